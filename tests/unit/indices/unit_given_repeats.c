/* unit_given_repeats.c - given data with repeated inputs: replicates, levels, factorial designs; and rows in any order. */
#include <math.h>
#include <string.h>

#include "engine/given.h"
#include "tests/support/check.h"
#include "tests/support/given_samples.h"

/* ---- replicates ---- */

static void rows_with_the_same_inputs_are_replicates_unless_all_inputs_have_few_values(void **state)
{
	(void)state;
	enum { N = 300 };
	struct given_samples s;
	int sample[N], *table = calloc((size_t)pound_given_join_slots(N), sizeof *table);
	// 100 points, three rows each, not together; -0 equals 0
	given_draw(&s, N, 2, 21);
	s.x[0] = 0.0;
	for (int i = 100; i < N; i++)
		memcpy(s.x + 2 * i, s.x + 2 * (i - 100), 2 * sizeof *s.x);
	s.x[2 * 100] = -0.0;
	assert_int_equal(pound_given_join(N, 2, s.x, table, sample), 100);
	for (int i = 0; i < N; i++)
		assert_int_equal(sample[i], i % 100);
	// one of them once more often
	memcpy(s.x + 2 * 299, s.x, 2 * sizeof *s.x);
	assert_int_equal(pound_given_join(N, 2, s.x, table, sample), 100);
	assert_int_equal(sample[299], 0);
	// draws of 3 and 5 values, and a grid of 15 x 20: each row counts
	for (int i = 0; i < N; i++) {
		s.x[2 * i] = floor(3 * given_uniform());
		s.x[2 * i + 1] = floor(5 * given_uniform());
	}
	assert_int_equal(pound_given_join(N, 2, s.x, table, sample), N);
	for (int i = 0; i < N; i++) {
		s.x[2 * i] = i / 20;
		s.x[2 * i + 1] = i % 20;
	}
	assert_int_equal(pound_given_join(N, 2, s.x, table, sample), N);
	for (int i = 0; i < N; i++)
		assert_int_equal(sample[i], i);
	given_free(&s);
	free(table);
}

/* y = u1 + u2 / 2 + noise of 0.3, each sample a mean of four: indices of the mean are 0.8 and 0.2, though the noise is 0.18 of the
 * variance. */
static void noise_of_known_variance_is_removed(void **state)
{
	(void)state;
	enum { SEEDS = 40, N = 200, R = 4 };
	static const double exact[] = {0.8, 0.2};
	int missed = 0;
	double share = 0.0;
	for (int seed = 0; seed < SEEDS; seed++) {
		struct given_samples s;
		struct pound_given_indices indices;
		given_draw(&s, N, 2, 300 + (uint64_t)seed);
		s.given.noise_known = true;
		for (int i = 0; i < N; i++) {
			double run[R], squares = 0.0;
			s.y[i] = 0.0;
			for (int r = 0; r < R; r++) {
				run[r] = s.x[2 * i] + 0.5 * s.x[2 * i + 1] + 0.3 * given_normal();
				s.y[i] += run[r] / R;
			}
			for (int r = 0; r < R; r++)
				squares += (run[r] - s.y[i]) * (run[r] - s.y[i]);
			s.noise[i] = squares / (R - 1) / R;
		}
		given_check(&s);
		given_estimate(&s, &indices);
		assert_int_equal(s.checks.notes, 0);
		share += indices.noise_share / SEEDS;
		for (int j = 0; j < 2; j++) {
			given_check_holds(indices.first[j], exact[j], "S1", &missed);
			if (isfinite(indices.total[j].value))
				given_check_holds(indices.total[j], exact[j], "ST", &missed);
		}
		given_free(&s);
	}
	// of the mean of four: 0.09 / 4 of 1.25 / 12 more
	const double noise = 0.09 / R;
	check_near(share, noise / (noise + 1.25 / 12), 0.01);
	check_report("%d of %d intervals missed", missed, SEEDS * 4);
	assert_true(missed <= 0.08 * SEEDS * 4);
}

