/* statistics_named.c - errors of the named estimators, by their published formulas, from the same number of runs. */
#include "tests/long/statistics.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "engine/design/design.h"

enum {
	D = FUNCTION_INPUTS,
	SAMPLES = 2 * D + 2, /* A, B, A with a column from B, B with a column from A */
	ROWS = 1000,
	ESTIMATORS_MAX = 16,
	CELLS_MAX = 64,
};

struct cell {
	const struct function *function;
	int design;
	struct statistics_score scores[ESTIMATORS_MAX];
};

struct campaign {
	int n_seeds, n_cells;
	struct cell cells[CELLS_MAX];
};

/* Outputs of all samples that any estimator may need, centered by the mean over A and B. */
static void outputs_fill(const struct function *f, const double *x, int n, double *y)
{
	double mean = 0.0;
	for (int i = 0; i < n; i++)
		for (int p = 0; p < SAMPLES; p++) {
			double u[D];
			for (int j = 0; j < D; j++)
				u[j] = pound_design_input(x, D, i, pound_order_mask(D, p), j);
			y[i * SAMPLES + p] = f->y(u);
			mean += p < 2 ? y[i * SAMPLES + p] / (2 * n) : 0.0;
		}
	for (int k = 0; k < n * SAMPLES; k++)
		y[k] -= mean;
}

/* The rows of an estimator for the runs of ROWS rows of d + 2 samples; a power of two for Sobol' sequences. */
static int rows_of(const struct pound_estimator *e, int design, int rows)
{
	int wanted = e->order == POUND_ORDER_TOTAL ? rows : rows * (D + 2) / SAMPLES;
	return statistics_design(design, wanted, 0).rows;
}

static void seed_run(struct cell *cell, uint64_t seed)
{
	const struct pound_estimator *e;
	double y[2 * ROWS * SAMPLES];
	for (int k = 0; (e = pound_estimator_row(k)); k++) {
		struct pound_design design = statistics_design(cell->design, ROWS, seed);
		design.rows = rows_of(e, cell->design, design.rows);
		double *x = function_design_of(&design), mean[POUND_MOMENTS_MAX] = {0}, value[STATISTICS_INDEXES];
		outputs_fill(cell->function, x, design.rows, y);
		for (int i = 0; i < design.rows; i++) {
			double m[POUND_MOMENTS_MAX];
			const struct pound_outputs row = {D, SAMPLES, y + i * SAMPLES, NULL};
			e->moments(&row, m);
			for (int t = 0; t < e->n_moments(D); t++)
				mean[t] += m[t] / design.rows;
		}
		e->indices(mean, D, 0.0, value);
		statistics_score_values(&cell->scores[k], cell->function, value);
		free(x);
	}
}

static void cell_run(void *of, int k)
{
	struct campaign *campaign = of;
	for (int seed = 0; seed < campaign->n_seeds; seed++)
		seed_run(&campaign->cells[k], (uint64_t)seed);
}

/* Prints root mean square errors in thousandths, over the inputs and then as means over the functions. */
void statistics_named(int n_seeds)
{
	static struct campaign c;
	c.n_seeds = n_seeds;
	for (int k = 0; statistics_function(k); k++)
		for (int design = 0; pound_design_name(design); design++)
			c.cells[c.n_cells++] = (struct cell){.function = statistics_function(k), .design = design};
	statistics_jobs(c.n_cells, cell_run, &c);
	printf("\n| estimator |");
	for (int design = 0; pound_design_name(design); design++)
		printf(" %s S1 | ST |", pound_design_name(design));
	printf("\n| --- |");
	for (int design = 0; pound_design_name(design); design++)
		printf(" --- | --- |");
	const struct pound_estimator *e;
	for (int k = 0; (e = pound_estimator_row(k)); k++) {
		printf("\n| %s |", e->name);
		for (int design = 0; pound_design_name(design); design++)
			for (int total = 0; total < 2; total++) {
				double sum = 0.0;
				int n = 0;
				for (int i = 0; i < c.n_cells; i++)
					if (c.cells[i].design == design) {
						sum += statistics_error(&c.cells[i].scores[k], total);
						n++;
					}
				printf(" %.1f |", 1e3 * sum / n);
			}
	}
	printf("\n");
}
