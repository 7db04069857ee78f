/* thread_pool.h - threads that run the blocks of a coordinator's studies. */
#ifndef THREAD_POOL_H
#define THREAD_POOL_H

#include <stdbool.h>

#include "schema/message/message.h"

struct thread_pool;

/* Receives an answer, DESIGN or VALUES; its body is valid during the call; in any thread, one at a time. */
typedef void worker_answer(void *to, const struct message *message, const void *body);

struct thread_pool *thread_pool_start(int n_threads, worker_answer *answer,
                                      void *to); /* NULL: no memory or threads */
/* Executes a message of the coordinator; takes over the body, which is on the heap.  false: the message is invalid. */
bool thread_pool_take(struct thread_pool *pool, const struct message *message, char *body);
/* Doubles of the largest block of a study whose design was answered. */
size_t thread_pool_values_most(struct thread_pool *pool, uint64_t study);
void thread_pool_stop(struct thread_pool *pool); /* outstanding blocks return POUND_STOPPED */
bool thread_pool_idle(struct thread_pool *pool); /* after that: all blocks were answered */

#endif
