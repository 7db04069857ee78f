/* adaptive.h - internal interface of the adaptive solver: floors and contacts, their equations, and the events that end steps.
 * For adaptive.c, adaptive_motion.c and adaptive_guards.c.
 *
 * States of floor i: drift of the story below it [m] and its rate [m/s].  States of contact k: overlap [m], its rate [m/s], and
 * the impulse since the contact began.  A pair is two one-story buildings; its forces and impulses are per left mass. */
#ifndef ADAPTIVE_H
#define ADAPTIVE_H

#include <gsl/gsl_odeiv2.h>

#include "engine/exact/counts.h"
#include "engine/solver/solver.h"

enum { POUND_FLOOR_STATES = 2, POUND_LINK_STATES = 3, POUND_LINK_ENDS = 4 };

/* A floor and the story below it; quantities are per mass of the floor unless stated otherwise. */
struct adaptive_floor {
	const struct pound_backbone *story; /* as forces (rows) or forces per mass (pairs) */
	double per_mass;                    /* acceleration per unit of the story's force */
	double damping, mass_damping;       /* story dashpot, and damping proportional to mass [1/s] */
	const double *modal;                /* as in pound_chain_floor; NULL: none */
	double above;        /* mass of the floor above over the mass of this floor; 0: no floor above */
	double inverse_mass; /* acceleration per unit of contact force */
	double drive;        /* 1: driven by the ground acceleration, 0: fixed to the ground (a rigid wall) */
	bool inner;          /* there is a floor below */
	int base, storeys;   /* lowest floor of the building, and number of its floors */
	struct pound_law_state at;
	double u, v; /* drift and its rate at the start [m], [m/s] */
};

struct adaptive_link {
	struct pound_contact_law law;
	bool meets; /* false: a pair without contact */
	double gap;
	int n_ends, floor[POUND_LINK_ENDS];
	double weight[POUND_LINK_ENDS]; /* right side: < 0 */
	double drive;                   /* overlap acceleration per ground acceleration */
	double inverse_mass;            /* 1 over the effective mass of both sides */
	double impulse_unit;            /* impulse per velocity change, for the error control */
	struct pound_touch touch;       /* while touching: branch of the force */
	bool touching, parted;          /* parted: overlapping without force */
	bool held;                      /* rigid contact: both sides move together */
	double release;      /* C/K if the contact ends at zero force [s]; 0: it ends at zero overlap */
	double counted_time; /* of contacts that count [s] */
	double time;         /* in contact [s] */
	struct pound_counts_scale scale;
	double touch_steps; /* steps of the current contact */
	double *measures;   /* result  (POUND_LINK_MEASURES) */
};

/* A scene in an interval between two samples of the ground motion. */
struct adaptive_scene {
	int n, n_links, n_states;
	struct adaptive_floor *floors;
	struct adaptive_link *links;
	double ground, slope; /* ground acceleration in the interval: ground + slope t */
	double *still, *push; /* accelerations of floors from stories and damping, and from contacts  (n) */
	double *row;          /* work space for a row of the Jacobian  (n_states) */
};

/* Events that end a step.  Reversals come first: in a step without reversals all other guards change their sign at most once. */
enum kind {
	TURN,         /* the drift rate of a story changes sign */
	TURN_OVERLAP, /* the overlap rate of a contact changes sign */
	TURN_FORCE,   /* the rate of a contact force changes sign */
	TURN_FLOOR,   /* the velocity of a floor changes sign */
	TURNS,
	LOW = TURNS, /* the drift of a story leaves its branch downwards */
	HIGH,        /* ... upwards */
	CONTACT,     /* a contact begins or ends */
	CLEARS,      /* an overlap without force ends */
	TOUCH_LOW,   /* the overlap of a contact leaves the branch of the force downwards */
	TOUCH_HIGH,  /* ... upwards */
	KINDS
};

struct guard {
	enum kind kind;
	int of;     /* index of the story, floor or contact */
	double way; /* of a reversal: sign of the rate when a step begins; 0: the reversal is no event */
};

struct adaptive_task {
	struct adaptive_scene scene;
	const double *samples;
	int n_samples;
	double time_step;
	enum pound_status status;
	double *floor_measures;
	bool many; /* a row, with many modes: a reversal ends a step only if pound_adaptive_turn_matters */
	int n_guards, n_turns;
	struct guard *guards; /* (n_guards) */
	double start, t;      /* start of the interval; time since then [s] */
	double *y, *end, *middle, *turned, *at_start, *at_end, *scale; /* (n_states) */
	gsl_odeiv2_system system;
	gsl_odeiv2_driver *explicit, *implicit; /* implicit NULL: too many states */
	int steps;                              /* since the start of the interval or the last event */
	int events; /* since the start of the interval, without reversals that end no branch */
};

/* The rate whose reversal a guard detects (of a drift, displacement, overlap, or contact force over stiffness), and the time
 * derivative of that rate. */
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
