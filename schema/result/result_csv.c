/* result_csv.c - writes tables of a result as CSV, from its JSON: members become columns.
 *
 * A table with a name joins the lists of one name from all outputs of all cells, from all cells or their contacts, or from all sets
 * of fragility curves.  Convergence: one row per setting, with its time.  Floor spectra: one row per frequency. */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "schema/json/json.h"
#include "schema/json/json_writer.h"
#include "schema/result/result_json.h"

static const cJSON *member(const cJSON *object, const char *name)
{
	return cJSON_GetObjectItemCaseSensitive(object, name);
}

/* The first element of a list, and the element after one; both for NULL arguments too. */
static const cJSON *first(const cJSON *list)
{
	return list ? list->child : NULL;
}

static const cJSON *behind(const cJSON *element)
{
	return element ? element->next : NULL;
}

/* ---- lines ---- */

/* The lines of a table.  All lines are made twice, first to collect columns, then to write values: a line may lack columns, but the
 * order of columns is the same in all lines. */
struct lines {
	struct writer *w;
	char **columns; /* (n) names */
	int n, room;
	int next;       /* next column of the current line */
	bool gathering; /* first pass: collects columns */
	bool failed;    /* out of memory */
};

/* The column with a name, from the next one on; n: none. */
static int column_of(const struct lines *lines, const char *name)
{
	int k = lines->next;
	while (k < lines->n && strcmp(lines->columns[k], name) != 0)
		k++;
	return k;
}

/* Inserts a new column after the previous one of its line. */
static void column_add(struct lines *lines, const char *name)
{
	if (lines->n == lines->room) {
		const int room = lines->room ? 2 * lines->room : 64;
		char **columns = realloc(lines->columns, (size_t)room * sizeof *columns);
		lines->failed = lines->failed || !columns;
		if (!columns)
			return;
		lines->columns = columns;
		lines->room = room;
	}
	char *copy = strdup(name);
	lines->failed = lines->failed || !copy;
	if (!copy)
		return;
	char **at = &lines->columns[lines->next];
	memmove(at + 1, at, (size_t)(lines->n - lines->next) * sizeof *at);
	*at = copy;
	lines->n++;
}

static void put_value(struct writer *w, const cJSON *value)
{
	char digits[WRITER_NUMBER_SIZE];
	if (cJSON_IsString(value))
		writer_cell(w, value->valuestring);
	else if (cJSON_IsNumber(value))
		writer_raw(w, digits, (size_t)writer_digits(value->valuedouble, digits));
	else if (cJSON_IsBool(value))
		writer_cell(w, cJSON_IsTrue(value) ? "true" : "false");
}

/* Commas up to a column. */
static void put_until(struct lines *lines, int column)
{
	for (int k = lines->next; k < column; k++)
		writer_raw(lines->w, ",", k > 0);
}

/* Puts the next cell: prefix and name of its column, and its value; NULL: empty. */
static void put(struct lines *lines, const char *prefix, const char *name, const cJSON *value)
{
	char text[256];
	snprintf(text, sizeof text, "%s%s", prefix, name);
	const int column = column_of(lines, text);
	if (lines->gathering) {
		if (column == lines->n)
			column_add(lines, text);
		else
			lines->next = column;
	} else {
		put_until(lines, column + 1);
		put_value(lines->w, value);
		lines->next = column;
	}
	lines->next++;
}

/* Puts every scalar member of an object, except notes, as a cell. */
static void put_scalars(struct lines *lines, const cJSON *object, const char *prefix)
{
	const cJSON *value;
	cJSON_ArrayForEach(value, object)
	{
		bool scalar = !cJSON_IsArray(value) && !cJSON_IsObject(value);
		if (scalar && strcmp(value->string, "note") != 0)
			put(lines, prefix, value->string, value);
	}
}

static void put_end(struct lines *lines)
{
	if (!lines->gathering) {
		put_until(lines, lines->n);
		writer_raw(lines->w, "\r\n", 2);
	}
	lines->next = 0;
}

