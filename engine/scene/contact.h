/* contact.h - contact models. */
#ifndef CONTACT_H
#define CONTACT_H

/* Damping of a contact model over its critical damping, from the restitution coefficient in [0, 1]. */
double pound_contact_damping_ratio(int model, double restitution);

#endif
