/* answer_cache.c - small answers; the least recently used one is replaced.  Making an answer takes 2 to 100 times as long as sending it. */
#include "server/answer_cache.h"

#include <stdlib.h>
#include <string.h>

/* The slot of a question, else the least recently used slot. */
static struct cached_answer *slot_of(struct answer_cache *cache, const char *question)
{
	struct cached_answer *oldest = &cache->slot[0];
	for (int i = 0; i < ANSWER_CACHE_SLOTS; i++) {
		struct cached_answer *slot = &cache->slot[i];
		if (slot->reply.body && !strcmp(slot->question, question))
			return slot;
		oldest = slot->used < oldest->used ? slot : oldest;
	}
	return oldest;
}

/* The same reply with a body of its own; NULL: no memory. */
static struct reply copied(const struct reply *reply)
{
	struct reply copy = *reply;
	copy.body = malloc(reply->length + 1);
	if (copy.body)
		memcpy(copy.body, reply->body, reply->length);
	return copy;
}

/* Finds the answer to a question.
 *
 * Given    question   all that the answer depends on, besides the store; "": answers that are not cached
 *          changes    store_changes() of the study, or of all studies
 * Returns  reply      with a body of its own
 *          value      false: it is not cached
 * Test     service_routes: an_answer_is_kept_until_what_it_is_about_changes
 */
bool answer_cache_take(struct answer_cache *cache, const char *question, unsigned changes,
                       struct reply *reply)
{
	bool found = false;
	pthread_mutex_lock(&cache->lock);
	struct cached_answer *answer = slot_of(cache, question);
	if (*question && answer->reply.body && answer->changes == changes &&
	    !strcmp(answer->question, question)) {
		*reply = copied(&answer->reply);
		answer->used = ++cache->uses;
		found = reply->body;
	}
	pthread_mutex_unlock(&cache->lock);
	return found;
}

/* Stores a copy of an answer, in place of the least recently used one. */
void answer_cache_give(struct answer_cache *cache, const char *question, unsigned changes,
                       const struct reply *reply)
{
	if (!*question || reply->status != 200 || !reply->body || reply->lasts ||
	    reply->length > ANSWER_CACHE_BYTES_MAX)
		return;
	struct reply copy = copied(reply);
	pthread_mutex_lock(&cache->lock);
	struct cached_answer *answer = slot_of(cache, question);
	free(answer->reply.body);
	strcpy(answer->question, question);
	answer->changes = changes;
	answer->reply = copy;
	answer->used = ++cache->uses;
	pthread_mutex_unlock(&cache->lock);
}

void answer_cache_free(struct answer_cache *cache)
{
	for (int i = 0; i < ANSWER_CACHE_SLOTS; i++)
		free(cache->slot[i].reply.body);
}
