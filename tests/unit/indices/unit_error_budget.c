/* unit_error_budget.c - error bounds of the indices: differences between repeated runs, intervals against rows, and
 * the dominant error; first for functions with known indices, then for runs of the engine. */
#include "engine/indices/error_budget.h"
#include "tests/support/check.h"
#include "tests/support/functions.h"
#include "tests/support/study_documents.h"

#include <math.h>
#include <string.h>

#include "schema/study/study_json.h"

enum { D = FUNCTION_INPUTS, SAMPLES = D + 2 };

struct estimated {
	struct pound_indices of;
	struct pound_estimate index[POUND_N_INDICES][POUND_INPUTS_MAX];
};

/* All indices and their accuracy, from outputs over function_design(n_rows, seed). */
static struct estimated *estimated_of(const struct pound_sample_values *values, struct pound_checks checks,
                                      uint64_t seed)
{
	struct estimated *e = calloc(1, sizeof *e);
	size_t n = pound_index_columns_scratch(values, 0);
	double *scratch = malloc(sizeof *scratch * (n + (size_t)checks.n));
	double *u = function_design(values->n_rows, seed);
	const struct pound_sampling sampling = {.u = u, .random = true, .fresh_signals = values->n_signals == 1};
	for (int k = 0; k < POUND_N_INDICES; k++)
		e->of.index[k] = e->index[k];
	pound_index_columns_indices(values, &sampling, seed, scratch, &e->of);
	pound_accuracy_estimate(values, checks, false, scratch, &e->of);
	free(scratch), free(u);
	return e;
}

static void differences_of_runs_come_out_relative_and_as_a_variance(void **state)
{
	(void)state;
	// two rows, one input, two signals; outputs are means of numerators, as all denominators are 1
	enum { VALUES = 2 * 3 * 2 };
	static const double numerator[VALUES] = {1, 3, 5, 7, 2, 4, 8, 8, 1, 1, 6, 2};
	double denominator[VALUES];
	for (int k = 0; k < VALUES; k++)
		denominator[k] = 1;
	struct pound_sample_values values = {
	    .n_rows = 2, .n_inputs = 1, .n_signals = 2, .numerator = numerator, .denominator = denominator};
	struct pound_check check[] = {
	    {0, 0, {1, 1}, {1, 1}},     // equal
	    {0, 1, {5, 5.5}, {1, 1}},   // relative difference 1/11, e = 1/2
	    {1, 0, {8, 4}, {1, 1}},     // relative difference 1/2, e = -4
	    {1, 2, {6, 12}, {1, 2}},    // the ratio is equal; e = 6 - 4 1 = 2
	    {1, 1, {NAN, 1}, {NAN, 1}}, // failed in one run
	    {1, 1, {1, 1}, {0, 0}},     // no response
	};
	struct estimated *e = estimated_of(&values, (struct pound_checks){6, check}, 1);
	assert_int_equal(e->of.accuracy.runs_checked, 4);
	assert_int_equal(e->of.accuracy.runs_unchecked, 2);
	check_near(e->of.accuracy.difference_median, 1 / 22., 1e-16);
	check_near(e->of.accuracy.difference_largest, 0.5, 0);
	// mean of 0, 1/4, 16, 4 over two signals
	check_near(e->of.accuracy.variance_share * e->of.variance, 20.25 / 4 / 2, 1e-14);
	free(e);
}

static void runs_that_agree_move_no_index(void **state)
{
	(void)state;
	struct pound_sample_values values =
	    function_values(function_named("ishigami"), 100, 3, (struct function_noise){.n_signals = 1});
	struct pound_check check = {7, 2, {0, 0}, {0, 0}};
	for (int k = 0; k < 2; k++) {
		check.numerator[k] = values.numerator[7 * SAMPLES + 2];
		check.denominator[k] = values.denominator[7 * SAMPLES + 2];
	}
	struct estimated *e = estimated_of(&values, (struct pound_checks){1, &check}, 3);
	for (int j = 0; j < D; j++) {
		check_near(e->of.accuracy.inputs[j].first_change, 0, 0);
		check_near(e->of.accuracy.inputs[j].total_change, 0, 0);
	}
	check_near(e->of.accuracy.errors[POUND_ERROR_INTEGRATION], 0, 0);
	free(e);
	function_values_free(&values);
}

/* A standard normal number of a stream, approximately: twelve uniform ones. */
static double normal(uint64_t *stream)
{
	double sum = -6;
	for (int k = 0; k < 12; k++) {
		*stream = *stream * 6364136223846793005u + 1442695040888963407u;
		sum += (double)(*stream >> 11) * 0x1p-53;
	}
	return sum;
}

