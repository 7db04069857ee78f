/* filtered_noise.inl - filtered noise, many signals side by side in lanes.
 *
 * From sample to sample a filter waits for its own result: one signal alone takes four times as long as its operations.
 * A signal's bits do not depend on its lane or its neighbours. */
#include <assert.h>
#include <string.h>

#include "engine/ground/kanai_tajimi.h"
#include "engine/ground/normals.h"
#include "engine/numeric/lanes.h"

enum { N = FILTER_STATES, NUMBERS = NOISE_WORDS * NOISE_CHUNK };

static_assert((int)N <= (int)ROW, "the state before the first sample comes from one row of numbers");

/* the filters of the lanes: struct pound_filter, in vectors */
struct filters {
	vd pole[N], zero[N], start[N][N];
};

static_assert(sizeof(struct filters) == W * sizeof(struct pound_filter),
              "a filter is doubles and nothing else");

/* One sample of every lane; kanai_tajimi.h has the recurrence. */
LANE_INLINE vd sample_next(const struct filters *f, vd z, vd x[N])
{
	const vd old = x[0];
	for (int i = 0; i < N - 1; i++)
		x[i] = (x[i] + x[i + 1] + f->zero[N - 1 - i] * z) - f->pole[N - 1 - i] * old;
	x[N - 1] = (x[N - 1] + f->zero[0] * z) - f->pole[0] * old;
	return x[0];
}

/* Up to W signals, as far as the longest goes. */
static void group_run(const struct pound_filtered *signals, int n_signals)
{
	struct filters f;
	for (size_t k = 0; k < sizeof(struct pound_filter) / sizeof(double); k++) {
		double of[W];
		for (int l = 0; l < W; l++)
			of[l] = ((const double *)&signals[l < n_signals ? l : 0].filter)[k];
		((vd *)&f)[k] = lanes_load(of);
	}
	int longest = 0;
	for (int l = 0; l < n_signals; l++)
		longest = signals[l].n > longest ? signals[l].n : longest;
	double z[W][NOISE_WORDS][NOISE_CHUNK], a[W][NUMBERS];
	memset(z, 0, sizeof z);
	vd x[N] = {vsplat(0), vsplat(0), vsplat(0), vsplat(0)};
	// number k of the chunks' numbers, in the order they lie in, makes sample k - N; the first N make the state before
	for (int first = 0; first < longest + N; first += NUMBERS) {
		for (int l = 0; l < n_signals; l++)
			if (first < signals[l].n + N)
				POUND_NORMALS(signals[l].noise, (uint32_t)(first / NOISE_WORDS), z[l]);
		for (int k = 0; k < NUMBERS; k += ROW) {
			vd noise[ROW], out[ROW];
			const double *from[W];
			double *to[W];
			for (int l = 0; l < W; l++) {
				from[l] = z[l][0];
				to[l] = a[l];
			}
			rows_load(noise, from, k);
			int j = 0;
			if (first + k == 0)
				for (; j < N; j++) {
					for (int i = 0; i < N; i++)
						x[i] += f.start[i][j] * noise[j];
					out[j] = vsplat(0);
				}
			for (; j < ROW; j++)
				out[j] = sample_next(&f, noise[j], x);
			rows_store(out, to, k);
		}
		const int skipped = first == 0 ? N : 0;
		for (int l = 0; l < n_signals; l++) {
			const int left = signals[l].n + N - first;
			const int made = (left < NUMBERS ? left : NUMBERS) - skipped;
			if (left > 0)
				memcpy(signals[l].a + first + skipped - N, a[l] + skipped, sizeof(double) * (size_t)made);
		}
	}
}

/* Samples of the stationary outputs of filters.
 *
 * Given    signals  (n)  of about one length, or lanes wait for the longest
 * Returns  signals  a
 *
 * Test     unit_kanai_tajimi
 */
void POUND_FILTERED_NOISE(const struct pound_filtered *signals, int n)
{
	for (int first = 0; first < n; first += W)
		group_run(&signals[first], n - first < W ? n - first : W);
	lanes_leave();
}
