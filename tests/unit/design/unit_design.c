/* unit_design.c - stratification exactly, uniformity and independence within derived bounds. */
#include "engine/design/design.h"
#include "tests/support/check.h"

#include <math.h>
#include <string.h>

enum { D = 4 };

static int row_named(const char *name)
{
	int row = 0;
	while (strcmp(pound_design_name(row), name))
		row++;
	return row;
}

/* The filled design of a study of D inputs, uniform on (0, 1); the caller frees it. */
static double *unit_design(const char *method, int rows, uint64_t seed)
{
	struct pound_input inputs[D];
	memset(inputs, 0, sizeof inputs);
	for (int j = 0; j < D; j++)
		inputs[j].distribution = (struct pound_distribution){.type = 0, .p = {0.0, 1.0}};
	struct pound_study study = {
	    .n_inputs = D, .inputs = inputs, .design = {.method = row_named(method), .rows = rows, .seed = seed}};
	double *x = malloc(sizeof *x * 2 * D * (size_t)rows);
	pound_design_probabilities(&study, NULL, x);
	pound_design_values(&study, x, NULL, x);
	return x;
}

/* The probabilities of a design that grows to 6 max_rows runs; its grouping and its rows. */
static double *grown_design(const char *method, int max_rows, int randomisations,
                            struct pound_grouping *grouping, int *rows)
{
	const struct pound_study study = {.n_inputs = D,
	                                  .scene.excitation.signals = 1,
	                                  .design = {.method = row_named(method),
	                                             .rows = 2,
	                                             .seed = 5,
	                                             .randomisations = randomisations,
	                                             .until = {0.1, 6 * max_rows}}};
	*grouping = pound_design_grouping(&study);
	*rows = pound_design_rows_most(&study);
	double *u = malloc(sizeof *u * 2 * D * (size_t)*rows);
	pound_design_probabilities(&study, NULL, u);
	return u;
}

/* Checks that each of n equal strata contains one point of a column's group. */
static void check_strata(const double *u, int rows, struct pound_grouping grouping, int group, int n)
{
	char *hit = calloc((size_t)n, 1);
	for (int i = 0; i < rows; i++)
		if (i / grouping.run % grouping.n == group)
			hit[(int)(u[(size_t)i * 2 * D] * n)]++;
	for (int k = 0; k < n; k++)
		assert_int_equal(hit[k], 1);
	free(hit);
}

static void rows_of_a_group_are_a_design_of_their_own(void **state)
{
	(void)state;
	struct pound_grouping grouping;
	int rows;
	double *u = grown_design("lhs", 1500, 0, &grouping, &rows);
	assert_true(rows == 1500 && grouping.n == 15 && grouping.run == 100);
	for (int group = 0; group < 15; group++)
		for (int c = 0; c < 2 * D; c++)
			check_strata(u + c, rows, grouping, group, 100);
	free(u);
	// the first batch is the Latin hypercube of its size
	double *batch = unit_design("lhs", 100, 5);
	u = grown_design("lhs", 1500, 0, &grouping, &rows);
	assert_memory_equal(u, batch, sizeof *u * 2 * D * 100);
	free(u), free(batch);
	// rows of a random design or of a single Latin hypercube have no groups
	for (int m = 0; m < 2; m++) {
		const struct pound_study study = {.n_inputs = D, .design = {.method = m, .rows = 100}};
		assert_int_equal(pound_design_grouping(&study).n, 0);
	}
}

static void every_net_of_a_sobol_design_is_a_net_of_its_own(void **state)
{
	(void)state;
	static const int randomisations[] = {8, 16};
	for (int k = 0; k < 2; k++) {
		struct pound_grouping grouping;
		int rows, n = randomisations[k];
		double *u = grown_design("sobol", 4096, n, &grouping, &rows);
		assert_true(rows == 4096 && grouping.n == n && grouping.run == 1);
		for (int group = 0; group < n; group++)
			for (int c = 0; c < 2 * D; c++)
				check_strata(u + c, rows, grouping, group, rows / n);
		// the first 16 points of each group are stratified, too
		for (int group = 0; group < n; group++)
			check_strata(u, 16 * n, grouping, group, 16);
		free(u);
	}
}

static void a_latin_hypercube_has_one_point_in_every_stratum_of_every_column(void **state)
{
	(void)state;
	static const int sizes[] = {2, 3, 7, 100, 1000, 4097, (1 << 17) - 1};
	for (size_t k = 0; k < sizeof sizes / sizeof sizes[0]; k++) {
		int n = sizes[k];
		double *x = unit_design("lhs", n, 42 + k);
		char *hit = malloc(n);
		for (int c = 0; c < 2 * D; c++) {
			memset(hit, 0, n);
			for (int i = 0; i < n; i++) {
				double u = x[(size_t)i * 2 * D + c];
				assert_true(u > 0.0 && u < 1.0);
				hit[(int)(u * n)]++;
			}
			assert_null(memchr(hit, 0, n));
		}
		free(hit);
		free(x);
	}
}

/* Largest distance between the distribution function of n points and that of a uniform variable. */
static double kolmogorov(const double *u, int n, int stride)
{
	enum { CELLS = 1 << 14 };
	static int below[CELLS + 1];
	memset(below, 0, sizeof below);
	for (int i = 0; i < n; i++)
		below[(int)(u[(size_t)i * stride] * CELLS) + 1]++;
	double distance = 0.0;
	for (int c = 1; c <= CELLS; c++) {
		below[c] += below[c - 1];
		distance = fmax(distance, fabs((double)below[c] / n - (double)c / CELLS));
	}
	return distance;
}

