/* fuzz_record.c - any bytes as a file of a recorded acceleration: read whole into finite samples, or refused with a reason.
 *
 * libFuzzer: make fuzz. */
#include <math.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#include "schema/record/record.h"

int LLVMFuzzerTestOneInput(const uint8_t *bytes, size_t length);

int LLVMFuzzerTestOneInput(const uint8_t *bytes, size_t length)
{
	// the first byte chooses what is known besides the file
	const uint8_t known = length ? bytes[0] : 0;
	const size_t n = length ? length - 1 : 0;
	const struct record_choice choice = {
	    .unit = known & 1 ? "g" : NULL, .step = known & 2 ? 0.01 : 0, .channel = known >> 2 & 3};
	char *text = malloc(n + 1);
	memcpy(text, bytes + (length > 0), n);
	text[n] = 0;
	struct record record;
	struct problems problems;
	if (record_read(text, n, &choice, &record, &problems)) {
		if (record.n < 2 || !(record.step > 0) || !isfinite(record.step) || !record.unit || !record.format)
			abort();
		for (int i = 0; i < record.n; i++)
			if (!isfinite(record.acceleration[i]))
				abort();
		record_free(&record);
	} else if (problems.status == PROBLEMS_NONE ||
	           (problems.status != PROBLEMS_NOMEM && !problems.list[0].detail[0]) || record.acceleration)
		abort();
	free(text);
	return 0;
}
