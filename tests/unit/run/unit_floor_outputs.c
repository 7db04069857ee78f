/* unit_floor_outputs.c - floor spectra as outputs of studies: over signals, in any order of threads, together with
 * the impulse. */
#include <math.h>
#include <string.h>

#include "engine/run/floor_outputs.h"
#include "schema/study/study_json.h"
#include "tests/support/check.h"
#include "tests/support/floor_tasks.h"
#include "tests/support/study_documents.h"

/* Runs all blocks, from the last to the first if `backwards`, and all reductions. */
static struct pound_run *run_all(const struct pound_study *study, bool backwards)
{
	struct pound_run *run = pound_run_create(study, 1);
	assert_non_null(run);
	int n = pound_run_blocks(run);
	for (int b = 0; b < n; b++)
		assert_int_equal(pound_run_block(run, backwards ? n - 1 - b : b, 0), POUND_OK);
	for (int r = 0; r < pound_run_reductions(run); r++)
		assert_int_equal(pound_run_reduce(run, r, 0), POUND_OK);
	return run;
}

static const char scene[] =
    "\"scene\": {\"oscillators\": [{\"frequency_hz\": 2, \"mass_kg\": 3}, {\"frequency_hz\": "
    "3.1}], \"excitation\": {\"cycles\": 8, \"signals\": %d}}";

/* A study document with this scene and number of signals; the caller frees it. */
static struct pound_study *study_of(const char *kind, int signals, const char *more)
{
	char filled[400], document[1600];
	snprintf(filled, sizeof filled, scene, signals);
	snprintf(document, sizeof document, "{\"kind\": \"%s\", %s, %s}", kind, filled, more);
	return study_documents_study(document);
}

static const char few[] = "\"spectrum\": {\"frequencies_hz\": [0.5, 2, 7, 40], \"damping_ratio\": 0.03}";

static void a_study_of_one_signal_is_its_floor(void **state)
{
	(void)state;
	struct specimen specimen;
	specimen_init(&specimen);
	specimen_noise(&specimen, 11, 3.7, 0.01, 401);
	specimen.study.kind = POUND_KIND_FLOOR_SPECTRUM;
	specimen.study.n_outputs = 0;
	specimen.study.scene.oscillators[0].mass = 2.5;
	const double frequencies[] = {0.5, 1, 2, 4, 8, 16};
	specimen.study.spectrum =
	    (struct pound_spectrum){.n = 6, .frequencies_hz = frequencies, .damping_ratio = 0.05};
	struct pound_run *run = run_all(&specimen.study, false);
	const struct pound_floor_result *floor = &pound_run_result(run)->floor;
	double psa[2][6], *into[] = {psa[0], psa[1]};
	specimen.study.kind = POUND_KIND_RESPONSE; // needed to derive the task
	specimen.study.n_outputs = 1;
	struct pound_task task = floor_task_task(&specimen, true);
	const struct pound_floor_answer answer =
	    floor_task_spectra(&task, &specimen.study.spectrum, 2, 1, 0, into);
	for (int k = 0; k < 6; k++) {
		// the study scales the motion by a power of two
		check_near(floor->spectra[POUND_SPECTRUM_POUNDING].mean[k], psa[0][k], 1e-9 * psa[0][k]);
		check_near(floor->spectra[POUND_SPECTRUM_IMPACT_ONLY].mean[k], psa[1][k], 1e-9 * psa[1][k]);
		check_near(floor->spectra[POUND_SPECTRUM_DIRAC_LINE].mean[k],
		           answer.impulse_max * 2 * 3.14159265358979 * frequencies[k] *
		               exp(-0.025 * 3.14159265358979),
		           1e-8 * psa[0][k]);
		check_near(floor->spectra[POUND_SPECTRUM_POUNDING].p84[k],
		           floor->spectra[POUND_SPECTRUM_POUNDING].mean[k], 0);
		check_near(floor->spectra[POUND_SPECTRUM_FREE].error[k], 0, 1e-11);
		check_near(floor->spectra[POUND_SPECTRUM_POUNDING].error[k], 0, 1e-9);
	}
	check_near(floor->impulse_mean, 2.5 * answer.impulse_max, 1e-9);
	check_near(floor->pulses_mean, (double)answer.contacts, 0);
	assert_int_equal(floor->signals_checked, 1);
	task = floor_task_task(&specimen, false);
	floor_task_spectra(&task, &specimen.study.spectrum, 1, 1, 0, into);
	for (int k = 0; k < 6; k++)
		check_near(floor->spectra[POUND_SPECTRUM_FREE].mean[k], psa[0][k], 1e-12 * psa[0][k]);
	pound_run_free(run);
	specimen_free(&specimen);
}

