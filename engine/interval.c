/* interval.c - 95 % intervals of a statistic of row means, by resampling whole rows.
 *
 * 1. Rows are drawn with replacement, as many as there are; which ones is a function of (seed, resample) alone.
 * 2. The statistic of the resample's means is one of POUND_RESAMPLES values.
 * 3. The interval goes from their 2.5 % to their 97.5 % quantile.
 *
 * Efron, Tibshirani 1993, An introduction to the bootstrap, chapter 13; rows of independent or Latin hypercube
 * designs only (rows of a quasi-random design are no sample: intervals would be several times too wide; jackknife.c). */
#include "engine/indices.h"

#include "engine/random.h"

#include <assert.h>
#include <gsl/gsl_statistics_double.h>
#include <math.h>
#include <string.h>

// a segment of rows and its tiles stay in the cache while they are drawn from
enum { SEGMENT = 1024, SEGMENTS_MAX = (1 << 20) / SEGMENT, GROUP = 8, DRAWS_PER_WORD_MAX = 8, TILE = 8 };

/* Draws of whole numbers below n, in order; several from each 64-bit word. */
struct draws {
	philox4x64_key_t key;
	philox4x64_ctr_t counter;
	uint64_t n, surplus;
	int per_word;
};

/* Draws below n at an address of their own.
 *
 * A word w yields hi(w n), then hi(lo(w n) n), and so on, for as long as n^k leaves ten bits to spare; words whose
 * last low half falls below 2^64 mod n^k are refused, so that all numbers are equally likely.
 *
 * Source   Brackett-Rozinsky, Lemire 2024, Softw. Pract. Exper. 55(1), 66-77
 * Test     unit_interval: rows_are_drawn_as_often_as_a_multinomial_says
 */
static struct draws draws_below(int n, uint64_t seed, int resample, int segment)
{
	struct draws draws = {.key = {{seed, 0}},
	                      .counter = {{0, segment, resample, POUND_STREAM_BOOTSTRAP}},
	                      .n = n,
	                      .per_word = 1};
	uint64_t power = n;
	for (; draws.per_word < DRAWS_PER_WORD_MAX && power <= (UINT64_C(1) << 54) / n; power *= n)
		draws.per_word++;
	draws.surplus = -power % power;
	return draws;
}

/* At least `wanted` further draws; the ones beyond it belong to no resample.  draw has room for
 * wanted + 4 DRAWS_PER_WORD_MAX. */
static void draws_fill(struct draws *draws, int wanted, uint32_t *draw)
{
	const uint64_t n = draws->n;
	const int per_word = draws->per_word;
	for (int have = 0; have < wanted; draws->counter.v[0]++) {
		const philox4x64_ctr_t words = philox4x64_R(10, draws->counter, draws->key);
		for (int k = 0; k < 4; k++) {
			uint64_t word = words.v[k], high;
			for (int i = 0; i < per_word; i++) {
				word = mulhilo64(word, n, &high);
				draw[have + i] = (uint32_t)high;
			}
			have += word >= draws->surplus ? per_word : 0;
		}
	}
}

// two doubles side by side; the width changes no sum, as every moment has its own lane
typedef double pair __attribute__((vector_size(16), may_alias));

/* Adds the drawn rows of one tile to a sum; even and odd draws are added up apart, to hide the adder's latency. */
static void tile_add(const double *tile, const uint32_t *draw, int n, double *sum)
{
	const pair *row = (const pair *)tile;
	pair even[4] = {{0}}, odd[4] = {{0}};
	int i = 0;
	for (; i + 1 < n; i += 2) {
		const pair *p = row + 4 * (size_t)draw[i], *q = row + 4 * (size_t)draw[i + 1];
		even[0] += p[0], even[1] += p[1], even[2] += p[2], even[3] += p[3];
		odd[0] += q[0], odd[1] += q[1], odd[2] += q[2], odd[3] += q[3];
	}
	if (i < n)
		for (int k = 0; k < 4; k++)
			even[k] += row[4 * (size_t)draw[i] + k];
	for (int k = 0; k < TILE; k++)
		sum[k] += even[k / 2][k % 2] + odd[k / 2][k % 2];
}

