/* chain_pieces.c - the motion of a floor of a chain, step by step from the exact solver, as pieces.
 *
 * 1. A step in time is a piece as it is.
 * 2. A step in the variable of nonlinear_contact.inl, in which a contact has powers of its overlap, is no polynomial in time.  It is halved
 *    until the interpolation at Chebyshev's nodes is one to rounding: near where the contact begins or ends, at t = 0,
 *    accelerations have terms of t^1.5, so that what a piece misses fades by 2^2.5 with every halving.
 * 3. A rigid impact is a jump of the velocity at the start of a piece. */
#include "engine/floor/floor_pieces.h"

#include <float.h>
#include <math.h>
#include <string.h>

enum {
	NODES = 16, /* of an interpolation */
	TAIL = 3,   /* last coefficients that are looked at */
	HALVINGS = 60,
	ROUNDS = 100, /* of the root search for a time; Newton's method, halving where it leaves the bracket */
};

/* What is interpolated: the acceleration of both floors, and the contacts' part of that of the first. */
enum { SERIES = POUND_CHAIN_OBSERVED + 1 };

/* cos(pi (2 k + 1)/32), k = 0 .. 7: the nodes, and by symmetry all that their polynomials have there */
static const double NODE[NODES / 2] = {
    0.9951847266721969, 0.9569403357322088,  0.881921264348355,  0.773010453362737,
    0.6343932841636455, 0.47139673682599764, 0.2902846772544624, 0.0980171403295606,
};

/* A part of a chain's piece, by the shares s of that. */
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

/* Largest magnitude that a series can have in its step. */
static double series_size(const double *c, int order)
{
	double sum = 0;
	for (int n = 0; n <= order; n++)
		sum += fabs(c[n]);
	return sum;
}

/* The share s at which a time is, between two that hold it, to the rounding of the clock. */
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

/* Values of all series at the nodes of a part, from its end to its start. */
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
 *   c_j = 2/N sum_k f_k T_j(x_k), half of that for j = 0
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

/* Coefficients of powers of the share of the part, by Clenshaw's recurrence for polynomials of 2 x - 1. */
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

/* Whether what an interpolation misses is a rounding of the velocity: of what it is, or of what the whole piece gives it. */
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

/* The last of the pieces is whole. */
static void piece_end(struct pound_floor_motion *motion)
{
	if (!motion->beside)
		return;
	motion->taker.take(motion->taker.into);
	motion->stretch->n = 0;
}

/* Sets the acceleration of both floors over a piece, and the contacts' part of it.
 *
 * Given    polynomials  of SERIES, their coefficients
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

/* Adds a part of a chain's piece whose time is a series of s, in halves where it is no polynomial of time yet. */
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

/* Makes the pieces of a step of a chain.
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
