/* noise.inl - random ground motions; filtered signals are computed in lanes, one signal per lane.
 *
 * Each sample of a filter depends on the previous one: computed alone, a signal takes four times as long as its operations
 * need, because of latency.  The bits of a signal do not depend on its lane or on the other lanes. */
#include <assert.h>
#include <math.h>
#include <stdbool.h>
#include <string.h>

#include "engine/ground/largest.h"
#include "engine/ground/noise.h"
#include "engine/ground/normals.h"
#include "engine/numeric/lanes.h"

enum { N = FILTER_STATES, NUMBERS = NOISE_WORDS * NOISE_CHUNK };

static_assert((int)N <= (int)ROW, "the state before the first sample comes from one row of numbers");

/* the filters of all lanes: struct pound_filter with a vector for each double */
struct filters {
	vd pole[N], zero[N], start[N][N];
};

static_assert(sizeof(struct filters) == W * sizeof(struct pound_filter),
              "a filter is doubles and nothing else");

/* The next sample of every lane, by the recurrence of kanai_tajimi.h. */
LANE_INLINE vd sample_next(const struct filters *f, vd z, vd x[N])
{
	const vd old = x[0];
	for (int i = 0; i < N - 1; i++)
		x[i] = (x[i] + x[i + 1] + f->zero[N - 1 - i] * z) - f->pole[N - 1 - i] * old;
	x[N - 1] = (x[N - 1] + f->zero[0] * z) - f->pole[0] * old;
	return x[0];
}

/* Copies a row of samples to a signal from sample `at` on, without samples before its first or after its last one. */
LANE_INLINE void row_part(const struct pound_noise *signal, int at, const double row[ROW])
{
	for (int j = at < 0 ? -at : 0; j < ROW && at + j < signal->n; j++)
		signal->a[at + j] = row[j];
}

/* Up to W filtered signals, up to the end of the longest. */
static void filtered_run(const struct pound_noise *signals, int n_signals)
{
	struct filters f;
	for (size_t k = 0; k < sizeof(struct pound_filter) / sizeof(double); k++) {
		double of[W];
		for (int l = 0; l < W; l++)
			of[l] = ((const double *)signals[l < n_signals ? l : 0].filter)[k];
		((vd *)&f)[k] = lanes_load(of);
	}
	int longest = 0, shortest = n_signals < W ? 0 : signals[0].n;
	for (int l = 0; l < n_signals; l++) {
		longest = signals[l].n > longest ? signals[l].n : longest;
		shortest = signals[l].n < shortest ? signals[l].n : shortest;
	}
	double z[W][NOISE_WORDS][NOISE_CHUNK], row[W][ROW];
	const double *from[W];
	double *to[W];
	for (int l = 0; l < W; l++)
		from[l] = z[l][0];
	memset(z, 0, sizeof z);
	vd x[N] = {vsplat(0), vsplat(0), vsplat(0), vsplat(0)};
	// normal number k, counted through all chunks in memory order, drives sample k - N; the first N give the initial state
	for (int first = 0; first < longest + N; first += NUMBERS) {
		for (int l = 0; l < n_signals; l++)
			if (first < signals[l].n + N)
				POUND_NORMALS(signals[l].stream, (uint32_t)(first / NOISE_WORDS), z[l]);
		for (int k = 0; k < NUMBERS && first + k < longest + N; k += ROW) {
			vd noise[ROW], out[ROW];
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
			const int at = first + k - N;
			const bool whole = at >= 0 && at + ROW <= shortest;
			for (int l = 0; l < W; l++)
				to[l] = whole ? signals[l].a + at : row[l];
			rows_store(out, to, 0);
			for (int l = 0; l < n_signals && !whole; l++)
				row_part(&signals[l], at, row[l]);
		}
	}
}

static void white_run(const struct pound_noise *signal)
{
	double z[NOISE_WORDS][NOISE_CHUNK];
	for (int i = 0; i < signal->n; i++) {
		const int l = i / NOISE_WORDS % NOISE_CHUNK, w = i % NOISE_WORDS;
		if (l == 0 && w == 0)
			POUND_NORMALS(signal->stream, (uint32_t)(i / NOISE_WORDS), z);
		signal->a[i] = z[w][l];
	}
}

/* Multiplies by a trapezoid: up from 0 in the first fraction `rise` of the duration, down to 0 in the last fraction `fall`. */
static void shape(double rise, double fall, int n, double *a)
{
	const double up = rise * (n - 1), down = fall * (n - 1);
	const double upward = 1 / up, downward = 1 / down;
	const int n_up = (int)ceil(up), n_down = (int)ceil(down);
	for (int i = 0; i < n_up; i++)
		a[i] *= i * upward;
	for (int i = 0; i < n_down; i++)
		a[n - 1 - i] *= i * downward;
}

/* Scales the largest |a| to the peak; the division comes first, so that nothing overflows or underflows. */
static void scale(double peak, int n, double *a)
{
	const double largest = ground_largest(n, a);
	if (largest > 0)
		for (int i = 0; i < n; i++)
			a[i] = a[i] / largest * peak;
}

/* Random ground motions.
 *
 * Given    signals  (n)   fastest if adjacent filtered signals have about the same length
 * Returns  signals  a     m/s2
 *
 * Test     unit_kanai_tajimi, unit_excitation
 */
void POUND_NOISE(const struct pound_noise *signals, int n)
{
	for (int first = 0, end; first < n; first = end) {
		for (end = first + 1; end < n && end - first < W && signals[first].filter && signals[end].filter;
		     end++)
			;
		if (signals[first].filter)
			filtered_run(&signals[first], end - first);
		else
			white_run(&signals[first]);
		for (int l = first; l < end; l++) {
			shape(signals[l].rise, signals[l].fall, signals[l].n, signals[l].a);
			if (signals[l].peak > 0)
				scale(signals[l].peak, signals[l].n, signals[l].a);
		}
	}
	lanes_leave();
}
