/* kanai_tajimi.c - white noise through the Kanai-Tajimi filter and the second-order high pass of Clough and Penzien, as an
 * ARMA(4, 3) recurrence with one normal number per sample and exactly the autocovariance of the continuous process.
 *
 *   1. p'''' + c3 p''' + c2 p'' + c1 p' + c0 p = w   and   a = alpha p''' + beta p''
 *   2. from sample to sample: the transition matrix F = 1 + D, and the covariance Q of the noise added within a step
 *   3. spectral density of the samples: a polynomial of degree 3 in |z - 1|^2 over |det(z - F)|^2
 *   4. spectral factorization: the cubic numerator with all zeros inside the unit circle whose squared modulus is the
 *      polynomial of 3; numerator and denominator are the coefficients of a recurrence with a new state
 *   5. the state before the first sample from the stationary covariance of the new state
 *
 * Polynomials are in d = z - 1, on the unit circle in v = |d|^2: with small steps poles and zeros are near z = 1, where d
 * has no cancellation.  Time is in sample steps and the state is (p''', p'', p', p), so the scaling of the matrices is the
 * same for any step, and small steps lose no digits.
 * Kanai 1957, Bull. Earthq. Res. Inst. 35, 309-325; Tajimi 1960, Proc. 2nd WCEE, 781-798;
 * Clough, Penzien 1975, Dynamics of structures, McGraw-Hill;
 * Anderson, Moore 1979, Optimal filtering, Prentice-Hall, chapter 9: spectral factorization. */
#include "engine/ground/kanai_tajimi.h"

#include <float.h>
#include <math.h>
#include <stdbool.h>

enum { N = FILTER_STATES, NODES = 8 };

static const double HIGH_PASS_DAMPING = 0.6;

/* p'''' + c[3] p''' + c[2] p'' + c[1] p' + c[0] p = (s^2 + alpha s + beta) (s^2 + gamma s + delta) p,  s: d/dt, t in steps */
struct filter {
	double alpha, beta;  /* Kanai-Tajimi */
	double gamma, delta; /* high pass */
	double c[N];
};

static double within(double x, double low, double high)
{
	return x < low ? low : x > high ? high : x;
}

static struct filter filter_of(double theta, double damping_ratio, double high_pass_ratio)
{
	theta = within(theta, 1e-20, 1e6);
	damping_ratio = within(damping_ratio, 1e-9, 1e9);
	const double corner = within(high_pass_ratio, 1e-9, 1e9) * theta;
	struct filter k = {.alpha = 2 * damping_ratio * theta,
	                   .beta = theta * theta,
	                   .gamma = 2 * HIGH_PASS_DAMPING * corner,
	                   .delta = corner * corner};
	k.c[3] = k.alpha + k.gamma;
	k.c[2] = k.beta + k.alpha * k.gamma + k.delta;
	k.c[1] = k.alpha * k.delta + k.beta * k.gamma;
	k.c[0] = k.beta * k.delta;
	return k;
}

/* (exp(A s) - 1) x, by its power series:  A (x0, x1, x2, x3) = (-c3 x0 - c2 x1 - c1 x2 - c0 x3, x0, x1, x2)
 *
 * Valid    s times the largest pole <= 1; the series ends when a term changes no component */
static void propagate(const double c[N], double s, double x[N])
{
	double t0 = x[0], t1 = x[1], t2 = x[2], t3 = x[3];
	double x0 = 0, x1 = 0, x2 = 0, x3 = 0;
	// a component may be zero in the first N - 1 terms
	for (int n = 1; n < N || x0 + t0 != x0 || x1 + t1 != x1 || x2 + t2 != x2 || x3 + t3 != x3; n++) {
		const double by = s / n, top = -((c[3] * t0 + c[2] * t1) + (c[1] * t2 + c[0] * t3));
		t3 = t2 * by;
		t2 = t1 * by;
		t1 = t0 * by;
		t0 = top * by;
		x0 += t0;
		x1 += t1;
		x2 += t2;
		x3 += t3;
	}
	x[0] = x0, x[1] = x1, x[2] = x2, x[3] = x3;
}

