/* Counters as the text format 0.0.4 of Prometheus has them. */
#include "server/metrics.h"

#include <stdio.h>
#include <string.h>
#include <time.h>
#include <unistd.h>

#include "engine/pound.h"
#include "schema/writer.h"

static const double bounds[METRICS_BUCKETS] = {0.001, 0.005, 0.02, 0.1, 0.5, 2.5, 10}; /* [s] */

void metrics_answered(struct metrics *metrics, int operation, int status, double seconds)
{
	int bucket = 0;
	while (bucket < METRICS_BUCKETS && seconds > bounds[bucket])
		bucket++;
	atomic_fetch_add(&metrics->answers[operation < 0 ? API_N_OPERATIONS : operation][status], 1);
	atomic_fetch_add(&metrics->buckets[bucket], 1);
	atomic_fetch_add(&metrics->microseconds, (unsigned long)(1e6 * seconds));
}

static void head(struct writer *w, const char *name, const char *type, const char *text)
{
	char line[256];
	writer_raw(w, line,
	           (size_t)snprintf(line, sizeof line, "# HELP %s %s\n# TYPE %s %s\n", name, text, name, type));
}

static void sample(struct writer *w, const char *name, const char *labels, double value)
{
	char line[256], digits[WRITER_NUMBER_SIZE];
	writer_digits(value, digits);
	const char *open = labels ? "{" : "", *close = labels ? "}" : "";
	writer_raw(w, line,
	           (size_t)snprintf(line, sizeof line, "%s%s%s%s %s\n", name, open, labels ? labels : "", close,
	                            digits));
}

static void answers(struct writer *w, const struct metrics *metrics)
{
	static const struct api_operation none = {.method = "", .path = ""};
	static const char name[] = "pound_http_requests_total";
	head(w, name, "counter", "Requests answered, by method, path and status.");
	for (int o = 0; o < METRICS_OPERATIONS; o++)
		for (int status = 0; status < METRICS_STATUSES; status++) {
			unsigned long n = metrics->answers[o][status];
			const struct api_operation *operation = o < API_N_OPERATIONS ? &api_operations[o] : &none;
			char labels[128];
			snprintf(labels, sizeof labels, "method=\"%s\",path=\"%s\",code=\"%d\"", operation->method,
			         operation->path, status);
			if (n > 0)
				sample(w, name, labels, (double)n);
		}
}

static void durations(struct writer *w, const struct metrics *metrics)
{
	unsigned long sum = 0;
	head(w, "pound_http_request_duration_seconds", "histogram",
	     "Time from a request's headers to its answer.");
	for (int b = 0; b <= METRICS_BUCKETS; b++) {
		char label[48];
		sum += metrics->buckets[b];
		if (b < METRICS_BUCKETS)
			snprintf(label, sizeof label, "le=\"%g\"", bounds[b]);
		else
			strcpy(label, "le=\"+Inf\"");
		sample(w, "pound_http_request_duration_seconds_bucket", label, (double)sum);
	}
	sample(w, "pound_http_request_duration_seconds_sum", NULL, 1e-6 * (double)metrics->microseconds);
	sample(w, "pound_http_request_duration_seconds_count", NULL, (double)sum);
}

static void value(struct writer *w, const struct metrics_value *of)
{
	if (of->text)
		head(w, of->name, of->type, of->text);
	sample(w, of->name, of->label, of->value);
}

/* What every program tells. */
static void process(struct writer *w)
{
	struct timespec cpu;
	long pages = 0;
	FILE *file = fopen("/proc/self/statm", "re");
	if (file && fscanf(file, "%*d %ld", &pages) != 1)
		pages = 0;
	if (file)
		fclose(file);
	clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &cpu);
	const struct metrics_value values[] = {
	    {"process_cpu_seconds_total", "counter", NULL, "Processor time.",
	     (double)cpu.tv_sec + 1e-9 * (double)cpu.tv_nsec},
	    {"process_resident_memory_bytes", "gauge", NULL, "Resident memory.",
	     (double)pages * (double)sysconf(_SC_PAGESIZE)},
	    {"pound_build_info", "gauge", "version=\"" POUND_VERSION "\"", "Which poundd this is.", 1},
	};
	for (size_t i = 0; i < sizeof values / sizeof values[0]; i++)
		value(w, &values[i]);
}

/* The text that Prometheus reads.
 *
 * Given    values   (n)   those of one name stand together
 * Returns  value    (length) bytes; NULL: out of memory
 * Memory   allocates; the caller frees
 *
 * Source   Prometheus, Exposition formats, text format 0.0.4
 * Test     service_metrics: the_text_keeps_the_rules_of_prometheus
 */
char *metrics_text(const struct metrics *metrics, const struct metrics_value *values, int n, size_t *length)
{
	struct writer w;
	writer_init(&w);
	answers(&w, metrics);
	durations(&w, metrics);
	for (int i = 0; i < n; i++)
		value(&w, &values[i]);
	process(&w);
	return writer_take(&w, length);
}
