/* record_columns.c - times and accelerations in two columns, or only accelerations with a step given by the user.
 *
 * Lines before the first line that begins with a number are a header, as are lines that begin with #, % or !.  A unit in the header,
 * in brackets or after `in', `of' or `_', is the unit of the accelerations: `time_s,acceleration_g'. */
#include "schema/record/record_text.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "schema/study/study_json.h"

enum { FIRST_SAMPLES = 4096, PAIR = 2 };

bool record_columns_recognized(struct record_text *text)
{
	(void)text;
	return true;
}

static bool is_comment(const struct record_text *text)
{
	return record_text_blank(text) || strchr("#%!", text->line.text[0]);
}

static int first_number(const struct record_text *text, double *value)
{
	const int blanks = (int)strspn(text->line.text, " \t");
	return blanks >= text->line.length
	           ? 0
	           : record_number(text->line.text + blanks, text->line.text + text->line.length, value);
}

/* ---- units ---- */

/* Whether a unit may begin at c: after a bracket, `_', "in " or "of ". */
static bool unit_place(const char *start, const char *c)
{
	if (c == start)
		return false;
	return strchr("[(_", c[-1]) ||
	       (c - start >= 3 && (strncmp(c - 3, "in ", 3) == 0 || strncmp(c - 3, "of ", 3) == 0));
}

/* Sets the unit if a header line names a unit of acceleration. */
static void header_unit(const struct record_text *text, const char **unit)
{
	char line[256];
	snprintf(line, sizeof line, "%.*s", text->line.length, text->line.text);
	for (char *c = line; *c; c++) {
		const char *name;
		if (unit_place(line, c) && record_unit(c, &name) > 0)
			*unit = name;
	}
}

/* The factor of the unit from the header or from the user; 0: a problem was added. */
static double factor_of(struct record_text *text, const char *header, struct record *record)
{
	const char *chosen = text->choice->unit;
	if (!header || chosen) {
		const double factor = record_unit_chosen(text, &record->unit);
		if (factor > 0 && header && strcmp(header, record->unit) != 0) {
			record_text_complain(text, -1, "the header has the unit %s, but %s was given", header,
			                     record->unit);
			return 0;
		}
		return factor;
	}
	return record_unit(header, &record->unit);
}

/* ---- numbers ---- */

/* Column, from 1, of a decimal comma in the current line: a comma between digits if blanks or semicolons separate the numbers;
 * 0: none. */
static int decimal_comma(const struct record_text *text)
{
	const char *c = text->line.text;
	const int n = text->line.length;
	bool parted = false;
	int place = 0;
	for (int i = 1; i + 1 < n; i++) {
		const bool inside = c[i - 1] >= '0' && c[i - 1] <= '9' && c[i + 1] >= '0' && c[i + 1] <= '9';
		parted |= c[i] == ';' || ((c[i] == ' ' || c[i] == '\t') && c[i - 1] != ',' && c[i - 1] != ' ');
		if (c[i] == ',' && inside && !place)
			place = i + 1;
	}
	return parted ? place : 0;
}

/* All numbers of the file, by line. */
struct numbers {
	int columns; /* numbers in the first line */
	int n, size;
	double *value;
	int *line;       /* line of each number, for messages  (size) */
	double interval; /* resolution of the printed times: one unit of the last digit [s] */
};

static bool numbers_add(struct record_text *text, struct numbers *numbers, double value)
{
	if (numbers->n == numbers->size) {
		const int size = numbers->size ? 2 * numbers->size : FIRST_SAMPLES;
		double *more = realloc(numbers->value, (size_t)size * sizeof *more);
		int *lines = more ? realloc(numbers->line, (size_t)size * sizeof *lines) : NULL;
		if (more)
			numbers->value = more;
		if (lines)
			numbers->line = lines;
		if (!lines) {
			text->problems->status = PROBLEMS_NOMEM;
			return false;
		}
		numbers->size = size;
	}
	if (numbers->n >= PAIR * STUDY_SAMPLES_MAX) {
		record_text_complain(text, 0, "a record may have at most %d samples", STUDY_SAMPLES_MAX);
		return false;
	}
	numbers->line[numbers->n] = text->line.number;
	numbers->value[numbers->n++] = value;
	return true;
}

/* One unit of the last digit of the number that starts a line: 0.0001 of "12.3450". */
static double last_digit(const struct record_text *text)
{
	const char *c = text->line.text + strspn(text->line.text, " \t+-");
	double digit = 1;
	bool point = false;
	for (; (*c >= '0' && *c <= '9') || *c == '.'; c++) {
		digit *= point ? 0.1 : 1;
		point |= *c == '.';
	}
	return strchr("eEdD", *c) && *c ? digit * pow(10, atoi(c + 1)) : digit;
}

