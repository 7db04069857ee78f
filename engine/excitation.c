/* The table of excitations.  Noise is shaped by a trapezoid in time and scaled to its peak. */
#include "engine/excitation.h"

#include <assert.h>
#include <limits.h>
#include <math.h>
#include <string.h>

#include "engine/dispatch.h"
#include "engine/elementary.h"
#include "engine/filter.h"
#include "engine/noise.h"

static const double PI = 0x1.921fb54442d18p+1;

/* duration over step to the nearest whole number, at least one, and the sample at time 0 */
static int samples_within(double duration, double step)
{
	const double steps = duration / step;
	assert(steps < INT_MAX - 1);
	return steps < 1.5 ? 2 : (int)(steps + 0.5) + 1;
}

static int duration_samples(const struct pound_excitation *e)
{
	return samples_within(e->duration, e->time_step);
}

static int cycles_samples(const struct pound_excitation *e)
{
	return samples_within(e->cycles / e->frequency_hz, e->time_step);
}

static int record_samples(const struct pound_excitation *e)
{
	return e->n_record;
}

/* a[i] times a trapezoid: up from 0 over the first `rise` of the time, down to 0 over the last `fall` */
static void shape(double rise, double fall, int n, double *a)
{
	const double up = rise * (n - 1), down = fall * (n - 1);
	const double upward = 1 / up, downward = 1 / down;
	for (int i = 0; i < up; i++)
		a[i] *= i * upward;
	for (int i = 0; i < down; i++)
		a[n - 1 - i] *= i * downward;
}

/* Largest |a|, n >= 1. */
double pound_excitation_largest(int n, const double *a)
{
	// in two parts, as each comparison waits for the one before it
	double even = 0, odd = fabs(a[n - 1]);
	for (int i = 0; i + 1 < n; i += 2) {
		even = fabs(a[i]) > even ? fabs(a[i]) : even;
		odd = fabs(a[i + 1]) > odd ? fabs(a[i + 1]) : odd;
	}
	return even > odd ? even : odd;
}

/* a times what makes its largest |a| the peak; dividing first, nothing in between is too large or too small */
static void scale(double peak, int n, double *a)
{
	const double largest = pound_excitation_largest(n, a);
	if (largest > 0)
		for (int i = 0; i < n; i++)
			a[i] = a[i] / largest * peak;
}

static void kanai_tajimi(const struct pound_excitation *e, struct pound_stream noise, double *a)
{
	const int n = cycles_samples(e);
	struct pound_filter filter;
	pound_filter_init(&filter, 2 * PI * e->frequency_hz * e->time_step, e->damping_ratio, e->high_pass_ratio);
	pound_filter_run(&filter, noise, n, a);
	shape(e->rise, e->fall, n, a);
	scale(e->peak, n, a);
}

static void white_noise(const struct pound_excitation *e, struct pound_stream noise, double *a)
{
	const int n = duration_samples(e);
	double z[NOISE_WORDS][NOISE_CHUNK];
	for (int i = 0; i < n; i++) {
		const int l = i / NOISE_WORDS % NOISE_CHUNK, w = i % NOISE_WORDS;
		if (l == 0 && w == 0)
			pound_noise_normals(pound_dispatch_width(0), noise, (uint32_t)(i / NOISE_WORDS), z);
		a[i] = z[w][l];
	}
	shape(e->rise, e->fall, n, a);
	scale(e->peak, n, a);
}

static void harmonic(const struct pound_excitation *e, struct pound_stream noise, double *a)
{
	(void)noise;
	const int n = duration_samples(e);
	for (int i = 0; i < n; i++) {
		double sine, cosine;
		pound_elementary_sincos(e->frequency_hz * (i * e->time_step), &sine, &cosine);
		a[i] = e->peak * sine;
	}
}

static void record(const struct pound_excitation *e, struct pound_stream noise, double *a)
{
	(void)noise;
	memcpy(a, e->record, (size_t)e->n_record * sizeof *a);
}

static const struct {
	const char *name;
	bool tuned;  /* has a frequency of its own */
	bool random; /* one signal differs from the next */
	int (*samples)(const struct pound_excitation *e);
	void (*fill)(const struct pound_excitation *e, struct pound_stream noise, double *a);
} excitations[] = {
    {"kanai_tajimi", true, true, cycles_samples, kanai_tajimi},
    {"white_noise", false, true, duration_samples, white_noise},
    {"harmonic", true, false, duration_samples, harmonic},
    {"record", false, false, record_samples, record},
};

enum { EXCITATIONS = sizeof excitations / sizeof excitations[0] };

const char *pound_excitation_name(int row)
{
	return row >= 0 && row < EXCITATIONS ? excitations[row].name : NULL;
}

/* Number of samples of an excitation.
 *
 * Returns  value   n     from the first to the last is the duration rounded to whole steps, at least one
 *
 * Valid    duration over step below 2^31 - 2
 * Test     unit_excitation: the_last_sample_is_the_one_nearest_to_the_end */
int pound_excitation_samples(const struct pound_excitation *e)
{
	assert(pound_excitation_name(e->type));
	return excitations[e->type].samples(e);
}

/* Samples of the ground acceleration of one signal.
 *
 * Given    e
 *          noise                 the stream of this signal; unused by harmonic and record
 * Returns  a       (n)    m/s2   n = pound_excitation_samples(e)
 *
 *   kanai_tajimi   filtered noise, times the trapezoid, scaled to peak      (filter.c)
 *   white_noise    independent normal samples, times the trapezoid, scaled to peak
 *   harmonic       peak * sin 2 pi f t
 *   record         as given
 *
 * Valid    Noise whose every sample is zero stays zero: two samples both at the feet of a trapezoid.
 * Source   model.md 4
 * Test     unit_excitation */
void pound_excitation_fill(const struct pound_excitation *e, struct pound_stream noise, double *a)
{
	assert(pound_excitation_name(e->type));
	excitations[e->type].fill(e, noise, a);
}

/* Frequency around which an excitation shakes [Hz], 0 for one that has none of its own.
 *
 * Test     unit_excitation: noise_without_colour_and_records_have_no_frequency */
double pound_excitation_frequency(const struct pound_excitation *e)
{
	return excitations[e->type].tuned ? e->frequency_hz : 0;
}

/* Whether the signals of an excitation differ.
 *
 * Test     unit_excitation: only_noise_differs_from_signal_to_signal */
bool pound_excitation_random(const struct pound_excitation *e)
{
	return excitations[e->type].random;
}
