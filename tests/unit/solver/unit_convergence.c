/* unit_convergence.c - convergence studies: rows whose errors are known. */
#include "tests/support/check.h"
#include "tests/support/scenes.h"

#include <math.h>
#include <stdatomic.h>
#include <string.h>

#include "engine/pound.h"
#include "engine/solver/convergence.h"

enum { NEWMARK = 1, CENTRAL_DIFFERENCE = 2, ADAPTIVE = 3, SAMPLES = 301 };

/* A convergence study of smooth noise for 3 s; two solvers with five halved steps, one with three tolerances. */
static void convergence_init(struct specimen *specimen)
{
	specimen_init(specimen);
	specimen_noise(specimen, 7, 1, 0.01, SAMPLES);
	specimen->study.kind = POUND_KIND_CONVERGENCE;
	struct pound_convergence *convergence = &specimen->study.convergence;
	convergence->history = 2;
	for (int k = 0; k < 5; k++)
		for (int row = NEWMARK; row <= CENTRAL_DIFFERENCE; row++)
			convergence->settings[row].values[convergence->settings[row].n++] = 0.005 / (1 << k);
	for (int k = 0; k < 3; k++)
		convergence->settings[ADAPTIVE].values[convergence->settings[ADAPTIVE].n++] = pow(10, -4 - 3 * k);
}

static struct pound_run *run_all(const struct pound_study *study, double (*cpu)(void))
{
	struct pound_run *run = pound_run_create(study, 1);
	assert_non_null(run);
	if (cpu)
		pound_run_clock(run, cpu);
	assert_int_equal(specimen_compute(run), POUND_OK);
	return run;
}

static void rows_are_the_reference_the_second_opinion_and_every_setting(void **state)
{
	(void)state;
	struct specimen specimen;
	convergence_init(&specimen);
	specimen.study.convergence.settings[NEWMARK].values[0] = 0.0051; // divided into two steps of 0.005
	struct pound_run *run = run_all(&specimen.study, NULL);
	const struct pound_result *r = pound_run_result(run);
	assert_int_equal(r->n_trials, 2 + 5 + 5 + 3);
	assert_int_equal(r->n_trials, pound_convergence_trials(&specimen.study));
	static const int methods[] = {0, 3, 1, 1, 1, 1, 1, 2, 2, 2, 2, 2, 3, 3, 3};
	for (int j = 0; j < r->n_trials; j++) {
		const struct pound_trial *trial = &r->trials[j];
		assert_int_equal(trial->solver.method, methods[j]);
		assert_true(isnan(trial->solver.step) == (trial->solver.method % 3 == 0));
		assert_true(isnan(trial->solver.tolerance) == (trial->solver.method != ADAPTIVE));
		assert_true(isnan(trial->order) == (j < 2 || methods[j - 1] != methods[j] || j == 2));
		assert_true(isnan(trial->cpu)); // the test has no clock
		assert_int_equal(trial->runs_failed, 0);
	}
	check_near(r->trials[0].history.largest + r->trials[0].impulse.largest, 0, 0);
	check_near(r->trials[1].solver.tolerance, 1e-12, 0);
	check_near(r->trials[2].solver.step, 0.005, 1e-18);
	assert_int_equal(r->cells[0].runs, r->n_trials);
	pound_run_free(run);
	specimen_free(&specimen);
}

static void without_contact_both_fixed_steps_are_of_second_order(void **state)
{
	(void)state;
	struct specimen specimen;
	convergence_init(&specimen);
	specimen.study.scene.contact.present = false;
	struct pound_run *run = run_all(&specimen.study, NULL);
	const struct pound_result *r = pound_run_result(run);
	for (int j = 2; j < r->n_trials; j++)
		if (pound_solver_takes_step(r->trials[j].solver.method) && !isnan(r->trials[j].order))
			// smooth forces, two frequencies up to 2.5 Hz: (w h)^2 = 0.6 % at the first step
			check_near(r->trials[j].order, 2, 0.02);
	assert_true(r->trials[6].history.mean < 1e-4 && r->trials[11].history.mean < 1e-4);
	check_near(pound_convergence_order(r->trials, r->n_trials, NEWMARK), 2, 0.02);
	check_near(pound_convergence_order(r->trials, r->n_trials, CENTRAL_DIFFERENCE), 2, 0.02);
	assert_true(isnan(pound_convergence_order(r->trials, r->n_trials, 0))); // the reference has one setting
	pound_run_free(run);
	specimen_free(&specimen);
}

/* In 2 s with contacts errors are of first order: after five steps, each half the last, 16 times less, except for the
 * scatter due to the start of contacts.  The second opinion agrees with the reference. */
