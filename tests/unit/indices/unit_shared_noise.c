/* unit_shared_noise.c - indices of outputs whose noise is the same in all samples of a row, with one signal: of
 * functions with exact indices in closed form, and of a study of the engine.
 *
 * Inputs x1, x2 and noise z are independent; of four inputs two have no effect.
 *
 *   sum       y = x1 + x2 + z     variances 1, 1, 2:  V(Y) = 4, the mean response x1 + x2 has the variance 2
 *   product   y = x1 z + x2       means 1, 0, 1, variances 1 each:  V(x1 z) = 2 2 - 1 = 3, V(Y) = 4, mean response x1 + x2 */
#include "engine/indices/indices.h"
#include "engine/numeric/random.h"
#include "schema/json/json_pointer.h"
#include "schema/result/result_json.h"
#include "schema/study/study_json.h"
#include "tests/support/check.h"
#include "tests/support/functions.h"
#include "tests/support/scenes.h"
#include "tests/support/study_documents.h"

#include <math.h>
#include <string.h>

enum { D = FUNCTION_INPUTS, SAMPLES = D + 2, ROWS = 300 };

// a uniform number scaled to mean 0 and variance 1
static double standard(double u)
{
	return sqrt(12.0) * (u - 0.5);
}

static double sum(const double *u, double noise)
{
	return standard(u[0]) + standard(u[1]) + M_SQRT2 * noise;
}

static double product(const double *u, double noise)
{
	return (1 + standard(u[0])) * (1 + noise) + standard(u[1]);
}

static const struct model {
	double (*y)(const double *u, double noise);
	double noise;                /* variance of y given all inputs, on average */
	double first[D];             /* V[E(Y|x)] / V(Y) */
	double total[D];             /* E[V(Y|all but x)] / V(Y) */
	double first_given_noise[D]; /* E_z V[E(Y|x, z)|z] / V(Y): pick-freeze under shared noise */
	double total_given_noise[D]; /* E V(Y|all but x, z) / V(Y), likewise */
} models[] = {
    {sum, 2, {.25, .25, 0, 0}, {.75, .75, .5, .5}, {.25, .25, 0, 0}, {.25, .25, 0, 0}},
    {product, 2, {.25, .25, 0, 0}, {.75, .75, .5, .5}, {.5, .25, 0, 0}, {.5, .25, 0, 0}},
};

enum { MODELS = sizeof models / sizeof models[0] };

/* The kind of noise, and what is known of it. */
struct noise {
	bool elsewhere; /* outputs come from an external model */
	bool variance;  /* the external model gives the variance of each output */
	bool fresh;     /* each sample has its own noise */
	bool quasi_random;
	int rows;
};

struct indices {
	struct pound_indices of;
	struct pound_estimate estimates[POUND_N_INDICES][POUND_INPUTS_MAX];
};

/* Noise of a sample, uniform with mean 0 and variance 1. */
static double noise_of(uint64_t seed, int row, int sample)
{
	const struct pound_stream stream = {
	    .seed = seed, .what = POUND_STREAM_NOISE, .row = (uint32_t)row, .sample = (uint32_t)sample};
	return standard(pound_random_uniform(stream, 0));
}

static struct indices *indices_of(const struct model *model, struct noise noise, uint64_t seed)
{
	const int n = noise.rows * SAMPLES;
	double *numerator = malloc(3 * sizeof *numerator * (size_t)n), *one = numerator + n, *variance = one + n;
	double *u = function_design(noise.rows, seed);
	for (int i = 0; i < n; i++) {
		const int row = i / SAMPLES, sample = i % SAMPLES;
		double x[D];
		for (int j = 0; j < D; j++)
			x[j] = u[(row * 2 + (pound_order_mask(D, sample) >> j & 1)) * D + j];
		numerator[i] = model->y(x, noise_of(seed, row, noise.fresh ? sample : 0));
		one[i] = 1;
		variance[i] = !noise.variance ? NAN : model->y == sum ? 2 : pow(1 + standard(x[0]), 2);
	}
	const struct pound_sample_values values = {.n_rows = noise.rows,
	                                           .n_inputs = D,
	                                           .n_signals = 1,
	                                           .numerator = numerator,
	                                           .denominator = noise.elsewhere ? NULL : one,
	                                           .variance = noise.elsewhere ? variance : NULL};
	const struct pound_sampling sampling = {.u = u,
	                                        .random = !noise.elsewhere || noise.variance,
	                                        .fresh_signals = noise.fresh,
	                                        .quasi_random = noise.quasi_random,
	                                        .n_resamples = 8}; // few suffice: no test uses their intervals
	struct indices *result = calloc(1, sizeof *result);
	double *scratch = malloc(sizeof *scratch * pound_index_columns_scratch(&values, &sampling));
	for (int k = 0; k < POUND_N_INDICES; k++)
		result->of.index[k] = result->estimates[k];
	pound_index_columns_indices(&values, &sampling, seed, scratch, &result->of);
	free(scratch), free(numerator), free(u);
	return result;
}

