/* fuzz_path.c - any text as a method, a path and an argument: found in the table or not, and an id found is the one
 * that stands there.  libFuzzer: make fuzz. */
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "schema/http/api.h"

int LLVMFuzzerTestOneInput(const uint8_t *bytes, size_t length);

int LLVMFuzzerTestOneInput(const uint8_t *bytes, size_t length)
{
	char *text = malloc(length + 1), allow[64], id_text[32];
	long long id;
	memcpy(text, bytes, length);
	text[length] = '\0';
	char *path = strchr(text, ' ');
	if (path)
		*path++ = '\0';
	int operation = path ? api_match(text, path, &id, allow) : -1;
	if (operation >= API_N_OPERATIONS || (operation >= 0 && (!allow[0] || id < 0)))
		abort();
	snprintf(id_text, sizeof id_text, "%016llx", (unsigned long long)(operation >= 0 ? id : 0));
	if (operation >= 0 && strchr(api_operations[operation].path, '{') && !strstr(path, id_text))
		abort();
	for (int i = 0; path && i < api_arguments_count; i++) {
		const struct api_argument *of = &api_arguments[i];
		bool wrong = *path ? of->max > 0 && (atoi(path) < of->min || atoi(path) > of->max) : !of->blank;
		if (api_takes(of, path) && wrong)
			abort();
	}
	free(text);
	return 0;
}
