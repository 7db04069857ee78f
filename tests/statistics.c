/* statistics.c - how good the indexes are: errors, coverage and bias over many designs of functions with exact indexes.
 *
 *   statistics [SEEDS [SUBSTRING of the functions' names]]
 *
 * 1. A cell is a function, a design and a number of rows; its seeds are computed one after the other by one thread, so
 *    that the numbers do not depend on how many threads there are.
 * 2. Every model is run as a user's own is: pound_run_create, its samples assigned, reduced.
 * 3. Progress goes to stderr, Markdown tables to stdout. */
#include <math.h>
#include <pthread.h>
#include <stdatomic.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "engine/pound.h"
#include "tests/statistics.h"

enum {
	D = FUNCTION_INPUTS,
	INDEXES = 2 * D, /* first-order, then total */
	FUNCTIONS_MAX = 16,
	DESIGNS_MAX = 4,
	SIZES = 3,
	THREADS_MAX = 64,
};

// where a polynomial is the function itself, error and interval are both of rounding's size
static const double ROUNDING = 1e-12;

static const int sizes[SIZES] = {250, 1000, 4000}; /* rows, of nets the nearest power of two */

// what is compared: columns of a result, then the packages
enum { BEST, PLAIN, PACKAGES, ESTIMATORS = PACKAGES + 2 };

static const struct {
	const char *name;
	enum pound_index first, total;
} columns[PACKAGES] = {{"S1, ST", POUND_S1, POUND_ST}, {"plain", POUND_S1_RAW, POUND_ST_RAW}};

struct cell {
	const struct function *function;
	int design, size;
	int rows;
	double bias[ESTIMATORS][INDEXES], square[ESTIMATORS][INDEXES]; /* means over the seeds */
	double covered[PACKAGES][INDEXES], half_width[PACKAGES][INDEXES];
};

struct campaign {
	int n_seeds, n_cells;
	struct cell cells[FUNCTIONS_MAX * DESIGNS_MAX * SIZES];
	atomic_int next, done;
};

/* ---- one cell ---- */

/* A study of four uniform inputs that is run here, in this program. */
static struct pound_study study_of(const struct cell *cell, uint64_t seed, struct pound_input inputs[D])
{
	static char name[] = "y";
	static char *names[] = {name};
	memset(inputs, 0, D * sizeof *inputs);
	for (int j = 0; j < D; j++)
		inputs[j].distribution = (struct pound_distribution){0, {0.0, 1.0}};
	return (struct pound_study){.kind = POUND_KIND_SENSITIVITY,
	                            .elsewhere = true,
	                            .n_inputs = D,
	                            .inputs = inputs,
	                            .design = {.method = cell->design, .rows = cell->rows, .seed = seed},
	                            .n_outputs = 1,
	                            .output_names = names};
}

static void seed_add(struct cell *cell, int estimator, const double *value, int n_seeds)
{
	for (int k = 0; k < INDEXES; k++) {
		double error = value[k] - cell->function->index[k];
		cell->bias[estimator][k] += error / n_seeds;
		cell->square[estimator][k] += error * error / n_seeds;
	}
}

static void column_add(struct cell *cell, int column, const struct pound_indices *indices, int n_seeds)
{
	double value[INDEXES];
	for (int k = 0; k < INDEXES; k++) {
		const struct pound_estimate *e =
		    &indices->index[k < D ? columns[column].first : columns[column].total][k % D];
		double truth = cell->function->index[k];
		value[k] = e->value;
		bool covered = e->low - ROUNDING <= truth && truth <= e->high + ROUNDING;
		cell->covered[column][k] += covered / (double)n_seeds;
		cell->half_width[column][k] += 0.5 * (e->high - e->low) / n_seeds;
	}
	seed_add(cell, column, value, n_seeds);
}

