/* UM-Bridge: a study of one sample is run while the client waits. */
#include "server/bridge.h"

#include <stdlib.h>

#include "schema/external/um_bridge.h"
#include "schema/study/cost.h"
#include "schema/study/study_json.h"
#include "server/store.h"

enum { CALL_MAX = 60 /* [s of one core], estimated: only two are computed at a time */ };

/* Looks the model up among the stored studies; false: the store failed, and the reply says why. */
static bool look_up(struct request *request, struct um_bridge *bridge, struct reply *reply)
{
	char *document = NULL;
	size_t length = 0;
	enum store_status found =
	    store_document(request->server->store, um_bridge_id(bridge), "request", &document, &length);
	if (found == STORE_OK || found == STORE_NONE)
		um_bridge_stored(bridge, document, length);
	else {
		free(reply->body);
		*reply = http_refusal(found, "");
	}
	free(document);
	return found == STORE_OK || found == STORE_NONE;
}

/* Whether a study can be run while a client waits; if not, the answer is a refusal. */
static bool allowed(const struct request *request, struct um_bridge *bridge, const struct pound_study *study)
{
	const int most = request->server->options->cpu_max;
	const double cpu_s = cost_of(study, 1).cpu_s, limit = most < CALL_MAX ? most : CALL_MAX;
	struct problems problems;
	problems_init(&problems);
	if (cpu_s > limit) {
		problems_add(&problems, "",
		             "needs %.6g estimated seconds of one core, but a call may take at most %.0f: submit it "
		             "as a study",
		             cpu_s, limit);
		um_bridge_refuse(bridge, UM_BRIDGE_ERROR_INPUT, &problems);
	}
	return cpu_s <= limit;
}

/* Runs a study; POUND_STOPPED: the client no longer waits for it. */
static enum pound_status run(const struct request *request, struct um_bridge *bridge,
                             const struct pound_study *study)
{
	struct pound_run *made = pound_run_create_by(study, 1, request->unwanted);
	enum pound_status status = made ? POUND_OK : POUND_NOMEM;
	if (made)
		pound_run_stop_by(made, request->unwanted);
	for (int block = 0; !status && block < pound_run_blocks(made); block++)
		status = pound_run_block(made, block, 0);
	for (int k = 0; !status && k < pound_run_reductions(made); k++)
		status = pound_run_reduce(made, k, 0);
	if (!status || status <= POUND_CHATTER) {
		um_bridge_result(bridge, pound_run_result(made));
		status = POUND_OK;
	}
	pound_run_free(made);
	return status;
}

static struct reply answer(struct request *request, enum um_bridge_call call)
{
	struct reply reply = http_problem(API_UNAVAILABLE, "out of memory", NULL);
	struct um_bridge *bridge = um_bridge_open(call, request->body, request->length);
	if (!bridge)
		return reply;
	bool known = !um_bridge_id(bridge) || look_up(request, bridge, &reply);
	const struct pound_study *study = known ? um_bridge_study(bridge) : NULL;
	if (known && (!study || !allowed(request, bridge, study) || run(request, bridge, study) == POUND_OK)) {
		int status;
		size_t length;
		char *body = um_bridge_answer(bridge, &status, &length);
		if (body) {
			free(reply.body);
			reply =
			    (struct reply){.status = status, .type = "application/json", .body = body, .length = length};
		}
	}
	um_bridge_close(bridge);
	return reply;
}

#define CALL(name, call)                       \
	struct reply name(struct request *request) \
	{                                          \
		return answer(request, call);          \
	}
CALL(bridge_info, UM_BRIDGE_INFO)
CALL(bridge_model, UM_BRIDGE_MODEL_INFO)
CALL(bridge_inputs, UM_BRIDGE_INPUT_SIZES)
CALL(bridge_outputs, UM_BRIDGE_OUTPUT_SIZES)
CALL(bridge_evaluate, UM_BRIDGE_EVALUATE)
CALL(bridge_gradient, UM_BRIDGE_DERIVATIVE)
CALL(bridge_jacobian, UM_BRIDGE_DERIVATIVE)
CALL(bridge_hessian, UM_BRIDGE_DERIVATIVE)
