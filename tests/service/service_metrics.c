/* /metrics: the rules of its format, and correct values. */
#include <ctype.h>
#include <math.h>
#include <string.h>

#include "tests/support/service.h"

enum { NAME_SIZE = 96 };

struct family {
	char name[NAME_SIZE], type[16];
	int samples;
};

static bool is_name(const char *text, size_t n)
{
	for (size_t i = 0; i < n; i++)
		if (!isalpha((unsigned char)text[i]) && text[i] != '_' && text[i] != ':' &&
		    !(i && isdigit((unsigned char)text[i])))
			return false;
	return n > 0;
}

/* Whether a sample belongs to a family: by its name, for a histogram without the suffix. */
static bool belongs(const char *sample, const struct family *family)
{
	static const char *const ends[] = {"_bucket", "_sum", "_count"};
	size_t n = strlen(family->name);
	if (strcmp(family->type, "histogram") != 0)
		return !strcmp(sample, family->name);
	for (int i = 0; i < 3; i++)
		if (!strncmp(sample, family->name, n) && !strcmp(sample + n, ends[i]))
			return true;
	return false;
}

/* Fails unless a line is a valid sample: NAME{label="value",...} NUMBER. */
static void sample_is_right(const char *line, const struct family *family)
{
	char name[NAME_SIZE];
	size_t n = strcspn(line, "{ ");
	const char *at = line + n;
	assert_true(is_name(line, n));
	snprintf(name, sizeof name, "%.*s", (int)n, line);
	if (!belongs(name, family))
		fail_msg("%s stands below %s", line, family->name);
	if (*at == '{') {
		for (at++; *at != '}'; at += *at == ',') {
			size_t label = strcspn(at, "=");
			assert_true(is_name(at, label) && at[label] == '=' && at[label + 1] == '"');
			at += label + 2;
			while (*at != '"') {
				assert_true(*at && *at != '\n');
				at += *at == '\\' ? 2 : 1;
			}
			at++;
			assert_true(*at == ',' || *at == '}');
		}
		at++;
	}
	assert_int_equal(*at, ' ');
	char *rest;
	double value = strtod(at + 1, &rest);
	if (rest == at + 1 || *rest || isnan(value))
		fail_msg("%s has no number", line);
	bool grows = !strcmp(family->type, "counter") || !strcmp(family->type, "histogram");
	assert_true(!grows || value >= 0);
}

/* Checks the rules of the text format and of promtool's lint: HELP and TYPE once before the samples, each family
 * contiguous, _total at the end of counters only, base units, no duplicate line. */
static int families_of(char *text, struct family *families, int most)
{
	int n = 0;
	struct family *family = NULL;
	char *lines[1000];
	int n_lines = 0;
	assert_true(text[strlen(text) - 1] == '\n');
	for (char *rest, *line = strtok_r(text, "\n", &rest); line; line = strtok_r(NULL, "\n", &rest)) {
		assert_true(n_lines < 1000);
		for (int i = 0; i < n_lines; i++) {
			size_t key = strcspn(line, " ");
			if (*line != '#' && !strncmp(lines[i], line, key + 1))
				fail_msg("%s is there twice", line);
		}
		lines[n_lines++] = line;
		if (!strncmp(line, "# HELP ", 7)) {
			assert_true(n < most);
			family = &families[n++];
			*family = (struct family){0};
			snprintf(family->name, sizeof family->name, "%.*s", (int)strcspn(line + 7, " "), line + 7);
			assert_true(strlen(line + 7 + strlen(family->name)) > 1);
			for (int i = 0; i < n - 1; i++)
				assert_string_not_equal(families[i].name, family->name);
		} else if (!strncmp(line, "# TYPE ", 7)) {
			char name[NAME_SIZE];
			assert_non_null(family);
			assert_int_equal(sscanf(line + 7, "%95s %15s", name, family->type), 2);
			assert_string_equal(name, family->name);
			assert_int_equal(family->samples, 0);
		} else {
			assert_non_null(family);
			sample_is_right(line, family);
			family->samples++;
		}
	}
	for (int i = 0; i < n; i++) {
		size_t length = strlen(families[i].name);
		bool total = length > 6 && !strcmp(families[i].name + length - 6, "_total");
		assert_true(!strcmp(families[i].type, "counter") == total);
		assert_null(strstr(families[i].name, "millisecond"));
		assert_null(strstr(families[i].name, "_ms"));
		assert_non_null(strstr("counter gauge histogram", families[i].type));
	}
	return n;
}

