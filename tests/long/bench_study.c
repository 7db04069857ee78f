/* bench_study.c - benchmarks of whole studies: the paper's campaign, threads, and growth of the cost. */
#include "tests/long/bench.h"

#include <pthread.h>
#include <stdatomic.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/wait.h>
#include <unistd.h>

#include "schema/examples/examples.h"
#include "schema/study/study_json.h"

enum { THREADS = 2, REPEATS = 3 };

/* ---- a study run ---- */

struct pool {
	struct pound_run *run;
	enum pound_status (*step)(struct pound_run *run, int index, int worker);
	int n_steps;
	atomic_int next, worker;
};

static void *pool_work(void *of)
{
	struct pool *pool = of;
	int worker = atomic_fetch_add(&pool->worker, 1);
	for (int i; (i = atomic_fetch_add(&pool->next, 1)) < pool->n_steps;)
		if (pool->step(pool->run, i, worker) != POUND_OK)
			bench_fail("a block of a study failed");
	return NULL;
}

static void pool_run(struct pool *pool, int threads)
{
	pthread_t thread[THREADS];
	atomic_store(&pool->next, 0);
	atomic_store(&pool->worker, 0);
	for (int w = 0; w < threads; w++)
		if (pthread_create(&thread[w], NULL, pool_work, pool) != 0)
			bench_fail("no thread");
	for (int w = 0; w < threads; w++)
		pthread_join(thread[w], NULL);
}

/* cost of a study */
struct cost {
	double wall, cpu, cpu_reductions; /* [s] */
	double memory;                    /* peak of the process [B] */
	struct pound_work work;
	int64_t runs;
};

static double peak_memory(void)
{
	char line[128];
	double kib = 0;
	FILE *status = fopen("/proc/self/status", "r");
	while (status && fgets(line, sizeof line, status))
		if (sscanf(line, "VmHWM: %lf", &kib) == 1)
			break;
	if (status)
		fclose(status);
	return 1024 * kib;
}

static struct cost study_cost(const struct pound_study *study, int threads)
{
	double wall = bench_seconds(CLOCK_MONOTONIC), cpu = bench_seconds(CLOCK_PROCESS_CPUTIME_ID);
	struct pool pool = {.run = pound_run_create(study, threads)};
	if (!pool.run)
		bench_fail("out of memory");
	pool.step = pound_run_block;
	pool.n_steps = pound_run_blocks(pool.run);
	pool_run(&pool, threads);
	double blocks = bench_seconds(CLOCK_PROCESS_CPUTIME_ID);
	pool.step = pound_run_reduce;
	pool.n_steps = pound_run_reductions(pool.run);
	pool_run(&pool, threads);
	struct cost cost = {.work = pound_run_result(pool.run)->work, .runs = study_runs(study)};
	cost.wall = bench_seconds(CLOCK_MONOTONIC) - wall;
	cost.cpu = bench_seconds(CLOCK_PROCESS_CPUTIME_ID) - cpu;
	cost.cpu_reductions = bench_seconds(CLOCK_PROCESS_CPUTIME_ID) - blocks;
	cost.memory = peak_memory();
	pound_run_free(pool.run);
	return cost;
}

/* The same in a separate process, to measure its memory. */
static struct cost study_cost_forked(const struct pound_study *study, int threads)
{
	struct cost cost;
	int ends[2], status;
	fflush(stdout);
	pid_t child = pipe(ends) == 0 ? fork() : -1;
	if (child == 0) {
		cost = study_cost(study, threads);
		_exit(write(ends[1], &cost, sizeof cost) == sizeof cost ? 0 : 1);
	}
	if (child > 0)
		close(ends[1]);
	if (child < 0 || read(ends[0], &cost, sizeof cost) != sizeof cost || waitpid(child, &status, 0) != child)
		bench_fail("the process of a study failed");
	close(ends[0]);
	return cost;
}

/* ---- the paper's campaign ---- */

static void campaign_rows(const struct cost *cost, int rows)
{
	const char *name = bench_text("the paper's campaign, n = %d, %.0f runs", rows, (double)cost->runs);
	double per_run = 1e6 * cost->cpu / (double)cost->runs;
	bench_print((struct bench_row){
	    .what = bench_text("%s: wall, %d threads", name, THREADS),
	    .value = cost->wall,
	    .unit = "s",
	    .goal = rows == 1000 ? bench_text("5 s: %s, at most 10 s", cost->wall <= 5 ? "yes" : "no") : NULL,
	    .met = cost->wall <= 10});
	bench_print((struct bench_row){.what = "its CPU time", .value = cost->cpu, .unit = "s"});
	bench_print((struct bench_row){.what = "of which the indices and their intervals",
	                               .value = cost->cpu_reductions,
	                               .unit = "s",
	                               .ratio = cost->cpu_reductions / cost->cpu,
	                               .to = "of the CPU time"});
	bench_print((struct bench_row){
	    .what = "CPU time of a pounding run with all it needs", .value = per_run, .unit = "us"});
	bench_print((struct bench_row){.what = "its peak memory",
	                               .value = 1e-6 * cost->memory,
	                               .unit = "MB",
	                               .goal = "below 200 MB",
	                               .met = cost->memory < 200e6});
#define X(member, text)                                                                                      \
	bench_print((struct bench_row){.what = "its " text ", made",                                             \
	                               .value = (double)cost->work.member.run,                                   \
	                               .ratio = (double)cost->work.member.run / (double)cost->work.member.asked, \
	                               .to = "of those asked"});
	POUND_STAGES(X)
#undef X
	bench_print(
	    (struct bench_row){.what = "its contacts",
	                       .value = (double)cost->work.contacts,
	                       .ratio = (double)cost->work.contacts / (double)cost->work.pounding_runs.run,
	                       .to = "a run"});
}