static void blocks_may_come_in_any_order(void **state)
{
	(void)state;
	struct pound_study *study = study_of("floor_spectrum", 21, few);
	struct pound_run *a = run_all(study, false), *b = run_all(study, true);
	assert_true(pound_run_blocks(a) > 2);
	const struct pound_result *one = pound_run_result(a), *other = pound_run_result(b);
	for (int row = 0; row < POUND_N_SPECTRA; row++) {
		assert_memory_equal(one->floor.spectra[row].mean, other->floor.spectra[row].mean, 4 * sizeof(double));
		assert_memory_equal(one->floor.spectra[row].p16, other->floor.spectra[row].p16, 4 * sizeof(double));
	}
	assert_int_equal(one->work.floors.asked, 42);
	assert_int_equal(one->work.floors.run, 42);
	pound_run_free(a);
	pound_run_free(b);
	study_free(study);
}

static void percentiles_stand_around_the_median(void **state)
{
	(void)state;
	struct pound_study *study = study_of("floor_spectrum", 9, few);
	struct pound_run *run = run_all(study, false);
	const struct pound_floor_result *floor = &pound_run_result(run)->floor;
	for (int row = 0; row < POUND_N_SPECTRA; row++)
		for (int k = 0; k < 4; k++) {
			const struct pound_floor_spectrum *s = &floor->spectra[row];
			assert_true(s->p16[k] < s->p84[k] && s->p16[k] > 0);
			assert_true(s->mean[k] > 0.5 * s->p16[k] && s->mean[k] < 2 * s->p84[k]);
		}
	// Eq. (23) is linear in the frequency
	const double *line = floor->spectra[POUND_SPECTRUM_DIRAC_LINE].mean;
	check_near(line[3] / line[0], 80, 1e-12);
	pound_run_free(run);
	study_free(study);
}

static const char varied[] =
    "\"inputs\": [{\"path\": \"/contact/restitution\", \"name\": \"eps\", \"distribution\": {\"type\": "
    "\"uniform\", "
    "\"min\": 0, \"max\": 1}}, {\"path\": \"/oscillators/1/mass_kg\", \"name\": \"m\", \"distribution\": "
    "{\"type\": "
    "\"uniform\", \"min\": 1, \"max\": 9}}], \"design\": {\"rows\": %d}, \"outputs\": [%s]%s%s";

static struct pound_study *sensitivity_of(int rows, const char *outputs, bool spectrum)
{
	char more[900];
	snprintf(more, sizeof more, varied, rows, outputs, spectrum ? ", " : "", spectrum ? few : "");
	return study_of("sensitivity", 2, more);
}

/* For the same signals and scenes an ordinate is the mean of a study of spectra. */
static void an_ordinate_is_that_of_a_study_of_spectra(void **state)
{
	(void)state;
	struct pound_study *study = sensitivity_of(2, "\"floor_spectrum\"", true);
	struct pound_run *run = run_all(study, false);
	double x[2];
	pound_run_sample_inputs(run, 0, 0, x);
	struct pound_study *spectra = study_of("floor_spectrum", 2, few);
	spectra->scene.contact.restitution = x[0];
	spectra->scene.oscillators[1].mass = x[1];
	struct pound_run *whole = run_all(spectra, false);
	for (int k = 0; k < 4; k++) {
		const struct pound_sample_output output = pound_run_sample_output(run, 0, 0, 0, k);
		check_near(output.mean, pound_run_result(whole)->floor.spectra[POUND_SPECTRUM_POUNDING].mean[k],
		           1e-13 * output.mean);
		assert_true(output.variance > 0);
	}
	pound_run_free(run);
	pound_run_free(whole);
	study_free(study);
	study_free(spectra);
}