static void put_names(struct lines *lines)
{
	for (int k = 0; k < lines->n; k++) {
		writer_raw(lines->w, ",", k > 0);
		writer_cell(lines->w, lines->columns[k]);
	}
	writer_raw(lines->w, "\r\n", lines->n ? 2 : 0);
}

/* ---- tables by name: the cells of a line of each ---- */

/* The objects of a result from which a line is made. */
struct place {
	const cJSON *result, *cell;
	const cJSON *output;  /* of the cell */
	const cJSON *contact; /* owner of the gaps: a contact of the cell, or the cell */
	const cJSON *set;     /* of fragility curves */
	const cJSON *signal;  /* of a row of buildings */
	const cJSON *body;    /* of the signal: a building */
	int building;         /* its index */
	const cJSON *element; /* of the table's list */
	int index;            /* of the element in the list */
	int point;            /* in the element's curve */
};

/* Every line of an intermediate result starts with its number of rows. */
static void put_cell(struct lines *lines, const struct place *at)
{
	put_scalars(lines, member(at->result, "partial"), "partial.");
	put_scalars(lines, member(at->cell, "sweep"), "");
}

/* Name and place of an output. */
static void put_output(struct lines *lines, const struct place *at)
{
	static const char *const members[] = {"frequency_hz", "contact", "building", "storey"};
	put_cell(lines, at);
	put(lines, "output.", "name", member(at->output, "name"));
	for (size_t k = 0; k < sizeof members / sizeof members[0]; k++)
		if (member(at->output, members[k]))
			put(lines, "output.", members[k], member(at->output, members[k]));
}

static void put_input(struct lines *lines, const struct place *at)
{
	const cJSON *accuracy = member(at->output, "accuracy");
	put_cell(lines, at);
	put_scalars(lines, at->output, "output.");
	put_scalars(lines, member(at->output, "excitation"), "output.excitation.");
	put_scalars(lines, accuracy, "output.accuracy.");
	put_scalars(lines, at->element, "");
	put_scalars(lines, cJSON_GetArrayItem(member(accuracy, "inputs"), at->index), "accuracy.");
}

static void put_set(struct lines *lines, const struct place *at)
{
	const cJSON *input;
	int k = 0;
	put_output(lines, at);
	cJSON_ArrayForEach(input, member(at->element, "inputs"))
	{
		char name[32];
		snprintf(name, sizeof name, "input_%d", ++k);
		put(lines, "", name, input);
	}
	put_scalars(lines, at->element, "");
}

static void put_group(struct lines *lines, const struct place *at)
{
	put_output(lines, at);
	put_scalars(lines, at->element, "");
}

static void put_variable(struct lines *lines, const struct place *at)
{
	put_output(lines, at);
	put_scalars(lines, member(at->output, "ratios"), "");
	put_scalars(lines, at->element, "");
}

static void put_point(struct lines *lines, const struct place *at)
{
	static const char *const curve[] = {"x", "mean", "low", "high"};
	put_output(lines, at);
	put_scalars(lines, at->element, "");
	for (int k = 0; k < 4; k++)
		put(lines, "", curve[k], cJSON_GetArrayItem(member(at->element, curve[k]), at->point));
}

/* A row of buildings in one line: the columns have the numbers of storeys, floors and contacts in their names. */
static void put_row(struct lines *lines, const cJSON *signal)
{
	static const char *const lists[] = {"storeys", "floors"}, *const ones[] = {"storey", "floor"};
	const cJSON *building, *element;
	int b = 0, k = 0;
	char prefix[64];
	cJSON_ArrayForEach(building, member(signal, "buildings"))
	{
		for (int list = 0; list < 2; list++) {
			int i = 0;
			cJSON_ArrayForEach(element, member(building, lists[list]))
			{
				snprintf(prefix, sizeof prefix, "building_%d.%s_%d.", b, ones[list], ++i);
				put_scalars(lines, element, prefix);
				snprintf(prefix, sizeof prefix, "building_%d.%s_%d.end.", b, ones[list], i);
				put_scalars(lines, member(element, "end"), prefix);
			}
		}
		b++;
	}
	cJSON_ArrayForEach(element, member(signal, "contacts"))
	{
		snprintf(prefix, sizeof prefix, "contact_%d.", k++);
		put_scalars(lines, element, prefix);
	}
}

