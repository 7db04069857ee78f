/* answer_cache.h - small answers, cached until what they describe changes.  Any thread. */
#ifndef ANSWER_CACHE_H
#define ANSWER_CACHE_H

#include <pthread.h>
#include <stddef.h>
#include <stdint.h>

#include "server/reply.h"

enum {
	ANSWER_CACHE_SLOTS = 61,             /* answers */
	ANSWER_CACHE_BYTES_MAX = 256 * 1024, /* of one answer: all of them are 16 MB */
	ANSWER_CACHE_QUESTION_SIZE = 512,    /* [bytes] answers to longer questions are not cached */
};

struct cached_answer {
	char question[ANSWER_CACHE_QUESTION_SIZE];
	unsigned changes;   /* store_changes() from before the answer was made */
	struct reply reply; /* body NULL: the slot is empty */
	uint64_t used;      /* answer_cache.uses at its last use; 0: never used */
};

struct answer_cache {
	pthread_mutex_t lock;
	uint64_t uses;
	struct cached_answer slot[ANSWER_CACHE_SLOTS];
};

/* Whether an answer to this question made at this value of store_changes() is cached; its body is a copy, which the caller frees. */
bool answer_cache_take(struct answer_cache *cache, const char *question, unsigned changes,
                       struct reply *reply);
void answer_cache_give(struct answer_cache *cache, const char *question, unsigned changes,
                       const struct reply *reply);
void answer_cache_free(struct answer_cache *cache);

#endif
