#include "tests/support/latency.h"

#include <math.h>
#include <time.h>

#include "tests/support/check.h"
#include "tests/support/host_pauses.h"

double latency_now(void)
{
	struct timespec time;
	clock_gettime(CLOCK_REALTIME, &time);
	return (double)time.tv_sec + 1e-9 * (double)time.tv_nsec;
}

double latency_soak_s(void)
{
	return atof(getenv("SOAK") ? getenv("SOAK") : "60");
}

static int ascending(const void *a, const void *b)
{
	const struct latency_answer *one = a, *other = b;
	double x = one->came - one->asked, y = other->came - other->asked;
	return (x > y) - (x < y);
}

void latency_add(struct latencies *l, double asked, double came)
{
	if (l->n == l->room) {
		l->room = 2 * l->room + 1000;
		l->answers = realloc(l->answers, (size_t)l->room * sizeof l->answers[0]);
		assert_non_null(l->answers);
	}
	l->answers[l->n++] = (struct latency_answer){asked, came};
}

double latency_quantile(struct latencies *l, double part)
{
	if (l->n == 0)
		return 0;
	qsort(l->answers, (size_t)l->n, sizeof l->answers[0], ascending);
	const struct latency_answer *answer = &l->answers[(int)fmin(part * l->n, l->n - 1)];
	return 1e3 * (answer->came - answer->asked);
}

void latency_report(const char *what, struct latencies *l)
{
	check_report("%s: %d, p50 %.2f ms, p99 %.2f ms, most %.1f ms", what, l->n, latency_quantile(l, 0.5),
	             latency_quantile(l, 0.99), latency_quantile(l, 1));
}

void latency_there(struct latencies *l)
{
	int n = 0;
	for (int i = 0; i < l->n; i++)
		if (!host_pauses_between(l->answers[i].asked, l->answers[i].came))
			l->answers[n++] = l->answers[i];
	l->n = n;
}
