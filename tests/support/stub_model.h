/* stub_model.h - a model server of UM-Bridge 1.0 in a process of its own: the Ishigami function of 3 inputs in 2 vectors.
 *
 * Errors in these functions fail the test. */
#ifndef STUB_MODEL_H
#define STUB_MODEL_H

#include <stdatomic.h>
#include <stdbool.h>
#include <sys/types.h>

enum stub_manner {
	STUB_PLAIN,
	STUB_SHUFFLED, /* answers after up to 5 ms each, drawn at random */
	STUB_FAILING, /* one run in 50, by its inputs: InvalidOutput, InvalidInput, a bare 500, null, NaN in turn */
	STUB_SHAKY,   /* every 20th call: 503, or a connection that ends */
	STUB_DEAD,    /* every call: 503 */
	STUB_NOISY,   /* noise that is a function of config.seed */
	STUB_WIDE,    /* two numbers where OutputSizes says one */
	STUB_SILENT,   /* never answers /Evaluate */
	STUB_REFUSING, /* 401 to /Evaluate */
};

struct stub_model {
	pid_t pid;
	char url[64];
	atomic_int *calls; /* of /Evaluate, shared with the process */
};

struct stub_model stub_model_start(enum stub_manner manner);
void stub_model_stop(struct stub_model *model);

double stub_model_value(const double x[3]);
bool stub_model_fails(const double x[3]); /* of STUB_FAILING */
double stub_model_noise(long seed);       /* of STUB_NOISY */

#endif
