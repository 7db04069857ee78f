/* model.h - the study of an external model. */
#ifndef MODEL_H
#define MODEL_H

#include "client/command.h"
#include "engine/pound.h"

/* The study of a file, which has a design and needs no scene; NULL: reported on stderr, with the outcome. */
struct pound_study *model_study(const char *path, enum outcome *outcome);

#endif
