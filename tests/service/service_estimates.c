/* Estimates of a server: CPU time, which a trial corrects; memory, compared with the memory that studies use; what
 * happens to studies above the limits. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "schema/examples/examples.h"
#include "schema/json/json_pointer.h"
#include "schema/study/cost.h"
#include "schema/study/study_json.h"
#include "tests/support/service.h"

static const double MIB = 1 << 20,
                    LEAST = 8 /* [MiB] smaller studies are not compared: the server's own pages matter */,
                    CPU_MOST = 0.5 /* [s] largest estimate of an example that is run */, FACTOR = 1.5;

/* A value of /proc/PID/status of a server [bytes]. */
static double status_bytes(const struct service *service, const char *name)
{
	char path[64], line[128];
	double kib = NAN;
	snprintf(path, sizeof path, "/proc/%d/status", (int)service->pid);
	FILE *status = fopen(path, "r");
	assert_non_null(status);
	while (fgets(line, sizeof line, status))
		if (!strncmp(line, name, strlen(name)))
			kib = strtod(line + strlen(name), NULL);
	fclose(status);
	return 1024 * kib;
}

/* Resets the peak memory of a server's process. */
static void forget_peak(const struct service *service)
{
	char path[64];
	snprintf(path, sizeof path, "/proc/%d/clear_refs", (int)service->pid);
	FILE *peak = fopen(path, "w");
	assert_non_null(peak);
	fputs("5", peak);
	fclose(peak);
}

static struct answer validate(const struct service *service, const char *study)
{
	return service_ask(service, &(struct ask){.method = "POST",
	                                          .path = "/v1/studies?validate_only=true",
	                                          .headers = {"Content-Type: application/json"},
	                                          .body = study,
	                                          .length = strlen(study)});
}

static double estimated(const struct service *service, const char *study, const char *member)
{
	struct answer answer = validate(service, study);
	if (answer.status != 200)
		fail_msg("%d %s", answer.status, answer.body);
	struct reading *cost = answer_read(&answer);
	const double value = reading_number(cost, "/%s", member);
	reading_close(cost);
	answer_free(&answer);
	return value;
}

/* Runs a study on a new server; returns the factor, >= 1, between the growth of its memory and the estimate; 1 for a
 * small study. */
static double compare(const char *name, const char *study)
{
	char id[17];
	struct service *service = service_new();
	service_start(service, 2);
	const double estimate = estimated(service, study, "estimated_memory_bytes"),
	             before = status_bytes(service, "VmRSS:");
	forget_peak(service);
	service_submit(service, study, id);
	assert_true(service_wait(service, id, "succeeded", 0));
	const double took = status_bytes(service, "VmHWM:") - before;
	service_stop(service);
	service_free(service);
	check_report("%-24s %8.1f MiB estimated, %8.1f taken: %.2f", name, estimate / MIB, took / MIB,
	             estimate / took);
	return fmax(took, estimate) < LEAST * MIB ? 1 : fmax(took / estimate, estimate / took);
}

#define SCENE(excitation)                                                           \
	"\"scene\": {\"oscillators\": [{\"frequency_hz\": 2}, {\"frequency_hz\": 3}], " \
	"\"excitation\": {" excitation "}}"
#define INPUT(path, low, high) \
	"{\"path\": \"" path "\", \"distribution\": {\"type\": \"uniform\", \"min\": " low ", \"max\": " high "}}"
#define INPUTS                                                                                      \
	"\"inputs\": [" INPUT("/contact/restitution", "0", "1") ", " INPUT(                             \
	    "/contact/stiffness_ratio", "50", "100") ", " INPUT("/oscillators/0/damping_ratio", "0.01", \
	                                                        "0.1") "]"

