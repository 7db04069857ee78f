/* The filter against three oracles that share no formula with it:
 *
 *   1. the exponentials of the poles of the continuous filter in 80-bit arithmetic
 *   2. the autocovariance of the continuous process by residues at the poles of its transfer function
 *   3. the transfer function, against the Welch estimate from generated signals
 *
 * Limits of random quantities are 5 standard errors of a normal estimate: exceeded once in 1.7 million. */
#include <complex.h>
#include <math.h>
#include <string.h>

#include "engine/ground/noise.h"
#include "engine/numeric/cpu_width.h"
#include "tests/support/check.h"

enum { N = FILTER_STATES };

static const struct {
	double theta, xi, ratio;
} cases[] = {
    {0.1257, 0.6, 0.1}, {0.0314, 0.6, 0.1}, {1e-3, 0.6, 0.1},    {1e-6, 0.6, 0.1},
    {0.9, 0.6, 0.1},    {4, 0.6, 0.1},      {0.1257, 0.05, 1},   {0.1257, 1.5, 0.1},
    {0.1257, 1, 1},     {0.05, 0.6, 20},    {0.1257, 0.6, 1e-3}, {30, 0.2, 0.5},
};
enum { CASES = sizeof cases / sizeof cases[0] };

static struct pound_filter filter_of(int i)
{
	struct pound_filter f;
	pound_filter_init(&f, cases[i].theta, cases[i].xi, cases[i].ratio);
	return f;
}

static void filter_run(const struct pound_filter *f, struct pound_stream noise, int n, double *a)
{
	pound_noise_fill(pound_dispatch_width(0),
	                 &(struct pound_noise){.filter = f, .stream = noise, .n = n, .a = a}, 1);
}

/* the four poles of the continuous filter */
static void poles_of(int i, long double complex pole[N])
{
	const long double t = cases[i].theta, xi[2] = {cases[i].xi, 0.6}, w[2] = {t, t * cases[i].ratio};
	for (int q = 0; q < 2; q++)
		for (int sign = 0; sign < 2; sign++)
			pole[2 * q + sign] = w[q] * (-xi[q] + (1 - 2 * sign) * csqrtl(xi[q] * xi[q] - 1));
}

/* F y, the transition matrix of the recurrence */
static void transition(const struct pound_filter *f, const double y[N], double to[N])
{
	for (int j = 0; j < N; j++)
		to[j] = y[j] + (j < N - 1 ? y[j + 1] : 0) - f->pole[N - 1 - j] * y[0];
}

/* The polynomial is zero at exp(p) - 1 for each pole p of the continuous filter: to the rounding error of its terms
 * there and of expm1 in 80 bits, a sum of 40 such errors. */
static void the_poles_of_a_step_are_those_of_the_continuous_filter(void **state)
{
	(void)state;
	for (int i = 0; i < CASES; i++) {
		const struct pound_filter f = filter_of(i);
		long double complex pole[N];
		poles_of(i, pole);
		for (int k = 0; k < N; k++) {
			long double complex d = 0, term = 1;
			if (cabsl(pole[k]) < 0.5L)
				for (int n = 1; n < 40; n++)
					d += term *= pole[k] / n;
			else
				d = cexpl(pole[k]) - 1;
			long double complex value = d * d * d * d, power = 1;
			long double size = cabsl(value);
			for (int j = 0; j < N; j++, power *= d) {
				value += f.pole[j] * power;
				size += fabs(f.pole[j]) * cabsl(power);
			}
			check_near((double)(cabsl(value) / size), 0, 16 * 0x1p-52);
		}
	}
}

/* P = F P F^T + b b^T, each entry to the rounding error of a sum of its size */
static void the_stationary_covariance_stays(void **state)
{
	(void)state;
	for (int i = 0; i < CASES; i++) {
		const struct pound_filter f = filter_of(i);
		double p[N][N] = {0}, half[N][N], next[N][N];
		for (int j = 0; j < N; j++)
			for (int k = 0; k < N; k++)
				for (int m = 0; m < N; m++)
					p[j][k] += f.start[j][m] * f.start[k][m];
		for (int j = 0; j < N; j++)
			transition(&f, p[j], half[j]);
		for (int k = 0; k < N; k++) {
			const double column[N] = {half[0][k], half[1][k], half[2][k], half[3][k]};
			transition(&f, column, next[k]);
		}
		for (int j = 0; j < N; j++)
			for (int k = 0; k < N; k++)
				check_near(next[k][j] + f.zero[N - 1 - j] * f.zero[N - 1 - k], p[j][k],
				           0x1p-44 * sqrt(p[j][j] * p[k][k]));
	}
}

