/* um_bridge.h - a sensitivity study as a model of the UM-Bridge protocol 1.0: requests in, answers out.
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
 * Any thread; a bridge is used by one at a time. */
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
	UM_BRIDGE_DERIVATIVE, /* Gradient, ApplyJacobian, ApplyHessian: a model has none */
};

/* What can be wrong with a call: X(enumerator, HTTP status, type of the protocol). */
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

/* The stored study that is the model, whose document um_bridge_stored wants next; 0: there is nothing to look up. */
long long um_bridge_id(const struct um_bridge *bridge);
void um_bridge_stored(struct um_bridge *bridge, const char *document,
                      size_t length); /* NULL: no such study */

/* The study to run, owned by the bridge; NULL: there is none, the answer is known. */
const struct pound_study *um_bridge_study(struct um_bridge *bridge);
void um_bridge_result(struct um_bridge *bridge, const struct pound_result *result);
/* or why it is not run */
void um_bridge_refuse(struct um_bridge *bridge, enum um_bridge_error error, const struct problems *problems);

/* The answer's bytes (heap, NULL: out of memory) and its HTTP status. */
char *um_bridge_answer(struct um_bridge *bridge, int *status, size_t *length);

#endif
