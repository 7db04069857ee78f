/* contact_map.inl - exact maps of contact, over a substep and over many substeps at once.
 *
 * Included by exact.inl alone, once per lane count: the columns of a map are made side by side in lanes.
 *
 * 1. In contact the bodies are one linear system: over a substep, a fraction of a radian of the contact's own
 *    frequency, its map is a power series.
 * 2. Doubled maps each cover eight times as many substeps as the one before, by doubling; stored as increments of the
 *    state, so that small terms are not lost beside 1.
 * 3. A bound proves that bodies stay in contact over a doubled map, however often the overlap oscillates within.
 *
 * Included by exact.inl after series.inl. */

#include <assert.h>
#include <float.h>
#include <math.h>
#include <string.h>

#include "engine/exact/tolerances.h"
#include "engine/numeric/lanes.h"

enum {
	N = POUND_CONTACT_INPUTS,
	MOVED = CONTACT_IMPULSE +
	        1, /* rows of increments: of the state, in the order of the inputs, and of the impulse */
	DOUBLINGS =
	    3, /* from a doubled map to the next; more if POUND_DOUBLED_MAPS maps would not reach a sample */
	DOUBLED_RATIO = 1 << DOUBLINGS,
};

/* Constants that split the motion into the bodies' common motion and the overlap's own: see doubled_bounds. */
static void split_fill(double split[N], const struct simulation *sim)
{
	const struct state_rows *x = &sim->x;
	const int o = 1 - sim->base;
	const double share = (sim->base ? -x->mass_ratio : 1) / x->both;
	const double dc = x->body[1].damping - x->body[0].damping,
	             dk = x->body[1].stiffness - x->body[0].stiffness;
	const double stiffness = x->both * x->contact_stiffness + x->body[o].stiffness - dk * share;
	split[SPLIT_DAMPING] = dc;
	split[SPLIT_STIFFNESS] = dk;
	split[SPLIT_BASE] = share;
	split[SPLIT_OMEGA] = sqrt(stiffness);
	split[SPLIT_TWO_ZETA] =
	    (x->both * x->contact_damping + x->body[o].damping - dc * share) / split[SPLIT_OMEGA];
	split[SPLIT_PHASE_LEAD] = sqrt(1 + x->release * x->release * stiffness);
	split[SPLIT_SUBSTEPS] = 1;
}

/* Static overlap per closing acceleration. */
static double yield_of(const double split[N])
{
	return 1 / (split[SPLIT_OMEGA] * split[SPLIT_OMEGA]);
}

/* Adds term n of the rates of base and overlap, times the substep's length, at the nodes of a quadrature. */
static void rates_add(double rates[POUND_GAUSS][2][N], int n, int column, vd w, vd z)
{
	for (int g = 0; g < POUND_GAUSS; g++) {
		double node = g < POUND_GAUSS / 2 ? -POUND_GAUSS_NODE[g] : POUND_GAUSS_NODE[g - POUND_GAUSS / 2];
		double power = 1;
		for (int m = 0; m < n; m++)
			power *= 0.5 + 0.5 * node;
		double *v = &rates[g][0][column], *q = &rates[g][1][column];
		lanes_store(v, vfma(vsplat(power), w, lanes_load(v)));
		lanes_store(q, vfma(vsplat(power), z, lanes_load(q)));
	}
}

/* Rewrites a linear form of the inputs in terms of the overlap off its equilibrium, p - g/W^2, instead of p.
 *
 * When there is little loss, as without oscillation, the quadratic form then has small terms, not a small difference of
 * large ones, whose error would grow with every doubling.
 */
static void form_off(double row[N], const double split[N])
{
	double yield = yield_of(split), slack = row[2] / (1 + yield * split[SPLIT_STIFFNESS] * split[SPLIT_BASE]);
	double closing = slack * yield, rate = closing * split[SPLIT_DAMPING];
	row[0] += closing * split[SPLIT_STIFFNESS];
	row[1] += rate;
	row[2] = slack;
	row[3] -= rate * split[SPLIT_BASE];
	row[5] += closing;
}

