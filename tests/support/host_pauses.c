#include "tests/support/host_pauses.h"

#include <math.h>
#include <pthread.h>
#include <sched.h>
#include <stdatomic.h>
#include <time.h>
#include <unistd.h>

#include "tests/support/check.h"
#include "tests/support/latency.h"

enum {
	PERIOD_NS = 2000000,
	GAPS_MAX = 200000,
	PROCESSORS_MAX = 64,
};
#define LATE_S 0.002 /* [s] a later wake-up is attributed to a pause of the host, not to the scheduler */

struct gap {
	double start, end; /* [s] of the wall clock */
};

static struct sentinel {
	pthread_t thread;
	int processor, n;
	double sum; /* [s] */
	struct gap *gaps;
} sentinels[PROCESSORS_MAX];

static int n_sentinels;
static atomic_bool stopping;
static double started, stopped; /* [s] of the wall clock */

static void *watch(void *of)
{
	struct sentinel *sentinel = of;
	cpu_set_t mine;
	CPU_ZERO(&mine);
	CPU_SET(sentinel->processor, &mine);
	pthread_setaffinity_np(pthread_self(), sizeof mine, &mine);
	pthread_setschedparam(pthread_self(), SCHED_FIFO, &(struct sched_param){.sched_priority = 1});
	for (double before = latency_now(); !stopping;) {
		nanosleep(&(struct timespec){.tv_nsec = PERIOD_NS}, NULL);
		double now = latency_now(), due = before + 1e-9 * PERIOD_NS;
		if (now - due > LATE_S && sentinel->n < GAPS_MAX) {
			sentinel->gaps[sentinel->n++] = (struct gap){before, now};
			sentinel->sum += now - due;
		}
		before = now;
	}
	return NULL;
}

void host_pauses_start(void)
{
	cpu_set_t allowed;
	assert_int_equal(sched_getaffinity(0, sizeof allowed, &allowed), 0);
	stopping = false;
	n_sentinels = 0;
	started = latency_now();
	for (int p = 0; p < CPU_SETSIZE && n_sentinels < PROCESSORS_MAX; p++)
		if (CPU_ISSET(p, &allowed)) {
			struct sentinel *sentinel = &sentinels[n_sentinels++];
			*sentinel = (struct sentinel){.processor = p, .gaps = calloc(GAPS_MAX, sizeof(struct gap))};
			assert_non_null(sentinel->gaps);
			assert_int_equal(pthread_create(&sentinel->thread, NULL, watch, sentinel), 0);
		}
}

void host_pauses_stop(void)
{
	stopping = true;
	for (int s = 0; s < n_sentinels; s++)
		pthread_join(sentinels[s].thread, NULL);
	stopped = latency_now();
}

bool host_pauses_between(double from, double to)
{
	for (int s = 0; s < n_sentinels; s++) {
		const struct sentinel *sentinel = &sentinels[s];
		// binary search for the first gap that ends late enough: gaps are in temporal order
		int low = 0, high = sentinel->n;
		while (low < high) {
			int middle = (low + high) / 2;
			const struct gap *gap = &sentinel->gaps[middle];
			if (2 * gap->end - gap->start < from)
				low = middle + 1;
			else
				high = middle;
		}
		if (low < sentinel->n && sentinel->gaps[low].start <= to)
			return true;
	}
	return false;
}

double host_pauses_share(void)
{
	double sum = 0;
	for (int s = 0; s < n_sentinels; s++)
		sum += sentinels[s].sum;
	return sum / (stopped - started) / n_sentinels;
}
