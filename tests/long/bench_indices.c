/* bench_indices.c - benchmarks of the statistics: cost of the indices of one output. */
#include "tests/long/bench.h"

#include <stdlib.h>

#include "tests/support/functions.h"

enum { D = FUNCTION_INPUTS, REPEATS = 5 };

struct reduction {
	struct pound_sample_values values;
	double *u, *scratch;
	struct pound_indices indices;
	struct pound_estimate columns[POUND_N_INDICES][D], named[POUND_N_NAMED][D];
	struct pound_curve curves[D];
};

static void reduction_init(struct reduction *r, int rows, struct function_noise noise)
{
	r->values = function_values(function_named("cusp"), rows, 1, noise);
	r->u = function_design(rows, 1);
	size_t all = pound_index_columns_scratch(&r->values, NULL), plain = pound_plain_scratch(&r->values);
	r->scratch = bench_memory(sizeof *r->scratch * (rows > 100000 ? plain : all));
	for (int k = 0; k < POUND_N_INDICES; k++)
		r->indices.index[k] = r->columns[k];
	for (int k = 0; k < POUND_N_NAMED; k++)
		r->indices.named[k] = r->named[k];
	r->indices.curves = r->curves;
}

static void reduction_free(struct reduction *r)
{
	function_values_free(&r->values);
	free(r->u), free(r->scratch);
}

static void everything(void *of)
{
	struct reduction *r = of;
	pound_index_columns_indices(&r->values, &(struct pound_sampling){.u = r->u, .random = true}, 1,
	                            r->scratch, &r->indices);
}

static void plain(void *of)
{
	struct reduction *r = of;
	pound_plain_indices(&r->values, (struct pound_resampling){1, 1000}, r->scratch, &r->indices);
}

/* Four inputs: every column, set and curve; the plain protocol only; every column for a large design. */
void bench_indices(void)
{
	static struct reduction few, one, many;
	reduction_init(&few, 1000, (struct function_noise){5, 0.2, true});
	reduction_init(&one, 1000, (struct function_noise){1, 0.0, true});
	reduction_init(&many, 1 << 17, (struct function_noise){1, 0.0, true});
	struct bench_job jobs[] = {{.run = everything, .of = &few}, {.run = plain, .of = &one}};
	bench_jobs(jobs, 2, 4 * REPEATS);
	bench_print(
	    (struct bench_row){.what = "indices of an output, 4 inputs, n = 1000, 2000 resamples, everything",
	                       .value = 1e3 * jobs[0].seconds,
	                       .unit = "ms",
	                       .goal = "at most 50 ms",
	                       .met = jobs[0].seconds <= 50e-3});
	bench_print((struct bench_row){.what = "plain estimators with 1000 resamples alone",
	                               .value = 1e3 * jobs[1].seconds,
	                               .unit = "ms",
	                               .goal = "at most 5 ms",
	                               .met = jobs[1].seconds <= 5e-3});
	struct bench_job large = {.run = plain, .of = &many};
	bench_jobs(&large, 1, REPEATS);
	bench_print((struct bench_row){.what = "the same for n = 2^17, on one core",
	                               .value = large.seconds,
	                               .unit = "s",
	                               .goal = "at most 4 CPU s",
	                               .met = large.seconds <= 4});
	reduction_free(&few), reduction_free(&one), reduction_free(&many);
}