/* The paper's campaign with `rows` rows, and with twenty rows by one thread and by two. */
void bench_campaign(int rows)
{
	struct pound_study *study = bench_study(example_text("paper"));
	study->design.rows = rows;
	struct cost cost = study_cost_forked(study, THREADS);
	campaign_rows(&cost, rows);

	study->design.rows = 20;
	struct cost best[THREADS + 1] = {0};
	for (int repeat = 0; repeat < REPEATS; repeat++)
		for (int threads = 1; threads <= THREADS; threads++) {
			cost = study_cost_forked(study, threads);
			if (repeat == 0 || cost.wall < best[threads].wall)
				best[threads] = cost;
		}
	for (int threads = 1; threads <= THREADS; threads++) {
		const char *name = bench_text("the same with n = 20, %d thread%s", threads, threads > 1 ? "s" : "");
		bench_print((struct bench_row){.what = bench_text("%s: wall", name),
		                               .value = best[threads].wall,
		                               .unit = "s",
		                               .ratio = best[1].wall / best[threads].wall,
		                               .to = "times as fast as one thread"});
		bench_print((struct bench_row){.what = bench_text("%s: CPU", name),
		                               .value = best[threads].cpu,
		                               .unit = "s",
		                               .ratio = best[threads].cpu / best[1].cpu,
		                               .to = "of one thread's"});
	}
	study_free(study);
}

/* ---- responses ---- */

static const char response[] =
    "{\"kind\": \"response\", \"scene\": {\"oscillators\": [{\"frequency_hz\": 2}, {\"frequency_hz\": 3.1}], "
    "\"excitation\": {\"type\": \"kanai_tajimi\", \"frequency_hz\": 2.5, \"cycles\": 50, \"signals\": "
    "2000}}}";

static const char sensitivity[] =
    "{\"kind\": \"sensitivity\", \"scene\": {\"oscillators\": [{\"frequency_hz\": 2}, {\"frequency_hz\": "
    "3.1}], "
    "\"excitation\": {\"type\": \"kanai_tajimi\", \"frequency_hz\": 2.5, \"cycles\": 50}}, "
    "\"inputs\": [{\"path\": \"/contact/restitution\", \"distribution\": {\"type\": \"uniform\", \"min\": "
    "0.6499, \"max\": "
    "0.6501}}], \"design\": {\"rows\": 700, \"signals\": \"independent\"}}";

/* a study and its number of runs with pounding */
struct document {
	const char *text;
	int64_t runs;
};

static void document_run(void *of)
{
	struct document *document = of;
	struct pound_study *study = bench_study(document->text);
	document->runs = study_cost(study, 1).runs;
	study_free(study);
}

/* A response study of many signals against a sensitivity study of the same scene, which records two outputs of a run. */
void bench_responses(void)
{
	struct document documents[] = {{response, 0}, {sensitivity, 0}};
	struct bench_job jobs[] = {{document_run, &documents[0], 0}, {document_run, &documents[1], 0}};
	bench_jobs(jobs, 2, REPEATS);
	const double whole = jobs[0].seconds / (double)documents[0].runs,
	             part = jobs[1].seconds / (double)documents[1].runs;
	bench_print((struct bench_row){.what = "response study of 2000 signals of 20 s: a run with all it needs",
	                               .value = 1e6 * whole,
	                               .unit = "us",
	                               .ratio = whole / part,
	                               .to = "a run of a sensitivity study",
	                               .goal = "at most 2",
	                               .met = whole / part <= 2});
}

/* ---- growth of the cost ---- */

struct growth {
	const char *what;
	int rows, signals;
	double cycles; /* duration of the excitation */
};

static void growth_run(void *of)
{
	const struct growth *growth = of;
	struct pound_study *study = bench_study(example_text("paper_linear"));
	study->design.rows = growth->rows;
	study->scene.excitation.signals = growth->signals;
	study->scene.excitation.cycles = growth->cycles;
	study_cost(study, 1);
	study_free(study);
}

/* The paper's study of linear oscillators, with n, the duration and the number of signals doubled twice. */
void bench_growth(void)
{
	struct growth growths[] = {
	    {"n = 100, T f_e = 20, 5 signals", 100, 5, 20},
	    {"n = 200", 200, 5, 20},
	    {"n = 400", 400, 5, 20},
	    {"T f_e = 40", 100, 5, 40},
	    {"T f_e = 80", 100, 5, 80},
	    {"10 signals", 100, 10, 20},
	    {"20 signals", 100, 20, 20},
	};
	enum { GROWTHS = sizeof growths / sizeof growths[0] };
	struct bench_job jobs[GROWTHS];
	for (int j = 0; j < GROWTHS; j++)
		jobs[j] = (struct bench_job){.run = growth_run, .of = &growths[j]};
	bench_jobs(jobs, GROWTHS, REPEATS);
	for (int j = 0; j < GROWTHS; j++) {
		// the doubled studies follow in pairs after the first
		const struct bench_job *half = &jobs[j == 0 ? 0 : j % 2 ? 0 : j - 1];
		double ratio = jobs[j].seconds / half->seconds;
		bench_print((struct bench_row){.what = bench_text("study of linear oscillators, %s", growths[j].what),
		                               .value = jobs[j].seconds,
		                               .unit = "s",
		                               .ratio = j == 0 ? 0 : ratio,
		                               .to = "times half of it",
		                               .goal = j == 0 ? NULL : "2, at most 2.2",
		                               .met = ratio <= 2.2});
	}
}
