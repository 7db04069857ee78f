/* unit_index_columns.c - every index column of one output: its estimator, its substitute, and its notes; from sample
 * values, and through a whole study into its result. */
#include "engine/indices/indices.h"
#include "schema/json/json_pointer.h"
#include "schema/result/result_json.h"
#include "schema/study/study_json.h"
#include "tests/support/check.h"
#include "tests/support/functions.h"
#include "tests/support/scenes.h"
#include "tests/support/study_documents.h"

#include <math.h>
#include <string.h>

enum { D = FUNCTION_INPUTS, SAMPLES = D + 2, SEED = 3 };

struct indices {
	struct pound_indices of;
	struct pound_estimate estimates[POUND_N_INDICES][POUND_INPUTS_MAX];
	struct pound_estimate named[POUND_N_NAMED][POUND_INPUTS_MAX];
	struct pound_curve curves[POUND_INPUTS_MAX];
	int dropped;
};

static struct indices *indices_of(const struct pound_sample_values *values, struct pound_sampling sampling)
{
	struct indices *result = calloc(1, sizeof *result);
	size_t n = pound_index_columns_scratch(values, &sampling);
	double *scratch = malloc(sizeof *scratch * n);
	for (int k = 0; k < POUND_N_INDICES; k++)
		result->of.index[k] = result->estimates[k];
	result->of.curves = result->curves;
	for (int k = 0; k < POUND_N_NAMED; k++)
		result->of.named[k] = result->named[k];
	result->dropped = pound_index_columns_indices(values, &sampling, SEED, scratch, &result->of);
	free(scratch);
	return result;
}

static struct indices *function_indices(const char *name, int n_rows, struct function_noise noise,
                                        bool random)
{
	struct pound_sample_values values = function_values(function_named(name), n_rows, 7, noise);
	double *u = function_design(n_rows, 7);
	struct indices *got = indices_of(
	    &values, (struct pound_sampling){.u = u, .random = random, .fresh_signals = !noise.common});
	free(u);
	function_values_free(&values);
	return got;
}

static void check_same(const struct indices *got, enum pound_index p, enum pound_index q)
{
	assert_memory_equal(got->estimates[p], got->estimates[q], sizeof(struct pound_estimate) * D);
}

static double width(struct pound_estimate estimate)
{
	return estimate.high - estimate.low;
}

static void every_column_comes_from_its_function(void **state)
{
	(void)state;
	enum { N = 200 };
	struct pound_sample_values values =
	    function_values(function_named("cusp"), N, 7, (struct function_noise){5, 1.0, true});
	double *u = function_design(N, 7);
	struct indices *got = indices_of(&values, (struct pound_sampling){.u = u, .random = true});
	struct pound_rows rows;
	struct pound_pick_freeze pick_freeze;
	struct pound_estimate local[D], first[D], total[D];
	struct pound_closed_results closed;
	struct pound_curve curves[D];
	double *held = malloc(sizeof *held * pound_rows_scratch(&values));
	double *scratch = malloc(sizeof *scratch * pound_index_columns_scratch(&values, 0));
	pound_rows_init(&rows, &values, held);
	pound_noise_correction_estimates(&rows, (struct pound_resampling){SEED, POUND_RESAMPLES}, scratch,
	                                 &pick_freeze);
	pound_local_regression_first(&rows, u, POUND_NOISE_REMOVED, scratch, local);
	pound_chaos_expansion_indices(&rows, &(struct pound_sampling){.u = u}, POUND_NOISE_REMOVED, scratch,
	                              &closed, curves);
	for (int j = 0; j < D; j++) {
		first[j] = width(local[j]) < width(closed.first[j]) ? local[j] : closed.first[j];
		// upper ends for skewed squared differences
		const struct pound_upper *upper = &pick_freeze.total_upper[j];
		struct pound_estimate plain = pick_freeze.total[j], smooth = closed.total[j];
		plain.high = fmax(plain.high, plain.value + 0.5 * width(plain) * upper->widening);
		smooth.high = fmax(smooth.high, smooth.value + closed.total_error[j] * upper->errors);
		total[j] = width(plain) < width(smooth) ? plain : smooth;
	}
	const struct {
		enum pound_index index;
		const struct pound_estimate *want;
	} columns[POUND_N_INDICES] = {{POUND_S1, first},
	                              {POUND_ST, total},
	                              {POUND_S1_PICK_FREEZE, pick_freeze.first},
	                              {POUND_ST_PICK_FREEZE, pick_freeze.total},
	                              {POUND_S1_RAW, pick_freeze.first_raw},
	                              {POUND_ST_RAW, pick_freeze.total_raw},
	                              {POUND_S2_EXCITATION, pick_freeze.with_signal},
	                              {POUND_SHAPLEY, closed.shapley}};
	for (int k = 0; k < POUND_N_INDICES; k++)
		assert_memory_equal(got->estimates[columns[k].index], columns[k].want, sizeof local);
	assert_memory_equal(&got->of.share[POUND_SHARE_TOTAL], &pick_freeze.signal_total, sizeof local[0]);
	assert_memory_equal(&got->of.share[POUND_SHARE_TOTAL_ONE], &pick_freeze.signal_total_one,
	                    sizeof local[0]);
	assert_memory_equal(&got->of.share[POUND_SHARE_FIRST_ONE], &pick_freeze.signal_first, sizeof local[0]);
	assert_memory_equal(got->curves, curves, sizeof curves);
	check_near(got->of.noise_share, pick_freeze.signal_total.value, 1e-14);
	assert_int_equal(got->of.notes, 0);
	free(got), free(u), free(held), free(scratch);
	function_values_free(&values);
}

