/* json_strict.h - a strict check of JSON text before it is parsed.
 *
 * RFC 8259 without extensions, UTF-8 only, and the limits below.  Allocates nothing; any thread. */
#ifndef JSON_STRICT_H
#define JSON_STRICT_H

#include <stdbool.h>
#include <stddef.h>

enum {
	JSON_DEPTH_MAX = 32,         /* arrays and objects inside each other */
	JSON_STRING_MAX = 64 * 1024, /* bytes of one string, escapes as written */
	JSON_MEMBERS_MAX = 256,      /* members of one object */
	JSON_NUMBER_MAX = 400,       /* characters of one number */
};

struct json_fault {
	int line, column; /* from 1; the column counts characters, not bytes */
	char detail[128]; /* a sentence: what was expected there and what was found */
};

bool json_strict_check(const char *text, size_t length, struct json_fault *fault); /* true: strict JSON */

/* Number of bytes of the UTF-8 character at the start of a text of at least one byte; 0: not UTF-8. */
size_t json_strict_character(const char *text, size_t length);

#endif
