/* api.h - what poundd can be asked and what it answers: a row for each operation, argument and fault.
 *
 * The server dispatches, checks arguments and makes problems by these rows, and the OpenAPI document is written from
 * them.  Constant; any thread. */
#ifndef API_H
#define API_H

#include <stdbool.h>
#include <stddef.h>

#include "schema/json/problems.h"

// clang-format off
/* What can be wrong with a request: X(enumerator, HTTP status, type, title). */
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

/* What can be asked for: X(operation, which is a row of api_operations and a function of routes.c). */
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
	    API_NO_FAULT /* and how many there are */
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
	const char *method, *path, *name; /* {id} in a path is 16 hexadecimal digits,
	                                     another name at its end what that argument takes */
	const char *text;                 /* one line for people */
	const char *
	    answers; /* of success, between spaces: "200=Page", its status and its object in the document, "204" */
	const char *media; /* further media types of success, between spaces; NULL: none */
	unsigned faults;   /* 1 << API_X of those that are not everyone's */
	bool open;         /* answered without a token */
	bool takes_study;  /* its body is a study document */
};

extern const struct api_operation api_operations[API_N_OPERATIONS];
extern const struct api_fault_row api_faults[API_NO_FAULT];
extern const unsigned api_faults_of_all; /* that any operation may answer */

/* An argument of an operation. */
struct api_argument {
	const char *operation, *name; /* of api_operations[]; NULL: of any */
	const char *place;            /* "query", "header" or "path" */
	const char *choices;          /* values it takes, between spaces; NULL: any, or a number */
	int min, max;                 /* a whole number in [min, max], when max > 0 */
	const char *absent;           /* its default; NULL: none */
	const char *text;
	int digits; /* it is so many hexadecimal digits, when > 0 */
	bool blank; /* it may be empty, which is as if it were not there */
};

extern const struct api_argument api_arguments[];
extern const int api_arguments_count;

/* The argument of that name, NULL: the operation has none. */
const struct api_argument *api_argument(int operation, const char *name, const char *place);

/* The names of an operation's arguments of a place, between commas. */
void api_names(int operation, const char *place, char *text, size_t size);

/* What an argument takes, in words that fit behind "must be". */
void api_expected(const struct api_argument *argument, char *text, size_t size);
bool api_takes(const struct api_argument *argument, const char *value); /* a query argument's value */

/* The operation that a method and a decoded path name, and the id in the path; `allow` has the methods of the path.
 * HEAD is GET.  -1: there is no such path, or it does not take the method. */
int api_match(const char *method, const char *path, long long *id, char allow[64]);

/* The bytes of a problem (heap, NULL: out of memory); `problems` may be NULL. */
char *api_problem(enum api_fault fault, const char *detail, const struct problems *problems, size_t *length);

/* The OpenAPI 3.0 document (heap, NULL: out of memory). */
char *api_document(size_t *length);

#endif
