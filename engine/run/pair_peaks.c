/* pair_peaks.c - the largest relative displacements of two bodies.
 *
 * 1. Between two instants outside of contacts a cubic Hermite interpolant and its error bound limit u_1 - u_2; if the limit
 *    exceeds the largest value at any instant so far, the interval is noted.
 * 2. At the end the notes whose limit still exceeds the largest value are searched: u_1 - u_2 is a power series in time (several
 *    for a long interval), and the interval is bisected until the possible excess is rounding error.
 *
 * Two linear bodies are advanced from sample to sample by their exact maps (pair_peaks.inl); others are followed by the exact
 * solver, which skips samples that cannot contain a larger value (task.h). */
#include "engine/run/pair_peaks.h"

#include <assert.h>
#include <float.h>
#include <math.h>

#include "engine/exact/tolerances.h"
#include "engine/numeric/cpu_width.h"

enum { ORDER = 21, HALVINGS = 30, NEWTON = 20 };

static const double REACH = 1.5; // largest rate * step of a series: 1.5^22/22! is below rounding

/* A power series over a step, in the fraction x in [0, 1] of the step [m]. */
struct series {
	double c[ORDER + 1];
	double bend, twist; /* bounds of its second and third derivative */
	double rounding;    /* of its terms */
};

/* Value, slope and half the second derivative. */
static void series_at(const struct series *s, double x, double at[3])
{
	at[0] = s->c[ORDER], at[1] = at[2] = 0;
	for (int n = ORDER - 1; n >= 0; n--) {
		at[2] = at[2] * x + at[1];
		at[1] = at[1] * x + at[0];
		at[0] = at[0] * x + s->c[n];
	}
}

/* A bound of the second derivative from 0 to a fraction of the step: sharper than s->bend if terms of high order dominate, as
 * for bodies that start from rest, like x^4. */
static double series_bend(const struct series *s, double share)
{
	double sum = 0;
	for (int n = ORDER; n >= 2; n--)
		sum = sum * share + n * (n - 1) * fabs(s->c[n]);
	return sum;
}

/* Maximum of a series that is concave between two points, by Newton's method on its slope. */
static double series_crest(const struct series *s, double low, double high, const double middle[3])
{
	double at[3] = {middle[0], middle[1], middle[2]}, x = 0.5 * (low + high), most = at[0];
	for (int k = 0; k < NEWTON; k++) {
		const double next = fmin(fmax(x - at[1] / (2 * at[2]), low), high), step = next - x;
		x = next;
		series_at(s, x, at);
		most = fmax(most, at[0]);
		if (fabs(at[1] * step) <= s->rounding)
			break;
	}
	return most;
}

/* Raises the peak to the largest value of a series between middle - half and middle + half, to the rounding of its terms.
 *
 *   p(x) <= p(m) + |p'(m)| h + bend h^2/2,     p''(x) <= p''(m) + twist h     for |x - m| <= h
 */
static void series_search(const struct series *s, double middle, double half, int depth, double *peak)
{
	double at[3];
	series_at(s, middle, at);
	*peak = fmax(*peak, at[0]);
	const double line = at[0] + fabs(at[1]) * half - *peak, square = 0.5 * half * half;
	if (depth == HALVINGS || !(line + square * s->bend > s->rounding) ||
	    !(line + square * series_bend(s, middle + half) > s->rounding))
		return;
	if (2 * at[2] + s->twist * half < 0) {
		*peak = fmax(*peak, series_crest(s, middle - half, middle + half, at));
		return;
	}
	// the rising half first, so that the other is often skipped
	const double next = at[1] < 0 ? -0.5 * half : 0.5 * half;
	series_search(s, middle + next, 0.5 * half, depth + 1, peak);
	series_search(s, middle - next, 0.5 * half, depth + 1, peak);
}

