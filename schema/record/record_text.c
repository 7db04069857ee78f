/* record_text.c - reads lines, numbers and units of a record's file. */
#include "schema/record/record_text.h"

#include <math.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>

#include "schema/study/study_json.h"

static bool is_blank(char c)
{
	return c == ' ' || c == '\t' || c == '\r';
}

static bool is_digit(char c)
{
	return c >= '0' && c <= '9';
}

/* ---- lines ---- */

bool record_text_next(struct record_text *text)
{
	if (text->at >= text->end)
		return false;
	const char *newline = memchr(text->at, '\n', (size_t)(text->end - text->at));
	const char *stop = newline ? newline : text->end;
	text->line.text = text->at;
	text->line.number++;
	text->at = newline ? newline + 1 : text->end;
	while (stop > text->line.text && is_blank(stop[-1]))
		stop--;
	text->line.length = (int)(stop - text->line.text);
	return true;
}

void record_text_back(struct record_text *text)
{
	text->at = text->line.text;
	text->line.number--;
}

void record_text_complain(struct record_text *text, int column, const char *format, ...)
{
	char what[256], place[64] = "";
	va_list values;
	va_start(values, format);
	vsnprintf(what, sizeof what, format, values);
	va_end(values);
	if (column > 0)
		snprintf(place, sizeof place, "line %d, column %d", text->line.number, column);
	else if (column == 0)
		snprintf(place, sizeof place, "line %d", text->line.number);
	problems_add(text->problems, place, "%s", what);
	text->problems->status = PROBLEMS_INVALID;
}

int record_text_find(const struct record_text *text, const char *phrase)
{
	const int n = (int)strlen(phrase);
	for (int i = 0; i + n <= text->line.length; i++)
		if (strncasecmp(text->line.text + i, phrase, (size_t)n) == 0)
			return i;
	return -1;
}

static int first_of(const struct record_text *text)
{
	int i = 0;
	while (i < text->line.length && is_blank(text->line.text[i]))
		i++;
	return i;
}

bool record_text_begins(const struct record_text *text, const char *phrase)
{
	return record_text_find(text, phrase) == first_of(text);
}

bool record_text_blank(const struct record_text *text)
{
	return text->line.length == 0;
}

bool record_text_value(const struct record_text *text, int at, double *value)
{
	const char *c = text->line.text + at, *end = text->line.text + text->line.length;
	while (c < end && (is_blank(*c) || *c == '=' || *c == ':'))
		c++;
	return record_number(c, end, value) > 0;
}

void record_text_title(const struct record_text *text, int from, char title[RECORD_TITLE])
{
	const size_t used = strlen(title);
	const char *c = text->line.text + from;
	int n = text->line.length - from;
	while (n > 0 && is_blank(*c))
		c++, n--;
	if (n > 0)
		snprintf(title + used, RECORD_TITLE - used, "%s%.*s", used ? ", " : "", n, c);
}

/* ---- numbers ---- */

int record_number(const char *at, const char *end, double *value)
{
	char digits[64];
	int n = 0, figures = 0;
	const char *c = at;
	const int room = (int)sizeof digits - 1;
	if (c < end && (*c == '+' || *c == '-'))
		digits[n++] = *c++;
	for (bool point = false; c < end && n < room && (is_digit(*c) || (*c == '.' && !point)); c++) {
		point |= *c == '.';
		figures += is_digit(*c);
		digits[n++] = *c;
	}
	if (figures == 0)
		return 0;
	if (c < end && n < room && strchr("eEdD", *c)) {
		const char *power = c + 1;
		if (power < end && (*power == '+' || *power == '-'))
			power++;
		if (power >= end || !is_digit(*power))
			return 0;
		digits[n++] = 'e';
		for (c++; c < end && n < room && (c < power || is_digit(*c)); c++)
			digits[n++] = *c;
	}
	if (n >= room || (c < end && !is_blank(*c) && !strchr(",;+-", *c)))
		return 0;
	digits[n] = 0;
	*value = strtod(digits, NULL);
	if (!isfinite(*value))
		return 0;
	while (c < end && is_blank(*c))
		c++;
	if (c < end && (*c == ',' || *c == ';'))
		c++;
	while (c < end && is_blank(*c))
		c++;
	return (int)(c - at);
}

/* ---- samples ---- */

