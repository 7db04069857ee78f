/* Submission of studies: repeated keys, a full queue, studies over the limits, hostile texts. */
#include <dirent.h>
#include <pthread.h>
#include <string.h>

#include "schema/json/json_pointer.h"
#include "tests/support/program.h"
#include "tests/support/service.h"

static void problem_is(struct answer *answer, int status, const char *type)
{
	struct reading *problem = answer_read(answer);
	if (answer->status != status || strcmp(reading_text(problem, "/type"), type) != 0)
		fail_msg("%d instead of %d: %s", answer->status, status, answer->body);
	reading_close(problem);
	answer_free(answer);
}

enum { THREADS = 100, KEYS = 50 };

struct poster {
	const struct service *service;
	const char *study;
	char locations[KEYS][64];
	pthread_t thread;
};

static void *post_in_thread(void *of)
{
	struct poster *poster = of;
	for (int k = 0; k < KEYS; k++) {
		char key[32];
		snprintf(key, sizeof key, "key-%d", k);
		struct answer answer = service_post_keyed(poster->service, poster->study, key);
		if (answer.status == 201)
			strcpy(poster->locations[k], answer.location);
		answer_free(&answer);
	}
	return NULL;
}

static void a_hundred_posts_at_once_with_one_key_are_one_study(void **state)
{
	struct service *service = *state;
	static struct poster posters[THREADS];
	char *study = service_study(2, 1, 1);
	for (int t = 0; t < THREADS; t++) {
		posters[t] = (struct poster){.service = service, .study = study};
		assert_int_equal(pthread_create(&posters[t].thread, NULL, post_in_thread, &posters[t]), 0);
	}
	for (int t = 0; t < THREADS; t++)
		pthread_join(posters[t].thread, NULL);
	for (int t = 0; t < THREADS; t++)
		for (int k = 0; k < KEYS; k++) {
			assert_true(posters[t].locations[k][0]);
			assert_string_equal(posters[t].locations[k], posters[0].locations[k]);
		}
	int64_t n = service_number(service, "SELECT count(*) FROM study");
	check_report("%d posts with %d keys: %d studies", THREADS * KEYS, KEYS, (int)n);
	assert_int_equal(n, KEYS);
	free(study);
}

static void a_key_is_known_after_a_crash_and_to_one_body_only(void **state)
{
	struct service *service = *state;
	char *study = service_study(2, 1, 1), *other = service_study(2, 1, 2);
	struct answer first = service_post_keyed(service, study, "\"a key, \xc3\xa4\"");
	assert_int_equal(first.status, 201);
	service_kill(service);
	service_start(service, 2);
	struct answer again = service_post_keyed(service, study, "\"a key, \xc3\xa4\"");
	assert_int_equal(again.status, 201);
	assert_string_equal(again.location, first.location);
	struct answer clash = service_post_keyed(service, other, "\"a key, \xc3\xa4\"");
	problem_is(&clash, 422, "idempotency-key-reused");
	struct answer free_of_key = service_post_keyed(service, study, NULL);
	assert_string_not_equal(free_of_key.location, first.location);
	// the key of a deleted study can be used again
	struct answer gone = service_ask(service, &(struct ask){.method = "DELETE", .path = first.location});
	assert_int_equal(gone.status, 204);
	struct answer fresh = service_post_keyed(service, other, "\"a key, \xc3\xa4\"");
	assert_int_equal(fresh.status, 201);
	answer_free(&fresh);
	answer_free(&gone);
	answer_free(&free_of_key);
	answer_free(&again);
	answer_free(&first);
	free(other);
	free(study);
}

