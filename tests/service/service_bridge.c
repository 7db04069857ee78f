/* service_bridge.c - the UM-Bridge protocol 1.0: the assertions of its conformity tests, every error, and values compared
 * with `pound run`. */
#include <math.h>
#include <string.h>
#include <unistd.h>

#include "schema/examples/examples.h"
#include "schema/json/json_pointer.h"
#include "tests/support/latency.h"
#include "tests/support/program.h"
#include "tests/support/service.h"

static struct answer call(const struct service *service, const char *path, const char *body)
{
	return service_ask(service, &(struct ask){.method = "POST",
	                                          .path = path,
	                                          .headers = {"Content-Type:"}, // clients need not send it
	                                          .body = body,
	                                          .length = strlen(body)});
}

/* Fails unless a call gets an error with exactly two members: this type and a message that contains `text`. */
static void refused(const struct service *service, const char *path, const char *body, const char *type,
                    const char *text)
{
	struct answer answer = call(service, path, body);
	struct reading *r = answer_read(&answer);
	if (answer.status != (strcmp(type, "InvalidOutput") ? 400 : 500))
		fail_msg("%s %s: %d %s", path, body, answer.status, answer.body);
	assert_string_equal(answer.type, "application/json");
	assert_int_equal(reading_count(r, "%s", ""), 1);
	assert_int_equal(reading_count(r, "/error"), 2);
	assert_string_equal(reading_text(r, "/error/type"), type);
	if (!strstr(reading_text(r, "/error/message"), text))
		fail_msg("%s %s: %s", path, body, answer.body);
	reading_close(r);
	answer_free(&answer);
}

/* Fails unless a call succeeds; returns its answer. */
static struct reading *answered(const struct service *service, const char *path, const char *body)
{
	struct answer answer = call(service, path, body);
	if (answer.status != 200)
		fail_msg("%s %s: %d %s", path, body, answer.status, answer.body);
	struct reading *r = answer_read(&answer);
	assert_int_equal(reading_count(r, "%s", ""), 1);
	answer_free(&answer);
	return r;
}

static void information_has_the_members_of_the_protocol_and_no_others(void **state)
{
	static const char *const supported[] = {"Evaluate", "Gradient", "ApplyJacobian", "ApplyHessian"};
	struct service *service = *state;
	struct answer answer = service_get(service, "/Info");
	struct reading *r = answer_read(&answer);
	assert_int_equal(answer.status, 200);
	assert_int_equal(reading_count(r, "%s", ""), 2);
	assert_true(reading_number(r, "/protocolVersion") == 1.0);
	assert_non_null(strstr(answer.body, "1.0"));
	assert_int_equal(reading_count(r, "/models"), 1);
	assert_string_equal(reading_text(r, "/models/0"), "pound");
	reading_close(r);
	answer_free(&answer);
	r = answered(service, "/ModelInfo", "{\"name\": \"pound\"}");
	assert_int_equal(reading_count(r, "/support"), 4);
	for (int i = 0; i < 4; i++) {
		assert_int_equal(reading_type(r, "/support/%s", supported[i]), 'b');
		assert_int_equal(reading_true(r, "/support/%s", supported[i]), i == 0);
	}
	reading_close(r);
}

static void sizes_are_those_of_the_output_of_evaluate(void **state)
{
	struct service *service = *state;
	struct reading *inputs = answered(service, "/InputSizes", "{\"name\": \"pound\"}");
	struct reading *outputs = answered(service, "/OutputSizes", "{\"name\": \"pound\", \"config\": {}}");
	struct reading *r = answered(service, "/Evaluate",
	                             "{\"input\": [[2.5, 3.1, 1, 0.6]], \"name\": \"pound\", \"config\": {}}");
	assert_int_equal(reading_count(inputs, "/inputSizes"), 1);
	assert_true(reading_number(inputs, "/inputSizes/0") == 4);
	assert_int_equal(reading_count(outputs, "/outputSizes"), 1);
	assert_true(reading_number(outputs, "/outputSizes/0") == 2);
	assert_int_equal(reading_count(r, "/output"), 1);
	assert_int_equal(reading_count(r, "/output/0"), 2);
	for (int o = 0; o < 2; o++)
		assert_true(reading_number(r, "/output/0/%d", o) > 0);
	reading_close(r);
	reading_close(outputs);
	reading_close(inputs);
}

