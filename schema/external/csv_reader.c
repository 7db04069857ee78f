/* csv_reader.c - reads CSV of users cell by cell; a fault of many lines is reported once.
 *
 * Source   RFC 4180; but here a quoted cell must not contain a line break */
#include "schema/external/csv_reader.h"

#include <math.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>

#include "schema/json/json_strict.h"

void csv_complain(const struct csv *csv, const char *column, const char *what)
{
	char place[CSV_CELL_SIZE + 80]; // problems_add() truncates it
	snprintf(place, sizeof place, column ? "line %d, %s" : "line %d", csv->line, column);
	problems_add(csv->problems, place, "%s", what);
}

void csv_fault_note(struct csv_fault *fault, const struct csv *csv, const char *format, ...)
{
	if (fault->n < CSV_LINES_SHOWN)
		fault->lines[fault->n] = csv->line;
	if (fault->n++ > 0)
		return;
	va_list arguments;
	va_start(arguments, format);
	vsnprintf(fault->what, sizeof fault->what, format, arguments);
	va_end(arguments);
}

void csv_length_check(struct csv *csv, int n, int expected)
{
	if (n != expected)
		csv_fault_note(&csv->length, csv, "must have %d cell%s, as the header, got %d", expected,
		               expected == 1 ? "" : "s", n);
}

/* Adds a problem for all lines with a fault: "line 7, y: ...", or "lines 7, 9, 12 and 30 more, y: ... (line 7)". */
void csv_fault_report(const struct csv_fault *fault, const char *column, struct problems *problems)
{
	char place[CSV_CELL_SIZE + 80]; // problems_add() truncates it
	int n = 0;
	if (fault->n == 0)
		return;
	for (int k = 0; k < fault->n && k < CSV_LINES_SHOWN; k++)
		n += snprintf(place + n, sizeof place - (size_t)n, "%s%d",
		              k > 0          ? ", "
		              : fault->n > 1 ? "lines "
		                             : "line ",
		              fault->lines[k]);
	if (fault->n > CSV_LINES_SHOWN)
		n += snprintf(place + n, sizeof place - (size_t)n, " and %d more", fault->n - CSV_LINES_SHOWN);
	snprintf(place + n, sizeof place - (size_t)n, "%s%s", column ? ", " : "", column ? column : "");
	if (fault->n > 1)
		problems_add(problems, place, "%s (line %d)", fault->what, fault->lines[0]);
	else
		problems_add(problems, place, "%s", fault->what);
}

/* Removes blanks at both ends. */
static void trim(char *text)
{
	size_t lead = strspn(text, " \t"), n = strlen(text + lead);
	memmove(text, text + lead, n + 1);
	while (n && (text[n - 1] == ' ' || text[n - 1] == '\t'))
		text[--n] = 0;
}

void csv_read(struct csv *csv)
{
	size_t n = 0;
	bool quoted = false, closed = false; // inside quotes, directly after them
	csv->cut = false;
	for (; csv->at < csv->end && *csv->at != '\n' && (quoted || *csv->at != ','); csv->at++) {
		const bool quote = *csv->at == '"', doubled = quote && closed;
		closed = quote && quoted;
		quoted ^= quote;
		if (quote && !doubled)
			continue;
		if (n < CSV_CELL_SIZE - 1)
			csv->cell[n++] = *csv->at;
		else
			csv->cut = true;
	}
	csv->ended = csv->at == csv->end || *csv->at == '\n';
	csv->at += csv->at < csv->end;
	if (csv->ended && n && csv->cell[n - 1] == '\r')
		n--;
	csv->cell[n] = 0;
	trim(csv->cell);
}

/* Number of lines from here on; blank ones count, as the only cell of a line may be empty. */
int csv_lines_left(const struct csv *csv)
{
	int n = 0;
	for (const char *at = csv->at; at < csv->end; n++) {
		const char *newline = memchr(at, '\n', (size_t)(csv->end - at));
		at = newline ? newline + 1 : csv->end;
	}
	return n;
}

bool csv_blank(const char *at, const char *end)
{
	for (; at < end; at++)
		if (*at != '\n' && *at != '\r')
			return false;
	return true;
}

/* Whether a text is a decimal number; strtod would also accept 0x10 and inf. */
static bool is_decimal(const char *text)
{
	size_t n = strspn(text, "+-") <= 1 ? strspn(text, "+-") : 0;
	size_t whole = strspn(text + n, "0123456789"), decimals = 0;
	n += whole;
	if (text[n] == '.')
		decimals = strspn(text + n + 1, "0123456789"), n += 1 + decimals;
	if (whole + decimals == 0)
		return false;
	if (text[n] == 'e' || text[n] == 'E') {
		n += 1 + (text[n + 1] == '+' || text[n + 1] == '-');
		if (!strspn(text + n, "0123456789"))
			return false;
		n += strspn(text + n, "0123456789");
	}
	return !text[n];
}

/* Whether a cell marks a failed run: empty, "nan" or "NA". */
static bool is_failed(const char *text)
{
	return !*text || strcasecmp(text, "nan") == 0 || strcmp(text, "NA") == 0;
}

bool csv_number(const struct csv *csv, double *value)
{
	*value = NAN;
	if (is_failed(csv->cell))
		return true;
	if (csv->cut || !is_decimal(csv->cell))
		return false;
	*value = strtod(csv->cell, NULL);
	return isfinite(*value);
}

/* Adds the problems of the name of column c, in the current cell; same: an earlier column with this name, or -1. */
void csv_name_check(const struct csv *csv, int c, int same)
{
	char what[CSV_CELL_SIZE + 80];
	double number;
	snprintf(what, sizeof what, "column %d has no name; pandas writes its index this way unless index=False",
	         c + 1);
	if (!*csv->cell)
		csv_complain(csv, NULL, what);
	snprintf(what, sizeof what, "must be the name of a column, got \"%.40s\"", csv->cell);
	if (*csv->cell && csv_number(csv, &number) && !isnan(number))
		csv_complain(csv, NULL, what);
	snprintf(what, sizeof what, "must be shorter than %d bytes", CSV_CELL_SIZE);
	if (csv->cut)
		csv_complain(csv, csv->cell, what);
	snprintf(what, sizeof what, "is already the name of column %d", same + 1);
	if (same >= 0 && *csv->cell)
		csv_complain(csv, csv->cell, what);
}

/* Whether the text is UTF-8; if not, the current line is the first invalid one. */
bool csv_is_text(struct csv *csv)
{
	const char *at = csv->at;
	for (size_t n; at < csv->end && (n = json_strict_character(at, (size_t)(csv->end - at))) > 0; at += n)
		csv->line += *at == '\n';
	if (at < csv->end)
		csv_complain(csv, NULL, "is not UTF-8");
	else
		csv->line = 1;
	return at == csv->end;
}

size_t csv_variance_stem(const char *name)
{
	static const char suffix[] = ".variance";
	const size_t n = strlen(name), length = sizeof suffix - 1;
	return n > length && strcmp(name + n - length, suffix) == 0 ? n - length : 0;
}

size_t csv_replicate_stem(const char *name, int *replicate)
{
	static const char suffix[] = ".replicate";
	const size_t n = strlen(name), length = sizeof suffix - 1;
	size_t end = n;
	*replicate = 0;
	while (end > 0 && name[end - 1] >= '0' && name[end - 1] <= '9')
		end--;
	if (end == n || name[end] == '0' || n - end > 4 || end <= length ||
	    strncmp(name + end - length, suffix, length) != 0)
		return 0;
	*replicate = (int)strtol(name + end, NULL, 10);
	return end - length;
}