/* Energy loss in the dashpots of both bodies and the contact over a substep, per mass of the left body, as a quadratic form of
 * the inputs with the overlap off its equilibrium: the integral of m c v^2 by quadrature, exact to rounding. */
static void loss_fill(double loss[N][N], double rates[POUND_GAUSS][2][N], const double split[N],
                      const struct simulation *sim)
{
	const struct state_rows *x = &sim->x;
	const double mass[2] = {1, x->right_mass};
	const int b = sim->base, o = 1 - b;
	memset(loss, 0, sizeof(double[N][N]));
	for (int g = 0; g < POUND_GAUSS; g++) {
		double *v = rates[g][0], *q = rates[g][1];
		form_off(v, split);
		form_off(q, split);
		for (int i = 0; i < N; i++)
			for (int j = 0; j < N; j++) {
				double other = (v[i] - x->side * q[i]) * (v[j] - x->side * q[j]);
				double rate = mass[b] * x->body[b].damping * v[i] * v[j] +
				              mass[o] * x->body[o].damping * other + x->contact_damping * q[i] * q[j];
				loss[i][j] += 0.5 * POUND_GAUSS_WEIGHT[g % (POUND_GAUSS / 2)] * rate / x->substep;
			}
	}
}

/* Exact map of the base body and the overlap over one substep h of contact, by its power series.
 *
 * Given    sim    its bodies on their branches, contact
 * Returns  map    rows of POUND_CONTACT_INPUTS coefficients
 *          work   forms for the energy balance; NULL: not requested
 *
 *   ub'' = -cb ub' - kb ub - (Ab + Db t/h) - s (K p + C p')        s = 1 for the left body, -m1/m2 for the right
 *   p''  = (c2 - c1) ub' + (k2 - k1) ub - co p' - ko p - (1 + m1/m2) (K p + C p') + Ap + Dp t/h
 *
 * with the other body (o) at the distance of gap and overlap from the base (b).  The error of a cubic is at most 1/288 of
 * the largest fourth derivative (POUND_CUBIC_ERROR), which by linearity is at most the sum of the inputs' magnitudes times
 * the fourth derivatives of their columns.
 */
