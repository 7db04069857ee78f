/* Answers that are kept.  To make one takes from twice to a hundred times of what it takes to send it. */
#include "server/kept.h"

#include <stdlib.h>
#include <string.h>

static struct kept_answer *place(struct kept *kept, const char *question)
{
	unsigned hash = 2166136261u; // FNV-1a
	for (const char *c = question; *c; c++)
		hash = (hash ^ (unsigned char)*c) * 16777619u;
	return &kept->answers[hash % KEPT];
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
 * Given    question   all that the answer depends on, besides what is stored; "": none that is kept
 *          changes    store_changes() of what it is about
 * Returns  reply      with a body of its own
 *          value      false: there is none
 * Test     service_routes: an_answer_is_kept_until_what_it_is_about_changes
 */
bool kept_take(struct kept *kept, const char *question, unsigned changes, struct reply *reply)
{
	struct kept_answer *answer = place(kept, question);
	bool found = false;
	pthread_mutex_lock(&kept->lock);
	if (*question && answer->reply.body && answer->changes == changes &&
	    !strcmp(answer->question, question)) {
		*reply = copied(&answer->reply);
		found = reply->body;
	}
	pthread_mutex_unlock(&kept->lock);
	return found;
}

/* Keeps a copy of an answer, in the place of another. */
void kept_give(struct kept *kept, const char *question, unsigned changes, const struct reply *reply)
{
	struct kept_answer *answer = place(kept, question);
	if (!*question || reply->status != 200 || !reply->body || reply->lasts || reply->length > KEPT_BYTES_MAX)
		return;
	struct reply copy = copied(reply);
	pthread_mutex_lock(&kept->lock);
	free(answer->reply.body);
	strcpy(answer->question, question);
	answer->changes = changes;
	answer->reply = copy;
	pthread_mutex_unlock(&kept->lock);
}

void kept_free(struct kept *kept)
{
	for (int i = 0; i < KEPT; i++)
		free(kept->answers[i].reply.body);
}