/* ---- over many designs ---- */

/* Estimates of an index for every input, from many designs. */
struct score {
	int n;
	double sum[D], squares[D]; /* of the errors */
	double half[D];
	int covered[D];
};

static void score_add(struct score *score, const struct pound_estimate *estimate, const double *exact)
{
	score->n++;
	for (int j = 0; j < D; j++) {
		const double error = estimate[j].value - exact[j];
		score->sum[j] += error;
		score->squares[j] += error * error;
		score->half[j] += 0.5 * (estimate[j].high - estimate[j].low);
		score->covered[j] += estimate[j].low <= exact[j] && exact[j] <= estimate[j].high;
	}
}

/* The mean error is 0 within 4 standard errors and a bias: products of two rows' outputs about the mean of all n rows
 * are too small by V(Y)/n, and their ratio to a variance estimated from the same rows has a bias of the same size.
 * Intervals of 95 % are too narrow if fewer than 0.95 n - 3.1 (0.95 0.05 n)^1/2 of n designs contain the exact index,
 * which happens by chance one time in a thousand.  Intervals from neighbors may be too wide by a factor of up to two:
 * the noise of a row and of its neighbors counts twice, and the extrapolation to distance zero is included.
 *
 * Given    share    reference variance of the indices, as a fraction of V(Y) */
static void score_check(const struct score *score, double share)
{
	const double n = score->n;
	for (int j = 0; j < D; j++) {
		const double mean = score->sum[j] / n, deviation = sqrt(score->squares[j] / n - mean * mean);
		check_near(mean, 0, 4 * deviation / sqrt(n) + 2 / share / ROWS);
		assert_true(score->covered[j] >= 0.95 * n - 3.1 * sqrt(0.95 * 0.05 * n));
		assert_true(score->half[j] / n < 2 * 1.96 * deviation);
	}
}

static void S1_is_a_share_of_the_variance_with_the_noise_in_it(void **state)
{
	(void)state;
	enum { SEEDS = 100 };
	for (int m = 0; m < MODELS; m++) {
		struct score score = {0};
		for (uint64_t seed = 0; seed < SEEDS; seed++) {
			// outputs of the engine, and of an external model
			struct indices *got = indices_of(&models[m], (struct noise){.elsewhere = m, .rows = ROWS}, seed);
			score_add(&score, got->estimates[POUND_S1], models[m].first);
			free(got);
		}
		score_check(&score, 1);
	}
}

static void S1_is_one_of_the_mean_response_where_the_variance_of_the_noise_is_known(void **state)
{
	(void)state;
	enum { SEEDS = 100 };
	for (int m = 0; m < MODELS; m++) {
		struct score score = {0};
		double exact[D];
		for (int j = 0; j < D; j++)
			exact[j] = models[m].first[j] * 4 / (4 - models[m].noise);
		for (uint64_t seed = 0; seed < SEEDS; seed++) {
			struct indices *got = indices_of(
			    &models[m], (struct noise){.elsewhere = true, .variance = true, .rows = ROWS}, seed);
			score_add(&score, got->estimates[POUND_S1], exact);
			free(got);
		}
		score_check(&score, 1 - models[m].noise / 4);
	}
}

/* Checks the mean error of an index over many designs. */
static void check_mean(const struct score *score)
{
	for (int j = 0; j < D; j++) {
		const double n = score->n, mean = score->sum[j] / n;
		check_near(mean, 0, 4 * sqrt((score->squares[j] / n - mean * mean) / n) + 2. / ROWS);
	}
}

