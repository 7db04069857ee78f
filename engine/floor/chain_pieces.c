/* chain_pieces.c - the motion of a floor of a chain, from the steps of the exact solver, as pieces.
 *
 * 1. A step whose series are in time is one piece.
 * 2. A step in the variable of nonlinear_contact.inl (contacts with powers of the overlap) is no polynomial in time.  It is halved
 *    until interpolation at Chebyshev nodes is exact to rounding: near the start or end of the contact, t = 0, accelerations have
 *    terms of t^1.5, so the velocity error of a piece falls by 2^2.5 with every halving.
 * 3. A rigid impact is a jump of the velocity at the start of a piece. */
#include "engine/floor/floor_pieces.h"

#include <float.h>
#include <math.h>
#include <string.h>

enum {
	NODES = 16, /* of an interpolation */
	TAIL = 3,   /* last coefficients, which must be roundings */
	HALVINGS = 60,
	ROUNDS = 100, /* of the root search for a time; Newton's method, bisection if it leaves the bracket */
};

/* Interpolated series: the acceleration of both floors, and the contacts' part of the first floor's acceleration. */
enum { SERIES = POUND_CHAIN_OBSERVED + 1 };

/* cos(pi (2 k + 1)/32), k = 0 .. 7: the positive nodes; the others are their negatives */
static const double NODE[NODES / 2] = {
    0.9951847266721969, 0.9569403357322088,  0.881921264348355,  0.773010453362737,
    0.6343932841636455, 0.47139673682599764, 0.2902846772544624, 0.0980171403295606,
};

/* A segment of a chain's piece; s in [0, 1] is the variable of the piece's series. */
struct span {
	double from, upto; /* s */
	double start, end; /* time since the start of the chain's piece [s] */
};

static double series_at(const double *c, int order, double s)
{
	double sum = 0;
	for (int n = order; n >= 0; n--)
		sum = sum * s + c[n];
	return sum;
}

static double series_rate(const double *c, int order, double s)
{
	double sum = 0;
	for (int n = order; n > 0; n--)
		sum = sum * s + n * c[n];
	return sum;
}

/* Bound of a series over its step. */
static double series_size(const double *c, int order)
{
	double sum = 0;
	for (int n = 0; n <= order; n++)
		sum += fabs(c[n]);
	return sum;
}

/* The variable s at a given time, bracketed by low and high, to the rounding of the clock's series. */
static double share_at(const struct pound_chain_piece *chain, double time, double low, double high)
{
	const double rounding = DBL_EPSILON * series_size(chain->clock, chain->order);
	double s = 0.5 * (low + high);
	for (int round = 0; round < ROUNDS; round++) {
		const double late = series_at(chain->clock, chain->order, s) - time;
		if (fabs(late) <= rounding)
			break;
		*(late < 0 ? &low : &high) = s;
		const double rate = series_rate(chain->clock, chain->order, s);
		const double next = s - late / (rate > 0 ? rate : DBL_MIN);
		s = next > low && next < high ? next : 0.5 * (low + high);
	}
	return s;
}

static double node(int k)
{
	return k < NODES / 2 ? NODE[k] : -NODE[NODES - 1 - k];
}

static const double *series_of(const struct pound_chain_piece *chain, int k)
{
	return k < POUND_CHAIN_OBSERVED ? chain->floors[k].acceleration : chain->floors[0].push;
}

/* Values of all series at the nodes of a segment, from its end to its start. */
static void nodes_fill(const struct pound_chain_piece *chain, const struct span *span,
                       double value[SERIES][NODES])
{
	double high = span->upto;
	for (int j = 0; j < NODES; j++) {
		const double time = span->start + (span->end - span->start) * (0.5 + 0.5 * node(j));
		const double s = high = share_at(chain, time, span->from, high);
		for (int k = 0; k < SERIES; k++)
			value[k][j] = series_at(series_of(chain, k), chain->order, s);
	}
}

/* Coefficients of Chebyshev polynomials from values at the nodes.
 *
 *   c_j = 2/N sum_k f_k T_j(x_k), half of this for j = 0
 */
static void chebyshev_fill(const double value[NODES], double c[NODES])
{
	memset(c, 0, sizeof *c * NODES);
	for (int k = 0; k < NODES; k++) {
		double t = 1, next = node(k);
		for (int j = 0; j < NODES; j++) {
			c[j] += value[k] * t;
			const double after = 2 * node(k) * next - t;
			t = next;
			next = after;
		}
	}
	for (int j = 0; j < NODES; j++)
		c[j] *= (j ? 2.0 : 1.0) / NODES;
}

/* Coefficients of powers of the elapsed fraction x of the segment, by Clenshaw's recurrence for polynomials of 2 x - 1. */
static void powers_fill(const double chebyshev[NODES], struct pound_polynomial *a)
{
	double b[2][NODES + 1] = {{0}}; // b_j+1, b_j+2
	for (int j = NODES - 1; j >= 0; j--) {
		double now[NODES + 1] = {chebyshev[j]};
		const double twice = j ? 2 : 1;
		for (int n = 0; n < NODES; n++) {
			now[n] += -twice * b[0][n] - b[1][n];
			now[n + 1] += 2 * twice * b[0][n];
		}
		memcpy(b[1], b[0], sizeof b[0]);
		memcpy(b[0], now, sizeof b[0]);
	}
	memcpy(a->c, b[0], sizeof *a->c * NODES);
}

