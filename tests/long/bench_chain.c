/* bench_chain.c - rows of buildings against a plain loop. */
#include "tests/long/bench.h"

#include <math.h>
#include <stdlib.h>

#include "tests/support/baseline_chain.h"
#include "tests/support/chain_scenes.h"
#include "tests/support/scenes.h"

enum { SAMPLES = 2001, STEPS = 1000, DENSER = 2 };

/* a row and the settings of its run */
struct chain_bench {
	struct row row;
	struct pound_chain_task task;
	void *scratch;
	bool yields;
	double drift[ROW_FLOORS]; /* computed by the loop */
};

/* Two buildings of n stories under 20 s of noise with a peak of about 3 m/s2; contacts at all floors. */
static void chain_bench_init(struct chain_bench *b, int n, bool yields, double stiffness_ratio)
{
	struct row *row = &b->row;
	uint64_t seed = 7;
	row_init(row);
	row->n_buildings = 2;
	row->contact.gap = 0.004 * n;
	row->contact.stiffness_ratio = stiffness_ratio;
	for (int k = 0; k < 2; k++) {
		row->buildings[k] = row_building(n, 1e5, 1);
		row->buildings[k].frequency_hz = (k ? 1.4 : 1) * 10.0 / n;
		int law = 0;
		while (yields == pound_law_linear(law))
			law++;
		row->buildings[k].law = (struct pound_backbone){.law = law, .hardening = 0.05, .yield = 0.005};
	}
	for (int i = 0; i < SAMPLES; i++)
		row->ground[i] = specimen_uniform(&seed, -3, 3);
	b->yields = yields;
	b->task = row_task(row, SAMPLES, 0.01, POUND_CHAIN_DRIFTS);
}

static void run_chain(void *of)
{
	struct chain_bench *b = of;
	struct pound_chain_result result = {.floors = b->row.floor_measures[0], .links = b->row.link_measures[0]};
	pound_chain_lanes(0, &b->task, &result, 1, b->scratch, NULL);
	if (result.status != POUND_OK)
		bench_fail(pound_status_text(result.status));
}

static void run_loop(void *of)
{
	struct chain_bench *b = of;
	(b->yields ? baseline_chain_yielding : baseline_chain_linear)(&b->task, STEPS, b->drift);
}

/* Largest difference of drifts, relative to the largest drift. */
static double drift_error(const struct chain_bench *b, const double *drift, int stride)
{
	double most = 0, error = 0;
	for (int i = 0; i < b->task.n_floors; i++) {
		const double want = b->row.floor_measures[i][POUND_FLOOR_DRIFT_MAX];
		most = fmax(most, want);
		error = fmax(error, fabs(drift[i * stride] - want));
	}
	return error / most;
}

/* The same ground motion with twice as many samples: other steps, other maps of free motion. */
static double own_error(const struct chain_bench *b)
{
	static double ground[DENSER * (SAMPLES - 1) + 1], floors[ROW_FLOORS][POUND_FLOOR_MEASURES],
	    links[ROW_LINKS][POUND_LINK_MEASURES];
	for (int i = 0; i < DENSER * (SAMPLES - 1) + 1; i++)
		ground[i] = i % 2 ? 0.5 * (b->row.ground[i / 2] + b->row.ground[i / 2 + 1]) : b->row.ground[i / 2];
	struct pound_chain_task task = b->task;
	task.ground = ground;
	task.n_samples = DENSER * (SAMPLES - 1) + 1;
	task.time_step = b->task.time_step / DENSER;
	struct pound_chain_result result = {.floors = floors[0], .links = links[0]};
	pound_chain_lanes(0, &task, &result, 1, b->scratch, NULL);
	return drift_error(b, &floors[0][POUND_FLOOR_DRIFT_MAX], POUND_FLOOR_MEASURES);
}

static void bench_stories(struct chain_bench *b, int n, bool yields)
{
	chain_bench_init(b, n, yields, 100);
	struct bench_job engine = {run_chain, b, 0}, loop = {run_loop, b, 0};
	bench_jobs(&engine, 1, 20);
	bench_jobs(&loop, 1, 2);
	const double least = yields ? 150 : 250, ratio = loop.seconds / engine.seconds, error = own_error(b);
	double contacts = 0;
	for (int j = 0; j < b->task.n_links; j++)
		contacts += b->row.link_measures[j][POUND_LINK_CONTACTS];
	bench_print(
	    (struct bench_row){.what = bench_text("two buildings of %d stories that %s, 20 s, %.0f contacts", n,
	                                          yields ? "yield" : "do not yield", contacts),
	                       .value = 1e6 * engine.seconds,
	                       .unit = "us",
	                       .error = error,
	                       .goal = "below 1e-12",
	                       .met = error < 1e-12});
	bench_print((struct bench_row){.what = "its central differences at 1e-5 s",
	                               .value = 1e6 * loop.seconds,
	                               .unit = "us",
	                               .ratio = ratio,
	                               .to = "the chain",
	                               .error = drift_error(b, b->drift, 1),
	                               .goal = yields ? "at least 150" : "at least 250",
	                               .met = ratio >= least});
}

void bench_chains(void)
{
	struct chain_bench *b = bench_memory(sizeof *b), *stiff = bench_memory(sizeof *stiff);
	b->scratch = stiff->scratch = bench_memory(POUND_CHAIN_SCRATCH);
	static const int stories[] = {3, 10, 30};
	for (int yields = 0; yields < 2; yields++)
		for (int k = 0; k < 3; k++)
			bench_stories(b, stories[k], yields);
	chain_bench_init(b, 10, false, 100);
	chain_bench_init(stiff, 10, false, 1e6);
	struct bench_job jobs[] = {{run_chain, b, 0}, {run_chain, stiff, 0}};
	bench_jobs(jobs, 2, 20);
	const double ratio = jobs[1].seconds / jobs[0].seconds;
	bench_print((struct bench_row){.what = "two buildings of 10 stories, K/k = 1e+06",
	                               .value = 1e6 * jobs[1].seconds,
	                               .unit = "us",
	                               .ratio = ratio,
	                               .to = "K/k = 100",
	                               .goal = "at most 1.5",
	                               .met = ratio <= 1.5});
	bench_print((struct bench_row){.what = "work space of a chain with straight contacts",
	                               .value = POUND_CHAIN_SCRATCH_STRAIGHT / 1024.0,
	                               .unit = "KiB",
	                               .goal = "at most 1024",
	                               .met = POUND_CHAIN_SCRATCH_STRAIGHT <= 1 << 20});
	free(b->scratch);
	free(stiff);
	free(b);
}
