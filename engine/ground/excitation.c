/* excitation.c - the table of excitations: number of samples and samples of each type. */
#include "engine/ground/excitation.h"

#include <assert.h>
#include <limits.h>
#include <math.h>
#include <string.h>

#include "engine/ground/kanai_tajimi.h"
#include "engine/ground/largest.h"
#include "engine/ground/noise.h"
#include "engine/numeric/cpu_width.h"
#include "engine/numeric/elementary.h"

static const double PI = 0x1.921fb54442d18p+1;

/* duration / step, rounded to the nearest integer, at least 1, plus the sample at time 0 */
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

static int suite_samples(const struct pound_excitation *e)
{
	int least, most;
	pound_suite_samples(e, &least, &most);
	return most;
}

/* Largest |a|.  (n) */
double pound_excitation_largest(int n, const double *a)
{
	return ground_largest(n, a);
}

/* The noise of a signal; filter NULL: white. */
static struct pound_noise noise_of(const struct pound_signal *signal, const struct pound_filter *filter,
                                   int n)
{
	const struct pound_excitation *e = signal->excitation;
	return (struct pound_noise){.filter = filter,
	                            .stream = signal->noise,
	                            .n = n,
	                            .a = signal->a,
	                            .rise = e->rise,
	                            .fall = e->fall,
	                            .peak = e->peak};
}

static void kanai_tajimi(const struct pound_signal *signals, int n)
{
	struct pound_noise made[POUND_SIGNALS_MAX];
	struct pound_filter filters[POUND_SIGNALS_MAX], *filter = filters - 1;
	double of[3] = {-1, -1, -1}; /* parameters of the last filter: signals of one design row share it */
	for (int j = 0; j < n; j++) {
		const struct pound_excitation *e = signals[j].excitation;
		const double asked[3] = {2 * PI * e->frequency_hz * e->time_step, e->damping_ratio,
		                         e->high_pass_ratio};
		if (memcmp(of, asked, sizeof of) != 0) {
			memcpy(of, asked, sizeof of);
			pound_filter_init(++filter, of[0], of[1], of[2]);
		}
		// sorted by length, so that signals in adjacent lanes end together
		const int samples = cycles_samples(e);
		int at = j;
		for (; at > 0 && made[at - 1].n > samples; at--)
			made[at] = made[at - 1];
		made[at] = noise_of(&signals[j], filter, samples);
	}
	pound_noise_fill(pound_dispatch_width(0), made, n);
}

static void white_noise(const struct pound_signal *signal, int one)
{
	const struct pound_noise made = noise_of(signal, NULL, duration_samples(signal->excitation));
	pound_noise_fill(pound_dispatch_width(0), &made, one);
}

static void harmonic(const struct pound_signal *signal, int one)
{
	(void)one;
	const struct pound_excitation *e = signal->excitation;
	const int n = duration_samples(e);
	for (int i = 0; i < n; i++) {
		double sine, cosine;
		pound_elementary_sincos(e->frequency_hz * (i * e->time_step), &sine, &cosine);
		signal->a[i] = e->peak * sine;
	}
}

static void record(const struct pound_signal *signal, int one)
{
	(void)one;
	const struct pound_excitation *e = signal->excitation;
	for (int i = 0; i < e->n_record; i++)
		signal->a[i] = e->factor * e->record[i];
}

static const struct {
	const char *name;
	const char *text; /* one line of documentation */
	bool tuned;       /* reads frequency_hz */
	bool random;      /* each signal is another realization */
	int at_once;      /* most signals of one call of fill */
	int (*samples)(const struct pound_excitation *e);
	void (*fill)(const struct pound_signal *signals, int n); /* NULL: the signals have the type record */
} excitations[] = {
    {"kanai_tajimi", "white noise through the Kanai-Tajimi filter and a high pass, a trapezoid in time", true,
     true, POUND_SIGNALS_MAX, cycles_samples, kanai_tajimi},
    {"white_noise", "independent normal samples, a trapezoid in time", false, true, 1, duration_samples,
     white_noise},
    {"harmonic", "a sine", true, false, 1, duration_samples, harmonic},
    {"record", "given samples", false, false, 1, record_samples, record},
    {"suite", "recorded ground motions, each a signal", false, false, 1, suite_samples, NULL},
};

enum { EXCITATIONS = sizeof excitations / sizeof excitations[0] };

const char *pound_excitation_text(int row)
{
	return excitations[row].text;
}

const char *pound_excitation_name(int row)
{
	return row >= 0 && row < EXCITATIONS ? excitations[row].name : NULL;
}

/* Number of samples of an excitation.
 *
 * Returns  value   n     1 + the duration in whole steps, rounded, at least one step; suite: samples of its longest record
 *
 * Valid    duration over step below 2^31 - 2
 * Test     unit_excitation: the_last_sample_is_the_one_nearest_to_the_end */
int pound_excitation_samples(const struct pound_excitation *e)
{
	assert(pound_excitation_name(e->type));
	return excitations[e->type].samples(e);
}

/* Samples of the ground acceleration of signals.
 *
 * Given    signals  (n)    of any excitations but suites; fastest if adjacent signals have the same type and length
 * Returns  signals  a      m/s2
 *
 *   kanai_tajimi   filtered noise, times the trapezoid, scaled to peak      (kanai_tajimi.c)
 *   white_noise    independent normal samples, times the trapezoid, scaled to peak
 *   harmonic       peak * sin 2 pi f t
 *   record         samples of the record, times its factor
 *
 * Valid    A signal of two samples may be zero at both, where the trapezoid is zero: it stays zero, without its peak.
 *          The bits of a signal do not depend on the other signals.
 * Source   model.md 4
 * Test     unit_excitation */
void pound_signals_fill(const struct pound_signal *signals, int n)
{
	for (int first = 0, end; first < n; first = end) {
		const int type = signals[first].excitation->type;
		assert(pound_excitation_name(type) && excitations[type].fill);
		for (end = first + 1; end < n && end - first < excitations[type].at_once; end++)
			if (signals[end].excitation->type != type)
				break;
		excitations[type].fill(&signals[first], end - first);
	}
}

/* Frequency of an excitation [Hz]: of the filter or of the sine; 0: the excitation has no frequency parameter.
 *
 * Test     unit_excitation: noise_without_colour_and_records_have_no_frequency */
double pound_excitation_frequency(const struct pound_excitation *e)
{
	return excitations[e->type].tuned ? e->frequency_hz : 0;
}

/* Whether the signals of an excitation are random: noise, and suites whose records are drawn at random.
 *
 * Test     unit_excitation: only_noise_differs_from_signal_to_signal */
bool pound_excitation_random(const struct pound_excitation *e)
{
	return excitations[e->type].random || e->draw > 0;
}
