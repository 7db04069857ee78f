/* fuzz_head.c - any bytes as the head of a request: a target in the first line, then headers; judged without reading
 * past an end, and what is let through is what may be.  libFuzzer: make fuzz. */
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#include "schema/http/http_head.h"

int LLVMFuzzerTestOneInput(const uint8_t *bytes, size_t length);

/* The next line as a text of its own, so that the sanitizer sees a byte too many. */
static char *line_of(const uint8_t **at, const uint8_t *end, size_t *n)
{
	const uint8_t *newline = memchr(*at, '\n', (size_t)(end - *at));
	*n = (size_t)((newline ? newline : end) - *at);
	char *line = malloc(*n + 1);
	memcpy(line, *at, *n);
	line[*n] = '\0';
	*at = newline ? newline + 1 : end;
	return line;
}

int LLVMFuzzerTestOneInput(const uint8_t *bytes, size_t length)
{
	const uint8_t *at = bytes, *end = bytes + length;
	struct head head;
	size_t n;
	char *target = line_of(&at, end, &n);
	head_target(&head, target);
	bool odd = strstr(target, "%00") || strpbrk(target, " \t\r\x7f");
	if (odd && head.fault == API_NO_FAULT)
		abort();
	free(target);
	while (at < end) {
		char *line = line_of(&at, end, &n);
		size_t name = strcspn(line, ":");
		const char *value = name < n ? line + name + 1 : line + n;
		head_header(&head, line, name < n ? name : n, value, (size_t)(line + n - value));
		if (strlen(value) == (size_t)(line + n - value)) {
			if (head_has_etag(value, "\"tag\"") && !strstr(value, "\"tag\"") && !strchr(value, '*'))
				abort();
			if (head_wait(value) < 0 || (head_names(value, "text/csv") && strlen(value) < strlen("text/csv")))
				abort();
		}
		free(line);
	}
	head_origin(&head);
	head_key(&head);
	head_end(&head, true, "pound.example,other.example");
	bool framed = head.lengths <= 1 && !head.codings && head.hosts == 1;
	if (head.fault == API_NO_FAULT ? !framed || head.length > HEAD_BODY_MAX || head.encoded || head.close
	                               : !head.detail[0])
		abort();
	return 0;
}
