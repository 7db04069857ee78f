/* request_keys.c - keys of numbers that identify ground motions and runs: equal keys are the same motion or run. */
#include "engine/run/request_keys.h"

#include <string.h>

#include "engine/numeric/hash.h"

void pound_keys_clear(struct pound_keys *keys)
{
	keys->n = 0;
	memset(keys->slots, -1, sizeof(int) * (size_t)keys->n_slots);
}

/* Number of a key; a new one gets the next number. */
static int number_of(struct pound_keys *r, const double key[static POUND_KEY])
{
	int slot = pound_hash_slot(0, key, POUND_KEY, r->n_slots);
	for (; r->slots[slot] >= 0; slot = (slot + 1) & (r->n_slots - 1))
		if (memcmp(&r->keys[POUND_KEY * r->slots[slot]], key, sizeof(double) * POUND_KEY) == 0)
			return r->slots[slot];
	memcpy(&r->keys[POUND_KEY * r->n], key, sizeof(double) * POUND_KEY);
	return r->slots[slot] = r->n++;
}

/* Number of a ground motion: its excitation, and the noise of its row and signal, if random. */
int pound_keys_motion(struct pound_keys *keys, const struct pound_excitation *e, struct pound_stream noise,
                      bool halved)
{
	const double key[POUND_KEY] = {e->type,      e->frequency_hz, e->damping_ratio, e->high_pass_ratio,
	                               e->cycles,    e->duration,     e->rise,          e->fall,
	                               e->time_step, e->peak,         noise.row,        noise.sample,
	                               noise.signal, halved,          e->factor,        e->number};
	return number_of(keys, key);
}

enum { LAW_KEY = 15 }; /* numbers before the bodies: motion, options and contact */

/* Number of a run: a task under a motion. */
int pound_keys_run(struct pound_keys *keys, int motion, const struct pound_task *task)
{
	double key[POUND_KEY] = {motion,
	                         task->contact + 2.0 * task->accounted + 4.0 * (task->observer != NULL),
	                         task->gap,
	                         task->contact_stiffness,
	                         task->contact_damping,
	                         task->mass_ratio,
	                         task->tension,
	                         task->contact ? task->force : 0,
	                         task->law.model,
	                         task->law.stiffness,
	                         task->law.dashpot,
	                         task->law.second_stiffness,
	                         task->law.yield_overlap,
	                         task->force == POUND_FORCE_IMPACT ? task->law.restitution : 0,
	                         task->law.speed_floor};
	for (int i = 0; i < POUND_OSCILLATORS; i++) {
		const struct pound_task_body *b = &task->bodies[i];
		double *k = &key[LAW_KEY + 6 * i];
		k[0] = b->backbone.law, k[1] = b->backbone.stiffness, k[2] = b->backbone.hardening,
		k[3] = b->backbone.yield;
		k[4] = b->damping, k[5] = b->drive;
	}
	return number_of(keys, key);
}
