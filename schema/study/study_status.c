/* study_status.c - the object Status of the OpenAPI document. */
#include "schema/study/study_status.h"

#include <inttypes.h>
#include <math.h>
#include <stdio.h>
#include <string.h>
#include <time.h>

/* Rounds down to four decimals, so that a fraction is 1 only if it is complete; printing 17 digits takes longer than the rest of
 * the object. */
static double rounded(double value)
{
	return floor(1e4 * value) / 1e4;
}

/* CPU time over the estimate from which the status reports "over_estimate". */
static const double OVER = 3;

/* Latest start from now, ten years: years must have four digits. */
static const double START_MAX_S = 3.2e8;

bool study_status_over(double cpu_s, double cpu_s_estimated)
{
	return cpu_s_estimated > 0 && cpu_s >= OVER * cpu_s_estimated;
}

/* Remaining time, if the remaining runs take as long as the finished ones. */
double study_status_eta(const struct study_status *study, int n_workers)
{
	if (strcmp(study->status, "running") != 0 || study->runs_done == 0)
		return NAN;
	return study->cpu_s / (double)study->runs_done * (double)(study->runs - study->runs_done) / n_workers;
}

/* Expected start of a queued study, from the estimates of the studies before it: RFC 3339, UTC. */
static void start_text(const struct study_status *study, int n_workers, char text[static 32])
{
	const time_t start = time(NULL) + (time_t)fmin(ceil(study->cpu_s_before / n_workers), START_MAX_S);
	struct tm utc;
	strftime(text, 32, "%Y-%m-%dT%H:%M:%SZ", gmtime_r(&start, &utc));
}

/* Writes the object Status.
 *
 * Test     service_routes: a_finished_study_has_times_in_order_and_all_runs_done;
 *          service_queue: a_queued_study_has_its_place_in_the_queue
 */
void study_status_write(struct writer *w, const struct study_status *study, int n_workers)
{
	static const char *const links[][2] = {{"self", ""},
	                                       {"request", "/request"},
	                                       {"results", "/results"},
	                                       {"samples", "/samples"},
	                                       {"cancel", "/cancel"}};
	char id[17], link[64], start[32];
	start_text(study, n_workers, start);
	snprintf(id, sizeof id, "%016" PRIx64, (uint64_t)study->id);
	writer_object(w, NULL, WRITER_LINES);
	writer_text(w, "id", id);
	writer_text(w, "name", study->name);
	writer_text(w, "kind", study->kind);
	writer_text(w, "status", study->status);
	writer_number(w, "progress", rounded((double)study->runs_done / (double)study->runs));
	writer_whole(w, "runs_done", study->runs_done);
	writer_whole(w, "runs_total", study->runs);
	writer_number(w, "eta_s", rounded(study_status_eta(study, n_workers)));
	writer_number(w, "cpu_s", rounded(study->cpu_s));
	writer_number(w, "estimated_cpu_s", study->cpu_s_estimated > 0 ? rounded(study->cpu_s_estimated) : NAN);
	writer_bool(w, "over_estimate", study_status_over(study->cpu_s, study->cpu_s_estimated));
	writer_number(w, "queue_position", study->queue_position ? (double)study->queue_position : NAN);
	writer_text(w, "expected_start", study->queue_position ? start : NULL);
	writer_text(w, "created", study->created);
	writer_text(w, "started", study->started);
	writer_text(w, "finished", study->finished);
	writer_text(w, "error", study->error);
	writer_object(w, "links", WRITER_LINE);
	for (size_t i = 0; i < sizeof links / sizeof links[0]; i++) {
		snprintf(link, sizeof link, "/v1/studies/%s%s", id, links[i][1]);
		writer_text(w, links[i][0], link);
	}
	writer_end(w);
	writer_end(w);
}