static void random_columns_are_uniform_and_unrelated(void **state)
{
	(void)state;
	enum { N = 20000 };
	static const char *const methods[] = {"random", "lhs"};
	for (int m = 0; m < 2; m++) {
		double *x = unit_design(methods[m], N, 7);
		for (int c = 0; c < 2 * D; c++) {
			// P(sqrt(n) distance > 2.5) = 2 exp(-2 * 2.5^2) = 7e-6 for independent points, less for strata
			assert_true(kolmogorov(x + c, N, 2 * D) < 2.5 / sqrt(N));
			for (int e = 0; e < c; e++) {
				double covariance = 0.0;
				for (int i = 0; i < N; i++)
					covariance += (x[i * 2 * D + c] - 0.5) * (x[i * 2 * D + e] - 0.5);
				// 5 standard deviations of a correlation, 1 / sqrt(n) each
				check_near(12.0 * covariance / N, 0.0, 5.0 / sqrt(N));
			}
			double lagged = 0.0;
			for (int i = 1; i < N; i++)
				lagged += (x[i * 2 * D + c] - 0.5) * (x[(i - 1) * 2 * D + c] - 0.5);
			check_near(12.0 * lagged / N, 0.0, 5.0 / sqrt(N));
		}
		free(x);
	}
}

static void every_order_of_three_strata_is_as_likely(void **state)
{
	(void)state;
	enum { SEEDS = 6000 };
	int seen[27] = {0};
	for (int seed = 0; seed < SEEDS; seed++) {
		double *x = unit_design("lhs", 3, seed);
		seen[(int)(3 * x[0]) * 9 + (int)(3 * x[2 * D]) * 3 + (int)(3 * x[4 * D])]++;
		free(x);
	}
	int orders = 0;
	for (int k = 0; k < 27; k++)
		if (seen[k]) {
			orders++;
			check_near(seen[k], SEEDS / 6.0, 5.0 * sqrt(SEEDS * 5.0 / 36.0)); // 5 binomial deviations
		}
	assert_int_equal(orders, 6);
}

static void a_column_depends_on_the_seed_and_the_input_only(void **state)
{
	(void)state;
	static const char *const methods[] = {"random", "lhs", "sobol"};
	for (int m = 0; m < 3; m++) {
		double *x = unit_design(methods[m], 50, 1), *again = unit_design(methods[m], 50, 1);
		double *other = unit_design(methods[m], 50, 2);
		assert_memory_equal(x, again, sizeof *x * 2 * D * 50);
		int same = 0;
		for (int k = 0; k < 2 * D * 50; k++)
			same += x[k] == other[k];
		assert_int_equal(same, 0);
		free(x), free(again), free(other);
	}
	static const char *const nested[] = {"random", "sobol"};
	for (int m = 0; m < 2; m++) {
		double *fewer = unit_design(nested[m], 20, 1), *more = unit_design(nested[m], 50, 1);
		assert_memory_equal(fewer, more, sizeof *fewer * 2 * D * 20);
		free(fewer), free(more);
	}
}

static void values_are_quantiles_of_the_inputs_distributions(void **state)
{
	(void)state;
	enum { N = 100 };
	struct pound_input inputs[2] = {{.distribution = {.type = 0, .p = {0.5, 5.0}}},
	                                {.distribution = {.type = 2, .p = {6.0}}}};
	struct pound_study study = {.n_inputs = 2, .inputs = inputs, .design = {.rows = N, .seed = 3}};
	double x[N * 4], u[N * 4];
	pound_design_probabilities(&study, NULL, x);
	pound_design_values(&study, x, NULL, x);
	pound_design_probabilities(&study, NULL, u);
	for (int k = 0; k < N * 4; k++)
		check_near(x[k], pound_distribution_quantile(&inputs[k % 2].distribution, u[k]), 0.0);
}

static void a_mixed_sample_takes_one_column_from_b(void **state)
{
	(void)state;
	const double x[] = {1, 2, 3, /* A */ 11, 12, 13, /* B */ 4, 5, 6, 14, 15, 16};
	static const double want[5][3] = {{4, 5, 6}, {14, 15, 16}, {14, 5, 6}, {4, 15, 6}, {4, 5, 16}};
	for (int sample = 0; sample < 5; sample++)
		for (int j = 0; j < 3; j++)
			check_near(pound_design_input(x, 3, 1, pound_order_mask(3, sample), j), want[sample][j], 0.0);
}

CHECK_MAIN(cmocka_unit_test(rows_of_a_group_are_a_design_of_their_own),
           cmocka_unit_test(every_net_of_a_sobol_design_is_a_net_of_its_own),
           cmocka_unit_test(a_latin_hypercube_has_one_point_in_every_stratum_of_every_column),
           cmocka_unit_test(random_columns_are_uniform_and_unrelated),
           cmocka_unit_test(every_order_of_three_strata_is_as_likely),
           cmocka_unit_test(a_column_depends_on_the_seed_and_the_input_only),
           cmocka_unit_test(values_are_quantiles_of_the_inputs_distributions),
           cmocka_unit_test(a_mixed_sample_takes_one_column_from_b))