/* Adds the numbers of the current line. */
static bool line_numbers(struct record_text *text, struct numbers *numbers)
{
	const char *start = text->line.text, *end = start + text->line.length, *c = start + strspn(start, " \t");
	const int comma = decimal_comma(text), before = numbers->n;
	if (comma) {
		record_text_complain(text, comma, "a comma between digits: decimal numbers need a point");
		return false;
	}
	while (c < end) {
		double value;
		const int length = record_number(c, end, &value);
		if (length == 0) {
			record_text_complain(text, (int)(c - start) + 1, "expected a number, got `%.*s'",
			                     (int)(end - c < 20 ? end - c : 20), c);
			return false;
		}
		if (!numbers_add(text, numbers, value))
			return false;
		c += length;
	}
	const int columns = numbers->n - before;
	if (!numbers->columns)
		numbers->columns = columns;
	if (text->choice->step == 0 && numbers->columns != PAIR) {
		record_text_complain(
		    text, 0,
		    "has %d number%s; expected a time and an acceleration, or give the time step of accelerations "
		    "alone",
		    columns, columns == 1 ? "" : "s");
		return false;
	}
	if (text->choice->step == 0 && columns != numbers->columns) {
		record_text_complain(text, 0, "has %d numbers where the first line has %d", columns,
		                     numbers->columns);
		return false;
	}
	const double digit = last_digit(text);
	if (before == 0 || digit > numbers->interval)
		numbers->interval = digit;
	return true;
}

/* ---- times ---- */

/* A number rounded to the fewest decimal digits with which it changes by at most `doubt`. */
static double fewest_digits(double value, double doubt, int *digits)
{
	for (*digits = 1; *digits < 17; ++*digits) {
		char text[40];
		snprintf(text, sizeof text, "%.*g", *digits, value);
		const double rounded = strtod(text, NULL);
		if (fabs(rounded - value) <= doubt)
			return rounded;
	}
	return value;
}

/* The step of times with a given mean step: the step or the sampling rate is rounded, whichever needs fewer digits.
 *
 *   Times printed with unit u of the last digit have errors of up to u/2, so the mean step of n times of up to u/(n - 1). */
static double step_of(const struct numbers *numbers, double mean)
{
	const double doubt =
	    numbers->interval / (numbers->n / 2 - 1) + 4e-16 * fabs(numbers->value[numbers->n - 2]);
	int digits, digits_rate;
	const double step = fewest_digits(mean, doubt, &digits);
	const double rate = fewest_digits(1 / mean, doubt / (mean * mean), &digits_rate);
	return digits_rate <= digits ? 1 / rate : step;
}

/* Whether the times are equally spaced within their last digit; adds a problem if not. */
static bool times_even(struct record_text *text, const struct numbers *numbers, double step)
{
	const double *t = numbers->value;
	for (int i = 1; i < numbers->n / 2; i++) {
		const double want = t[0] + i * step, off = fabs(t[2 * i] - want);
		if (t[2 * i] > t[2 * i - 2] && off <= numbers->interval + 1e-12 * fabs(want) && off < 0.5 * step)
			continue;
		text->line.number = numbers->line[2 * i];
		record_text_complain(text, 1, "the times must increase by equal steps: expected %.9g s, got %.9g s",
		                     want, t[2 * i]);
		return false;
	}
	return true;
}

/* Takes times and accelerations from two columns. */
static bool take_pairs(struct record_text *text, const struct numbers *numbers, struct record *record)
{
	const int rows = numbers->n / 2;
	const double mean = rows > 1 ? (numbers->value[numbers->n - 2] - numbers->value[0]) / (rows - 1) : 1;
	if (!times_even(text, numbers, mean) ||
	    !record_sized(text, rows, rows > 1 ? step_of(numbers, mean) : mean, record))
		return false;
	for (int i = 0; i < rows; i++)
		record->acceleration[i] = numbers->value[2 * i + 1];
	record->n = rows;
	return true;
}

/* Takes only accelerations, any number per line. */
static bool take_all(struct record_text *text, const struct numbers *numbers, struct record *record)
{
	const double step = text->choice->step;
	const double *t = numbers->value;
	if (numbers->columns == PAIR && numbers->n >= 6 && t[2] - t[0] > 0 &&
	    fabs(t[2] - t[0] - step) <= numbers->interval && fabs(t[4] - t[2] - step) <= numbers->interval) {
		record_text_complain(text, -1,
		                     "the first column looks like times with the given step: omit the step");
		return false;
	}
	if (!record_sized(text, numbers->n, step, record))
		return false;
	memcpy(record->acceleration, numbers->value, (size_t)numbers->n * sizeof *numbers->value);
	record->n = numbers->n;
	return true;
}

static bool read_numbers(struct record_text *text, struct numbers *numbers, const char **unit,
                         struct record *record)
{
	double value;
	bool begun = false;
	while (record_text_next(text)) {
		if (is_comment(text) || (!begun && first_number(text, &value) == 0 && !decimal_comma(text))) {
			header_unit(text, unit);
			if (!record_text_blank(text) && !begun)
				record_text_title(text, (int)strspn(text->line.text, "#%! "), record->title);
			continue;
		}
		begun = true;
		if (!line_numbers(text, numbers))
			return false;
	}
	return true;
}

static bool take(struct record_text *text, const struct numbers *numbers, struct record *record)
{
	if (numbers->n == 0)
		record_text_complain(text, -1, "the file has no numbers");
	else if (text->choice->step > 0)
		return take_all(text, numbers, record);
	else
		return take_pairs(text, numbers, record);
	return false;
}

bool record_columns_read(struct record_text *text, struct record *record)
{
	struct numbers numbers = {0};
	const char *header = NULL;
	bool good = read_numbers(text, &numbers, &header, record) && take(text, &numbers, record);
	const double factor = good ? factor_of(text, header, record) : 0;
	record_scale(record, factor);
	free(numbers.value);
	free(numbers.line);
	return factor > 0;
}
