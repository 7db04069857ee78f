/* means.c - means of varied fields over a study's distributions and sweeps. */
#include "schema/study/means.h"

#include <math.h>
#include <stdint.h>

#include "schema/study/fields.h"

enum { QUANTILES = 64 /* quantiles per mean of a distribution */ };

/* Offset of a varied field in the scene; SIZE_MAX: in its buildings or contacts. */
size_t means_offset(struct pound_field field)
{
	return field.part == POUND_PART_SCENE ? field.offset : SIZE_MAX;
}

/* The mean of a power of a field of the scene, over its distribution or its sweep. */
double means_power(const struct pound_study *study, size_t offset, double power)
{
	double sum = 0;
	for (int j = 0; j < study->n_inputs; j++) {
		if (means_offset(study->inputs[j].field) != offset)
			continue;
		for (int k = 0; k < QUANTILES; k++)
			sum += pow(pound_distribution_quantile(&study->inputs[j].distribution, (k + 0.5) / QUANTILES),
			           power);
		return sum / QUANTILES;
	}
	for (int s = 0; s < study->n_sweeps; s++) {
		const struct pound_sweep *sweep = &study->sweeps[s];
		if (means_offset(sweep->field) != offset)
			continue;
		for (int k = 0; k < sweep->n_values; k++)
			sum += pow(sweep->values[k], power);
		return sum / sweep->n_values;
	}
	const struct pound_field field = {.type = POUND_FIELD_REAL, .offset = offset};
	return pow(pound_scene_field(&study->scene, field), power);
}

/* Mean duration [s] and number of samples of a ground motion. */
static void motion_mean(const struct pound_study *study, double *duration, double *samples)
{
	const struct pound_excitation *e = &study->scene.excitation;
	const bool cycles =
	    fields_used(fields_find("/scene/excitation/cycles"), NULL, pound_excitation_name(e->type), NULL);
	*duration = *samples = 0;
	for (int k = 0; k < e->n_records; k++) {
		*duration += e->records[k].n * e->records[k].time_step / e->n_records;
		*samples += (double)e->records[k].n / e->n_records;
	}
	if (e->n_records)
		return;
	*duration = e->n_record ? e->n_record * MEAN(study, excitation.time_step, 1)
	            : cycles    ? MEAN(study, excitation.cycles, 1) * MEAN(study, excitation.frequency_hz, -1)
	                        : MEAN(study, excitation.duration, 1);
	*samples = *duration * MEAN(study, excitation.time_step, -1) + 1;
}

double means_duration(const struct pound_study *study)
{
	double duration, samples;
	motion_mean(study, &duration, &samples);
	return duration;
}

double means_samples(const struct pound_study *study)
{
	double duration, samples;
	motion_mean(study, &duration, &samples);
	return samples;
}