static void the_memory_of_a_study_is_estimated(void **state)
{
	static const struct {
		const char *name, *text;
	} large[] = {
	    {"100,000 rows",
	     "{\"kind\": \"sensitivity\", " SCENE(
	         "\"signals\": 1, \"cycles\": 0.1") ", " INPUTS
	                                            ", \"design\": {\"rows\": 100000, \"method\": \"random\"}}"},
	    {"4,096 rows, 20 signals",
	     "{\"kind\": \"sensitivity\", " SCENE(
	         "\"signals\": 20, \"cycles\": 0.1") ", " INPUTS
	                                             ", \"design\": {\"rows\": 4096, \"method\": \"sobol\"}}"},
	    {"100,000 signals", "{\"kind\": \"response\", " SCENE("\"signals\": 100000, \"cycles\": 0.1") "}"},
	    {"1,000,000 samples", "{\"kind\": \"response\", " SCENE(
	                              "\"type\": \"white_noise\", \"duration_s\": 10000, \"time_step_s\": 0.01, "
	                              "\"signals\": 3") "}"},
	    {"1,000 cells",
	     "{\"kind\": \"response\", " SCENE(
	         "\"signals\": 20, \"cycles\": 0.2") ", \"sweep\": [{\"path\": "
	                                             "\"/oscillators/0/frequency_hz\", \"values\": "
	                                             "[1,2,3,4,5,6,7,8,9,10]}, {\"path\": "
	                                             "\"/oscillators/1/frequency_hz\", \"values\": "
	                                             "[1,2,3,4,5,6,7,8,9,10]}, {\"path\": "
	                                             "\"/contact/restitution\", \"values\": "
	                                             "[0,0.1,0.2,0.3,0.4,0.5,0.6,0.7,0.8,0.9]}]}"},
	    {"10,000 frequencies",
	     "{\"kind\": \"floor_spectrum\", " SCENE(
	         "\"signals\": 40, \"cycles\": 1") ", \"spectrum\": {\"frequencies_hz\": {\"count\": 10000}}}"},
	};
	static struct problems problems;
	double most = 1;
	(void)state;
	for (size_t i = 0; i < sizeof large / sizeof large[0]; i++)
		most = fmax(most, compare(large[i].name, large[i].text));
	struct service *service = service_new();
	service_start(service, 1);
	for (int i = 0; examples[i].name; i++) {
		struct pound_study *whole = study_from_json(examples[i].text, strlen(examples[i].text), &problems);
		if (!whole) // a design only
			continue;
		study_free(whole);
		if (estimated(service, examples[i].text, "estimated_cpu_s") < CPU_MOST)
			most = fmax(most, compare(examples[i].name, examples[i].text));
	}
	service_stop(service);
	service_free(service);
	check_report("estimates of memory are off by a factor of %.2f at most, of %g MiB and more", most, LEAST);
	assert_true(most < FACTOR);
}

#define ROWS(rows)                                                                                     \
	"{\"kind\": \"sensitivity\", " SCENE("\"signals\": 1, \"cycles\": 2") ", " INPUTS ", \"design\": " \
	                                                                      "{\"rows\": " rows           \
	                                                                      ", \"method\": \"random\"}}"

static void a_study_too_large_for_the_memory_is_refused_with_both_numbers(void **state)
{
	static const char large[] = ROWS("60000"), small[] = ROWS("1000");
	struct service *service = service_with((const char *const[][2]){{"POUNDD_MEMORY_MAX", "48"}, {NULL}}, 2);
	(void)state;
	struct answer answer = validate(service, large);
	assert_int_equal(answer.status, 422);
	struct reading *refusal = answer_read(&answer);
	check_report("422: %s", reading_text(refusal, "/errors/0/detail"));
	assert_non_null(strstr(reading_text(refusal, "/errors/0/detail"), "--memory-max"));
	assert_true(reading_number(refusal, "/errors/0/limit") == 48);
	assert_true(reading_number(refusal, "/errors/0/requested") > 48);
	reading_close(refusal);
	answer_free(&answer);
	answer = service_post(service, large);
	assert_int_equal(answer.status, 422);
	answer_free(&answer);
	assert_true(estimated(service, small, "estimated_memory_bytes") < 48 * MIB);
	service_stop(service);
	service_free(service);
}

/* Each large study fits alone; the small one, submitted last, would fit beside the first but must not overtake the
 * second. */
static void two_studies_that_do_not_fit_together_run_one_after_the_other(void **state)
{
	static const char large[] = ROWS("40000"), small[] = ROWS("1000");
	struct service *service = service_with((const char *const[][2]){{"POUNDD_MEMORY_MAX", "80"}, {NULL}}, 2);
	char id[3][17];
	(void)state;
	const double estimate = estimated(service, large, "estimated_memory_bytes"),
	             before = status_bytes(service, "VmRSS:");
	assert_true(estimate > 40 * MIB && estimate < 80 * MIB);
	forget_peak(service);
	service_submit(service, large, id[0]);
	service_submit(service, large, id[1]);
	service_submit(service, small, id[2]);
	int most = 0;
	for (bool done = false; !done;
	     done = service_number(service, "SELECT count(*) = 3 FROM study WHERE status = 'succeeded'")) {
		const int running =
		    (int)service_number(service, "SELECT count(*) FROM study WHERE status = 'running'");
		const int large_running = (int)service_number(
		    service, "SELECT count(*) FROM study WHERE status = 'running' AND memory > 40000000");
		most = large_running > most ? large_running : most;
		assert_true(running <= 2);
	}
	const double took = status_bytes(service, "VmHWM:") - before;
	check_report("two studies of %.0f MiB at most 80 together: %d at a time, %.0f MiB taken", estimate / MIB,
	             most, took / MIB);
	assert_int_equal(most, 1);
	assert_true(took < FACTOR * estimate);
	// started in the order of submission
	assert_int_equal(
	    service_number(
	        service,
	        "SELECT count(*) FROM study AS a JOIN study AS b ON a.id < b.id AND a.started > b.started"),
	    0);
	service_stop(service);
	service_free(service);
}

