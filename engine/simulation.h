/* simulation.h - one simulation of the march as it rests between its turns in the lanes.
 *
 * What changes in lanes stands in columns, so that whole ranges of them are carried in and out. */
#ifndef SIMULATION_H
#define SIMULATION_H

#include "engine/march.h"

enum {
	POUND_MAPS = 4, /* free-flight maps a body keeps */
};

/* Columns of a simulation: T is double at rest, and a vector in a group of lanes.  A group is loaded
 * and saved by ranges of columns: event steps from the first to map, flight from state to the end. */
#define COLUMNS(T)                                                                                 \
	/* constants of event steps */                                                                 \
	T contact_stiffness, contact_damping, mass_ratio, release, reach[2], can_fly, right_mass;      \
	/* changed by event steps; touching, parted, fresh (contact force exactly 0 now) are 0 or 1 */ \
	T p, q, left, slope, events, pace, touching, parted, fresh, impulse, impulse_max, contacts,    \
	    contact_time, work_in, work_out;                                                           \
	/* changed by both */                                                                          \
	T u[2], v[2], top[2], ground;                                                                  \
	/* read by both: the bodies, and the piece each is on */                                       \
	T step, gap, drive[2], damping[2], stiffness[2], offset[2], low[2], high[2], direction[2];     \
	/* map of each body over one sample, and what bounds its error */                              \
	T uu[2], uv[2], ua[2], ud[2], ea[2], ej[2], third, per_step;

struct column {
	COLUMNS(double)
};

enum {
	COLUMN_FIRST = 0,
	COLUMN_MOVED = offsetof(struct column, p) / sizeof(double),
	COLUMN_STATE = offsetof(struct column, u) / sizeof(double),
	COLUMN_READ = offsetof(struct column, gap) / sizeof(double),
	COLUMN_MAP = offsetof(struct column, uu) / sizeof(double),
	COLUMN_END = sizeof(struct column) / sizeof(double),
};

/* exact displacement of one body after one sample, from (u, v) and a forcing a at the start that grows by d */
struct map {
	double stiffness;      /* of the piece it belongs to; < 0: none */
	double uu, uv, ua, ud; /* the velocity follows: see flight_step in march.c */
	double ea, ej;         /* the cubic's error is at most ea |u''| + ej |u'''|, both at the start */
};

struct simulation {
	struct column x;
	int64_t next, last; /* sample at the end of this interval, and the last of the signal */
	const struct pound_march_task *task;
	struct pound_march_result *result;
	struct pound_branch at[2];
	struct map maps[2][POUND_MAPS];
	int map_next[2];
	bool edged;     /* a law has more than one piece */
	bool accounted; /* the energy balance is kept */
	bool paired;    /* the right body moves, or there is something to touch */
};

void pound_simulation_start(struct simulation *sim, const struct pound_march_task *task,
                            struct pound_march_result *result);
void pound_simulation_piece(struct simulation *sim, int i);
void pound_simulation_interval(struct simulation *sim);
double pound_simulation_residual(const struct simulation *sim);

#endif