static void substep_fill(struct pound_contact_map *map, struct pound_contact_work *work,
                         const struct simulation *sim)
{
	const struct state_rows *x = &sim->x;
	const int b = sim->base, o = 1 - b;
	const double h = x->substep, h2 = h * h, push = b ? -x->mass_ratio : 1;
	const double K = x->contact_stiffness * h2, C = x->contact_damping * h;
	const double dc = (x->body[1].damping - x->body[0].damping) * h;
	const double dk = (x->body[1].stiffness - x->body[0].stiffness) * h2;
	const double cb = x->body[b].damping * h, kb = x->body[b].stiffness * h2;
	const double co = x->body[o].damping * h + x->both * C, ko = x->body[o].stiffness * h2 + x->both * K;
	const double start[4][N] = {{1}, {0, h}, {0, 0, 1}, {0, 0, 0, h}}; // rates times h
	const double force_b[2][N] = {{[4] = -h2}, {[6] = -h2}}, force_p[2][N] = {{[5] = h2}, {[7] = h2}};
	double rates[POUND_GAUSS][2][N];
	double(*row)[N] = map->row;
	if (work)
		memset(rates, 0, sizeof rates);
	split_fill(row[CONTACT_SPLIT], sim);
	for (int j = 0; j < N; j += W) {
		vd zero = vsplat(0), sum[4] = {zero, zero, zero, zero}, area = zero, mean = zero, error = zero;
		vd u = lanes_load(&start[0][j]), w = lanes_load(&start[1][j]);
		vd p = lanes_load(&start[2][j]), z = lanes_load(&start[3][j]);
		for (int n = 0; n < POUND_MAP_ORDERS; n++) {
			double share = 1.0 / (n + 1),
			       fourth_factor = POUND_CUBIC_ERROR * n * (n - 1.0) * (n - 2.0) * (n - 3.0);
			const vd terms[4] = {u, w, p, z};
			for (int r = 0; r < 4 && n > 0; r++)
				sum[r] = sum[r] + terms[r];
			area = vfma(p, vsplat(share), area);
			mean = vfma(u, vsplat(share), mean);
			error = vfma(vsplat(fourth_factor), vmax(vabs(u), vabs(p)), error);
			if (work)
				rates_add(rates, n, j, w, z);
			vd w1 = -vfma(vsplat(kb * share), u, vsplat(push * K * share) * p);
			vd z1 = vfma(vsplat(dk * share), u, vsplat(-ko * share) * p);
			if (n < 2) {
				w1 = vfma(vsplat(share), lanes_load(&force_b[n][j]), w1);
				z1 = vfma(vsplat(share), lanes_load(&force_p[n][j]), z1);
			}
			u = w * vsplat(share);
			p = z * vsplat(share);
			w1 = vfma(vsplat(-cb * share), w, vfma(vsplat(-push * C * share), z, w1));
			z = vfma(vsplat(-co * share), z, vfma(vsplat(dc * share), w, z1));
			w = w1;
		}
		lanes_store(&row[CONTACT_U][j], sum[0]);
		lanes_store(&row[CONTACT_V][j], sum[1] / vsplat(h));
		lanes_store(&row[CONTACT_P][j], sum[2]);
		lanes_store(&row[CONTACT_Q][j], sum[3] / vsplat(h));
		lanes_store(&row[CONTACT_IMPULSE][j],
		            vfma(vsplat(x->contact_stiffness * h), area, vsplat(x->contact_damping) * sum[2]));
		lanes_store(&row[CONTACT_ERROR][j], error);
		if (work) {
			lanes_store(&work->mean_base[j], mean);
			lanes_store(&work->mean_overlap[j], area);
		}
	}
	if (work)
		loss_fill(work->loss, rates, row[CONTACT_SPLIT], sim);
}

/* ---- doubled maps ---- */

/* Doubles the length of a map: with s the state, f the forcing and d its growth over the length,
 *
 *   R s + R s',   s' = s + X s + F f + D d      in terms of s, f and 2 d, for each row R of (X F D) and the impulse's
 */
static void map_double(double row[][N])
{
	double once[MOVED][N];
	memcpy(once, row, sizeof once);
	for (int r = 0; r < MOVED; r++) {
		double grown[2];
		for (int j = 0; j < N; j += W) {
			vd again = vsplat(once[r][0]) * lanes_load(&once[0][j]);
			for (int m = 1; m < 4; m++)
				again = vfma(vsplat(once[r][m]), lanes_load(&once[m][j]), again);
			lanes_store(&row[r][j], vfma(vsplat(2), lanes_load(&once[r][j]), again));
		}
		for (int j = 0; j < 2; j++)
			grown[j] = 0.5 * (row[r][6 + j] + once[r][4 + j]);
		memcpy(&row[r][6], grown, sizeof grown);
	}
}

/* Matrix from the inputs of one map to the inputs of the next of equal length; off: the overlap is off its equilibrium. */
static void inputs_next(double next[N][N], const double row[][N], bool off)
{
	const double *split = row[CONTACT_SPLIT];
	for (int i = 0; i < N; i++)
		for (int j = 0; j < N; j++)
			next[i][j] = (i == j) + (i < 4 ? row[i][j] : i < 6 && j == i + 2);
	if (!off)
		return;
	for (int i = 0; i < N; i++)
		form_off(next[i], split);
	for (int j = 0; j < N; j++) {
		double w = next[0][j] - split[SPLIT_BASE] * next[2][j],
		       rate = next[1][j] - split[SPLIT_BASE] * next[3][j];
		double closing = split[SPLIT_DAMPING] * rate + split[SPLIT_STIFFNESS] * w + next[5][j];
		next[2][j] -= yield_of(split) * closing;
	}
}

/* Doubles the length of the energy forms.
 *
 * Given    row   rows of the map over the single length
 */
