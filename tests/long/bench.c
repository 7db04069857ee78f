/* bench.c - speed of the engine, as one Markdown table.
 *
 *   bench [ROWS [PART]]     ROWS of the paper campaign's design, default 1000, fewer for a trial; PART: one group of rows
 *
 * Times are CPU time, the least of several runs; compared jobs run in rotation.  A missed goal is reported and is no
 * error. */
#include "tests/long/bench.h"

#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "engine/exact/task.h"
#include "schema/json/problems.h"
#include "schema/study/study_json.h"

double bench_seconds(clockid_t clock)
{
	struct timespec time;
	clock_gettime(clock, &time);
	return (double)time.tv_sec + 1e-9 * (double)time.tv_nsec;
}

void bench_jobs(struct bench_job *jobs, int n, int repeats)
{
	for (int repeat = 0; repeat < repeats; repeat++)
		for (int j = 0; j < n; j++) {
			double start = bench_seconds(CLOCK_PROCESS_CPUTIME_ID);
			jobs[j].run(jobs[j].of);
			double seconds = bench_seconds(CLOCK_PROCESS_CPUTIME_ID) - start;
			jobs[j].seconds = repeat == 0 || seconds < jobs[j].seconds ? seconds : jobs[j].seconds;
		}
}

_Noreturn void bench_fail(const char *why)
{
	fprintf(stderr, "bench: %s\n", why);
	exit(1);
}

struct pound_study *bench_study(const char *document)
{
	struct problems problems;
	struct pound_study *study = study_from_json(document, strlen(document), &problems);
	if (!study)
		bench_fail(problems.list[0].detail);
	return study;
}

void *bench_memory(size_t bytes)
{
	size_t whole = (bytes / 64 + 1) * 64;
	void *memory = aligned_alloc(64, whole);
	if (!memory)
		bench_fail("out of memory");
	return memset(memory, 0, whole);
}

/* ---- the table ---- */

const char *bench_text(const char *format, ...)
{
	static char texts[16][128];
	static int next;
	char *text = texts[next++ % 16];
	va_list arguments;
	va_start(arguments, format);
	vsnprintf(text, sizeof texts[0], format, arguments);
	va_end(arguments);
	return text;
}

void bench_print(struct bench_row row)
{
	printf("| %s | ", row.what);
	if (row.value > 0)
		printf(row.value >= 1000 ? "%.0f" : "%.3g", row.value);
	if (row.unit)
		printf(" %s", row.unit);
	printf(" | ");
	if (row.ratio > 0)
		printf("%.3g", row.ratio);
	if (row.ratio > 0 && row.to)
		printf(" %s", row.to);
	printf(" | ");
	if (row.error > 0)
		printf("%.1e", row.error);
	printf(" | ");
	if (row.goal)
		printf("%s: %s", row.goal, row.met ? "yes" : "no");
	printf(" |\n");
	fflush(stdout);
}

static int lanes_widest(void)
{
	static const int widths[] = {8, 4, 1};
	void *scratch = bench_memory(POUND_EXACT_SCRATCH);
	int widest = 0;
	for (int w = 0; w < 3 && widest == 0; w++)
		widest = pound_exact_lanes(widths[w], NULL, NULL, 0, scratch, NULL) ? widths[w] : 0;
	free(scratch);
	return widest;
}

/* The machine of the measurement. */
static void head(void)
{
	char line[256], processor[256] = "unknown processor", date[32];
	FILE *file = fopen("/proc/cpuinfo", "r");
	while (file && fgets(line, sizeof line, file))
		if (sscanf(line, "model name : %255[^\n]", processor) == 1)
			break;
	if (file)
		fclose(file);
	time_t now = time(NULL);
	strftime(date, sizeof date, "%Y-%m-%d", gmtime(&now));
	double load = 0;
	getloadavg(&load, 1);
	printf("%s, %d lanes, %s %s, %s, load %.1f at the start.\n\n", processor, lanes_widest(),
#ifdef __clang__
	       "clang", __clang_version__,
#else
	       "gcc", __VERSION__,
#endif
	       date, load);
	printf("| what | measured | ratio | error | goal |\n| --- | --- | --- | --- | --- |\n");
}

static int campaign_rows = 1000;

static void campaign(void)
{
	bench_campaign(campaign_rows);
}

/* the groups of rows, in the order of the table */
static const struct {
	const char *name;
	void (*run)(void);
} PARTS[] = {
    {"campaign", campaign}, // first, while this process is small: the peak memory of its children includes its own
    {"reference", bench_reference}, {"kernel", bench_kernel},         {"chains", bench_chains},
    {"responses", bench_responses}, {"growth", bench_growth},         {"indices", bench_indices},
    {"spectra", bench_spectra},     {"separation", bench_separation}, {"outputs", bench_outputs},
};

enum { N_PARTS = sizeof PARTS / sizeof PARTS[0] };

static int usage(void)
{
	fprintf(stderr, "usage: bench [ROWS [PART]], PART one of:");
	for (int i = 0; i < N_PARTS; i++)
		fprintf(stderr, " %s", PARTS[i].name);
	fprintf(stderr, "\n");
	return 2;
}

int main(int argc, char **argv)
{
	const char *only = argc > 2 ? argv[2] : NULL;
	bool known = !only;
	for (int i = 0; i < N_PARTS && !known; i++)
		known = !strcmp(only, PARTS[i].name);
	campaign_rows = argc > 1 ? atoi(argv[1]) : campaign_rows;
	if (campaign_rows < 2 || !known)
		return usage();
	head();
	for (int i = 0; i < N_PARTS; i++)
		if (!only || !strcmp(only, PARTS[i].name))
			PARTS[i].run();
	return 0;
}
