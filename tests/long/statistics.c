/* statistics.c - quality of the indices: errors, coverage and bias over many designs of functions with exact indices.
 *
 *   statistics [SEEDS [TABLE]]      TABLE: designs, named, noise, growth, tails, signals or given; default: all
 *
 * 1. A job is one function in one setting; its seeds are computed one after another, so the numbers do not depend on
 *    the number of threads.
 * 2. Functions are run as external models: pound_run_create, outputs assigned, reduced.
 * 3. Progress goes to stderr, Markdown tables to stdout. */
#include "tests/long/statistics.h"

#include <math.h>
#include <pthread.h>
#include <stdatomic.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

enum { D = FUNCTION_INPUTS, THREADS_MAX = 64 };

void *statistics_sure(void *memory)
{
	if (!memory) {
		fprintf(stderr, "statistics: out of memory\n");
		exit(1);
	}
	return memory;
}

/* ---- functions ---- */

const struct function *statistics_function(int k)
{
	const struct function *f = functions;
	for (; f->name && k > 0; k--)
		f++;
	if (!f->name)
		f = statistics_functions + k;
	return f->name ? f : NULL;
}

struct pound_design statistics_design(int method, int rows, uint64_t seed)
{
	int power = 1;
	while (4 * power < 3 * rows)
		power *= 2;
	bool nets = strcmp(pound_design_name(method), "sobol") == 0;
	return (struct pound_design){.method = method, .rows = nets ? power : rows, .seed = seed};
}

struct pound_study statistics_study(const struct pound_design *design)
{
#define UNIFORM                                       \
	{                                                 \
		.distribution = {.type = 0, .p = {0.0, 1.0} } \
	}
	static struct pound_input inputs[D] = {UNIFORM, UNIFORM, UNIFORM, UNIFORM};
	static char name[] = "y";
	static char *names[] = {name};
	return (struct pound_study){.kind = POUND_KIND_SENSITIVITY,
	                            .elsewhere = true,
	                            .n_inputs = D,
	                            .inputs = inputs,
	                            .design = *design,
	                            .n_outputs = 1,
	                            .output_names = names};
}

void statistics_assign(struct pound_run *run, const struct function *f, int first, double *y)
{
	const int n_samples = pound_run_samples(run);
	for (int i = first; i < pound_run_rows(run); i++)
		for (int p = 0; p < n_samples; p++) {
			double u[D];
			pound_run_sample_inputs(run, i, p, u);
			double value = f->y(u);
			pound_run_sample_assign(run, i, p, 0, value, NAN);
			if (y)
				y[(size_t)i * (size_t)n_samples + (size_t)p] = value;
		}
}

/* ---- scores ---- */

void statistics_score_values(struct statistics_score *score, const struct function *f, const double *value)
{
	score->n++;
	for (int k = 0; k < STATISTICS_INDEXES; k++) {
		double error = value[k] - f->index[k];
		score->bias[k] += error;
		score->square[k] += error * error;
	}
}

void statistics_score_indices(struct statistics_score *score, const struct function *f,
                              const struct pound_indices *indices, enum pound_index first,
                              enum pound_index total)
{
	// if a polynomial equals the function, error and interval are rounding errors
	const double rounding = 1e-12;
	double value[STATISTICS_INDEXES];
	for (int k = 0; k < STATISTICS_INDEXES; k++) {
		const struct pound_estimate *e = &indices->index[k < D ? first : total][k % D];
		value[k] = e->value;
		score->covered[k] += e->low - rounding <= f->index[k] && f->index[k] <= e->high + rounding;
	}
	statistics_score_values(score, f, value);
}

static int from(int total)
{
	return total == 1 ? D : 0;
}

static int to(int total)
{
	return total == 0 ? D : STATISTICS_INDEXES;
}

double statistics_error(const struct statistics_score *score, int total)
{
	double sum = 0.0;
	for (int k = from(total); k < to(total); k++)
		sum += score->square[k] / score->n;
	return sqrt(sum / (to(total) - from(total)));
}

double statistics_coverage(const struct statistics_score *score, int total)
{
	double sum = 0.0;
	for (int k = from(total); k < to(total); k++)
		sum += score->covered[k] / score->n;
	return sum / (to(total) - from(total));
}

double statistics_bias(const struct statistics_score *score, int total)
{
	double largest = 0.0;
	for (int k = from(total); k < to(total); k++)
		if (fabs(score->bias[k] / score->n) > fabs(largest))
			largest = score->bias[k] / score->n;
	return largest;
}

/* ---- jobs ---- */

struct jobs {
	int n;
	void (*job)(void *of, int k);
	void *of;
	atomic_int next, done;
};

static void *work(void *argument)
{
	struct jobs *jobs = argument;
	for (int k; (k = atomic_fetch_add(&jobs->next, 1)) < jobs->n;) {
		jobs->job(jobs->of, k);
		int done = atomic_fetch_add(&jobs->done, 1) + 1;
		if (isatty(STDERR_FILENO))
			fprintf(stderr, "\r%d of %d%s", done, jobs->n, done < jobs->n ? "" : "\r\033[K");
	}
	return NULL;
}

void statistics_jobs(int n, void (*job)(void *of, int k), void *of)
{
	struct jobs jobs = {.n = n, .job = job, .of = of};
	pthread_t threads[THREADS_MAX];
	int n_threads = (int)sysconf(_SC_NPROCESSORS_ONLN);
	n_threads = n_threads > THREADS_MAX ? THREADS_MAX : n_threads;
	for (int t = 0; t < n_threads; t++)
		if (pthread_create(&threads[t], NULL, work, &jobs)) {
			fprintf(stderr, "statistics: no thread\n");
			exit(1);
		}
	for (int t = 0; t < n_threads; t++)
		pthread_join(threads[t], NULL);
}

/* ---- tables ---- */

static const struct {
	const char *name;
	void (*print)(int n_seeds);
} tables[] = {
    {"designs", statistics_designs}, {"named", statistics_named}, {"noise", statistics_noise},
    {"growth", statistics_growth},   {"tails", statistics_tails}, {"signals", statistics_signals},
    {"given", statistics_given},
};

int main(int argc, char **argv)
{
	int n_seeds = argc > 1 ? atoi(argv[1]) : 200;
	for (size_t k = 0; k < sizeof tables / sizeof tables[0]; k++)
		if (argc < 3 || strcmp(argv[2], tables[k].name) == 0) {
			fprintf(stderr, "%s\n", tables[k].name);
			tables[k].print(n_seeds);
			fflush(stdout);
		}
	return 0;
}