static void work_double(struct pound_contact_work *work, const double row[][N])
{
	double next[N][N], once[N][N], half[2][N], *const mean[2] = {work->mean_base, work->mean_overlap};
	inputs_next(next, row, false);
	for (int i = 0; i < 2; i++)
		for (int j = 0; j < N; j++) {
			half[i][j] = mean[i][j];
			for (int m = 0; m < N; m++)
				half[i][j] += mean[i][m] * next[m][j];
		}
	inputs_next(next, row, true);
	for (int i = 0; i < N; i++)
		for (int j = 0; j < N; j++) {
			once[i][j] = 0;
			for (int m = 0; m < N; m++)
				once[i][j] += work->loss[i][m] * next[m][j];
		}
	for (int i = 0; i < N; i++) {
		double share = i < 6 ? 1 : 0.5; // growths are over the whole length from here on
		for (int m = 0; m < 2; m++)
			mean[m][i] = 0.5 * share * half[m][i];
		for (int j = 0; j < N; j++) {
			double again = 0;
			for (int m = 0; m < N; m++)
				again += next[m][i] * once[m][j];
			work->loss[i][j] = share * (j < 6 ? 1 : 0.5) * (work->loss[i][j] + again);
		}
	}
}

/* Bounds that prove that no event occurs over a doubled map of length h.
 *
 * With the slow coordinate w = ub - s/(1 + m1/m2) p of the bodies' common motion
 *
 *   p'' + G p' + W^2 p = g,   g = (c2 - c1) w' + (k2 - k1) w + Ap + Dp t/h       w'' = -cw w' - kw w - Aw + kp p + kq p'
 *
 * where the damping, stiffness and forcing with the index w are means of both bodies weighted by mass.  The closing acceleration g
 * follows a straight line of slope r = (g1 - g0)/h up to a deviation b, and the overlap follows this line with a lag:
 *
 *   e = p - (g0 + r t)/W^2 + G r/W^4      e'' + G e' + W^2 e = b
 *
 * V = (e'^2 + (W e - b/W)^2)^1/2 grows by |b'|/W at most.  Bodies in contact have |p'| <= g/W and p <= 2 g/W^2: bounds that hold
 * up to a first release prove that there is none.  So f = |kp p + kq p'| is bounded.  The remainder of w'' differs from its
 * mean, (w1' - w0')/h less the mean of f, by at most its own growth: with F = 1/(1 - h (cw + kw h))
 *
 *   A2 = F (|w1' - w0'|/h + 2 f + h kw |w'| + |Dw|) bounds w'', and so B = h^2 |g''| is bounded:
 *
 * b is at most B/8, and |b'| integrates to at most B/2.  With these W V is bounded, and the bodies stay in contact while the line
 * less its lag, W V and B/8 is positive.  Meanwhile |p'| is at most (W V + |r|/W)/W, |p''| (1 + G/W) W V, and kp p grows by
 * kp (W V + |g1 - g0|)/W^2, which is no more than the terms in g with W V + |r|/W + |g1 - g0| in place of g.  So bodies at
 * rest have small bounds, however large the contact force, and under a growing contact force their velocity keeps its sign.
 * w - kq int e is slower than w: its fourth derivative bounds the error of the cubic of w, to which 4 |kq| h |e| is
 * added for the remainder, e with B/8 for the deviation of int p from a cubic.  The rounding allowance is that of the
 * increment, that is of h w' and of the terms of h^2 w''; for w itself sustained_contact() adds the rounding of w: creeping bodies
 * may move less than that, and their velocity still has a sign.
 */