static void raw_indices_are_the_golden_ones_of_the_plain_protocol(void **state)
{
	(void)state;
	// statistics_golden.json, estimators_d2_n6: A, B, AB1, AB2 of each row
	static const double y[6 * 4] = {3.3,  3.13, 3.25, 3.65, 1.96, 2.68, 2.88, 2.3,  3.75, 2.98, 3.6,  3.27,
	                                3.94, 2.15, 2.62, 2.7,  1.05, 3.88, 2.65, 3.08, 1.7,  3.78, 2.26, 2.66};
	static const double u[6 * 2 * 2] = {.1, .2, .3, .4, .5, .6, .7, .8, .9, .15, .25, .35,
	                                    .1, .9, .2, .8, .3, .7, .4, .6, .5, .55, .45, .65};
	double one[6 * 4];
	for (int k = 0; k < 6 * 4; k++)
		one[k] = 1;
	struct pound_sample_values values = {
	    .n_rows = 6, .n_inputs = 2, .n_signals = 1, .numerator = y, .denominator = one};
	struct indices *got = indices_of(&values, (struct pound_sampling){.u = u, .random = true});
	check_near(got->estimates[POUND_S1_RAW][0].value, 0.572576783750673, 1e-12);
	check_near(got->estimates[POUND_S1_RAW][1].value, 0.755503894911683, 1e-12);
	check_near(got->estimates[POUND_ST_RAW][0].value, 0.880662387875659, 1e-12);
	check_near(got->estimates[POUND_ST_RAW][1].value, 1.13121640616328, 2e-12);
	assert_int_equal(got->of.notes, 1 << POUND_NOTE_SHARED_SIGNAL | 1 << POUND_NOTE_NOISE_INSIDE |
	                                    1 << POUND_NOTE_NO_NEIGHBORS);
	free(got);
}

static void a_signal_of_each_sample_s_own_leaves_the_raw_indices_and_differs_from_no_randomness(void **state)
{
	(void)state;
	for (int random = 0; random < 2; random++) {
		struct indices *got = function_indices("cusp", 100, (struct function_noise){1, 0.0, !random}, random);
		check_same(got, POUND_S1_PICK_FREEZE, POUND_S1_RAW);
		check_same(got, POUND_ST_PICK_FREEZE, POUND_ST_RAW);
		for (int j = 0; j < D; j++) {
			assert_true(isfinite(got->estimates[POUND_S1][j].high) &&
			            isfinite(got->estimates[POUND_ST][j].low));
			assert_true(isnan(got->estimates[POUND_S2_EXCITATION][j].value));
		}
		assert_true(isnan(got->of.share[POUND_SHARE_TOTAL].value));
		assert_int_equal(got->of.notes, 1 << (random ? POUND_NOTE_ONE_SIGNAL : POUND_NOTE_NOT_RANDOM));
		free(got);
	}
}