/* Adds noise to every output; every 20th run is checked against the output without noise.  Returns the number of
 * indices that change by more than the stated bound. */
static int moved_further(const struct function *f, int n_rows, double share, uint64_t seed)
{
	struct pound_sample_values clean =
	    function_values(f, n_rows, seed, (struct function_noise){.n_signals = 1});
	int n = n_rows * SAMPLES, n_checks = 0, further = 0;
	double *noisy = malloc(sizeof *noisy * (size_t)n);
	struct pound_check *check = malloc(sizeof *check * (size_t)n);
	uint64_t stream = seed;
	for (int k = 0; k < n; k++) {
		double below = clean.denominator[k];
		noisy[k] = clean.numerator[k] + sqrt(share * f->variance) * normal(&stream) * below;
		if (k % 20 == 0)
			check[n_checks++] = (struct pound_check){
			    k / SAMPLES, k % SAMPLES, {noisy[k], clean.numerator[k]}, {below, below}};
	}
	struct pound_sample_values values = clean;
	values.numerator = noisy;
	struct estimated *with = estimated_of(&values, (struct pound_checks){n_checks, check}, seed);
	struct estimated *without = estimated_of(&clean, (struct pound_checks){0, NULL}, seed);
	for (int j = 0; j < D; j++) {
		further += fabs(with->index[POUND_S1][j].value - without->index[POUND_S1][j].value) >
		           with->of.accuracy.inputs[j].first_change;
		further += fabs(with->index[POUND_ST][j].value - without->index[POUND_ST][j].value) >
		           with->of.accuracy.inputs[j].total_change;
	}
	free(with), free(without), free(noisy), free(check);
	function_values_free(&clean);
	return further;
}

static void indices_move_no_more_than_stated_when_noise_is_added(void **state)
{
	(void)state;
	enum { SEEDS = 40, N = 100 };
	static const double shares[] = {1e-8, 1e-3, 0.05};
	for (int k = 0; k < 3; k++) {
		int further = 0;
		for (int seed = 0; seed < SEEDS; seed++)
			further += moved_further(function_named("ishigami"), N, shares[k], 100 + (uint64_t)seed);
		// twice the standard deviation is exceeded in at most 4.6 % of cases, as the deviations of the terms are added
		assert_in_range(further, 0, (int)(0.046 * SEEDS * 2 * D));
	}
}

static void half_widths_fall_with_the_root_of_the_rows(void **state)
{
	(void)state;
	struct pound_sample_values values =
	    function_values(function_named("ishigami"), 2048, 5, (struct function_noise){.n_signals = 1});
	struct estimated *e = estimated_of(&values, (struct pound_checks){0, NULL}, 5);
	const struct pound_accuracy *accuracy = &e->of.accuracy;
	assert_int_equal(accuracy->rows[0], 256);
	assert_int_equal(accuracy->rows[3], 2048);
	// half widths of 256 rows scatter by 5 % (more if outputs have heavy tails), so the slope scatters by some 0.05
	check_near(accuracy->slope.value, -0.5, 0.1);
	assert_true(accuracy->slope.low < -0.5 && accuracy->slope.high > -0.5);
	// by the root of the rows, whatever the slope
	check_near(accuracy->rows_to_halve / 2048, 4, 1e-12);
	// no runs were checked, and there is one signal only
	assert_true(isnan(accuracy->errors[POUND_ERROR_INTEGRATION]));
	assert_true(isnan(accuracy->errors[POUND_ERROR_EXCITATION]));
	assert_int_equal(pound_accuracy_dominant(accuracy->errors, accuracy->excitation_low),
	                 POUND_ERROR_SAMPLING);
	free(e);
	function_values_free(&values);
}

/* Sobol' points of a smooth function: the widths fall faster than with the root of the rows, and by so much that it shows. */
static void sobol_points_need_fewer_rows_if_it_shows(void **state)
{
	(void)state;
	for (int quasi_random = 0; quasi_random < 2; quasi_random++) {
		const struct pound_design design = {.method = 2, .rows = 16384, .randomisations = 32, .seed = 5};
		struct pound_sample_values values =
		    function_values_of(function_named("ishigami"), &design, (struct function_noise){.n_signals = 1});
		struct estimated *e = calloc(1, sizeof *e);
		double *u = function_design_of(&design),
		       *scratch = malloc(sizeof *scratch * pound_index_columns_scratch(&values, 0));
		const struct pound_sampling sampling = {
		    .u = u, .random = true, .fresh_signals = true, .quasi_random = true};
		for (int k = 0; k < POUND_N_INDICES; k++)
			e->of.index[k] = e->index[k];
		pound_index_columns_indices(&values, &sampling, 5, scratch, &e->of);
		pound_accuracy_estimate(&values, (struct pound_checks){0, NULL}, quasi_random, scratch, &e->of);
		const struct pound_accuracy *accuracy = &e->of.accuracy;
		assert_true(accuracy->slope.high < -0.5);
		if (quasi_random)
			check_near(accuracy->rows_to_halve / design.rows, exp2(-1 / accuracy->slope.high), 1e-12);
		else
			check_near(accuracy->rows_to_halve / design.rows, 4, 1e-12);
		free(u), free(scratch), free(e);
		function_values_free(&values);
	}
}

