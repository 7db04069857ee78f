/* floor.h - the spectra and the history of one floor under one task. */
#ifndef FLOOR_H
#define FLOOR_H

#include "engine/floor/oscillator_bank.h"
#include "engine/pound.h"

struct pound_floor; /* work space of one worker */

enum { POUND_FLOORS = 16 }; /* tasks that are followed at once */

size_t pound_floor_bytes(int n_frequencies);
struct pound_floor *pound_floor_init(void *memory,
                                     const struct pound_spectrum *spectrum); /* 64-byte aligned */

/* a floor of a chain */
struct pound_floor_of_chain {
	const struct pound_chain_task *task;
	int floor;
	struct pound_chain_result *result; /* room for its measures */
};

/* The contact between this floor and a level of the right neighbor; -1: it has none. */
int pound_floor_contact(const struct pound_floor_of_chain *chain);

/* what is asked of one task: of the left body of a pair, or of a floor of a chain */
struct pound_floor_ask {
	const struct pound_task *task;
	struct pound_floor_of_chain chain; /* its task NULL: none */
	int n_drives;                      /* 1: the whole acceleration; 2: the contact's part of it too */
	double radians;                    /* an oscillator's longest step, at most 1.5 */
	int lanes;                         /* 0: the widest there are */
	const atomic_bool *stop;           /* looked at throughout; NULL: never */
	void *scratch; /* POUND_EXACT_SCRATCH bytes, of a chain those of its march; 64-byte aligned */
};

/* what comes out; psa: [m/s2]  (n_frequencies) each */
struct pound_floor_answer {
	enum pound_status status;
	double *psa[POUND_DRIVES];
	// of a pair
	double impulse_max; /* over the left mass [m/s] */
	int64_t contacts;
};

enum pound_status pound_floor_spectra(struct pound_floor *floor, const struct pound_floor_ask *asks,
                                      struct pound_floor_answer *answers, int n);

/* Both bodies at one time: left, right; of a chain the floor and the level of its contact, without a contact 0 for that level and
 * of the gap. */
struct pound_floor_instant {
	double time;                                       /* [s] */
	double u[POUND_OSCILLATORS], v[POUND_OSCILLATORS]; /* relative to the ground [m], [m/s] */
	double acceleration[POUND_OSCILLATORS];            /* absolute [m/s2] */
	double gap, gap_rate;                              /* clear distance, < 0: overlap [m], [m/s] */
	double ground;                                     /* acceleration [m/s2] */
	double
	    push; /* of the contact, without one of all on the floor: force over the left mass, < 0 pushes away [m/s2] */
};

/* Hands every row of a task's history to `take`: at the samples, on both sides of every event, and between them as often as
 * straight lines between rows need. */
typedef void pound_floor_take(void *into, const struct pound_floor_instant *instant);
enum pound_status pound_floor_history(struct pound_floor *floor, const struct pound_floor_ask *ask,
                                      pound_floor_take *take, void *into);

#endif
