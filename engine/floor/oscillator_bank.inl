/* oscillator_bank.inl - oscillators on a floor, integrated exactly over its pieces, and their largest displacements.
 *
 * 1. A piece is divided into 2^L equal segments, so that w times a segment is at most 1.5 radians and a power series of the
 *    oscillator ends in rounding; the fastest of a group of eight sets L, and the group shares all steps.
 * 2. A whole sample of free motion is linear in the oscillator's state and in four state numbers of the floor, by maps
 *    that are computed once (oscillator_maps.inl); any other piece is integrated by the series.
 * 3. Bounds from an oscillator's energy and the floor's acceleration prove for most pieces that no new largest displacement
 *    lies inside.  In the others each segment is checked: the cubic through both of its ends plus its error bound may prove
 *    the same; if not, the roots of the velocity are refined on the series.  So maxima between steps are found, too.
 *
 * | z, v | displacement and velocity of an oscillator |   | w, xi | frequency and damping |   | x | w times a segment |
 * | a, A | the floor's acceleration and its bound over a piece; A', A'' bounds of its derivatives |
 * | h | the length of a piece |   | y | velocity in the segment's time 0 .. 1 | */
#include "engine/floor/oscillator_bank.h"

#include <assert.h>
#include <stdalign.h>

#include "engine/exact/tolerances.h"
#include "engine/numeric/lanes.h"

enum {
	G = POUND_SPECTRUM_GROUP / W, /* vectors of a group */
	TERMS = POUND_FLOOR_TERMS,
	DERIVATIVES = POUND_SEGMENT_DERIVATIVES,
	SEGMENTS_MAX = POUND_SEGMENTS, /* of a sample that has maps */
	SEGMENTS_LIMIT = 1 << 24,
	POLISH = 3, /* Newton steps from the cubic's extremum, whose error is 1e-2, near critical damping more */
};

/* Squares below this have lost digits and prove nothing. */
static const double SQUARES_LEAST = 0x1p-1000;

struct state {
	vd z[G], v[G], top[G];
};

/* eight oscillators */
struct group {
	vd omega[G], per_omega[G];
	double omega_max, damping;
	bool slow; /* the fastest has w times a sample <= 1 */
	struct state s[POUND_DRIVES];
};

/* One of n equal segments of a piece; motions below are in its time 0 .. 1. */
struct segment {
	int n;
	double step;          /* [s] */
	double x;             /* of the fastest of the group */
	int terms;            /* of a series without a drive, for the fastest of the group */
	vd damp[G], stiff[G]; /* -2 xi x, -x^2 */
};

/* What drives oscillators over a piece: coefficients of powers of the piece's time  (order + 1, space for DERIVATIVES) */
struct drive {
	const double *c;
	int order; /* -1: none */
	int terms; /* maximum of a series that it drives */
};

/* Derivatives of a drive at the start of a segment, times -step^2; 0 beyond its order. */
struct force {
	alignas(64) double of[DERIVATIVES];
	int terms; /* of a series that it drives */
};

/* Increments of a state over a time without a drive: of z zz z + zv v, of v vz z + vv v. */
struct passage {
	vd zz[G], zv[G], vz[G], vv[G];
};

/* increments of a state per unit of each of the four state numbers of a floor in free motion */
struct drive_map {
	vd z[4][G], v[4][G];
};

/* State numbers of a floor in free motion a segment later, per unit of each: of spring force and velocity. */
struct floor_map {
	double r[4], v[4];
	double share; /* segment over sample: what the forcing gains of its growth */
};

/* Error bound of the cubic through the ends of a segment: factors of |z| and |v| at its start and of the bounds A, A', A'' of the
 * drive over the piece. */
struct cubic_error {
	vd on_z, on_v, on_bound[3];
};

