/* adaptive.h - the inside of the adaptive solver: floors and contacts, and their equations.  For adaptive.c and
 * adaptive_motion.c.
 *
 * State i of floor i is the drift of the story below it and the drift's rate; of contact k its overlap, the overlap's rate and the
 * impulse so far.  A pair is two floors that both stand on the ground. */
#ifndef ADAPTIVE_H
#define ADAPTIVE_H

#include <gsl/gsl_odeiv2.h>

#include "engine/exact/counts.h"
#include "engine/solver/solver.h"

enum { POUND_FLOOR_STATES = 2, POUND_LINK_STATES = 3, POUND_LINK_ENDS = 4 };

/* A floor and the story below it; what has no other unit is over its own mass. */
struct adaptive_floor {
	const struct pound_backbone *story; /* of forces, or of forces over masses */
	double per_mass;                    /* that these are multiplied by */
	double damping, mass_damping;       /* of the story's dashpot, and by mass [1/s] */
	const double *modal;                /* of pound_chain_floor; NULL: none */
	double above;                       /* mass of the floor above it over its own; 0: no floor is above it */
	double inverse_mass;                /* of the unit of contact forces */
	double drive;                       /* 1: rides on the ground motion, 0: stays where the ground is */
	bool inner;                         /* there is a floor below it */
	int base, storeys;                  /* first floor of its building, and how many that has */
	struct pound_law_state at;
	double u, v; /* drift and its rate at the start [m], [m/s] */
};

struct adaptive_link {
	struct pound_contact_law law;
	bool meets; /* false: the sides never touch */
	double gap;
	int n_ends, floor[POUND_LINK_ENDS];
	double weight[POUND_LINK_ENDS]; /* right side: < 0 */
	double drive;                   /* of the overlap by the ground */
	double inverse_mass;            /* over the effective mass */
	double impulse_unit;            /* of an impulse that changes velocities by one */
	struct pound_touch touch;       /* while touching: branch of the force */
	bool touching, parted;          /* parted: overlapping without force */
	bool held;                      /* touching, rigid: both velocities stay the same */
	double release;                 /* C/K where contact ends at zero force [s], 0: it ends at zero overlap */
	double counted_time;
	double time;
	struct pound_counts_scale scale;
	double touch_steps; /* of the current contact */
	double *measures;
};

/* A scene under its ground motion, in an interval between two samples. */
struct adaptive_scene {
	int n, n_links, n_states;
	struct adaptive_floor *floors;
	struct adaptive_link *links;
	double ground, slope; /* acceleration in the interval: ground + slope t */
	double *still, *push; /* of floors: accelerations without ground and contact, and by contacts  (n) */
	double *row;          /* (n_states) */
};

/* What ends a step, of a story, floor or contact; turns first, for they make the others change their sign once at most. */
enum kind {
	TURN,
	TURN_OVERLAP,
	TURN_FORCE,
	TURN_FLOOR,
	TURNS,
	LOW = TURNS,
	HIGH,
	CONTACT,
	CLEARS,
	TOUCH_LOW,
	TOUCH_HIGH,
	KINDS
};

struct guard {
	enum kind kind;
	int of;     /* index of its story, floor or contact */
	double way; /* of a turn: sign of the rate when a step begins; 0: it may turn */
};

struct adaptive_task {
	struct adaptive_scene scene;
	const double *samples;
	int n_samples;
	double time_step;
	enum pound_status status;
	double *floor_measures;
	bool many; /* modes: a turn ends a step only where it may matter */
	int n_guards, n_turns;
	struct guard *guards;                                          /* (n_guards) */
	double start, t;                                               /* of the interval; since then [s] */
	double *y, *end, *middle, *turned, *at_start, *at_end, *scale; /* (n_states) */
	gsl_odeiv2_system system;
	gsl_odeiv2_driver *explicit, *implicit; /* implicit NULL: too many states */
	int steps;                              /* since the interval began, or the last event */
	int events;                             /* since the interval began, without turns that change nothing */
};

/* What a guard of a turn looks at, the rate of a drift, of a displacement, of the overlap or of the contact's force per stiffness,
 * and how fast that changes. */
struct rate {
	double value, change;
};

static inline int drift_state(int i)
{
	return POUND_FLOOR_STATES * i;
}
static inline int rate_state(int i)
{
	return POUND_FLOOR_STATES * i + 1;
}
static inline int overlap_state(const struct adaptive_scene *s, int k)
{
	return POUND_FLOOR_STATES * s->n + POUND_LINK_STATES * k;
}

void pound_adaptive_lay_row(struct adaptive_scene *s, const struct pound_chain_task *task);
void pound_adaptive_lay_pair(struct adaptive_scene *s, const struct pound_task *task);
double pound_adaptive_velocity(const struct adaptive_scene *s, int i, const double *y);
double pound_adaptive_apart(const struct adaptive_scene *s, int k, double t, const double *y);
int pound_adaptive_derivative(double t, const double *y, double *dydt, void *of);
int pound_adaptive_jacobian(double t, const double *y, double *dfdy, double *dfdt, void *of);
double pound_adaptive_jerk(const struct adaptive_scene *s, int k, const double *y, const double *dydt);

/* adaptive_guards.c */
struct rate pound_adaptive_rate(const struct adaptive_task *c, const struct guard *g, const double *y,
                                const double *dydt);
double pound_adaptive_guard(const struct adaptive_task *c, const struct guard *g, double t, const double *y);
void pound_adaptive_ways(struct adaptive_task *c);
bool pound_adaptive_turn_ends(const struct adaptive_task *c, const struct guard *g);
double pound_adaptive_hump(const double g[2], const double d[2]);
bool pound_adaptive_turn_matters(const struct adaptive_task *c, const struct guard *g, double h,
                                 const double *y);
void pound_adaptive_guards_lay(struct adaptive_task *c, unsigned asked);

#endif