/* What each column estimates: raw columns the indices given the shared noise; with independent noise all are indices of y. */
static void every_column_estimates_what_its_name_says_or_is_null(void **state)
{
	(void)state;
	enum { SEEDS = 40 };
	static const enum pound_index columns[] = {POUND_S1,     POUND_S1_PICK_FREEZE, POUND_S1_RAW,
	                                           POUND_ST,     POUND_ST_PICK_FREEZE, POUND_ST_RAW,
	                                           POUND_SHAPLEY};
	for (int m = 0; m < MODELS; m++)
		for (int fresh = 0; fresh < 2; fresh++) {
			struct score scores[sizeof columns / sizeof columns[0]] = {{0}};
			for (uint64_t seed = 0; seed < SEEDS; seed++) {
				struct indices *got =
				    indices_of(&models[m], (struct noise){.fresh = fresh, .rows = ROWS}, seed);
				for (int k = 0; k < 7; k++) {
					const bool first = k < 3, raw = columns[k] == POUND_S1_RAW || columns[k] == POUND_ST_RAW;
					const double *exact = first ? models[m].first : models[m].total;
					if (raw && !fresh)
						exact = first ? models[m].first_given_noise : models[m].total_given_noise;
					const struct pound_estimate *e = got->estimates[columns[k]];
					if (fresh || raw || columns[k] == POUND_S1)
						score_add(&scores[k], e, exact);
					else
						for (int j = 0; j < D; j++)
							assert_true(isnan(e[j].value) && isnan(e[j].low) && isnan(e[j].high));
				}
				for (int k = 0; k < got->of.sets.n_closed; k++)
					assert_int_equal(isnan(got->of.sets.closed[k].estimate.value), !fresh);
				for (int k = 0; k < got->of.sets.n_second; k++)
					assert_int_equal(isnan(got->of.sets.second[k].estimate.value), !fresh);
				free(got);
			}
			for (int k = 0; k < 6; k++)
				if (scores[k].n)
					check_mean(&scores[k]);
		}
}

/* ---- notes ---- */

static void a_note_says_which_indices_shared_noise_leaves(void **state)
{
	(void)state;
	enum {
		SIGNAL = 1 << POUND_NOTE_SHARED_SIGNAL,
		NOISE = 1 << POUND_NOTE_SHARED_NOISE,
		INSIDE = 1 << POUND_NOTE_NOISE_INSIDE,
		NONE = 1 << POUND_NOTE_NO_NEIGHBORS
	};
	static const struct {
		struct noise noise;
		unsigned notes;
		bool first, total; /* S1, ST have values */
	} cases[] = {
	    {{.rows = ROWS}, SIGNAL | INSIDE, true, false},
	    {{.rows = POUND_ROWS_MIN}, SIGNAL | INSIDE, true, false},
	    {{.rows = POUND_ROWS_MIN - 1}, SIGNAL | INSIDE | NONE, false, false},
	    {{.quasi_random = true, .rows = ROWS}, SIGNAL | INSIDE | NONE, false, false},
	    {{.fresh = true, .rows = ROWS}, 1 << POUND_NOTE_ONE_SIGNAL, true, true},
	    {{.elsewhere = true, .rows = ROWS}, NOISE | INSIDE, true, false},
	    {{.elsewhere = true, .variance = true, .rows = ROWS}, NOISE, true, false},
	    {{.elsewhere = true, .fresh = true, .rows = ROWS}, 1 << POUND_NOTE_NO_VARIANCE, true, true},
	    {{.elsewhere = true, .fresh = true, .variance = true, .rows = ROWS}, 0, true, true},
	};
	for (size_t k = 0; k < sizeof cases / sizeof cases[0]; k++) {
		struct indices *got = indices_of(&models[0], cases[k].noise, 1);
		assert_int_equal(got->of.notes, cases[k].notes);
		for (int j = 0; j < D; j++) {
			assert_int_equal(!isnan(got->estimates[POUND_S1][j].value), cases[k].first);
			assert_int_equal(!isnan(got->estimates[POUND_ST][j].value), cases[k].total);
			assert_true(isfinite(got->estimates[POUND_S1_RAW][j].high));
			assert_true(isfinite(got->estimates[POUND_ST_RAW][j].high));
		}
		free(got);
	}
}

/* ---- a study of the engine ---- */

