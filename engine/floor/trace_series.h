/* trace_series.h - the motion of a trace over one step, as power series in time. */
#ifndef TRACE_SERIES_H
#define TRACE_SERIES_H

#include "engine/exact/tolerances.h"
#include "engine/floor/trace.h"

static const double POUND_NOTHING_BESIDE = 0x1p-48; /* of the largest acceleration */
static const double POUND_TRACE_REACH = 1.5;        /* largest rate * step of a series */

/* Derivatives by the share of the step that is gone, times 1/n! the coefficients of powers of it. */
struct pound_trace_series {
	int order;
	bool whole; /* it goes to the next sample */
	double step;
	// of left, right and overlap; those of their velocities are one further on
	double y[3][POUND_TRACE_ORDER + 2];
	// of the floor's acceleration but for its piece's offset, and of the contact's part of it, times the step squared
	double floor[POUND_TRACE_ORDER + 1], push[POUND_TRACE_ORDER + 1];
};

/* What of the overlap's rate its force has beside the overlap [s], where contact ends with the force; 0: with the overlap. */
static inline double pound_trace_release(const struct pound_march_task *task)
{
	return task->tension ? 0 : task->contact_damping / task->contact_stiffness;
}

/* Order of the series of a step by rate * step. */
int pound_trace_order(double x);

/* The motion from where a trace is. */
void pound_trace_series(struct pound_trace_series *s, const struct pound_trace *t);

#endif
