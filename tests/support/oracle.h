/* oracle.h - the response of a scene by a plain fixed-step integrator, as a reference for the engine.
 *
 * Written from the model alone and never linked into the product.  SI units; calls may run in any thread. */
#ifndef ORACLE_H
#define ORACLE_H

#include "engine/pound.h"

#define X(member, name, oscillator) +1
enum { ORACLE_CONTACTS_MAX = 512, ORACLE_MEASURES = 0 POUND_MEASURES(X) };
#undef X

struct oracle_motion {
	double time_step;           /* between samples [s]  > 0 */
	int n;                      /* samples  >= 2 */
	const double *acceleration; /* of the ground, linear between samples [m/s2]  (n) */
};

struct oracle_method {
	double radians; /* step times the angular frequency of the stiffest free or touching pair  > 0 */
	bool located;   /* steps are bisected to end where a branch, a velocity or the contact changes */
};

struct oracle_start {
	double u1, v1, u2, v2; /* [m], [m/s] */
};

struct oracle_contact {
	double start, duration; /* [s] */
	double speed;           /* of approach when it starts [m/s] */
	double departure;       /* relative speed when it ends, > 0: separating [m/s] */
	double impulse;         /* [N s] */
};

struct oracle_trace {
	int n_contacts;
	struct oracle_contact contacts[ORACLE_CONTACTS_MAX]; /* (n_contacts), the first ones */
};

/* A law's force and its state variables, for quasi-static paths. */
struct oracle_law {
	int row;               /* of oracle_law.c's table */
	long double k, k2;     /* slopes [N/m] */
	long double yield;     /* [m] */
	long double memory[2]; /* [m] */
};

struct oracle_law oracle_law(const char *name, long double k, double hardening_ratio, double yield);
long double oracle_law_force(const struct oracle_law *law, long double u);
void oracle_law_settle(struct oracle_law *law, long double u);
int oracle_law_branch(const struct oracle_law *law, long double u, long double v);

/* start and trace may be NULL: at rest, no trace. */
struct pound_response oracle_response(const struct pound_scene *scene, const struct oracle_motion *motion,
                                      const struct oracle_method *method, const struct oracle_start *start,
                                      struct oracle_trace *trace);

/* Names and values of a response in the order of POUND_MEASURES. */
const char *oracle_measure_name(int measure);
double oracle_measure(const struct pound_response *response, int measure);

#endif