static double half(struct pound_estimate estimate)
{
	return 0.5 * (estimate.high - estimate.low);
}

/* From rows and from groups of rows, in a design with neighbors and in a quasi-random one. */
static void half_widths_of_all_rows_are_those_of_the_indices(void **state)
{
	(void)state;
	enum { N = 256 };
	for (int k = 0; k < 2; k++) {
		struct pound_sample_values values =
		    function_values(function_named("ishigami"), N, 5, (struct function_noise){.n_signals = 1});
		values.grouping = (struct pound_grouping){k ? 16 : 0, 1};
		double *u = function_design(N, 5),
		       *scratch = malloc(sizeof *scratch * pound_index_columns_scratch(&values, 0));
		struct pound_rows rows;
		struct pound_closed_results all, first_rows;
		struct pound_estimate first[D];
		double from_all[D], from_half[D];
		pound_rows_init(&rows, &values, scratch);
		double *rest = scratch + pound_rows_scratch(&values);
		pound_chaos_expansion_indices(&rows, &(struct pound_sampling){.u = u}, POUND_NOISE_KEPT, rest, &all,
		                              NULL);
		pound_chaos_expansion_first_rows(&rows, N, rest, &first_rows);
		for (int j = 0; j < D; j++) {
			check_near(half(first_rows.first[j]), half(all.first[j]), 1e-15);
			check_near(half(first_rows.total[j]), half(all.total[j]), 1e-15);
		}
		pound_local_regression_first(&rows, u, POUND_NOISE_KEPT, rest, first);
		pound_local_regression_first_rows(&rows, N, rest, from_all);
		pound_local_regression_first_rows(&rows, N / 2, rest, from_half);
		for (int j = 0; j < D; j++) {
			check_near(from_all[j], half(first[j]), 1e-15);
			// intervals from half the rows are wider by sqrt(2), within a third as there are 16 groups
			assert_true(from_half[j] > from_all[j] && from_half[j] < 2 * from_all[j]);
		}
		free(u), free(scratch);
		function_values_free(&values);
	}
}

/* Noise that is removed from the indices is still in their intervals: if it is nearly all of the variance, it is the
 * dominant error; if it is negligible, it is not. */
static void noise_of_few_signals_is_an_error_in_the_intervals(void **state)
{
	(void)state;
	static const double shares[] = {1e-4, 20};
	for (int k = 0; k < 2; k++) {
		struct pound_sample_values values = function_values(
		    function_named("ishigami"), 800, 7, (struct function_noise){.n_signals = 4, .share = shares[k]});
		struct estimated *e = estimated_of(&values, (struct pound_checks){0, NULL}, 7);
		const double *errors = e->of.accuracy.errors;
		assert_int_equal(pound_accuracy_dominant(errors, e->of.accuracy.excitation_low),
		                 k ? POUND_ERROR_EXCITATION : POUND_ERROR_SAMPLING);
		assert_true(errors[POUND_ERROR_EXCITATION] > 0);
		free(e);
		function_values_free(&values);
	}
}

/* An index that is exactly 1 has an interval of zero width, and the noise of signals shared by the samples adds
 * nothing to it. */
