/* unit_closed_indices.c - second-order and closed indices, Shapley effects: golden contrasts, identities, known functions. */
#include "engine/indices/indices.h"
#include "tests/support/check.h"
#include "tests/support/functions.h"

#include <math.h>
#include <string.h>

enum { D = FUNCTION_INPUTS };

/* Indices from outputs, without a control variate. */
static struct pound_closed_results *plain(const double *y, int n_rows, int n_inputs, int order)
{
	static const double none[POUND_CLOSED_COLUMNS_MAX];
	const struct pound_rows rows = {.n_rows = n_rows};
	struct pound_closed_results *results = malloc(sizeof *results);
	struct pound_closed closed;
	pound_closed_init(&closed, &(struct pound_sample_values){.n_inputs = n_inputs, .order = order});
	double *estimates = malloc(2 * sizeof *estimates * (size_t)(n_rows * closed.n_columns));
	double *scratch = malloc(sizeof *scratch * pound_closed_scratch(&closed, n_rows));
	const struct pound_control_variate control = {.part = none};
	for (int i = 0; i < n_rows; i++)
		pound_closed_row(&closed, y + (size_t)i * closed.n_samples, &control, NULL,
		                 estimates + 2 * (size_t)i * closed.n_columns);
	pound_closed_indices(&closed, estimates, &rows, scratch, results);
	free(estimates), free(scratch);
	return results;
}

static void contrasts_of_the_factorial_design_have_their_golden_values(void **state)
{
	(void)state;
	// statistics_golden.json, factorial_contrasts_d2_n4: y[mask][row]
	static const double golden[4][4] = {{1.24, 0.41, -0.45, 1.07},
	                                    {0.47, 1.23, 1.02, 2.6},
	                                    {0.76, -0.02, 1.18, 1.22},
	                                    {2.36, 1.84, 1.36, 2.46}};
	double y[4][4];
	for (int i = 0; i < 4; i++)
		for (int p = 0; p < 4; p++)
			y[i][p] = golden[pound_order_mask(2, p)][i];
	struct pound_closed_results *got = plain(&y[0][0], 4, 2, POUND_ORDER_FACTORIAL);
	check_near(got->first[0].value, 0.40631904734320307, 1e-12);
	check_near(got->first[1].value, -0.10531193882870878, 1e-12);
	check_near(got->total[0].value, 1.105311938828709, 1e-12);
	check_near(got->total[1].value, 0.593680952656797, 1e-12);
	check_near(got->shapley[0].value, 0.755815493085956, 1e-12);
	check_near(got->shapley[1].value, 0.2441845069140441, 1e-12);
	// V_1, V_2, V_12 over their sum
	assert_int_equal(got->sets.n_second, 1);
	check_near(got->sets.second[0].estimate.value, 0.52791875 / 0.75525625, 1e-12);
	assert_int_equal(got->sets.n_closed, 2);
	check_near(got->sets.closed[1].estimate.value, -0.07953749999999998 / 0.75525625, 1e-12);
	free(got);
}

static void four_inputs_have_every_set_in_the_plain_design(void **state)
{
	(void)state;
	static const struct {
		int n_inputs, order, n_second, n_closed;
	} cases[] = {
	    {1, POUND_ORDER_TOTAL, 0, 0},  {2, POUND_ORDER_TOTAL, 1, 2},    {3, POUND_ORDER_TOTAL, 3, 6},
	    {4, POUND_ORDER_TOTAL, 6, 14}, {5, POUND_ORDER_SECOND, 10, 30}, {5, POUND_ORDER_FACTORIAL, 10, 30},
	    {6, POUND_ORDER_TOTAL, 0, 0},  {6, POUND_ORDER_SECOND, 15, 0},  {16, POUND_ORDER_SECOND, 120, 0},
	};
	double y[8 * POUND_SAMPLES_MAX];
	for (int k = 0; k < 8 * POUND_SAMPLES_MAX; k++)
		y[k] = (k * 7 + k * k * 3) % 31;
	for (size_t c = 0; c < sizeof cases / sizeof cases[0]; c++) {
		struct pound_closed_results *got = plain(y, 8, cases[c].n_inputs, cases[c].order);
		assert_int_equal(got->sets.n_second, cases[c].n_second);
		assert_int_equal(got->sets.n_closed, cases[c].n_closed);
		assert_int_equal(isnan(got->shapley[0].value), cases[c].n_inputs > 5);
		free(got);
	}
	// five inputs in the plain design: the sets of two lack samples, so there are no Shapley effects
	struct pound_closed_results *got = plain(y, 8, 5, POUND_ORDER_TOTAL);
	assert_int_equal(got->sets.n_second, 0);
	assert_true(isnan(got->shapley[0].value) && isfinite(got->first[0].value));
	free(got);
}