static void an_output_that_is_noise_has_no_indices(void **state)
{
	(void)state;
	enum { N = 200 };
	struct given_samples s;
	struct pound_given_indices indices;
	given_draw(&s, N, 2, 41);
	s.given.noise_known = true;
	for (int i = 0; i < N; i++) {
		s.y[i] = given_normal();
		s.noise[i] = 1.0;
	}
	given_check(&s);
	given_estimate(&s, &indices);
	assert_true(given_says(indices.notes, POUND_GIVEN_ALL_NOISE));
	assert_true(isnan(indices.first[0].value) && isnan(indices.total[1].value));
	given_free(&s);
}

/* ---- factorial designs ---- */

enum { A = 4, B = 5, C = 6, CELLS = A * B * C };

/* The output at levels of three inputs. */
static double output(int a, int b, int c)
{
	return 0.7 * a * a + b + 0.5 * a * b + sin(c) + 0.2 * b * c;
}

/* Indices of `output` by their definition: first, total, second (0,1), (0,2), (1,2)  (9) */
static void exact_indices(double exact[9])
{
	double variance = 0.0, mean = 0.0, closed[8] = {0};
	for (int k = 0; k < CELLS; k++)
		mean += output(k / (B * C), k / C % B, k % C) / CELLS;
	for (unsigned set = 1; set < 8; set++)
		for (int k = 0; k < CELLS; k++) {
			const int at[] = {k / (B * C), k / C % B, k % C};
			double sum = 0.0;
			int n = 0;
			for (int l = 0; l < CELLS; l++) {
				const int other[] = {l / (B * C), l / C % B, l % C};
				bool same = true;
				for (int j = 0; j < 3; j++)
					same &= !(set >> j & 1) || at[j] == other[j];
				sum += same ? output(other[0], other[1], other[2]) : 0.0;
				n += same;
			}
			closed[set] += (sum / n - mean) * (sum / n - mean) / CELLS;
		}
	variance = closed[7];
	for (int j = 0; j < 3; j++) {
		exact[j] = closed[1 << j] / variance;
		exact[3 + j] = 1.0 - closed[7 & ~(1 << j)] / variance;
	}
	exact[6] = (closed[3] - closed[1] - closed[2]) / variance;
	exact[7] = (closed[5] - closed[1] - closed[4]) / variance;
	exact[8] = (closed[6] - closed[2] - closed[4]) / variance;
}

/* Fills in a factorial design of r rows for each combination, its rows shuffled, with noise. */
static void factorial_fill(struct given_samples *s, int r, double noise)
{
	const int n = CELLS * r;
	for (int i = 0; i < n; i++)
		s->order[i] = (size_t)i;
	for (int i = n - 1; i > 0; i--) {
		const size_t k = (size_t)(given_uniform() * (i + 1)), swap = s->order[i];
		s->order[i] = s->order[k];
		s->order[k] = swap;
	}
	for (int i = 0; i < n; i++) {
		const int k = (int)s->order[i] / r, a = k / (B * C), b = k / C % B, c = k % C;
		s->x[3 * i] = 10 * a;
		s->x[3 * i + 1] = -b;
		s->x[3 * i + 2] = 0.1 * c;
		s->y[i] = output(a, b, c) + noise * given_normal();
	}
}

static void a_factorial_design_has_the_indices_of_its_levels(void **state)
{
	(void)state;
	struct given_samples s;
	static struct pound_given_indices indices;
	double exact[9];
	exact_indices(exact);
	for (int r = 1; r <= 2; r++) {
		given_draw(&s, CELLS * r, 3, 50);
		factorial_fill(&s, r, 0.0);
		given_check(&s);
		assert_int_equal(s.given.replicates, r);
		assert_int_equal(s.checks.notes,
		                 1u << POUND_GIVEN_FACTORIAL | (r == 1 ? 1u << POUND_GIVEN_NOISE : 0u));
		given_estimate(&s, &indices);
		for (int j = 0; j < 3; j++)
			// there is no interaction of three inputs that would be taken as noise
			check_near(indices.first[j].value, exact[j], 1e-12);
		if (r == 2) {
			for (int j = 0; j < 3; j++) {
				check_near(indices.total[j].value, exact[3 + j], 1e-12);
				check_near(indices.second[j].estimate.value, exact[6 + j], 1e-12);
				check_near(indices.total[j].high - indices.total[j].low, 0.0, 1e-12);
			}
			check_near(indices.noise_share, 0.0, 1e-12);
		}
		given_free(&s);
	}
	// 60 x 60, more levels than a discrete input has; u1 + u2 / 2: 0.8 and 0.2
	given_draw(&s, 3600, 2, 51);
	for (int i = 0; i < 3600; i++) {
		s.x[2 * i] = i / 60;
		s.x[2 * i + 1] = i % 60;
		s.y[i] = s.x[2 * i] + 0.5 * s.x[2 * i + 1];
	}
	given_check(&s);
	assert_int_equal(s.checks.notes, 1u << POUND_GIVEN_FACTORIAL | 1u << POUND_GIVEN_NOISE);
	given_estimate(&s, &indices);
	check_near(indices.first[0].value, 0.8, 1e-12);
	check_near(indices.first[1].value, 0.2, 1e-12);
	given_free(&s);
}