static void doubled_bounds(struct pound_contact_map *map, const struct simulation *sim, double substeps)
{
	const struct state_rows *x = &sim->x;
	const int b = sim->base, o = 1 - b;
	double *split = map->row[CONTACT_SPLIT];
	split[SPLIT_SUBSTEPS] = substeps;
	const double h = x->substep * substeps, share = split[SPLIT_BASE], omega = split[SPLIT_OMEGA];
	const double dc = split[SPLIT_DAMPING], dk = split[SPLIT_STIFFNESS], yield = yield_of(split);
	const double cw = x->body[b].damping + share * dc, kw = x->body[b].stiffness + share * dk;
	const double kp = fabs(share * (x->body[o].stiffness - kw)), kq = fabs(share * (x->body[o].damping - cw));
	const double jerk = kp / omega + kq * (1 + split[SPLIT_TWO_ZETA]),
	             jounce = kp * (1 + split[SPLIT_TWO_ZETA]);
	const double quartic = h * h * h * h * POUND_CUBIC_ERROR, rounding = 4 * DBL_EPSILON;
	const double ahead = 1 / (1 - h * (cw + kw * h));
	split[SPLIT_RESIDUAL] = 4 * kq * h;
	// of the magnitudes of w, w', g, w1' - w0', Ab, Ap, Db, Dp
	const double a0[N] = {[1] = kw * h, 2 * (2 * kp * yield + kq / omega), 1 / h, [6] = 1, fabs(share)};
	const double grown[N] = {[6] = 1 / h, [7] = fabs(share) / h};
	for (int j = 0; j < N; j++)
		map->closing[j] = dc * (map->row[CONTACT_V][j] - share * map->row[CONTACT_Q][j]) +
		                  dk * (map->row[CONTACT_U][j] - share * map->row[CONTACT_P][j]) + (j == 7);
	// twice, for the cancellation in the difference of rates
	const double rounded[N] = {2 * fabs(dk), 2 * fabs(dc), 1, 0, 0, 1};
	const double lost[N] = {2 * kw * h * h, h, 0, 0, h * h, 2 * fabs(share) * h * h};
	for (int j = 0; j < N; j++) {
		double a2 = ahead * a0[j], a1 = (j == 1) + h * a2;
		double a3 = cw * a2 + kw * a1 + grown[j] + (j == 2 ? jerk : 0);
		double a4 = cw * a3 + kw * a2 + (j == 2 ? jounce : 0);
		map->row[DOUBLED_CURVATURE][j] = h * h * (fabs(dc) * a3 + fabs(dk) * a2) + rounding * rounded[j];
		map->row[DOUBLED_ERROR][j] = quartic * a4 + rounding * lost[j];
	}
}

/* Fills the doubled maps: of as many substeps as a whole sample has, or of an eighth, a 64th ... */
static void doubled_fill(struct pound_doubled_maps *doubled, const struct pound_contact_map *substep,
                         const struct simulation *sim)
{
	double substeps = 1;
	struct pound_contact_map map = *substep;
	struct pound_contact_work *work = doubled->work;
	for (int r = 0; r < sim->n_doubled; r++) {
		if (sim->task->accounted)
			work[r] = work[r > 0 ? r - 1 : POUND_DOUBLED_MAPS];
		for (; substeps < sim->doubled_substeps[r]; substeps *= 2) {
			if (sim->task->accounted)
				work_double(&work[r], map.row);
			map_double(map.row);
		}
		doubled->map[r] = map;
		doubled_bounds(&doubled->map[r], sim, substeps);
	}
}

/* Chooses the lengths of a simulation's doubled maps: one substep, then lengths up to a whole sample, as far as the bodies' own
 * rates allow.  Few substeps per sample are as fast one by one. */
static void doubled_choose(struct simulation *sim)
{
	const struct state_rows *x = &sim->x;
	double first = x->substeps_per_sample;
	int doublings = DOUBLINGS; // from a doubled map to the next
	if (first <= DOUBLED_RATIO)
		return;
	sim->doubled_ratio = DOUBLED_RATIO;
	if (first >
	    0x1p53) // a double cannot count them one by one: contact_ready ends such a simulation as chatter
		return;
	while (ldexp(1, doublings * (POUND_DOUBLED_MAPS - 1)) < first)
		doublings++;
	const double ratio = sim->doubled_ratio = ldexp(1, doublings);
	while (first > ratio)
		first /= ratio;
	for (double substeps = 1; substeps <= x->substeps_per_sample && sim->n_doubled < POUND_DOUBLED_MAPS;
	     substeps *= substeps == 1 ? first : ratio) {
		double h = substeps * x->substep;
		for (int i = 0; i < POUND_OSCILLATORS; i++)
			if (h * (x->body[i].damping + sim->task->bodies[i].backbone.stiffness * h) > 0.5)
				return;
		sim->doubled_substeps[sim->n_doubled++] = substeps;
	}
}

