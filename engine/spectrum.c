/* spectrum.c - oscillators on a floor, driven by its pieces exactly, their largest displacements between steps too.
 *
 * 1. A piece is cut into 2^L equal parts, so that w times a part is at most one radian and a power series of the
 *    oscillator ends in rounding; L is that of the fastest of a group of eight.
 * 2. A whole sample of free flight is linear in the oscillator's state and four numbers of the floor's, with maps
 *    that are made once; any other piece is done by the series itself.
 * 3. The cubic through both ends of a part, widened by the bound of its error, proves that no new largest displacement
 *    lies inside; where it does not, the velocity's roots are polished on the series. */
#include "engine/spectrum.h"

#include <assert.h>
#include <stdalign.h>

#include "engine/lanes.h"

enum {
	TERMS = 20,     /* of a series, at most: 1^20/20! is far below rounding */
	PARTS_MAX = 16, /* of a sample that has maps */
	PARTS_LIMIT = 1 << 24,
	POLISH = 3, /* rounds of Newton from the cubic's extremum, which misses by 1e-3 at most */
};

/* A part of a piece: its step and the bounds of the drive over it.  All motions below are in its time 0 .. 1. */
struct part {
	double step, fastest;  /* [s]; w * step of the fastest of the group */
	vd x, damp;            /* w step, 2 xi w step */
	vd alpha, beta, gamma; /* |z''''| <= 384 (alpha e + beta A + gamma A' + A''/384), see part_init */
};

/* the maps of one part of a sample: z' = zz z + zv v + gz state, v' = vz z + vv v + gv state */
struct flight {
	vd gz[4], gv[4];
};

struct maps {
	vd zz, zv, vz, vv;
	struct flight part[POUND_TRACE_MAPS][PARTS_MAX];
};

struct state {
	vd z, v, top;
};

struct series {
	int terms;
	vd z[TERMS + 1], y[TERMS + 1]; /* y: derivative of z */
	vd z1, y1;
};

struct scratch {
	alignas(64) struct maps maps;
};

static_assert(sizeof(struct scratch) <= POUND_SPECTRUM_SCRATCH, "the work space is too small");

static int larger(int a, int b)
{
	return a > b ? a : b;
}

/* Terms after which x^n/n! is below rounding, x <= 1. */
static int terms_of(double x)
{
	double term = 1;
	int n = 0;
	while (n < TERMS && term > 0x1p-54)
		term *= x / ++n;
	return n;
}

/* A part of step h, for oscillators of frequency w.
 *
 * With e = x |z0| + |y0| + A, x = w h and A, A', A'' bounds of the drive times h^2:  x |z| <= e and |z'| <= e inside, so
 *   |z''| <= A + (2 xi + 1) x e,   |z'''| <= A' + 2 xi x |z''| + x^2 e,   |z''''| <= A'' + 2 xi x |z'''| + x^2 |z''|
 */
static struct part part_init(vd omega, double omega_max, double damping, double step)
{
	struct part p = {.step = step, .fastest = omega_max * step};
	vd x = p.x = omega * step, x2 = x * x, both;
	vd damp = p.damp = x * (2 * damping);
	both = damp * damp + x2;
	p.alpha = (both * x * (2 * damping + 1) + damp * x2) * (1.0 / 384);
	p.beta = both * (1.0 / 384);
	p.gamma = damp * (1.0 / 384);
	return p;
}

/* Power series of oscillators over a part.
 *
 * Given    z, y    at the start, y = z' in the part's time
 *          drive   (order + 1)  coefficients of the acceleration times step^2;  order -1: none
 *
 *   (n + 1) z_n+1 = y_n     (n + 1) y_n+1 = -(2 xi x y_n + x^2 z_n + a_n)
 */