static void fresh_signals_hide_the_indices_of_the_excitation_that_need_shared_ones(void **state)
{
	(void)state;
	struct indices *got = function_indices("cusp", 100, (struct function_noise){5, 1.0, false}, true);
	assert_true(isnan(got->estimates[POUND_S2_EXCITATION][0].value));
	assert_true(isnan(got->of.share[POUND_SHARE_FIRST_ONE].high));
	// half of the variance of single runs, known to some 10 % with 100 rows
	check_near(got->of.share[POUND_SHARE_TOTAL_ONE].value, 0.5, 4 * 0.05);
	assert_int_equal(got->of.notes, 1 << POUND_NOTE_FRESH_SIGNALS);
	free(got);
}

static void with_few_rows_the_corrected_indices_stand_in(void **state)
{
	(void)state;
	static const int rows[] = {4, POUND_ROWS_MIN - 1, POUND_ROWS_MIN};
	for (int k = 0; k < 3; k++) {
		struct indices *got = function_indices("cusp", rows[k], (struct function_noise){5, 0.1, true}, true);
		bool few = rows[k] < POUND_ROWS_MIN;
		assert_int_equal(got->of.notes, few ? 1 << POUND_NOTE_FEW_ROWS : 0);
		bool first = true, total = true;
		for (int j = 0; j < D; j++) {
			first &= got->estimates[POUND_S1][j].value == got->estimates[POUND_S1_PICK_FREEZE][j].value;
			total &= got->estimates[POUND_ST][j].value == got->estimates[POUND_ST_PICK_FREEZE][j].value;
			assert_int_equal(few, isnan(got->estimates[POUND_SHAPLEY][j].value));
		}
		assert_true(first == few && total == few);
		free(got);
	}
}

static void what_is_lost_in_noise_is_undefined_and_only_the_raw_indices_are_left(void **state)
{
	(void)state;
	// the outputs differ almost only by their signals
	enum { N = 40 };
	double numerator[N * SAMPLES * 2], one[N * SAMPLES * 2];
	for (int i = 0; i < N; i++)
		for (int k = 0; k < SAMPLES * 2; k++) {
			numerator[i * SAMPLES * 2 + k] = (k % 2 ? 1 : -1) + 1e-3 * ((i * 7 + k) % 5);
			one[i * SAMPLES * 2 + k] = 1;
		}
	struct pound_sample_values values = {
	    .n_rows = N, .n_inputs = D, .n_signals = 2, .numerator = numerator, .denominator = one};
	double *u = function_design(N, 7);
	struct indices *got = indices_of(&values, (struct pound_sampling){.u = u, .random = true});
	assert_int_equal(got->of.notes, 1 << POUND_NOTE_NOISE);
	for (int j = 0; j < D; j++) {
		assert_true(isfinite(got->estimates[POUND_ST_RAW][j].value));
		assert_true(isnan(got->estimates[POUND_ST_PICK_FREEZE][j].value));
		assert_true(isnan(got->estimates[POUND_S1][j].value) && isnan(got->estimates[POUND_ST][j].value));
	}
	free(got), free(u);
}

