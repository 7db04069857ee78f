/* table.c - stores cells as text; widths and alignment are computed when all cells are known. */
#include "client/table.h"

#include "client/command.h"
#include "schema/json/json_writer.h"

#include <math.h>
#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { COLUMNS_MAX = 40, GAP = 2, KEY_MOST = 32, TEXT_LEAST = 16 };

struct cell {
	char *text; /* NULL: no value */
	double number;
	bool is_number;
};

struct table {
	int n_columns, n_cells, room;
	int n_keys;               /* first columns, repeated in every block of a folded table */
	bool whole;               /* the last column is a chart: rather in a block of its own than cut */
	char *names[COLUMNS_MAX]; /* (n_columns) */
	struct cell *cells;       /* (n_cells), row-major */
};

/* Opens an empty table. */
struct table *table_open(int n_keys, const char *const names[])
{
	struct table *table = command_sure(calloc(1, sizeof *table));
	table->n_keys = n_keys;
	while (names[table->n_columns]) {
		table->names[table->n_columns] = command_sure(strdup(names[table->n_columns]));
		table->n_columns++;
	}
	return table;
}

void table_keep_chart(struct table *table)
{
	table->whole = true;
}

static struct cell *next_cell(struct table *table)
{
	if (table->n_cells == table->room) {
		table->room = table->room ? 2 * table->room : 64;
		table->cells = command_sure(realloc(table->cells, (size_t)table->room * sizeof *table->cells));
	}
	struct cell *cell = &table->cells[table->n_cells++];
	*cell = (struct cell){0};
	return cell;
}

/* Copies a text into the next cell. */
void table_text(struct table *table, const char *text)
{
	struct cell *cell = next_cell(table);
	cell->text = text ? command_sure(strdup(text)) : NULL;
}

/* Puts a number into the next cell: four significant digits in a printed table, all digits in CSV. */
void table_number(struct table *table, double value)
{
	char text[32];
	struct cell *cell = next_cell(table);
	cell->number = value;
	cell->is_number = true;
	if (!isfinite(value))
		return;
	snprintf(text, sizeof text, fabs(value) < 1e9 && value == floor(value) ? "%.0f" : "%.4g", value);
	cell->text = command_sure(strdup(text));
}

void table_round(char *text, size_t size, const char *format, double value)
{
	snprintf(text, size, format, value);
	const char *sign = strchr(text, '-');
	if (sign && !strpbrk(sign, "123456789"))
		snprintf(text, size, format, 0.0);
}

/* Counts the bytes that start a UTF-8 character; wide and combining characters count as one. */
int table_width(const char *text)
{
	int n = 0;
	for (; *text; text++)
		n += ((unsigned char)*text & 0xc0) != 0x80;
	return n;
}

/* Byte offset of character n in a UTF-8 text. */
static size_t character_at(const char *text, int n)
{
	size_t at = 0;
	for (; text[at] && (n > 0 || ((unsigned char)text[at] & 0xc0) == 0x80); at++)
		n -= ((unsigned char)text[at + 1] & 0xc0) != 0x80;
	return at;
}

/* Cuts a text to a width: a path at its beginning, any other text in its middle, so that similar texts stay distinguishable.
 *
 * Memory   allocates; the caller frees
 * Test     client_wire
 */
char *table_cut(const char *text, int width)
{
	const int n = table_width(text), kept = width - 3;
	if (n <= width)
		return command_text("%s", text);
	const int head = strchr(text, '/') ? 0 : kept / 2;
	return command_text("%.*s...%s", (int)character_at(text, head), text,
	                    text + character_at(text, n - (kept - head)));
}

static void pad(int n)
{
	printf("%*s", n > 0 ? n : 0, "");
}

void table_say(const char *text)
{
	char *tame = command_sure(strdup(text ? text : ""));
	command_tame(tame);
	fputs(tame, stdout);
	free(tame);
}

/* Breaks a text into lines and prints or only counts them; returns their number. */
static int prose(int indent, const char *text, bool print)
{
	char *words = command_sure(strdup(text)), *rest;
	int column = TABLE_WIDTH, n = 0;
	command_tame(words);
	for (char *word = strtok_r(words, " ", &rest); word; word = strtok_r(NULL, " ", &rest)) {
		const int width = table_width(word);
		const bool fits = column + 1 + width <= TABLE_WIDTH;
		n += !fits;
		column = (fits ? column + 1 : indent) + width;
		if (print)
			printf("%s%*s%s", !fits && n > 1 ? "\n" : "", fits ? 1 : indent, "", word);
	}
	if (print)
		putchar('\n');
	free(words);
	return n > 0 ? n : 1;
}

void table_prose(int indent, const char *text)
{
	prose(indent, text, true);
}

int table_prose_lines(int indent, const char *text)
{
	return prose(indent, text, false);
}

