/* A place for each remainder of ids; the last one told there is kept. */
#include "server/cache.h"

#include <pthread.h>
#include <stdlib.h>
#include <string.h>

enum { PLACES = 509 /* a prime, so that ids fall everywhere */, LOCKS = 16 };

struct cache {
	pthread_mutex_t locks[LOCKS];
	struct cached places[PLACES];
};

struct cache *cache_open(void)
{
	struct cache *cache = calloc(1, sizeof *cache);
	for (int i = 0; cache && i < LOCKS; i++)
		pthread_mutex_init(&cache->locks[i], NULL);
	return cache;
}

void cache_close(struct cache *cache)
{
	for (int i = 0; i < LOCKS; i++)
		pthread_mutex_destroy(&cache->locks[i]);
	free(cache);
}

static void copy(struct cached *to, const struct cached *from)
{
	memcpy(to, from, offsetof(struct cached, body) + from->length);
}

bool cache_find(struct cache *cache, int64_t id, unsigned changes, struct cached *found)
{
	int64_t place = id % PLACES;
	pthread_mutex_lock(&cache->locks[place % LOCKS]);
	const struct cached *here = &cache->places[place];
	bool same = here->id == id && here->changes == changes && here->length > 0;
	if (same)
		copy(found, here);
	pthread_mutex_unlock(&cache->locks[place % LOCKS]);
	return same;
}

void cache_keep(struct cache *cache, const struct cached *kept)
{
	int64_t place = kept->id % PLACES;
	pthread_mutex_lock(&cache->locks[place % LOCKS]);
	copy(&cache->places[place], kept);
	pthread_mutex_unlock(&cache->locks[place % LOCKS]);
}
