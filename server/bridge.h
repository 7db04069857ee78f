/* bridge.h - the calls of the UM-Bridge protocol. */
#ifndef BRIDGE_H
#define BRIDGE_H

#include "server/http.h"

struct reply bridge_info(struct request *request);
struct reply bridge_model(struct request *request);
struct reply bridge_inputs(struct request *request);
struct reply bridge_outputs(struct request *request);
struct reply bridge_evaluate(struct request *request); /* runs a study in the thread of the caller */
struct reply bridge_gradient(struct request *request);
struct reply bridge_jacobian(struct request *request);
struct reply bridge_hessian(struct request *request);

#endif