bool record_reserve(struct record_text *text, struct record *record, int n)
{
	double *more = realloc(record->acceleration, (size_t)n * sizeof *more);
	if (!more) {
		text->problems->status = PROBLEMS_NOMEM;
		return false;
	}
	record->acceleration = more;
	return true;
}

bool record_sized(struct record_text *text, double n, double step, struct record *record)
{
	if (!(n >= 2 && n <= STUDY_SAMPLES_MAX && n == floor(n)))
		record_text_complain(text, 0, "the number of samples must be a whole number in [2, %d], got %.15g",
		                     STUDY_SAMPLES_MAX, n);
	else if (!(step > 0 && step < INFINITY))
		record_text_complain(text, 0, "the time step must be greater than 0 s, got %.15g", step);
	else {
		record->step = step;
		return record_reserve(text, record, (int)n);
	}
	return false;
}

/* Reads the numbers of the current line. */
static bool line_samples(struct record_text *text, int width, int expected, struct record *record)
{
	const char *start = text->line.text, *end = start + text->line.length;
	for (const char *c = width ? start : start + first_of(text); c < end;) {
		const char *stop = width && c + width < end ? c + width : end, *from = c;
		while (from < stop && is_blank(*from))
			from++;
		double value;
		const int length = record_number(from, stop, &value);
		const int column = (int)(from - start) + 1;
		if (length == 0 || (width && from + length < stop))
			record_text_complain(text, column, "expected a number, got `%.*s'",
			                     (int)(end - from < 20 ? end - from : 20), from);
		else if (record->n == expected)
			record_text_complain(text, column, "the file has more samples than the %d of the header",
			                     expected);
		else {
			record->acceleration[record->n++] = value;
			c = width ? stop : from + length;
			continue;
		}
		return false;
	}
	return true;
}

bool record_text_samples(struct record_text *text, int width, int expected, struct record *record)
{
	while (record->n < expected && record_text_next(text))
		if (!line_samples(text, width, expected, record))
			return false;
	if (record->n < expected) {
		record_text_complain(text, 0,
		                     "the header announces %d samples, but the file ends after %d: it is truncated; "
		                     "get the complete file, or correct the header",
		                     expected, record->n);
		return false;
	}
	return true;
}

void record_scale(struct record *record, double factor)
{
	for (int i = 0; i < record->n; i++)
		record->acceleration[i] *= factor;
}

/* ---- units ---- */

/* Units of acceleration with their spellings in files.  Source of g: standard gravity, 3rd CGPM 1901. */
static const struct {
	const char *name;
	double factor; /* to m/s2 */
	const char *spellings[9];
} units[] = {
    {"g", 9.80665, {"g"}},
    {"cm/s2",
     0.01,
     {"cm/s2", "cm/s^2", "cm/s**2", "cm/sec2", "cm/sec^2", "cm/sec/sec", "cm/s/s", "cm_s2", "gal"}},
    {"m/s2", 1, {"m/s2", "m/s^2", "m/s**2", "m/sec2", "m/sec^2", "m/sec/sec", "m/s/s", "m_s2"}},
};

enum { UNITS = sizeof units / sizeof units[0], SPELLINGS = 9 };

const char *record_unit_name(int row)
{
	return row >= 0 && row < UNITS ? units[row].name : NULL;
}

double record_unit(const char *text, const char **name)
{
	for (int row = 0; row < UNITS; row++)
		for (int k = 0; k < SPELLINGS && units[row].spellings[k]; k++) {
			const char *spelling = units[row].spellings[k];
			const size_t n = strlen(spelling);
			if (strncasecmp(text, spelling, n) == 0 && !strchr("/^*", text[n] ? text[n] : ' ') &&
			    !(text[n] >= 'a' && text[n] <= 'z') && !(text[n] >= 'A' && text[n] <= 'Z')) {
				*name = units[row].name;
				return units[row].factor;
			}
		}
	return 0;
}

double record_unit_chosen(struct record_text *text, const char **name)
{
	const char *unit = text->choice->unit;
	const double factor = unit ? record_unit(unit, name) : 0;
	if (!unit)
		record_text_complain(
		    text, -1,
		    "the file does not name the unit of its accelerations: give `unit`, one of g, cm/s2 and m/s2");
	else if (factor == 0)
		record_text_complain(text, -1, "the unit must be g, cm/s2 or m/s2, got `%.40s'", unit);
	return factor;
}
