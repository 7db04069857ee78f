/* Properties of an excitation's samples that do not depend on the noise; unit_normals and unit_kanai_tajimi test the noise. */
#include <float.h>
#include <math.h>
#include <string.h>

#include "engine/ground/excitation.h"
#include "engine/ground/noise.h"
#include "engine/numeric/cpu_width.h"
#include "tests/support/check.h"

/* types with generated samples; samples of a suite are records */
enum { KANAI_TAJIMI, WHITE_NOISE, HARMONIC, RECORD, TYPES, MANY = 200000 };

static const struct pound_stream noise = {
    .seed = 42, .what = POUND_STREAM_NOISE, .row = 1, .sample = 2, .signal = 3};

static double a[MANY], b[MANY];

static struct pound_excitation excitation(int type)
{
	static const double samples[] = {0, 1.5, -2, 0.25, 1e-300};
	return (struct pound_excitation){.type = type,
	                                 .frequency_hz = 2,
	                                 .damping_ratio = 0.6,
	                                 .high_pass_ratio = 0.1,
	                                 .cycles = 20,
	                                 .duration = 10,
	                                 .rise = 0.15,
	                                 .fall = 0.25,
	                                 .time_step = 0.01,
	                                 .peak = 1,
	                                 .signals = 1,
	                                 .factor = 1,
	                                 .n_record = 5,
	                                 .record = samples};
}

static void fill(const struct pound_excitation *e, struct pound_stream stream, double *x)
{
	pound_signals_fill(&(struct pound_signal){e, stream, x}, 1);
}

static double largest(const double *x, int n)
{
	double most = 0;
	for (int i = 0; i < n; i++)
		most = fmax(most, fabs(x[i]));
	return most;
}

static void the_table_has_the_excitations_of_a_study(void **state)
{
	(void)state;
	static const char *const names[TYPES + 1] = {"kanai_tajimi", "white_noise", "harmonic", "record",
	                                             "suite"};
	for (int i = 0; i <= TYPES; i++)
		assert_string_equal(pound_excitation_name(i), names[i]);
	assert_null(pound_excitation_name(TYPES + 1));
	assert_null(pound_excitation_name(-1));
}

static void noise_without_colour_and_records_have_no_frequency(void **state)
{
	(void)state;
	static const double frequency[TYPES] = {2, 0, 2, 0};
	for (int type = 0; type < TYPES; type++) {
		const struct pound_excitation e = excitation(type);
		assert_true(pound_excitation_frequency(&e) == frequency[type]);
	}
}

static void only_noise_differs_from_signal_to_signal(void **state)
{
	(void)state;
	for (int type = 0; type < TYPES; type++) {
		const struct pound_excitation e = excitation(type);
		assert_int_equal(pound_excitation_random(&e), type == KANAI_TAJIMI || type == WHITE_NOISE);
	}
}

static void the_last_sample_is_the_one_nearest_to_the_end(void **state)
{
	(void)state;
	static const struct {
		double duration, step;
		int n;
	} cases[] = {{10, 0.01, 1001}, {0.3, 0.1, 4}, {1, 0.3, 4},  {1, 0.4, 4},          {1, 0.41, 3},
	             {1e-9, 1, 2},     {1.49, 1, 2},  {1.51, 1, 3}, {4e4, 0.01, 4000001}, {1e-300, 1e-301, 11}};
	for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
		struct pound_excitation e = excitation(HARMONIC);
		e.duration = cases[i].duration;
		e.time_step = cases[i].step;
		assert_int_equal(pound_excitation_samples(&e), cases[i].n);
		e.type = WHITE_NOISE;
		assert_int_equal(pound_excitation_samples(&e), cases[i].n);
		e.type = KANAI_TAJIMI;
		e.cycles = 1;
		e.frequency_hz = 1 / e.duration;
		assert_int_equal(pound_excitation_samples(&e), cases[i].n);
	}
	const struct pound_excitation e = excitation(RECORD);
	assert_int_equal(pound_excitation_samples(&e), 5);
}

/* exactly, and without overflow or underflow: the shape is computed for a peak of 1 */
static void noise_has_exactly_the_peak_asked(void **state)
{
	(void)state;
	static const double peaks[] = {1, 0.1, 3.3, 9.81, 1e-300, 1e300, DBL_MAX};
	for (int type = KANAI_TAJIMI; type <= WHITE_NOISE; type++)
		for (size_t i = 0; i < sizeof peaks / sizeof peaks[0]; i++) {
			struct pound_excitation e = excitation(type);
			const int n = pound_excitation_samples(&e);
			fill(&e, noise, a);
			e.peak = peaks[i];
			fill(&e, noise, b);
			assert_true(largest(b, n) == peaks[i]);
			for (int k = 0; k < n; k++)
				check_near(b[k] / peaks[i], a[k], 0x1p-52);
		}
}

