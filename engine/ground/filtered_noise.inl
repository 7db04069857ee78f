/* filtered_noise.inl - filtered noise, many signals side by side in lanes.
 *
 * From sample to sample a filter waits for its own result: one signal alone takes four times as long as its operations.
 * A signal's bits do not depend on its lane or its neighbours. */
#include <assert.h>
#include <string.h>

#include "engine/ground/kanai_tajimi.h"
#include "engine/ground/normals.h"
#include "engine/numeric/lanes.h"

enum { N = FILTER_STATES };

/* the filters of the lanes: struct pound_filter, in vectors */
struct filters {
	vd transition[N][N], step[N][N], start[N][N], output[2];
};

static_assert(sizeof(struct filters) == W * sizeof(struct pound_filter),
              "a filter is doubles and nothing else");

LANE_INLINE vd combined(const vd row[N], const vd x[N])
{
	return (row[0] * x[0] + row[1] * x[1]) + (row[2] * x[2] + row[3] * x[3]);
}

/* One sample of every lane. */
LANE_INLINE vd sample_next(const struct filters *f, const vd added[N][N], const vd z[N], vd x[N])
{
	vd next[N];
	for (int i = 0; i < N; i++)
		next[i] = combined(added[i], z) + combined(f->transition[i], x);
	for (int i = 0; i < N; i++)
		x[i] = next[i];
	return f->output[0] * x[0] + f->output[1] * x[1];
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
	double z[W][NOISE_WORDS][NOISE_CHUNK], a[W][NOISE_CHUNK];
	memset(z, 0, sizeof z);
	vd x[N] = {vsplat(0), vsplat(0), vsplat(0), vsplat(0)};
	for (int first = 0; first < longest; first += NOISE_CHUNK) {
		for (int l = 0; l < n_signals; l++)
			if (first < signals[l].n)
				POUND_NORMALS(signals[l].noise, (uint32_t)first, z[l]);
		for (int k = 0; k < NOISE_CHUNK; k += ROW) {
			vd noise[NOISE_WORDS][ROW], out[ROW];
			for (int w = 0; w < NOISE_WORDS; w++) {
				const double *row[W];
				for (int l = 0; l < W; l++)
					row[l] = z[l][w];
				rows_load(noise[w], row, k);
			}
			for (int j = 0; j < ROW; j++)
				out[j] = sample_next(&f, first + k + j ? f.step : f.start,
				                     (vd[]){noise[0][j], noise[1][j], noise[2][j], noise[3][j]}, x);
			double *row[W];
			for (int l = 0; l < W; l++)
				row[l] = a[l];
			rows_store(out, row, k);
		}
		for (int l = 0; l < n_signals; l++) {
			int left = signals[l].n - first;
			if (left > 0)
				memcpy(signals[l].a + first, a[l],
				       sizeof(double) * (size_t)(left < NOISE_CHUNK ? left : NOISE_CHUNK));
		}
	}
}

/* Samples of the stationary outputs of filters.
 *
 * Given    signals  (n)  sample k of one takes draw k of its stream; of about one length, or lanes wait for the longest
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
