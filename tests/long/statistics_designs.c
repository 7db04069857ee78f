/* statistics_designs.c - errors of S1 and ST against the plain protocol and other packages on the same outputs, and
 * coverage of their intervals, by design and number of rows. */
#include "tests/long/statistics.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>

enum {
	D = FUNCTION_INPUTS,
	JOBS_MAX = 200,
	SIZES = 3,
	RESAMPLES_FEW =
	    200, /* for intervals of the plain protocol with more than 1000 rows: ends within a tenth */
};

static const int sizes[SIZES] = {250, 1000, 4000};

// compared estimators: columns of a result, then the packages
enum { BEST, PLAIN, COLUMNS, ESTIMATORS = COLUMNS + 2 };

static const struct {
	const char *name[2];
	enum pound_index index[2];
} columns[COLUMNS] = {{{"S1", "ST"}, {POUND_S1, POUND_ST}},
                      {{"S1_raw", "ST_raw"}, {POUND_S1_RAW, POUND_ST_RAW}}};

struct cell {
	const struct function *function;
	int design, size;
	struct statistics_score scores[ESTIMATORS];
};

struct campaign {
	int n_seeds, n_cells;
	struct cell cells[JOBS_MAX];
};

static void seed_run(struct cell *cell, uint64_t seed)
{
	struct pound_design design = statistics_design(cell->design, sizes[cell->size], seed);
	design.resamples = sizes[cell->size] > 1000 ? RESAMPLES_FEW : 0;
	const struct pound_study study = statistics_study(&design);
	struct pound_run *run = statistics_sure(pound_run_create(&study, 1));
	const int n_samples = pound_run_samples(run);
	double *y = statistics_sure(malloc(sizeof *y * (size_t)design.rows * (size_t)n_samples));
	statistics_assign(run, cell->function, 0, y);
	pound_run_reduce(run, 0, 0);
	for (int c = 0; c < COLUMNS; c++)
		statistics_score_indices(&cell->scores[c], cell->function,
		                         &pound_run_result(run)->cells[0].indices[0], columns[c].index[0],
		                         columns[c].index[1]);
	for (int k = 0; statistics_packages[k].name; k++) {
		double value[STATISTICS_INDEXES];
		statistics_packages[k].indices(y, design.rows, D, n_samples, value);
		statistics_score_values(&cell->scores[COLUMNS + k], cell->function, value);
	}
	free(y);
	pound_run_free(run);
}

static void cell_run(void *of, int k)
{
	struct campaign *campaign = of;
	for (int seed = 0; seed < campaign->n_seeds; seed++)
		seed_run(&campaign->cells[k], (uint64_t)seed);
}

/* ---- tables ---- */

static double ratio_of(const struct cell *cell, int total)
{
	return statistics_error(&cell->scores[BEST], total) / statistics_error(&cell->scores[PLAIN], total);
}

static int rows_of(int design, int size)
{
	return statistics_design(design, sizes[size], 0).rows;
}

/* Means over the functions of all errors, and mean and largest of the ratios of S1 and ST together. */
static void row_of_errors(const struct campaign *c, int design, int size)
{
	double error[2][ESTIMATORS] = {0}, ratio = 0.0, worst = 0.0;
	int n = 0;
	for (int k = 0; k < c->n_cells; k++) {
		const struct cell *cell = &c->cells[k];
		if (cell->design != design || cell->size != size)
			continue;
		n++;
		for (int e = 0; e < ESTIMATORS; e++)
			for (int total = 0; total < 2; total++)
				error[total][e] += statistics_error(&cell->scores[e], total);
		ratio += ratio_of(cell, -1);
		worst = fmax(worst, ratio_of(cell, -1));
	}
	printf("| %s | %d |", pound_design_name(design), rows_of(design, size));
	for (int total = 0; total < 2; total++)
		for (int e = 0; e < ESTIMATORS; e++)
			printf(" %.1f |", 1e3 * error[total][e] / n);
	printf(" %.2f | %.2f |\n", ratio / n, worst);
}

