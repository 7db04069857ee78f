/* indices_table.h - a sensitivity result as tables for people. */
#ifndef INDICES_TABLE_H
#define INDICES_TABLE_H

#include "schema/json/json_pointer.h"

/* All of them: the design, every table of every output, and what more rows cost. */
void indices_print(const struct reading *result);
void given_data_print(const struct reading *result);

/* Whether the result has a table of RESULT_TABLES in any output. */
bool indices_have_table(const struct reading *result, const char *table);
/* One of RESULT_TABLES, of every output that has it; false: none has. */
bool indices_print_table(const struct reading *result, const char *table);

#endif