static void put_signal(struct lines *lines, const struct place *at)
{
	int index = 1;
	const cJSON *oscillator, *signal = at->element;
	put_cell(lines, at);
	put_scalars(lines, signal, "");
	cJSON_ArrayForEach(oscillator, member(signal, "oscillators"))
	{
		char prefix[32];
		snprintf(prefix, sizeof prefix, "oscillator_%d.", index++);
		put_scalars(lines, oscillator, prefix);
	}
	put_row(lines, signal);
	put_scalars(lines, member(signal, "end"), "end.");
}

static void put_count(struct lines *lines, const char *name, int count)
{
	const cJSON number = {.type = cJSON_Number, .valuedouble = count};
	put(lines, "", name, &number);
}

/* A story of a building in a signal, with the floor above it. */
static void put_storey(struct lines *lines, const struct place *at)
{
	const cJSON *floor = cJSON_GetArrayItem(member(at->body, "floors"), at->index);
	put_cell(lines, at);
	put(lines, "", "signal", member(at->signal, "index"));
	put_count(lines, "building", at->building);
	put_count(lines, "storey", at->index + 1);
	put_scalars(lines, at->element, "");
	put_scalars(lines, floor, "");
	put_scalars(lines, member(floor, "end"), "end.");
}

/* A contact of a row of buildings in a signal. */
static void put_row_contact(struct lines *lines, const struct place *at)
{
	const cJSON *levels = member(at->element, "levels");
	put_cell(lines, at);
	put(lines, "", "signal", member(at->signal, "index"));
	put_count(lines, "contact", at->index);
	put(lines, "", "left_level", cJSON_GetArrayItem(levels, 0));
	put(lines, "", "right_level", cJSON_GetArrayItem(levels, 1));
	put_scalars(lines, at->element, "");
}

/* An element of a list of a cell or of a contact: of gaps, or of modes. */
static void put_contact(struct lines *lines, const struct place *at)
{
	put_cell(lines, at);
	if (member(at->contact, "contact"))
		put(lines, "", "contact", member(at->contact, "contact"));
	put_scalars(lines, at->element, "");
}

static void put_needed(struct lines *lines, const struct place *at)
{
	put_cell(lines, at);
	put_scalars(lines, at->contact, "");
	put_scalars(lines, at->element, "gap_needed.");
}

static void put_needed_signal(struct lines *lines, const struct place *at)
{
	const cJSON index = {.type = cJSON_Number, .valuedouble = at->index};
	put_contact(lines, at);
	put(lines, "", "index", &index);
	put(lines, "", "gap_needed_m", at->element);
}

static void put_curve(struct lines *lines, const struct place *at)
{
	put_scalars(lines, member(at->result, "partial"), "partial.");
	put_scalars(lines, member(at->set, "sweep"), "");
	put_scalars(lines, at->set, "");
	put_scalars(lines, at->element, "");
}

/* The mean of an output of a response study, or the numbers of an output of a study with inputs. */
static void put_mean(struct lines *lines, const struct place *at)
{
	put_cell(lines, at);
	if (cJSON_IsObject(at->element)) {
		put_scalars(lines, at->element, "output.");
		return;
	}
	const cJSON name = {.type = cJSON_String, .valuestring = at->element->string};
	put(lines, "output.", "name", &name);
	put(lines, "output.", "mean", at->element);
}

static void put_record(struct lines *lines, const struct place *at)
{
	const cJSON *value;
	put(lines, "", "name", member(at->element, "name"));
	cJSON_ArrayForEach(value, at->element) if (strcmp(value->string, "name") != 0)
	    put(lines, "", value->string, value);
}

