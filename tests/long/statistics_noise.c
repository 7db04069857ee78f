/* statistics_noise.c - bias, error and coverage of the indices of a random model, with and without its noise: five
 * signals in every sample, each with noise as large as the variance of the mean response, 1000 rows. */
#include "tests/long/statistics.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>

enum { D = FUNCTION_INPUTS, COLUMNS = 3, CASES = 4, ROWS = 1000 };

static const struct {
	const char *name;
	enum pound_index index[2];
} columns[COLUMNS] = {{"`_raw`", {POUND_S1_RAW, POUND_ST_RAW}},
                      {"`_pick_freeze`", {POUND_S1_PICK_FREEZE, POUND_ST_PICK_FREEZE}},
                      {"`S1`, `ST`", {POUND_S1, POUND_ST}}};

static const struct {
	const char *function;
	bool common;
} cases[CASES] = {{"cusp", false}, {"cusp", true}, {"ishigami", false}, {"ishigami", true}};

struct campaign {
	int n_seeds;
	struct statistics_score scores[CASES][COLUMNS];
};

static void seed_run(struct campaign *c, int k, uint64_t seed)
{
	const struct function *f = function_named(cases[k].function);
	struct pound_sample_values values =
	    function_values(f, ROWS, seed, (struct function_noise){5, 1.0, cases[k].common});
	double *u = function_design(ROWS, seed);
	double *scratch = statistics_sure(malloc(sizeof *scratch * pound_index_columns_scratch(&values, 0)));
	const struct pound_sampling sampling = {.u = u, .random = true, .fresh_signals = !cases[k].common};
	struct pound_estimate estimates[POUND_N_INDICES][D];
	struct pound_indices indices = {0};
	for (int i = 0; i < POUND_N_INDICES; i++)
		indices.index[i] = estimates[i];
	pound_index_columns_indices(&values, &sampling, seed, scratch, &indices);
	for (int i = 0; i < COLUMNS; i++)
		statistics_score_indices(&c->scores[k][i], f, &indices, columns[i].index[0], columns[i].index[1]);
	free(scratch);
	free(u);
	function_values_free(&values);
}

static void case_run(void *of, int k)
{
	struct campaign *c = of;
	for (int seed = 0; seed < c->n_seeds; seed++)
		seed_run(c, k, (uint64_t)seed);
}

/* Prints the largest bias of an index, root mean square errors over the inputs, and coverage; the last column is the
 * mean total of the input without effect, if there is one. */
void statistics_noise(int n_seeds)
{
	static struct campaign c;
	c.n_seeds = n_seeds;
	statistics_jobs(CASES, case_run, &c);
	printf("\n| function | signals | columns | bias of S1 | of ST | error of S1 | of ST | S1 covered | ST "
	       "covered | "
	       "inert ST |\n| --- | --- | --- | --- | --- | --- | --- | --- | --- | --- |\n");
	for (int k = 0; k < CASES; k++)
		for (int i = 0; i < COLUMNS; i++) {
			const struct statistics_score *s = &c.scores[k][i];
			const int last = STATISTICS_INDEXES - 1;
			printf("| %s | %s | %s | %+.3f | %+.3f | %.3f | %.3f | %.3f | %.3f |", cases[k].function,
			       cases[k].common ? "common" : "independent", columns[i].name, statistics_bias(s, 0),
			       statistics_bias(s, 1), statistics_error(s, 0), statistics_error(s, 1),
			       statistics_coverage(s, 0), statistics_coverage(s, 1));
			if (function_named(cases[k].function)->index[last] == 0.0)
				printf(" %+.3f |\n", s->bias[last] / s->n);
			else
				printf(" |\n");
		}
}
