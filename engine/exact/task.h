/* task.h - the response of many pairs of oscillators, event by event, to rounding.
 *
 * A task is one scene under one ground motion, divided by masses; tasks do not touch each other. */
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
	double drive;   /* 1: rides on the ground motion, 0: stays where the ground is (a rigid wall) */
	double u, v;    /* at the start [m], [m/s] */
	bool followed;  /* its largest displacement is wanted */
};

/* An instant of a motion: where one interval ends and the next begins.  There is one at the start, at every sample of the
 * ground motion, at every event and at the end, in the order of time.  Between two of them no contact begins or ends, no body
 * leaves its branch, and the ground motion is a straight line. */
struct pound_instant_of_task {
	double time;    /* [s] */
	double elapsed; /* since the instant before, 0: it is the same one, and its state has changed [s] */
	bool sampled;   /* it is at a sample; false: an event */
	double u[POUND_OSCILLATORS], v[POUND_OSCILLATORS]; /* [m], [m/s] */
	// of the interval behind it
	bool touching;                           /* the contact's force acts */
	double overlap, overlap_rate;            /* while touching [m], [m/s] */
	double ground, slope;                    /* acceleration, and its growth [m/s2], [m/s3] */
	double stiffness[POUND_OSCILLATORS];     /* of the bodies' branches, per mass [1/s2] */
	double spring_offset[POUND_OSCILLATORS]; /* spring force at no displacement, per mass [m/s2] */
};

/* the observer of a task */
struct pound_task_observer {
	void (*observe)(void *into, const struct pound_instant_of_task *instant);
	void *into;
	// or NULL: it hears of every sample.  Where nothing touches it need not hear of those inside of which neither is larger than at a sample:
	double *
	    most; /* u_1 - u_2 and u_2 - u_1 at most so far, raised to those at the samples that are passed (2) [m] */
	void (*pass)(void *into, const struct pound_instant_of_task *instant,
	             int n); /* n of them, up to an instant */
};

struct pound_task {
	const double *ground; /* acceleration at the samples, linear between  [m/s2]  (n_samples) */
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
	struct pound_contact_law law;               /* over m1; read where the force is not linear */
	bool accounted;                             /* energy_residual is wanted */
	const struct pound_task_observer *observer; /* NULL: none */
};

struct pound_task_result {
	enum pound_status status;
	double displacement_max[POUND_OSCILLATORS]; /* [m]; NAN where it was not followed */
	double u[POUND_OSCILLATORS];                /* at the end [m] */
	double v[POUND_OSCILLATORS];                /* [m/s] */
	double impulse_max;                         /* largest integral of F/m1 over one contact [m/s] */
	double contact_time;                        /* [s] */
	int64_t contacts;
	// |kinetic + absorbed - put in| over the most along the way of what was put in and of kinetic energy; NAN: not accounted
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