/* A row of a map applied to its inputs; summed in pairs to shorten the dependency chain. */
static double row_at(const double row[N], const double x[N])
{
	double slow = row[6] * x[6] + row[7] * x[7], force = row[4] * x[4] + row[5] * x[5];
	return (row[0] * x[0] + row[1] * x[1] + slow) + (row[2] * x[2] + row[3] * x[3] + force);
}

/* Upper bound of (x^2 + y^2)^1/2 without overflow: the larger plus 2^1/2 - 1 of the smaller.  Coarser than in sustained_contact():
 * here it only chooses a doubled map. */
static double length_above(double x, double y)
{
	double a = fabs(x), b = fabs(y);
	return a < b ? b + 0.4143 * a : a + 0.4143 * b;
}

/* Oscillation of the overlap at the start of a doubled map: W p', W^2 p - g, and g. */
struct swing {
	double rate, off, closing;
};

/* Whether bodies are proved to stay in contact over a doubled map: see doubled_bounds.
 *
 * Given    x     inputs;  bound  magnitudes of w, w', g, w1' - w0', and of x from there on
 *          h     length of the doubled map [s]
 */
static bool stays_in_contact(const struct pound_contact_map *map, const double x[N], double bound[N],
                             const struct swing *start, double h)
{
	const double closing = start->closing;
	const double *split = map->row[CONTACT_SPLIT];
	double change = row_at(map->closing, x), closing1 = closing + change,
	       drift = change / (split[SPLIT_OMEGA] * h);
	bound[2] = fabs(closing) + fabs(closing1);
	bound[3] = fabs(row_at(map->row[CONTACT_V], x) - split[SPLIT_BASE] * row_at(map->row[CONTACT_Q], x));
	bound[6] = fabs(x[6]);
	bound[7] = fabs(x[7]);
	double curvature = row_at(map->row[DOUBLED_CURVATURE], bound);
	double swing =
	    length_above(start->rate - drift, start->off + split[SPLIT_TWO_ZETA] * drift) + 0.5 * curvature;
	double phase_lag = fmax(split[SPLIT_TWO_ZETA], split[SPLIT_PHASE_LEAD]) * fabs(drift);
	return split[SPLIT_PHASE_LEAD] * swing + phase_lag + 0.125 * curvature <
	       (change < 0 ? closing1 : closing);
}

/* The longest doubled map over which bodies are proved to stay in contact; NULL: none. */
static const struct pound_contact_map *doubled_longest(struct simulation *sim,
                                                       struct pound_contact_maps *maps)
{
	struct state_rows *x = &sim->x;
	const double *split = maps->substep.row[CONTACT_SPLIT], omega = split[SPLIT_OMEGA];
	double in[N] = {x->u[sim->base],
	                x->v[sim->base],
	                x->p,
	                x->q,
	                x->base_drive * x->ground + x->base_force,
	                x->gap_drive * x->ground + x->gap_force};
	double w = in[0] - split[SPLIT_BASE] * x->p, rate = in[1] - split[SPLIT_BASE] * x->q;
	double bound[N] = {[0] = fabs(w), [1] = fabs(rate), [4] = fabs(in[4]), [5] = fabs(in[5])};
	double closing = split[SPLIT_DAMPING] * rate + split[SPLIT_STIFFNESS] * w + in[5];
	const struct swing start = {
	    .rate = omega * x->q, .off = omega * omega * x->p - closing, .closing = closing};
	// identical bodies with zero overlap and rate stay so over any doubled map
	const bool still = sim->traits & TRAIT_ALIKE && x->p == 0 && x->q == 0;
	if (!still && !(split[SPLIT_PHASE_LEAD] * length_above(start.rate, start.off) < closing))
		return NULL;
	struct pound_doubled_maps *doubled = maps->doubled;
	if (!maps->has_doubled)
		doubled_fill(doubled, &maps->substep, sim);
	maps->has_doubled = true;
	const double *ground = &sim->ground[sim->next],
	             rise = (ground[0] - ground[-1]) * (1 / x->substeps_per_sample);
	for (int r = sim->doubled_limit; r >= 0; r--) {
		double substeps = sim->doubled_substeps[r];
		in[6] = x->base_drive * rise * substeps;
		in[7] = x->gap_drive * rise * substeps;
		if (substeps <= x->substeps &&
		    (still || stays_in_contact(&doubled->map[r], in, bound, &start, x->substep * substeps))) {
			sim->doubled = r;
			return &doubled->map[r];
		}
	}
	return NULL;
}