static void every_error_of_the_protocol_has_its_type_status_and_message(void **state)
{
	static const char *const calls[] = {"/ModelInfo", "/InputSizes",    "/OutputSizes", "/Evaluate",
	                                    "/Gradient",  "/ApplyJacobian", "/ApplyHessian"};
	static const char right[] = "\"name\": \"pound\", \"input\": [[2.5, 3.1, 1, 0.6]]";
	// a record of zeros: the ratio to a zero response is undefined; steps too long: no run has a result
	static const char still[] =
	    "{\"kind\": \"sensitivity\", \"scene\": {\"oscillators\": [{\"frequency_hz\": 50}, "
	    "{\"frequency_hz\": "
	    "2}], \"excitation\": {\"type\": \"record\", \"time_step_s\": 0.01, \"acceleration_m_s2\": [%s]}}, "
	    "\"inputs\": [{\"path\": \"/oscillators/1/mass_kg\", \"distribution\": {\"type\": \"uniform\", "
	    "\"min\": 1, \"max\": 2}}]%s}";
	struct service *service = *state;
	char body[2048], study[1024];
	for (size_t i = 0; i < sizeof calls / sizeof calls[0]; i++) {
		refused(service, calls[i], "{\"name\": \"wrong_model_name\"}", "ModelNotFound", "/name: must be");
		refused(service, calls[i], "{}", "ModelNotFound", "/name: must be");
		refused(service, calls[i], "{\"name\": \"0123456789abcdef\", \"config\": 1}", "ModelNotFound",
		        "no study 0123456789abcdef");
		refused(service, calls[i], "", "InvalidInput", "not JSON: line 1");
		if (i > 3)
			refused(service, calls[i], "{\"name\": \"pound\"}", "UnsupportedFeature", "no derivatives");
		refused(service, calls[i], "{\"name\": \"pound\", \"config\": 7}", "InvalidInput",
		        "/config: must be");
		refused(service, calls[i], "{\"name\": \"pound\", \"config\": {\"rows\": 1, \"signals\": 0}}",
		        "InvalidInput",
		        "/config/rows: unknown member; expected study, row or signals; /config/signals: must be a "
		        "whole number in [1, 100000]");
	}
	refused(service, "/Evaluate", "{\"name\": \"pound\", \"input\": [[1, 2, 3]]}", "InvalidInput",
	        "/input/0: must have 4 numbers, has 3");
	refused(service, "/Evaluate", "{\"name\": \"pound\", \"input\": [[1, 2, 3, 0.5, 0.5]]}", "InvalidInput",
	        "/input/0: must have 4 numbers, has 5");
	refused(service, "/Evaluate", "{\"name\": \"pound\", \"input\": [[1, 2], [3, 0.5]]}", "InvalidInput",
	        "/input: must have one vector");
	refused(service, "/Evaluate", "{\"name\": \"pound\", \"input\": [1, 2, 3, 0.5]}", "InvalidInput",
	        "/input: must have one vector");
	refused(service, "/Evaluate", "{\"name\": \"pound\"}", "InvalidInput", "/input: must have one vector");
	refused(service, "/Evaluate", "{\"name\": \"pound\", \"input\": [[2, -2, NaN, 0.5]]}", "InvalidInput",
	        "not JSON: line 1, column 37");
	refused(
	    service, "/Evaluate",
	    "{\"name\": \"pound\", \"input\": [[0, -2, \"3\", 1.5]], \"config\": {\"row\": 1.5}}", "InvalidInput",
	    "/config/row: must be a whole number in [0, 1048575]; /input/0/0: f_e must be greater than 0 Hz, got "
	    "0; /input/0/1: f_2 must be greater than 0 Hz, got -2; /input/0/2: m_2/m_1 must be a number; "
	    "/input/0/3: eps must be in [0, 1], got 1.5");
	// rules between values are checked as in any study: 20 cycles of 1e-9 Hz need too many samples
	refused(service, "/Evaluate", "{\"name\": \"pound\", \"input\": [[1e-9, 2, 1, 0.5]]}", "InvalidInput",
	        "/scene/excitation/time_step_s: a ground motion may have at most 10000000 samples");
	snprintf(body, sizeof body, "{%s, \"config\": {\"study\": {\"kind\": \"sensitivity\", \"scene\": {}}}}",
	         right);
	refused(service, "/Evaluate", body, "InvalidInput",
	        "/config/study/scene/oscillators: is required: an array of 2 elements; /config/study/inputs: is "
	        "required");
	// all digits of a number in the study are read: rounded to 15 digits this is 1
	snprintf(
	    body, sizeof body,
	    "{%s, \"config\": {\"study\": {\"scene\": {\"contact\": {\"restitution\": 1.0000000000000002}}}}}",
	    right);
	refused(service, "/Evaluate", body, "InvalidInput",
	        "/config/study/scene/contact/restitution: must be in [0, 1]");
	// the deepest JSON accepted
	snprintf(body, sizeof body,
	         "{%s, \"config\": {\"study\": "
	         "[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[]]]]]]]]]]]]]]]]]]]]]]]]]]]]]]}}",
	         right);
	refused(service, "/Evaluate", body, "InvalidInput", "/config/study: must be");
	snprintf(body, sizeof body, "{%s, \"config\": {\"study\": %s}}", right, example_text("response"));
	refused(service, "/Evaluate", body, "InvalidInput", "/config/study/kind: must be \"sensitivity\"");
	snprintf(body, sizeof body, "{%s, \"config\": {\"study\": %s}}", right,
	         example_text("spectrum_sensitivity"));
	refused(service, "/Evaluate", body, "InvalidInput",
	        "/config/study/outputs: output \"floor_spectrum\" is not available from a model");
	snprintf(study, sizeof study, still, "0, 0, 0", "");
	snprintf(body, sizeof body, "{\"name\": \"pound\", \"input\": [[1]], \"config\": {\"study\": %s}}",
	         study);
	refused(service, "/Evaluate", body, "InvalidOutput", "force_amplification of cell 0 has no value");
	snprintf(
	    body, sizeof body,
	    "{\"name\": \"pound\", \"input\": [[1]], \"config\": {\"row\": 1, \"signals\": 2, \"study\": %s}}",
	    study);
	refused(service, "/Evaluate", body, "InvalidInput",
	        "/config/row: is not used by excitation \"record\"; /config/signals: is not used");
	snprintf(study, sizeof study, still, "0, 1, 0, 1, 0, 1, 0, 1",
	         ", \"solver\": {\"method\": \"central_difference\", \"step_s\": 0.01}");
	snprintf(body, sizeof body, "{\"name\": \"pound\", \"input\": [[1]], \"config\": {\"study\": %s}}",
	         study);
	refused(service, "/Evaluate", body, "InvalidOutput",
	        "1 run failed: the steps of the solver are too long");
	// a call that would take too long
	snprintf(body, sizeof body,
	         "{\"name\": \"pound\", \"input\": [[0.001, 2, 1, 0.5]], \"config\": {\"signals\": "
	         "100000}}");
	refused(service, "/Evaluate", body, "InvalidInput", "a call may take at most 60: submit it as a study");
}