static void seed_run(struct cell *cell, uint64_t seed, int n_seeds)
{
	struct pound_input inputs[D];
	const struct pound_study study = study_of(cell, seed, inputs);
	struct pound_run *run = pound_run_create(&study, 1);
	const int n_samples = run ? pound_run_samples(run) : 0;
	double *y = malloc(sizeof *y * (size_t)cell->rows * (size_t)n_samples);
	if (!run || !y) {
		fprintf(stderr, "statistics: out of memory\n");
		exit(1);
	}
	for (int i = 0; i < cell->rows; i++)
		for (int p = 0; p < n_samples; p++) {
			double u[D];
			pound_run_sample_inputs(run, i, p, u);
			y[i * n_samples + p] = cell->function->y(u);
			pound_run_sample_assign(run, i, p, 0, y[i * n_samples + p], NAN);
		}
	pound_run_reduce(run, 0, 0);
	for (int c = 0; c < PACKAGES; c++)
		column_add(cell, c, &pound_run_result(run)->cells[0].indices[0], n_seeds);
	for (int k = 0; statistics_packages[k].name; k++) {
		double value[INDEXES];
		statistics_packages[k].indices(y, cell->rows, D, n_samples, value);
		seed_add(cell, PACKAGES + k, value, n_seeds);
	}
	free(y);
	pound_run_free(run);
}

static void *work(void *argument)
{
	struct campaign *campaign = argument;
	for (int k; (k = atomic_fetch_add(&campaign->next, 1)) < campaign->n_cells;) {
		struct cell *cell = &campaign->cells[k];
		for (int seed = 0; seed < campaign->n_seeds; seed++)
			seed_run(cell, (uint64_t)seed, campaign->n_seeds);
		int done = atomic_fetch_add(&campaign->done, 1) + 1;
		if (isatty(STDERR_FILENO))
			fprintf(stderr, "\r%d of %d cells%s", done, campaign->n_cells,
			        done < campaign->n_cells ? "" : "\r\033[K");
	}
	return NULL;
}

static void work_all(struct campaign *campaign)
{
	pthread_t threads[THREADS_MAX];
	int n = (int)sysconf(_SC_NPROCESSORS_ONLN);
	n = n > THREADS_MAX ? THREADS_MAX : n;
	for (int t = 0; t < n; t++)
		if (pthread_create(&threads[t], NULL, work, campaign)) {
			fprintf(stderr, "statistics: no thread\n");
			exit(1);
		}
	for (int t = 0; t < n; t++)
		pthread_join(threads[t], NULL);
}

/* ---- tables ---- */

static int rows_of(int design, int size)
{
	int rows = 1;
	while (4 * rows < 3 * size)
		rows *= 2;
	return strcmp(pound_design_name(design), "sobol") ? size : rows;
}

static double mean_of(const double *value, int n)
{
	double sum = 0.0;
	for (int k = 0; k < n; k++)
		sum += value[k] / n;
	return sum;
}

/* Root mean square error of an estimator's first-order (0) or total (1) indexes, or both (-1). */
static double error_of(const struct cell *cell, int estimator, int total)
{
	return sqrt(mean_of(cell->square[estimator] + (total == 1 ? D : 0), total < 0 ? INDEXES : D));
}

static double ratio_of(const struct cell *cell)
{
	return error_of(cell, BEST, -1) / error_of(cell, PLAIN, -1);
}

/* The mean over the functions of an error, and the mean and the largest of the ratios of both together. */
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
				error[total][e] += error_of(cell, e, total);
		ratio += ratio_of(cell);
		worst = fmax(worst, ratio_of(cell));
	}
	printf("| %s | %d |", pound_design_name(design), rows_of(design, sizes[size]));
	for (int total = 0; total < 2; total++)
		for (int e = 0; e < ESTIMATORS; e++)
			printf(" %.1f |", 1e3 * error[total][e] / n);
	printf(" %.2f | %.2f |\n", ratio / n, worst);
}