/* Kills the server of a running study and lowers the study's stored estimate. */
static void a_study_that_takes_three_times_its_estimate_says_so(void **state)
{
	static const char study[] = ROWS("6000");
	char id[17], etag[64];
	struct service *service = service_with((const char *const[][2]){{NULL}}, 1);
	(void)state;
	service_submit(service, study, id);
	struct answer answer = service_get(service, "/v1/studies/%s", id);
	struct reading *status = answer_read(&answer);
	assert_true(reading_number(status, "/estimated_cpu_s") > 0.01);
	assert_false(reading_true(status, "/over_estimate"));
	reading_close(status);
	answer_free(&answer);
	service_kill(service);
	// the CPU time of the blocks exceeds the estimate
	service_change(service, "UPDATE study SET cpu_s_estimated = 1e-5");
	service_start(service, 1);
	assert_true(service_wait(service, id, "running", 1));
	answer = service_get(service, "/v1/studies/%s", id);
	status = answer_read(&answer);
	check_report("taken %g s, estimated %g s, over: %d", reading_number(status, "/cpu_s"),
	             reading_number(status, "/estimated_cpu_s"), reading_true(status, "/over_estimate"));
	assert_true(reading_true(status, "/over_estimate"));
	assert_non_null(strstr(answer.etag, "-over"));
	reading_close(status);
	answer_free(&answer);
	assert_true(service_wait(service, id, "succeeded", 0));
	// a study accepted by an older version has no estimate, so nothing is reported; the CPU time of a finished study
	// includes the reductions
	answer = service_get(service, "/v1/studies/%s/results", id);
	status = answer_read(&answer);
	const double all = reading_number(status, "/timing/cpu_s");
	reading_close(status);
	answer_free(&answer);
	service_stop(service);
	service_change(service, "UPDATE study SET cpu_s_estimated = 0");
	service_start(service, 1);
	answer = service_get(service, "/v1/studies/%s", id);
	status = answer_read(&answer);
	check_near(reading_number(status, "/cpu_s"), all, 1e-3);
	assert_int_equal(reading_type(status, "/estimated_cpu_s"), '0');
	assert_false(reading_true(status, "/over_estimate"));
	snprintf(etag, sizeof etag, "%s", answer.etag);
	assert_null(strstr(etag, "-over"));
	reading_close(status);
	answer_free(&answer);
	service_stop(service);
	service_free(service);
}

/* A server makes a trial of a long study: its estimate is measured on this machine and differs from the estimate by
 * counting, which a process without a trial gives. */
static void what_takes_a_while_is_tried(void **state)
{
	struct service *service = service_with((const char *const[][2]){{NULL}}, 1);
	struct problems problems;
	(void)state;
	for (int tried = 0; tried < 2; tried++) {
		char *text = service_study(tried ? 100 * SERVICE_ROWS : 2, 10, 1);
		struct pound_study *study = study_from_json(text, strlen(text), &problems);
		assert_non_null(study);
		const struct cost counted = cost_of(study, 1);
		assert_int_equal(cost_tried(&counted), tried);
		const double cpu_s = estimated(service, text, "estimated_cpu_s");
		// 1e-9: above the rounding of numbers in a document
		assert_int_equal(fabs(cpu_s / counted.cpu_s - 1) > 1e-9, tried);
		study_free(study);
		free(text);
	}
	service_stop(service);
	service_free(service);
}

CHECK_MAIN(cmocka_unit_test(what_takes_a_while_is_tried),
           cmocka_unit_test(a_study_that_takes_three_times_its_estimate_says_so),
           cmocka_unit_test(the_memory_of_a_study_is_estimated),
           cmocka_unit_test(a_study_too_large_for_the_memory_is_refused_with_both_numbers),
           cmocka_unit_test(two_studies_that_do_not_fit_together_run_one_after_the_other))
