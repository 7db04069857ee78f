/* widest_interval.c - the widest of all intervals, and the narrowest interval of the same output from fewer rows.
 *
 * If a few rare rows make much of a variance, fewer rows may contain none of them: the interval is then narrower and wrong. */
#include "schema/result/widest_interval.h"

#include "schema/result/output_label.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

enum { PATH_SIZE = 128 };

/* The widest interval of one output, by number of rows. */
struct widths {
	char output[OUTPUT_LABEL]; /* with its place */
	const char *input, *index; /* from all rows */
	double last, least;        /* half-widths from all rows, and the narrowest from fewer rows */
	double rows, rows_least, rows_to_halve;
};

static struct widths widths_of(const struct reading *result, const char *output)
{
	static const char *const names[] = {"S1", "ST"};
	struct widths widths = {.last = NAN, .least = NAN};
	output_label(result, output, widths.output);
	const int levels = reading_count(result, "%s/accuracy/rows", output);
	widths.rows_to_halve = reading_number(result, "%s/accuracy/rows_to_halve", output);
	for (int level = 0; level < levels; level++) {
		double widest = NAN, rows = reading_number(result, "%s/accuracy/rows/%d", output, level);
		for (int j = 0; j < reading_count(result, "%s/accuracy/inputs", output); j++)
			for (int k = 0; k < 2; k++) {
				double half = reading_number(result, "%s/accuracy/inputs/%d/%s_half_widths/%d", output, j,
				                             names[k], level);
				if (!(isfinite(half) && !(half <= widest)))
					continue;
				widest = half;
				widths.index = names[k];
				widths.input = reading_text(result, "%s/accuracy/inputs/%d/name", output, j);
			}
		if (level == levels - 1) {
			widths.last = widest;
			widths.rows = rows;
		} else if (!(widest >= widths.least)) {
			widths.least = widest;
			widths.rows_least = rows;
		}
	}
	return widths;
}

static struct widths widest_of(const struct reading *result)
{
	struct widths widest = {.last = NAN};
	for (int c = 0; c < reading_count(result, "/cells"); c++)
		for (int o = 0; o < reading_count(result, "/cells/%d/outputs", c); o++) {
			char output[PATH_SIZE];
			snprintf(output, sizeof output, "/cells/%d/outputs/%d", c, o);
			struct widths widths = widths_of(result, output);
			if (isfinite(widths.last) && !(widths.last <= widest.last))
				widest = widths;
		}
	return widest;
}

/* Finds the widest interval of a result.
 *
 * Test     unit_result_json: the_widest_interval_is_named_and_why_fewer_rows_have_a_narrower_one
 */
void widest_interval_find(const struct reading *result, struct widest_interval *text)
{
	char more[64] = "";
	const struct widths widest = widest_of(result);
	*text = (struct widest_interval){0};
	if (!isfinite(widest.last))
		return;
	if (isfinite(widest.rows_to_halve))
		snprintf(more, sizeof more, "; about %.0f rows would halve its width", widest.rows_to_halve);
	snprintf(text->size, WIDEST_TEXT, "The widest 95 %% interval is +-%.2g, of %s of input %s, output %s%s.",
	         widest.last, widest.index, widest.input ? widest.input : "?", widest.output, more);
	if (widest.last > 1.1 * widest.least)
		snprintf(text->narrower, WIDEST_TEXT,
		         "With %.0f rows it was +-%.2g, narrower but not better: a few rare rows hold much of the "
		         "variance, and so few rows may not contain them. Quote the interval of %.0f rows.",
		         widest.rows_least, widest.least, widest.rows);
}
