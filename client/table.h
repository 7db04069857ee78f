/* table.h - rows of text in columns, printed aligned for people or as CSV. */
#ifndef TABLE_H
#define TABLE_H

#include <stddef.h>

struct table;

enum { TABLE_WIDTH = 80 }; /* columns that tables and sentences keep within */

/* `names` are the column heads, ending with NULL; they are copied.  The first n_keys columns identify a row: a table wider
 * than TABLE_WIDTH is printed as several tables below each other, each with these columns first.  No function fails: out of
 * memory ends the program. */
struct table *table_open(int n_keys, const char *const names[]);
void table_text(struct table *table,
                const char *text);                    /* next cell, rows fill from the left; NULL: no value */
void table_number(struct table *table, double value); /* NAN: no value */

/* The last column is a chart of characters: it gets a block of its own if it would have to be cut. */
void table_keep_chart(struct table *table);

/* Aligned: `indent` blanks before each row, numbers to the right, columns without any value left out, the middle of long
 * texts left out. */
void table_print(const struct table *table, int indent);
void table_print_csv(const struct table *table);
void table_close(struct table *table);

/* A number as text, by a format of printf, without the sign of a zero that is left after rounding. */
void table_round(char *text, size_t size, const char *format, double value);

/* Columns a text takes on a terminal: its characters, not its bytes. */
int table_width(const char *text);

/* A text of at most `width` columns, for the caller to free; "..." is where it is cut. */
char *table_cut(const char *text, int width);

/* Prints an untrusted text after command_tame; NULL: nothing. */
void table_say(const char *text);
/* Prints such a text in lines of at most TABLE_WIDTH columns, all indented by `indent` blanks. */
void table_prose(int indent, const char *text);
int table_prose_lines(int indent, const char *text); /* their number */

#endif
