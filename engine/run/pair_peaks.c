/* pair_peaks.c - the largest displacements of two bodies against each other, and the fastest approach of a contact.
 *
 * 1. Between two instants outside of contacts a cubic and the bound of its error show how large u_1 - u_2 may be; where that
 *    is more than at any instant so far, the interval is noted.
 * 2. In the end the notes that are still above are searched: u_1 - u_2 as a power series in time, or several where one does
 *    not reach, is halved until what it may exceed the largest value by is rounding.
 *
 * Two linear bodies go from sample to sample by their exact maps; others are followed by the exact solver. */
#include "engine/run/pair_peaks.h"

#include <float.h>
#include <math.h>

#include "engine/exact/tolerances.h"

enum { ORDER = 21, HALVINGS = 30, NEWTON = 20 };

static const double REACH = 1.5; // largest rate * step of a series: 1.5^22/22! is below rounding

/* A power series over a step, by the share of the step that is gone [m]. */
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

/* The largest value of a series that is concave between two points, by Newton's method on its slope. */
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
	const double above = at[0] + fabs(at[1]) * half + 0.5 * s->bend * half * half - *peak;
	if (depth == HALVINGS || !(above > s->rounding))
		return;
	if (2 * at[2] + s->twist * half < 0) {
		*peak = fmax(*peak, series_crest(s, middle - half, middle + half, at));
		return;
	}
	// the half that rises first, so that the other is often left out
	const double next = at[1] < 0 ? -0.5 * half : 0.5 * half;
	series_search(s, middle + next, 0.5 * half, depth + 1, peak);
	series_search(s, middle - next, 0.5 * half, depth + 1, peak);
}

/* Raises the peak to the largest value of a series times sign.
 *
 *   p(x) = c_0 + x^k (c_k + c_k+1 x + ...) <= c_0 + max(c_k + max(c_k+1 + ..., 0), 0)     for 0 <= x <= 1
 *
 * with c_k the first coefficient behind c_0 that is not 0.  Bodies leave their rest like x^4: no halving would find that flat start
 * below the peak before its steps are as short as roundings. */