static void errors_table(const struct campaign *c)
{
	printf("| design | n | S1 |");
	for (int total = 0; total < 2; total++) {
		if (total)
			printf(" ST |");
		printf(" plain |");
		for (int k = 0; statistics_packages[k].name; k++)
			printf(" %s |", statistics_packages[k].name);
	}
	printf(" over plain | worst |\n| --- | --- |");
	for (int k = 0; k < 2 * ESTIMATORS + 2; k++)
		printf(" --- |");
	printf("\n");
	for (int design = 0; pound_design_name(design); design++)
		for (int size = 0; size < SIZES; size++)
			row_of_errors(c, design, size);
}

static const struct cell *cell_of(const struct campaign *c, const struct function *f, int design, int size)
{
	for (int k = 0; k < c->n_cells; k++)
		if (c->cells[k].function == f && c->cells[k].design == design && c->cells[k].size == size)
			return &c->cells[k];
	abort();
}

static void head_of_sizes(const char *first)
{
	printf("\n| %s |", first);
	for (int design = 0; pound_design_name(design); design++)
		for (int size = 0; size < SIZES; size++)
			printf(" %s %d |", pound_design_name(design), rows_of(design, sizes[size]));
	printf("\n| --- |");
	for (int design = 0; pound_design_name(design); design++)
		for (int size = 0; size < SIZES; size++)
			printf(" --- |");
	printf("\n");
}

static void ratios_table(const struct campaign *c)
{
	head_of_sizes("S1 and ST over plain");
	for (int k = 0; k < c->n_cells; k++) {
		const struct function *f = c->cells[k].function;
		if (cell_of(c, f, 0, SIZES - 1) != &c->cells[k])
			continue;
		printf("| %s |", f->name);
		for (int design = 0; pound_design_name(design); design++)
			for (int size = 0; size < SIZES; size++) {
				const struct cell *cell = cell_of(c, f, design, size);
				printf(" %.2f (%.2f %.2f) |", ratio_of(cell),
				       error_of(cell, BEST, 0) / error_of(cell, PLAIN, 0),
				       error_of(cell, BEST, 1) / error_of(cell, PLAIN, 1));
			}
		printf("\n");
	}
}

static void coverage_table(const struct campaign *c)
{
	static const char *const names[2][PACKAGES] = {{"S1", "S1_raw"}, {"ST", "ST_raw"}};
	head_of_sizes("95 % intervals cover [least of one index]");
	for (int column = 0; column < PACKAGES; column++)
		for (int total = 0; total < 2; total++) {
			printf("| %s |", names[total][column]);
			for (int design = 0; pound_design_name(design); design++)
				for (int size = 0; size < SIZES; size++) {
					double sum = 0.0, least = 1.0;
					int n = 0;
					for (int k = 0; k < c->n_cells; k++)
						for (int j = 0; j < D; j++)
							if (c->cells[k].design == design && c->cells[k].size == size) {
								double covered = c->cells[k].covered[column][total * D + j];
								sum += covered;
								least = fmin(least, covered);
								n++;
							}
					printf(" %.3f [%.2f] |", sum / n, least);
				}
			printf("\n");
		}
}

/* ---- all of it ---- */

static void cells_fill(struct campaign *c, const struct function *f, const char *names)
{
	// the largest first, so that no thread is left with one at the end
	for (; f->name; f++)
		for (int design = 0; pound_design_name(design) && strstr(f->name, names); design++)
			for (int size = SIZES - 1; size >= 0; size--)
				c->cells[c->n_cells++] = (struct cell){
				    .function = f, .design = design, .size = size, .rows = rows_of(design, sizes[size])};
}

int main(int argc, char **argv)
{
	static struct campaign campaign;
	campaign.n_seeds = argc > 1 ? atoi(argv[1]) : 200;
	cells_fill(&campaign, functions, argc > 2 ? argv[2] : "");
	cells_fill(&campaign, statistics_functions, argc > 2 ? argv[2] : "");
	work_all(&campaign);
	errors_table(&campaign);
	ratios_table(&campaign);
	coverage_table(&campaign);
	return 0;
}