/* The paper's study as a response study, with these values of its inputs; the caller frees it. */
static char *response_of(const double x[4], int signals)
{
	static const char form[] =
	    "{\"kind\": \"response\", \"scene\": {\"law\": {\"type\": \"linear\"}, \"oscillators\": "
	    "[{\"mass_kg\": 1, "
	    "\"frequency_hz\": 2, \"damping_ratio\": 0.05}, {\"mass_kg\": %.17g, \"frequency_hz\": %.17g, "
	    "\"damping_ratio\": 0.05}], \"contact\": {\"restitution\": %.17g}, \"excitation\": "
	    "{\"frequency_hz\": "
	    "%.17g, \"signals\": %d}}, \"design\": {\"seed\": 42}, \"outputs\": [\"force_amplification\", "
	    "\"impulse\"]}";
	char *study = NULL;
	assert_true(asprintf(&study, form, x[2], x[1], x[3], x[0], signals) > 0);
	return study;
}

/* The digits of the number after a text in JSON. */
static void digits_behind(const char *json, const char *text, char digits[32])
{
	const char *at = strstr(json, text);
	assert_non_null(at);
	at += strlen(text);
	snprintf(digits, 32, "%.*s", (int)strspn(at, "0123456789.eE+-"), at);
}

static void evaluate_gives_the_numbers_of_the_response_study(void **state)
{
	enum { POINTS = 20 };
	struct service *service = *state;
	double largest = 0;
	for (int i = 0; i < POINTS; i++) {
		// points of a lattice in the ranges of the inputs
		const double x[4] = {0.5 + 4.5 * fmod(0.618 * (i + 1), 1), 0.5 + 4.5 * fmod(0.445 * (i + 1), 1),
		                     0.2 + 5.8 * fmod(0.303 * (i + 1), 1), fmod(0.755 * (i + 1), 1)};
		const int signals = 1 + i % 5;
		char body[256], impulse[40], got[32], wanted[32], *study = response_of(x, signals);
		snprintf(
		    body, sizeof body,
		    "{\"name\": \"pound\", \"input\": [[%.17g, %.17g, %.17g, %.17g]], \"config\": {\"signals\": %d}}",
		    x[0], x[1], x[2], x[3], signals);
		struct answer answer = call(service, "/Evaluate", body);
		struct program_outcome run = program_run((const char *const[]){"pound", "run", "-", NULL}, study);
		program_expect(&run, 0);
		digits_behind(answer.body, "{\"output\": [[", got);
		digits_behind(run.out, "\"force_amplification\": ", wanted);
		largest = fmax(largest, fabs(strtod(got, NULL) / strtod(wanted, NULL) - 1));
		snprintf(impulse, sizeof impulse, "%s, ", got);
		digits_behind(answer.body, impulse, got);
		digits_behind(run.out, "\"impulse\": ", wanted);
		largest = fmax(largest, fabs(strtod(got, NULL) / strtod(wanted, NULL) - 1));
		program_free(&run);
		answer_free(&answer);
		free(study);
	}
	// rounding only: without energy balances, intervals without an event are passed in one step
	assert_true(largest < 1e-12);
	check_report("%d points: largest relative difference to pound run %.1e", POINTS, largest);
}

