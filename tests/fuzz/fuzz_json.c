/* fuzz_json.c - any bytes to the strict check of JSON: what passes must be JSON to the parser behind it, too, with finite numbers.
 *
 * libFuzzer: make fuzz. */
#include <math.h>
#include <stdint.h>
#include <stdlib.h>

#include "schema/json/json_pointer.h"
#include "schema/json/json_strict.h"

int LLVMFuzzerTestOneInput(const uint8_t *bytes, size_t length);

int LLVMFuzzerTestOneInput(const uint8_t *bytes, size_t length)
{
	struct json_fault fault = {0};
	bool strict = json_strict_check((const char *)bytes, length, &fault);
	if (strict ? fault.line != 0 : fault.line < 1 || fault.column < 1 || !fault.detail[0])
		abort();
	struct reading *reading = reading_open((const char *)bytes, length);
	if (strict != (reading != NULL) || isinf(reading ? reading_number(reading, "%s", "") : 0))
		abort();
	reading_close(reading);
	return 0;
}
