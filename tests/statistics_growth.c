/* statistics_growth.c - designs that grow until every interval of S1 and ST is narrow: what they spend, how large the
 * errors then are, and whether the intervals at the stop still cover. */
#include "tests/statistics.h"

#include <stdio.h>
#include <string.h>

enum { DESIGNS = 2, CELLS_MAX = 64, RUNS_MAX = 20000 };

static const char *const designs[DESIGNS] = {"lhs", "sobol"};

static const double HALF_WIDTH = 0.03;

struct cell {
	const struct function *function;
	int design;
	double runs; /* sums over the seeds */
	int narrow;  /* stopped because they were */
	struct statistics_score score;
};

struct campaign {
	int n_seeds, n_cells;
	struct cell cells[CELLS_MAX];
};

static void seed_run(struct cell *cell, uint64_t seed)
{
	struct pound_design design = statistics_design(cell->design, 2, seed);
	design.until = (struct pound_until){.half_width = HALF_WIDTH, .max_runs = RUNS_MAX};
	const struct pound_study study = statistics_study(&design);
	struct pound_run *run = statistics_sure(pound_run_create(&study, 1));
	int rows = 0;
	do {
		statistics_assign(run, cell->function, rows, NULL);
		rows = pound_run_rows(run);
		pound_run_reduce(run, 0, 0);
	} while (pound_run_grow(run));
	const struct pound_result *result = pound_run_result(run);
	const struct pound_indices *indices = &result->cells[0].indices[0];
	cell->runs += (double)result->rows * pound_run_samples(run);
	cell->narrow += result->looks[result->n_looks - 1].half_width <= HALF_WIDTH;
	statistics_score_indices(&cell->score, cell->function, indices, POUND_S1, POUND_ST);
	pound_run_free(run);
}

static int design_named(const char *name)
{
	int design = 0;
	while (strcmp(pound_design_name(design), name))
		design++;
	return design;
}

static void cell_run(void *of, int k)
{
	struct campaign *campaign = of;
	for (int seed = 0; seed < campaign->n_seeds; seed++)
		seed_run(&campaign->cells[k], (uint64_t)seed);
}

static void cell_print(const struct cell *cell)
{
	int n = cell->score.n;
	printf(" %.0f | %.3f | %.3f | %.2f |", cell->runs / n, statistics_error(&cell->score, -1),
	       statistics_coverage(&cell->score, -1), (double)cell->narrow / n);
}

/* What all functions come to in one design: means. */
static void all_print(const struct campaign *c, int design)
{
	double runs = 0.0, error = 0.0, covered = 0.0, narrow = 0.0;
	int n = 0;
	for (int k = 0; k < c->n_cells; k++) {
		const struct cell *cell = &c->cells[k];
		if (cell->design != design)
			continue;
		n++;
		runs += cell->runs / cell->score.n;
		error += statistics_error(&cell->score, -1);
		covered += statistics_coverage(&cell->score, -1);
		narrow += (double)cell->narrow / cell->score.n;
	}
	printf(" %.0f | %.3f | %.3f | %.2f |", runs / n, error / n, covered / n, narrow / n);
}

/* Prints, of designs that grow to a half width of 0.03 within 20,000 runs: mean runs, root mean square error of all eight
 * indexes, coverage of the intervals at the stop, and how often they were narrow enough.  Half the seeds will do. */
void statistics_growth(int n_seeds)
{
	static struct campaign c;
	c.n_seeds = (n_seeds + 1) / 2;
	for (int k = 0; statistics_function(k); k++)
		for (int d = 0; d < DESIGNS; d++)
			c.cells[c.n_cells++] =
			    (struct cell){.function = statistics_function(k), .design = design_named(designs[d])};
	statistics_jobs(c.n_cells, cell_run, &c);
	printf("\n| function |");
	for (int d = 0; d < DESIGNS; d++)
		printf(" %s runs | error | covered | narrow |", designs[d]);
	printf("\n| --- |");
	for (int d = 0; d < DESIGNS; d++)
		printf(" --- | --- | --- | --- |");
	for (int k = 0; k < c.n_cells; k++) {
		if (k == 0 || c.cells[k].function != c.cells[k - 1].function)
			printf("\n| %s |", c.cells[k].function->name);
		cell_print(&c.cells[k]);
	}
	printf("\n| all |");
	for (int d = 0; d < DESIGNS; d++)
		all_print(&c, design_named(designs[d]));
	printf("\n");
}