static void a_key_is_one_text_of_1_to_200_characters(void **state)
{
	struct service *service = *state;
	char *study = service_study(2, 1, 1), key[2 * 201 + 1] = "";
	struct answer first = service_post_keyed(service, study, "a"),
	              again = service_post_keyed(service, study, "a \t");
	assert_int_equal(first.status, 201);
	assert_string_equal(first.location, again.location);
	for (int i = 0; i < 200; i++)
		strcat(key, "\xc3\xa9");
	struct answer lengthy = service_post_keyed(service, study, key);
	assert_int_equal(lengthy.status, 201);
	struct answer longer = service_post_keyed(service, study, strcat(key, "\xc3\xa9"));
	problem_is(&longer, 400, "bad-request");
	struct answer latin = service_post_keyed(service, study, "caf\xe9");
	problem_is(&latin, 400, "bad-request");
	struct answer two =
	    service_ask(service, &(struct ask){.method = "POST",
	                                       .path = "/v1/studies",
	                                       .headers = {"Content-Type: application/json", "Idempotency-Key: b",
	                                                   "Idempotency-Key: a"},
	                                       .body = study,
	                                       .length = strlen(study)});
	problem_is(&two, 400, "bad-request");
	assert_int_equal(service_number(service, "SELECT count(*) FROM study"), 2);
	answer_free(&lengthy);
	answer_free(&again);
	answer_free(&first);
	free(study);
}

static void a_full_queue_is_503_until_there_is_room(void **state)
{
	static const char *const settings[][2] = {{"POUNDD_QUEUE_MAX", "3"}, {NULL}};
	(void)state;
	struct service *service = service_with(settings, 1);
	enum { OPEN = 4 }; // studies that run at a time
	char *study = service_study(20 * SERVICE_ROWS, 5, 1), id[17], path[64];
	for (int i = 0; i < OPEN; i++) {
		service_submit(service, study, id);
		assert_true(service_wait(service, id, "running", 0));
	}
	for (int i = 0; i < 3; i++)
		service_submit(service, study, id);
	struct answer refused = service_post(service, study);
	assert_true(atoi(refused.retry_after) >= 1);
	problem_is(&refused, 503, "unavailable");
	assert_int_equal(service_number(service, "SELECT count(*) FROM study"), OPEN + 3);
	snprintf(path, sizeof path, "/v1/studies/%s/cancel", id);
	struct answer cancelled = service_ask(service, &(struct ask){.method = "POST", .path = path});
	assert_int_equal(cancelled.status, 200);
	service_submit(service, study, id);
	answer_free(&cancelled);
	free(study);
	service_free(service);
}

static void a_study_over_a_limit_is_refused_with_the_limit_and_what_was_asked(void **state)
{
	static const struct {
		const char *variable, *most, *words[3];
	} limits[] = {
	    {"POUNDD_RUNS_MAX", "39", {"40 pounding runs", "at most 39", "--runs-max"}},
	    {"POUNDD_CPU_MAX", "1", {"seconds of one core", "at most 1", "--cpu-max"}},
	    {"POUNDD_RESULT_MAX", "1", {"MiB", "at most 1", "--result-max"}},
	    {"POUNDD_MEMORY_MAX", "16", {"MiB of memory", "at most 16", "--memory-max"}},
	};
	(void)state;
	for (size_t i = 0; i < sizeof limits / sizeof limits[0]; i++) {
		const char *const settings[][2] = {{limits[i].variable, limits[i].most}, {NULL}};
		struct service *service = service_with(settings, 1);
		char *small = service_study(2, 1, 1),
		     *large = i == 0 ? service_study(4, 2, 1) : service_study(20000, 9, 1);
		static const char *const paths[] = {"/v1/studies", "/v1/studies?validate_only=true"};
		for (int p = 0; p < 2; p++) {
			struct answer answer =
			    service_ask(service, &(struct ask){.method = "POST",
			                                       .path = paths[p],
			                                       .headers = {"Content-Type: application/json"},
			                                       .body = large,
			                                       .length = strlen(large)});
			for (int w = 0; w < 3; w++)
				if (!strstr(answer.body, limits[i].words[w]))
					fail_msg("'%s' is not in %s", limits[i].words[w], answer.body);
			struct reading *problem = answer_read(&answer);
			double limit = reading_number(problem, "/errors/0/limit");
			check_near(limit, atof(limits[i].most), 0);
			assert_true(reading_number(problem, "/errors/0/requested") > limit);
			reading_close(problem);
			problem_is(&answer, 422, "study-too-large");
		}
		struct answer taken = service_post(service, small);
		assert_int_equal(taken.status, 201);
		assert_int_equal(service_number(service, "SELECT count(*) FROM study"), 1);
		answer_free(&taken);
		free(large);
		free(small);
		service_free(service);
	}
}