/* Whether the interpolation error is a rounding of the velocity: of its value, or of its change over the chain's piece. */
static bool resolved(const struct pound_chain_piece *chain, const struct span *span,
                     const double chebyshev[SERIES][NODES])
{
	bool all = true;
	for (int k = 0; k < SERIES && all; k++) {
		const double size = series_size(series_of(chain, k), chain->order);
		const double v = chain->floors[k < POUND_CHAIN_OBSERVED ? k : 0].v;
		const double rounding = 0.5 * DBL_EPSILON * (size * chain->length + fabs(v));
		for (int j = NODES - TAIL; j < NODES; j++)
			all &= fabs(chebyshev[k][j]) * (span->end - span->start) <= rounding;
	}
	return all;
}

/* The last piece is complete; a history takes it at once. */
static void piece_end(struct pound_floor_motion *motion)
{
	if (!motion->beside)
		return;
	motion->taker.take(motion->taker.into);
	motion->stretch->n = 0;
}

/* Sets the acceleration of both floors over a piece, and the contacts' part of it.
 *
 * Given    a  coefficients of each series
 */
static void piece_fill(struct pound_floor_motion *motion, struct pound_floor_piece *piece,
                       const struct pound_polynomial a[SERIES], int order)
{
	piece->floor = a[0];
	piece->push = a[SERIES - 1];
	piece->order = pound_floor_bound(&piece->floor, order);
	const int push = pound_floor_bound(&piece->push, order);
	piece->order = push > piece->order ? push : piece->order;
	if (motion->beside) {
		motion->beside->right = a[1];
		motion->beside->order = pound_floor_bound(&motion->beside->right, order);
	}
	piece_end(motion);
}

/* Adds a segment of a chain's piece whose time is a series of s, halved until it is a polynomial of time. */
static void span_add(struct pound_floor_motion *motion, const struct pound_chain_piece *chain,
                     const struct span *span, int halvings)
{
	double value[SERIES][NODES], chebyshev[SERIES][NODES];
	if (motion->status || pound_stopped(motion->stop) || !(span->end > span->start))
		return;
	nodes_fill(chain, span, value);
	for (int k = 0; k < SERIES; k++)
		chebyshev_fill(value[k], chebyshev[k]);
	if (halvings < HALVINGS && !resolved(chain, span, chebyshev)) {
		const double middle = 0.5 * (span->start + span->end);
		const double s = share_at(chain, middle, span->from, span->upto);
		span_add(motion, chain, &(struct span){span->from, s, span->start, middle}, halvings + 1);
		span_add(motion, chain, &(struct span){s, span->upto, middle, span->end}, halvings + 1);
		return;
	}
	struct pound_polynomial a[SERIES];
	for (int k = 0; k < SERIES; k++)
		powers_fill(chebyshev[k], &a[k]);
	struct pound_floor_piece *piece =
	    pound_floor_piece_add(motion, chain->time + span->start, span->end - span->start);
	if (motion->beside)
		motion->beside->ground = chain->ground + chain->slope * span->start;
	piece_fill(motion, piece, a, NODES - 1);
}

/* Given    motion  stretch, taker, stop and beside are set */
void pound_floor_start_chain(struct pound_floor_motion *motion)
{
	motion->status = POUND_OK;
	motion->sampled = motion->after_event = false;
	motion->jump = 0;
	motion->stretch->n = motion->stretch->n_maps = 0;
	motion->stretch->order = 0;
}

/* Makes the pieces of one step of a chain.
 *
 * Test     unit_chain_pieces
 */
void pound_floor_observe_chain(void *of, const struct pound_chain_piece *chain)
{
	struct pound_floor_motion *motion = of;
	struct pound_floor_beside *beside = motion->beside;
	if (motion->status || pound_stopped(motion->stop))
		return;
	motion->sampled |= chain->sampled;
	motion->after_event |= chain->after_event;
	motion->jump += chain->floors[0].jump;
	if (beside) {
		for (int o = 0; o < POUND_CHAIN_OBSERVED; o++)
			beside->u[o] = chain->floors[o].u, beside->v[o] = chain->floors[o].v;
		beside->ground = chain->ground, beside->slope = chain->slope;
		beside->overlap = chain->overlap, beside->overlap_rate = chain->overlap_rate;
		beside->touching = chain->touching;
	}
	if (chain->time_is_series) {
		span_add(motion, chain, &(struct span){0, 1, 0, chain->length}, 0);
		return;
	}
	struct pound_polynomial a[SERIES];
	for (int k = 0; k < SERIES; k++)
		memcpy(a[k].c, series_of(chain, k), sizeof *a[k].c * (size_t)(chain->order + 1));
	piece_fill(motion, pound_floor_piece_add(motion, chain->time, chain->length), a, chain->order);
}
