/* What a study will take: its runs by the time of one. */
#include "schema/cost.h"

#include "schema/study_json.h"

/* [s] of one core for a sample interval of one run: `make run` takes 3.5 s for 30,000 runs of 1,020 on average */
static const double INTERVAL_CPU_S = 1.2e-7;

struct cost cost_of(const struct pound_study *study)
{
	double runs = (double)study_runs(study);
	// what is stored of a run: its part of two means for each output, or all its measures
	size_t bytes = study->kind == POUND_KIND_SENSITIVITY ? 2 * (size_t)study->n_outputs * sizeof(double)
	                                                     : sizeof(struct pound_response);
	return (struct cost){.runs = study_runs(study),
	                     .cpu_s = runs * study_steps(study) * INTERVAL_CPU_S,
	                     .bytes = runs * (double)bytes};
}
