/* motion_spectrum.c - the response spectrum of a ground motion, computed by a study without contact that sweeps the frequency. */
#include "schema/result/motion_spectrum.h"

#include "engine/ground/excitation.h"

#include <assert.h>
#include <stddef.h>
#include <stdlib.h>
#include <string.h>

const double motion_spectrum_damping = 0.05;

static const double PI = 3.14159265358979323846, PERIOD_MAX = 1000;

const char motion_spectrum_expected[] = "up to 100 numbers in (0, 1000] s between commas";
static_assert(PERIODS_MAX == 100, "as the text says");

bool motion_spectrum_periods(const char *list, struct periods *periods)
{
	periods->n = 0;
	for (const char *at = list; at; periods->n++) {
		char *end;
		const double period = strtod(at, &end);
		if (end == at || (*end && *end != ',') || !(period > 0 && period <= PERIOD_MAX) ||
		    periods->n == PERIODS_MAX)
			return false;
		periods->period[periods->n] = period;
		at = *end ? end + 1 : NULL;
	}
	return true;
}

/* Runs a study in this thread. */
static enum pound_status run_all(struct pound_run *run)
{
	enum pound_status status = run ? POUND_OK : POUND_NOMEM;
	for (int b = 0; status == POUND_OK && b < pound_run_blocks(run); b++)
		status = pound_run_block(run, b, 0);
	for (int r = 0; status == POUND_OK && r < pound_run_reductions(run); r++)
		status = pound_run_reduce(run, r, 0);
	return status;
}

enum pound_status motion_spectrum(const struct record *motion, const struct periods *periods, double *psa)
{
	double frequencies[PERIODS_MAX];
	for (int k = 0; k < periods->n; k++)
		frequencies[k] = 1 / periods->period[k];
	struct pound_sweep sweep = {
	    .path = "/oscillators/0/frequency_hz",
	    .field = {.type = POUND_FIELD_REAL,
	              .offset = offsetof(struct pound_scene, oscillators[0].frequency_hz)},
	    .n_values = periods->n,
	    .values = frequencies};
	struct pound_study study = {.kind = POUND_KIND_RESPONSE, .n_sweeps = 1, .sweeps = &sweep};
	for (int i = 0; i < POUND_OSCILLATORS; i++)
		study.scene.oscillators[i] =
		    (struct pound_oscillator){.mass = 1, .frequency_hz = 1, .damping_ratio = motion_spectrum_damping};
	struct pound_excitation *excitation = &study.scene.excitation;
	for (int row = 0; pound_excitation_name(row); row++)
		if (strcmp(pound_excitation_name(row), "record") == 0)
			excitation->type = row;
	excitation->time_step = motion->step;
	excitation->signals = 1;
	excitation->factor = 1;
	excitation->n_record = motion->n;
	excitation->record = motion->acceleration;
	struct pound_run *run = pound_run_create(&study, 1);
	enum pound_status status = run_all(run);
	for (int k = 0; status == POUND_OK && k < periods->n; k++) {
		const double w = 2 * PI * frequencies[k];
		psa[k] = w * w * pound_run_result(run)->cells[k].signals[0].displacement_max_free_1;
	}
	pound_run_free(run);
	return status;
}

enum pound_status motion_spectrum_finer(const struct record *motion, const struct periods *periods,
                                        double *psa)
{
	struct record twice = {.n = 2 * motion->n - 1, .step = motion->step / 2};
	twice.acceleration = malloc((size_t)twice.n * sizeof *twice.acceleration);
	if (!twice.acceleration)
		return POUND_NOMEM;
	pound_interpolation_twice(motion->n, motion->acceleration, twice.acceleration);
	const enum pound_status status = motion_spectrum(&twice, periods, psa);
	record_free(&twice);
	return status;
}
