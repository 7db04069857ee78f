/* known_rows.h - rows of buildings whose answers are known, and rows at random; the functions return the samples of the ground motion,
 * 0.01 s apart. */
#ifndef KNOWN_ROWS_H
#define KNOWN_ROWS_H

#include "tests/support/chain_scenes.h"

/* T2, T3, EP, LA, R3, W and MS */
enum row_known {
	ROW_TWO_AND_TWO,
	ROW_NO_TENSION,
	ROW_ELASTOPLASTIC,
	ROW_ORIENTED,
	ROW_OF_THREE,
	ROW_WALL,
	ROW_LEVELS,
	ROW_KNOWN
};

int row_known(struct row *row, enum row_known which);

/* A different row for every number: any law and damping, up to four buildings or a wall, levels within stories. */
int row_random(struct row *row, uint64_t number);

int row_law(const char *name); /* row of the laws */

#endif
