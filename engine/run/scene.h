/* scene.h - a scene divided by masses, as input of the solver. */
#ifndef SCENE_H
#define SCENE_H

#include "engine/exact/task.h"
#include "engine/pound.h"

struct pound_task_body pound_scene_body(const struct pound_scene *scene, int i);
void pound_scene_contact(const struct pound_scene *scene, struct pound_task *task);
double pound_scene_reduction(const struct pound_scene *scene, double frequency_hz, double demand);
bool pound_scene_alike(const struct pound_scene *scene);

#endif