/* A study without spectra gets the same numbers, and no floor is followed. */
static void a_study_without_spectra_does_not_pay_for_them(void **state)
{
	(void)state;
	struct pound_study *with = sensitivity_of(8, "\"impulse\", \"floor_spectrum\"", true);
	struct pound_study *without = sensitivity_of(8, "\"impulse\"", false);
	struct pound_run *a = run_all(with, false), *b = run_all(without, false);
	const struct pound_result *dear = pound_run_result(a), *cheap = pound_run_result(b);
	assert_int_equal(dear->work.floors.asked, 8 * 4 * 2);
	assert_true(dear->work.floors.run > 0 && dear->work.floors.run <= dear->work.floors.asked);
	assert_int_equal(cheap->work.floors.asked, 0);
	assert_int_equal(cheap->work.floors.run, 0);
	assert_int_equal(pound_ordinate_bytes(without, 100), 0);
	check_near(dear->cells[0].indices[0].mean, cheap->cells[0].indices[0].mean, 0);
	check_near(dear->cells[0].indices[0].index[POUND_ST][1].value,
	           cheap->cells[0].indices[0].index[POUND_ST][1].value, 0);
	assert_true(isnan(cheap->cells[0].indices[0].impulse_correlation.value));
	pound_run_free(a);
	pound_run_free(b);
	study_free(with);
	study_free(without);
}

/* Pearson's correlation of the samples A and B, computed plainly from the sample outputs. */
static void the_correlation_is_that_of_the_samples(void **state)
{
	(void)state;
	enum { ROWS = 24 };
	struct pound_study *study = sensitivity_of(ROWS, "\"impulse\", \"floor_spectrum\"", true);
	struct pound_run *run = run_all(study, false);
	const struct pound_cell *cell = &pound_run_result(run)->cells[0];
	for (int o = 1; o < 5; o++) {
		double x[2 * ROWS], y[2 * ROWS], mx = 0, my = 0, xx = 0, yy = 0, xy = 0;
		for (int i = 0; i < 2 * ROWS; i++) {
			x[i] = pound_run_sample_output(run, 0, i / 2, i % 2, o).mean;
			// f_1 and the excitation are the same: each row's ratio to the free displacement is proportional to its
			// mean impulse
			double sum = 0;
			for (int r = 0; r < 2; r++)
				sum += pound_blocks_run(&run->layout, i / 2 * 2 + r, 0, i % 2)[2 * study->n_outputs];
			y[i] = sum / 2;
			mx += x[i] / (2 * ROWS), my += y[i] / (2 * ROWS);
		}
		for (int i = 0; i < 2 * ROWS; i++)
			xx += (x[i] - mx) * (x[i] - mx), yy += (y[i] - my) * (y[i] - my), xy += (x[i] - mx) * (y[i] - my);
		const struct pound_estimate *r = &cell->indices[o].impulse_correlation;
		check_near(r->value, xy / sqrt(xx * yy), 1e-12);
		assert_true(r->low < r->value && r->value < r->high && r->high <= 1);
	}
	assert_true(isnan(cell->indices[0].impulse_correlation.value));
	// 7 and 40 Hz are far above the floor's 2 Hz, 0.5 Hz is below
	assert_true(cell->indices[3].impulse_correlation.value > cell->indices[1].impulse_correlation.value);
	pound_run_free(run);
	study_free(study);
}

/* The half widths of the correlations must be Student's quantile times the scatter of the correlations without one
 * group, which the test computes from the samples. */
