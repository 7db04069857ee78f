/* noise.inl - ground motions of noise, many filtered signals side by side in lanes.
 *
 * From sample to sample a filter waits for its own result: one signal alone takes four times as long as its operations.
 * A signal's bits do not depend on its lane or its neighbours. */
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

/* The part of a row of samples that a signal has, from its sample `at` on. */
LANE_INLINE void row_part(const struct pound_noise *signal, int at, const double row[ROW])
{
	for (int j = at < 0 ? -at : 0; j < ROW && at + j < signal->n; j++)
		signal->a[at + j] = row[j];
}

/* Up to W filtered signals, as far as the longest goes. */
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
	// number k of the chunks' numbers, in the order they lie in, makes sample k - N; the first N make the state before
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

/* a[i] times a trapezoid: up from 0 over the first `rise` of the time, down to 0 over the last `fall` */
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

/* a times what makes its largest |a| the peak; dividing first, nothing in between is too large or too small */
static void scale(double peak, int n, double *a)
{
	const double largest = ground_largest(n, a);
	if (largest > 0)
		for (int i = 0; i < n; i++)
			a[i] = a[i] / largest * peak;
}

/* Ground motions of noise.
 *
 * Given    signals  (n)  filtered ones of about one length, or lanes wait for the longest
 * Returns  signals  a
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