static void nothing_is_defined_where_nothing_varies_or_nothing_is_left(void **state)
{
	(void)state;
	enum { N = 8 };
	static const enum pound_note notes[] = {POUND_NOTE_CONSTANT, POUND_NOTE_ONE_ROW, POUND_NOTE_NO_ROWS};
	static const int kept[] = {N, 1, 0};
	double *u = function_design(N, 7), numerator[N * SAMPLES * 3], denominator[N * SAMPLES * 3];
	for (int k = 0; k < 3; k++) {
		for (int i = 0; i < N * SAMPLES * 3; i++) {
			denominator[i] = 0.1 + 0.7 * (i % 17);
			numerator[i] = i < kept[k] * SAMPLES * 3 ? 1.1 * denominator[i] : NAN; // 1.1 except for rounding
		}
		struct pound_sample_values values = {
		    .n_rows = N, .n_inputs = D, .n_signals = 3, .numerator = numerator, .denominator = denominator};
		struct indices *got = indices_of(&values, (struct pound_sampling){.u = u, .random = true});
		assert_int_equal(got->of.notes, 1 << notes[k]);
		assert_int_equal(got->dropped, N - kept[k]);
		for (int c = 0; c < POUND_N_INDICES; c++)
			for (int j = 0; j < D; j++)
				assert_true(isnan(got->estimates[c][j].value) && isnan(got->estimates[c][j].low));
		for (int c = 0; c < POUND_N_SHARES; c++)
			assert_true(isnan(got->of.share[c].value));
		free(got);
	}
	free(u);
}

/* If one sample differs from all others, the interval of a total has zero width, and a note says not to rely on it;
 * with ten such rows there is no note. */
static void an_output_that_few_rows_decide_is_noted(void **state)
{
	(void)state;
	enum { N = 100 };
	double *u = function_design(N, 7), numerator[N * SAMPLES], denominator[N * SAMPLES];
	for (int rare = 1; rare <= 10; rare += 9) {
		for (int i = 0; i < N * SAMPLES; i++) {
			denominator[i] = 1;
			numerator[i] = i % SAMPLES == 2 && i / SAMPLES < rare ? 1 : 0;
		}
		struct pound_sample_values values = {
		    .n_rows = N, .n_inputs = D, .n_signals = 1, .numerator = numerator, .denominator = denominator};
		struct indices *got = indices_of(&values, (struct pound_sampling){.u = u});
		const int few = rare == 1 ? 1 << POUND_NOTE_FEW_DECIDE : 0;
		assert_int_equal(got->of.notes, 1 << POUND_NOTE_NOT_RANDOM | few);
		free(got);
	}
	free(u);
}

/* A product of Pareto variables, where one row in a hundred has nearly all of the variance: if the polynomial misses
 * it, its totals are far from [0, 1]; pick-freeze totals are never below 0, and are reported there. */
static void a_total_that_few_rows_decide_is_a_share(void **state)
{
	(void)state;
	enum { N = 100, DESIGNS = 20 };
	static const double alpha[D] = {2.5, 3, 4, 6};
	double numerator[N * SAMPLES], denominator[N * SAMPLES];
	for (int seed = 0; seed < DESIGNS; seed++) {
		double *u = function_design(N, (uint64_t)seed);
		for (int i = 0; i < N * SAMPLES; i++) {
			const int sample = i % SAMPLES;
			numerator[i] = denominator[i] = 1;
			for (int j = 0; j < D; j++) {
				const int from_b = sample == 1 || sample == 2 + j;
				numerator[i] *= pow(u[(2 * (i / SAMPLES) + from_b) * D + j], -1 / alpha[j]);
			}
		}
		struct pound_sample_values values = {
		    .n_rows = N, .n_inputs = D, .n_signals = 1, .numerator = numerator, .denominator = denominator};
		struct indices *got = indices_of(&values, (struct pound_sampling){.u = u});
		for (int j = 0; j < D; j++) {
			const struct pound_estimate *e = &got->estimates[POUND_ST][j];
			assert_true(e->low <= e->value && e->value <= e->high);
			const double plain = got->estimates[POUND_ST_RAW][j].value;
			if (got->of.notes >> POUND_NOTE_FEW_DECIDE & 1 && plain <= 1.0)
				assert_true(-0.02 <= e->value && e->value <= 1.02);
		}
		free(got), free(u);
	}
}

/* ---- whole studies ---- */