static struct pound_closed_results *indices_of(const struct function *f, int n_rows, int seed, int order,
                                               struct function_noise noise)
{
	struct pound_closed_results *results = malloc(sizeof *results);
	struct pound_rows rows;
	const struct pound_design design = {.rows = n_rows, .seed = (uint64_t)seed, .order = order};
	struct pound_sample_values values = function_values_of(f, &design, noise);
	double *u = function_design(n_rows, (uint64_t)seed);
	size_t rows_size = pound_rows_scratch(&values);
	double *scratch = malloc(sizeof *scratch * (rows_size + pound_chaos_expansion_scratch(&values)));
	pound_rows_init(&rows, &values, scratch);
	pound_chaos_expansion_indices(&rows, &(struct pound_sampling){.u = u},
	                              noise.n_signals > 1 ? POUND_NOISE_REMOVED : POUND_NOISE_KEPT,
	                              scratch + rows_size, results, NULL);
	free(scratch), free(u);
	function_values_free(&values);
	return results;
}

static const struct function_noise noiseless = {1, 0.0, true};

static void shapley_effects_add_up_to_one(void **state)
{
	(void)state;
	for (int order = POUND_ORDER_TOTAL; order <= POUND_ORDER_FACTORIAL; order++) {
		struct pound_closed_results *got =
		    indices_of(function_named("steps"), 120, 3, order, (struct function_noise){3, 0.5, true});
		double sum = 0.0;
		for (int j = 0; j < D; j++)
			sum += got->shapley[j].value;
		check_near(sum, 1.0, 1e-12);
		free(got);
	}
}

static void second_order_indices_and_shapley_effects_follow_from_the_closed_ones(void **state)
{
	(void)state;
	struct pound_closed_results *got =
	    indices_of(function_named("cusp"), 100, 4, POUND_ORDER_TOTAL, noiseless);
	double closed[1 << D] = {0.0}, shapley[D] = {0.0};
	closed[(1 << D) - 1] = 1.0;
	for (int k = 0; k < got->sets.n_closed; k++)
		closed[got->sets.closed[k].inputs] = got->sets.closed[k].estimate.value;
	for (int j = 0; j < D; j++) {
		// the same variances with weighted controls, so both intervals contain the exact ones
		check_near(got->first[j].value, closed[1 << j], got->first[j].high - got->first[j].low);
		check_near(got->total[j].value, 1.0 - closed[15 ^ 1 << j], got->total[j].high - got->total[j].low);
		// the mean over the 24 orders of the inputs of what j adds to the inputs before it
		for (int a = 0; a < D; a++)
			for (int b = 0; b < D; b++)
				for (int c = 0; c < D; c++) {
					const int order[D] = {a, b, c, 6 - a - b - c};
					unsigned before = 0;
					if (a == b || a == c || b == c)
						continue;
					for (int k = 0; order[k] != j; k++)
						before |= 1u << order[k];
					shapley[j] += (closed[before | 1u << j] - closed[before]) / 24.0;
				}
		check_near(got->shapley[j].value, shapley[j], 1e-13);
	}
	for (int k = 0; k < got->sets.n_second; k++) {
		unsigned set = got->sets.second[k].inputs;
		double want = closed[set] - closed[set & -set] - closed[set & (set - 1)];
		check_near(got->sets.second[k].estimate.value, want, 1e-13);
	}
	free(got);
}

/* The total of the first input from rows of which `large` are 1 in A and in all mixtures but the first, and all else is 0.  A row's
 * half squared difference is N = 1/2, the mean square of its six samples C = 4/6, the one of A and the mixture 1/2.
 * As N - (N / C) C is 0 in every row, the regression gives the coefficient 0. */
