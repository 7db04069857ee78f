/* indexes.h - a sensitivity result as tables for people. */
#ifndef INDEXES_H
#define INDEXES_H

#include "schema/json/json_pointer.h"

/* All of it: what the design came to, and every table of every output of every cell. */
void indexes_print(const struct reading *result);

/* One of RESULT_TABLES of every output that has it; false: none has. */
bool indexes_print_table(const struct reading *result, const char *table);

#endif
