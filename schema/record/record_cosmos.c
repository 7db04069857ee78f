/* record_cosmos.c - COSMOS strong motion format 1.20: V1 and V2 files, one channel or several.
 *
 *   Corrected acceleration  (Format v01.20 with 13 text lines) Src: ...
 *    100 Integer-header values follow on  10 lines, Format= (10I8)
 *    100 Real-header values follow on  20 lines, Format= (5F15.6)
 *      1 Comment line(s) follow, each starting with a "|":
 *   26219 acceleration pts, approx  131 secs, units=cm/sec2(04),Format=(8F10.3)
 *
 * Numbers have the width in their line's format, possibly without blanks between them.  The step is real value 34, the sampling
 * interval in s; if that is unknown (-999), real value 62, the time between data points in ms.
 *
 * Source   COSMOS Strong Motion Programs Board, Strong Motion Data Format, version 1.20, 2001 */
#include "schema/record/record_text.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { REALS_MAX = 200, INTERVAL = 34, INTERVAL_MS = 62, TITLE_LINES = 2, FIRST_LINES = 60 };

struct channel {
	double reals[REALS_MAX + 1]; /* real values by their number, from 1; NAN: missing */
	int n;                       /* accelerations so far */
	char title[RECORD_TITLE];
};

bool record_cosmos_recognized(struct record_text *text)
{
	for (int i = 0; i < FIRST_LINES && record_text_next(text); i++)
		if (record_text_find(text, "(Format v") >= 0 ||
		    record_text_find(text, "Integer-header values follow") >= 0)
			return true;
	return false;
}

/* Width of the numbers from the current line's Format= (8F10.3); 0: no format. */
static int format_width(const struct record_text *text)
{
	const int at = record_text_find(text, "Format");
	const char *end = text->line.text + text->line.length, *c = at < 0 ? end : text->line.text + at;
	while (c < end && *c != '(')
		c++;
	for (c += c < end; c < end && *c >= '0' && *c <= '9'; c++)
		;
	if (c >= end || !strchr("fFeEiIgGdD", *c))
		return 0;
	const int width = atoi(c + 1); // at least a line end follows
	return width > 0 && width < 64 ? width : 0;
}

/* Reads the real values after the current line. */
static bool read_reals(struct record_text *text, struct channel *channel)
{
	double n;
	const int width = format_width(text);
	for (int i = 0; i <= REALS_MAX; i++)
		channel->reals[i] = NAN;
	if (!record_text_value(text, (int)strspn(text->line.text, " \t"), &n) || !(n >= 0 && n <= REALS_MAX) ||
	    !width) {
		record_text_complain(text, 0,
		                     "expected `100 Real-header values follow on 20 lines, Format= (5F15.6)'");
		return false;
	}
	for (int i = 1; i <= n && record_text_next(text);)
		for (int at = 0; at < text->line.length && i <= n; at += width, i++) {
			const char *c = text->line.text + at, *end = text->line.text + text->line.length;
			const char *stop = c + width < end ? c + width : end;
			while (c < stop && *c == ' ')
				c++;
			if (record_number(c, stop, &channel->reals[i]) == 0) {
				record_text_complain(text, at + 1, "expected a number of %d columns", width);
				return false;
			}
		}
	return true;
}

/* The step of a channel; NAN: not in the header. */
static double step_of(const struct channel *channel)
{
	const double seconds = channel->reals[INTERVAL], milliseconds = channel->reals[INTERVAL_MS];
	return seconds > 0 ? seconds : milliseconds > 0 ? milliseconds / 1000 : NAN;
}

/* Whether the current line is the header of data, and whether the data are accelerations. */
static bool is_data(const struct record_text *text, bool *acceleration)
{
	if (record_text_find(text, "pts") < 0 || record_text_find(text, "units") < 0 || !format_width(text))
		return false;
	*acceleration = record_text_find(text, "accel") >= 0;
	return true;
}

/* Reads the accelerations after their header, the current line. */
static bool read_data(struct record_text *text, const struct channel *channel, struct record *record)
{
	double n = 0;
	const int width = format_width(text);
	const int units = record_text_find(text, "units") + 5;
	char unit[32];
	snprintf(unit, sizeof unit, "%.*s", text->line.length - units, text->line.text + units);
	const double factor = record_unit(unit + strspn(unit, " ="), &record->unit);
	if (factor == 0) {
		record_text_complain(
		    text, units + 1,
		    "the unit must be cm/sec2, m/sec2 or g, got `%.20s'; raw counts (V0) have no unit of "
		    "acceleration: use the V1 or V2 file",
		    unit + strspn(unit, " ="));
		return false;
	}
	record_text_value(text, (int)strspn(text->line.text, " \t"), &n);
	const double step = step_of(channel);
	if (isnan(step)) {
		record_text_complain(text, 0, "the real header has no sampling interval (value %d in s or %d in ms)",
		                     INTERVAL, INTERVAL_MS);
		return false;
	}
	memcpy(record->title, channel->title, sizeof record->title);
	if (!record_sized(text, n, step, record) || !record_text_samples(text, width, (int)n, record))
		return false;
	record_scale(record, factor);
	return true;
}

/* Scans the file up to acceleration number `wanted`, from 1, and reads it; wanted 0: counts all accelerations. */
static bool scan(struct record_text *text, struct channel *channel, int wanted, struct record *record)
{
	int title = 0;
	while (record_text_next(text)) {
		bool acceleration;
		if (record_text_find(text, "(Format v") >= 0) {
			title = TITLE_LINES;
			channel->title[0] = 0;
		} else if (title > 0) {
			title--;
			record_text_title(text, 0, channel->title);
		}
		if (record_text_find(text, "Real-header values follow") >= 0) {
			if (!read_reals(text, channel))
				return false;
		} else if (is_data(text, &acceleration) && acceleration && ++channel->n == wanted)
			return read_data(text, channel, record);
	}
	return true;
}

bool record_cosmos_read(struct record_text *text, struct record *record)
{
	struct channel all = {0}, one = {0};
	struct record_text whole = *text;
	const int wanted = text->choice->channel;
	if (!scan(&whole, &all, 0, record))
		return false;
	if (all.n == 0)
		record_text_complain(text, -1,
		                     "the file has no accelerations; a V3 file has spectra only: use the V2 file");
	else if (wanted > all.n)
		record_text_complain(text, -1, "no channel %d: the file has %d", wanted, all.n);
	else if (wanted == 0 && all.n > 1)
		record_text_complain(text, -1, "the file has %d channels with accelerations: choose one, 1 to %d",
		                     all.n, all.n);
	else
		return scan(text, &one, wanted ? wanted : 1, record);
	return false;
}
