/* means.h - means of varied fields over a study's distributions and sweeps.  For the files of schema/study only. */
#ifndef MEANS_H
#define MEANS_H

#include <stddef.h>

#include "engine/pound.h"

size_t means_offset(struct pound_field field);

/* The mean of a power of a field of the scene. */
double means_power(const struct pound_study *study, size_t offset, double power);
#define MEAN(study, member, power) means_power((study), offsetof(struct pound_scene, member), (power))

/* Mean duration and number of samples of a ground motion. */
double means_duration(const struct pound_study *study); /* [s] */
double means_samples(const struct pound_study *study);

#endif