static void noise_adds_no_more_to_an_interval_than_there_is(void **state)
{
	(void)state;
	enum { N = 40, SIGNALS = 2 };
	double numerator[N * 3 * SIGNALS], one[N * 3 * SIGNALS], u[N * 2];
	for (int i = 0; i < N; i++) {
		u[2 * i] = (i + 0.5) / N, u[2 * i + 1] = (7 * i % N + 0.5) / N;
		// one input: its sample of A with the column from B is B
		for (int p = 0; p < 3; p++)
			for (int r = 0; r < SIGNALS; r++) {
				const double noise = r ? 1 : -1;
				numerator[(i * 3 + p) * SIGNALS + r] = u[2 * i + (p > 0)] + noise * (1 + i % 3) / 10;
				one[(i * 3 + p) * SIGNALS + r] = 1;
			}
	}
	const struct pound_sample_values values = {
	    .n_rows = N, .n_inputs = 1, .n_signals = SIGNALS, .numerator = numerator, .denominator = one};
	struct estimated *e = calloc(1, sizeof *e);
	double *scratch = malloc(sizeof *scratch * pound_index_columns_scratch(&values, 0));
	for (int k = 0; k < POUND_N_INDICES; k++)
		e->of.index[k] = e->index[k];
	pound_index_columns_indices(&values, &(struct pound_sampling){.u = u, .random = true}, 1, scratch,
	                            &e->of);
	pound_accuracy_estimate(&values, (struct pound_checks){0, NULL}, false, scratch, &e->of);
	const double sampling = e->of.accuracy.errors[POUND_ERROR_SAMPLING];
	assert_true(e->of.noise_share > 0.2);
	check_near(e->index[POUND_S1][0].low, 1, 0);
	check_near(sampling, 0, 0);
	check_near(e->of.accuracy.errors[POUND_ERROR_EXCITATION], 0, 0);
	free(scratch), free(e);
}

static void few_rows_and_constant_outputs_have_no_slope(void **state)
{
	(void)state;
	struct pound_sample_values values =
	    function_values(function_named("ishigami"), 12, 5, (struct function_noise){.n_signals = 1});
	struct estimated *e = estimated_of(&values, (struct pound_checks){0, NULL}, 5);
	static const int rows[POUND_LEVELS] = {0, 0, 0, 12};
	assert_memory_equal(e->of.accuracy.rows, rows, sizeof rows);
	assert_true(isnan(e->of.accuracy.slope.value) && isnan(e->of.accuracy.rows_to_halve));
	free(e);
	double *constant = calloc(12 * SAMPLES, sizeof *constant);
	struct pound_sample_values flat = values;
	flat.numerator = constant;
	e = estimated_of(&flat, (struct pound_checks){0, NULL}, 5);
	assert_true(isnan(e->of.accuracy.slope.value) && isnan(e->of.accuracy.variance_share));
	assert_true(isnan(e->of.accuracy.errors[POUND_ERROR_SAMPLING]));
	free(e), free(constant);
	function_values_free(&values);
}

static void the_dominant_error_is_larger_than_the_others_together(void **state)
{
	(void)state;
	// the widest interval has the squares of both of its sources: with 0.05 by signals sqrt(0.1^2 - 0.05^2) = 0.087 by rows
	static const struct {
		double errors[POUND_ERROR_NONE], low;
		enum pound_error wanted;
		bool undecided;
	} cases[] = {
	    {{0.1, 0.02, 1e-9, 0}, NAN, POUND_ERROR_SAMPLING, false},
	    {{0.1, NAN, 1e-9, 0}, NAN, POUND_ERROR_SAMPLING, false},
	    {{0.1, 0.05, 0.03, 0}, 0.05, POUND_ERROR_SAMPLING, false},
	    {{0.1, 0.05, 0.04, 0}, 0.05, POUND_ERROR_NONE, false},
	    // the rows exceed the signals, but not by the integration error, which is the rival
	    {{0.1, 0.01, 1e-9, 0.095}, 0.01, POUND_ERROR_NONE, false},
	    // an upper bound that is the whole interval shows nothing
	    {{0.05, 0.05, 0, 0}, NAN, POUND_ERROR_NONE, true},
	    {{0.05, 0.05, 0, 0}, 0.02, POUND_ERROR_NONE, true},
	    // 0.04 leaves at most 0.03 to the rows
	    {{0.05, 0.05, 0, 0}, 0.04, POUND_ERROR_EXCITATION, false},
	    {{0.05, 0.05, 0.02, 0}, 0.04, POUND_ERROR_NONE, false},
	    {{0.01, NAN, 0.2, 0.1}, NAN, POUND_ERROR_INTEGRATION, false},
	    {{0.01, 0.01, 0.01, 0.04}, 0.01, POUND_ERROR_FAILED_ROWS, false},
	    {{0.05, 0.05, 0.04, 0.04}, 0.05, POUND_ERROR_NONE, false},
	    {{NAN, NAN, NAN, 0}, NAN, POUND_ERROR_NONE, false},
	};
	for (size_t k = 0; k < sizeof cases / sizeof cases[0]; k++) {
		assert_int_equal(pound_accuracy_dominant(cases[k].errors, cases[k].low), cases[k].wanted);
		assert_int_equal(pound_accuracy_undecided(cases[k].errors, cases[k].low), cases[k].undecided);
	}
	assert_string_equal(pound_error_name(POUND_ERROR_FAILED_ROWS), "failed_rows");
	assert_null(pound_error_name(POUND_ERROR_NONE));
}