/* Relative to the signal without rise and fall; one sample gives the factor of the peak. */
static void noise_rises_and_falls_along_a_trapezoid(void **state)
{
	(void)state;
	static const double shapes[][2] = {{0.15, 0.25}, {0, 0.25}, {0.5, 0.5},   {1, 0},
	                                   {0, 1},       {0, 0},    {0.001, 1e-9}};
	for (int type = KANAI_TAJIMI; type <= WHITE_NOISE; type++)
		for (size_t i = 0; i < sizeof shapes / sizeof shapes[0]; i++) {
			struct pound_excitation e = excitation(type);
			const int n = pound_excitation_samples(&e), at = n / 2;
			e.rise = e.fall = 0;
			fill(&e, noise, a);
			e.rise = shapes[i][0], e.fall = shapes[i][1];
			fill(&e, noise, b);
			double trapezoid[2000];
			for (int k = 0; k < n; k++) {
				const double t = (double)k / (n - 1), up = e.rise > 0 ? t / e.rise : 1;
				trapezoid[k] = fmin(1, fmin(up, e.fall > 0 ? (1 - t) / e.fall : 1));
			}
			const double gain = b[at] / (a[at] * trapezoid[at]);
			for (int k = 0; k < n; k++)
				check_near(b[k], gain * trapezoid[k] * a[k], 16 * 0x1p-52);
		}
}

static void kanai_tajimi_noise_is_the_filter_output_scaled(void **state)
{
	(void)state;
	struct pound_excitation e = excitation(KANAI_TAJIMI);
	e.rise = e.fall = 0;
	const int n = pound_excitation_samples(&e);
	struct pound_filter f;
	pound_filter_init(&f, 2 * M_PI * e.frequency_hz * e.time_step, e.damping_ratio, e.high_pass_ratio);
	pound_noise_fill(pound_dispatch_width(0),
	                 &(struct pound_noise){.filter = &f, .stream = noise, .n = n, .a = b}, 1);
	fill(&e, noise, a);
	const double most = largest(b, n);
	for (int k = 0; k < n; k++)
		check_near(a[k], b[k] / most, 0x1p-52);
}

/* n samples of variance v: the mean of a_k a_k+lag has the standard error v/sqrt n, and the mean of a_k^2 sqrt 2 times that */
static void white_noise_has_no_memory(void **state)
{
	(void)state;
	struct pound_excitation e = excitation(WHITE_NOISE);
	e.rise = e.fall = 0;
	e.duration = 1000;
	const int n = pound_excitation_samples(&e);
	fill(&e, noise, a);
	double sum = 0, variance = 0, fourth = 0;
	for (int k = 0; k < n; k++) {
		sum += a[k] / n;
		variance += a[k] * a[k] / n;
	}
	for (int k = 0; k < n; k++)
		fourth += pow(a[k], 4) / (variance * variance) / n;
	check_near(sum, 0, 5 * sqrt(variance / n));
	check_near(fourth, 3, 5 * sqrt(24.0 / n)); /* kurtosis: variance 24 / n */
	for (int lag = 1; lag < 300; lag++) {
		double product = 0;
		for (int k = 0; k + lag < n; k++)
			product += a[k] * a[k + lag] / (variance * n);
		check_near(product, 0, 5 / sqrt(n));
	}
}

static void a_harmonic_is_a_sine_from_zero(void **state)
{
	(void)state;
	struct pound_excitation e = excitation(HARMONIC);
	e.peak = 2.5;
	const int n = pound_excitation_samples(&e);
	fill(&e, noise, a);
	assert_true(a[0] == 0);
	// the phase, up to 20 periods, has an error of 3 roundings
	for (int k = 0; k < n; k++)
		check_near(a[k], 2.5 * sin(2 * M_PI * 2 * 0.01 * k), 2.5 * 2 * M_PI * 20 * 4 * 0x1p-53);
	// the peak is the sine's even if no sample is at the peak
	e.time_step = 0.4;
	e.duration = 0.8;
	fill(&e, noise, a);
	check_near(a[1], 2.5 * sin(2 * M_PI * 0.8), 1e-15 * 2 * M_PI);
}

static void a_record_is_copied(void **state)
{
	(void)state;
	const struct pound_excitation e = excitation(RECORD);
	fill(&e, noise, a);
	assert_memory_equal(a, e.record, 5 * sizeof(double));
}

