/* White noise through the Kanai-Tajimi filter and the second-order high pass of Clough and Penzien: its matrices, which
 * filtered_noise.inl runs.
 *
 *   1. p'''' + c3 p''' + c2 p'' + c1 p' + c0 p = w   and   a = alpha p''' + beta p''
 *   2. from sample to sample: the transition matrix, and the covariance of what the noise adds meanwhile
 *   3. the first sample from the stationary covariance
 *
 * Time is counted in sample steps and the state is (p''', p'', p', p), so the matrices keep one shape for any
 * step: small steps cost no digits.
 * Kanai 1957, Bull. Earthq. Res. Inst. 35, 309-325; Tajimi 1960, Proc. 2nd WCEE, 781-798;
 * Clough, Penzien 1975, Dynamics of structures, McGraw-Hill. */
#include "engine/ground/kanai_tajimi.h"

#include <math.h>
#include <stdbool.h>

enum { N = FILTER_STATES, NODES = 8 };

static const double HIGH_PASS_DAMPING = 0.6;

/* p'''' + c[3] p''' + c[2] p'' + c[1] p' + c[0] p = (s^2 + alpha s + beta) (s^2 + gamma s + delta) p */
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
	theta = within(theta, 1e-30, 1e6);
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

/* exp(A s) x, by its power series:  A (x0, x1, x2, x3) = (-c3 x0 - c2 x1 - c1 x2 - c0 x3, x0, x1, x2)
 *
 * Valid    s times the largest pole <= 1: the series ends where a term changes no component */
static void propagate(const double c[N], double s, double x[N])
{
	double t0 = x[0], t1 = x[1], t2 = x[2], t3 = x[3];
	double x0 = t0, x1 = t1, x2 = t2, x3 = t3;
	// the first N - 1 terms are zero in components the chain has not reached
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

/* Covariance of what white noise of intensity 1 adds to the state within h.
 *
 *   Q = integral of v v^T from 0 to h,   v(s) = exp(A s) (1, 0, 0, 0)^T
 *
 * by Gauss-Legendre: the sum of v v^T with positive weights loses no digits, and for h = 1 and slow poles v
 * is nearly (1, s, s^2/2, s^3/6), so Q is a Hilbert matrix with scaled rows, whose pivots come out to 1e-12.
 *
 * Valid    h times the largest pole <= 1: the error is below the rounding
 * Test     unit_kanai_tajimi: a_step_is_that_of_the_continuous_filter */
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
		for (int i = 0; i < N; i++)
			for (int j = 0; j < N; j++)
				q[i][j] += weight[k < NODES / 2 ? k : NODES - 1 - k] * h * v[i] * v[j];
	}
}

/* a b^T if transposed, else a b; out is neither of them */
static void product(double a[N][N], double b[N][N], bool transposed, double out[N][N])
{
	for (int i = 0; i < N; i++)
		for (int j = 0; j < N; j++) {
			double sum = 0;
			for (int k = 0; k < N; k++)
				sum += a[i][k] * (transposed ? b[j][k] : b[k][j]);
			out[i][j] = sum;
		}
}

/* transition and covariance over twice the time:  Q + F Q F^T  and  F F */
static void doubled(double f[N][N], double q[N][N])
{
	double fq[N][N], grown[N][N], ff[N][N];
	product(f, q, false, fq);
	product(fq, f, true, grown);
	product(f, f, false, ff);
	for (int i = 0; i < N; i++)
		for (int j = 0; j < N; j++) {
			q[i][j] += grown[i][j];
			f[i][j] = ff[i][j];
		}
}

/* l l^T = q, l lower triangular */
static void cholesky(double q[N][N], double l[N][N])
{
	for (int i = 0; i < N; i++)
		for (int j = 0; j < N; j++) {
			double sum = q[i][j];
			for (int k = 0; k < j && j <= i; k++)
				sum -= l[i][k] * l[j][k];
			l[i][j] = j > i ? 0 : j < i ? sum / l[j][j] : sqrt(sum);
		}
}

