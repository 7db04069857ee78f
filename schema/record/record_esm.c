/* record_esm.c - files of the Engineering Strong Motion database and of ITACA.
 *
 *   EVENT_NAME: CENTRAL_ITALY
 *   STATION_CODE: AMT                     lines KEY: value, the value may be empty
 *   SAMPLING_INTERVAL_S: 0.005000
 *   NDATA: 12000
 *   UNITS: cm/s^2
 *   0.001234                              one sample per line
 *
 * Source   headers of files of both databases (DYNA 1.x) */
#include "schema/record/record_text.h"

#include <stdio.h>
#include <string.h>

enum { KEYS_FIRST = 3 }; /* lines KEY: value at the start that identify such a file */

static bool has_key(const struct record_text *text)
{
	int n = 0;
	while (n < text->line.length && (strchr("_/^0123456789", text->line.text[n]) ||
	                                 (text->line.text[n] >= 'A' && text->line.text[n] <= 'Z')))
		n++;
	return n > 0 && n < text->line.length && text->line.text[n] == ':';
}

bool record_esm_recognized(struct record_text *text)
{
	for (int i = 0; i < KEYS_FIRST; i++)
		if (!record_text_next(text) || !has_key(text))
			return false;
	return true;
}

bool record_esm_read(struct record_text *text, struct record *record)
{
	double n = 0, step = 0, factor = 0;
	static const char *const titles[] = {"EVENT_NAME:", "EVENT_ID:", "STATION_CODE:", "STREAM:"};
	while (record_text_next(text) && (has_key(text) || record_text_blank(text))) {
		const char *colon = memchr(text->line.text, ':', (size_t)text->line.length);
		const int value = colon ? (int)(colon - text->line.text) + 1 : 0;
		char word[32];
		snprintf(word, sizeof word, "%.*s", text->line.length - value, text->line.text + value);
		for (int k = 0; k < 4; k++)
			if (record_text_begins(text, titles[k]))
				record_text_title(text, value, record->title);
		if (record_text_begins(text, "SAMPLING_INTERVAL_S:"))
			record_text_value(text, value, &step);
		else if (record_text_begins(text, "NDATA:") || record_text_begins(text, "NPTS:"))
			record_text_value(text, value, &n);
		else if (record_text_begins(text, "DATA_TYPE:") && record_text_find(text, "ACCELERATION") < 0) {
			record_text_complain(text, value + 1, "expected DATA_TYPE: ACCELERATION, got%s", word);
			return false;
		} else if (record_text_begins(text, "UNITS:")) {
			factor = record_unit(word + strspn(word, " "), &record->unit);
			if (factor == 0) {
				record_text_complain(text, value + 1, "the unit must be cm/s^2, m/s^2 or g, got%s", word);
				return false;
			}
		}
	}
	static const char missing[] = "the header has no valid line %s";
	if (step == 0)
		record_text_complain(text, -1, missing, "SAMPLING_INTERVAL_S: 0.005");
	if (n == 0)
		record_text_complain(text, -1, missing, "NDATA: 12000");
	if (factor == 0)
		record_text_complain(text, -1, missing, "UNITS: cm/s^2");
	if (step == 0 || n == 0 || factor == 0)
		return false;
	record_text_back(text);
	if (!record_sized(text, n, step, record) || !record_text_samples(text, 0, (int)n, record))
		return false;
	while (record_text_next(text))
		if (!record_text_blank(text)) {
			record_text_complain(text, 1, "the file has more samples than NDATA = %d", (int)n);
			return false;
		}
	record_scale(record, factor);
	return true;
}