/* Maps of a whole sample and of its segments, and factors of the bound in risk_of_sample. */
struct maps {
	struct segment whole, segment;
	struct passage of_whole, of_segment;
	struct drive_map drive_of_whole[POUND_FLOOR_MAPS], drive_of_segment[POUND_FLOOR_MAPS];
	struct floor_map floor_of_segment[POUND_FLOOR_MAPS];
	vd on_start[G], on_rate[G]; /* factors of a and its rate at the start of the sample */
	vd on_bound[3][G];          /* factors of A, A', A'' */
	struct cubic_error miss_of_whole[G];
};

static_assert(sizeof POUND_TERMS_REACH == (TERMS + 1) * sizeof(double) && (TERMS + 1) % W == 0,
              "whole vectors");
static_assert(DERIVATIVES % W == 0, "whole vectors of derivatives");
static_assert(TERMS < DERIVATIVES, "a series has no more than the derivatives of its force");
static_assert(sizeof(struct maps) <= POUND_SPECTRUM_SCRATCH, "the work space is too small");

static int larger(int a, int b)
{
	return a > b ? a : b;
}

/* Terms after which x^n/n! is below rounding, as pound_floor_terms(): all thresholds are compared, as an early exit would be
 * mispredicted. */
LANE_INLINE int terms_of(double x)
{
	int n = 0;
	for (int k = 0; k <= TERMS; k += W)
		n += __builtin_popcount(vbits(vless(lanes_load(&POUND_TERMS_REACH[k]), vsplat(x))));
	return n;
}

/* Number of segments of a step, a power of two, so that omega_max times a segment is at most `radians`. */
static int segments_of(double omega_max, double step, double radians)
{
	int n = 1;
	while (omega_max * step > radians * n && n < SEGMENTS_LIMIT)
		n *= 2;
	return n;
}

LANE_INLINE void segment_init(struct segment *p, const struct group *g, double length, int n)
{
	const double step = length / n;
	p->n = n;
	p->step = step;
	p->x = g->omega_max * step;
	p->terms = terms_of(p->x);
	for (int i = 0; i < G; i++) {
		const vd x = g->omega[i] * step;
		p->damp[i] = x * (-2 * g->damping);
		p->stiff[i] = -(x * x);
	}
}

/* ---- forces ---- */

/* Coefficients of a polynomial in the time of segment j of n equal segments, n a power of two, put into `room`. */
static void coefficients_of_segment(const double *a, int order, int j, int n, double *room)
{
	double share = 1.0 / n, from = j * share, power = 1;
	for (int k = 0; k <= order; k++)
		room[k] = a[k];
	for (int i = 0; i < order && j > 0; i++)
		for (int k = order - 1; k >= i; k--)
			room[k] += from * room[k + 1];
	for (int k = 0; k <= order; k++, power *= share)
		room[k] *= power;
}

/* A drive over the segments p of a piece.
 *
 * Given    c      its coefficients  (order + 1)
 *          bound  of its magnitude
 *
 * Beyond order + 2 a term of a series follows from the last two coefficients, and term n is x/n of the one before it.
 */
LANE_INLINE struct drive drive_of(const double *c, int order, const struct segment *p, double bound)
{
	struct drive drive = {.c = c, .order = order, .terms = larger(p->terms, order + 2)};
	// two coefficients: without damping, even and odd terms are independent
	double last = order < 0 ? 0 : fmax(fabs(c[order]), order > 0 ? fabs(c[order - 1]) : 0);
	for (int n = order + 3; n <= TERMS && last > 0x1p-54 * bound; n++) {
		last *= p->x * POUND_SHARE[n - 1];
		drive.terms = larger(drive.terms, n);
	}
	return drive;
}

