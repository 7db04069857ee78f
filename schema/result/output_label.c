/* output_label.c - an output of a result with its place, in words. */
#include "schema/result/output_label.h"

#include <math.h>
#include <stdio.h>

/* Writes name, frequency and place of an output; an output has only some of them.
 *
 * Test     unit_result_json: the_widest_interval_is_named_and_why_fewer_rows_have_a_narrower_one
 */
const char *output_label(const struct reading *result, const char *output, char text[OUTPUT_LABEL])
{
	static const struct {
		const char *member, *before, *after;
	} places[] = {{"frequency_hz", " at ", " Hz"},
	              {"building", ", building ", ""},
	              {"storey", ", story ", ""},
	              {"contact", ", contact ", ""}};
	const char *name = reading_text(result, "%s/name", output);
	int n = snprintf(text, OUTPUT_LABEL, "%.150s", name ? name : "?");
	for (size_t k = 0; k < sizeof places / sizeof places[0]; k++) {
		const double value = reading_number(result, "%s/%s", output, places[k].member);
		if (isfinite(value))
			n += snprintf(text + n, (size_t)(OUTPUT_LABEL - n), "%s%.4g%s", places[k].before, value,
			              places[k].after);
	}
	return text;
}