/* The object that has the list of a table. */
enum owner { OUTPUT, CONTACT, CELL, SIGNAL, BUILDING, SET, RESULT };

/* The tables. */
static const struct table {
	const char *name;
	enum owner owner;
	void (*put)(struct lines *lines, const struct place *at);
	const char *list;   /* member of the owner */
	const char *within; /* the list is this member of `list`; NULL: `list` itself */
	const char *points; /* array of an element with a line per value; NULL: one line per element */
	bool whole;         /* no list: one line for the member itself */
} tables[] = {
    {"inputs", OUTPUT, put_input, "inputs", NULL, NULL, false},
    {"second_order", OUTPUT, put_set, "second_order", NULL, NULL, false},
    {"closed", OUTPUT, put_set, "closed", NULL, NULL, false},
    {"groups", OUTPUT, put_group, "groups", NULL, NULL, false},
    {"ratios", OUTPUT, put_variable, "ratios", "variables", NULL, false},
    {"conditional_means", OUTPUT, put_point, "conditional_means", NULL, "x", false},
    {"pounding", CONTACT, put_contact, "pounding", NULL, NULL, false},
    {"gaps", CONTACT, put_contact, "gaps", NULL, NULL, false},
    {"rules", CONTACT, put_contact, "rules", NULL, NULL, false},
    {"gap_needed", CONTACT, put_needed, "gap_needed", NULL, NULL, true},
    {"signals", CONTACT, put_needed_signal, "gap_needed", "signals_m", NULL, false},
    {"signals", CELL, put_signal, "signals", NULL, NULL, false},
    {"storeys", BUILDING, put_storey, "storeys", NULL, NULL, false},
    {"contacts", SIGNAL, put_row_contact, "contacts", NULL, NULL, false},
    {"fragility", SET, put_curve, "curves", NULL, NULL, false},
    {"return_periods", SET, put_curve, "return_periods", NULL, NULL, false},
    {"modes", CELL, put_contact, "modes", NULL, NULL, false},
    {"outputs", CELL, put_mean, "outputs", NULL, NULL, false},
    {"records", RESULT, put_record, "suite", "records", NULL, false},
};

enum { TABLES = sizeof tables / sizeof tables[0] };

static const cJSON *list_of(const struct table *table, const cJSON *owner)
{
	const cJSON *list = member(owner, table->list);
	return table->within ? member(list, table->within) : list;
}

/* Puts the lines of one element. */
static void put_element(struct lines *lines, const struct table *table, struct place *at)
{
	int n = table->points ? cJSON_GetArraySize(member(at->element, table->points)) : 1;
	for (at->point = 0; at->point < n; at->point++) {
		table->put(lines, at);
		put_end(lines);
	}
	at->index++;
}

static void put_list(struct lines *lines, const struct table *table, struct place *at, const cJSON *owner)
{
	at->index = 0;
	at->element = list_of(table, owner);
	if (at->element && table->whole)
		put_element(lines, table, at);
	else
		cJSON_ArrayForEach(at->element, list_of(table, owner)) put_element(lines, table, at);
}

/* Puts the lists of the signals of a cell, or of their buildings. */
static void put_signal_lists(struct lines *lines, const struct table *table, struct place *at)
{
	cJSON_ArrayForEach(at->signal, member(at->cell, "signals"))
	{
		const cJSON *buildings = table->owner == BUILDING ? member(at->signal, "buildings") : NULL;
		if (table->owner == SIGNAL)
			put_list(lines, table, at, at->signal);
		at->building = 0;
		cJSON_ArrayForEach(at->body, buildings)
		{
			put_list(lines, table, at, at->body);
			at->building++;
		}
	}
}