/* The force of a drive in segment j of a piece. */
LANE_INLINE void force_fill(struct force *force, const struct pound_segment_powers *powers,
                            const struct drive *drive, const struct segment *p, int j)
{
	const double *c = drive->c;
	const int order = drive->order;
	double room[POUND_FLOOR_ROOM];
	const vd scale = vsplat(-(p->step * p->step));
	int n = p->n;
	if (n > SEGMENTS_MAX) {
		coefficients_of_segment(c, order, j, n, room);
		c = room, n = 1, j = 0;
	}
	force->terms = drive->terms;
	// at the start of a piece every power has one derivative that is not 0
	for (int m = 0; m < DERIVATIVES && j == 0; m += W) {
		const vm kept = vless(lanes_load(&powers->number[m]), vsplat(order + 1));
		const vd derivative = lanes_load(&c[m]) * lanes_load(&powers->start[n][m]);
		lanes_store(&force->of[m], vselect(kept, derivative * scale, vsplat(0)));
	}
	for (int m = 0; m < DERIVATIVES && j > 0; m += W) {
		vd sum = vsplat(0);
		for (int k = order; k >= m; k--)
			sum = vfma(vsplat(c[k]), lanes_load(&powers->segment[n + j][k][m]), sum);
		lanes_store(&force->of[m], sum * scale);
	}
}

/* ---- responses ---- */

/* Responses at the end of a segment, of oscillators initially at rest: to a level of 1, and to a pulse. */
struct response {
	vd level[G], pulse[G];
};

/* Increments of a group over a segment by a force, and its responses to a level and a pulse; neither depends on the state, so that
 * the series of several segments overlap in the processor.
 *
 * Returns  z, y  displacement and velocity at the end, from rest
 *
 * | Y_k | displacement at the end after z'' + 2 xi x z' + x^2 z = t^k/k! from rest; of the k-th derivative of a force |
 * | Y_0, Y_-1 | responses to a level and to a pulse |
 *
 *   Y_k' = Y_k-1, therefore     Y_k-2 = 1/k! - 2 xi x Y_k-1 - x^2 Y_k
 *
 * Downwards this sums the power series of every Y from its last term: stable for x <= 1.5.
 */
LANE_INLINE void force_pass(const struct segment *p, const struct force *force, int order, vd z[G], vd y[G],
                            struct response *response)
{
	vd next[G], now[G]; // Y_k, Y_k-1
	for (int i = 0; i < G; i++)
		next[i] = now[i] = z[i] = y[i] = vsplat(0);
	for (int k = force->terms + 1; k > order + 1; k--) {
		const vd power = vsplat(POUND_FACTOR[k]);
		for (int i = 0; i < G; i++) {
			const vd before = vfma(p->damp[i], now[i], vfma(p->stiff[i], next[i], power));
			next[i] = now[i];
			now[i] = before;
		}
	}
	for (int k = order + 1; k > 0; k--) {
		const vd power = vsplat(POUND_FACTOR[k]), f = vsplat(force->of[k - 1]);
		for (int i = 0; i < G; i++) {
			const vd before = vfma(p->damp[i], now[i], vfma(p->stiff[i], next[i], power));
			next[i] = now[i];
			now[i] = before;
			z[i] = vfma(f, next[i], z[i]);
			y[i] = vfma(f, now[i], y[i]);
		}
	}
	for (int i = 0; i < G; i++)
		response->level[i] = next[i], response->pulse[i] = now[i];
}

/* Increments of a state over a segment without a drive: unlike roundings of a factor near 1, roundings of an increment do not
 * accumulate over thousands of samples. */
LANE_INLINE void passage_fill(struct passage *passage, const struct response *response,
                              const struct segment *p)
{
	const double per_step = 1 / p->step;
	for (int i = 0; i < G; i++) {
		const vd level = p->stiff[i] * response->level[i];
		passage->zz[i] = level;
		passage->zv[i] = response->pulse[i] * p->step;
		passage->vz[i] = p->stiff[i] * response->pulse[i] * per_step;
		passage->vv[i] = vfma(p->damp[i], response->pulse[i], level);
	}
}

/* Advances a state by a passage and by the increments more_z and more_v of a drive. */
LANE_INLINE void passage_take(const struct passage *m, int i, vd *z, vd *v, vd more_z, vd more_v)
{
	more_z = vfma(m->zz[i], *z, vfma(m->zv[i], *v, more_z));
	more_v = vfma(m->vz[i], *z, vfma(m->vv[i], *v, more_v));
	*z = *z + more_z;
	*v = *v + more_v;
}