/* ---- runs of the engine ---- */

static struct pound_run *run_of(const struct pound_study *study)
{
	struct pound_run *run = pound_run_create(study, 1);
	for (int b = 0; b < pound_run_blocks(run); b++)
		assert_int_equal(pound_run_block(run, b, 0), POUND_OK);
	return run;
}

static const struct pound_result *reduced(struct pound_run *run)
{
	for (int k = 0; k < pound_run_reductions(run); k++)
		assert_int_equal(pound_run_reduce(run, k, 0), POUND_OK);
	return pound_run_result(run);
}

static void checked_runs_agree_and_are_counted_apart(void **state)
{
	(void)state;
	// 2 cells with 50 items of 4 runs each: 8 checked runs are every 25th item
	struct pound_study *study = study_documents_study(study_documents_sensitivity);
	struct pound_run *run = run_of(study);
	const struct pound_result *result = reduced(run);
	for (int c = 0; c < 2; c++)
		for (int o = 0; o < 2; o++) {
			const struct pound_accuracy *accuracy = &result->cells[c].indices[o].accuracy;
			assert_int_equal(accuracy->runs_checked, 8);
			// measured 1e-13: a gap leads to few contacts, which amplify rounding little
			assert_true(accuracy->difference_largest < 1e-9);
			// and the runs differ
			assert_true(accuracy->difference_largest > 0);
		}
	assert_int_equal(result->work.pounding_runs.asked, 400);
	assert_true(result->work.checks.run >= 8);
	pound_run_free(run);
	study_free(study);
}

static void restored_blocks_bring_their_checks(void **state)
{
	(void)state;
	struct pound_study *study = study_documents_study(study_documents_sensitivity);
	struct pound_run *run = run_of(study), *restored = pound_run_create(study, 1);
	for (int b = 0; b < pound_run_blocks(run); b++)
		pound_run_block_restore(restored, b, pound_run_block_values(run, b));
	const struct pound_result *result = reduced(run), *again = reduced(restored);
	for (int c = 0; c < 2; c++)
		for (int o = 0; o < 2; o++) {
			const struct pound_accuracy *p = &result->cells[c].indices[o].accuracy;
			const struct pound_accuracy *q = &again->cells[c].indices[o].accuracy;
			assert_memory_equal(p->inputs, q->inputs, sizeof p->inputs);
			assert_true(p->difference_largest == q->difference_largest);
		}
	pound_run_free(run);
	pound_run_free(restored);
	study_free(study);
}

/* The check run is always exact, so its difference shows the error of a coarse solver. */
static void a_coarse_solver_shows_its_error(void **state)
{
	(void)state;
	char *document =
	    study_documents_with(study_documents_sensitivity, "{\"method\": \"event\", \"tolerance\": 1e-9}",
	                         "{\"method\": \"newmark\", \"step_s\": 0.001}");
	struct pound_study *study = study_documents_study(document);
	struct pound_run *run = run_of(study);
	const struct pound_result *result = reduced(run);
	double median = result->cells[0].indices[1].accuracy.difference_median;
	// a contact of stiffness ratio 100 lasts about 0.02 s, twenty steps
	assert_true(median > 1e-5 && median < 1e-1);
	pound_run_free(run);
	study_free(study);
	free(document);
}

CHECK_MAIN(cmocka_unit_test(differences_of_runs_come_out_relative_and_as_a_variance),
           cmocka_unit_test(runs_that_agree_move_no_index),
           cmocka_unit_test(indices_move_no_more_than_stated_when_noise_is_added),
           cmocka_unit_test(half_widths_fall_with_the_root_of_the_rows),
           cmocka_unit_test(sobol_points_need_fewer_rows_if_it_shows),
           cmocka_unit_test(half_widths_of_all_rows_are_those_of_the_indices),
           cmocka_unit_test(noise_of_few_signals_is_an_error_in_the_intervals),
           cmocka_unit_test(few_rows_and_constant_outputs_have_no_slope),
           cmocka_unit_test(noise_adds_no_more_to_an_interval_than_there_is),
           cmocka_unit_test(the_dominant_error_is_larger_than_the_others_together),
           cmocka_unit_test(checked_runs_agree_and_are_counted_apart),
           cmocka_unit_test(restored_blocks_bring_their_checks),
           cmocka_unit_test(a_coarse_solver_shows_its_error))