static double total_of_large_rows(int large)
{
	enum { N = 40, SAMPLES = D + 2 };
	static const double row[SAMPLES] = {1, 0, 0, 1, 1, 1};
	const double part[POUND_CLOSED_COLUMNS_MAX] = {0};
	const struct pound_control_variate none = {NULL, 0.0, part};
	double numerator[N * SAMPLES] = {0}, denominator[N * SAMPLES];
	for (int k = 0; k < N * SAMPLES; k++) {
		numerator[k] = k / SAMPLES < large ? row[k % SAMPLES] : 0.0;
		denominator[k] = 1.0;
	}
	const struct pound_sample_values values = {
	    .n_rows = N, .n_inputs = D, .n_signals = 1, .numerator = numerator, .denominator = denominator};
	struct pound_closed closed;
	struct pound_closed_results results;
	struct pound_rows rows;
	pound_closed_init(&closed, &values);
	double *held = malloc(sizeof *held * pound_rows_scratch(&values));
	double *estimates = malloc(sizeof *estimates * N * 2 * (size_t)closed.n_columns);
	double *scratch = malloc(sizeof *scratch * pound_closed_scratch(&closed, N));
	pound_rows_init(&rows, &values, held);
	for (int i = 0; i < N; i++)
		pound_closed_row(&closed, numerator + (size_t)i * SAMPLES, &none, NULL,
		                 estimates + (size_t)i * 2 * (size_t)closed.n_columns);
	pound_closed_indices(&closed, estimates, &rows, scratch, &results);
	free(held), free(estimates), free(scratch);
	return results.total[0].value;
}

/* N / (C + w (1/2 - C)): w is 1/2 with the coefficient 0, and 3/4 if fewer than five rows do not determine the coefficient. */
static void a_coefficient_of_few_rows_is_not_used(void **state)
{
	(void)state;
	check_near(total_of_large_rows(8), 6.0 / 7.0, 1e-14);
	check_near(total_of_large_rows(2), 12.0 / 13.0, 1e-14);
}

enum { SEEDS = 12 };

/* Root mean square errors and coverage over designs; [0] second-order indices, [1] Shapley effects. */
static void errors_of(const struct function *f, int n_rows, int order, struct function_noise noise,
                      double *rms, double *coverage)
{
	rms[0] = rms[1] = coverage[0] = coverage[1] = 0.0;
	for (int seed = 0; seed < SEEDS; seed++) {
		struct pound_closed_results *got = indices_of(f, n_rows, seed, order, noise);
		for (int k = 0; k < FUNCTION_PAIRS + D; k++) {
			static const int place[FUNCTION_PAIRS] = {0, 1, 3, 2, 4, 5}; // of sets in ascending order
			bool pair = k < FUNCTION_PAIRS;
			const struct pound_estimate *x =
			    pair ? &got->sets.second[k].estimate : &got->shapley[k - FUNCTION_PAIRS];
			double want = pair ? f->pair[place[k]] : f->shapley[k - FUNCTION_PAIRS];
			double n = SEEDS * (pair ? FUNCTION_PAIRS : D), error = x->value - want;
			rms[!pair] += error * error / n;
			coverage[!pair] += (x->low <= want && want <= x->high) / n;
		}
		free(got);
	}
	rms[0] = sqrt(rms[0]), rms[1] = sqrt(rms[1]);
}

static void errors_at_six_thousand_runs_are_those_measured_for_the_formulas(void **state)
{
	(void)state;
	// measured means over these five functions, with a control variate n = 1000, and contrasts only n = 375
	static const char *const names[] = {"ishigami", "g_a", "g_b", "cusp", "steps"};
	double pair[2] = {0.0}, shapley[2] = {0.0};
	for (int k = 0; k < 5; k++)
		for (int factorial = 0; factorial < 2; factorial++) {
			double rms[2], coverage[2];
			errors_of(function_named(names[k]), factorial ? 375 : 1000,
			          factorial ? POUND_ORDER_FACTORIAL : POUND_ORDER_TOTAL, noiseless, rms, coverage);
			pair[factorial] += rms[0] / 5.0;
			shapley[factorial] += rms[1] / 5.0;
			// nominal 0.95; 72 and 48 intervals that are not independent
			assert_true(coverage[0] >= 0.87 && coverage[1] >= 0.85);
		}
	assert_true(pair[0] <= 0.0115 && shapley[0] <= 0.0034 * 1.3);
	assert_true(pair[1] <= 0.0066 && shapley[1] <= 0.0169);
}

CHECK_MAIN(cmocka_unit_test(a_coefficient_of_few_rows_is_not_used),
           cmocka_unit_test(contrasts_of_the_factorial_design_have_their_golden_values),
           cmocka_unit_test(four_inputs_have_every_set_in_the_plain_design),
           cmocka_unit_test(shapley_effects_add_up_to_one),
           cmocka_unit_test(second_order_indices_and_shapley_effects_follow_from_the_closed_ones),
           cmocka_unit_test(errors_at_six_thousand_runs_are_those_measured_for_the_formulas))
