/* cache.h - status objects as they were last told, for clients that ask again before anything has changed.
 *
 * To read one from the database takes the longer the more blocks it has.  Any thread. */
#ifndef CACHE_H
#define CACHE_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

enum { CACHE_BODY_MAX = 4096 }; /* [bytes] of a status object that is kept; a longer one is read every time */

struct cached {
	int64_t id;
	unsigned changes; /* of the study (store_changes) before it was read */
	size_t length;
	char etag[64];
	char body[CACHE_BODY_MAX];
};

struct cache;

struct cache *cache_open(void); /* NULL: no memory */
void cache_close(struct cache *cache);

/* Whether the object of a study that has had so many changes is there; then it is copied. */
bool cache_find(struct cache *cache, int64_t id, unsigned changes, struct cached *found);
void cache_keep(struct cache *cache, const struct cached *kept);

#endif