/* Raises the peak to the largest value of sign times a series. */
static void series_peak(const struct series *s, double sign, double *peak)
{
	struct series signed_series = {.bend = s->bend, .twist = s->twist, .rounding = s->rounding};
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

/* Raises the peaks to the largest values inside a noted interval. */
static void note_search(struct pound_pair_peaks *peaks, const struct pound_pair_note *note)
{
	struct pound_instant_of_task at = note->from;
	const double steps = fmax(ceil(peaks->rate * note->length / REACH), 1), step = note->length / steps;
	for (double k = 0; k < steps; k++) {
		struct series s = {0};
		for (int i = 0; i < POUND_OSCILLATORS; i++)
			body_add(&peaks->bodies[i], &at, i, step, &s);
		at.ground += at.slope * step;
		for (int n = 0; n <= ORDER; n++) {
			s.bend += n * (n - 1) * fabs(s.c[n]);
			s.twist += n * (n - 1) * (n - 2) * fabs(s.c[n]);
			s.rounding += DBL_EPSILON * fabs(s.c[n]);
		}
		series_peak(&s, 1, &peaks->peak[0]);
		series_peak(&s, -1, &peaks->peak[1]);
	}
}

static bool note_counts(const struct pound_pair_peaks *peaks, const struct pound_pair_note *note)
{
	return note->most[0] > peaks->peak[0] || note->most[1] > peaks->peak[1];
}

/* Notes an interval; obsolete notes are removed, and if there is still no room the first note is searched. */
static void note_add(struct pound_pair_peaks *peaks, const struct pound_pair_note *note)
{
	int kept = 0;
	for (int k = 0; k < peaks->n_notes; k++)
		if (note_counts(peaks, &peaks->notes[k]))
			peaks->notes[kept++] = peaks->notes[k];
	if (kept == POUND_PAIR_NOTES) {
		note_search(peaks, &peaks->notes[0]);
		for (int k = 1; k < kept; k++)
			peaks->notes[k - 1] = peaks->notes[k];
		kept--;
	}
	peaks->notes[kept] = *note;
	peaks->n_notes = kept + 1;
}

static void notes_search(struct pound_pair_peaks *peaks)
{
	for (int k = 0; k < peaks->n_notes; k++)
		if (note_counts(peaks, &peaks->notes[k]))
			note_search(peaks, &peaks->notes[k]);
	peaks->n_notes = 0;
}

/* Error bound of the cubic through both ends of an interval, as factors of the acceleration and velocity at its start and of the
 * slope of the ground acceleration.  No interval is longer than a sample, and no branch stiffer than the first.
 *
 *   |u''| <= A = (|u''(0)| + h (k |v(0)| + |a'|)) / (1 - h c - k h^2)     as u''' = -(c u'' + k u' + a'), |u'| <= |v(0)| + h A
 *   |u''''| <= c |u'''| + k A <= (c^2 + c k h + k) A + c k |v(0)| + c |a'|,   error <= h^4/384 |u''''|
 */
static void error_fill(double error[3], const struct pound_task_body *b, double h)
{
	const double c = b->damping, k = b->backbone.stiffness, left = 1 - h * c - k * h * h;
	const double most = (c * c + c * k * h + k) / left, fourth = h * h * h * h / 384;
	const bool is_short = left > 0.25;
	error[0] = is_short ? fourth * most : DBL_MAX;
	error[1] = is_short ? fourth * k * (most * h + c) : DBL_MAX;
	error[2] = is_short ? fourth * fabs(b->drive) * (most * h + c) : DBL_MAX;
}

/* Raises the peaks to the displacement at the end of an interval, and notes the interval if a larger value inside is possible. */
static void interval_look(struct pound_pair_peaks *peaks, const struct pound_instant_of_task *instant)
{
	const struct pound_instant_of_task *from = &peaks->from;
	const double third = instant->elapsed / 3, p = instant->u[0] - instant->u[1];
	const double b1 = from->u[0] - from->u[1] + third * (from->v[0] - from->v[1]),
	             b2 = p - third * (instant->v[0] - instant->v[1]);
	double error = 0;
	for (int i = 0; i < POUND_OSCILLATORS; i++) {
		const struct pound_task_body *b = &peaks->bodies[i];
		assert(from->stiffness[i] <= 1.000001 * b->backbone.stiffness); // else the error bound is invalid
		const double acceleration = b->damping * from->v[i] + from->stiffness[i] * from->u[i] +
		                            (from->spring_offset[i] + b->drive * from->ground);
		error += peaks->error[i][0] * fabs(acceleration) +
		         (peaks->error[i][1] * fabs(from->v[i]) + peaks->error[i][2] * fabs(from->slope));
	}
	const double most[2] = {(b1 > b2 ? b1 : b2) + error, error - (b1 < b2 ? b1 : b2)};
	peaks->peak[0] = p > peaks->peak[0] ? p : peaks->peak[0];
	peaks->peak[1] = -p > peaks->peak[1] ? -p : peaks->peak[1];
	if (most[0] > peaks->peak[0] || most[1] > peaks->peak[1])
		note_add(peaks, &(struct pound_pair_note){*from, instant->elapsed, {most[0], most[1]}});
}

static void observe(void *into, const struct pound_instant_of_task *instant)
{
	struct pound_pair_peaks *peaks = into;
	if (instant->elapsed > 0 && !peaks->from.touching)
		interval_look(peaks, instant);
	peaks->from = *instant;
	peaks->samples_left -= instant->sampled;
	if (peaks->samples_left <= 0)
		notes_search(peaks);
}

/* Skips n samples that cannot contain a larger value. */
static void pass(void *into, const struct pound_instant_of_task *instant, int n)
{
	struct pound_pair_peaks *peaks = into;
	peaks->from = *instant;
	peaks->samples_left -= n;
	if (peaks->samples_left <= 0)
		notes_search(peaks);
}

static void start(struct pound_pair_peaks *peaks, const struct pound_task *task)
{
	*peaks = (struct pound_pair_peaks){.observer = {observe, peaks, peaks->peak, pass},
	                                   .samples_left = task->n_samples};
	for (int i = 0; i < POUND_OSCILLATORS; i++) {
		const struct pound_task_body *b = &task->bodies[i];
		peaks->bodies[i] = *b;
		error_fill(peaks->error[i], b, task->time_step);
		peaks->rate = fmax(peaks->rate, fmax(sqrt(b->backbone.stiffness), b->damping));
	}
}

/* Test     unit_outputs: the_gap_needed_decides_which_signals_pound */
void pound_pair_peaks_start(struct pound_pair_peaks *peaks, struct pound_task *task)
{
	start(peaks, task);
	task->observer = &peaks->observer;
}

/* ---- linear bodies ---- */

/* Transition of a body over one sample: columns for its displacement, its velocity, the ground acceleration and the change of the
 * ground acceleration, and the error bound of the displacement's cubic per column. */
static void map_fill(struct pound_pair_maps *maps, int i, const struct pound_task_body *b, double step)
{
	for (int j = 0; j < POUND_PAIR_COLUMNS; j++) {
		struct pound_instant_of_task at = {.u = {j == 0},
		                                   .v = {j == 1},
		                                   .ground = j == 2,
		                                   .slope = j == 3 ? 1 / step : 0,
		                                   .stiffness = {b->backbone.stiffness}};
		struct series s = {0};
		body_add(b, &at, 0, step, &s);
		maps->u[i][j] = at.u[0], maps->v[i][j] = at.v[0], maps->error[i][j] = 0;
		for (int n = 4; n <= ORDER; n++)
			maps->error[i][j] += n * (n - 1.0) * (n - 2.0) * (n - 3.0) * fabs(s.c[n]) / 384;
	}
}

typedef void width_pairs(const struct pound_pairs *, struct pound_pair_peaks *);

static bool has_maps(const struct pound_task *task)
{
	bool has = true;
	for (int i = 0; i < POUND_OSCILLATORS; i++) {
		const struct pound_task_body *b = &task->bodies[i];
		has &= pound_law_linear(b->backbone.law) &&
		       fmax(sqrt(b->backbone.stiffness), b->damping) * task->time_step <= REACH;
	}
	return has;
}

/* Whether two tasks have the same maps and number of samples. */
static bool goes_with(const struct pound_task *task, const struct pound_task *other)
{
	bool same = task->n_samples == other->n_samples && task->time_step == other->time_step;
	for (int i = 0; i < POUND_OSCILLATORS; i++) {
		const struct pound_task_body *a = &task->bodies[i], *b = &other->bodies[i];
		same &= a->backbone.stiffness == b->backbone.stiffness && a->damping == b->damping &&
		        a->drive == b->drive;
	}
	return same;
}

/* Notes a sample interval of two linear bodies.
 *
 * Given    note   state at the start of the interval, and bounds inside
 *          peak   closing and opening displacement so far
 */
void pound_pair_sample(struct pound_pair_peaks *peaks, const struct pound_task *task, int s,
                       struct pound_pair_note *note, const double peak[2])
{
	for (int k = 0; k < 2; k++)
		peaks->peak[k] = peak[k] > peaks->peak[k] ? peak[k] : peaks->peak[k];
	note->length = task->time_step;
	note->from.ground = task->ground[s];
	note->from.slope = (task->ground[s + 1] - task->ground[s]) / task->time_step;
	for (int i = 0; i < POUND_OSCILLATORS; i++)
		note->from.stiffness[i] = task->bodies[i].backbone.stiffness;
	note_add(peaks, note);
}

/* Follows the collected pairs, and writes the closing and opening displacement of each. */
void pound_pairs_finish(struct pound_pairs *all)
{
	static width_pairs *const run[POUND_WIDTHS] = {pound_pairs_w8, pound_pairs_w4, pound_pairs_w1,
	                                               pound_pairs_portable};
	struct pound_pair_peaks peaks[POUND_PAIRS];
	if (all->n == 0)
		return;
	for (int k = 0; k < all->n; k++)
		start(&peaks[k], &all->tasks[k]);
	run[pound_dispatch_width(0)](all, peaks);
	for (int k = 0; k < all->n; k++) {
		notes_search(&peaks[k]);
		all->peak[k][0] = peaks[k].peak[0], all->peak[k][1] = peaks[k].peak[1];
	}
	all->n = 0;
}

/* Adds a pair of linear bodies that start at rest, without contact, to compute its closing and opening displacement.
 *
 * Given    pairs  zeroed before the first call
 *          task   its ground motion must stay valid until the pairs are finished
 * Returns  value  false: use an observer instead, because steps are too long or a law is not linear
 *          peak   set when the pairs are finished: by pound_pairs_finish, or when they are full or a pair has other maps
 * Test     unit_outputs: linear_bodies_have_the_peaks_that_an_observer_finds
 */
bool pound_pairs_add(struct pound_pairs *all, const struct pound_task *task, double peak[2])
{
	if (!has_maps(task))
		return false;
	if (all->n > 0 && !goes_with(task, &all->tasks[0]))
		pound_pairs_finish(all);
	// tasks[0] of the previous pairs is still stored
	for (int i = 0; i < POUND_OSCILLATORS && all->n == 0 && !goes_with(task, &all->tasks[0]); i++)
		map_fill(&all->maps, i, &task->bodies[i], task->time_step);
	all->tasks[all->n] = *task;
	all->peak[all->n++] = peak;
	if (all->n == POUND_PAIRS)
		pound_pairs_finish(all);
	return true;
}
