/* record_peer.c - PEER strong motion and NGA-West2 files.
 *
 *   PEER NGA STRONG MOTION DATABASE RECORD
 *   Imperial Valley-06, 10/15/1979, El Centro Array #6, 230
 *   ACCELERATION TIME SERIES IN UNITS OF G
 *   NPTS=   7807, DT=   .0050 SEC,              or    7807    0.0050    NPTS, DT
 *     -.2309213E-03   ...                       any number of samples per line
 *
 * Source   headers of files of NGA-West2 and of the older PEER database */
#include "schema/json/json_writer.h"
#include "schema/record/record_text.h"

#include <stdio.h>
#include <string.h>

enum { HEADER_LINES = 8 }; /* lines within which the four lines must be, blank ones included */

/* Moves to the line with the type of the series; false: none among the first lines. */
static bool series_line(struct record_text *text)
{
	for (int i = 0; i < HEADER_LINES && record_text_next(text); i++)
		if (record_text_find(text, "TIME SERIES IN UNITS OF") >= 0 ||
		    record_text_find(text, "TIME HISTORY IN UNITS OF") >= 0)
			return true;
	return false;
}

bool record_peer_recognized(struct record_text *text)
{
	return series_line(text);
}

/* Reads the number of samples and the step from the line with NPTS and DT. */
static bool read_size(struct record_text *text, double *n, double *step)
{
	for (int i = 0; i < HEADER_LINES && record_text_next(text); i++) {
		const int npts = record_text_find(text, "NPTS"), dt = record_text_find(text, "DT");
		if (npts < 0 || dt < 0)
			continue;
		if (record_text_value(text, npts + 4, n) && record_text_value(text, dt + 2, step))
			return true;
		// in the older form the numbers come before the names
		const char *end = text->line.text + text->line.length, *c = text->line.text;
		while (c < end && *c == ' ')
			c++;
		const int length = record_number(c, end, n);
		if (length > 0 && record_number(c + length, end, step) > 0)
			return true;
		record_text_complain(text, 0, "expected `NPTS= 7807, DT= .0050 SEC' or `7807 0.0050 NPTS, DT'");
		return false;
	}
	record_text_complain(text, -1, "the header of a PEER file needs a line with NPTS and DT");
	return false;
}

bool record_peer_read(struct record_text *text, struct record *record)
{
	struct record_text head = *text;
	series_line(text);
	for (int i = 1; record_text_next(&head) && head.line.number < text->line.number; i++)
		if (record_text_find(&head, "DATABASE RECORD") < 0)
			record_text_title(&head, 0, record->title);
	static const char *const others[] = {"VELOCITY", "DISPLACEMENT"};
	for (int k = 0; k < 2; k++)
		if (record_text_begins(text, others[k])) {
			record_text_complain(
			    text, 1, "this is a %s series (%s); expected the acceleration of the same record (.AT2)",
			    k ? "displacement" : "velocity", k ? ".DT2" : ".VT2");
			return false;
		}
	const int units = record_text_find(text, "UNITS OF") + 8;
	char unit[32];
	snprintf(unit, sizeof unit, "%.*s", text->line.length - units, text->line.text + units);
	const double factor = record_unit(unit + strspn(unit, " "), &record->unit);
	if (factor == 0) {
		record_text_complain(text, units + 1, "the unit must be G, CM/S2 or M/S2, got `%s'", unit);
		return false;
	}
	double n, step;
	if (!read_size(text, &n, &step) || !record_sized(text, n, step, record))
		return false;
	if (!record_text_samples(text, 0, (int)n, record))
		return false;
	while (record_text_next(text))
		if (!record_text_blank(text)) {
			record_text_complain(text, 1, "the file has more samples than the %d of the header", (int)n);
			return false;
		}
	record_scale(record, factor);
	return true;
}

/* A record as a PEER file.
 *
 * Returns  value   (length)   NULL: out of memory
 * Memory   allocates; the caller frees
 *
 * Valid    A sample that is read back differs at most by the rounding of its division by g.
 * Test     unit_motions: a_peer_file_is_read_back
 */
char *record_to_peer(const struct record *record, size_t *length)
{
	enum { PER_LINE = 3 };
	const char *unit;
	const double g = record_unit("g", &unit);
	struct writer w;
	char text[RECORD_TITLE + 160];
	writer_init(&w);
	int n = snprintf(text, sizeof text,
	                 "PEER STRONG MOTION DATABASE RECORD\n%s\nACCELERATION TIME SERIES IN UNITS OF G\n"
	                 "NPTS= %d, DT= %.17g SEC,\n",
	                 record->title, record->n, record->step);
	writer_raw(&w, text, (size_t)n);
	for (int i = 0; i < record->n; i++) {
		n = snprintf(text, sizeof text, "%25.16E%s", record->acceleration[i] / g,
		             i % PER_LINE == PER_LINE - 1 || i == record->n - 1 ? "\n" : "");
		writer_raw(&w, text, (size_t)n);
	}
	return writer_take(&w, length);
}
