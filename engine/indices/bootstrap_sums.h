/* bootstrap_sums.h - sums of columns over rows drawn with replacement, for groups of resamples. */
#ifndef BOOTSTRAP_SUMS_H
#define BOOTSTRAP_SUMS_H

#include <stdatomic.h>
#include <stdint.h>

enum {
	POUND_TILE = 16, /* columns of a tile: two cache lines of a row */
	POUND_RESAMPLE_GROUP = 8,
	POUND_RESAMPLE_ROWS_MAX = 1 << 20,
};

/* A table in tiles of columns, so that a resample reads whole cache lines. */
struct pound_tiles {
	int n_rows, n_tiles;
	double *tile;            /* (n_tiles x n_rows x POUND_TILE), 64-byte aligned */
	const atomic_bool *stop; /* checked throughout: if set, the sums must not be used; NULL: never */
};

/* Sums of the columns over POUND_RESAMPLE_GROUP resamples from number `first`, each of n_rows draws.
 * sum: (POUND_RESAMPLE_GROUP x n_tiles x POUND_TILE), 64-byte aligned, the same bits for any width of cpu_width.h */
void pound_bootstrap_sums(int width, const struct pound_tiles *tiles, uint64_t seed, int first, double *sum);

/* bootstrap_sums.inl, compiled once for each lane count */
void pound_bootstrap_sums_w8(const struct pound_tiles *tiles, uint64_t seed, int first, double *sum);
void pound_bootstrap_sums_w4(const struct pound_tiles *tiles, uint64_t seed, int first, double *sum);
void pound_bootstrap_sums_w1(const struct pound_tiles *tiles, uint64_t seed, int first, double *sum);
void pound_bootstrap_sums_portable(const struct pound_tiles *tiles, uint64_t seed, int first, double *sum);

#endif