/* ---- series ---- */

LANE_INLINE vd series_at(const vd *c, int terms, vd t)
{
	vd even = vsplat(0), odd = vsplat(0), t2 = t * t;
	int n = terms;
	if (n % 2 == 0)
		even = c[n--];
	for (; n > 0; n -= 2) {
		odd = vfma(odd, t2, c[n]);
		even = vfma(even, t2, c[n - 1]);
	}
	return vfma(odd, t, even);
}

/* ---- largest displacements ---- */

/* one vector of a group over a segment of a piece */
struct stage {
	const struct segment *segment;
	int i;               /* index of the vector */
	const double *bound; /* A, A', A'' over the piece */
	vd z, v, z1, v1;     /* at the start and at the end */
};

/* Coefficients of powers of a segment's own time  (terms + 1) */
struct series {
	int terms;
	vd z[TERMS + 1], y[TERMS + 1], slope[TERMS + 1]; /* slope: derivative of y */
};

/* |z| at the root of the velocity that Newton's method finds from t; an inexact root still gives a value that |z| takes. */
LANE_INLINE vd polished(const struct series *s, vd t)
{
	vd zero = vsplat(0), one = vsplat(1);
	for (int round = 0; round < POLISH; round++) {
		vd slope = series_at(s->slope, s->terms - 1, t);
		vd flat = vselect(vequal(slope, zero), one, slope);
		t = vmin(vmax(t - series_at(s->y, s->terms, t) / flat, zero), one);
	}
	return vabs(series_at(s->z, s->terms, t));
}

/* The maximum of top and of |z| at the extrema inside a segment, searched from both extrema of the cubic through its ends;
 * in the lanes of risk. */
LANE_SHARED vd segment_top(const struct stage *stage, const struct force *force, vm risk, vd top)
{
	const struct segment *p = stage->segment;
	struct series s;
	s.terms = force->terms; // the arrays are not cleared
	vd zero = vsplat(0), one = vsplat(1), now = stage->z, next = stage->v * p->step;
	for (int n = 0; n <= s.terms; n++) {
		const vd after = vfma(p->damp[stage->i], next, vfma(p->stiff[stage->i], now, vsplat(force->of[n])));
		s.z[n] = now * vsplat(POUND_FACTOR[n]);
		s.y[n] = next * vsplat(POUND_FACTOR[n]);
		s.slope[n] = after * vsplat(POUND_FACTOR[n]);
		now = next;
		next = after;
	}
	vd y0 = s.y[0], y1 = stage->v1 * p->step, rise = stage->z1 - stage->z;
	vd a = 3.0 * rise - 2.0 * y0 - y1, b = y1 + y0 - 2.0 * rise;
	// scaled by a power of two, so that squares of small values do not underflow
	vd large = vmax(vmax(vabs(a), vabs(b)), vabs(y0));
	vd raise = vselect(vless(large, vsplat(0x1p-400)), vsplat(0x1p600), one);
	a = a * raise, b = b * raise, y0 = y0 * raise;
	vd root = vsqrt(vmax(vfma(a, a, -3.0 * b * y0), zero));
	vd q = -(a + vselect(vless(a, zero), -root, root));
	vd t[2] = {q / vselect(vequal(b, zero), one, 3.0 * b), y0 / vselect(vequal(q, zero), one, q)},
	   most = zero;
	// usually one of the roots lies inside; the margin is for the error of the cubic
	for (int i = 0; i < 2; i++) {
		vm inside = vless(vsplat(-0.1), t[i]) & vless(t[i], vsplat(1.1)) & risk;
		if (vany(inside))
			most = vselect(inside, vmax(most, polished(&s, vmin(vmax(t[i], zero), one))), most);
	}
	return vselect(risk, vmax(top, most), top);
}

/* With e = x |z0| + h |v0| + A, h the segment's length and A, A', A'' bounds of the drive times h^2, in the segment's time:
 * x |z| <= e and |z'| <= e inside, so
 *   |z''| <= A + (2 xi + 1) x e,   |z'''| <= A' + 2 xi x |z''| + x^2 e,   |z''''| <= A'' + 2 xi x |z'''| + x^2 |z''|
 */