/* Puts the lists of a cell; a result without cells passes itself as the cell. */
static void put_cell_lists(struct lines *lines, const struct table *table, struct place *at)
{
	if (table->owner == CELL)
		put_list(lines, table, at, at->cell);
	else if (table->owner == SIGNAL || table->owner == BUILDING)
		put_signal_lists(lines, table, at);
	else if (table->owner == OUTPUT)
		cJSON_ArrayForEach(at->output, member(at->cell, "outputs")) put_list(lines, table, at, at->output);
	else if (member(at->cell, "contacts"))
		cJSON_ArrayForEach(at->contact, member(at->cell, "contacts")) put_list(lines, table, at, at->contact);
	else {
		at->contact = at->cell;
		put_list(lines, table, at, at->cell);
	}
}

static void put_table(struct lines *lines, const struct table *table, const cJSON *result)
{
	const cJSON *cells = member(result, "cells");
	struct place at = {.result = result};
	if (table->owner == RESULT)
		put_list(lines, table, &at, result);
	else if (table->owner == SET)
		cJSON_ArrayForEach(at.set, member(result, "fragility")) put_list(lines, table, &at, at.set);
	else if (cells)
		cJSON_ArrayForEach(at.cell, cells) put_cell_lists(lines, table, &at);
	else {
		at.cell = result;
		put_cell_lists(lines, table, &at);
	}
}

/* One check of the intervals of a growing design, with the requested limits. */
static void put_look(struct lines *lines, const cJSON *stopping, const cJSON *look, const cJSON *sweep)
{
	static const char *const members[] = {"rows", "runs", "half_width", "index", "input", "output"};
	const cJSON *value;
	for (int k = 0; k < 6; k++)
		put(lines, "", members[k], member(look, members[k]));
	cJSON_ArrayForEach(value, sweep)
	    put(lines, "", value->string, member(member(look, "sweep"), value->string));
	put(lines, "asked.", "half_width", member(stopping, "half_width"));
	put(lines, "asked.", "max_runs", member(stopping, "max_runs"));
	put(lines, "", "reached", member(stopping, "reached"));
	put_end(lines);
}

static void put_stopping(struct lines *lines, const cJSON *result)
{
	const cJSON *stopping = member(result, "stopping"), *looks = member(stopping, "looks"), *look;
	const cJSON *sweep = member(cJSON_GetArrayItem(member(result, "cells"), 0), "sweep");
	cJSON_ArrayForEach(look, looks) put_look(lines, stopping, look, sweep);
}

/* ---- convergence, floor spectra ---- */

static const char TRIALS[] =
    "trials"; /* internal name, unknown to clients: the table of a convergence study */

static void put_trial(struct lines *lines, const cJSON *row, const cJSON *time)
{
	put_scalars(lines, row, "");
	put(lines, "", "cpu_s", time);
	put_end(lines);
}

static void put_trials(struct lines *lines, const cJSON *rows, const cJSON *times)
{
	const cJSON *row, *time = first(times);
	cJSON_ArrayForEach(row, rows)
	{
		put_trial(lines, row, time);
		time = behind(time);
	}
}

/* A column of numbers: one array of one spectrum. */
struct column {
	char name[64];
	const cJSON *next;
};

enum { COLUMNS_MAX = 32 };

static int columns_add(struct column *columns, int n, const cJSON *spectra)
{
	const cJSON *spectrum, *values;
	cJSON_ArrayForEach(spectrum, spectra) cJSON_ArrayForEach(values, spectrum)
	{
		if (!cJSON_IsArray(values) || n == COLUMNS_MAX)
			continue;
		snprintf(columns[n].name, sizeof columns[n].name, "%s.%s",
		         cJSON_GetStringValue(member(spectrum, "name")), values->string);
		columns[n++].next = values->child;
	}
	return n;
}

static void put_spectra(struct writer *w, const cJSON *result)
{
	struct column columns[COLUMNS_MAX] = {{"frequency_hz", first(member(result, "frequencies_hz"))}};
	int n = columns_add(columns, 1, member(result, "spectra"));
	n = columns_add(columns, n, member(member(result, "accuracy"), "spectra"));
	for (int j = 0; j < n; j++) {
		writer_raw(w, ",", j > 0);
		writer_cell(w, columns[j].name);
	}
	writer_raw(w, "\r\n", 2);
	while (columns[0].next) {
		for (int j = 0; j < n; j++) {
			writer_raw(w, ",", j > 0);
			put_value(w, columns[j].next);
			columns[j].next = behind(columns[j].next);
		}
		writer_raw(w, "\r\n", 2);
	}
}

