/* oscillator_bank.inl - oscillators on a floor, driven by its pieces exactly, their largest displacements between steps too.
 *
 * 1. A piece is cut into 2^L equal segments, so that w times a segment is at most 1.5 radians and a power series of the
 *    oscillator ends in rounding; L is that of the fastest of a group of eight.
 * 2. A whole sample of free motion is linear in the oscillator's state and four numbers of the floor's, with maps
 *    that are made once; any other piece is done by the series itself.
 * 3. The cubic through both ends of a segment, widened by the bound of its error, proves that no new largest displacement
 *    lies inside; where it does not, the velocity's roots are polished on the series. */
#include "engine/floor/oscillator_bank.h"

#include <assert.h>
#include <stdalign.h>

#include "engine/exact/tolerances.h"
#include "engine/numeric/lanes.h"

enum {
	TERMS = POUND_FLOOR_TERMS,
	SEGMENTS_MAX = POUND_KERNEL_SEGMENTS, /* of a sample that has maps */
	INTEGRALS = POUND_KERNEL_INTEGRALS,
	SEGMENTS_LIMIT = 1 << 24,
	POLISH =
	    2, /* rounds of Newton from the cubic's extremum, which misses by 1e-2 at most: 1e-4, 1e-8, squared in z */
};

/* A segment of a piece: its step and the bounds of the drive over it.  All motions below are in its time 0 .. 1. */
struct segment {
	double step; /* [s] */
	int terms;   /* of a series without a drive, by the fastest of the group */
	vd x, damp;  /* w step, 2 xi w step */
	// |z''''|/288 <= on_z |z| + on_v |v| + on_drive (A, A', A''), A of the drive over the piece: see segment_init
	vd on_z, on_v, on_drive[3];
};

/* the maps of one segment of a sample: z' = zz z + zv v + gz state, v' = vz z + vv v + gv state */
struct segment_map {
	vd gz[4], gv[4];
};

struct maps {
	vd zz, zv, vz, vv;
	struct segment_map segment[POUND_FLOOR_MAPS][SEGMENTS_MAX];
};

struct state {
	vd z, v, top;
};

struct oscillator_series {
	int terms;
	vd z[TERMS + 1], y[TERMS + 1]; /* y: derivative of z */
	vd z1, y1;
};

struct scratch {
	alignas(64) struct maps maps;
	double integral[POUND_FLOOR_PIECES][POUND_DRIVES][INTEGRALS]; /* of the pieces that have no map */
};

static_assert(sizeof POUND_TERMS_REACH == (TERMS + 1) * sizeof(double) && (TERMS + 1) % W == 0,
              "whole vectors");
static_assert(sizeof(struct scratch) <= POUND_SPECTRUM_SCRATCH, "the work space is too small");

static int larger(int a, int b)
{
	return a > b ? a : b;
}

static const double MINUS_SHARE[TERMS + 1] = {
    -1.0 / 1,  -1.0 / 2,  -1.0 / 3,  -1.0 / 4,  -1.0 / 5,  -1.0 / 6,  -1.0 / 7,  -1.0 / 8,
    -1.0 / 9,  -1.0 / 10, -1.0 / 11, -1.0 / 12, -1.0 / 13, -1.0 / 14, -1.0 / 15, -1.0 / 16,
    -1.0 / 17, -1.0 / 18, -1.0 / 19, -1.0 / 20, -1.0 / 21, -1.0 / 22, -1.0 / 23, -1.0 / 24};

/* Terms after which x^n/n! is below rounding, as pound_floor_terms() has them: all are looked at, as no branch foresees where
 * to stop. */
LANE_INLINE int terms_of(double x)
{
	int n = 0;
	for (int k = 0; k <= TERMS; k += W)
		n += __builtin_popcount(vbits(vless(lanes_load(&POUND_TERMS_REACH[k]), vsplat(x))));
	return n;
}