/* Cholesky factor of the stationary covariance, from the moments m_k = variance of the k-th derivative of p.
 *
 *   covariance of p^(i), p^(j) = (-1)^((i - j)/2) m_(i+j)/2 for even i + j, else 0
 *   D = 2 alpha gamma ((beta - delta)^2 + (alpha + gamma) (alpha delta + beta gamma))
 *   m1 = c3 / D     m2 = c1 / D     m3 = (c1 c2 - c0 c3) / D
 *   m1 m3 - m2^2 = 1 / 2 D     m0 m2 - m1^2 = 1 / 2 c0 D
 *
 * for white noise of intensity 1.  D / 2 is the Hurwitz determinant c1 c2 c3 - c1^2 - c0 c3^2; written in the
 * coefficients of the two factors nothing cancels.
 *
 * Source   the four equations E[p^(k) (p'''' + c3 p''' + ... - w)] = 0, k = 0 .. 3
 * Test     unit_kanai_tajimi: the_stationary_covariance_stays */
static void stationary(const struct filter *k, double l[N][N])
{
	const double al = k->alpha, be = k->beta, ga = k->gamma, de = k->delta;
	const double d = 2 * al * ga * ((be - de) * (be - de) + (al + ga) * (al * de + be * ga));
	const double m1 = k->c[3] / d, m2 = k->c[1] / d;
	const double m3 = (al * de * (de + al * ga) + be * ga * (be + al * ga)) / d;
	for (int i = 0; i < N; i++)
		for (int j = 0; j < N; j++)
			l[i][j] = 0;
	l[0][0] = sqrt(m3);
	l[2][0] = -m2 / l[0][0];
	l[2][2] = sqrt(0.5 / (d * m3));
	l[1][1] = sqrt(m2);
	l[3][1] = -m1 / l[1][1];
	l[3][3] = sqrt(0.5 / (k->c[0] * k->c[1]));
}

/* The recurrence of a Kanai-Tajimi filter with its high pass.
 *
 * Given    theta               -    2 pi filter frequency * sample step, > 0
 *          damping_ratio       -    of the filter, > 0
 *          high_pass_ratio     -    corner of the high pass over the filter frequency, > 0
 * Returns  f                        for white noise of intensity 1 per sample step: two-sided density 1 / 2 pi
 *
 *   H(s) = (alpha s + beta) / (s^2 + alpha s + beta) * s^2 / (s^2 + gamma s + delta)
 *
 * Valid    ratios beyond 1e-9 and 1e9 and steps beyond 1e-30 and 1e6 are taken as these, so that no power of them
 *          overflows; a step of many periods gives nearly independent samples
 * Source   model.md 4: absolute acceleration of the filter's mass, then the high pass
 * Test     unit_kanai_tajimi */
void pound_filter_init(struct pound_filter *f, double theta, double damping_ratio, double high_pass_ratio)
{
	const struct filter k = filter_of(theta, damping_ratio, high_pass_ratio);
	// a quadratic's roots are no larger than the larger of its natural frequency and its damping coefficient
	const double bound[4] = {sqrt(k.beta), k.alpha, sqrt(k.delta), k.gamma};
	double largest = 0;
	for (int i = 0; i < 4; i++)
		largest = bound[i] > largest ? bound[i] : largest;
	int doublings = 0;
	double h = 1, q[N][N];
	for (; h * largest > 1; h *= 0.5)
		doublings++;
	for (int j = 0; j < N; j++) {
		double column[N] = {0};
		column[j] = 1;
		propagate(k.c, h, column);
		for (int i = 0; i < N; i++)
			f->transition[i][j] = column[i];
	}
	covariance(k.c, h, q);
	for (int i = 0; i < doublings; i++)
		doubled(f->transition, q);
	cholesky(q, f->step);
	stationary(&k, f->start);
	f->output[0] = k.alpha;
	f->output[1] = k.beta;
}