/* The result of a study as a server with n_workers would reduce it, with alternating workers. */
static char *result_of(const struct pound_study *study, int n_workers, struct pound_run **run)
{
	static const struct timing timing = {0, 0, 1};
	size_t length;
	*run = pound_run_create(study, n_workers);
	for (int b = pound_run_blocks(*run) - 1; b >= 0; b--)
		assert_int_equal(pound_run_block(*run, b, b % n_workers), POUND_OK);
	for (int k = 0; k < pound_run_reductions(*run); k++)
		assert_int_equal(pound_run_reduce(*run, k, k % n_workers), POUND_OK);
	return result_to_json(study, pound_run_result(*run), &timing, &length);
}

/* Mean outputs of a study's samples as sample values of one signal. */
static struct pound_sample_values means_of(const struct pound_study *study, const struct pound_run *run,
                                           int cell, int output)
{
	const int d = study->n_inputs, n = study->design.rows * (d + 2);
	double *numerator = malloc(2 * sizeof *numerator * (size_t)n), *denominator = numerator + n;
	for (int k = 0; k < n; k++) {
		numerator[k] = pound_run_sample_output(run, cell, k / (d + 2), k % (d + 2), output).mean;
		denominator[k] = 1;
	}
	return (struct pound_sample_values){.n_rows = study->design.rows,
	                                    .n_inputs = d,
	                                    .n_signals = 1,
	                                    .numerator = numerator,
	                                    .denominator = denominator};
}

static void check_column(const struct reading *r, const char *at, enum pound_index index, const char *name,
                         const struct indices *want, int n_inputs)
{
	static const char *const ends[] = {"", "_low", "_high"};
	for (int j = 0; j < n_inputs; j++) {
		const struct pound_estimate *e = &want->estimates[index][j];
		const double numbers[] = {e->value, e->low, e->high};
		for (int k = 0; k < 3; k++) {
			double got = reading_number(r, "%s/inputs/%d/%s%s", at, j, name, ends[k]);
			// a ratio of sums of five numbers, rounded once more
			check_near(got, numbers[k], 1e-9);
		}
	}
}

static void a_study_s_result_holds_what_its_samples_give(void **state)
{
	(void)state;
	static const char record[] = "{\"type\": \"harmonic\", \"frequency_hz\": 2.5, \"duration_s\": 4, "
	                             "\"time_step_s\": 0.01, \"peak_m_s2\": 1}";
	static const char form[] =
	    "{\"kind\": \"sensitivity\", \"scene\": {\"oscillators\": [{\"frequency_hz\": 2}, {\"frequency_hz\": "
	    "3}], \"excitation\": %s}, \"inputs\": [{\"path\": \"/oscillators/1/frequency_hz\", "
	    "\"distribution\": "
	    "{\"type\": \"uniform\", \"min\": 1, \"max\": 5}}, {\"path\": \"/contact/restitution\", "
	    "\"distribution\": {\"type\": \"uniform\", \"min\": 0.1, \"max\": 1}}], \"design\": {\"rows\": 60, "
	    "\"seed\": 3}, \"outputs\": [\"impulse\"]}";
	static const char noise[] = "{\"type\": \"kanai_tajimi\", \"cycles\": 5, \"signals\": 5}";
	static const char at[] = "/cells/0/outputs/0";
	for (int random = 0; random < 2; random++) {
		char document[1024];
		snprintf(document, sizeof document, form, random ? noise : record);
		struct pound_study *study = study_documents_study(document);
		struct pound_run *run, *other;
		char *json = result_of(study, 1, &run);
		struct reading *r = reading_open(json, strlen(json));
		struct pound_sample_values values = means_of(study, run, 0, 0);
		double u[60 * 2 * 2];
		for (int i = 0; i < 60 * 2; i++) {
			double x[2];
			pound_run_sample_inputs(run, i / 2, i % 2, x);
			u[2 * i] = (x[0] - 1) / 4, u[2 * i + 1] = (x[1] - 0.1) / 0.9;
		}
		struct indices *want =
		    indices_of(&values, (struct pound_sampling){.u = u, .random = random, .fresh_signals = true});
		for (int c = 0; c < POUND_N_INDICES; c++)
			for (int j = 0; j < 2; j++)
				assert_true(c == POUND_S2_EXCITATION || isfinite(want->estimates[c][j].value));
		check_column(r, at, POUND_S1_RAW, "S1_raw", want, 2);
		check_column(r, at, POUND_ST_RAW, "ST_raw", want, 2);
		if (!random) {
			check_column(r, at, POUND_S1_PICK_FREEZE, "S1_pick_freeze", want, 2);
			check_column(r, at, POUND_S1, "S1", want, 2);
			check_column(r, at, POUND_ST, "ST", want, 2);
			assert_non_null(strstr(reading_text(r, "%s/note", at), "not random"));
			assert_true(isnan(reading_number(r, "%s/excitation/ST_one_signal", at)));
		} else {
			check_near(reading_number(r, "%s/excitation/ST_mean_of_signals", at),
			           reading_number(r, "%s/noise_share", at), 1e-12);
			assert_true(reading_number(r, "%s/excitation/ST_one_signal", at) >
			            reading_number(r, "%s/noise_share", at));
			assert_false(reading_has(r, "%s/note", at));
		}
		for (int n_workers = 2; n_workers <= 4; n_workers += 2) {
			char *again = result_of(study, n_workers, &other);
			assert_string_equal(again, json);
			free(again);
			pound_run_free(other);
		}
		free(want), free((double *)values.numerator), free(json);
		reading_close(r);
		pound_run_free(run);
		study_free(study);
	}
}