/* Covariance that white noise of intensity 1 adds to the state within time h.
 *
 *   Q = integral of v v^T from 0 to h,   v(s) = exp(A s) (1, 0, 0, 0)^T
 *
 * by Gauss-Legendre quadrature: a sum of v v^T with positive weights does not cancel.  For h = 1 and slow poles v is
 * nearly (1, s, s^2/2, s^3/6), so Q is a Hilbert matrix with scaled rows; its pivots are accurate to 1e-12.
 *
 * Valid    h times the largest pole <= 1: the quadrature error is below rounding
 * Test     unit_kanai_tajimi, through the variance */
static void covariance(const double c[N], double h, double q[N][N])
{
	static const double node[NODES / 2] = {0x1.454e34f533998p-6, 0x1.a06d536d82f88p-4, 0x1.e5dad4f9af698p-3,
	                                       0x1.a214dac30e32fp-2}; /* and 1 - node */
	static const double weight[NODES / 2] = {0x1.9ea1d04ca0374p-5, 0x1.c76fb531d2b96p-4, 0x1.413c50a255615p-3,
	                                         0x1.736360b199343p-3};
	for (int i = 0; i < N; i++)
		for (int j = 0; j < N; j++)
			q[i][j] = 0;
	for (int k = 0; k < NODES; k++) {
		double v[N] = {1, 0, 0, 0};
		const double s = k < NODES / 2 ? node[k] : 1 - node[NODES - 1 - k];
		propagate(c, s * h, v);
		v[0] += 1;
		for (int i = 0; i < N; i++)
			for (int j = 0; j < N; j++)
				q[i][j] += weight[k < NODES / 2 ? k : NODES - 1 - k] * h * v[i] * v[j];
	}
}

/* out = a b; out must not alias a or b */
static inline void product(double a[N][N], double b[N][N], double out[N][N])
{
#pragma GCC unroll 4
	for (int i = 0; i < N; i++) {
#pragma GCC unroll 4
		for (int j = 0; j < N; j++)
			out[i][j] = (a[i][0] * b[0][j] + a[i][1] * b[1][j]) + (a[i][2] * b[2][j] + a[i][3] * b[3][j]);
	}
}

/* out = a q a^T for a symmetric q; out must not alias a or q */
static inline void congruent(double a[N][N], double q[N][N], double out[N][N])
{
	double aq[N][N], transposed[N][N];
	product(a, q, aq);
	for (int i = 0; i < N; i++)
		for (int j = 0; j < N; j++)
			transposed[j][i] = aq[i][j];
	product(a, transposed, out);
}

/* D = F - 1 and covariance over twice the time:  2 D + D D  and  Q + F Q F^T.  D, not F, because F of a slow pole is
 * nearly 1 and would lose the digits of D.
 *
 * Returns  value   whether a variance has grown */
static bool doubled(double d[N][N], double q[N][N])
{
	double f[N][N], grown[N][N], dd[N][N];
	for (int i = 0; i < N; i++)
		for (int j = 0; j < N; j++)
			f[i][j] = d[i][j] + (i == j);
	congruent(f, q, grown);
	product(d, d, dd);
	bool grows = false;
	for (int i = 0; i < N; i++) {
		grows |= q[i][i] + grown[i][i] > q[i][i];
		for (int j = 0; j < N; j++) {
			q[i][j] += grown[i][j];
			d[i][j] = 2 * d[i][j] + dd[i][j];
		}
	}
	return grows;
}

/* sum and product of two roots of d^2 - sum d + product */
struct pair {
	double sum, product;
};

/* The poles d = exp(p) - 1 of a step,  p^2 + b p + c = 0.
 *
 * Poles for time h: trace and determinant of exp(A h) - 1 by its power series,  A (x0, x1) = (-b x0 - c x1, x0); the
 * determinant has no cancellation.  Each doubling of the time:  d -> 2 d + d^2.
 *
 * Valid    h times the largest pole <= 1 */