/* Moments of all rows in tiles of eight columns, so that a resample reads whole cache lines. */
struct moments {
	int n_rows, n_moments, tiles;
	double *tile; /* (tiles x n_rows x TILE), zero beyond n_moments */
};

static double *moment_tile(const struct moments *moments, int row, int tile)
{
	return moments->tile + ((size_t)tile * moments->n_rows + row) * TILE;
}

static struct moments moments_of(const struct pound_statistic *statistic, int n_rows, double *scratch)
{
	struct moments moments = {n_rows, statistic->n_moments, (statistic->n_moments + TILE - 1) / TILE,
	                          scratch};
	for (int i = 0; i < n_rows; i++) {
		double m[POUND_MOMENTS_MAX] = {0};
		statistic->moments(statistic->subject, i, m);
		for (int t = 0; t < moments.tiles; t++)
			memcpy(moment_tile(&moments, i, t), m + TILE * t, sizeof *m * TILE);
	}
	return moments;
}

static void moments_means(const struct moments *moments, double *mean)
{
	for (int k = 0; k < moments->n_moments; k++) {
		double sum = 0.0;
		for (int i = 0; i < moments->n_rows; i++)
			sum += moment_tile(moments, i, k / TILE)[k % TILE];
		mean[k] = sum / moments->n_rows;
	}
}

/* How many of a resample's draws fall into each segment of rows. */
static void segment_shares(int n_rows, uint64_t seed, int resample, int *share)
{
	uint32_t draw[SEGMENT + 4 * DRAWS_PER_WORD_MAX];
	struct draws draws = draws_below(n_rows, seed, resample, 0);
	memset(share, 0, sizeof *share * SEGMENTS_MAX);
	for (int left = n_rows; left > 0; left -= SEGMENT) {
		int n = left < SEGMENT ? left : SEGMENT;
		draws_fill(&draws, n, draw);
		for (int i = 0; i < n; i++)
			share[draw[i] / SEGMENT]++;
	}
}

/* Adds a resample's rows of one segment to its sums. */
static void segment_add(const struct moments *moments, int segment, uint64_t seed, int resample, int share,
                        double *sum)
{
	const int first = segment * SEGMENT, rows = moments->n_rows - first;
	uint32_t draw[SEGMENT + 4 * DRAWS_PER_WORD_MAX];
	struct draws draws = draws_below(rows < SEGMENT ? rows : SEGMENT, seed, resample, 1 + segment);
	for (int left = share; left > 0; left -= SEGMENT) {
		int n = left < SEGMENT ? left : SEGMENT;
		draws_fill(&draws, n, draw);
		for (int t = 0; t < moments->tiles; t++)
			tile_add(moment_tile(moments, first, t), draw, n, sum + TILE * t);
	}
}

/* Means of the moments over GROUP resamples of the rows, from resample `first`.
 *
 * Which segment each draw falls into comes first, then the rows within the segments: the same law as drawing
 * from all rows, and a segment is read from memory once for the whole group, however many rows there are.
 */
static void resample_means(const struct moments *moments, uint64_t seed, int first,
                           double mean[GROUP][POUND_MOMENTS_MAX])
{
	const int segments = (moments->n_rows + SEGMENT - 1) / SEGMENT;
	int share[GROUP][SEGMENTS_MAX];
	memset(mean, 0, sizeof *mean * GROUP);
	for (int g = 0; g < GROUP; g++)
		if (segments > 1)
			segment_shares(moments->n_rows, seed, first + g, share[g]);
		else
			share[g][0] = moments->n_rows;
	for (int s = 0; s < segments; s++)
		for (int g = 0; g < GROUP; g++)
			segment_add(moments, s, seed, first + g, share[g][s], mean[g]);
	for (int g = 0; g < GROUP; g++)
		for (int k = 0; k < moments->n_moments; k++)
			mean[g][k] /= moments->n_rows;
}

/* Quantile of n values, linear between the order statistics around (n - 1) p; reorders them. */
static double quantile(double *value, int n, double p)
{
	int below = (int)((n - 1) * p);
	double at = gsl_stats_select(value, 1, n, below), next = INFINITY;
	if (below == n - 1)
		return at;
	// selection has left the larger ones behind
	for (int i = below + 1; i < n; i++)
		next = fmin(next, value[i]);
	return at + ((n - 1) * p - below) * (next - at);
}