static void check_zero(struct pound_estimate estimate)
{
	check_near(estimate.value, 0.0, 0.0);
	check_near(estimate.low, 0.0, 0.0);
	check_near(estimate.high, 0.0, 0.0);
}

static void an_input_of_one_value_explains_exactly_nothing(void **state)
{
	(void)state;
	static const double one_value[] = {3};
	struct pound_input inputs[D] = {{.distribution = {.p = {0, 1}}},
	                                {.distribution = {.p = {0, 1}}},
	                                {.distribution = {.p = {0, 1}}},
	                                {.distribution = {.p = {0, 1}}}};
	while (!pound_distribution_lists_values(inputs[3].distribution.type))
		inputs[3].distribution.type++;
	inputs[3].distribution.n_values = 1;
	inputs[3].distribution.values = one_value;
	// the fourth input of this function has no effect; with independent signals its samples differ nevertheless
	for (int common = 0; common < 2; common++)
		for (int n = 20; n <= 200; n += 180) {
			struct pound_sample_values values =
			    function_values(function_named("ishigami"), n, 7, (struct function_noise){5, 0.5, common});
			values.inputs = inputs;
			double *u = function_design(n, 7);
			struct indices *got = indices_of(
			    &values, (struct pound_sampling){.u = u, .random = true, .fresh_signals = !common});
			check_zero(got->estimates[POUND_S1][3]);
			check_zero(got->estimates[POUND_ST][3]);
			for (int j = 0; j < 3 && n == 200; j++)
				assert_true(width(got->estimates[POUND_ST][j]) > 0.0);
			double sum = 0.0;
			for (int j = 0; j < D && n == 200; j++)
				sum += got->estimates[POUND_SHAPLEY][j].value;
			if (n == 200) {
				check_zero(got->estimates[POUND_SHAPLEY][3]);
				check_near(sum, 1.0, 1e-12);
			}
			for (int k = 0; k < got->of.sets.n_second; k++)
				if (got->of.sets.second[k].inputs >> 3 & 1)
					check_zero(got->of.sets.second[k].estimate);
			free(got), free(u);
			function_values_free(&values);
		}
}

