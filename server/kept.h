/* kept.h - answers that are kept for who asks the same again before anything has changed.  Any thread. */
#ifndef KEPT_H
#define KEPT_H

#include <pthread.h>
#include <stddef.h>

#include "server/reply.h"

enum {
	KEPT = 61,                   /* answers; a prime, so that questions fall everywhere */
	KEPT_BYTES_MAX = 256 * 1024, /* of one: all of them are 16 MB */
	KEPT_QUESTION_SIZE = 512,    /* [bytes] longer ones are not kept */
};

struct kept_answer {
	char question[KEPT_QUESTION_SIZE];
	unsigned changes;   /* store_changes() from before the answer was made */
	struct reply reply; /* body NULL: none */
};

struct kept {
	pthread_mutex_t lock;
	struct kept_answer answers[KEPT]; /* each where its question's hash is */
};

/* The reply to the same question before so many changes, its body a copy; false: none, and then it is to be given. */
bool kept_take(struct kept *kept, const char *question, unsigned changes, struct reply *reply);
void kept_give(struct kept *kept, const char *question, unsigned changes, const struct reply *reply);
void kept_free(struct kept *kept);

#endif