static struct reading *study_with(const char *signals, int n_signals)
{
	static const char form[] =
	    "{\"kind\": \"sensitivity\", \"scene\": {\"oscillators\": [{\"frequency_hz\": 2}, {\"frequency_hz\": "
	    "3.1}], \"contact\": {\"restitution\": 0.6}, \"excitation\": {\"type\": \"kanai_tajimi\", "
	    "\"frequency_hz\": 2.5, \"signals\": %d}}, \"inputs\": [{\"path\": \"/oscillators/0/frequency_hz\", "
	    "\"name\": \"f_1\", \"distribution\": {\"type\": \"uniform\", \"min\": 0.5, \"max\": 5}}, {\"path\": "
	    "\"/contact/restitution\", \"distribution\": {\"type\": \"uniform\", \"min\": 0, \"max\": 1}}], "
	    "\"design\": {\"rows\": 400, \"seed\": 1, \"signals\": \"%s\"}, \"outputs\": "
	    "[\"force_amplification\"]}";
	char document[1024];
	snprintf(document, sizeof document, form, n_signals, signals);
	struct pound_study *study = study_documents_study(document);
	struct pound_run *run = specimen_run(study);
	static const struct timing timing = {0, 0, 1};
	size_t length;
	char *json = result_to_json(study, pound_run_result(run), &timing, &length);
	struct reading *r = reading_open(json, length);
	free(json);
	pound_run_free(run);
	study_free(study);
	return r;
}

/* S1 from one signal has the same value whether samples share the signal or not, and differs from the raw index,
 * which contains the interaction of the input with the signal. */
static void S1_does_not_depend_on_whether_samples_share_their_signal(void **state)
{
	(void)state;
	static const char at[] = "/cells/0/outputs/0/inputs/0";
	struct reading *common = study_with("common", 1), *independent = study_with("independent", 1);
	const double p = reading_number(common, "%s/S1", at), q = reading_number(independent, "%s/S1", at);
	const double p_half = reading_number(common, "%s/S1_high", at) - p;
	const double q_half = reading_number(independent, "%s/S1_high", at) - q;
	check_near(p, q, sqrt(p_half * p_half + q_half * q_half));
	assert_true(reading_number(common, "%s/S1_raw_low", at) > p + p_half);
	assert_true(reading_has(common, "%s/ST", at) && isnan(reading_number(common, "%s/ST", at)));
	assert_true(isfinite(reading_number(independent, "%s/ST", at)));
	assert_true(isfinite(reading_number(common, "/cells/0/outputs/0/accuracy/slope")));
	assert_true(isfinite(reading_number(common, "/cells/0/outputs/0/accuracy/inputs/0/S1_integration")));
	assert_non_null(strstr(reading_text(common, "/cells/0/outputs/0/note"), "use 2 signals or more"));
	reading_close(common), reading_close(independent);
}

static void a_design_does_not_grow_for_a_total_index_that_cannot_be_estimated(void **state)
{
	(void)state;
	static const char until[] = "\"until\": {\"half_width\": 0.1, \"max_runs\": 40000}";
	static const struct {
		const char *signals, *design;
		bool accepted;
	} cases[] = {{"1", "common", false}, {"2", "common", true}, {"1", "independent", true}};
	for (int k = 0; k < 3; k++) {
		char signals[32], design[128];
		snprintf(signals, sizeof signals, "\"signals\": %s}", cases[k].signals);
		snprintf(design, sizeof design, "%s, \"signals\": \"%s\"", until, cases[k].design);
		char *one = study_documents_with(study_documents_sensitivity, "\"signals\": 5}", signals);
		char *two = study_documents_with(one, "\"rows\": 10", until);
		char *document = study_documents_with(two, "\"seed\": 42, \"signals\": \"common\"",
		                                      cases[k].design[0] == 'c' ? "\"signals\": \"common\""
		                                                                : "\"signals\": \"independent\"");
		if (cases[k].accepted)
			study_free(study_documents_study(document));
		else
			study_documents_problem(
			    document, "/design/until",
			    "needs /scene/excitation/signals of 2 or more, or \"independent\" "
			    "/design/signals: ST cannot be estimated from one signal that the samples of a "
			    "row share");
		free(one), free(two), free(document);
	}
}

CHECK_MAIN(cmocka_unit_test(S1_is_a_share_of_the_variance_with_the_noise_in_it),
           cmocka_unit_test(S1_is_one_of_the_mean_response_where_the_variance_of_the_noise_is_known),
           cmocka_unit_test(every_column_estimates_what_its_name_says_or_is_null),
           cmocka_unit_test(a_note_says_which_indices_shared_noise_leaves),
           cmocka_unit_test(S1_does_not_depend_on_whether_samples_share_their_signal),
           cmocka_unit_test(a_design_does_not_grow_for_a_total_index_that_cannot_be_estimated))