/* Sobol' points in 8 scrambles; in one of them no variance remains besides the noise of two signals. */
static void an_index_without_an_interval_is_noted(void **state)
{
	(void)state;
	static const char study[] =
	    "{\"kind\": \"sensitivity\", \"scene\": {\"oscillators\": [{\"frequency_hz\": 0.5}, "
	    "{\"frequency_hz\": "
	    "2}], \"excitation\": {\"type\": \"kanai_tajimi\", \"cycles\": 10, \"signals\": 2}}, \"inputs\": ["
	    "{\"path\": \"/excitation/frequency_hz\", \"distribution\": {\"type\": \"uniform\", \"min\": 0.5, "
	    "\"max\": 5}}, {\"path\": \"/oscillators/1/frequency_hz\", \"distribution\": {\"type\": \"uniform\", "
	    "\"min\": 0.5, \"max\": 5}}, {\"path\": \"/oscillators/1/mass_kg\", \"distribution\": {\"type\": "
	    "\"reciprocal_uniform\", \"max\": 6}}, {\"path\": \"/contact/restitution\", \"distribution\": "
	    "{\"type\": \"uniform\", \"min\": 0, \"max\": 1}}], \"design\": {\"method\": \"sobol\", \"rows\": "
	    "128, "
	    "\"signals\": \"common\", \"seed\": 2}, \"outputs\": [\"force_amplification\", \"impulse\"]}";
	struct pound_study *read = study_documents_study(study);
	struct pound_run *run = specimen_run(read);
	for (int o = 0; o < 2; o++) {
		const struct pound_indices *indices = &pound_run_result(run)->cells[0].indices[o];
		bool lacks = false;
		for (int j = 0; j < 4; j++)
			for (int k = 0; k < 2; k++) {
				const struct pound_estimate *e = &indices->index[k ? POUND_ST : POUND_S1][j];
				lacks |= !isnan(e->value) && isnan(e->high);
			}
		assert_int_equal(lacks, o == 0);
		assert_int_equal(indices->notes >> POUND_NOTE_NO_INTERVAL & 1, lacks);
	}
	pound_run_free(run);
	study_free(read);
}

/* Noise of 20 times the variance, shared by the samples of a row, is no effect of an input without one: its
 * pick-freeze estimate is exactly 0, regression over few rows is not.  With 40 designs an interval of 95 % is above 0
 * in one of them on average, and in more than 4 with a probability of 0.003. */
static void noise_is_no_effect_of_an_input_without_one(void **state)
{
	(void)state;
	enum { N = 80, DESIGNS = 40, INERT = 3 /* ishigami */ };
	int above = 0, most = 0;
	for (int seed = 1; seed <= DESIGNS; seed++) {
		struct pound_sample_values values = function_values(function_named("ishigami"), N, (uint64_t)seed,
		                                                    (struct function_noise){2, 20, true});
		double *u = function_design(N, (uint64_t)seed);
		struct indices *got = indices_of(&values, (struct pound_sampling){.u = u, .random = true});
		above += got->estimates[POUND_S1][INERT].low > 1e-6;
		most += got->estimates[POUND_S1][INERT].low > got->estimates[POUND_ST][INERT].high + 1e-6;
		free(got), free(u);
		function_values_free(&values);
	}
	check_report("of %d designs of an input without effect: S1 above 0 in %d, above ST in %d", DESIGNS, above,
	             most);
	assert_int_equal(most, 0);
	assert_in_range(above, 0, 4);
}

CHECK_MAIN(
    cmocka_unit_test(noise_is_no_effect_of_an_input_without_one),
    cmocka_unit_test(an_index_without_an_interval_is_noted),
    cmocka_unit_test(every_column_comes_from_its_function),
    cmocka_unit_test(raw_indices_are_the_golden_ones_of_the_plain_protocol),
    cmocka_unit_test(a_signal_of_each_sample_s_own_leaves_the_raw_indices_and_differs_from_no_randomness),
    cmocka_unit_test(fresh_signals_hide_the_indices_of_the_excitation_that_need_shared_ones),
    cmocka_unit_test(with_few_rows_the_corrected_indices_stand_in),
    cmocka_unit_test(what_is_lost_in_noise_is_undefined_and_only_the_raw_indices_are_left),
    cmocka_unit_test(nothing_is_defined_where_nothing_varies_or_nothing_is_left),
    cmocka_unit_test(an_output_that_few_rows_decide_is_noted),
    cmocka_unit_test(a_total_that_few_rows_decide_is_a_share),
    cmocka_unit_test(an_input_of_one_value_explains_exactly_nothing),
    cmocka_unit_test(a_study_s_result_holds_what_its_samples_give))
