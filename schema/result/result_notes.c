/* result_notes.c - notes about estimates of indices outside [0, 1] or outside their intervals, and notes of an output.
 *
 * An index lies in [0, 1].  Estimates are not clipped, so the estimate of a small index may be below 0.  An estimate further
 * outside, or outside its own interval, has another cause, which the note names. */
#include "schema/result/result_notes.h"

#include <assert.h>
#include <math.h>
#include <stdio.h>
#include <string.h>

// bound of rounding errors in sums over up to 2^20 rows: an index of exactly 0 or 1 gets no note
static const double ROUNDING = 0x1p-33;

/* ---- conditions on an estimate ---- */

/* Distance of a number from [0, 1]. */
static double beyond(double value)
{
	return fmax(fmax(-value, value - 1), 0);
}

// off by more than the whole variance: too far for a sampling error of a variance fraction
static bool far(const struct pound_estimate *e)
{
	return beyond(e->value) > 1;
}

static bool outside(const struct pound_estimate *e)
{
	return e->value < e->low - ROUNDING || e->value > e->high + ROUNDING;
}

static bool impossible(const struct pound_estimate *e)
{
	return beyond(e->value) > ROUNDING;
}

static bool without_interval(const struct pound_estimate *e)
{
	return impossible(e) && isnan(e->high - e->low);
}

static bool interval_impossible(const struct pound_estimate *e)
{
	return e->high < -ROUNDING || e->low > 1 + ROUNDING;
}

static bool below(const struct pound_estimate *e)
{
	return impossible(e) && e->value < 0;
}

// clang-format off
/* The first rule that holds gives the note. */
static const struct rule {
	bool (*holds)(const struct pound_estimate *e);
	bool lost;  /* only if the noise-corrected variance may be 0 */
	bool small; /* a sampling error that its interval shows */
	const char *text;
} rules[] = {
	{far,                 true,  false, "far outside [0, 1] as the variance corrected for the signals' noise may be 0 (use more signals)"},
	{far,                 false, false, "far outside [0, 1] as there are too few rows to estimate the variance (use more rows)"},
	{outside,             true,  false, "outside its own interval as the variance corrected for the signals' noise may be 0 (use more signals)"},
	{outside,             false, false, "outside its own interval as there are too few rows for an interval (use more rows)"},
	{without_interval,    false, false, "outside [0, 1], and too few rows for an interval (use more rows)"},
	{interval_impossible, false, true,  "outside [0, 1] with its whole interval, so the error is larger than the interval shows"},
	{below,               false, true,  "below 0 by sampling error, so the index is between 0 and the upper end of its interval"},
	{impossible,          false, true,  "above 1 by sampling error, so the index is between the lower end of its interval and 1"},
};
// clang-format on

static_assert(sizeof rules / sizeof rules[0] == RESULT_NOTES, "a row of names for each rule");

void result_notes_init(struct result_notes *notes)
{
	for (int k = 0; k < RESULT_NOTES; k++)
		*notes->names[k] = 0;
}

/* Adds an estimate to the names of the note that applies to it, if any.
 *
 * Test     unit_result_notes
 */
void result_notes_add(struct result_notes *notes, const char *name, const struct pound_estimate *estimate,
                      struct result_notes_source source)
{
	int k = 0;
	while (k < RESULT_NOTES && !(rules[k].holds(estimate) && (source.lost || !rules[k].lost)))
		k++;
	if (k == RESULT_NOTES || (source.large_only && rules[k].small))
		return;
	const size_t n = strlen(notes->names[k]);
	snprintf(notes->names[k] + n, RESULT_NOTES_NAMES - n, "%s%s", n ? ", " : "", name);
}

/* Writes member "note", the names of estimates before each note that applies; nothing if none does. */
void result_notes_write(struct writer *w, const struct result_notes *notes)
{
	char text[RESULT_NOTES * (RESULT_NOTES_NAMES + 120)];
	int n = 0;
	for (int k = 0; k < RESULT_NOTES; k++)
		if (*notes->names[k])
			n += snprintf(text + n, sizeof text - (size_t)n, "%s%s: %s", n ? "; " : "", notes->names[k],
			              rules[k].text);
	if (n)
		writer_text(w, "note", text);
}

/* Writes the reasons of failed runs, with the number of runs of each. */
void result_failures(struct writer *w, const struct pound_work *work)
{
	static const char *const reasons[] = {
#define X(name, value, text) [name##_RUNS] = text,
	    POUND_FAILURES(X)
#undef X
	};
	writer_array(w, "failures", WRITER_LINES);
	for (int k = 0; k < POUND_N_FAILURES; k++) {
		if (!work->failed[k])
			continue;
		writer_object(w, NULL, WRITER_LINE);
		writer_text(w, "reason", reasons[k]);
		writer_whole(w, "runs", work->failed[k]);
		writer_end(w);
	}
	writer_end(w);
}

/* ---- notes of an output ---- */

#define X(name, text) {#name, text},
static const struct {
	const char *name, *text;
} notes[] = {POUND_NOTES(X)};
#undef X

/* The name of a note in results: few_rows for POUND_NOTE_FEW_ROWS. */
static const char *note_name(int note, char name[32])
{
	int n = 0;
	for (const char *c = notes[note].name + strlen("POUND_NOTE_"); *c; c++)
		name[n++] = *c == '_' ? '_' : (char)(*c + 'a' - 'A');
	name[n] = '\0';
	return name;
}

/* All notes about an output's indices: in one string for readers, and each with its name for programs.
 *
 * Test     unit_result_json: all_there_is_to_say_has_room
 */
void result_notes_output(struct writer *w, const struct pound_indices *indices)
{
	char text[2048], name[32];
	int n = 0;
	for (int k = 0; k < POUND_N_NOTES; k++)
		if (indices->notes >> k & 1)
			n += snprintf(text + n, sizeof text - (size_t)n, "%s%s", n ? "; " : "", notes[k].text);
	if (indices->notes >> POUND_NOTE_FEW_DECIDE & 1)
		n += snprintf(text + n, sizeof text - (size_t)n, ": %.15g rows or more are needed",
		              indices->rows_needed);
	if (n == 0)
		return;
	writer_text(w, "note", text);
	writer_array(w, "notes", WRITER_LINES);
	for (int k = 0; k < POUND_N_NOTES; k++) {
		if (!(indices->notes >> k & 1))
			continue;
		writer_object(w, NULL, WRITER_LINE);
		writer_text(w, "name", note_name(k, name));
		writer_text(w, "text", notes[k].text);
		if (k == POUND_NOTE_FEW_DECIDE)
			writer_number(w, "rows_needed", indices->rows_needed);
		writer_end(w);
	}
	writer_end(w);
}
