/* table.c - cells are kept as text; alignment is decided when all of them are known. */
#include "client/table.h"

#include "client/command.h"
#include "schema/json/json_writer.h"

#include <math.h>
#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { COLUMNS_MAX = 16, GAP = 2 };

struct cell {
	char *text; /* NULL: no value */
	double number;
	bool is_number;
};

struct table {
	int n_columns, n_cells, room;
	char *names[COLUMNS_MAX]; /* (n_columns) */
	struct cell *cells;       /* (n_cells), row-major */
};

/* Opens an empty table. */
struct table *table_open(const char *const names[])
{
	struct table *table = command_sure(calloc(1, sizeof *table));
	while (names[table->n_columns]) {
		table->names[table->n_columns] = command_sure(strdup(names[table->n_columns]));
		table->n_columns++;
	}
	return table;
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

/* Puts a text, copied, into the next cell. */
void table_text(struct table *table, const char *text)
{
	struct cell *cell = next_cell(table);
	cell->text = text ? command_sure(strdup(text)) : NULL;
}

/* Puts a number into the next cell: four digits for people, all of them in CSV. */
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

/* Counts the bytes that start a UTF-8 character; wide and combining characters count as one. */
int table_width(const char *text)
{
	int n = 0;
	for (; *text; text++)
		n += ((unsigned char)*text & 0xc0) != 0x80;
	return n;
}

/* Keeps text from other people off the controls of a terminal. */
void table_tame(char *text)
{
	for (unsigned char *c = (unsigned char *)text; *c; c++) {
		// C0 and DEL, and the C1 controls, which UTF-8 writes c2 80 .. c2 9f
		if (*c < ' ' || *c == 0x7f)
			*c = '?';
		else if (*c == 0xc2 && c[1] >= 0x80 && c[1] < 0xa0)
			c[0] = c[1] = '?';
	}
}

static void pad(int n)
{
	printf("%*s", n > 0 ? n : 0, "");
}

void table_say(const char *text)
{
	char *tame = command_sure(strdup(text ? text : ""));
	table_tame(tame);
	fputs(tame, stdout);
	free(tame);
}

void table_prose(int indent, const char *text)
{
	char *words = command_sure(strdup(text)), *rest;
	int column = TABLE_PROSE;
	table_tame(words);
	for (char *word = strtok_r(words, " ", &rest); word; word = strtok_r(NULL, " ", &rest)) {
		int width = table_width(word);
		bool fits = column + 1 + width <= TABLE_PROSE;
		if (!fits && word != words)
			putchar('\n');
		pad(fits ? 1 : indent);
		fputs(word, stdout);
		column = (fits ? column + 1 : indent) + width;
	}
	putchar('\n');
	free(words);
}

/* Prints one cell in its column; the last column of text is not padded. */
static void put(const char *text, int width, bool right, bool last)
{
	int blanks = width - table_width(text);
	if (right)
		pad(blanks);
	table_say(text);
	if (!right && !last)
		pad(blanks);
}

/* Prints the table aligned; a column in which no row has a value is left out. */
void table_print(const struct table *table, int indent)
{
	int width[COLUMNS_MAX] = {0}, last = 0; /* width 0: no value in the column */
	bool right[COLUMNS_MAX] = {0};
	for (int i = 0; i < table->n_cells; i++) {
		const struct cell *cell = &table->cells[i];
		int column = i % table->n_columns, n = cell->text ? table_width(cell->text) : 0;
		width[column] = n > width[column] ? n : width[column];
		right[column] |= cell->is_number;
	}
	for (int c = 0; c < table->n_columns; c++) {
		int n = table_width(table->names[c]);
		width[c] = table->n_cells && !width[c] ? 0 : n > width[c] ? n : width[c];
		last = width[c] ? c : last;
	}
	for (int i = -table->n_columns; i < table->n_cells; i++) {
		int c = (i + table->n_columns) % table->n_columns;
		if (c == 0)
			pad(indent);
		const char *text = i < 0 ? table->names[c] : table->cells[i].text ? table->cells[i].text : "-";
		if (width[c])
			put(text, width[c], right[c], c == last);
		if (width[c] && c != last)
			pad(GAP);
		if (c == table->n_columns - 1)
			putchar('\n');
	}
}

/* Prints the table as CSV, numbers to the last digit. */
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
