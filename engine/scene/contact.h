/* contact.h - contact models: the force between two bodies as branches, and the edges between them.
 *
 * As with constitutive laws, an integrator sees only the current branch.  On a branch the force has one form until the overlap p
 * leaves [low, high] or, if direction is not 0, its rate q becomes opposite to direction; at such an edge the integrator requests
 * the next branch.  A contact begins when p rises through 0 and ends when p falls to 0 (a branch with low = 0).  Without tension
 * only positive forces act.  Forces are divided by a mass that the caller chooses. */
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

/* a contact model and its parameters; parameters that the model does not read are 0 */
struct pound_contact_law {
	int model;                       /* row of the contact models */
	double stiffness;                /* K [N/m], with p^1.5 [N/m^1.5] */
	double dashpot;                  /* C [N s/m]; with p^0.25 [N s/m^1.25]; D of D q/v [-] */
	double second_stiffness;         /* K2 [N/m] */
	double yield_overlap;            /* p_y [m] */
	double restitution, speed_floor; /* eps [-], smallest v [m/s] */
	bool tension;                    /* the force may pull until the overlap ends */
};

struct pound_touch_branch {
	enum pound_touch_form form;
	double stiffness, damping,
	    offset;       /* K, c, f above; damping is c [N s/m], [N s/m^1.25], or in products [s/m] */
	double low, high; /* overlap [m]  0: the contact ends there; DBL_MAX: no edge */
	double direction; /* +1, -1: ends when the rate has the opposite sign; 0: any */
};

/* state of a contact on its model */
struct pound_touch {
	int branch;    /* number of the branch within the model */
	double memory; /* what the model remembers [m] */
	struct pound_touch_branch on;
};

/* what the parameters of a contact depend on besides the study */
struct pound_contact_place {
	double stiffness;    /* of the stiffer adjacent story or oscillator, over `mass` [N/m/kg] */
	double inverse_mass; /* mass over the effective mass of the two sides [-] */
	double mass;         /* divisor of all forces [kg]; 1: forces in N */
};

struct pound_contact_law pound_contact_law(const struct pound_contact *contact,
                                           const struct pound_contact_place *place);
void pound_contact_begin(const struct pound_contact_law *law, struct pound_touch *at, double rate);
void pound_contact_leave(const struct pound_contact_law *law, struct pound_touch *at, enum pound_edge edge,
                         double overlap);
/* Force of a branch at one overlap, linear in the rate q: force = still + rate q; slope: of `still` over the overlap. */
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