/* The contact maps of the bodies' current branches. */
static struct pound_contact_maps *contact_maps_find(struct simulation *sim)
{
	if (sim->common)
		return &sim->common->maps;
	const struct state_rows *x = &sim->x;
	unsigned found = 0;
	for (int m = 0; m < POUND_CONTACT_MAPS; m++)
		found |= (unsigned)(sim->contact_map_of[0][m] == x->body[0].stiffness &&
		                    sim->contact_map_of[1][m] == x->body[1].stiffness)
		         << m;
	if (found)
		return &sim->own_maps[__builtin_ctz(found)];
	int m = sim->contact_map_next;
	sim->contact_map_next = (m + 1) % POUND_CONTACT_MAPS;
	for (int i = 0; i < POUND_OSCILLATORS; i++)
		sim->contact_map_of[i][m] = x->body[i].stiffness;
	sim->own_maps[m].made = false;
	return &sim->own_maps[m];
}

/* First contact since the bodies entered their current branches: finds or fills its maps. */
LANE_SHARED void contact_maps_enter(struct simulation *sim)
{
	struct state_rows *x = &sim->x;
	const int b = sim->base, o = 1 - b;
	struct pound_contact_maps *maps = sim->contact_maps = contact_maps_find(sim);
	if (!maps->made) {
		substep_fill(&maps->substep, sim->task->accounted ? &maps->doubled->work[POUND_DOUBLED_MAPS] : NULL,
		             sim);
		maps->made = true;
		maps->has_doubled = false;
	}
	x->base_force = x->body[b].offset;
	x->gap_force = x->body[1].offset - x->body[0].offset - x->body[o].stiffness * x->gap;
	const bool alike = x->gap_force == 0 && x->gap_drive == 0 &&
	                   x->body[0].stiffness == x->body[1].stiffness &&
	                   x->body[0].damping == x->body[1].damping;
	sim->traits = alike ? sim->traits | TRAIT_ALIKE : sim->traits & ~(unsigned)TRAIT_ALIKE;
}

/* Copies the substep map of a simulation, but no doubled maps, to its copy: it is still on its first branches,
 * so it has maps of at most one pair of branches. */
static void contact_maps_copy(struct simulation *to, const struct simulation *from)
{
	if (!from->contact_maps)
		return;
	assert(from->contact_maps == &from->own_maps[0]);
	struct pound_contact_maps *maps = to->contact_maps = &to->own_maps[0];
	maps->substep = from->own_maps[0].substep;
	maps->made = true;
	maps->has_doubled = false;
}

/* Restores the contact map of a resumed copy. */
static void contact_maps_resume(struct simulation *sim, enum pound_stage stage)
{
	struct pound_contact_maps *maps = sim->contact_maps;
	if (stage == STAGE_CONTACT)
		sim->contact_map = &maps->substep;
	if (stage != STAGE_SUSTAINED)
		return;
	doubled_fill(maps->doubled, &maps->substep, sim);
	maps->has_doubled = true;
	sim->contact_map = &maps->doubled->map[sim->doubled];
}

