/* statistics_signals.c - benefit of signals "auto": CPU time until every S1 and ST of the paper's linear study has a
 * half width of 0.05, at each of its six frequencies, against fixed numbers of signals. */
#include "tests/long/statistics.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

#include "schema/examples/examples.h"
#include "schema/json/problems.h"
#include "schema/study/study_json.h"

enum { FREQUENCIES = 6, SPLITS = 6, MAX_RUNS = 300000 };

static const double frequencies[FREQUENCIES] = {0.5, 1, 2, 3, 4, 5};
static const int splits[SPLITS] = {0, 2, 3, 5, 10, 20}; /* 0: auto */

struct cell {
	int frequency, split;
	double cpu, runs, half_width, signals; /* sums over the seeds */
	int reached;
};

struct campaign {
	int n_seeds;
	struct cell cells[FREQUENCIES * SPLITS];
};

static double thread_cpu(void)
{
	struct timespec now;
	clock_gettime(CLOCK_THREAD_CPUTIME_ID, &now);
	return (double)now.tv_sec + 1e-9 * (double)now.tv_nsec;
}

static struct pound_study *linear_study(void)
{
	struct problems problems;
	const char *text = example_text("paper_linear");
	return statistics_sure(study_from_json(text, strlen(text), &problems));
}

static void seed_run(struct cell *cell, uint64_t seed)
{
	struct pound_study *study = linear_study();
	study->scene.oscillators[0].frequency_hz = frequencies[cell->frequency];
	study->design = (struct pound_design){
	    .rows = 2,
	    .seed = seed,
	    .common_signals = true,
	    .split = splits[cell->split] == 0,
	    .until = {.half_width = 0.05, .max_runs = MAX_RUNS},
	};
	study->scene.excitation.signals = splits[cell->split] ? splits[cell->split] : POUND_SPLIT_LEAST;
	const double start = thread_cpu();
	struct pound_run *run = statistics_sure(pound_run_create(study, 1));
	int block = 0;
	do {
		for (; block < pound_run_blocks(run); block++)
			if (pound_run_block(run, block, 0) != POUND_OK)
				abort();
		for (int k = 0; k < pound_run_reductions(run); k++)
			pound_run_reduce(run, k, 0);
	} while (pound_run_grow(run));
	const struct pound_result *result = pound_run_result(run);
	const struct pound_look *last = &result->looks[result->n_looks - 1];
	cell->cpu += thread_cpu() - start;
	cell->runs += (double)result->cells[0].runs + (double)result->split.pilot_runs;
	cell->half_width += last->half_width;
	cell->reached += last->half_width <= study->design.until.half_width;
	cell->signals += result->split.signals ? result->split.signals : study->scene.excitation.signals;
	pound_run_free(run);
	study_free(study);
}

static void cell_run(void *of, int k)
{
	struct campaign *campaign = of;
	for (int seed = 0; seed < campaign->n_seeds; seed++)
		seed_run(&campaign->cells[k], (uint64_t)seed);
}

/* Prints, for each frequency, mean CPU seconds and runs with signals "auto" and with fixed numbers of signals; for a
 * design that is not narrow enough after 300,000 runs, its half width instead. */
void statistics_signals(int n_seeds)
{
	static struct campaign c;
	c.n_seeds = n_seeds;
	for (int f = 0; f < FREQUENCIES; f++)
		for (int s = 0; s < SPLITS; s++)
			c.cells[f * SPLITS + s] = (struct cell){.frequency = f, .split = s};
	statistics_jobs(FREQUENCIES * SPLITS, cell_run, &c);
	printf("\n| f_1 [Hz] | signals chosen |");
	for (int s = 0; s < SPLITS; s++)
		if (splits[s])
			printf(" %d signals [s] |", splits[s]);
		else
			printf(" auto [s] | runs |");
	printf(" saving over 2, 5, 20 |\n| --- | --- |");
	for (int s = 0; s <= SPLITS + 1; s++)
		printf(" --- |");
	for (int f = 0; f < FREQUENCIES; f++) {
		const struct cell *row = &c.cells[f * SPLITS];
		printf("\n| %g | %.1f |", frequencies[f], row->signals / n_seeds);
		for (int s = 0; s < SPLITS; s++) {
			printf(" %.2f", row[s].cpu / n_seeds);
			if (row[s].reached < n_seeds)
				printf(" (%.3f)", row[s].half_width / n_seeds);
			printf(s ? " |" : " | %.0f |", row[s].runs / n_seeds);
		}
		printf(" %.1f, %.1f, %.1f |", row[1].cpu / row->cpu, row[3].cpu / row->cpu, row[5].cpu / row->cpu);
	}
	printf("\n");
}
