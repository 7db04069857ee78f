/* A partial result is fresh for SHARE times as long as it took to make: repeated requests then use at most about a twentieth of one
 * core for new ones, and get the others at once. */
#include "server/partial_results.h"

#include <stdlib.h>
#include <string.h>
#include <time.h>

enum { SHARE = 20, BYTES_MAX = 128 << 20 /* of all results kept; a larger one is not kept */ };

static double now_s(void)
{
	struct timespec now;
	clock_gettime(CLOCK_MONOTONIC, &now);
	return (double)now.tv_sec + 1e-9 * (double)now.tv_nsec;
}

/* Test     service_growth: results_so_far_come_at_once_when_asked_for_again */
bool partial_results_take(struct partial_results *results, int64_t id, struct partial_result *copy)
{
	*copy = (struct partial_result){.id = id};
	pthread_mutex_lock(&results->lock);
	for (int i = 0; i < PARTIAL_RESULTS && !copy->body; i++) {
		const struct partial_result *r = &results->result[i];
		char *body = r->id == id && r->body ? malloc(r->length + 1) : NULL;
		if (!body)
			continue;
		memcpy(body, r->body, r->length + 1);
		*copy = *r;
		copy->body = body;
	}
	pthread_mutex_unlock(&results->lock);
	return copy->body && now_s() <= copy->until;
}

/* Forgets other results than `kept`, those that expire first, until all take at most BYTES_MAX bytes. */
static void shrink(struct partial_results *results, const struct partial_result *kept)
{
	for (;;) {
		struct partial_result *first = NULL;
		size_t bytes = 0;
		for (int i = 0; i < PARTIAL_RESULTS; i++) {
			struct partial_result *r = &results->result[i];
			bytes += r->body ? r->length : 0;
			if (r != kept && r->body && (!first || r->until < first->until))
				first = r;
		}
		if (bytes <= BYTES_MAX || !first)
			return;
		free(first->body);
		*first = (struct partial_result){0};
	}
}

/* Replaces the study's last partial result, else the one that expires first. */
void partial_results_give(struct partial_results *results, const struct partial_result *made, double took)
{
	char *copy = made->length < BYTES_MAX ? malloc(made->length + 1) : NULL;
	if (!copy)
		return;
	memcpy(copy, made->body, made->length);
	copy[made->length] = '\0';
	pthread_mutex_lock(&results->lock);
	struct partial_result *into = &results->result[0];
	for (int i = 1; i < PARTIAL_RESULTS && into->id != made->id; i++) {
		struct partial_result *r = &results->result[i];
		into = r->id == made->id || r->until < into->until ? r : into;
	}
	// a result of few rows may be made while another of all rows is
	const bool later = into->id != made->id || made->rows >= into->rows;
	if (later) {
		free(into->body);
		*into = *made;
		into->body = copy;
		into->until = now_s() + SHARE * took;
		shrink(results, into);
	}
	pthread_mutex_unlock(&results->lock);
	if (!later)
		free(copy);
}

void partial_results_free(struct partial_results *results)
{
	for (int i = 0; i < PARTIAL_RESULTS; i++)
		free(results->result[i].body);
}