/* One lost line is reported; levels drawn at random, as unequally often as chance has them, are not. */
static void a_factorial_design_with_a_lost_line_is_reported(void **state)
{
	(void)state;
	enum { R = 10, SEEDS = 200 };
	const unsigned note = 1u << POUND_GIVEN_UNBALANCED;
	struct given_samples s;
	int reported = 0;
	for (int lost = 0; lost < 2; lost++) {
		given_draw(&s, CELLS * R, 3, 50);
		factorial_fill(&s, R, 1.0);
		s.given.n_rows -= lost;
		given_check(&s);
		assert_int_equal(s.checks.notes & note, lost ? note : 0);
		assert_int_equal(s.given.replicates, lost ? 0 : R);
		given_free(&s);
	}
	for (int seed = 0; seed < SEEDS; seed++) {
		given_draw(&s, 600, 3, 900 + (uint64_t)seed);
		for (int k = 0; k < 3 * 600; k++)
			s.x[k] = s.x[k] < 0.5;
		given_check(&s);
		reported += (s.checks.notes & note) != 0;
		given_free(&s);
	}
	// one of a hundred: a binomial number of mean 2, above 7 with probability 0.001
	assert_in_range(reported, 0, 7);
}

static void one_balanced_input_alone_explains_everything_by_construction(void **state)
{
	(void)state;
	struct given_samples s;
	static struct pound_given_indices indices;
	for (int balanced = 0; balanced < 2; balanced++) {
		given_draw(&s, 100, 1, 7);
		for (int i = 0; i < 100; i++) {
			s.x[i] = i % (balanced ? 4 : 3);
			s.y[i] = s.x[i] + 3 * given_normal();
		}
		given_check(&s);
		assert_int_equal(s.checks.notes >> POUND_GIVEN_ONE_INPUT & 1, balanced);
		if (balanced) {
			given_estimate(&s, &indices);
			check_near(indices.first[0].value, 1, 1e-12);
			assert_true(indices.noise_share > 0);
		}
		given_free(&s);
	}
}

/* Replicates in a factorial design: S1, ST and S2 without the noise, which is a third of the variance of a run. */
static void noise_of_a_factorial_design_is_removed(void **state)
{
	(void)state;
	enum { SEEDS = 100, R = 3 };
	const double noise = 3.0;
	int missed = 0;
	double exact[9], mean[9] = {0},
	                 variance[2] = {0}; // of the means of the combinations, without noise: exact, estimated
	exact_indices(exact);
	for (int seed = -1; seed < SEEDS; seed++) {
		struct given_samples s;
		static struct pound_given_indices indices;
		given_draw(&s, CELLS * R, 3, 700 + (uint64_t)(seed + 1));
		factorial_fill(&s, R, seed < 0 ? 0.0 : noise);
		given_check(&s);
		assert_int_equal(s.checks.notes, 1u << POUND_GIVEN_FACTORIAL);
		given_estimate(&s, &indices);
		variance[seed >= 0] += indices.variance * (1.0 - indices.noise_share) / (seed < 0 ? 1 : SEEDS);
		if (seed < 0) {
			given_free(&s);
			continue;
		}
		for (int k = 0; k < 9; k++) {
			const struct pound_estimate e = k < 3   ? indices.first[k]
			                                : k < 6 ? indices.total[k - 3]
			                                        : indices.second[k - 6].estimate;
			given_check_holds(e, exact[k], k < 3 ? "S1" : k < 6 ? "ST" : "S2", &missed);
			mean[k] += e.value / SEEDS;
		}
		given_free(&s);
	}
	for (int k = 0; k < 9; k++)
		check_near(mean[k], exact[k], 0.01);
	// four standard errors: 2 sqrt(V t / CELLS / SEEDS) with t = V / 6, as the noise is a third of the variance of a run
	check_near(variance[1], variance[0], variance[0] * 8.0 * sqrt(1.0 / 6 / CELLS / SEEDS));
	check_report("%d of %d intervals missed", missed, SEEDS * 9);
	assert_true(missed >= 0.01 * SEEDS * 9 && missed <= 0.08 * SEEDS * 9);
}