static void a_study_beyond_all_measure_is_refused_without_making_it(void **state)
{
	struct service *service = *state;
	// 3e11 runs: 1e6 rows x 3 samples x 1e5 signals
	static const char study[] =
	    "{\"kind\": \"sensitivity\", \"scene\": {\"oscillators\": [{\"frequency_hz\": 2}, {\"frequency_hz\": "
	    "3}], "
	    "\"excitation\": {\"signals\": 100000}}, \"inputs\": [{\"path\": \"/contact/restitution\", "
	    "\"distribution\": "
	    "{\"type\": \"uniform\", \"min\": 0, \"max\": 1}}], \"design\": {\"rows\": 1000000}}";
	struct answer answer = service_post(service, study);
	assert_int_equal(answer.status, 422);
	assert_non_null(strstr(answer.body, "300000000000 pounding runs"));
	answer_free(&answer);
}

static const char *const HOSTILE[] = {"' OR '1'='1",
                                      "' OR 1=1--",
                                      "'; DROP TABLE study;--",
                                      "\\\"; DELETE FROM study; --",
                                      "1' UNION SELECT sql FROM sqlite_schema--",
                                      "') OR ('1'='1",
                                      "%27%20OR%201=1",
                                      "\\u0027 OR 1=1",
                                      "admin'/*",
                                      "0x27",
                                      "1;ATTACH DATABASE '/tmp/x' AS x",
                                      "{{7*7}}",
                                      "${jndi:x}",
                                      "<script>alert(1)</script>",
                                      "=cmd|'/c calc'!A1",
                                      "@SUM(1)",
                                      "../../etc/passwd",
                                      "%s%s%s%n",
                                      "\xe2\x80\xae-abc",
                                      "\xf0\x9f\x8f\xa2",
                                      "e\xcc\x81",
                                      "\\ud83c\\udfe2",
                                      "NULL",
                                      "nan",

                                      "a\\\"b",
                                      "load_extension('x')",
                                      "randomblob(1e9)",
                                      "1) AND (SELECT 1",
                                      "-1",
                                      "9223372036854775808",
                                      "`id`",
                                      "$(id)",
                                      "|id",
                                      "&&id",
                                      "\\\\x00",
                                      "%00",
                                      "\xef\xbf\xbf",

                                      "--",
                                      "/*",
                                      "*/",
                                      ";"};

/* Form v of a hostile text in a JSON string: unchanged, or between characters that may close or open a quotation, a
 * comment or an expression. */
enum { FORMS = 13 };

static void form(const char *text, int v, char formed[400])
{
	static const char *const forms[FORMS][2] = {
	    {"", ""},    {"'", ""},  {"\\\"", ""},    {"", "'"},  {"", "\\\""}, {"')", "--"},
	    {"1 ", "#"}, {"''", ""}, {"", "\\u00e9"}, {"%", "%"}, {"(", ")"},   {"x' || ", " || 'x"},
	    {" ", " "}};
	snprintf(formed, 400, "%s%s%s", forms[v][0], text, forms[v][1]);
}

/* Percent-encodes every byte of a text for a request target. */
static void escape(const char *text, char *escaped)
{
	for (; *text; text++)
		escaped += sprintf(escaped, "%%%02x", (unsigned)(unsigned char)*text);
}