size_t pound_interval_scratch(int n_rows, int n_moments, int n_values)
{
	size_t tiles = (n_moments + TILE - 1) / TILE;
	return tiles * n_rows * TILE + (size_t)n_values * POUND_RESAMPLES + TILE;
}

/* A statistic's values, with 95 % percentile bootstrap intervals.
 *
 * Given    statistic  -               moments of a row, and n_values numbers from their means
 *          n_rows     -               [1, 2^20]
 *          seed       -               same seed, same resamples
 *          n_resamples                a multiple of 8, at most POUND_RESAMPLES
 * Returns  estimates  (n_values)      low and high are NAN where no resample defines the value
 * Memory   scratch    (pound_interval_scratch)
 *
 * Resamples for which a value is not defined (all rows alike) are left out of its quantiles; a value that is not defined
 * has no interval.
 *
 * Valid    Rows that are independent or of one Latin hypercube; mildly wide for the latter (3-13 %)
 * Source   percentile interval, Efron, Tibshirani 1993, section 13.3
 * Test     unit_interval: intervals_of_a_mean_are_those_of_the_normal_law
 */
void pound_interval_bootstrap(const struct pound_statistic *statistic, int n_rows, uint64_t seed,
                              int n_resamples, double *scratch, struct pound_estimate *estimates)
{
	static_assert(POUND_MOMENTS_MAX % TILE == 0, "tiles are whole");
	assert(statistic->n_moments <= POUND_MOMENTS_MAX && statistic->n_values <= POUND_VALUES_MAX);
	assert(n_rows <= SEGMENTS_MAX * SEGMENT);
	assert(n_resamples % GROUP == 0 && n_resamples <= POUND_RESAMPLES);
	double *on_cache_line = (double *)(((uintptr_t)scratch + 63) / 64 * 64);
	const struct moments moments = moments_of(statistic, n_rows, on_cache_line);
	double *resampled = moments.tile + (size_t)moments.tiles * n_rows * TILE;
	double mean[GROUP][POUND_MOMENTS_MAX], value[POUND_VALUES_MAX];
	int defined[POUND_VALUES_MAX] = {0};
	moments_means(&moments, mean[0]);
	statistic->values(statistic->subject, mean[0], value);
	for (int v = 0; v < statistic->n_values; v++)
		estimates[v] = (struct pound_estimate){value[v], NAN, NAN};
	for (int r = 0; r < n_resamples; r++) {
		if (r % GROUP == 0)
			resample_means(&moments, seed, r, mean);
		statistic->values(statistic->subject, mean[r % GROUP], value);
		for (int v = 0; v < statistic->n_values; v++)
			if (!isnan(value[v]))
				resampled[v * POUND_RESAMPLES + defined[v]++] = value[v];
	}
	for (int v = 0; v < statistic->n_values; v++)
		if (defined[v] && !isnan(estimates[v].value)) {
			estimates[v].low = quantile(resampled + v * POUND_RESAMPLES, defined[v], 0.025);
			estimates[v].high = quantile(resampled + v * POUND_RESAMPLES, defined[v], 0.975);
		}
}

/* A statistic's values, with 95 % intervals by what its rows are.
 *
 * Given    scatter    -               groups: by leaving each out (jackknife.c); none: by resampling rows
 *          the rest                   as pound_interval_bootstrap has it
 * Returns  estimates  (n_values)
 * Memory   scratch    (pound_interval_scratch)
 *
 * Test     unit_jackknife: rows_in_groups_are_never_resampled
 */
void pound_interval_estimates(const struct pound_statistic *statistic, const struct pound_scatter *scatter,
                              int n_rows, uint64_t seed, int n_resamples, double *scratch,
                              struct pound_estimate *estimates)
{
	if (scatter->grouping.n)
		pound_jackknife_estimates(statistic, scatter, n_rows, scratch, estimates);
	else
		pound_interval_bootstrap(statistic, n_rows, seed, n_resamples, scratch, estimates);
}
