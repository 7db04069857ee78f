/* um_bridge.h - a sensitivity study as a model of the UM-Bridge protocol 1.0: handles requests, writes responses.
 *
 *   struct um_bridge *bridge = um_bridge_open(UM_BRIDGE_EVALUATE, body, length);
 *   if (um_bridge_id(bridge))
 *       um_bridge_stored(bridge, document, n);
 *   struct pound_study *study = um_bridge_study(bridge);
 *   if (study)
 *       ... run it ..., um_bridge_result(bridge, result);
 *   body = um_bridge_answer(bridge, &status, &length);
 *   um_bridge_close(bridge);
 *
 * Any thread; only one thread at a time may use a bridge. */
#ifndef UM_BRIDGE_H
#define UM_BRIDGE_H

#include <stddef.h>

#include "engine/pound.h"
#include "schema/json/problems.h"

enum um_bridge_call {
	UM_BRIDGE_INFO,
	UM_BRIDGE_MODEL_INFO,
	UM_BRIDGE_INPUT_SIZES,
	UM_BRIDGE_OUTPUT_SIZES,
	UM_BRIDGE_EVALUATE,
	UM_BRIDGE_DERIVATIVE, /* Gradient, ApplyJacobian, ApplyHessian: not supported */
};

/* Errors of a call: X(enumerator, HTTP status, error type of the protocol). */
// clang-format off
#define UM_BRIDGE_ERRORS(X)                                                               \
	X(INPUT,   400, "InvalidInput")                                                       \
	X(MODEL,   400, "ModelNotFound")                                                      \
	X(FEATURE, 400, "UnsupportedFeature")                                                 \
	X(OUTPUT,  500, "InvalidOutput")
// clang-format on

enum um_bridge_error {
#define X(name, status, type) UM_BRIDGE_ERROR_##name,
	UM_BRIDGE_ERRORS(X)
#undef X
	    UM_BRIDGE_NO_ERROR
};

struct um_bridge;

struct um_bridge *um_bridge_open(enum um_bridge_call call, const char *body,
                                 size_t length); /* NULL: no memory */
void um_bridge_close(struct um_bridge *bridge);

/* The id of the stored study that is the model: pass its document to um_bridge_stored; 0: the model is not a stored study. */
long long um_bridge_id(const struct um_bridge *bridge);
void um_bridge_stored(struct um_bridge *bridge, const char *document,
                      size_t length); /* NULL: no such study */

/* The study to run, owned by the bridge; NULL: nothing to run, call um_bridge_answer. */
const struct pound_study *um_bridge_study(struct um_bridge *bridge);
void um_bridge_result(struct um_bridge *bridge, const struct pound_result *result);
/* instead of a result: the study was not run */
void um_bridge_refuse(struct um_bridge *bridge, enum um_bridge_error error, const struct problems *problems);

/* The response body (heap, NULL: out of memory) and its HTTP status. */
char *um_bridge_answer(struct um_bridge *bridge, int *status, size_t *length);

#endif