/* Autocovariance of the continuous process at time tau, by residues at the poles p of the left half plane:
 *
 *   R(tau) = sum of B(p) B(-p) / (D'(p) D(-p)) exp(p tau),   D(s) = product of (s - p),   B(s) = s^2 (alpha s + beta)
 *
 * Needs four different poles. */
static long double autocovariance(int i, long double tau)
{
	const long double t = cases[i].theta, damping = cases[i].xi;
	long double complex pole[N], sum = 0;
	poles_of(i, pole);
	for (int q = 0; q < N; q++) {
		const long double complex p = pole[q];
		long double complex term =
		    p * p * p * p * (2 * damping * t * p + t * t) * (t * t - 2 * damping * t * p);
		for (int m = 0; m < N; m++)
			term /= (m == q ? 1 : p - pole[m]) * (-p - pole[m]);
		sum += term * cexpl(p * tau);
	}
	return creall(sum);
}

/* the first entry of F^k P */
static double covariance_at_lag(const struct pound_filter *f, int lag)
{
	double x[N] = {0}, y[N];
	for (int j = 0; j < N; j++)
		x[j] = f->start[j][0] * f->start[0][0];
	for (; lag > 0; lag--) {
		transition(f, x, y);
		memcpy(x, y, sizeof x);
	}
	return x[0];
}

/* At every lag the samples have the covariance of the continuous process, whatever the step: the exact discretization
 * has no step error.  Rounding: 2^-52 of the variance for each step and state, and the rounding of the coefficients,
 * which moves the poles of the high pass by the inverse ratio more. */
static void samples_have_the_autocovariance_of_the_continuous_process(void **state)
{
	(void)state;
	static const int lags[] = {0, 1, 2, 5, 10, 50, 200, 1000};
	for (int i = 0; i < CASES; i++) {
		if (cases[i].ratio == 1 || cases[i].xi == 1)
			continue; /* equal poles */
		const struct pound_filter f = filter_of(i);
		const double variance = (double)autocovariance(i, 0);
		for (size_t j = 0; j < sizeof lags / sizeof lags[0]; j++)
			check_near(covariance_at_lag(&f, lags[j]), (double)autocovariance(i, lags[j]),
			           (128 / fmin(1, cases[i].ratio) + N * lags[j]) * 0x1p-52 * variance);
	}
}

/* 2.0333333 pi S0 w_e for the Kanai-Tajimi filter without high pass (a corner at 0 changes nothing); unit intensity
 * per step is S0 = 1 / 2 pi.  A corner at ratio r reduces the variance by a fraction of order r. */
static void the_kanai_tajimi_variance_is_the_known_one(void **state)
{
	(void)state;
	struct pound_filter f;
	for (double theta = 1e-4; theta < 2; theta *= 7) {
		pound_filter_init(&f, theta, 0.6, 1e-7);
		check_near(covariance_at_lag(&f, 0) / theta, 2.44 / 1.2 / 2, 1e-6);
	}
}

/* alpha^2 m3 + beta^2 m2, the closed form of the variance:
 *
 *   m2 = c1 / D     m3 = (alpha delta (delta + alpha gamma) + beta gamma (beta + alpha gamma)) / D
 *   D = 2 alpha gamma ((beta - delta)^2 + (alpha + gamma) (alpha delta + beta gamma))
 *
 * The poles of the high pass are slower than the others by the ratio: the rounding of the polynomial's coefficients
 * moves them more by the inverse of the ratio. */
static void the_variance_is_right_at_extreme_steps_and_ratios(void **state)
{
	(void)state;
	static const double ratios[] = {1, 1e-2, 1e-4, 1e-6, 1e-8};
	for (size_t i = 0; i < sizeof ratios / sizeof ratios[0]; i++)
		for (double theta = 1e-7; theta < 2e3; theta *= 10) {
			const double al = 1.2 * theta, be = theta * theta, corner = ratios[i] * theta;
			const double ga = 1.2 * corner, de = corner * corner, c1 = al * de + be * ga;
			const double d = 2 * al * ga * ((be - de) * (be - de) + (al + ga) * c1);
			const double m3 = (al * de * (de + al * ga) + be * ga * (be + al * ga)) / d;
			struct pound_filter f;
			pound_filter_init(&f, theta, 0.6, ratios[i]);
			check_near(covariance_at_lag(&f, 0) / (al * al * m3 + be * be * c1 / d), 1,
			           128 * 0x1p-52 / ratios[i]);
		}
}

static double density(int i, double omega)
{
	const double complex s = I * omega;
	const double t = cases[i].theta, x = 2 * cases[i].xi * t, r = t * cases[i].ratio;
	const double h =
	    cabs((x * s + t * t) / (s * s + x * s + t * t) * s * s / (s * s + 2 * 0.6 * r * s + r * r));
	return h * h;
}