LANE_INLINE void series_fill(struct series *s, const struct part *p, vd z, vd y, const double *drive,
                             int order)
{
	vd x2 = p->x * p->x;
	s->terms = larger(terms_of(p->fastest), order + 2);
	s->z1 = s->y1 = vsplat(0);
	for (int n = 0;; n++) {
		s->z[n] = z;
		s->y[n] = y;
		s->z1 = s->z1 + z;
		s->y1 = s->y1 + y;
		if (n == s->terms)
			break;
		vd share = vsplat(1.0 / (n + 1));
		vd sum = vfma(p->damp, y, x2 * z);
		if (n <= order)
			sum = sum + vsplat(drive[n]);
		z = y * share;
		y = -sum * share;
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

/* Lanes in which |z| may have a new largest value inside a part; ends are taken here.
 *
 * Given    y0, y1   derivatives in the part's time;  bound: of the drive and its derivatives, times step^2
 */
LANE_INLINE vm part_risk(const struct part *p, struct state *s, vd y0, vd z1, vd y1, const double bound[3])
{
	vd third = vsplat(1.0 / 3);
	vd b1 = vfma(third, y0, s->z), b2 = vfma(-third, y1, z1);
	vd e = vfma(p->x, vabs(s->z), vabs(y0) + vsplat(bound[0]));
	vd error = vfma(p->alpha, e,
	                vfma(p->beta, vsplat(bound[0]), vfma(p->gamma, vsplat(bound[1]), vsplat(bound[2]))));
	s->top = vmax(s->top, vabs(z1));
	return vless(s->top, vmax(vabs(b1), vabs(b2)) + error);
}

/* |z| at the root of the velocity that Newton's method finds from t; whatever it finds is a value that z takes. */
LANE_INLINE vd polished(const struct series *s, const vd *bend, vd t)
{
	vd zero = vsplat(0), one = vsplat(1);
	for (int round = 0; round < POLISH; round++) {
		vd slope = series_at(bend, s->terms - 1, t);
		vd flat = vselect(vequal(slope, zero), one, slope);
		t = vmin(vmax(t - series_at(s->y, s->terms, t) / flat, zero), one);
	}
	return vabs(series_at(s->z, s->terms, t));
}

/* The extrema inside a part, from both roots of the velocity of the cubic through its ends. */
static void peak_add(const struct series *s, vm risk, vd *top)
{
	vd zero = vsplat(0), one = vsplat(1), bend[TERMS + 1];
	for (int n = 0; n < s->terms; n++)
		bend[n] = s->y[n + 1] * (double)(n + 1);
	vd y0 = s->y[0], rise = s->z1 - s->z[0];
	vd a = 3.0 * rise - 2.0 * y0 - s->y1, b = s->y1 + y0 - 2.0 * rise;
	vd root = vsqrt(vmax(vfma(a, a, -3.0 * b * y0), zero));
	vd q = -(a + vselect(vless(a, zero), -root, root));
	vd left = q / vselect(vequal(b, zero), one, 3.0 * b);
	vd right = y0 / vselect(vequal(q, zero), one, q);
	vd most = polished(s, bend, vmin(vmax(left, zero), one));
	most = vmax(most, polished(s, bend, vmin(vmax(right, zero), one)));
	*top = vselect(risk, vmax(*top, most), *top);
}

/* ---- drives ---- */

/* Coefficients of part j of n equal ones, in its own time and times the square of its step, n a power of two. */
static void part_drive(const struct pound_polynomial *a, int order, int j, int n, double step, double *out)
{
	double from = (double)j / n, power = step * step;
	for (int k = 0; k <= order; k++)
		out[k] = a->c[k];
	for (int i = 0; i < order && j > 0; i++)
		for (int k = order - 1; k >= i; k--)
			out[k] += from * out[k + 1];
	for (int k = 0; k <= order; k++, power /= n)
		out[k] *= power;
}

static void part_bound(const struct pound_polynomial *a, int n, double step, double bound[3])
{
	double scale = step * step;
	bound[0] = a->bound[0] * scale;
	bound[1] = a->bound[1] * scale / n;
	bound[2] = a->bound[2] * scale / n / n / 384;
}

/* Parts that a step is cut into so that the fastest oscillator turns by `radians` at most in each: a power of two. */
static int parts_of(double omega_max, double step, double radians)
{
	int n = 1;
	while (omega_max * step > radians * n && n < PARTS_LIMIT)
		n *= 2;
	return n;
}

/* ---- any piece ---- */

/* Oscillators over one part by their series. */
LANE_INLINE void part_ride(const struct part *p, struct state *s, const struct pound_polynomial *a,
                           const struct pound_trace_piece *piece, int j, int n)
{
	double drive[POUND_TRACE_ORDER + 1], bound[3];
	part_drive(a, piece->order, j, n, p->step, drive);
	part_bound(a, n, p->step, bound);
	struct series series;
	int order = a->bound[0] > 0 ? piece->order : -1;
	series_fill(&series, p, s->z, s->v * p->step, drive, order);
	vm risk = part_risk(p, s, series.y[0], series.z1, series.y1, bound);
	if (vany(risk))
		peak_add(&series, risk, &s->top);
	s->z = series.z1;
	s->v = series.y1 / p->step;
}

/* ---- free flight ---- */

/* Drives of unit states over a sample h: what the floor's acceleration -(c v + r) is for each of r, v, ground, rise.
 *
 *   r' = k v     v' = -(c v + r + ground + rise t/h)
 */
static int unit_drive(int state, double k, double c, double h, struct pound_polynomial *a)
{
	double r = state == 0, v = state == 1, x = fmax(__builtin_sqrt(k), c) * h;
	int order = larger(terms_of(x), 4);
	order = order > POUND_TRACE_ORDER ? POUND_TRACE_ORDER : order;
	for (int n = 0; n <= order; n++) {
		double ground = (state == 2 && n == 0) || (state == 3 && n == 1);
		double next = -h * (c * v + r + ground) / (n + 1);
		a->c[n] = -(c * v + r);
		r = h * k * v / (n + 1);
		v = next;
	}
	return order;
}

/* The maps of all parts of a sample, of every stiffness of a stretch. */
static void maps_fill(struct maps *maps, const struct part *p, const struct pound_ride *ride, int parts)
{
	struct series s;
	vd zero = vsplat(0), one = vsplat(1);
	double drive[POUND_TRACE_ORDER + 1];
	series_fill(&s, p, one, zero, NULL, -1);
	maps->zz = s.z1, maps->vz = s.y1 / p->step;
	series_fill(&s, p, zero, one * p->step, NULL, -1);
	maps->zv = s.z1, maps->vv = s.y1 / p->step;
	for (int m = 0; m < ride->stretch->n_maps; m++)
		for (int state = 0; state < 4; state++) {
			struct pound_polynomial a;
			int order = unit_drive(state, ride->stretch->stiffness[m], ride->damping, ride->time_step, &a);
			for (int j = 0; j < parts; j++) {
				part_drive(&a, order, j, parts, p->step, drive);
				series_fill(&s, p, zero, zero, drive, order);
				maps->part[m][j].gz[state] = s.z1;
				maps->part[m][j].gv[state] = s.y1 / p->step;
			}
		}
}

/* A whole sample by maps; the floor's drive has them, the contact gives none. */
LANE_INLINE void flight_ride(const struct maps *maps, const struct part *p, struct state *s,
                             const struct pound_trace_piece *piece, enum pound_drive drive, int parts)
{
	static const struct pound_polynomial none;
	const struct pound_polynomial *a = drive == POUND_DRIVE_FLOOR ? &piece->floor : &none;
	double bound[3];
	part_bound(a, parts, p->step, bound);
	for (int j = 0; j < parts; j++) {
		vd z = vfma(maps->zv, s->v, maps->zz * s->z), v = vfma(maps->vv, s->v, maps->vz * s->z);
		if (drive == POUND_DRIVE_FLOOR) {
			const struct flight *f = &maps->part[piece->map][j];
			for (int k = 0; k < 4; k++) {
				z = vfma(f->gz[k], vsplat(piece->state[k]), z);
				v = vfma(f->gv[k], vsplat(piece->state[k]), v);
			}
		}
		vm risk = part_risk(p, s, s->v * p->step, z, v * p->step, bound);
		if (vany(risk)) {
			double coefficients[POUND_TRACE_ORDER + 1];
			struct series series;
			part_drive(a, piece->order, j, parts, p->step, coefficients);
			series_fill(&series, p, s->z, s->v * p->step, coefficients,
			            drive == POUND_DRIVE_FLOOR ? piece->order : -1);
			peak_add(&series, risk, &s->top);
		}
		s->z = z;
		s->v = v;
	}
}

/* ---- the bank ---- */

/* One vector of oscillators over a whole stretch. */
static void vector_ride(const struct pound_bank *bank, const struct pound_ride *ride, int at,
                        double omega_max, struct scratch *scratch)
{
	vd omega = *(const vd *)(bank->omega + at);
	struct state s[POUND_DRIVES];
	for (int d = 0; d < bank->n_drives; d++)
		s[d] = (struct state){*(vd *)(bank->z[d] + at), *(vd *)(bank->v[d] + at), *(vd *)(bank->top[d] + at)};
	int parts = parts_of(omega_max, ride->time_step, bank->radians);
	bool mapped = parts <= PARTS_MAX && ride->stretch->n_maps > 0;
	struct part sample = part_init(omega, omega_max, bank->damping, ride->time_step / parts);
	if (mapped)
		maps_fill(&scratch->maps, &sample, ride, parts);
	for (int i = 0; i < ride->stretch->n; i++) {
		const struct pound_trace_piece *piece = &ride->stretch->piece[i];
		if (piece->map >= 0 && mapped) {
			flight_ride(&scratch->maps, &sample, &s[POUND_DRIVE_FLOOR], piece, POUND_DRIVE_FLOOR, parts);
			if (bank->n_drives > 1)
				flight_ride(&scratch->maps, &sample, &s[POUND_DRIVE_PUSH], piece, POUND_DRIVE_PUSH, parts);
			continue;
		}
		int n = parts_of(omega_max, piece->step, bank->radians);
		struct part p = part_init(omega, omega_max, bank->damping, piece->step / n);
		for (int d = 0; d < bank->n_drives; d++)
			for (int j = 0; j < n; j++)
				part_ride(&p, &s[d], d == POUND_DRIVE_FLOOR ? &piece->floor : &piece->push, piece, j, n);
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
 * Test     unit_spectrum
 */
void POUND_SPECTRUM(const struct pound_bank *bank, const struct pound_ride *ride, void *scratch)
{
	for (int g = 0; g < bank->n_groups; g++) {
		const double *omega = bank->omega + g * POUND_SPECTRUM_GROUP;
		double omega_max = 0;
		for (int l = 0; l < POUND_SPECTRUM_GROUP; l++)
			omega_max = omega[l] > omega_max ? omega[l] : omega_max;
		for (int l = 0; l < POUND_SPECTRUM_GROUP; l += W)
			vector_ride(bank, ride, g * POUND_SPECTRUM_GROUP + l, omega_max, scratch);
	}
}