static void errors_table(const struct campaign *c)
{
	printf("| design | n |");
	for (int total = 0; total < 2; total++) {
		for (int k = 0; k < COLUMNS; k++)
			printf(" %s |", columns[k].name[total]);
		for (int k = 0; statistics_packages[k].name; k++)
			printf(" %s |", statistics_packages[k].name);
	}
	printf(" over raw | worst |\n| --- | --- |");
	for (int k = 0; k < 2 * ESTIMATORS + 2; k++)
		printf(" --- |");
	printf("\n");
	for (int design = 0; pound_design_name(design); design++)
		for (int size = 0; size < SIZES; size++)
			row_of_errors(c, design, size);
}

static void head_of_sizes(const char *first)
{
	printf("\n| %s |", first);
	for (int design = 0; pound_design_name(design); design++)
		for (int size = 0; size < SIZES; size++)
			printf(" %s %d |", pound_design_name(design), rows_of(design, size));
	printf("\n| --- |");
	for (int k = 0; pound_design_name(k / SIZES); k++)
		printf(" --- |");
	printf("\n");
}

static const struct cell *cell_of(const struct campaign *c, const struct function *f, int design, int size)
{
	const struct cell *cell = c->cells;
	while (cell->function != f || cell->design != design || cell->size != size)
		cell++;
	return cell;
}

static void ratios_table(const struct campaign *c)
{
	head_of_sizes("function");
	const struct function *f;
	for (int k = 0; (f = statistics_function(k)); k++) {
		printf("| %s |", f->name);
		for (int design = 0; pound_design_name(design); design++)
			for (int size = 0; size < SIZES; size++) {
				const struct cell *cell = cell_of(c, f, design, size);
				printf(" %.2f %.2f |", ratio_of(cell, 0), ratio_of(cell, 1));
			}
		printf("\n");
	}
}

/* Mean and least coverage of intervals over functions and inputs. */
static void coverage_cell(const struct campaign *c, int design, int size, int column, int total)
{
	double sum = 0.0, least = 1.0;
	int n = 0;
	for (int k = 0; k < c->n_cells; k++) {
		const struct statistics_score *score = &c->cells[k].scores[column];
		for (int j = 0; j < D && c->cells[k].design == design && c->cells[k].size == size; j++, n++) {
			double covered = score->covered[total * D + j] / score->n;
			sum += covered;
			least = fmin(least, covered);
		}
	}
	printf(" %.3f (%.2f) |", sum / n, least);
}

static void coverage_table(const struct campaign *c)
{
	head_of_sizes("intervals of");
	for (int column = 0; column < COLUMNS; column++)
		for (int total = 0; total < 2; total++) {
			printf("| %s |", columns[column].name[total]);
			for (int k = 0; pound_design_name(k / SIZES); k++)
				coverage_cell(c, k / SIZES, k % SIZES, column, total);
			printf("\n");
		}
}

/* Prints, for every design and number of rows: root mean square errors in thousandths, over the inputs and then as
 * means over the functions; the ratio of S1 and ST to S1_raw and ST_raw, both together, mean and worst, and then for
 * every function; and the mean and the least fraction of 95 % intervals that cover the exact index. */
void statistics_designs(int n_seeds)
{
	static struct campaign c;
	c.n_seeds = n_seeds;
	// the largest first, so that no thread is left with a large job at the end
	for (int size = SIZES - 1; size >= 0; size--)
		for (int k = 0; statistics_function(k); k++)
			for (int design = 0; pound_design_name(design); design++)
				c.cells[c.n_cells++] =
				    (struct cell){.function = statistics_function(k), .design = design, .size = size};
	statistics_jobs(c.n_cells, cell_run, &c);
	errors_table(&c);
	ratios_table(&c);
	coverage_table(&c);
}