static void hostile_texts_are_names_like_any_other_and_never_questions(void **state)
{
	static const char *const targets[] = {"/v1/studies?status=%s",  "/v1/studies?cursor=%s",
	                                      "/v1/studies?limit=%s",   "/v1/studies/%s",
	                                      "/v1/studies/%s/results", "/v1/studies?%s=1"};
	struct service *service = *state;
	int asked = 0, n = (int)(sizeof HOSTILE / sizeof HOSTILE[0]) * FORMS;
	for (int h = 0; h < n; h++) {
		char text[400], key[416], escaped[1300], path[1400], study[1024], name[600], id[17];
		form(HOSTILE[h / FORMS], h % FORMS, text);
		escape(text, escaped);
		for (size_t t = 0; t < sizeof targets / sizeof targets[0]; t++, asked++) {
#pragma GCC diagnostic push
#pragma GCC diagnostic ignored "-Wformat-nonliteral"
			snprintf(path, sizeof path, targets[t], escaped);
#pragma GCC diagnostic pop
			struct answer answer = service_get(service, "%s", path);
			if (answer.status != 400 && answer.status != 404)
				fail_msg("%s: %d %s", path, answer.status, answer.body);
			answer_free(&answer);
		}
		snprintf(
		    study, sizeof study,
		    "{\"kind\": \"response\", \"name\": \"%s\", \"scene\": {\"oscillators\": [{\"frequency_hz\": 2}, "
		    "{\"frequency_hz\": 3}], \"excitation\": {\"cycles\": 1, \"signals\": 1}}}",
		    text);
		snprintf(key, sizeof key, "%d %s", h, text);
		struct answer created = service_post_keyed(service, study, key);
		asked++;
		if (created.status != 201)
			fail_msg("%s: %d %s", study, created.status, created.body);
		strcpy(id, created.location + strlen("/v1/studies/"));
		struct reading *sent = reading_open(study, strlen(study)), *status = answer_read(&created);
		snprintf(name, sizeof name, "%s", reading_text(sent, "/name"));
		assert_string_equal(reading_text(status, "/name"), name);
		reading_close(status);
		reading_close(sent);
		answer_free(&created);
		struct answer kept = service_get(service, "/v1/studies/%s/request", id);
		assert_string_equal(kept.body, study);
		answer_free(&kept);
	}
	check_report("%d hostile texts in %d requests: %d studies", n, asked,
	             (int)service_number(service, "SELECT count(*) FROM study"));
	assert_int_equal(service_number(service, "SELECT count(*) FROM study"), n);
}

/* Every file of JSONTestSuite (folder in JSONTESTSUITE_DIR) posted as a study: none is a valid study, but only files that
 * are not JSON are malformed. */
static void the_public_suite_is_posted_and_judged_as_it_says(void **state)
{
	struct service *service = *state;
	const char *folder = getenv("JSONTESTSUITE_DIR");
	DIR *files = folder ? opendir(folder) : NULL;
	int n[128] = {0}, malformed[128] = {0};
	if (!files)
		skip();
	for (struct dirent *entry = readdir(files); entry; entry = readdir(files)) {
		char path[512];
		size_t length;
		int kind = entry->d_name[0] & 0x7f;
		if (!strchr("nyi", kind) || entry->d_name[1] != '_')
			continue;
		snprintf(path, sizeof path, "%s/%s", folder, entry->d_name);
		char *bytes = program_file(path, &length);
		struct answer answer =
		    service_ask(service, &(struct ask){.method = "POST",
		                                       .path = "/v1/studies",
		                                       .headers = {"Content-Type: application/json"},
		                                       .body = bytes,
		                                       .length = length});
		if (answer.status != 400 && answer.status != 422)
			fail_msg("%s: %d", entry->d_name, answer.status);
		if (kind == 'n' && answer.status != 400)
			fail_msg("%s is not malformed: %s", entry->d_name, answer.body);
		assert_string_equal(answer.type, "application/problem+json");
		n[kind]++;
		malformed[kind] += answer.status == 400;
		answer_free(&answer);
		free(bytes);
	}
	closedir(files);
	check_report("posted: n_ %d of %d malformed, y_ %d of %d (escaped U+0000), i_ %d of %d", malformed['n'],
	             n['n'], malformed['y'], n['y'], malformed['i'], n['i']);
	assert_true(n['n'] > 100 && n['y'] > 50 && malformed['y'] <= 2);
	assert_int_equal(service_number(service, "SELECT count(*) FROM study"), 0);
}

#define SERVED(test) cmocka_unit_test_setup_teardown(test, service_setup, service_teardown)

CHECK_MAIN(SERVED(a_hundred_posts_at_once_with_one_key_are_one_study),
           SERVED(a_key_is_known_after_a_crash_and_to_one_body_only),
           SERVED(a_key_is_one_text_of_1_to_200_characters),
           cmocka_unit_test(a_full_queue_is_503_until_there_is_room),
           cmocka_unit_test(a_study_over_a_limit_is_refused_with_the_limit_and_what_was_asked),
           SERVED(a_study_beyond_all_measure_is_refused_without_making_it),
           SERVED(hostile_texts_are_names_like_any_other_and_never_questions),
           SERVED(the_public_suite_is_posted_and_judged_as_it_says))
