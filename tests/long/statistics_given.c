/* statistics_given.c - errors and coverage of the indices of given data: random samples without a design. */
#include "tests/long/statistics.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>

#include "tests/support/given_samples.h"

enum { D = FUNCTION_INPUTS, SIZES = 3, CELLS_MAX = 64 };

static const int sizes[SIZES] = {200, 500, 2000};

/* One function and one number of samples. */
struct cell {
	const struct function *function;
	int n_samples;
	struct statistics_score scores[2]; /* first-order indices of all sets; both of those where ST is given */
	int fitted, noted; /* sets with ST, and with the note that few samples hold most of the variance */
	double missed_without_note; /* intervals of S1 */
};

struct campaign {
	int n_seeds, n_cells;
	struct cell cells[CELLS_MAX];
};

static void seed_run(struct cell *cell, uint64_t seed)
{
	struct given_samples s;
	struct pound_given_indices *given = statistics_sure(calloc(1, sizeof *given));
	struct pound_indices indices = {.index = {[POUND_S1] = given->first, [POUND_ST] = given->total}};
	given_draw(&s, cell->n_samples, D, (seed + 1) * 0x9E3779B97F4A7C15u);
	for (int i = 0; i < cell->n_samples; i++)
		s.y[i] = cell->function->y(s.x + (size_t)i * D);
	given_check(&s);
	given_estimate(&s, given);
	const double before = statistics_coverage(&cell->scores[0], 0) * cell->scores[0].n;
	const bool fitted = isfinite(given->total[0].value),
	           noted = given_says(given->notes, POUND_GIVEN_FEW_DECIDE);
	for (int k = 0; k < 1 + fitted; k++)
		statistics_score_indices(&cell->scores[k], cell->function, &indices, POUND_S1, POUND_ST);
	cell->fitted += fitted;
	cell->noted += noted;
	if (!noted)
		cell->missed_without_note += 1.0 - (statistics_coverage(&cell->scores[0], 0) * cell->scores[0].n -
		                                    (isnan(before) ? 0.0 : before));
	free(given);
	given_free(&s);
}

static void cell_run(void *of, int k)
{
	struct campaign *campaign = of;
	for (int seed = 0; seed < campaign->n_seeds; seed++)
		seed_run(&campaign->cells[k], (uint64_t)seed);
}

static void cell_print(const struct cell *cell, int n_seeds)
{
	const struct statistics_score *all = &cell->scores[0], *fitted = &cell->scores[1];
	printf("| %s | %d | %.3f | %.3f | ", cell->function->name, cell->n_samples, statistics_error(all, 0),
	       statistics_coverage(all, 0));
	if (cell->fitted > 0)
		printf("%.2f | %.3f | %.3f | ", (double)cell->fitted / n_seeds, statistics_error(fitted, 1),
		       statistics_coverage(fitted, 1));
	else
		printf("0 | | | ");
	printf("%.2f | %.3f |\n", (double)cell->noted / n_seeds,
	       cell->noted < n_seeds ? 1.0 - cell->missed_without_note / (n_seeds - cell->noted) : NAN);
}

/* Means over the functions with one number of samples; in parentheses the lowest coverage of a function. */
static void means_print(const struct campaign *campaign, int n_samples)
{
	double error[2] = {0}, covered[2] = {0}, lowest[2] = {1.0, 1.0}, fitted = 0.0;
	int n[2] = {0};
	for (int k = 0; k < campaign->n_cells; k++) {
		const struct cell *cell = &campaign->cells[k];
		for (int total = 0; total < 2 && cell->n_samples == n_samples; total++) {
			const struct statistics_score *score = &cell->scores[total];
			if (score->n == 0)
				continue;
			const double coverage = statistics_coverage(score, total);
			error[total] += statistics_error(score, total);
			covered[total] += coverage;
			lowest[total] = fmin(lowest[total], coverage);
			n[total]++;
			fitted += total ? (double)cell->fitted / campaign->n_seeds : 0.0;
		}
	}
	printf("| mean | %d | %.3f | %.3f (%.2f) | %.2f | %.3f | %.3f (%.2f) | | |\n", n_samples, error[0] / n[0],
	       covered[0] / n[0], lowest[0], fitted / n[0], error[1] / n[1], covered[1] / n[1], lowest[1]);
}

void statistics_given(int n_seeds)
{
	struct campaign *campaign = statistics_sure(calloc(1, sizeof *campaign));
	const struct function *f;
	campaign->n_seeds = n_seeds;
	for (int k = 0; (f = statistics_function(k)); k++)
		for (int size = 0; size < SIZES; size++)
			campaign->cells[campaign->n_cells++] = (struct cell){.function = f, .n_samples = sizes[size]};
	statistics_jobs(campaign->n_cells, cell_run, campaign);
	printf("\n| function | samples | error of S1 | covered | ST given | error of ST | covered | noted | S1 "
	       "covered, "
	       "not noted |\n");
	printf("| --- | --- | --- | --- | --- | --- | --- | --- | --- |\n");
	for (int k = 0; k < campaign->n_cells; k++)
		cell_print(&campaign->cells[k], n_seeds);
	for (int size = 0; size < SIZES; size++)
		means_print(campaign, sizes[size]);
	free(campaign);
}
