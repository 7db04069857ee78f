/* hash.h - hash tables with linear probing, for keys of doubles; the number of slots is a power of two. */
#ifndef HASH_H
#define HASH_H

#include <stdint.h>
#include <string.h>

/* Slots of a table for n keys: at least 2 n. */
static inline int pound_hash_slots(int n)
{
	int slots = 16;
	while (slots < 2 * n)
		slots *= 2;
	return slots;
}

/* The slot where the search for a key begins.
 *
 * Given    hash   of further parts of the key; 0: there are none
 *          key    (n)  hashed by its bits
 *          slots  of the table
 */
static inline int pound_hash_slot(uint64_t hash, const double *key, int n, int slots)
{
	for (int j = 0; j < n; j++) {
		uint64_t bits;
		memcpy(&bits, &key[j], sizeof bits);
		hash = (hash ^ bits) * 0x9E3779B97F4A7C15u; // 2^64 over the golden ratio
		hash ^= hash >> 32;
	}
	return (int)(hash & (uint64_t)(slots - 1));
}

#endif