/* One row for each combination, with noise: S1 is a share of the variance with the noise. */
static void one_row_for_each_combination_has_first_order_indices(void **state)
{
	(void)state;
	enum { SEEDS = 100, L = 12 };
	int missed = 0;
	double mean = 0.0;
	// u1 + noise; 12 levels of 0 to 1 have the variance (L + 1) / (L - 1) / 12
	const double variance = (L + 1.0) / (L - 1) / 12, noise = 0.3,
	             exact = variance / (variance + noise * noise);
	for (int seed = 0; seed < SEEDS; seed++) {
		struct given_samples s;
		static struct pound_given_indices indices;
		given_draw(&s, L * L, 2, 900 + (uint64_t)seed);
		for (int i = 0; i < L * L; i++) {
			s.x[2 * i] = (i / L) / (L - 1.0);
			s.x[2 * i + 1] = i % L;
			s.y[i] = s.x[2 * i] + noise * given_normal();
		}
		given_check(&s);
		given_estimate(&s, &indices);
		given_check_holds(indices.first[0], exact, "S1", &missed);
		given_check_holds(indices.first[1], 0.0, "S1", &missed);
		mean += indices.first[1].value / SEEDS;
		given_free(&s);
	}
	check_report("%d of %d intervals missed", missed, SEEDS * 2);
	// without the correction it would be noise of (L - 1) / L^2 of its variance, 0.04
	check_near(mean, 0.0, 0.01);
	assert_true(missed <= 0.08 * SEEDS * 2);
}

/* Fills in a factorial design of d inputs of -1 and 1 with r rows for each point: effect (x1 + x1 x2 / 2) + noise. */
static void two_levels_fill(struct given_samples *s, int d, double effect, double noise)
{
	for (int i = 0; i < s->given.n_rows; i++) {
		for (int j = 0; j < d; j++)
			s->x[d * i + j] = i >> j & 1 ? 1.0 : -1.0;
		const double *x = s->x + (size_t)d * i;
		s->y[i] = effect * (x[0] + 0.5 * x[0] * x[1]) + noise * given_normal();
	}
}

/* Designs of few points: only the noise of a mean matters, not how many points there are.  x1 is 0.8 of the variance of the means,
 * x1 x2 the other 0.2. */
static void replicates_of_few_points_have_indices(void **state)
{
	(void)state;
	enum { SEEDS = 200 };
	static const struct {
		int d, r;
		double noise;
	} designs[] = {{2, 20, 0.5}, {3, 10, 0.5}, {3, 40, 0.5}, {3, 10, 0.0},
	               {2, 20, 0.0}, {3, 10, 1.5}, {6, 2, 0.5}};
	for (size_t k = 0; k < sizeof designs / sizeof designs[0]; k++) {
		const int d = designs[k].d;
		int refused = 0, missed = 0, n = 0;
		for (int seed = 0; seed < SEEDS; seed++) {
			struct given_samples s;
			static struct pound_given_indices indices;
			given_draw(&s, designs[k].r << d, d, 4000 + (uint64_t)seed);
			two_levels_fill(&s, d, 1.0, designs[k].noise);
			given_check(&s);
			assert_int_equal(s.given.replicates, designs[k].r);
			given_estimate(&s, &indices);
			refused += given_says(indices.notes, POUND_GIVEN_ALL_NOISE);
			for (int j = 0; j < d && indices.notes == 0; j++, n += 2) {
				const double first = j == 0 ? 0.8 : 0.0, total = j == 0 ? 1.0 : j == 1 ? 0.2 : 0.0;
				if (designs[k].noise == 0.0) {
					check_near(indices.first[j].value, first, 1e-12);
					check_near(indices.total[j].high, total, 1e-12);
					continue;
				}
				given_check_holds(indices.first[j], first, "S1", &missed);
				given_check_holds(indices.total[j], total, "ST", &missed);
			}
			given_free(&s);
		}
		check_report("2^%d x %d, noise %g: %d of %d intervals missed", d, designs[k].r, designs[k].noise,
		             missed, n);
		assert_int_equal(refused, 0);
		assert_true(missed <= 0.08 * n);
	}
}

