/* oscillator_bank.inl - oscillators on a floor, integrated exactly over its pieces, and their largest displacements.
 *
 * 1. A piece is divided into 2^L equal segments, so that w times a segment is at most 1.5 radians and a power series of the
 *    oscillator ends in rounding; the fastest of a group of eight sets L, and the group shares all steps.
 * 2. A whole sample of free motion is linear in the oscillator's state and in four state numbers of the floor, by maps
 *    that are computed once; any other piece is integrated by the series.
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

/* Error bound of the cubic through the ends of a segment: factors of |z| and |v| at its start and of the bounds A, A', A'' of the
 * drive over the piece. */
struct cubic_error {
	vd on_z, on_v, on_bound[3];
};

/* Maps of a whole sample and of its segments, and factors of the bound in risk_of_sample. */
struct maps {
	struct segment whole, segment;
	struct passage of_whole, of_segment;
	struct drive_map drive_of_whole[POUND_FLOOR_MAPS], drive_of_segment[POUND_FLOOR_MAPS][SEGMENTS_MAX];
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

/* ---- series ---- */

/* Increments of a group over a segment: unlike roundings of a factor near 1, roundings of an increment do not accumulate over
 * thousands of samples.
 *
 * Given    z, y  at the start
 * Returns  z, y  their increments
 *
 * With d_n the n-th derivative of z:  d_n+2 = -(2 xi x d_n+1 + x^2 d_n + f_n)     increments: sum d_n/n!, sum d_n+1/n!, n > 0
 */
LANE_INLINE void series_pass(const struct segment *p, const struct force *force, vd z[G], vd y[G])
{
	const int terms = force->terms;
	vd now[G], next[G];
	for (int i = 0; i < G; i++) {
		now[i] = y[i];
		next[i] = vfma(p->damp[i], y[i], vfma(p->stiff[i], z[i], vsplat(force->of[0])));
		z[i] = y[i] = vsplat(0);
	}
	for (int n = 1; n <= terms; n++) {
		const vd factor = vsplat(POUND_FACTOR[n]), f = vsplat(force->of[n]);
		for (int i = 0; i < G; i++) {
			z[i] = vfma(now[i], factor, z[i]);
			y[i] = vfma(next[i], factor, y[i]);
			const vd after = vfma(p->damp[i], next[i], vfma(p->stiff[i], now[i], f));
			now[i] = next[i];
			next[i] = after;
		}
	}
}

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
	struct series s = {.terms = force->terms};
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
		vd z[G], y[G];
		force_fill(&force, bank->powers, &made, p, j);
		for (int i = 0; i < G; i++)
			z[i] = s->z[i], y[i] = s->v[i] * p->step;
		series_pass(p, &force, z, y);
		for (int i = 0; i < G; i++) {
			struct stage stage = {
			    p, i, own->bound, s->z[i], s->v[i], s->z[i] + z[i], vfma(y[i], vsplat(per_step), s->v[i])};
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

/* ---- free motion ---- */

/* Increments of oscillators over a segment without a drive. */
static void passage_fill(struct passage *passage, const struct segment *p)
{
	const struct force none = {.terms = p->terms};
	const double per_step = 1 / p->step;
	for (int state = 0; state < 2; state++) {
		vd z[G], y[G];
		for (int i = 0; i < G; i++)
			z[i] = vsplat(state == 0), y[i] = vsplat(state == 0 ? 0 : p->step);
		series_pass(p, &none, z, y);
		for (int i = 0; i < G; i++) {
			(state == 0 ? passage->zz : passage->zv)[i] = z[i];
			(state == 0 ? passage->vz : passage->vv)[i] = y[i] * per_step;
		}
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

/* Appends a segment to a passage, by the increments of a unit displacement and a unit velocity. */
LANE_INLINE void passage_append(struct passage *all, const struct passage *m, int i)
{
	const vd z = 1.0 + all->zz[i], v = 1.0 + all->vv[i];
	const vd zz = vfma(m->zz[i], z, m->zv[i] * all->vz[i]), vz = vfma(m->vz[i], z, m->vv[i] * all->vz[i]);
	const vd zv = vfma(m->zv[i], v, m->zz[i] * all->zv[i]), vv = vfma(m->vv[i], v, m->vz[i] * all->zv[i]);
	all->zz[i] = all->zz[i] + zz, all->vz[i] = all->vz[i] + vz;
	all->zv[i] = all->zv[i] + zv, all->vv[i] = all->vv[i] + vv;
}

/* Increments of oscillators on a floor of one stiffness, over each segment of a sample and over the whole sample. */
static void drive_map_fill(struct maps *maps, int m, const struct pound_bank *bank,
                           const struct pound_bank_input *input)
{
	const struct segment *p = &maps->segment;
	const int order = input->stretch->order;
	struct force force;
	for (int state = 0; state < 4; state++) {
		const double unit[4] = {state == 0, state == 1, state == 2, state == 3};
		double a[POUND_FLOOR_ROOM], size = 0;
		vd *end_z = maps->drive_of_whole[m].z[state], *end_v = maps->drive_of_whole[m].v[state];
		for (int i = 0; i < G; i++)
			end_z[i] = end_v[i] = vsplat(0);
		pound_floor_free_motion(unit, input->stretch->stiffness[m], input->damping, input->time_step, order,
		                        a);
		for (int k = 0; k <= order; k++)
			size += fabs(a[k]);
		const struct drive drive = drive_of(a, order, p, size);
		for (int j = 0; j < p->n; j++) {
			struct drive_map *map = &maps->drive_of_segment[m][j];
			vd *z = map->z[state], *v = map->v[state];
			force_fill(&force, bank->powers, &drive, p, j);
			for (int i = 0; i < G; i++)
				z[i] = v[i] = vsplat(0);
			series_pass(p, &force, z, v);
			for (int i = 0; i < G; i++) {
				v[i] = v[i] / p->step;
				passage_take(&maps->of_segment, i, &end_z[i], &end_v[i], z[i], v[i]);
			}
		}
	}
}

/* All maps of a sample, for every stiffness of a stretch. */
static void maps_fill(struct maps *maps, const struct pound_bank *bank, const struct group *g,
                      const struct pound_bank_input *input, int segments)
{
	const double h = input->time_step;
	segment_init(&maps->whole, g, h, 1);
	segment_init(&maps->segment, g, h, segments);
	passage_fill(&maps->of_segment, &maps->segment);
	maps->of_whole = maps->of_segment;
	for (int j = 1; j < segments; j++)
		for (int i = 0; i < G; i++)
			passage_append(&maps->of_whole, &maps->of_segment, i);
	for (int m = 0; m < input->stretch->n_maps; m++)
		drive_map_fill(maps, m, bank, input);
	for (int i = 0; i < G; i++) {
		const vd zero = vsplat(0), per = g->per_omega[i], per2 = per * per;
		const vm fast = vless(vsplat(1), g->omega[i] * h);
		maps->on_start[i] = vselect(fast, per2, zero);
		maps->on_rate[i] = vselect(fast, per2 * per * (1 / h), zero);
		maps->on_bound[0][i] = vselect(fast, per2, per * h);
		maps->on_bound[1][i] = vselect(fast, per2 * (2 * g->damping), zero);
		maps->on_bound[2][i] = maps->on_rate[i];
		maps->miss_of_whole[i] = cubic_error_of(&maps->whole, g, i);
	}
}

/* Lanes in which |z| may have a new maximum inside a whole sample h of free motion.
 *
 * Given    a  the drive: bounds A, A', A'', coefficients a and its rate at the start, by the elapsed fraction of the sample
 *
 * Slow oscillators, w h <= 1: as in risk_of_piece.  Fast ones follow the floor: with y = z + a/w^2
 *   y'' + 2 xi w y' + w^2 y = a''/w^2 + 2 xi a'/w     E of y grows by at most A''/(h w^3) + 2 xi A'/w^2, |z| <= E + A/w^2
 */
LANE_INLINE vm risk_of_sample(const struct maps *m, const struct group *g, const struct state *s, int i,
                              const struct pound_polynomial *a)
{
	const vd z = vfma(m->on_start[i], vsplat(a->c[0]), s->z[i]);
	const vd v = vfma(m->on_rate[i], vsplat(a->c[1]), s->v[i] * g->per_omega[i]);
	vd left = s->top[i];
	for (int k = 0; k < 3; k++)
		left = vfma(m->on_bound[k][i], vsplat(-a->bound[k]), left);
	return vless(left * vabs(left), vfma(z, z, vfma(v, v, vsplat(SQUARES_LEAST))));
}

/* the contact's drive in free motion */
static const struct pound_polynomial none = {{0}, {0}};

/* one vector of a group over a whole sample */
struct sample_place {
	const struct pound_bank *bank;
	const struct pound_bank_input *input;
	const struct pound_floor_piece *piece;
	const struct maps *maps;
	const struct group *group;
	int i;
};

/* The largest |z| of a sample, by its segments, in the lanes of risk; else top. */
LANE_SHARED vd sample_top(const struct sample_place *at, enum pound_drive drive, vm risk, vd top)
{
	const int i = at->i;
	const struct maps *maps = at->maps;
	const struct state *s = &at->group->s[drive];
	const bool driven = drive == POUND_DRIVE_FLOOR;
	double room[POUND_FLOOR_ROOM];
	const double *c, *bound = driven ? at->piece->floor.bound : none.bound;
	struct force force;
	struct stage stage = {&maps->segment, i, bound, s->z[i], s->v[i], s->z[i], s->v[i]};
	const struct cubic_error miss = cubic_error_of(&maps->segment, at->group, i);
	for (int j = 0; j < maps->segment.n; j++) {
		const struct drive_map *map = &maps->drive_of_segment[at->piece->map][j];
		vd z = vsplat(0), v = vsplat(0);
		stage.z = stage.z1, stage.v = stage.v1;
		for (int k = 0; k < 4 && driven; k++) {
			z = vfma(map->z[k][i], vsplat(at->piece->state[k]), z);
			v = vfma(map->v[k][i], vsplat(at->piece->state[k]), v);
		}
		passage_take(&maps->of_segment, i, &stage.z1, &stage.v1, z, v);
		top = vselect(risk, vmax(top, vabs(stage.z1)), top);
		const vm inside = risk_of_segment(&stage, &miss, top) & risk;
		if (vany(inside)) {
			const int order =
			    pound_floor_drive(at->input->stretch, at->piece, drive, at->input->damping, room, &c);
			const struct drive made = drive_of(c, order, &maps->segment, bound[0]);
			force_fill(&force, at->bank->powers, &made, &maps->segment, j);
			top = segment_top(&stage, &force, inside, top);
		}
	}
	return top;
}

/* Integrates a group over a whole sample by maps; the contact's drive is 0.
 *
 * A new largest displacement is excluded by the cubic through the ends of the sample if all oscillators are slow; else by
 * risk_of_sample, and where this does not suffice, by the cubic.
 */
LANE_INLINE void sample_move(struct sample_place *at, enum pound_drive drive, struct group *g)
{
	const bool driven = drive == POUND_DRIVE_FLOOR;
	const struct pound_floor_piece *piece = at->piece;
	const struct pound_polynomial *a = driven ? &piece->floor : &none;
	const struct drive_map *map = &at->maps->drive_of_whole[piece->map];
	struct state *s = &g->s[drive];
	for (int i = 0; i < G; i++) {
		vd z = vsplat(0), v = vsplat(0);
#pragma GCC unroll 4
		for (int k = 0; k < 4 && driven; k++) {
			z = vfma(map->z[k][i], vsplat(piece->state[k]), z);
			v = vfma(map->v[k][i], vsplat(piece->state[k]), v);
		}
		struct stage stage = {&at->maps->whole, i, a->bound, s->z[i], s->v[i], s->z[i], s->v[i]};
		passage_take(&at->maps->of_whole, i, &stage.z1, &stage.v1, z, v);
		vm risk = g->slow ? vmask((1u << W) - 1) : risk_of_sample(at->maps, g, s, i, a);
		if (g->slow || __builtin_expect(vany(risk), 0)) {
			s->top[i] = vselect(risk, vmax(s->top[i], vabs(stage.z1)), s->top[i]);
			risk = risk & risk_of_segment(&stage, &at->maps->miss_of_whole[i], s->top[i]);
			if (__builtin_expect(vany(risk), 0)) {
				at->i = i;
				s->top[i] = sample_top(at, drive, risk, s->top[i]);
			}
		}
		s->z[i] = stage.z1;
		s->v[i] = stage.v1;
	}
}

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