static struct pair poles_of(double b, double c, double h, int doublings)
{
	double d[2][2];
	for (int j = 0; j < 2; j++) {
		double t0 = j == 0, t1 = j == 1, x0 = 0, x1 = 0;
		for (int n = 1; n < 3 || x0 + t0 != x0 || x1 + t1 != x1; n++) {
			const double by = h / n, top = -(b * t0 + c * t1);
			t1 = t0 * by;
			t0 = top * by;
			x0 += t0;
			x1 += t1;
		}
		d[0][j] = x0, d[1][j] = x1;
	}
	struct pair p = {d[0][0] + d[1][1], d[0][0] * d[1][1] - d[0][1] * d[1][0]};
	for (int i = 0; i < doublings; i++)
		p = (struct pair){2 * p.sum + (p.sum * p.sum - 2 * p.product),
		                  p.product * (4 + 2 * p.sum + p.product)};
	return p;
}

/* a_0 .. a_3 of  det(d - D) = d^4 + a_3 d^3 + a_2 d^2 + a_1 d + a_0 */
static void denominator_of(struct pair p, struct pair q, double a[N])
{
	a[3] = -(p.sum + q.sum);
	a[2] = p.product + q.product + p.sum * q.sum;
	a[1] = -(p.sum * q.product + q.sum * p.product);
	a[0] = p.product * q.product;
}

/* Numerator of the transfer function from the noise added to each state to the samples:  C adj(d - D),  d = z - 1.
 *
 * Returns  numerator  (N x N)   row j: the coefficients of d^j, one per state
 *
 * Source   adj = sum of M_j d^j,  M_3 = 1,  M_j-1 = M_j D + a_j */
static void numerator_of(double d[N][N], const double a[N], const double c[N], double numerator[N][N])
{
	for (int j = 0; j < N; j++)
		numerator[N - 1][j] = c[j];
	for (int power = N - 1; power > 0; power--) {
		const double *n = numerator[power];
		for (int j = 0; j < N; j++)
			numerator[power - 1][j] =
			    (n[0] * d[0][j] + n[1] * d[1][j]) + (n[2] * d[2][j] + n[3] * d[3][j]) + a[power] * c[j];
	}
}

/* |sum of n_j d^j|^2 on the unit circle for added noise of covariance q, as a polynomial in v = |d|^2.
 *
 *   d + conj d = -v     d^2 + conj d^2 = v^2 - 2 v     d^3 + conj d^3 = 3 v^2 - v^3 */
static void density_of(double n[N][N], double q[N][N], double density[N])
{
	double g[N][N];
	congruent(n, q, g);
	density[0] = g[0][0];
	density[1] = g[1][1] - g[0][1] - 2 * g[0][2];
	density[2] = g[2][2] - g[1][2] - 2 * g[1][3] + g[0][2] + 3 * g[0][3];
	density[3] = g[3][3] - g[2][3] + g[1][3] - g[0][3];
}

/* A real root of q[0] + q[1] v + q[2] v^2 + q[3] v^3, a cubic that is positive for v in [0, 4].
 *
 * Returns  value   the root below 0 if q[3] > 0, else above 4; to rounding
 *
 * Newton's method within a bracket; if a Newton step fails, bisection, geometric as long as the bracket is wide.
 *
 * Source   the bracket: Cauchy's bounds of the roots */
