/* problems.h - the list of all problems of a request, and the response body with it (RFC 9457).
 *
 * Memory of the caller, about 230 kB; one thread at a time. */
#ifndef PROBLEMS_H
#define PROBLEMS_H

#include <stdbool.h>
#include <stddef.h>

enum { PROBLEMS_MAX = 100 };

enum problems_status {
	PROBLEMS_NONE,
	PROBLEMS_MALFORMED, /* not JSON: `line`, `column`, and a sentence in list[0].detail; HTTP 400 */
	PROBLEMS_INVALID,   /* JSON, but not a valid study: list[0 .. n - 1]; HTTP 422 */
	PROBLEMS_NOMEM,     /* out of memory before the check was complete; HTTP 503 */
};

struct problem {
	char pointer[160];       /* JSON Pointer (RFC 6901) into the document; "" is the whole document */
	char detail[2048];       /* "must be in [0, 1], got 1.4" */
	double requested, limit; /* of an exceeded limit; limit 0: another problem */
};

struct problems {
	enum problems_status status;
	int line, column; /* of the error in malformed text, from 1 */
	int n;            /* problems listed */
	int n_more;       /* problems found after the list was full */
	struct problem list[PROBLEMS_MAX];
};

void problems_init(struct problems *problems);
void problems_add(struct problems *problems, const char *pointer, const char *format, ...)
    __attribute__((format(printf, 3, 4)));

/* Adds the problem that more is requested than a limit > 0; both numbers are reported. */
void problems_exceed(struct problems *problems, const char *pointer, double requested, double limit,
                     const char *format, ...) __attribute__((format(printf, 5, 6)));

struct cJSON;
/* Puts the problems in the order of the document that they are in; absent members come after all others of their object. */
void problems_sort(struct problems *problems, const struct cJSON *document);

/* Whether a value at or below a pointer has a problem, or may have one because the list is full. */
bool problems_at(const struct problems *problems, const char *pointer);

/* Whether the value at a pointer, or a value that contains it, has a problem as a whole. */
bool problems_over(const struct problems *problems, const char *pointer);

/* Members of a problem object besides its list of errors. */
struct problem_head {
	int status;         /* HTTP status code */
	const char *type;   /* short name such as "invalid-study"; NULL: about:blank */
	const char *title;  /* "Unprocessable Content" */
	const char *detail; /* a sentence about this request */
};

/* An application/problem+json body (heap, NULL: out of memory); `problems` may be NULL. */
char *problem_to_json(const struct problem_head *head, const struct problems *problems, size_t *length);

#endif
