/* contact.h - contact models: the force between two bodies as branches, and the edges between them.
 *
 * An integrator sees only a branch, as it does of a law.  On it the force has one form until the overlap p leaves [low, high] or,
 * where direction is not 0, its rate q turns against direction; at such an edge it asks for the next.  A contact begins where p
 * rises through 0 and ends where p falls to 0, which a branch has as low = 0.  Without tension the force acts only while it is
 * above 0.  All numbers are per whatever mass the caller chose. */
#ifndef CONTACT_H
#define CONTACT_H

#include <stdbool.h>

#include "engine/pound.h"
#include "engine/scene/law.h"

/* the force of a branch over p and q */
enum pound_touch_form {
	POUND_TOUCH_STRAIGHT, /* K p + c q + f */
	POUND_TOUCH_PRODUCT,  /* K p (1 + c q) */
	POUND_TOUCH_POWER,    /* K p^1.5 (1 + c q) */
	POUND_TOUCH_ROOT,     /* K p^1.5 + c p^0.25 q */
};

/* a contact model and its numbers; those that the model does not read are 0 */
struct pound_contact_law {
	int model;                       /* row of the contact models */
	double stiffness;                /* K [N/m], of powers [N/m^1.5] */
	double dashpot;                  /* C [N s/m]; of p^0.25 [N s/m^1.25]; D of D q/v [-] */
	double second_stiffness;         /* K2 [N/m] */
	double yield_overlap;            /* p_y [m] */
	double restitution, speed_floor; /* eps [-], least v [m/s] */
	bool tension;                    /* the force may pull until the overlap ends */
};

struct pound_touch_branch {
	enum pound_touch_form form;
	double stiffness, damping,
	    offset;       /* K, c, f above; damping is c [N s/m], [N s/m^1.25], or of products [s/m] */
	double low, high; /* overlap [m]  0: the contact ends there; DBL_MAX: no edge */
	double direction; /* +1, -1: ends when the rate turns against it; 0: does not */
};

/* where on its model a contact is */
struct pound_touch {
	int branch;    /* the model's own number of it */
	double memory; /* what the model remembers [m] */
	struct pound_touch_branch on;
};

/* what a contact model's numbers are made of beside the study's */
struct pound_contact_place {
	double
	    stiffness; /* the larger one of the stories or oscillators beside the contact, over `mass` [N/m/kg] */
	double inverse_mass; /* mass over the effective mass of the two sides [-] */
	double mass;         /* that forces are divided by [kg]; 1: they are not */
};

struct pound_contact_law pound_contact_law(const struct pound_contact *contact,
                                           const struct pound_contact_place *place);
void pound_contact_begin(const struct pound_contact_law *law, struct pound_touch *at, double rate);
void pound_contact_leave(const struct pound_contact_law *law, struct pound_touch *at, enum pound_edge edge,
                         double overlap);
/* Force of a branch over the rate at one overlap, and its slope over the overlap: force = still + rate q. */
struct pound_touch_line {
	double still, rate, slope;
};

struct pound_touch_line pound_contact_line(const struct pound_touch_branch *on, double overlap);
double pound_contact_force_on(const struct pound_touch_branch *on, double overlap, double rate);

void pound_contact_follow(const struct pound_contact_law *law, struct pound_touch *at, double from,
                          double to);

/* Dashpot of a contact model, dimensionless: z, x or D of its row, from the restitution coefficient in [0, 1]. */
double pound_contact_damping_ratio(int model, double restitution);

#endif