LANE_INLINE struct cubic_error cubic_error_of(const struct segment *p, const struct group *g, int i)
{
	const double step = p->step, scale = POUND_CUBIC_ERROR * step * step, share = 1.0 / p->n;
	const vd x = g->omega[i] * step, damp = -p->damp[i], x2 = x * x, both = vfma(damp, damp, x2);
	const vd on_e = vfma(both, x, damp * x2) + damp * both;
	return (struct cubic_error){
	    .on_z = on_e * x * POUND_CUBIC_ERROR,
	    .on_v = on_e * (step * POUND_CUBIC_ERROR),
	    .on_bound = {(on_e + both) * scale, damp * (scale * share), vsplat(scale * share * share)}};
}

/* Lanes in which |z| may have a new maximum inside a segment, by the cubic through its ends; top includes |z| at the end. */
LANE_INLINE vm risk_of_segment(const struct stage *stage, const struct cubic_error *miss, vd top)
{
	const vd third = vsplat(stage->segment->step * (1.0 / 3));
	vd error = vfma(miss->on_z, vabs(stage->z), miss->on_v * vabs(stage->v));
	for (int k = 0; k < 3; k++)
		error = vfma(miss->on_bound[k], vsplat(stage->bound[k]), error);
	const vd b1 = vfma(third, stage->v, stage->z), b2 = vfma(-third, stage->v1, stage->z1);
	return vless(top, error + vmax(vabs(b1), vabs(b2)));
}

/* ---- any piece ---- */

/* Lanes in which |z| may have a new maximum inside a piece of length h; value: there are any.
 *
 *   E^2 = z^2 + (v/w)^2     E' <= |a|/w for any damping     |z| <= E <= E0 + A h/w
 */
LANE_INLINE bool risk_of_piece(const struct group *g, const struct state *s, double step, double bound,
                               vm risk[G])
{
	bool any = false;
	const vd drive = vsplat(step * bound);
	for (int i = 0; i < G; i++) {
		const vd rate = s->v[i] * g->per_omega[i], left = s->top[i] - drive * g->per_omega[i];
		risk[i] = vless(left * vabs(left), vfma(s->z[i], s->z[i], vfma(rate, rate, vsplat(SQUARES_LEAST))));
		any |= vany(risk[i]);
	}
	return any;
}

/* Integrates a group over any piece under one of the drives, segment by segment. */
LANE_INLINE void piece_move(const struct pound_bank *bank, const struct pound_bank_input *input,
                            const struct pound_floor_piece *piece, enum pound_drive drive, struct group *g,
                            const struct segment *p)
{
	const struct pound_polynomial *own = drive == POUND_DRIVE_PUSH ? &piece->push : &piece->floor;
	struct state *s = &g->s[drive];
	struct force force;
	double room[POUND_FLOOR_ROOM];
	const double *c;
	vm risk[G];
	const int order = pound_floor_drive(input->stretch, piece, drive, input->damping, room, &c);
	const struct drive made = drive_of(c, order, p, own->bound[0]);
	const bool any = risk_of_piece(g, s, piece->step, own->bound[0], risk);
	const double per_step = 1 / p->step;
	struct cubic_error miss[G];
	for (int i = 0; i < G && any; i++)
		miss[i] = cubic_error_of(p, g, i);
	for (int j = 0; j < p->n; j++) {
		struct response response;
		struct passage passage;
		vd z[G], y[G];
		force_fill(&force, bank->powers, &made, p, j);
		force_pass(p, &force, larger(order, 0), z, y, &response);
		passage_fill(&passage, &response, p);
		for (int i = 0; i < G; i++) {
			struct stage stage = {p, i, own->bound, s->z[i], s->v[i], s->z[i], s->v[i]};
			passage_take(&passage, i, &stage.z1, &stage.v1, z[i], y[i] * per_step);
			if (any && vany(risk[i])) {
				s->top[i] = vselect(risk[i], vmax(s->top[i], vabs(stage.z1)), s->top[i]);
				const vm inside = risk_of_segment(&stage, &miss[i], s->top[i]) & risk[i];
				if (vany(inside))
					s->top[i] = segment_top(&stage, &force, inside, s->top[i]);
			}
			s->z[i] = stage.z1;
			s->v[i] = stage.v1;
		}
	}
}

