/* Counters in Prometheus text format 0.0.4. */
#include "server/metrics.h"

#include <stdio.h>
#include <time.h>
#include <unistd.h>

#include "engine/pound.h"
#include "schema/json/json_writer.h"
#include "server/http.h"
#include "server/store.h"
#include "server/workers.h"

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
	int n = snprintf(line, sizeof line, "# HELP %s %s\n# TYPE %s %s\n", name, text, name, type);
	writer_raw(w, line, (size_t)n);
}

/* labels: `{status="queued"}`, "": none */
static void sample(struct writer *w, const char *name, const char *labels, double value)
{
	char line[256], digits[WRITER_NUMBER_SIZE];
	writer_digits(value, digits);
	writer_raw(w, line, (size_t)snprintf(line, sizeof line, "%s%s %s\n", name, labels, digits));
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
			snprintf(labels, sizeof labels, "{method=\"%s\",path=\"%s\",code=\"%d\"}", operation->method,
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
		char label[48] = "{le=\"+Inf\"}";
		sum += metrics->buckets[b];
		if (b < METRICS_BUCKETS)
			snprintf(label, sizeof label, "{le=\"%g\"}", bounds[b]);
		sample(w, "pound_http_request_duration_seconds_bucket", label, (double)sum);
	}
	sample(w, "pound_http_request_duration_seconds_sum", "", 1e-6 * (double)metrics->microseconds);
	sample(w, "pound_http_request_duration_seconds_count", "", (double)sum);
}

/* Leaves out a status whose studies cannot be counted. */
static void studies(struct writer *w, struct store *store)
{
	static const char *const states[] = {"queued", "running", "succeeded", "failed", "cancelled"};
	head(w, "pound_studies", "gauge", "Studies, by status.");
	for (size_t i = 0; i < sizeof states / sizeof states[0]; i++) {
		int64_t n;
		char label[32];
		snprintf(label, sizeof label, "{status=\"%s\"}", states[i]);
		if (store_count(store, states[i], &n) == STORE_OK)
			sample(w, "pound_studies", label, (double)n);
	}
}

static double resident_bytes(void)
{
	long pages = 0;
	FILE *file = fopen("/proc/self/statm", "re");
	if (file && fscanf(file, "%*d %ld", &pages) != 1)
		pages = 0;
	if (file)
		fclose(file);
	return (double)pages * (double)sysconf(_SC_PAGESIZE);
}

/* The text that Prometheus reads.
 *
 * Returns  value    (length) bytes; NULL: out of memory
 * Memory   allocates; the caller frees
 *
 * Source   Prometheus, Exposition formats, text format 0.0.4
 * Test     service_metrics: the_text_keeps_the_rules_of_prometheus
 */
char *metrics_text(const struct server *server, size_t *length)
{
	struct timespec cpu;
	clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &cpu);
	const struct {
		const char *name, *type, *labels, *text;
		double value;
	} values[] = {
	    {"pound_http_connections", "gauge", "", "Open connections.", server->connections.n},
	    {"pound_http_connections_late_total", "counter", "", "Connections closed for being too slow.",
	     server->connections.n_late},
	    {"pound_http_waiting", "gauge", "", "Requests that wait for a study to change.",
	     server->connections.n_waiting},
	    {"pound_worker_groups", "gauge", "", "Worker groups that are connected.", work_groups(server->work)},
	    {"pound_worker_blocks_total", "counter", "", "Blocks that worker groups have run.",
	     (double)work_group_blocks(server->work)},
	    {"pound_partial_values_total", "counter", "",
	     "Outputs of samples from which requests have made partial results.",
	     (double)server->partial_maker.values},
	    {"process_cpu_seconds_total", "counter", "", "Processor time.",
	     (double)cpu.tv_sec + 1e-9 * (double)cpu.tv_nsec},
	    {"process_resident_memory_bytes", "gauge", "", "Resident memory.", resident_bytes()},
	    {"pound_build_info", "gauge", "{version=\"" POUND_VERSION "\"}", "Version of poundd.", 1},
	};
	struct writer w;
	writer_init(&w);
	answers(&w, &server->metrics);
	durations(&w, &server->metrics);
	studies(&w, server->store);
	for (size_t i = 0; i < sizeof values / sizeof values[0]; i++) {
		head(&w, values[i].name, values[i].type, values[i].text);
		sample(&w, values[i].name, values[i].labels, values[i].value);
	}
	return writer_take(&w, length);
}