/* Puts the table of that name; of tables with the same name a result has at most one. */
static void put_named(struct lines *lines, const char *name, const cJSON *result)
{
	if (strcmp(name, "stopping") == 0)
		put_stopping(lines, result);
	if (strcmp(name, TRIALS) == 0 && cJSON_IsArray(member(result, "rows")))
		put_trials(lines, member(result, "rows"), member(member(result, "timing"), "run_cpu_s"));
	for (size_t k = 0; k < sizeof tables / sizeof tables[0]; k++)
		if (strcmp(tables[k].name, name) == 0)
			put_table(lines, &tables[k], result);
}

/* Writes a table by its name, in two passes: columns, then values.  false: out of memory. */
static bool put_lines(struct writer *w, const char *name, const cJSON *result)
{
	struct lines lines = {.w = w, .gathering = true};
	put_named(&lines, name, result);
	lines.gathering = false;
	if (!lines.failed) {
		put_names(&lines);
		put_named(&lines, name, result);
	}
	for (int k = 0; k < lines.n; k++)
		free(lines.columns[k]);
	free(lines.columns);
	return !lines.failed;
}

/* Writes the default table of a result, found by the members of the result. */
static bool put_first(struct writer *w, const cJSON *result)
{
	static const char *const names[] = {TRIALS, "pounding", "signals", "inputs"};
	bool made = true;
	if (cJSON_IsArray(member(result, "spectra")))
		put_spectra(w, result);
	for (int k = 0; k < 4 && made && w->length == 0; k++)
		made = put_lines(w, names[k], result);
	return made;
}

/* A result as CSV (RFC 4180).
 *
 * Given    json      (json_length)  -  from result_to_json
 *          table     -              -  one of RESULT_TABLES; NULL: the default table of the kind
 * Returns  value     (length)       -  CSV, empty if the result has no such table; NULL: out of memory
 * Memory   allocates; the caller frees
 *
 * Test     unit_result_csv: a_row_for_every_cell_output_and_input
 */
char *result_to_csv(const char *json, size_t json_length, const char *table, size_t *length)
{
	struct json_fault fault;
	struct writer w;
	*length = 0;
	cJSON *result = json_parse(json, json_length, &fault);
	if (!result)
		return NULL;
	writer_init(&w);
	bool made = table ? put_lines(&w, table, result) : put_first(&w, result);
	cJSON_Delete(result);
	char *csv = writer_take(&w, length);
	if (!made) {
		free(csv);
		return NULL;
	}
	return csv;
}

/* Reads the next cell of a CSV table, unquoted.
 *
 * Given    csv, end   (end - csv)  -  csv is at the start of a cell
 * Returns  cell       (size)       -  its text, truncated to fit
 *          sign       -            -  the delimiter: a comma, or a carriage return after the last cell of a line
 *          value      -            -  bytes of cell and delimiter
 */
size_t result_csv_cell(const char *csv, const char *end, char *cell, size_t size, char *sign)
{
	const char *at = csv;
	size_t n = 0;
	bool quoted = at < end && *at == '"';
	for (at += quoted; at < end; at++) {
		if (quoted && *at == '"' && (at + 1 == end || at[1] != '"')) {
			quoted = false;
			continue;
		}
		at += quoted && *at == '"';
		if (!quoted && (*at == ',' || *at == '\r'))
			break;
		if (n < size - 1)
			cell[n++] = *at;
	}
	cell[n] = '\0';
	*sign = at < end ? *at : '\r';
	at += at < end ? (*at == '\r' ? 2 : 1) : 0;
	return (size_t)(at - csv);
}