/* A segment of step h, one of n equal ones of a piece, for oscillators of frequency w.
 *
 * With e = x |z0| + h |v0| + A, x = w h and A, A', A'' bounds of the drive times h^2, in the segment's time:
 * x |z| <= e and |z'| <= e inside, so
 *   |z''| <= A + (2 xi + 1) x e,   |z'''| <= A' + 2 xi x |z''| + x^2 e,   |z''''| <= A'' + 2 xi x |z'''| + x^2 |z''|
 */
LANE_INLINE struct segment segment_init(vd omega, double omega_max, double damping, double step, int n)
{
	struct segment p = {.step = step, .terms = terms_of(omega_max * step)};
	const double scale = step * step, share = 1.0 / n;
	vd x = p.x = omega * step, x2 = x * x, damp = p.damp = x * (2 * damping), both = vfma(damp, damp, x2);
	vd on_e = vfma(both * x, vsplat(2 * damping + 1), damp * x2) * vsplat(POUND_CUBIC_ERROR);
	p.on_z = on_e * x;
	p.on_v = on_e * step;
	p.on_drive[0] = vfma(both, vsplat(POUND_CUBIC_ERROR), on_e) * vsplat(scale);
	p.on_drive[1] = damp * vsplat(POUND_CUBIC_ERROR * scale * share);
	p.on_drive[2] = vsplat(POUND_CUBIC_ERROR * scale * share * share);
	return p;
}

/* Acceleration over a segment as a power series: coefficients to be taken times `scale`  (order + 1);  order -1: none. */
struct drive {
	const double *a;
	int order;
	double scale;
};

/* Power series of oscillators over a segment.
 *
 * Given    z, y    at the start, y = z' in the segment's time
 *          drive   acceleration of the floor or by the contact
 *
 *   (n + 1) z_n+1 = y_n     (n + 1) y_n+1 = -(2 xi x y_n + x^2 z_n + a_n)
 *
 * Only one fused operation of an order has to wait for the order before.
 */
