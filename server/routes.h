/* routes.h - the table of routes: what poundd answers. */
#ifndef ROUTES_H
#define ROUTES_H

#include "server/http.h"

struct reply routes_answer(struct request *request);

// clang-format off
#define ROUTES_FAULTS(X)                                                                  \
	X(BAD_REQUEST,   400, "bad-request",            "Bad Request")                        \
	X(MALFORMED,     400, "malformed-json",         "Malformed JSON")                     \
	X(NOT_FOUND,     404, "not-found",              "Not Found")                          \
	X(NOT_READY,     404, "not-ready",              "Not Ready")                          \
	X(NOT_ALLOWED,   405, "method-not-allowed",     "Method Not Allowed")                 \
	X(CONFLICT,      409, "conflict",               "Conflict")                           \
	X(TOO_LARGE,     413, "body-too-large",         "Content Too Large")                  \
	X(NOT_JSON,      415, "unsupported-media-type", "Unsupported Media Type")             \
	X(INVALID,       422, "invalid-study",          "Invalid Study")                      \
	X(CORRUPT,       500, "result-corrupt",         "Stored Data Damaged")                \
	X(UNAVAILABLE,   503, "unavailable",            "Service Unavailable")
// clang-format on

enum routes_fault {
#define X(name, status, type, title) ROUTES_##name,
	ROUTES_FAULTS(X)
#undef X
};

/* an application/problem+json reply */
struct reply routes_problem(enum routes_fault fault, const char *detail);

#endif
