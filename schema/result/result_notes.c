/* result_notes.c - what there is to say about estimates of indices, in words that are true of their numbers.
 *
 * An index lies in [0, 1].  Estimates are not clipped, so that one of a small index may come out below 0; one that is
 * further off, or not in its own interval, has another cause, and the sentence names that. */
#include "schema/result/result_notes.h"

#include <assert.h>
#include <math.h>
#include <stdio.h>
#include <string.h>

// sums over up to 2^20 rows round to no more: an index that is exactly 0 or 1 needs no words
static const double ROUNDING = 0x1p-33;

/* ---- what may be true of an estimate ---- */

/* How far a number is from [0, 1]. */
static double beyond(double value)
{
	return fmax(fmax(-value, value - 1), 0);
}

// by more than all of the variance: no sampling error of a share
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
/* The first row that holds says what there is to say. */
static const struct rule {
	bool (*holds)(const struct pound_estimate *e);
	bool lost;  /* where the variance may be lost in noise only */
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

/* Adds what there is to say about an estimate.
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

/* Writes member "note": the names of estimates, and what holds of them; nothing where there is nothing to say. */
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

/* Why runs have no result, the reasons that there are. */
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
