/* floor.h - the spectra and the history of one floor under one task. */
#ifndef FLOOR_H
#define FLOOR_H

#include "engine/floor/oscillator_bank.h"
#include "engine/pound.h"

struct pound_floor; /* work space of one worker */

enum { POUND_FLOORS = 16 }; /* tasks integrated at once */

size_t pound_floor_bytes(int n_frequencies);
struct pound_floor *pound_floor_init(void *memory,
                                     const struct pound_spectrum *spectrum); /* 64-byte aligned */

/* a floor of a chain */
struct pound_floor_of_chain {
	const struct pound_chain_task *task;
	int floor;
	struct pound_chain_result *result; /* space for its measures */
};

/* The contact between this floor and a level of the right neighbor; -1: none. */
int pound_floor_contact(const struct pound_floor_of_chain *chain);

/* request for one task: the left body of a pair, or a floor of a chain */
struct pound_floor_ask {
	const struct pound_task *task;
	struct pound_floor_of_chain chain; /* its task NULL: a pair */
	int n_drives;                      /* 1: the floor's acceleration; 2: also the contact's part of it */
	double radians;                    /* longest step of an oscillator, as its phase [rad], at most 1.5 */
	int lanes;                         /* 0: the widest of this processor */
	const atomic_bool *stop;           /* polled throughout; NULL: none */
	void *scratch; /* POUND_EXACT_SCRATCH bytes, for a chain as its solver needs; 64-byte aligned */
};

/* results; psa: [m/s2]  (n_frequencies) each */
struct pound_floor_answer {
	enum pound_status status;
	double *psa[POUND_DRIVES];
	// of a pair
	double impulse_max; /* over the left mass [m/s] */
	int64_t contacts;
};

enum pound_status pound_floor_spectra(struct pound_floor *floor, const struct pound_floor_ask *asks,
                                      struct pound_floor_answer *answers, int n);

/* State at one time of both bodies: left, right; in a chain of the floor and of the level opposite its contact.  Without a contact
 * this level and the gap are 0. */
struct pound_floor_instant {
	double time;                                       /* [s] */
	double u[POUND_OSCILLATORS], v[POUND_OSCILLATORS]; /* relative to the ground [m], [m/s] */
	double acceleration[POUND_OSCILLATORS];            /* absolute [m/s2] */
	double gap, gap_rate;                              /* clear distance, < 0: overlap [m], [m/s] */
	double ground;                                     /* acceleration [m/s2] */
	double
	    push; /* force of the contact (without one: of all contacts on the floor) over the left mass; < 0: repulsion [m/s2] */
};

/* Calls `take` for every row of a task's history: at the samples, before and after every event, and between them as often as
 * linear interpolation between rows needs. */
typedef void pound_floor_take(void *into, const struct pound_floor_instant *instant);
enum pound_status pound_floor_history(struct pound_floor *floor, const struct pound_floor_ask *ask,
                                      pound_floor_take *take, void *into);

#endif