static void with_contact_errors_fall_and_the_second_opinion_agrees(void **state)
{
	(void)state;
	for (int k = 0; k < 2 * SPECIMEN_LAWS; k++) {
		struct specimen specimen;
		convergence_init(&specimen);
		specimen_law(&specimen, specimen_laws[k / 2], 0);
		specimen.study.scene.contact.tension = k % 2;
		struct pound_run *run = run_all(&specimen.study, NULL);
		const struct pound_result *r = pound_run_result(run);
		const struct pound_trial *second = &r->trials[1];
		check_near(second->history.largest, 0, 1e-9);
		check_near(second->displacement.largest, 0, 1e-9);
		check_near(second->impulse.largest, 0, 1e-9);
		for (int first = 2; first <= 7; first += 5) {
			assert_true(r->trials[first].history.mean > 0);
			assert_true(r->trials[first + 4].history.mean < r->trials[first].history.mean / 4);
			assert_true(r->trials[first + 4].impulse.mean < 0.05);
		}
		// each solver searches its own yield displacement, so the demand has a separate error
		assert_true(isnan(second->demand.mean) == (k < 2));
		if (k >= 2)
			assert_true(r->trials[2].demand.mean != r->trials[2].displacement.mean);
		pound_run_free(run);
		specimen_free(&specimen);
	}
}

static void a_setting_that_fails_is_counted_and_the_others_stand(void **state)
{
	(void)state;
	struct specimen specimen;
	convergence_init(&specimen);
	specimen.study.scene.oscillators[1].frequency_hz = 150; // 2/w = 2.1 ms
	specimen.study.scene.contact.present = false;
	specimen.study.scene.oscillators[0].frequency_hz = 150;
	struct pound_run *run = run_all(&specimen.study, NULL);
	const struct pound_result *r = pound_run_result(run);
	assert_int_equal(r->trials[7].runs_failed, 1);
	assert_int_equal(r->trials[8].runs_failed, 1);
	assert_int_equal(r->trials[9].runs_failed, 0);
	assert_int_equal(r->cells[0].runs_failed, 2);
	assert_true(isnan(r->trials[7].displacement.mean) && isnan(r->trials[7].history.largest));
	assert_true(isnan(r->trials[9].order)); // there is no earlier error
	assert_true(r->trials[10].order > 1.5);
	pound_run_free(run);
	specimen_free(&specimen);
}

static _Atomic int ticks;

static double counted_cpu(void)
{
	return 0.25 * atomic_fetch_add(&ticks, 1);
}

static void a_run_s_time_is_the_clock_s_over_its_runs(void **state)
{
	(void)state;
	struct specimen specimen;
	convergence_init(&specimen);
	struct pound_run *run = run_all(&specimen.study, counted_cpu);
	const struct pound_result *r = pound_run_result(run);
	for (int j = 0; j < r->n_trials; j++)
		check_near(r->trials[j].cpu, 0.25, 0); // one run between two clock ticks
	pound_run_free(run);
	specimen_free(&specimen);
}

static void histories_are_compared_at_rising_samples_within_their_seconds(void **state)
{
	(void)state;
	static const struct {
		double history;
		int n, last;
	} cases[] = {{2, POUND_HISTORY, 200}, {0.1, 10, 10}, {1e-9, 1, 1}, {1e300, POUND_HISTORY, SAMPLES - 1}};
	struct specimen specimen;
	convergence_init(&specimen);
	for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
		int samples[POUND_HISTORY];
		specimen.study.convergence.history = cases[i].history;
		assert_int_equal(pound_convergence_times(&specimen.study, samples), cases[i].n);
		for (int k = 0; k < cases[i].n; k++)
			assert_true(samples[k] > (k ? samples[k - 1] : 0));
		assert_int_equal(samples[cases[i].n - 1], cases[i].last);
	}
	specimen_free(&specimen);
}

static void a_stopped_run_says_so(void **state)
{
	(void)state;
	struct specimen specimen;
	convergence_init(&specimen);
	struct pound_run *run = pound_run_create(&specimen.study, 1);
	pound_run_stop(run);
	assert_int_equal(pound_run_block(run, 3, 0), POUND_STOPPED);
	assert_int_equal(pound_run_reduce(run, 0, 0), POUND_STOPPED);
	pound_run_free(run);
	specimen_free(&specimen);
}

CHECK_MAIN(cmocka_unit_test(rows_are_the_reference_the_second_opinion_and_every_setting),
           cmocka_unit_test(without_contact_both_fixed_steps_are_of_second_order),
           cmocka_unit_test(with_contact_errors_fall_and_the_second_opinion_agrees),
           cmocka_unit_test(a_setting_that_fails_is_counted_and_the_others_stand),
           cmocka_unit_test(a_run_s_time_is_the_clock_s_over_its_runs),
           cmocka_unit_test(histories_are_compared_at_rising_samples_within_their_seconds),
           cmocka_unit_test(a_stopped_run_says_so))