LANE_INLINE void series_fill(struct oscillator_series *s, const struct segment *p, vd z, vd y,
                             const struct drive *drive)
{
	vd x2 = p->x * p->x, factor = vsplat(drive->scale);
	s->terms = larger(p->terms, drive->order + 2);
	s->z1 = s->y1 = vsplat(0);
	for (int n = 0;; n++) {
		s->z[n] = z;
		s->y[n] = y;
		s->z1 = s->z1 + z;
		s->y1 = s->y1 + y;
		if (n == s->terms)
			break;
		vd share = vsplat(POUND_SHARE[n]), minus = vsplat(MINUS_SHARE[n]), force = x2 * z;
		if (n <= drive->order)
			force = vfma(factor, vsplat(drive->a[n]), force);
		z = y * share;
		y = vfma(p->damp * minus, y, minus * force);
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

/* What a drive with these bounds over its piece adds to the error of the cubic of a segment. */
LANE_INLINE vd drive_error(const struct segment *p, const double bound[3])
{
	vd error = p->on_drive[2] * vsplat(bound[2]);
	for (int k = 1; k >= 0; k--)
		error = vfma(p->on_drive[k], vsplat(bound[k]), error);
	return error;
}

/* Lanes in which |z| may have a new largest value inside a segment; ends are taken here.
 *
 * Given    z1, v1  at the end;  error: of the drive
 */
LANE_INLINE vm segment_risk(const struct segment *p, struct state *s, vd z1, vd v1, vd error)
{
	vd third = vsplat(p->step * (1.0 / 3));
	vd b1 = vfma(third, s->v, s->z), b2 = vfma(-third, v1, z1);
	error = vfma(p->on_z, vabs(s->z), vfma(p->on_v, vabs(s->v), error));
	s->top = vmax(s->top, vabs(z1));
	return vless(s->top, vmax(vabs(b1), vabs(b2)) + error);
}

/* |z| at the root of the velocity that Newton's method finds from t; whatever it finds is a value that z takes. */
LANE_INLINE vd polished(const struct oscillator_series *s, const vd *slope_series, vd t)
{
	vd zero = vsplat(0), one = vsplat(1);
	for (int round = 0; round < POLISH; round++) {
		vd slope = series_at(slope_series, s->terms - 1, t);
		vd flat = vselect(vequal(slope, zero), one, slope);
		t = vmin(vmax(t - series_at(s->y, s->terms, t) / flat, zero), one);
	}
	return vabs(series_at(s->z, s->terms, t));
}

/* The larger of |z| at the extrema inside a segment, from both roots of the velocity of the cubic through its ends, and of top. */
static vd peak_add(const struct oscillator_series *s, vm risk, vd top)
{
	vd zero = vsplat(0), one = vsplat(1), slope_series[TERMS + 1];
	for (int n = 0; n < s->terms; n++)
		slope_series[n] = s->y[n + 1] * vsplat(n + 1);
	vd y0 = s->y[0], rise = s->z1 - s->z[0];
	vd a = 3.0 * rise - 2.0 * y0 - s->y1, b = s->y1 + y0 - 2.0 * rise;
	vd root = vsqrt(vmax(vfma(a, a, -3.0 * b * y0), zero));
	vd q = -(a + vselect(vless(a, zero), -root, root));
	vd t[2] = {q / vselect(vequal(b, zero), one, 3.0 * b), y0 / vselect(vequal(q, zero), one, q)},
	   most = zero;
	// most often one of them lies inside; the cubic's may be a little off
	for (int i = 0; i < 2; i++) {
		vm inside = vless(vsplat(-0.1), t[i]) & vless(t[i], vsplat(1.1)) & risk;
		if (vany(inside))
			most = vselect(inside, vmax(most, polished(s, slope_series, vmin(vmax(t[i], zero), one))), most);
	}
	return vselect(risk, vmax(top, most), top);
}

/* ---- drives ---- */

/* Coefficients of segment j of n equal ones in its own time, n a power of two: those of the piece where it is one segment, else
 * put into `room`. */
static const double *segment_drive(const double *a, int order, int j, int n, double *room)
{
	double share = 1.0 / n, from = j * share, power = 1;
	if (n == 1)
		return a;
	for (int k = 0; k <= order; k++)
		room[k] = a[k];
	for (int i = 0; i < order && j > 0; i++)
		for (int k = order - 1; k >= i; k--)
			room[k] += from * room[k + 1];
	for (int k = 0; k <= order; k++, power *= share)
		room[k] *= power;
	return room;
}

/* Parts that a step is cut into so that the fastest oscillator turns by `radians` at most in each: a power of two. */
static int segments_of(double omega_max, double step, double radians)
{
	int n = 1;
	while (omega_max * step > radians * n && n < SEGMENTS_LIMIT)
		n *= 2;
	return n;
}

/* ---- any piece ---- */

/* Integrals of a polynomial over segment j of n of its piece. */
static void integrals_fill(const struct pound_kernel *kernel, const double *a, int order, int j, int n,
                           double integral[INTEGRALS])
{
	double room[POUND_FLOOR_ORDER + 1];
	const double *c = n > SEGMENTS_MAX ? segment_drive(a, order, j, n, room) : a;
	const double(*row)[INTEGRALS] = kernel->segment[n > SEGMENTS_MAX ? 1 : n + j];
	vd sum[INTEGRALS / W] = {0};
	for (int k = order; k >= 0; k--)
#pragma GCC unroll 6
		for (int i = 0; i < INTEGRALS / W; i++)
			sum[i] = vfma(vsplat(c[k]), *(const vd *)(row[k] + i * W), sum[i]);
	for (int i = 0; i < INTEGRALS / W; i++)
		*(vd *)(integral + i * W) = sum[i];
}

/* What a segment does to a state: z' = zz z + zy y + fz, y' = yz z + yy y + fy, and the drives' shares (fz, fy). */
struct passage {
	vd zz, zy, yz, yy, fz[POUND_DRIVES], fy[POUND_DRIVES];
};

/* The passage of a segment by the response h to an initial y of 1, h = sum g_m t^m/m!, for n drives by their integrals.
 *
 *   g_0 = 0, g_1 = 1, g_m+1 = -(2 xi x g_m + x^2 g_m-1)
 *   z' = (h' + 2 xi x h) z + h y - sum g_m J_m     y' = -x^2 h z + h' y - sum g_m+1 J_m,  J_m the (m+1)-fold integral
 */
LANE_INLINE void passage_fill(struct passage *s, const struct segment *p, const double *const integral[],
                              int n_drives)
{
	vd damp = -p->damp, x2 = -(p->x * p->x), g = vsplat(0), next = vsplat(1), h = g, rate = g;
	for (int d = 0; d < n_drives; d++)
		s->fz[d] = s->fy[d] = g;
	for (int m = 0; m < p->terms; m++) {
		rate = vfma(next, vsplat(POUND_FACTOR[m]), rate);
		h = vfma(next, vsplat(POUND_FACTOR[m + 1]), h);
		for (int d = 0; d < n_drives; d++) {
			s->fy[d] = vfma(next, vsplat(integral[d][m]), s->fy[d]);
			s->fz[d] = vfma(next, vsplat(integral[d][m + 1]), s->fz[d]);
		}
		vd before = g;
		g = next;
		next = vfma(damp, g, x2 * before);
	}
	vd minus = vsplat(-(p->step * p->step));
	for (int d = 0; d < n_drives; d++) {
		s->fy[d] = s->fy[d] * minus;
		s->fz[d] = s->fz[d] * minus;
	}
	s->zz = vfma(p->damp, h, rate);
	s->zy = h;
	s->yz = x2 * h;
	s->yy = rate;
}

/* segment j of n equal ones of a piece */
struct segment_place {
	const struct pound_bank_input *input;
	const struct pound_floor_piece *piece;
	int j, n;
};

/* The largest |z| of a segment in which there may be an extremum, by its series; in the lanes of `risk`, else top.
 *
 * Given    s  at the start of the segment, the largest so far in `top`
 */
LANE_SHARED vd segment_top(const struct segment *p, const struct segment_place *at, enum pound_drive drive,
                           struct state s, vm risk)
{
	double made[POUND_FLOOR_ORDER + 1], room[POUND_FLOOR_ORDER + 1];
	const double *a;
	struct oscillator_series series;
	const int order = pound_floor_drive(at->input->stretch, at->piece, drive, at->input->damping, made, &a);
	const struct drive of_segment = {segment_drive(a, order, at->j, at->n, room), order, p->step * p->step};
	series_fill(&series, p, s.z, s.v * p->step, &of_segment);
	return peak_add(&series, risk, s.top);
}

/* Moves a state over a segment; the series is only made where there may be an extremum inside.
 *
 * Given    to     its z and v there;  error: of the drive
 */
LANE_INLINE void segment_pass(const struct segment *p, const struct segment_place *at, enum pound_drive drive,
                              struct state *s, struct state to, vd error)
{
	vm risk = segment_risk(p, s, to.z, to.v, error);
	if (__builtin_expect(vany(risk), 0))
		s->top = segment_top(p, at, drive, *s, risk);
	s->z = to.z;
	s->v = to.v;
}

/* Oscillators over one segment of a piece, by the integrals of its drives. */
LANE_INLINE void segment_move(const struct segment *p, const struct segment_place *at, struct state s[],
                              int n_drives, const double *const integral[])
{
	const struct pound_polynomial *a[POUND_DRIVES] = {&at->piece->floor, &at->piece->push};
	struct passage passage;
	double per_step = 1 / p->step;
	passage_fill(&passage, p, integral, n_drives);
	for (int d = 0; d < n_drives; d++) {
		vd y = s[d].v * p->step;
		vd z1 = vfma(passage.zz, s[d].z, vfma(passage.zy, y, passage.fz[d]));
		vd y1 = vfma(passage.yz, s[d].z, vfma(passage.yy, y, passage.fy[d]));
		segment_pass(p, at, d, &s[d], (struct state){.z = z1, .v = y1 * per_step},
		             drive_error(p, a[d]->bound));
	}
}

/* Oscillators over a piece of many segments: each segment has integrals of its own. */
LANE_SHARED void segments_move(const struct pound_bank *bank, const struct segment *p,
                               struct segment_place *at, struct state s[])
{
	alignas(64) double own[POUND_DRIVES][INTEGRALS];
	double room[POUND_FLOOR_ORDER + 1];
	const double *c[POUND_DRIVES], *const integral[POUND_DRIVES] = {own[0], own[1]};
	int order[POUND_DRIVES];
	for (int d = 0; d < bank->n_drives; d++)
		order[d] = pound_floor_drive(at->input->stretch, at->piece, d, at->input->damping, room, &c[d]);
	for (at->j = 0; at->j < at->n; at->j++) {
		for (int d = 0; d < bank->n_drives; d++)
			integrals_fill(bank->kernel, c[d], order[d], at->j, at->n, own[d]);
		segment_move(p, at, s, bank->n_drives, integral);
	}
}

/* ---- free motion ---- */

/* The maps of all segments of a sample, of every stiffness of a stretch. */
static void maps_fill(struct maps *maps, const struct pound_bank *bank, const struct segment *p,
                      const struct pound_bank_input *input, int segments)
{
	alignas(64) double integrals[INTEGRALS] = {0};
	const double *const integral[] = {integrals};
	struct passage passage;
	vd per_step = vsplat(1 / p->step);
	const int order = input->stretch->order;
	passage_fill(&passage, p, integral, 0);
	maps->zz = passage.zz, maps->vz = passage.yz * per_step;
	maps->zv = passage.zy * p->step, maps->vv = passage.yy;
	for (int m = 0; m < input->stretch->n_maps; m++)
		for (int state = 0; state < 4; state++) {
			const double unit[4] = {state == 0, state == 1, state == 2, state == 3};
			const double k = input->stretch->stiffness[m];
			double a[POUND_FLOOR_ORDER + 1];
			pound_floor_free_motion(unit, k, input->damping, input->time_step, order, a);
			for (int j = 0; j < segments; j++) {
				integrals_fill(bank->kernel, a, order, j, segments, integrals);
				passage_fill(&passage, p, integral, 1);
				maps->segment[m][j].gz[state] = passage.fz[0];
				maps->segment[m][j].gv[state] = passage.fy[0] * per_step;
			}
		}
}

/* A whole sample by maps; the floor's drive has them, the contact gives none. */
LANE_INLINE void free_move(const struct maps *maps, const struct segment *p, struct segment_place *at,
                           enum pound_drive drive, struct state *s)
{
	const struct pound_floor_piece *piece = at->piece;
	const bool driven = drive == POUND_DRIVE_FLOOR;
	const vd error = driven ? drive_error(p, piece->floor.bound) : vsplat(0);
	vd state[4];
	for (int k = 0; k < 4; k++)
		state[k] = vsplat(piece->state[k]);
	for (at->j = 0; at->j < at->n; at->j++) {
		vd z = vsplat(0), v = vsplat(0);
		if (driven) {
			// what does not wait for the sample before comes first
			const struct segment_map *f = &maps->segment[piece->map][at->j];
#pragma GCC unroll 4
			for (int k = 0; k < 4; k++) {
				z = vfma(f->gz[k], state[k], z);
				v = vfma(f->gv[k], state[k], v);
			}
		}
		z = vfma(maps->zz, s->z, vfma(maps->zv, s->v, z));
		v = vfma(maps->vz, s->z, vfma(maps->vv, s->v, v));
		segment_pass(p, at, drive, s, (struct state){.z = z, .v = v}, error);
	}
}

/* ---- the bank ---- */

/* One vector of oscillators over a whole stretch. */
static void vector_move(const struct pound_bank *bank, const struct pound_bank_input *input, int at,
                        double omega_max, struct scratch *scratch)
{
	vd omega = *(const vd *)(bank->omega + at);
	struct state s[POUND_DRIVES];
	for (int d = 0; d < bank->n_drives; d++)
		s[d] = (struct state){*(vd *)(bank->z[d] + at), *(vd *)(bank->v[d] + at), *(vd *)(bank->top[d] + at)};
	int segments = segments_of(omega_max, input->time_step, bank->radians);
	bool mapped = segments <= SEGMENTS_MAX && input->stretch->n_maps > 0;
	struct segment sample =
	    segment_init(omega, omega_max, bank->damping, input->time_step / segments, segments);
	if (mapped)
		maps_fill(&scratch->maps, bank, &sample, input, segments);
	for (int i = 0; i < input->stretch->n; i++) {
		const struct pound_floor_piece *piece = &input->stretch->piece[i];
		struct segment_place place = {.input = input, .piece = piece, .n = segments};
		for (int d = 0; d < bank->n_drives && piece->jump != 0; d++)
			s[d].v = s[d].v - vsplat(piece->jump);
		if (piece->map >= 0 && mapped) {
			free_move(&scratch->maps, &sample, &place, POUND_DRIVE_FLOOR, &s[POUND_DRIVE_FLOOR]);
			if (bank->n_drives > 1)
				free_move(&scratch->maps, &sample, &place, POUND_DRIVE_PUSH, &s[POUND_DRIVE_PUSH]);
			continue;
		}
		place.n = segments_of(omega_max, piece->step, bank->radians);
		struct segment p = segment_init(omega, omega_max, bank->damping, piece->step / place.n, place.n);
		const double *const whole[POUND_DRIVES] = {scratch->integral[i][0], scratch->integral[i][1]};
		if (place.n > 1)
			segments_move(bank, &p, &place, s);
		else if (bank->n_drives > 1)
			segment_move(&p, &place, s, POUND_DRIVES, whole);
		else
			segment_move(&p, &place, s, 1, whole);
	}
	for (int d = 0; d < bank->n_drives; d++) {
		*(vd *)(bank->z[d] + at) = s[d].z;
		*(vd *)(bank->v[d] + at) = s[d].v;
		*(vd *)(bank->top[d] + at) = s[d].top;
	}
}

/* Takes all oscillators of a bank over the pieces of a stretch.
 *
 * Given    bank     state and largest displacements, moved on
 *          scratch  POUND_SPECTRUM_SCRATCH bytes, 64-byte aligned
 *
 * Valid    exact but for rounding; bits of an oscillator depend on its group, not on the lane count
 * Test     unit_oscillator_bank
 */
void POUND_OSCILLATOR_BANK(const struct pound_bank *bank, const struct pound_bank_input *input, void *scratch)
{
	struct scratch *room = scratch;
	for (int i = 0; i < input->stretch->n; i++) {
		const struct pound_floor_piece *piece = &input->stretch->piece[i];
		if (piece->map >= 0)
			continue;
		integrals_fill(bank->kernel, piece->floor.c, piece->order, 0, 1,
		               room->integral[i][POUND_DRIVE_FLOOR]);
		if (bank->n_drives > 1)
			integrals_fill(bank->kernel, piece->push.c, piece->order, 0, 1,
			               room->integral[i][POUND_DRIVE_PUSH]);
	}
	for (int g = 0; g < bank->n_groups; g++) {
		const double *omega = bank->omega + g * POUND_SPECTRUM_GROUP;
		double omega_max = 0;
		for (int l = 0; l < POUND_SPECTRUM_GROUP; l++)
			omega_max = omega[l] > omega_max ? omega[l] : omega_max;
		for (int l = 0; l < POUND_SPECTRUM_GROUP; l += W)
			vector_move(bank, input, g * POUND_SPECTRUM_GROUP + l, omega_max, room);
	}
}