/* Samples of a study against its model evaluated at the same rows: the same scenes and noise, run in different blocks. */
static void a_stored_study_is_a_model_by_its_id_and_a_row_is_that_of_its_design(void **state)
{
	enum { ROWS = 6, SAMPLES = 5 /* A, B, AB of three inputs */ };
	struct service *service = *state;
	char id[17], body[256], *study = service_study(ROWS, 3, 7);
	double largest = 0;
	int n = 0;
	service_submit(service, study, id);
	assert_true(service_wait(service, id, "succeeded", 0));
	struct answer csv = service_get(service, "/v1/studies/%s/samples", id);
	char *line = strchr(csv.body, '\n') + 1;
	for (; *line; line = strchr(line, '\n') + 1, n++) {
		double row, x[3], force, impulse;
		assert_int_equal(sscanf(line, "%lf,%*[^,],%lf,%lf,%lf,%lf,%*[^,],%lf", &row, &x[0], &x[1], &x[2],
		                        &force, &impulse),
		                 6);
		snprintf(body, sizeof body,
		         "{\"name\": \"%s\", \"input\": [[%.17g, %.17g, %.17g]], \"config\": {\"row\": %.0f}}", id,
		         x[0], x[1], x[2], row);
		struct reading *r = answered(service, "/Evaluate", body);
		largest = fmax(largest, fabs(reading_number(r, "/output/0/0") / force - 1));
		largest = fmax(largest, fabs(reading_number(r, "/output/0/1") / impulse - 1));
		reading_close(r);
	}
	assert_int_equal(n, ROWS * SAMPLES);
	// rounding only: scenes are run in scaled units, which are chosen for all samples of a block together
	assert_true(largest < 1e-12);
	check_report("%d samples of a stored study: largest relative difference %.1e", n, largest);
	answer_free(&csv);
	struct reading *r;
	snprintf(body, sizeof body, "{\"name\": \"%s\"}", id);
	r = answered(service, "/InputSizes", body);
	assert_true(reading_number(r, "/inputSizes/0") == 3);
	reading_close(r);
	snprintf(body, sizeof body, "{\"name\": \"%s\", \"config\": {\"study\": {}}}", id);
	refused(service, "/InputSizes", body, "InvalidInput", "/config/study: is not used");
	service_submit(service, example_text("response"), id);
	snprintf(body, sizeof body, "{\"name\": \"%s\"}", id);
	refused(service, "/InputSizes", body, "ModelNotFound", "/kind: must be \"sensitivity\"");
	free(study);
}