static void its_interval_is_by_groups_where_the_rows_have_some(void **state)
{
	(void)state;
	enum { ROWS = 32 };
	struct pound_study *study = sensitivity_of(ROWS, "\"impulse\", \"floor_spectrum\"", true);
	study->design.method = 0;
	while (strcmp(pound_design_name(study->design.method), "sobol") != 0)
		study->design.method++;
	study->design.randomisations = 8;
	struct pound_run *run = run_all(study, false);
	const int groups = 8;
	const struct pound_estimate *r = &pound_run_result(run)->cells[0].indices[1].impulse_correlation;
	double pseudo[8], mean = 0, squares = 0;
	for (int without = -1; without < groups; without++) {
		double n = 0, mx = 0, my = 0, xx = 0, yy = 0, xy = 0;
		for (int i = 0; i < 2 * ROWS; i++) {
			double y = 0;
			if (without >= 0 && i / 2 % groups == without)
				continue;
			const double x = pound_run_sample_output(run, 0, i / 2, i % 2, 1).mean;
			for (int s = 0; s < 2; s++)
				y += pound_blocks_run(&run->layout, i / 2 * 2 + s, 0, i % 2)[2 * study->n_outputs] / 2;
			n++, mx += x, my += y, xx += x * x, yy += y * y, xy += x * y;
		}
		double value =
		    (xy / n - mx / n * (my / n)) / sqrt((xx / n - mx / n * (mx / n)) * (yy / n - my / n * (my / n)));
		if (without < 0)
			check_near(r->value, value, 1e-10);
		else
			mean += (pseudo[without] = groups * r->value - (groups - 1) * value) / groups;
	}
	for (int g = 0; g < groups; g++)
		squares += (pseudo[g] - mean) * (pseudo[g] - mean);
	// 97.5 % quantile of Student's distribution with 7 degrees of freedom
	const double half = 2.364624251592784 * sqrt(squares / (groups - 1) / groups);
	check_near(r->high - r->value, half, 1e-8);
	check_near(r->value - r->low, half, 1e-8);
	pound_run_free(run);
	study_free(study);
}

/* ---- histories ---- */

struct instants_seen {
	int n, signal, doubled;
	struct pound_instant last;
	double impulse; /* integral of the contact force of all contacts by linear interpolation */
};

static void instant_take(void *into, int signal, const struct pound_instant *instant)
{
	struct instants_seen *seen = into;
	assert_true(seen->n == 0 || instant->time >= seen->last.time);
	seen->doubled += seen->n && instant->time == seen->last.time;
	seen->impulse +=
	    seen->n ? 0.5 * (instant->time - seen->last.time) * (instant->force + seen->last.force) : 0;
	seen->last = *instant;
	seen->signal = signal;
	seen->n++;
}

static void a_history_is_that_of_the_signal(void **state)
{
	(void)state;
	struct pound_study *spectra = study_of("floor_spectrum", 2, few),
	                   *response = study_of("response", 2, "\"name\": \"r\"");
	struct pound_run *run = pound_run_create(spectra, 1), *reference = run_all(response, false);
	for (int signal = 1; signal >= 0; signal--) {
		struct instants_seen seen = {0};
		assert_int_equal(pound_run_history(run, signal, instant_take, &seen), POUND_OK);
		const struct pound_response *r = &pound_run_result(reference)->cells[0].signals[signal];
		assert_int_equal(seen.signal, signal);
		check_near(seen.last.time, 3.2, 1e-12);
		check_near(seen.last.u[0], r->end_u1, 1e-9 * r->displacement_max_1);
		check_near(seen.last.v[0], r->end_v1, 1e-8 * r->displacement_max_1);
		check_near(seen.last.u[1], r->end_u2, 1e-9 * r->displacement_max_2);
		check_near(seen.last.v[1], r->end_v2, 1e-8 * r->displacement_max_2);
		// a contact that begins at the first sample has one row there, not two
		int events = 2 * (int)r->contact_count - (seen.last.force != 0);
		assert_in_range(seen.doubled, events - 1, events);
		// the total impulse of the contacts is between zero and the number of contacts times the largest impulse
		assert_true(seen.impulse > 0 && seen.impulse < r->impulse_max * r->contact_count);
	}
	pound_run_free(run);
	pound_run_free(reference);
	study_free(spectra);
	study_free(response);
}

CHECK_MAIN(cmocka_unit_test(a_study_of_one_signal_is_its_floor),
           cmocka_unit_test(blocks_may_come_in_any_order),
           cmocka_unit_test(percentiles_stand_around_the_median),
           cmocka_unit_test(an_ordinate_is_that_of_a_study_of_spectra),
           cmocka_unit_test(a_study_without_spectra_does_not_pay_for_them),
           cmocka_unit_test(the_correlation_is_that_of_the_samples),
           cmocka_unit_test(its_interval_is_by_groups_where_the_rows_have_some),
           cmocka_unit_test(a_history_is_that_of_the_signal))