static double root_of(const double q[N])
{
	const double sign = q[3] > 0 ? -1 : 1; // q(sign u) is positive below the root, negative above it
	const double c[N] = {q[0], sign * q[1], q[2], sign * q[3]};
	const double most = fmax(fabs(c[1]), fabs(c[2]));
	double low = c[0] / (c[0] + fmax(most, fabs(c[3]))), high = 1 + fmax(most, c[0]) / fabs(c[3]);
	double u = high, width = high;
	for (;;) {
		const double value = ((c[3] * u + c[2]) * u + c[1]) * u + c[0];
		const double slope = (3 * c[3] * u + 2 * c[2]) * u + c[1];
		if (value > 0)
			low = u;
		else
			high = u;
		double next = u - value / slope;
		if (!(next > low && next < high && fabs(next - u) < 0.5 * width))
			next = high > 4 * low ? sqrt(low) * sqrt(high) : low + 0.5 * (high - low);
		if (!(next > low && next < high && fabs(next - u) > DBL_EPSILON * u))
			return sign * u;
		width = fabs(next - u);
		u = next;
	}
}

/* The zero d inside the unit circle of a real v:  d^2 + v d + v = 0,  |1 + d| < 1.
 *
 * The product of the two roots is v, so the root without cancellation gives the other one. */
static double zero_of(double v)
{
	return 2 * v / (-v - copysign(sqrt(v * (v - 4)), v));
}

/* Sum and product of the zeros inside the unit circle of the complex pair v = a + i b, a - i b. */
static struct pair zeros_of(double a, double b)
{
	// s = sqrt(v (v - 4)), the root in the direction of -v, so that s - v does not cancel
	const double x = (a - b) * (a + b) - 4 * a, y = 2 * b * (a - 2), size = sqrt(x * x + y * y);
	double re = sqrt(0.5 * (size + fabs(x))), im = re > 0 ? 0.5 * y / re : 0;
	if (x < 0) {
		const double swap = re;
		re = fabs(im);
		im = copysign(swap, y);
	}
	const double side = -a * re - b * im < 0 ? -1 : 1;
	const double p = 0.5 * (side * re - a), q = 0.5 * (side * im - b), r = p * p + q * q;
	return (struct pair){2 * (a * p + b * q) / r, (a * a + b * b) / r};
}

/* Spectral factor: the cubic polynomial in d whose squared modulus on the unit circle is the density and whose zeros lie
 * inside the circle.
 *
 * Valid    a density that is positive for v in (0, 4].  A leading coefficient below 1e-30 of the density at v = 4 is set to
 *          that, which gives a zero at d = -1; a density at v = 0 below 1e-200 of it is set to that, which gives two zeros
 *          at d = 0. */
static void factor_of(const double density[N], double b[N])
{
	double q[N] = {density[0], density[1], density[2], density[3]};
	const double nyquist = q[0] + 4 * (q[1] + 4 * (q[2] + 4 * q[3]));
	q[0] = fmax(q[0], 1e-200 * nyquist);
	if (fabs(q[3]) < 1e-30 * nyquist)
		q[3] = 1e-30 * nyquist;
	const double v = root_of(q);
	// the other two roots: q3 v^2 + e1 v + e0; e1 by the formula with less cancellation
	const double e0 = -q[0] / v;
	const double e1 =
	    fabs(q[2]) + fabs(q[3] * v) < (fabs(e0) + fabs(q[1])) / fabs(v) ? q[2] + q[3] * v : (e0 - q[1]) / v;
	const double half = -0.5 * e1 / q[3], discriminant = half * half - e0 / q[3];
	const double far = half + copysign(sqrt(fmax(discriminant, 0)), half), near = e0 / q[3] / far;
	// by rounding errors, two nearly equal roots may fall into (0, 4), where the density is positive
	const struct pair zeros = discriminant < 0 || (far > 0 && far < 4)
	                              ? zeros_of(half, sqrt(fmax(-discriminant, 0)))
	                              : (struct pair){zero_of(far) + zero_of(near), zero_of(far) * zero_of(near)};
	const double d = zero_of(v);
	// at v = 4, d = -2
	const double gain = sqrt(nyquist) / ((2 + d) * (4 + 2 * zeros.sum + zeros.product));
	b[3] = gain;
	b[2] = -gain * (zeros.sum + d);
	b[1] = gain * (zeros.product + zeros.sum * d);
	b[0] = -gain * zeros.product * d;
}