/* both samples of a signal of one step are at the ends of the trapezoid; without rise and fall they are not zero */
static void a_signal_of_one_step_is_finite(void **state)
{
	(void)state;
	for (int type = KANAI_TAJIMI; type <= WHITE_NOISE; type++) {
		struct pound_excitation e = excitation(type);
		e.cycles = e.duration = 1e-6;
		assert_int_equal(pound_excitation_samples(&e), 2);
		fill(&e, noise, a);
		assert_true(a[0] == 0 && a[1] == 0);
		e.rise = e.fall = 0;
		fill(&e, noise, a);
		assert_true(largest(a, 2) == 1 && isfinite(a[0]) && isfinite(a[1]));
		e.rise = 1;
		fill(&e, noise, a);
		assert_true(a[0] == 0 && fabs(a[1]) == 1);
	}
}

/* for any positive numbers in a study, including numbers whose powers overflow */
static void extreme_filters_give_finite_noise(void **state)
{
	(void)state;
	static const double turns[] = {1e-300, 1e-9, 0.005, 1, 1e6, 1e300},
	                    ratios[] = {1e-300, 1e-6, 0.6, 1, 1e3, 1e300};
	enum { TURNS = sizeof turns / sizeof turns[0], RATIOS = sizeof ratios / sizeof ratios[0] };
	for (int i = 0; i < TURNS * RATIOS * RATIOS; i++) {
		struct pound_excitation e = excitation(KANAI_TAJIMI);
		e.time_step = turns[i / (RATIOS * RATIOS)];
		e.frequency_hz = 1;
		e.cycles = 100.2 * e.time_step;
		e.damping_ratio = ratios[i / RATIOS % RATIOS];
		e.high_pass_ratio = ratios[i % RATIOS];
		const int n = pound_excitation_samples(&e);
		assert_int_equal(n, 101);
		fill(&e, noise, a);
		for (int k = 0; k < n; k++)
			assert_true(fabs(a[k]) <= 1);
		assert_true(largest(a, n) == 1);
	}
}

/* The hash is from gcc -O2; every other compiler, optimization, processor and thread must give the same. */
static void the_bits_are_the_same_everywhere(void **state)
{
	(void)state;
	uint64_t hash = 0xcbf29ce484222325;
	for (int type = 0; type < TYPES; type++)
		for (int k = 0; k < 12; k++) {
			struct pound_excitation e = excitation(type);
			struct pound_stream s = noise;
			e.frequency_hz = 0.5 + 0.4 * k;
			s.row = (uint32_t)k * 1000;
			const int n = pound_excitation_samples(&e);
			fill(&e, s, a);
			for (int i = 0; i < n; i++) {
				uint64_t bits;
				memcpy(&bits, &a[i], sizeof bits);
				hash = (hash ^ bits) * 0x100000001b3;
			}
		}
	assert_int_equal(hash, 0x49798a6db6651703);
}

/* Below 90 % of the Nyquist frequency, away from the ends, where the sine begins and ends abruptly. */
static void a_sine_is_interpolated_as_a_sine(void **state)
{
	(void)state;
	enum { N = 400 };
	double sine[N], twice[2 * N - 1];
	for (double cycles = 0; cycles <= 0.45; cycles += 0.01) { // cycles per sample
		for (int i = 0; i < N; i++)
			sine[i] = cos(2 * 3.14159265358979323846 * cycles * i + 0.3);
		pound_interpolation_twice(N, sine, twice);
		for (int i = 0; i < 2 * N - 1; i += 2)
			check_near(twice[i], sine[i / 2], 0);
		for (int i = 81; i < 2 * N - 81; i += 2)
			check_near(twice[i], cos(2 * 3.14159265358979323846 * cycles * 0.5 * i + 0.3), 2e-5);
	}
}

CHECK_MAIN(cmocka_unit_test(a_sine_is_interpolated_as_a_sine),
           cmocka_unit_test(the_table_has_the_excitations_of_a_study),
           cmocka_unit_test(noise_without_colour_and_records_have_no_frequency),
           cmocka_unit_test(only_noise_differs_from_signal_to_signal),
           cmocka_unit_test(the_last_sample_is_the_one_nearest_to_the_end),
           cmocka_unit_test(noise_has_exactly_the_peak_asked),
           cmocka_unit_test(noise_rises_and_falls_along_a_trapezoid),
           cmocka_unit_test(kanai_tajimi_noise_is_the_filter_output_scaled),
           cmocka_unit_test(white_noise_has_no_memory), cmocka_unit_test(a_harmonic_is_a_sine_from_zero),
           cmocka_unit_test(a_record_is_copied), cmocka_unit_test(a_signal_of_one_step_is_finite),
           cmocka_unit_test(extreme_filters_give_finite_noise),
           cmocka_unit_test(the_bits_are_the_same_everywhere))