static void series_peak(const struct series *s, double sign, double *peak)
{
	struct series signed_series = {.bend = s->bend, .twist = s->twist, .rounding = s->rounding};
	double rise = 0;
	for (int n = ORDER; n >= 0; n--) {
		signed_series.c[n] = sign * s->c[n];
		if (n > 0 && signed_series.c[n] != 0)
			rise = fmax(rise, 0) + signed_series.c[n];
	}
	if (!(signed_series.c[0] + fmax(rise, 0) > *peak + s->rounding))
		return;
	*peak = fmax(*peak, signed_series.c[0]);
	if (rise > 0)
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

/* Notes an interval; notes that do not count any more make room for it, else the first one is searched. */
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

/* Raises the peaks to the displacement at the end of an interval, and notes it where it may have been larger inside.
 *
 * Given    p, q    u_1 - u_2 and its rate at both ends [m], [m/s]
 *          error   of the cubic through them [m]
 */
static void interval_look(struct pound_pair_peaks *peaks, struct pound_pair_note *note, const double p[2],
                          const double q[2], double error)
{
	const double third = note->length / 3, b1 = p[0] + third * q[0], b2 = p[1] - third * q[1];
	peaks->peak[0] = fmax(peaks->peak[0], p[1]);
	peaks->peak[1] = fmax(peaks->peak[1], -p[1]);
	note->most[0] = fmax(b1, b2) + error;
	note->most[1] = error - fmin(b1, b2);
	if (note_counts(peaks, note))
		note_add(peaks, note);
}

/* A bound of the error of the cubic through both ends of an interval; infinite where it is long.
 *
 *   |u''| <= A = (|u''(0)| + h (k |v(0)| + |a'|)) / (1 - h c - k h^2)     as u''' = -(c u'' + k u' + a'), |u'| <= |v(0)| + h A
 *   |u''''| <= c |u'''| + k A,   error <= h^4/384 |u''''|
 */
static double cubic_error(const struct pound_task_body *b, const struct pound_instant_of_task *at, int i,
                          double h)
{
	const double c = b->damping, k = at->stiffness[i], slope = fabs(b->drive * at->slope), v = fabs(at->v[i]);
	const double start = fabs(c * at->v[i] + k * at->u[i] + at->spring_offset[i] + b->drive * at->ground);
	const double left = 1 - h * c - k * h * h;
	if (!(left > 0.25))
		return INFINITY;
	const double most = (start + h * (k * v + slope)) / left;
	return h * h * h * h / 384 * (c * (c * most + k * (v + h * most) + slope) + k * most);
}

static void observe(void *into, const struct pound_instant_of_task *instant)
{
	struct pound_pair_peaks *peaks = into;
	const struct pound_instant_of_task *from = &peaks->from;
	if (instant->elapsed > 0 && !from->touching) {
		struct pound_pair_note note = {.from = *from, .length = instant->elapsed};
		double error = 0;
		for (int i = 0; i < POUND_OSCILLATORS; i++)
			error += cubic_error(&peaks->bodies[i], from, i, note.length);
		interval_look(peaks, &note, (const double[2]){from->u[0] - from->u[1], instant->u[0] - instant->u[1]},
		              (const double[2]){from->v[0] - from->v[1], instant->v[0] - instant->v[1]}, error);
	}
	if (instant->touching && !from->touching)
		peaks->approach = fmax(peaks->approach, instant->overlap_rate);
	peaks->from = *instant;
	peaks->samples_left -= instant->sampled;
	if (peaks->samples_left <= 0)
		notes_search(peaks);
}

static void start(struct pound_pair_peaks *peaks, const struct pound_task *task)
{
	*peaks = (struct pound_pair_peaks){.observer = {observe, peaks}, .samples_left = task->n_samples};
	for (int i = 0; i < POUND_OSCILLATORS; i++) {
		const struct pound_task_body *b = &task->bodies[i];
		peaks->bodies[i] = *b;
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

/* a number of each body */
typedef double bodies __attribute__((vector_size(sizeof(double) * POUND_OSCILLATORS)));

static double difference(bodies x)
{
	return x[0] - x[1];
}

static bodies magnitude(bodies x)
{
	return (bodies){fabs(x[0]), fabs(x[1])};
}

/* A body over one sample, from its displacement, velocity and the ground acceleration and its growth over the sample: their
 * columns, and by how much of each the cubic of its displacement may err. */
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
		maps->u[j][i] = at.u[0], maps->v[j][i] = at.v[0], maps->error[j][i] = 0;
		for (int n = 4; n <= ORDER; n++)
			maps->error[j][i] += n * (n - 1.0) * (n - 2.0) * (n - 3.0) * fabs(s.c[n]) / 384;
	}
}

/* The maps of a task's bodies, which may be those of the task before; false: there are none. */
static bool maps_of(struct pound_pair_maps *maps, const struct pound_task *task)
{
	bool same = maps->step == task->time_step;
	for (int i = 0; i < POUND_OSCILLATORS; i++) {
		const struct pound_task_body *b = &task->bodies[i];
		const double w = sqrt(b->backbone.stiffness);
		if (!pound_law_linear(b->backbone.law) || !(fmax(w, b->damping) * task->time_step <= REACH))
			return false;
		same &= maps->stiffness[i] == b->backbone.stiffness && maps->damping[i] == b->damping &&
		        maps->drive[i] == b->drive;
	}
	for (int i = 0; i < POUND_OSCILLATORS && !same; i++) {
		const struct pound_task_body *b = &task->bodies[i];
		maps->stiffness[i] = b->backbone.stiffness, maps->damping[i] = b->damping, maps->drive[i] = b->drive;
		map_fill(maps, i, b, task->time_step);
	}
	maps->step = task->time_step;
	return true;
}

static bodies column(const double of[POUND_OSCILLATORS])
{
	return (bodies){of[0], of[1]};
}

/* Notes a sample of two linear bodies.
 *
 * Given    most  closing and opening displacement inside, at most
 */
static void sample_note(struct pound_pair_peaks *peaks, const struct pound_task *task, int s, bodies u,
                        bodies v, const double most[2])
{
	struct pound_pair_note note = {.length = task->time_step, .most = {most[0], most[1]}};
	note.from.ground = task->ground[s];
	note.from.slope = (task->ground[s + 1] - task->ground[s]) / task->time_step;
	for (int i = 0; i < POUND_OSCILLATORS; i++) {
		note.from.u[i] = u[i], note.from.v[i] = v[i];
		note.from.stiffness[i] = task->bodies[i].backbone.stiffness;
	}
	note_add(peaks, &note);
}

/* The closing and opening displacement of two linear bodies that start at rest, without contact.
 *
 * Given    maps   of the task before, all 0 at first
 * Returns  value  false: they are to be observed, as their steps are too long or a law is not linear
 * Test     unit_outputs: two_linear_bodies_have_the_peaks_that_an_observer_finds
 */
bool pound_pair_peaks_linear(struct pound_pair_maps *maps, const struct pound_task *task, double peak[2])
{
	struct pound_pair_peaks peaks;
	if (!maps_of(maps, task))
		return false;
	start(&peaks, task);
	const bodies uu = column(maps->u[0]), uv = column(maps->u[1]), ua = column(maps->u[2]),
	             ud = column(maps->u[3]), vu = column(maps->v[0]), vv = column(maps->v[1]),
	             va = column(maps->v[2]), vd = column(maps->v[3]), eu = column(maps->error[0]),
	             ev = column(maps->error[1]);
	const double ea = maps->error[2][0] + maps->error[2][1], ed = maps->error[3][0] + maps->error[3][1],
	             third = task->time_step / 3;
	bodies u = {0, 0}, v = {0, 0};
	double p = 0, inner = 0, top = 0, bottom = 0; // inner: p + third q
	for (int s = 0; s + 1 < task->n_samples; s++) {
		const double a = task->ground[s], d = task->ground[s + 1] - a;
		const bodies u1 = uu * u + (uv * v + (ua * a + ud * d)), v1 = vv * v + (vu * u + (va * a + vd * d));
		const bodies off = eu * magnitude(u) + ev * magnitude(v);
		const double error = (off[0] + off[1]) + (ea * fabs(a) + ed * fabs(d));
		const double p1 = difference(u1), step = third * difference(v1), b2 = p1 - step;
		const double high = (inner > b2 ? inner : b2) + error, low = (inner < b2 ? inner : b2) - error;
		top = p1 > top ? p1 : top;
		bottom = p1 < bottom ? p1 : bottom;
		// few samples may hold more than their ends
		if (high > top || low < bottom) {
			peaks.peak[0] = top > peaks.peak[0] ? top : peaks.peak[0];
			peaks.peak[1] = -bottom > peaks.peak[1] ? -bottom : peaks.peak[1];
			sample_note(&peaks, task, s, u, v, (const double[2]){high, -low});
		}
		u = u1, v = v1, p = p1, inner = p + step;
	}
	peaks.peak[0] = top > peaks.peak[0] ? top : peaks.peak[0];
	peaks.peak[1] = -bottom > peaks.peak[1] ? -bottom : peaks.peak[1];
	notes_search(&peaks);
	peak[0] = peaks.peak[0], peak[1] = peaks.peak[1];
	return true;
}