/* Cholesky factor of a covariance, l l^T = q; a remaining variance below rounding counts as 0. */
static void cholesky(double q[N][N], double l[N][N])
{
	for (int j = 0; j < N; j++) {
		double left = q[j][j];
		for (int k = 0; k < j; k++)
			left -= l[j][k] * l[j][k];
		const bool none = !(left > 16 * DBL_EPSILON * q[j][j]);
		l[j][j] = none ? 0 : sqrt(left);
		for (int i = 0; i < N; i++) {
			double sum = q[i][j];
			for (int k = 0; k < j; k++)
				sum -= l[i][k] * l[j][k];
			if (i != j)
				l[i][j] = i < j || none ? 0 : sum / l[j][j];
		}
	}
}

/* Cholesky factor of the stationary covariance of the state: the sum of F^k b b^T F^kT, with the F = 1 + D of struct
 * pound_filter; each round doubles the number of terms, until no variance grows. */
static void stationary(const double a[N], const double b[N], double l[N][N])
{
	double d[N][N], p[N][N];
	for (int i = 0; i < N; i++)
		for (int j = 0; j < N; j++) {
			d[i][j] = j == 0 ? -a[N - 1 - i] : 0;
			p[i][j] = b[N - 1 - i] * b[N - 1 - j];
		}
	for (int i = 0; i < N - 1; i++)
		d[i][i + 1] += 1;
	while (doubled(d, p)) {
	}
	cholesky(p, l);
}

/* The recurrence of a Kanai-Tajimi filter with its high pass.
 *
 * Given    theta               -    2 pi filter frequency * sample step, > 0
 *          damping_ratio       -    of the filter, > 0
 *          high_pass_ratio     -    corner frequency of the high pass over the filter frequency, > 0
 * Returns  f                        for white noise of intensity 1 per sample step: two-sided density 1 / 2 pi
 *
 *   H(s) = (alpha s + beta) / (s^2 + alpha s + beta) * s^2 / (s^2 + gamma s + delta)
 *
 * Valid    ratios outside [1e-9, 1e9] and theta outside [1e-20, 1e6] are set to the nearest limit, so that no power of
 *          them overflows; a step of many periods gives nearly independent samples.  Error of the autocovariance:
 *          1e-14 of the variance, divided by the high pass ratio
 * Source   model.md 4: absolute acceleration of the filter's mass, then the high pass
 * Test     unit_kanai_tajimi */
void pound_filter_init(struct pound_filter *f, double theta, double damping_ratio, double high_pass_ratio)
{
	const struct filter k = filter_of(theta, damping_ratio, high_pass_ratio);
	// the roots of a quadratic are at most the larger of its natural frequency and its damping coefficient
	const double bound[4] = {sqrt(k.beta), k.alpha, sqrt(k.delta), k.gamma};
	double largest = 0;
	for (int i = 0; i < 4; i++)
		largest = bound[i] > largest ? bound[i] : largest;
	int doublings = 0;
	double h = 1, d[N][N], q[N][N];
	for (; h * largest > 1; h *= 0.5)
		doublings++;
	for (int j = 0; j < N; j++) {
		double column[N] = {0};
		column[j] = 1;
		propagate(k.c, h, column);
		for (int i = 0; i < N; i++)
			d[i][j] = column[i];
	}
	covariance(k.c, h, q);
	for (int i = 0; i < doublings; i++)
		doubled(d, q);
	denominator_of(poles_of(k.alpha, k.beta, h, doublings), poles_of(k.gamma, k.delta, h, doublings),
	               f->pole);
	double numerator[N][N], density[N];
	numerator_of(d, f->pole, (const double[N]){k.alpha, k.beta, 0, 0}, numerator);
	density_of(numerator, q, density);
	factor_of(density, f->zero);
	stationary(f->pole, f->zero, f->start);
}
