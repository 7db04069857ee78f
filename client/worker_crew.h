/* worker_crew.h - threads that run the blocks of a coordinator's studies. */
#ifndef WORKER_CREW_H
#define WORKER_CREW_H

#include <stdbool.h>

#include "schema/message/message.h"

struct worker_crew;

/* Takes an answer, DESIGN or VALUES, whose body lives until it returns; in any thread, one at a time. */
typedef void worker_answer(void *to, const struct message *message, const void *body);

int worker_threads(void); /* as many as this process may use cores */
struct worker_crew *worker_crew_start(int n_threads, worker_answer *answer,
                                      void *to); /* NULL: no memory or threads */
/* Does what a message of the coordinator says; takes the body, which is on the heap.  false: it makes no sense. */
bool worker_crew_take(struct worker_crew *crew, const struct message *message, char *body);
/* Doubles of the largest block of a study whose design was answered. */
size_t worker_crew_values_most(struct worker_crew *crew, uint64_t study);
void worker_crew_stop(struct worker_crew *crew); /* outstanding blocks return POUND_STOPPED */
bool worker_crew_idle(struct worker_crew *crew); /* after that: all of them were answered */

/* Connects as POUND_WORKER says and greets; ends the program when that is not possible. */
int worker_connect(int n_threads);
/* Threads as `--threads N` says, or worker_threads(); ends the program on wrong usage. */
int worker_options(int argc, char **argv);

#endif