/* Noise alone is refused, but for the 2.5 % of sets that a test at this level takes for an effect. */
static void replicates_of_few_points_that_are_noise_have_no_indices(void **state)
{
	(void)state;
	enum { SEEDS = 400 };
	static const int designs[][2] = {{2, 20}, {3, 10}, {3, 40}, {6, 2}};
	for (size_t k = 0; k < sizeof designs / sizeof designs[0]; k++) {
		const int d = designs[k][0];
		int taken = 0;
		for (int seed = 0; seed < SEEDS; seed++) {
			struct given_samples s;
			static struct pound_given_indices indices;
			given_draw(&s, designs[k][1] << d, d, 5000 + (uint64_t)seed);
			two_levels_fill(&s, d, 0.0, 1.0);
			given_check(&s);
			given_estimate(&s, &indices);
			taken += !given_says(indices.notes, POUND_GIVEN_ALL_NOISE);
			given_free(&s);
		}
		check_report("2^%d x %d: noise taken for an effect in %d of %d sets", d, designs[k][1], taken, SEEDS);
		// 10 expected, standard deviation 3
		assert_true(taken >= 1 && taken <= 20);
	}
}

/* ---- rows in any order ---- */

static void lines_in_another_order_have_the_same_notes_and_intervals_as_wide(void **state)
{
	(void)state;
	enum { N = 1000 };
	double width[2][2];
	for (int sorted = 0; sorted < 2; sorted++) {
		struct given_samples s;
		static struct pound_given_indices indices;
		given_draw(&s, N, 2, 77);
		s.given.sorted = sorted;
		for (int i = 1; i < N && sorted; i++)
			for (int k = i; k > 0 && s.x[2 * k] < s.x[2 * k - 2]; k--)
				for (int j = 0; j < 2; j++) {
					const double swap = s.x[2 * k + j];
					s.x[2 * k + j] = s.x[2 * k - 2 + j];
					s.x[2 * k - 2 + j] = swap;
				}
		for (int i = 0; i < N; i++)
			s.y[i] = s.x[2 * i] + 0.5 * s.x[2 * i] * s.x[2 * i + 1];
		given_check(&s);
		assert_int_equal(s.checks.notes, 1u << POUND_GIVEN_NOISE);
		given_estimate(&s, &indices);
		for (int j = 0; j < 2; j++)
			width[sorted][j] = indices.total[j].high - indices.total[j].low;
		given_free(&s);
	}
	// widths from 20 folds are known to a sixth; sorted folds, dealt out in turn, were alike and their widths a third
	for (int j = 0; j < 2; j++)
		assert_true(width[1][j] > 0.5 * width[0][j] && width[1][j] < 2.0 * width[0][j]);
}

/* Equal values of an input in a table that is sorted by the other one: neighbors among the ties must not be near in it. */
static void ties_do_not_take_the_order_of_the_lines(void **state)
{
	(void)state;
	enum { N = 4000 };
	struct given_samples s;
	static struct pound_given_indices indices;
	given_draw(&s, N, 2, 78);
	s.given.sorted = true;
	for (int i = 0; i < N; i++) {
		s.x[2 * i] = floor(100 * s.x[2 * i]);
		s.x[2 * i + 1] = (i + given_uniform()) / N;
		s.y[i] = s.x[2 * i + 1];
	}
	given_check(&s);
	assert_int_equal(s.checks.notes, 1u << POUND_GIVEN_NOISE);
	given_estimate(&s, &indices);
	check_near(indices.first[0].value, 0.0, 0.02);
	given_free(&s);
}