/* Prints one cell in its column; text in the last column is not padded. */
static void put(const char *text, int width, bool right, bool last)
{
	const int blanks = width - table_width(text);
	if (right)
		pad(blanks);
	char *within = table_cut(text, width);
	table_say(within);
	free(within);
	if (!right && !last)
		pad(blanks);
}

/* Width of each column (0: no row has a value), and whether it is right-aligned because it has numbers. */
struct layout {
	int width[COLUMNS_MAX];
	bool right[COLUMNS_MAX];
};

static struct layout layout_of(const struct table *table, int indent)
{
	struct layout layout = {0};
	for (int i = 0; i < table->n_cells; i++) {
		const struct cell *cell = &table->cells[i];
		int column = i % table->n_columns, n = cell->text ? table_width(cell->text) : 0;
		layout.width[column] = n > layout.width[column] ? n : layout.width[column];
		layout.right[column] |= cell->is_number;
	}
	int used = indent - GAP;
	for (int c = 0; c < table->n_columns; c++) {
		int *width = &layout.width[c], n = table_width(table->names[c]);
		*width = table->n_cells && !*width ? 0 : n > *width ? n : *width;
		if (*width > TABLE_WIDTH - indent)
			*width = TABLE_WIDTH - indent;
		used += *width ? *width + GAP : 0;
	}
	for (int c = 0; c < table->n_keys && used > TABLE_WIDTH; c++)
		if (layout.width[c] > KEY_MOST)
			layout.width[c] = KEY_MOST;
	return layout;
}

/* Returns the end of the block of columns from `first` on that fit beside the keys; the block has at least one column.  Text columns
 * are cut to fit if they are the first of the block or the last of the table. */
static int block_end(const struct table *table, struct layout *layout, int indent, int first)
{
	int used = indent, end = first;
	for (int c = 0; c < table->n_keys; c++)
		used += layout->width[c] ? layout->width[c] + GAP : 0;
	for (; end < table->n_columns; end++) {
		const int left = TABLE_WIDTH - used;
		const bool cut = end == first || (end == table->n_columns - 1 && !table->whole);
		if (cut && !layout->right[end] && left >= TEXT_LEAST && left < layout->width[end])
			layout->width[end] = left;
		if (end > first && layout->width[end] > left)
			break;
		used += layout->width[end] ? layout->width[end] + GAP : 0;
	}
	return end;
}

/* Prints the key columns and the columns first to end - 1 of all rows. */
static void print_block(const struct table *table, const struct layout *layout, int indent, int first,
                        int end)
{
	int last = 0;
	for (int c = 0; c < end; c++)
		last = layout->width[c] && (c < table->n_keys || c >= first) ? c : last;
	for (int row = -1; row < table->n_cells / table->n_columns; row++) {
		pad(indent);
		for (int c = 0; c <= last; c++) {
			if (!layout->width[c] || (c >= table->n_keys && c < first))
				continue;
			const char *text = row < 0 ? table->names[c] : table->cells[row * table->n_columns + c].text;
			put(text ? text : "-", layout->width[c], layout->right[c], c == last);
			if (c != last)
				pad(GAP);
		}
		putchar('\n');
	}
}

/* Prints the table aligned, folded into blocks below each other if it is too wide; columns without any value are
 * left out.
 *
 * Test     client_tables: every_table_fits_a_terminal_of_80_columns
 */
void table_print(const struct table *table, int indent)
{
	struct layout layout = layout_of(table, indent);
	for (int first = table->n_keys, end; first < table->n_columns; first = end) {
		if (first > table->n_keys)
			putchar('\n');
		end = block_end(table, &layout, indent, first);
		print_block(table, &layout, indent, first, end);
	}
}

/* Prints the table as CSV, numbers with all digits. */
void table_print_csv(const struct table *table)
{
	struct writer writer;
	writer_init(&writer);
	for (int i = -table->n_columns; i < table->n_cells; i++) {
		int c = (i + table->n_columns) % table->n_columns;
		char digits[WRITER_NUMBER_SIZE];
		if (i < 0)
			writer_cell(&writer, table->names[c]);
		else if (!table->cells[i].is_number)
			writer_cell(&writer, table->cells[i].text ? table->cells[i].text : "");
		else if (table->cells[i].text)
			writer_raw(&writer, digits, (size_t)writer_digits(table->cells[i].number, digits));
		writer_raw(&writer, c == table->n_columns - 1 ? "\n" : ",", 1);
	}
	size_t n;
	char *text = command_sure(writer_take(&writer, &n));
	fwrite(text, 1, n, stdout);
	free(text);
}

/* Frees the table and its cells. */
void table_close(struct table *table)
{
	for (int i = 0; i < table->n_columns; i++)
		free(table->names[i]);
	for (int i = 0; i < table->n_cells; i++)
		free(table->cells[i].text);
	free(table->cells);
	free(table);
}