enum { SIGNALS = 3000, LENGTH = 512 };

static struct pound_stream stream_of(int row)
{
	return (struct pound_stream){.seed = 5, .what = POUND_STREAM_NOISE, .row = (uint32_t)row};
}

/* Welch's estimate: the mean over independent signals of |sum of window * a * exp(-i omega k)|^2 / sum of window^2,
 * with a Hann window.  Its expectation is the sum over lags of R times the autocorrelation of the window; the mean of
 * n estimates, each exponentially distributed, has the relative standard error 1/sqrt n.  So it may differ from |H|^2
 * by 5 standard errors and by the effect of window and sampling on the spectrum, which is computed and must itself be
 * below 3 % here. */
static void the_spectrum_is_the_analytic_one(void **state)
{
	(void)state;
	enum { FREQUENCIES = 22 };
	static double table[FREQUENCIES][LENGTH][2], a[LENGTH], power[FREQUENCIES], window[LENGTH];
	double omega[FREQUENCIES], energy = 0;
	const struct pound_filter f = filter_of(0);
	for (int k = 0; k < LENGTH; k++) {
		window[k] = 0.5 - 0.5 * cos(2 * M_PI * (k + 0.5) / LENGTH);
		energy += window[k] * window[k];
	}
	for (int j = 0; j < FREQUENCIES; j++) {
		omega[j] = cases[0].theta * 0.35 * pow(10, j / 20.0); /* 0.35 to 4 times the filter frequency */
		power[j] = 0;
		for (int k = 0; k < LENGTH; k++) {
			table[j][k][0] = window[k] * cos(omega[j] * k);
			table[j][k][1] = window[k] * sin(omega[j] * k);
		}
	}
	for (int row = 0; row < SIGNALS; row++) {
		filter_run(&f, stream_of(row), LENGTH, a);
		for (int j = 0; j < FREQUENCIES; j++) {
			double re = 0, im = 0;
			for (int k = 0; k < LENGTH; k++) {
				re += table[j][k][0] * a[k];
				im += table[j][k][1] * a[k];
			}
			power[j] += (re * re + im * im) / energy / SIGNALS;
		}
	}
	double expected[FREQUENCIES] = {0};
	for (int lag = 0; lag < LENGTH; lag++) {
		double overlap = 0;
		for (int k = 0; k + lag < LENGTH; k++)
			overlap += window[k] * window[k + lag];
		const double r = (double)autocovariance(0, lag) * overlap / energy;
		for (int j = 0; j < FREQUENCIES; j++)
			expected[j] += (lag == 0 ? 1 : 2) * r * cos(omega[j] * lag);
	}
	for (int j = 0; j < FREQUENCIES; j++) {
		const double h2 = density(0, omega[j]);
		const double smeared = fabs(expected[j] - h2);
		check_near(expected[j] / h2, 1, 0.03);
		check_near(power[j], h2, 5 / sqrt(SIGNALS) * expected[j] + smeared);
	}
}

/* Variance of the estimate (1/n) sum a_k a_k+lag of a normal process: (1/n) sum over j of R_j^2 + R_j+lag R_j-lag
 * (Bartlett); of a long signal, and of the start and the end of many signals. */
static void the_variance_and_autocovariance_are_the_analytic_ones(void **state)
{
	(void)state;
	enum { LONG = 400000, REACH = 3000 };
	static double a[LONG], r[2 * REACH];
	static const int lags[] = {0, 1, 3, 10, 30, 100};
	const struct pound_filter f = filter_of(0);
	filter_run(&f, stream_of(0), LONG, a);
	for (int j = 0; j < 2 * REACH; j++)
		r[j] = (double)autocovariance(0, j);
	for (size_t i = 0; i < sizeof lags / sizeof lags[0]; i++) {
		const int lag = lags[i];
		double sum = 0, spread = 0;
		for (int k = 0; k + lag < LONG; k++)
			sum += a[k] * a[k + lag];
		for (int j = -REACH; j <= REACH; j++)
			spread += r[abs(j)] * r[abs(j)] + r[abs(j + lag)] * r[abs(j - lag)];
		check_near(sum / (LONG - lag), r[lag], 5 * sqrt(spread / (LONG - lag)));
	}
}

