/* problems.h - what is wrong with a request, all of it at once, and the body that says so (RFC 9457).
 *
 * Plain memory of the caller, about 230 kB; one thread at a time. */
#ifndef PROBLEMS_H
#define PROBLEMS_H

#include <stdbool.h>
#include <stddef.h>

enum { PROBLEMS_MAX = 100 };

enum problems_status {
	PROBLEMS_NONE,
	PROBLEMS_MALFORMED, /* not JSON: `line`, `column`, and the sentence in list[0].detail; HTTP 400 */
	PROBLEMS_INVALID,   /* JSON, but not a valid study: list[0 .. n - 1]; HTTP 422 */
	PROBLEMS_NOMEM,     /* out of memory, nothing is known; HTTP 503 */
};

struct problem {
	char pointer[160];       /* JSON Pointer (RFC 6901) into the document; "" is the whole document */
	char detail[2048];       /* "must be in [0, 1], got 1.4" */
	double requested, limit; /* of what there may not be so much of; limit 0: it is no such problem */
};

struct problems {
	enum problems_status status;
	int line, column; /* of malformed text, from 1 */
	int n;            /* problems listed */
	int n_more;       /* problems found after the list was full */
	struct problem list[PROBLEMS_MAX];
};

void problems_init(struct problems *problems);
void problems_add(struct problems *problems, const char *pointer, const char *format, ...)
    __attribute__((format(printf, 3, 4)));

/* A problem that is reported as numbers, too: more is requested than the limit, which is above 0. */
void problems_exceed(struct problems *problems, const char *pointer, double requested, double limit,
                     const char *format, ...) __attribute__((format(printf, 5, 6)));

/* Whether something at or below a pointer is known to be wrong, or may be, as the list is full. */
bool problems_at(const struct problems *problems, const char *pointer);

/* Whether something that a pointer is in, or it itself, is known to be wrong as a whole. */
bool problems_over(const struct problems *problems, const char *pointer);

/* What a problem body says in addition to its list of errors. */
struct problem_head {
	int status;         /* of HTTP */
	const char *type;   /* short name such as "invalid-study"; NULL: about:blank */
	const char *title;  /* "Unprocessable Content" */
	const char *detail; /* a sentence about this request */
};

/* The bytes of an application/problem+json body (heap, NULL: out of memory); `problems` may be NULL. */
char *problem_to_json(const struct problem_head *head, const struct problems *problems, size_t *length);

#endif