/* Prepares whole substeps of contact: chooses the longest map over which no event can occur.
 *
 * Given    sim    in contact, with whole substeps left
 * Returns  value  STAGE_SUSTAINED: sim->contact_map is a doubled map; STAGE_CONTACT: it is the substep map; STAGE_CHATTER: more
 *                 than POUND_STEPS_LIMIT steps in this interval
 */
static enum pound_stage contact_ready(struct simulation *sim)
{
	if (++sim->steps > POUND_STEPS_LIMIT)
		return STAGE_CHATTER;
	if (!sim->contact_maps)
		contact_maps_enter(sim);
	struct pound_contact_maps *maps = sim->contact_maps;
	if (sim->doubled_ratio > 0) {
		sim->x.rounds = sim->doubled_ratio; // applied until it has covered the next longer map's length
		sim->contact_map = sim->n_doubled > 0 ? doubled_longest(sim, maps) : NULL;
		if (sim->contact_map)
			return STAGE_SUSTAINED;
	}
	sim->contact_map = &maps->substep;
	return STAGE_CONTACT;
}

/* Adds the energy balance of the substeps that a simulation has passed by one map.
 *
 * Given    sim     its map and interval
 *          x, end  inputs of the map, and the state after it
 *          ground  acceleration at the start [m/s2];  rise: its growth over one substep
 * Returns  sim     work, as energy.inl adds it: the ground's is -m (a (u1 - u0) + d (u1 - mean u)), with a growing by d
 */
static void contact_work(struct simulation *sim, const double x[N], const double end[4], double ground,
                         double rise)
{
	struct state_rows *r = &sim->x;
	const struct pound_contact_map *map = sim->contact_map;
	const struct pound_contact_maps *maps = sim->contact_maps;
	const struct pound_contact_work *work =
	    &maps->doubled->work[map == &maps->substep ? POUND_DOUBLED_MAPS : sim->doubled];
	const double substeps = map->row[CONTACT_SPLIT][SPLIT_SUBSTEPS], grown = rise * substeps;
	const int b = sim->base, o = 1 - b;
	const double mass[2] = {1, r->right_mass};
	double mean = row_at(work->mean_base, x), mean_p = row_at(work->mean_overlap, x);
	const double *split = map->row[CONTACT_SPLIT];
	double w = x[0] - split[SPLIT_BASE] * x[2], rate = x[1] - split[SPLIT_BASE] * x[3];
	double closing = split[SPLIT_DAMPING] * rate + split[SPLIT_STIFFNESS] * w + x[5];
	const double off[N] = {x[0], x[1], x[2] - yield_of(split) * closing, x[3], x[4], x[5], x[6], x[7]};
	double u0[2], u1[2], v1[2], means[2];
	u0[b] = x[0], u1[b] = end[0], v1[b] = end[1], means[b] = mean;
	u0[o] = x[0] - r->side * (r->gap + x[2]);
	u1[o] = end[0] - r->side * (r->gap + end[2]);
	v1[o] = end[1] - r->side * end[3];
	means[o] = mean - r->side * (r->gap + mean_p);
	double in = 0, moving = 0, out = 0.5 * r->contact_stiffness * (end[2] + x[2]) * (end[2] - x[2]);
	for (int i = 0; i < N; i++)
		out += off[i] * row_at(work->loss[i], off);
	for (int i = 0; i < POUND_OSCILLATORS; i++) {
		double way = u1[i] - u0[i], spring = r->body[i].stiffness * 0.5 * (u0[i] + u1[i]) + r->body[i].offset;
		in -= mass[i] * r->body[i].drive * (ground * way + grown * (u1[i] - means[i]));
		out += mass[i] * spring * way;
		moving += 0.5 * mass[i] * v1[i] * v1[i];
	}
	r->work_in += in;
	double gap = out - in + r->work_low, sum = r->work_gap + gap;
	r->work_low = gap - (sum - r->work_gap);
	r->work_gap = sum;
	double most = fabs(r->work_in) < moving ? moving : fabs(r->work_in);
	r->work_top = r->work_top < most ? most : r->work_top;
}