#include "engine/floor/oscillator_maps.inl"

/* ---- the bank ---- */

static void group_load(struct group *g, const struct pound_bank *bank, int at)
{
	g->damping = bank->damping;
	g->omega_max = 0;
	for (int l = 0; l < POUND_SPECTRUM_GROUP; l++)
		g->omega_max = bank->omega[at + l] > g->omega_max ? bank->omega[at + l] : g->omega_max;
	for (int i = 0; i < G; i++) {
		g->omega[i] = *(const vd *)(bank->omega + at + i * W);
		g->per_omega[i] = 1.0 / g->omega[i];
		for (int d = 0; d < bank->n_drives; d++) {
			g->s[d].z[i] = *(vd *)(bank->z[d] + at + i * W);
			g->s[d].v[i] = *(vd *)(bank->v[d] + at + i * W);
			g->s[d].top[i] = *(vd *)(bank->top[d] + at + i * W);
		}
	}
}

static void group_store(const struct group *g, const struct pound_bank *bank, int at)
{
	for (int d = 0; d < bank->n_drives; d++)
		for (int i = 0; i < G; i++) {
			*(vd *)(bank->z[d] + at + i * W) = g->s[d].z[i];
			*(vd *)(bank->v[d] + at + i * W) = g->s[d].v[i];
			*(vd *)(bank->top[d] + at + i * W) = g->s[d].top[i];
		}
}

/* Integrates one group of oscillators over a whole stretch. */
static void group_move(const struct pound_bank *bank, const struct pound_bank_input *input, int at,
                       struct maps *maps)
{
	struct group g;
	struct segment p;
	group_load(&g, bank, at);
	g.slow = g.omega_max * input->time_step <= 1;
	const int segments = segments_of(g.omega_max, input->time_step, bank->radians);
	const bool mapped = segments <= SEGMENTS_MAX && input->stretch->n_maps > 0;
	if (mapped)
		maps_fill(maps, bank, &g, input, segments);
	for (int k = 0; k < input->stretch->n; k++) {
		const struct pound_floor_piece *piece = &input->stretch->piece[k];
		for (int d = 0; d < bank->n_drives && piece->jump != 0; d++)
			for (int i = 0; i < G; i++)
				g.s[d].v[i] = g.s[d].v[i] - vsplat(piece->jump);
		if (piece->map >= 0 && mapped) {
			struct sample_place place = {bank, input, piece, maps, &g, 0};
			sample_move(&place, POUND_DRIVE_FLOOR, &g);
			if (bank->n_drives > 1)
				sample_move(&place, POUND_DRIVE_PUSH, &g);
			continue;
		}
		segment_init(&p, &g, piece->step, segments_of(g.omega_max, piece->step, bank->radians));
		for (int d = 0; d < bank->n_drives; d++)
			piece_move(bank, input, piece, d, &g, &p);
	}
	group_store(&g, bank, at);
}

/* Integrates all oscillators of a bank over the pieces of a stretch.
 *
 * Given    bank     state and largest displacements, updated
 *          scratch  POUND_SPECTRUM_SCRATCH bytes, 64-byte aligned
 *
 * Valid    exact except for rounding; the bits of an oscillator depend on its group, not on the lane count
 * Test     unit_oscillator_bank
 */
void POUND_OSCILLATOR_BANK(const struct pound_bank *bank, const struct pound_bank_input *input, void *scratch)
{
	for (int g = 0; g < bank->n_groups; g++)
		group_move(bank, input, g * POUND_SPECTRUM_GROUP, scratch);
}