static void every_cell_of_a_sweep_has_its_outputs_in_order(void **state)
{
	struct service *service = *state;
	char *body = NULL, output[32];
	assert_true(asprintf(&body,
	                     "{\"name\": \"pound\", \"config\": {\"study\": %s}, \"input\": [[2.5, 3.1, 1, "
	                     "0.6]]}",
	                     example_text("paper")) > 0);
	struct reading *sizes = answered(service, "/OutputSizes", body);
	struct reading *r = answered(service, "/Evaluate", body);
	const int n = reading_count(r, "/output/0");
	assert_true(reading_number(sizes, "/outputSizes/0") == n);
	// 6 frequencies x 4 laws x 2 outputs: force (linear law) or demand (other laws), and impulse
	assert_int_equal(n, 48);
	// the cell of f_1 = 2 Hz and the linear law is the paper's study
	struct reading *one =
	    answered(service, "/Evaluate", "{\"name\": \"pound\", \"input\": [[2.5, 3.1, 1, 0.6]]}");
	int same = 0;
	for (int i = 0; i + 1 < n; i += 2)
		same += reading_number(r, "/output/0/%d", i) == reading_number(one, "/output/0/0") &&
		        reading_number(r, "/output/0/%d", i + 1) == reading_number(one, "/output/0/1");
	snprintf(output, sizeof output, "%d", same);
	assert_string_equal(output, "1");
	reading_close(one);
	reading_close(r);
	reading_close(sizes);
	free(body);
}

static void evaluate_takes_milliseconds(void **state)
{
	struct service *service = *state;
	struct latencies latencies = {0};
	for (int i = 0; i < check_count(200, 2000); i++) {
		char body[128];
		snprintf(body, sizeof body, "{\"name\": \"pound\", \"input\": [[2.5, %.6f, 1, 0.6]], \"config\": {}}",
		         0.5 + 4.5 * fmod(0.618 * i, 1));
		double asked = latency_now();
		struct answer answer = call(service, "/Evaluate", body);
		latency_add(&latencies, asked, latency_now());
		assert_int_equal(answer.status, 200);
		answer_free(&answer);
	}
	latency_report("Evaluate of 5 signals of 8 s, a connection each", &latencies);
	if (check_soaks())
		assert_true(latency_quantile(&latencies, 0.5) < 2);
	free(latencies.answers);
}

/* The conformity tests of UM-Bridge from a checkout in UMBRIDGE_DIR; skipped without one. */
static void the_conformity_tests_of_the_protocol_pass(void **state)
{
	struct service *service = *state;
	const char *folder = getenv("UMBRIDGE_DIR");
	char tests[256], url[64];
	if (!folder)
		skip();
	snprintf(tests, sizeof tests, "%s/testing/protocol_conformity_1.0/test_model_schema.py", folder);
	snprintf(url, sizeof url, "--model_url=http://127.0.0.1:%d", service->port);
	struct program_outcome outcome =
	    program_run((const char *const[]){"/usr/bin/python3", "-m", "pytest", "-q", "-p", "no:cacheprovider",
	                                      tests, url, "--input_value=[2.5,3.1,1,0.6]", NULL},
	                NULL);
	program_expect(&outcome, 0);
	const char *passed = strstr(outcome.out, " passed");
	assert_non_null(passed);
	while (passed > outcome.out && passed[-1] != '\n')
		passed--;
	check_report("%.*s", (int)strcspn(passed, "\n"), passed);
	program_free(&outcome);
}

#define TEST(name) cmocka_unit_test_setup_teardown(name, service_setup, service_teardown)
CHECK_MAIN(TEST(information_has_the_members_of_the_protocol_and_no_others),
           TEST(sizes_are_those_of_the_output_of_evaluate),
           TEST(every_error_of_the_protocol_has_its_type_status_and_message),
           TEST(evaluate_gives_the_numbers_of_the_response_study),
           TEST(a_stored_study_is_a_model_by_its_id_and_a_row_is_that_of_its_design),
           TEST(every_cell_of_a_sweep_has_its_outputs_in_order), TEST(evaluate_takes_milliseconds),
           TEST(the_conformity_tests_of_the_protocol_pass))
