/* pair_peaks.inl - pairs of linear bodies without contact from sample to sample, one pair per SIMD lane.
 *
 * Included by pair_peaks_w8.c and so on, once per lane count. */
#include "engine/numeric/lanes.h"
#include "engine/run/pair_peaks.h"

/* State of one body of every pair. */
struct movement {
	vd u, v;
};

LANE_INLINE struct movement moved(const struct pound_pair_maps *maps, int i, struct movement from, vd a, vd d)
{
	const double *u = maps->u[i], *v = maps->v[i];
	return (struct movement){
	    vsplat(u[0]) * from.u + (vsplat(u[1]) * from.v + (vsplat(u[2]) * a + vsplat(u[3]) * d)),
	    vsplat(v[1]) * from.v + (vsplat(v[0]) * from.u + (vsplat(v[2]) * a + vsplat(v[3]) * d))};
}

/* Error bound of the cubic for a body's displacement, due to its own state. */
LANE_INLINE vd error_of(const struct pound_pair_maps *maps, int i, struct movement from)
{
	return vsplat(maps->error[i][0]) * vabs(from.u) + vsplat(maps->error[i][1]) * vabs(from.v);
}

/* Lane values of a sample as arrays. */
struct sample {
	double u[POUND_OSCILLATORS][W], v[POUND_OSCILLATORS][W], high[W], low[W], top[W], bottom[W];
};

LANE_INLINE void lanes_put(vd from, double to[W])
{
	__builtin_memcpy(to, &from, sizeof from);
}

/* Follows W pairs from `first` on; lanes beyond the last pair repeat it. */
static void group_follow(const struct pound_pairs *all, int first, struct pound_pair_peaks *peaks)
{
	const struct pound_pair_maps *maps = &all->maps;
	const int n_samples = all->tasks[0].n_samples, n = all->n - first < W ? all->n - first : W;
	const vd third = vsplat(all->tasks[0].time_step / 3), zero = vsplat(0);
	const vd forced_a = vsplat(maps->error[0][2] + maps->error[1][2]),
	         forced_d = vsplat(maps->error[0][3] + maps->error[1][3]);
	struct movement left = {zero, zero}, right = {zero, zero};
	vd inner = zero, top = zero, bottom = zero; // inner: p + third q
	vu ground;
	uint64_t start[W];
	for (int l = 0; l < W; l++)
		start[l] = (uint64_t)all->tasks[first + (l < n ? l : n - 1)].ground;
	__builtin_memcpy(&ground, start, sizeof start);
	vd a = vgather(ground);
	for (int s = 0; s + 1 < n_samples; s++) {
		ground += sizeof(double);
		const vd next = vgather(ground), d = next - a;
		const struct movement l1 = moved(maps, 0, left, a, d), r1 = moved(maps, 1, right, a, d);
		const vd error =
		    (error_of(maps, 0, left) + error_of(maps, 1, right)) + (forced_a * vabs(a) + forced_d * vabs(d));
		const vd p1 = l1.u - r1.u, step = third * (l1.v - r1.v), b2 = p1 - step;
		const vd high = vmax(b2, inner) + error, low = vmin(b2, inner) - error;
		top = vmax(top, p1);
		bottom = vmin(bottom, p1);
		// rarely, a larger displacement is possible inside the interval than at its ends
		unsigned more = vbits(vless(top, high) | vless(low, bottom)) & ((1u << n) - 1);
		if (more) {
			struct sample of;
			lanes_put(left.u, of.u[0]), lanes_put(left.v, of.v[0]);
			lanes_put(right.u, of.u[1]), lanes_put(right.v, of.v[1]);
			lanes_put(high, of.high), lanes_put(low, of.low);
			lanes_put(top, of.top), lanes_put(bottom, of.bottom);
			for (; more; more &= more - 1) {
				const int k = __builtin_ctz(more);
				struct pound_pair_note note = {
				    .from = {.u = {of.u[0][k], of.u[1][k]}, .v = {of.v[0][k], of.v[1][k]}},
				    .most = {of.high[k], -of.low[k]}};
				pound_pair_sample(&peaks[first + k], &all->tasks[first + k], s, &note,
				                  (const double[2]){of.top[k], -of.bottom[k]});
			}
		}
		left = l1, right = r1, inner = p1 + step, a = next;
	}
	double most[2][W];
	lanes_put(top, most[0]), lanes_put(-bottom, most[1]);
	for (int k = 0; k < n; k++)
		for (int way = 0; way < 2; way++)
			if (most[way][k] > peaks[first + k].peak[way])
				peaks[first + k].peak[way] = most[way][k];
}

void POUND_PAIR_PEAKS(const struct pound_pairs *all, struct pound_pair_peaks *peaks)
{
	for (int first = 0; first < all->n; first += W)
		group_follow(all, first, peaks);
}
