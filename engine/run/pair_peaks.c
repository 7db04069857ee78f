/* pair_peaks.c - the largest displacements of two bodies against each other, and the fastest approach of a contact.
 *
 * 1. Outside of contacts the closing displacement u_1 - u_2 is a power series in time between two instants, or several where
 *    one does not reach.
 * 2. A series that may exceed the largest value so far is halved until what it may exceed it by is rounding. */
#include "engine/run/pair_peaks.h"

#include <float.h>
#include <math.h>

#include "engine/exact/tolerances.h"

enum { ORDER = 21, HALVINGS = 30 };

static const double REACH = 1.5; // largest rate * step of a series: 1.5^22/22! is below rounding

/* A power series over a step, by the share of the step that is gone [m]. */
struct series {
	double c[ORDER + 1];
	double bend;     /* bound of its second derivative */
	double rounding; /* of its terms */
};

static void series_at(const struct series *s, double x, double *value, double *slope)
{
	double p = s->c[ORDER], q = 0;
	for (int n = ORDER - 1; n >= 0; n--) {
		q = q * x + p;
		p = p * x + s->c[n];
	}
	*value = p;
	*slope = q;
}

/* Raises the peak to the largest value of a series between middle - half and middle + half, to the rounding of its terms.
 *
 *   p(x) <= p(m) + |p'(m)| h + bend h^2/2     for |x - m| <= h
 */
static void series_search(const struct series *s, double middle, double half, int depth, double *peak)
{
	double value, slope;
	series_at(s, middle, &value, &slope);
	*peak = fmax(*peak, value);
	const double above = value + fabs(slope) * half + 0.5 * s->bend * half * half - *peak;
	if (depth == HALVINGS || !(above > s->rounding))
		return;
	// the half that rises first, so that the other is often left out
	const double next = slope < 0 ? -0.5 * half : 0.5 * half;
	series_search(s, middle + next, 0.5 * half, depth + 1, peak);
	series_search(s, middle - next, 0.5 * half, depth + 1, peak);
}

/* Raises the peak to the largest value of a series times sign. */
static void series_peak(const struct series *s, double sign, double *peak)
{
	struct series signed_series = {.bend = s->bend, .rounding = s->rounding};
	double most = 0;
	for (int n = 0; n <= ORDER; n++) {
		const double c = sign * s->c[n];
		signed_series.c[n] = c;
		most += n == 0 ? c : fmax(c, 0);
	}
	if (!(most > *peak + s->rounding))
		return;
	*peak = fmax(*peak, signed_series.c[0]);
	series_search(&signed_series, 0.5, 0.5, 0, peak);
}

/* Adds a body's series, and moves its state to the end of the step.
 *
 *   u'' = -(c u' + k u + r + drive (a + a' t))     derivatives by t over the step
 */
static void body_add(const struct pound_task_body *b, struct pound_instant_of_task *at, int i, double step,
                     struct series *s)
{
	const double damping = b->damping * step, stiffness = at->stiffness[i] * step * step;
	const double forcing[2] = {(b->drive * at->ground + at->spring_offset[i]) * step * step,
	                           b->drive * at->slope * step * step * step};
	double y[ORDER + 2] = {at->u[i], at->v[i] * step}, u = 0, v = 0;
	for (int n = 0; n < ORDER; n++)
		y[n + 2] = -(damping * y[n + 1] + stiffness * y[n]) - (n < 2 ? forcing[n] : 0);
	for (int n = ORDER; n >= 0; n--) {
		u += y[n] * POUND_FACTOR[n];
		v += y[n + 1] * POUND_FACTOR[n];
		s->c[n] += (i ? -y[n] : y[n]) * POUND_FACTOR[n];
	}
	at->u[i] = u;
	at->v[i] = v / step;
}

static void interval_peaks(struct pound_pair_peaks *peaks, double length)
{
	struct pound_instant_of_task at = peaks->from;
	const double steps = fmax(ceil(peaks->rate * length / REACH), 1), step = length / steps;
	for (double k = 0; k < steps; k++) {
		struct series s = {0};
		for (int i = 0; i < POUND_OSCILLATORS; i++)
			body_add(&peaks->bodies[i], &at, i, step, &s);
		at.ground += at.slope * step;
		for (int n = 0; n <= ORDER; n++) {
			s.bend += n * (n - 1) * fabs(s.c[n]);
			s.rounding += DBL_EPSILON * fabs(s.c[n]);
		}
		series_peak(&s, 1, &peaks->closing);
		series_peak(&s, -1, &peaks->opening);
	}
}

static void observe(void *into, const struct pound_instant_of_task *instant)
{
	struct pound_pair_peaks *peaks = into;
	if (instant->elapsed > 0 && !peaks->from.touching)
		interval_peaks(peaks, instant->elapsed);
	if (instant->touching && !peaks->from.touching)
		peaks->approach = fmax(peaks->approach, instant->overlap_rate);
	peaks->from = *instant;
}

/* Test     unit_outputs: the_gap_needed_decides_which_signals_pound, the_largest_approach_speed_is_that_of_an_impact */
void pound_pair_peaks_start(struct pound_pair_peaks *peaks, struct pound_task *task)
{
	*peaks = (struct pound_pair_peaks){.observer = {observe, peaks}};
	for (int i = 0; i < POUND_OSCILLATORS; i++) {
		const struct pound_task_body *b = &task->bodies[i];
		peaks->bodies[i] = *b;
		peaks->rate = fmax(peaks->rate, fmax(sqrt(b->backbone.stiffness), b->damping));
	}
	task->observer = &peaks->observer;
}
