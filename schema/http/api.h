/* api.h - the HTTP interface of poundd: one row per operation, argument and kind of error.
 *
 * The server dispatches requests, checks arguments and makes problem objects by these rows; the OpenAPI document is generated
 * from them.  Constant; any thread. */
#ifndef API_H
#define API_H

#include <stdbool.h>
#include <stddef.h>

#include "schema/json/problems.h"

// clang-format off
/* Kinds of errors: X(enumerator, HTTP status, type, title). */
#define API_FAULTS(X)                                                                     \
	X(BAD_REQUEST,   400, "bad-request",            "Bad Request")                        \
	X(MALFORMED,     400, "malformed-json",         "Malformed JSON")                     \
	X(UNAUTHORIZED,  401, "unauthorized",           "Unauthorized")                       \
	X(FOREIGN,       403, "foreign-origin",         "Forbidden")                          \
	X(NOT_FOUND,     404, "not-found",              "Not Found")                          \
	X(NOT_READY,     404, "not-ready",              "Not Ready")                          \
	X(NOT_ALLOWED,   405, "method-not-allowed",     "Method Not Allowed")                 \
	X(CONFLICT,      409, "conflict",               "Conflict")                           \
	X(NO_LENGTH,     411, "length-required",        "Length Required")                    \
	X(TOO_LARGE,     413, "body-too-large",         "Content Too Large")                  \
	X(TARGET_LONG,   414, "target-too-long",        "URI Too Long")                       \
	X(NOT_JSON,      415, "unsupported-media-type", "Unsupported Media Type")             \
	X(MISDIRECTED,   421, "misdirected-request",    "Misdirected Request")                \
	X(INVALID,       422, "invalid-study",          "Invalid Study")                      \
	X(TOO_COSTLY,    422, "study-too-large",        "Study Too Large")                    \
	X(KEY_REUSED,    422, "idempotency-key-reused", "Idempotency Key Reused")             \
	X(TOO_MANY,      429, "too-many-requests",      "Too Many Requests")                  \
	X(HEAD_LARGE,    431, "headers-too-large",      "Request Header Fields Too Large")    \
	X(CORRUPT,       500, "result-corrupt",         "Stored Data Damaged")                \
	X(UNAVAILABLE,   503, "unavailable",            "Service Unavailable")

/* Operations: X(operation); each is a row of api_operations and a function of routes.c. */
#define API_OPERATIONS(X)                                                                 \
	X(submit) X(list) X(status) X(erase)  X(posted)  X(results) X(samples) X(motions) X(figures) \
	X(figure) X(cancel) X(records_put) X(records_get) \
	X(live) X(ready) X(metrics) X(version) X(openapi) \
	X(bridge_info) X(bridge_model) X(bridge_inputs) X(bridge_outputs) \
	X(bridge_evaluate) X(bridge_gradient) X(bridge_jacobian) X(bridge_hessian) \
	X(example_list) X(example) X(home) X(new) X(study) X(style) X(script) X(icon)
// clang-format on

enum api_fault {
#define X(name, status, type, title) API_##name,
	API_FAULTS(X)
#undef X
	    API_NO_FAULT /* and the number of faults */
};

enum {
#define X(name) API_##name,
	API_OPERATIONS(X)
#undef X
	    API_N_OPERATIONS
};

struct api_fault_row {
	int status;
	const char *type, *title;
};

struct api_operation {
	const char *method, *path, *name; /* in a path {id} is 16 hexadecimal digits, and
	                                     {name} at the end a value of the path argument */
	const char *text;                 /* description in one line */
	const char *
	    answers; /* successes, between spaces: a status and its object in the document, "200=Page", or "204" */
	const char *media; /* further media types of success, between spaces; NULL: none */
	unsigned faults;   /* 1 << API_X of faults besides api_faults_of_all */
	bool open;         /* answered without a token */
	bool takes_study;  /* its body is a study document */
};

extern const struct api_operation api_operations[API_N_OPERATIONS];
extern const struct api_fault_row api_faults[API_NO_FAULT];
extern const unsigned api_faults_of_all; /* faults of every operation */

/* An argument of an operation. */
struct api_argument {
	const char *operation, *name; /* name in api_operations[]; NULL: any */
	const char *place;            /* "query", "header" or "path" */
	const char *choices;          /* valid values, between spaces; NULL: any, or a number */
	int min, max;                 /* if max > 0: a whole number in [min, max] */
	const char *absent;           /* its default; NULL: none */
	const char *text;
	int digits; /* if > 0: it has so many hexadecimal digits */
	bool blank; /* may be empty, which means absent */
};

extern const struct api_argument api_arguments[];
extern const int api_arguments_count;

/* The argument with that name; NULL: the operation has no such argument. */
const struct api_argument *api_argument(int operation, const char *name, const char *place);

/* The comma-separated names of an operation's arguments in a place. */
void api_names(int operation, const char *place, char *text, size_t size);

/* The valid values of an argument, as text that follows "must be". */
void api_expected(const struct api_argument *argument, char *text, size_t size);
bool api_takes(const struct api_argument *argument, const char *value); /* whether a value is valid */
enum { API_CHOICE_SIZE = 32 };
/* The valid value that was probably meant, copied; NULL: not known. */
const char *api_nearest(const struct api_argument *argument, const char *value,
                        char nearest[API_CHOICE_SIZE]);

/* The operation of a method and a decoded path, and the id in the path; `allow` lists the methods of the path.
 * HEAD counts as GET.  -1: no such path, or the path does not support the method. */
int api_match(const char *method, const char *path, long long *id, char allow[64]);

/* A problem object as JSON (heap, NULL: out of memory); `problems` may be NULL. */
char *api_problem(enum api_fault fault, const char *detail, const struct problems *problems, size_t *length);

/* The OpenAPI 3.0 document (heap, NULL: out of memory). */
char *api_document(size_t *length);

#endif
