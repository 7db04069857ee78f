#include "tests/long/paper_campaign.h"

#include <assert.h>
#include <math.h>
#include <pthread.h>
#include <stdatomic.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "schema/examples/examples.h"
#include "schema/json/problems.h"
#include "schema/study/study_json.h"

enum { THREADS_MAX = 64, MATRICES = 2 }; /* samples A and B of a row are independent of each other */

static void fail(const char *text)
{
	fprintf(stderr, "paper: %s\n", text);
	exit(1);
}

/* ---- running ---- */

struct pool {
	const struct campaign_plan *plan;
	struct pound_run *run;
	enum pound_status (*step)(struct pound_run *run, int number, int worker);
	int n_steps;
	atomic_int next, worker;
};

static const char *noise_name(bool noise)
{
	return noise ? "with" : "without";
}

static void *pool_work(void *argument)
{
	struct pool *pool = argument;
	int worker = atomic_fetch_add(&pool->worker, 1);
	for (int j; (j = atomic_fetch_add(&pool->next, 1)) < pool->n_steps;) {
		enum pound_status status = pool->step(pool->run, j, worker);
		if (status)
			fail(pound_status_text(status));
		int tenth = 10 * (j + 1) / pool->n_steps;
		if (pool->step == pound_run_block && tenth > 10 * j / pool->n_steps)
			fprintf(stderr, "f_e T = %g, %s the noise: %d %%\n", pool->plan->cycles,
			        noise_name(pool->plan->noise), 10 * tenth);
	}
	return NULL;
}

static void pool_run(struct pool *pool, int n_workers)
{
	pthread_t threads[THREADS_MAX];
	for (int j = 0; j < n_workers; j++)
		if (pthread_create(&threads[j], NULL, pool_work, pool))
			fail("no thread");
	for (int j = 0; j < n_workers; j++)
		pthread_join(threads[j], NULL);
}

/* ---- reading ---- */

// which output is the amplification depends on the law
static int column(enum effect effect, int law)
{
	return effect == IMPULSE ? 2 : law == 0 ? 0 : 1;
}

static int cell(int law, int f)
{
	return law * FREQUENCIES + f;
}

static void indices_read(const struct pound_result *result, struct campaign *into)
{
	static const enum pound_index columns[2][ORDERS] = {{POUND_S1, POUND_ST}, {POUND_S1_RAW, POUND_ST_RAW}};
	for (int effect = 0; effect < EFFECTS; effect++)
		for (int law = 0; law < LAWS; law++)
			for (int f = 0; f < FREQUENCIES; f++) {
				const struct pound_indices *x = &result->cells[cell(law, f)].indices[column(effect, law)];
				for (int order = 0; order < ORDERS; order++)
					memcpy(into->evidence.index[effect][law][f][order],
					       x->index[columns[into->plan.noise][order]],
					       INPUTS * sizeof(struct pound_estimate));
				into->noise_share[effect][law][f] = x->noise_share;
			}
}

/* Mean and standard deviation of a sample, with 95 % intervals for large samples; NAN: too few. */
enum { SAMPLE_LEAST = 10 };

struct moments {
	struct pound_estimate mean, deviation;
};

static struct pound_estimate within(double value, double half)
{
	return (struct pound_estimate){value, value - half, value + half};
}

static struct moments moments_of(const double *y, int n)
{
	const double quantile = n < SAMPLE_LEAST ? NAN : 1.959964; /* of a standard normal, 0.975 */
	double mean = 0, second = 0, fourth = 0;
	for (int i = 0; i < n; i++)
		mean += y[i] / n;
	for (int i = 0; i < n; i++) {
		double square = (y[i] - mean) * (y[i] - mean);
		second += square / n;
		fourth += square * square / n;
	}
	double deviation = sqrt(second);
	/* variance of the sample variance, and from it the error of the standard deviation */
	double error = sqrt((fourth - second * second) / n) / (2 * deviation);
	return (struct moments){within(mean, quantile * deviation / sqrt(n)),
	                        within(deviation, quantile * error)};
}

/* Moments of the impulse at f_1 = 2 Hz, relative to its mean, for f_2 at a distance from f_1 within `away`. */
static struct moments beside(struct pound_run *run, int law, const struct pound_indices *impulse,
                             const double away[2])
{
	int rows = pound_run_rows(run), n = 0;
	double *y = malloc(sizeof *y * MATRICES * (size_t)rows);
	if (!y)
		fail("out of memory");
	for (int row = 0; row < rows; row++)
		for (int sample = 0; sample < MATRICES; sample++) {
			double x[INPUTS];
			pound_run_sample_inputs(run, row, sample, x);
			double distance = fabs(x[F_2] - findings_f1[AT_2_HZ]);
			const double value =
			    pound_run_sample_output(run, cell(law, AT_2_HZ), row, sample, column(IMPULSE, law)).mean;
			if (distance >= away[0] && distance < away[1] && isfinite(value))
				y[n++] = value / impulse->mean;
		}
	struct moments moments = moments_of(y, n);
	free(y);
	return moments;
}

/* The point of a curve over eps nearest to a value. */
static struct pound_estimate at_eps(const struct pound_indices *impulse, double eps)
{
	return impulse->curves[EPS].mean[(int)(eps * POUND_CURVE)];
}

static void scatter_read(struct pound_run *run, const struct pound_result *result, struct evidence *evidence)
{
	static const double equal[2] = {0, 0.025}, aside[2] = {0.2, 0.4}; /* [Hz] */
	for (int law = 0; law < LAWS; law++) {
		const struct pound_indices *x = &result->cells[cell(law, AT_2_HZ)].indices[column(IMPULSE, law)];
		struct moments at = beside(run, law, x, equal), off = beside(run, law, x, aside);
		/* below 0.1 plastic contacts last long, and their impulse includes the force that presses the bodies together */
		struct pound_estimate low = at_eps(x, 0.2), high = at_eps(x, 0.9);
		evidence->scatter[law] =
		    (struct scatter){at.mean,
		                     off.mean,
		                     at.deviation,
		                     off.deviation,
		                     {(high.value - low.value) / x->mean, (high.low - low.high) / x->mean,
		                      (high.high - low.low) / x->mean}};
	}
}

void campaign_run(const struct campaign_plan *plan, struct campaign *campaign)
{
	const char *text = example_text("paper");
	struct problems problems = {0};
	struct pound_study *study = study_from_json(text, strlen(text), &problems);
	assert(study && study->n_inputs == INPUTS);
	study->scene.excitation.cycles = plan->cycles;
	study->design.common_signals = !plan->noise;
	study->design.rows = plan->rows;
	int cores = (int)sysconf(_SC_NPROCESSORS_ONLN), n_workers = cores > THREADS_MAX ? THREADS_MAX : cores;
	struct pound_run *run = pound_run_create(study, n_workers);
	if (!run)
		fail("out of memory");
	pool_run(&(struct pool){plan, run, pound_run_block, pound_run_blocks(run), 0, 0}, n_workers);
	pool_run(&(struct pool){plan, run, pound_run_reduce, pound_run_reductions(run), 0, 0}, n_workers);
	const struct pound_result *result = pound_run_result(run);
	assert(result->n_cells == LAWS * FREQUENCIES);
	campaign->plan = *plan;
	indices_read(result, campaign);
	scatter_read(run, result, &campaign->evidence);
	pound_run_free(run);
	study_free(study);
}