static double value_of(const char *text, const char *name)
{
	char line[160];
	snprintf(line, sizeof line, "\n%s ", name);
	const char *at = strstr(text, line);
	return at ? atof(at + strlen(line)) : 0;
}

static void the_text_keeps_the_rules_of_prometheus(void **state)
{
	struct service *service = *state;
	struct family families[64];
	struct answer answer = service_get(service, "/nowhere");
	answer_free(&answer);
	answer = service_get(service, "/metrics");
	assert_int_equal(answer.status, 200);
	assert_string_equal(answer.type, "text/plain; version=0.0.4; charset=utf-8");
	int n = families_of(answer.body, families, 64), samples = 0;
	for (int i = 0; i < n; i++)
		samples += families[i].samples;
	check_report("%d families, %d samples", n, samples);
	assert_true(n >= 7);
	answer_free(&answer);
}

static void the_counts_are_those_of_the_requests_and_studies(void **state)
{
	struct service *service = *state;
	static const struct {
		const char *path, *name;
		int n;
	} asked[] = {
	    {"/livez", "pound_http_requests_total{method=\"GET\",path=\"/livez\",code=\"200\"}", 7},
	    {"/v1/studies?limit=0", "pound_http_requests_total{method=\"GET\",path=\"/v1/studies\",code=\"400\"}",
	     3},
	    {"/v1/studies/0123456789abcdef",
	     "pound_http_requests_total{method=\"GET\",path=\"/v1/studies/{id}\",code=\"404\"}", 5},
	    {"/nowhere", "pound_http_requests_total{method=\"\",path=\"\",code=\"404\"}", 4},
	};
	enum { ASKED = sizeof asked / sizeof asked[0], STUDIES = 6 };
	int sum = 0;
	double buckets = 0;
	char id[17];
	for (int i = 0; i < ASKED; i++)
		for (int k = 0; k < asked[i].n; k++, sum++) {
			struct answer answer = service_get(service, "%s", asked[i].path);
			answer_free(&answer);
		}
	char *study = service_study(2, 1, 1);
	for (int i = 0; i < STUDIES; i++, sum++)
		service_submit(service, study, id);
	free(study);
	struct answer answer = service_get(service, "/metrics");
	for (int i = 0; i < ASKED; i++)
		check_near(value_of(answer.body, asked[i].name), asked[i].n, 0);
	check_near(
	    value_of(answer.body, "pound_http_requests_total{method=\"POST\",path=\"/v1/studies\",code=\"201\"}"),
	    STUDIES, 0);
	check_near(value_of(answer.body, "pound_http_request_duration_seconds_count"), sum, 0);
	check_near(value_of(answer.body, "pound_http_request_duration_seconds_bucket{le=\"+Inf\"}"), sum, 0);
	for (const char *at = strstr(answer.body, "_bucket{"); at; at = strstr(at + 1, "_bucket{")) {
		double value = atof(strchr(at, ' '));
		assert_true(value >= buckets); // buckets are cumulative
		buckets = value;
	}
	double studies = 0;
	static const char *const states[] = {"queued", "running", "succeeded", "failed", "cancelled"};
	for (int i = 0; i < 5; i++) {
		char name[64];
		snprintf(name, sizeof name, "pound_studies{status=\"%s\"}", states[i]);
		studies += value_of(answer.body, name);
	}
	check_near(studies, STUDIES, 0);
	answer_free(&answer);
}

#define SERVED(test) cmocka_unit_test_setup_teardown(test, service_setup, service_teardown)

CHECK_MAIN(SERVED(the_text_keeps_the_rules_of_prometheus),
           SERVED(the_counts_are_those_of_the_requests_and_studies))