/* Independent chains are correlated in their order, not with each other. */
static void independent_markov_chains_are_not_called_dependent(void **state)
{
	(void)state;
	enum { SEEDS = 60, N = 1000 };
	int dependent = 0, serial = 0;
	for (int seed = 0; seed < SEEDS; seed++) {
		struct given_samples s;
		given_draw(&s, N, 3, 7000 + (uint64_t)seed);
		for (int i = 1; i < N; i++)
			for (int j = 0; j < 3; j++)
				s.x[3 * i + j] = 0.9 * s.x[3 * (i - 1) + j] + sqrt(1 - 0.81) * given_normal();
		given_check(&s);
		dependent += given_says(s.checks.notes, POUND_GIVEN_DEPENDENT);
		serial += given_says(s.checks.notes, POUND_GIVEN_SERIAL);
		given_free(&s);
	}
	check_report("%d of %d dependent", dependent, SEEDS);
	assert_int_equal(serial, SEEDS);
	assert_true(dependent <= 2);
}

/* ---- heavy tails ---- */

/* A lognormal output: intervals that miss come with the note, those without it hold. */
static void heavy_tails_are_noted(void **state)
{
	(void)state;
	enum { SEEDS = 100, N = 500 };
	int noted = 0, missed = 0, missed_silent = 0, light = 0;
	// first-order indices of exp(sum s_j z_j): (exp(s_j^2) - 1) / (exp(sum s_j^2) - 1)
	const double sd[] = {1.5, 1.0, 0.5}, all = exp(1.5 * 1.5 + 1.0 + 0.25) - 1.0;
	for (int seed = 0; seed < SEEDS; seed++) {
		struct given_samples s;
		static struct pound_given_indices indices;
		given_draw(&s, N, 3, 3000 + (uint64_t)seed);
		for (int i = 0; i < N; i++) {
			double sum = 0.0;
			for (int j = 0; j < 3; j++) {
				s.x[3 * i + j] = given_normal();
				sum += sd[j] * s.x[3 * i + j];
			}
			s.y[i] = exp(sum);
		}
		given_check(&s);
		given_estimate(&s, &indices);
		int misses = 0;
		for (int j = 0; j < 3; j++)
			given_check_holds(indices.first[j], (exp(sd[j] * sd[j]) - 1.0) / all, "S1", &misses);
		const bool note = given_says(indices.notes, POUND_GIVEN_FEW_DECIDE);
		assert_true(given_says(indices.notes, POUND_GIVEN_LOGARITHM) == note);
		missed += misses;
		noted += note;
		missed_silent += note ? 0 : misses;
		// the same with a value of zero has no logarithm
		const double one = s.y[0];
		s.y[0] = 0.0;
		given_estimate(&s, &indices);
		assert_false(given_says(indices.notes, POUND_GIVEN_LOGARITHM));
		s.y[0] = one;
		// a normal output of the same inputs has no note
		for (int i = 0; i < N; i++)
			s.y[i] = log(s.y[i]);
		given_estimate(&s, &indices);
		light += given_says(indices.notes, POUND_GIVEN_FEW_DECIDE);
		given_free(&s);
	}
	check_report("%d of %d intervals missed, %d of them without a note; %d of %d sets noted", missed,
	             3 * SEEDS, missed_silent, noted, SEEDS);
	assert_true(noted >= 0.95 * SEEDS);
	assert_true(missed_silent <= 0.01 * 3 * SEEDS);
	assert_int_equal(light, 0);
}

CHECK_MAIN(cmocka_unit_test(rows_with_the_same_inputs_are_replicates_unless_all_inputs_have_few_values),
           cmocka_unit_test(noise_of_known_variance_is_removed),
           cmocka_unit_test(an_output_that_is_noise_has_no_indices),
           cmocka_unit_test(a_factorial_design_has_the_indices_of_its_levels),
           cmocka_unit_test(a_factorial_design_with_a_lost_line_is_reported),
           cmocka_unit_test(one_balanced_input_alone_explains_everything_by_construction),
           cmocka_unit_test(noise_of_a_factorial_design_is_removed),
           cmocka_unit_test(one_row_for_each_combination_has_first_order_indices),
           cmocka_unit_test(replicates_of_few_points_have_indices),
           cmocka_unit_test(replicates_of_few_points_that_are_noise_have_no_indices),
           cmocka_unit_test(lines_in_another_order_have_the_same_notes_and_intervals_as_wide),
           cmocka_unit_test(ties_do_not_take_the_order_of_the_lines),
           cmocka_unit_test(independent_markov_chains_are_not_called_dependent),
           cmocka_unit_test(heavy_tails_are_noted))
