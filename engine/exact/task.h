/* task.h - interface of the exact solver: the response of many pairs of oscillators, accurate to rounding.
 *
 * A task is one scene under one ground motion, with all quantities per mass; tasks are independent of each other. */
#ifndef TASK_H
#define TASK_H

#include <stdatomic.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "engine/numeric/stop.h"
#include "engine/pound.h"
#include "engine/scene/contact.h"
#include "engine/scene/law.h"

struct pound_task_body {
	struct pound_backbone backbone;
	double damping; /* c/m [1/s] */
	double drive;   /* 1: driven by the ground acceleration, 0: fixed to the ground (a rigid wall) */
	double u, v;    /* at the start [m], [m/s] */
	bool followed;  /* its largest displacement is requested */
};

/* An instant of a motion, where one interval ends and the next begins: the start, every sample of the ground motion, every event
 * and the end, in the order of time.  Between two instants no contact begins or ends, no body leaves its branch, and the
 * ground acceleration is linear in time. */
struct pound_instant_of_task {
	double time;    /* [s] */
	double elapsed; /* since the previous instant; 0: same time, changed state [s] */
	bool sampled;   /* at a sample; false: at an event */
	double u[POUND_OSCILLATORS], v[POUND_OSCILLATORS]; /* [m], [m/s] */
	// the interval that follows
	bool touching;                           /* the contact's force acts */
	double overlap, overlap_rate;            /* while touching [m], [m/s] */
	double ground, slope;                    /* ground acceleration and its rate [m/s2], [m/s3] */
	double stiffness[POUND_OSCILLATORS];     /* of the bodies' branches, per mass [1/s2] */
	double spring_offset[POUND_OSCILLATORS]; /* spring force at u = 0, per mass [m/s2] */
};

/* the observer of a task */
struct pound_task_observer {
	void (*observe)(void *into, const struct pound_instant_of_task *instant);
	void *into;
	// NULL: every sample is reported.  Else, while separated, samples inside of which neither maximum can be exceeded are only passed:
	double *
	    most; /* largest u_1 - u_2 and u_2 - u_1 so far; raised to the values at the samples that are passed (2) [m] */
	void (*pass)(void *into, const struct pound_instant_of_task *instant,
	             int n); /* n samples were passed, the last one at the instant */
};

struct pound_task {
	const double *ground; /* acceleration at the samples, linear in between  [m/s2]  (n_samples) */
	int n_samples;        /* >= 2 */
	double time_step;     /* [s] */
	struct pound_task_body bodies[POUND_OSCILLATORS];
	bool contact;                               /* false: the bodies never meet */
	enum pound_force force;                     /* form of the contact force */
	double gap;                                 /* [m] */
	double contact_stiffness;                   /* K/m1 [1/s2] */
	double contact_damping;                     /* C/m1 [1/s] */
	double mass_ratio;                          /* m1/m2, 0: the right body is a wall */
	bool tension;                               /* contact ends at zero overlap; false: at zero force */
	struct pound_contact_law law;               /* over m1; used only if the force is not linear */
	bool accounted;                             /* energy_residual is requested */
	const struct pound_task_observer *observer; /* NULL: none */
};

struct pound_task_result {
	enum pound_status status;
	double displacement_max[POUND_OSCILLATORS]; /* largest |u| [m]; NAN: not requested */
	double u[POUND_OSCILLATORS];                /* at the end [m] */
	double v[POUND_OSCILLATORS];                /* [m/s] */
	double impulse_max;                         /* largest integral of F/m1 over one contact [m/s] */
	double contact_time;                        /* [s] */
	int64_t contacts;
	// |kinetic + absorbed - input| energy over the largest input or kinetic energy of the motion; NAN: not requested
	double energy_residual;
	double first_contact,
	    first_speed; /* time [s] and approach speed [m/s] of the first contact; 0, 0: none */
};

enum { POUND_EXACT_SCRATCH = 1 << 23 }; /* bytes of work space, 64-byte aligned */

bool pound_exact_lanes(int lanes, const struct pound_task *tasks, struct pound_task_result *results, int n,
                       void *scratch, const atomic_bool *stop);

/* exact.inl, compiled once for each */
void pound_exact_w8(const struct pound_task *tasks, struct pound_task_result *results, int n, void *scratch,
                    const atomic_bool *stop);
void pound_exact_w4(const struct pound_task *tasks, struct pound_task_result *results, int n, void *scratch,
                    const atomic_bool *stop);
void pound_exact_w1(const struct pound_task *tasks, struct pound_task_result *results, int n, void *scratch,
                    const atomic_bool *stop);
void pound_exact_portable(const struct pound_task *tasks, struct pound_task_result *results, int n,
                          void *scratch, const atomic_bool *stop);

#endif