static void a_signal_is_stationary_from_its_first_sample(void **state)
{
	(void)state;
	enum { ROWS = 8000, SHORT = 40 };
	const struct pound_filter f = filter_of(0);
	const double r0 = (double)autocovariance(0, 0), r1 = (double)autocovariance(0, 1);
	double first = 0, last = 0, neighbours = 0;
	for (int row = 0; row < ROWS; row++) {
		double a[SHORT];
		filter_run(&f, stream_of(row), SHORT, a);
		first += a[0] * a[0] / ROWS;
		last += a[SHORT - 1] * a[SHORT - 1] / ROWS;
		neighbours += a[0] * a[1] / ROWS;
	}
	check_near(first, r0, 5 * r0 * sqrt(2.0 / ROWS));
	check_near(last, r0, 5 * r0 * sqrt(2.0 / ROWS));
	check_near(neighbours, r1, 5 * sqrt((r0 * r0 + r1 * r1) / ROWS));
}

/* the correlation of n pairs of independent numbers has the standard error 1/sqrt n */
static void signals_of_other_rows_samples_and_indices_are_uncorrelated(void **state)
{
	(void)state;
	enum { PAIRS = 8000, SHORT = 20 };
	const struct pound_filter f = filter_of(0);
	const double variance = (double)autocovariance(0, 0);
	double product[3] = {0};
	for (int row = 0; row < PAIRS; row++) {
		double a[SHORT], b[SHORT];
		filter_run(&f, stream_of(row), SHORT, a);
		for (int other = 0; other < 3; other++) {
			struct pound_stream s = stream_of(row);
			*(uint32_t *[3]){&s.row, &s.sample, &s.signal}[other] += 1;
			filter_run(&f, s, SHORT, b);
			product[other] += a[SHORT - 1] * b[SHORT - 1] / variance;
		}
	}
	for (int other = 0; other < 3; other++)
		check_near(product[other] / PAIRS, 0, 5 / sqrt(PAIRS));
}

/* a shorter signal is the beginning of a longer one, at every length around the chunks in which noise is generated */
static void the_length_of_a_signal_does_not_change_its_samples(void **state)
{
	(void)state;
	const struct pound_filter f = filter_of(0);
	double whole[100], part[101];
	filter_run(&f, stream_of(3), 100, whole);
	for (int n = 1; n <= 100; n++) {
		part[n] = 12345;
		filter_run(&f, stream_of(3), n, part);
		assert_memory_equal(part, whole, (size_t)n * sizeof(double));
		assert_true(part[n] == 12345);
	}
}

/* Signals of other filters and lengths in the other lanes, at any width, in groups that fill the lanes and in groups
 * that do not. */
static void a_signal_has_the_same_bits_whatever_is_beside_it(void **state)
{
	(void)state;
	enum { MOST = 19, LONGEST = 200 };
	static double alone[MOST][LONGEST], together[MOST][LONGEST + 1];
	struct pound_filter filters[CASES];
	for (int i = 0; i < CASES; i++)
		filters[i] = filter_of(i);
	struct pound_noise signals[MOST];
	for (int n = 1; n <= MOST; n++)
		for (int width = pound_dispatch_width(0); width < POUND_WIDTHS; width++) {
			for (int j = 0; j < n; j++) {
				signals[j] = (struct pound_noise){&filters[j % CASES],
				                                  stream_of(j),
				                                  1 + 37 * j * j % LONGEST,
				                                  together[j],
				                                  0.2,
				                                  0.3,
				                                  j % 3};
				together[j][signals[j].n] = 12345;
				struct pound_noise one = signals[j];
				one.a = alone[j];
				pound_noise_fill(POUND_WIDTH_PORTABLE, &one, 1);
			}
			pound_noise_fill(width, signals, n);
			for (int j = 0; j < n; j++) {
				assert_memory_equal(together[j], alone[j], sizeof(double) * (size_t)signals[j].n);
				assert_true(together[j][signals[j].n] == 12345);
			}
		}
}

CHECK_MAIN(cmocka_unit_test(a_signal_has_the_same_bits_whatever_is_beside_it),
           cmocka_unit_test(the_poles_of_a_step_are_those_of_the_continuous_filter),
           cmocka_unit_test(the_stationary_covariance_stays),
           cmocka_unit_test(samples_have_the_autocovariance_of_the_continuous_process),
           cmocka_unit_test(the_kanai_tajimi_variance_is_the_known_one),
           cmocka_unit_test(the_variance_is_right_at_extreme_steps_and_ratios),
           cmocka_unit_test(the_spectrum_is_the_analytic_one),
           cmocka_unit_test(the_variance_and_autocovariance_are_the_analytic_ones),
           cmocka_unit_test(a_signal_is_stationary_from_its_first_sample),
           cmocka_unit_test(signals_of_other_rows_samples_and_indices_are_uncorrelated),
           cmocka_unit_test(the_length_of_a_signal_does_not_change_its_samples))
