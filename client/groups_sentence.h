/* groups_sentence.h - the indices of the groups of inputs of a sensitivity result, in one sentence. */
#ifndef GROUPS_SENTENCE_H
#define GROUPS_SENTENCE_H

#include "schema/json/json_pointer.h"

/* S1 and ST of every group, of as many outputs as fit in four lines; the caller frees it.  NULL: no output has groups.
 *
 * Given    over      what an index is a range over, such as "the 2 cells of the sweep"; "": every index is one value
 */
char *groups_sentence(const struct reading *result, const char *over);

#endif
