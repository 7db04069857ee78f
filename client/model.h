/* model.h - the study of a model that is run elsewhere. */
#ifndef MODEL_H
#define MODEL_H

#include "client/command.h"
#include "engine/pound.h"

/* The study of a file, with a design and no need of a scene; NULL: complained about, with the outcome. */
struct pound_study *model_study(const char *path, enum outcome *outcome);

#endif
