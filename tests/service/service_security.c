/* Access to the server: tokens, listen addresses, Host and Origin headers. */
#include <fcntl.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include "schema/http/api.h"
#include "tests/support/program.h"
#include "tests/support/service.h"

static const char TOKEN[] = "correct-horse-battery-staple-0123456789";

static void token_file(const struct service *service, char path[128])
{
	snprintf(path, 128, "%s/log", service->directory); // service_free deletes all files of the folder
	strcat(path, ".tokens");
	FILE *file = fopen(path, "w");
	assert_non_null(file);
	fprintf(file, "# ours\n%s\n", TOKEN);
	fclose(file);
	assert_int_equal(chmod(path, 0600), 0);
}

static int status_of(const struct service *service, const char *method, const char *path,
                     const char *authorization, const char *more)
{
	struct answer answer =
	    service_ask(service, &(struct ask){.method = method, .path = path, .headers = {authorization, more}});
	int status = answer.status;
	answer_free(&answer);
	return status;
}

static void without_a_right_token_everything_but_the_probes_is_401(void **state)
{
	static const char *const wrong[] = {"Authorization:",
	                                    "Authorization: Bearer",
	                                    "Authorization: Bearer ",
	                                    "Authorization: Bearer correct-horse-battery-staple-012345678",
	                                    "Authorization: Bearer correct-horse-battery-staple-01234567890",
	                                    "Authorization: Bearer Correct-horse-battery-staple-0123456789",
	                                    "Authorization: Bearer wrong-horse-battery-staple-0123456789",
	                                    "Authorization: Basic correct-horse-battery-staple-0123456789",
	                                    "Authorization: correct-horse-battery-staple-0123456789",
	                                    "X-Token: correct-horse-battery-staple-0123456789",
	                                    "Cookie: token=correct-horse-battery-staple-0123456789"};
	char path[128], right[128], line[1024];
	int refused = 0;
	(void)state;
	struct service *service = service_new();
	token_file(service, path);
	setenv("POUNDD_TOKEN_FILE", path, 1);
	service_start(service, 1);
	unsetenv("POUNDD_TOKEN_FILE");
	snprintf(right, sizeof right, "Authorization: Bearer %s", TOKEN);
	for (int o = 0; o < API_N_OPERATIONS; o++) {
		const struct api_operation *operation = &api_operations[o];
		char target[96];
		const char *rest = strstr(operation->path, "{id}");
		snprintf(target, sizeof target, "%.*s%s%s",
		         (int)(rest ? rest - operation->path : (long)strlen(operation->path)), operation->path,
		         rest ? "0123456789abcdef" : "", rest ? rest + 4 : "");
		char *named = strstr(target, "{name}");
		if (named)
			strcpy(named, "swept");
		for (size_t w = 0; w < sizeof wrong / sizeof wrong[0]; w++, refused++) {
			int status = status_of(service, operation->method, target, wrong[w], NULL);
			if (operation->open ? status != 200 : status != 401)
				fail_msg("%s %s with %s: %d", operation->method, target, wrong[w], status);
			refused -= operation->open;
		}
		int status = status_of(service, operation->method, target, right, NULL);
		if (status == 401)
			fail_msg("%s %s with the right token", operation->method, target);
	}
	// without a valid token an unknown path is a 401, not a 404
	assert_int_equal(status_of(service, "GET", "/nowhere", wrong[0], NULL), 401);
	assert_int_equal(status_of(service, "GET", "/nowhere", right, NULL), 404);
	// two Authorization headers are refused: a proxy may have checked the other one
	assert_int_equal(status_of(service, "GET", "/version", wrong[6], right), 400);
	assert_int_equal(status_of(service, "GET", "/version", right, "Authorization;"), 400); // an empty header
	strcat(right, " \t");
	assert_int_equal(status_of(service, "GET", "/version", right, NULL), 200);
	service_stop(service);
	FILE *log = fopen(service->log, "r");
	while (fgets(line, sizeof line, log))
		assert_null(strstr(line, "battery"));
	fclose(log);
	check_report("%d requests with wrong tokens: all 401", refused);
	unlink(path);
	service_free(service);
}

static void the_command_line_sends_the_token_of_its_environment(void **state)
{
	char path[128], url[64];
	(void)state;
	struct service *service = service_new();
	token_file(service, path);
	setenv("POUNDD_TOKEN_FILE", path, 1);
	service_start(service, 1);
	unsetenv("POUNDD_TOKEN_FILE");
	snprintf(url, sizeof url, "http://127.0.0.1:%d", service->port);
	setenv("POUND_URL", url, 1);
	struct program_outcome without = program_run((const char *const[]){"pound", "list", NULL}, NULL);
	setenv("POUND_TOKEN", TOKEN, 1);
	struct program_outcome with = program_run((const char *const[]){"pound", "list", NULL}, NULL);
	unsetenv("POUND_TOKEN");
	unsetenv("POUND_URL");
	assert_int_equal(without.status, 1);
	assert_non_null(strstr(without.err, "token"));
	program_expect(&with, 0);
	program_free(&without);
	program_free(&with);
	service_stop(service);
	unlink(path);
	service_free(service);
}

static void an_address_that_is_not_loopback_needs_tokens_or_insecure(void **state)
{
	char path[128];
	(void)state;
	struct service *service = service_new();
	setenv("POUNDD_LISTEN", "0.0.0.0", 1);
	assert_int_not_equal(service_run(service, 1), 0);
	setenv("POUNDD_LISTEN", "::", 1);
	assert_int_not_equal(service_run(service, 1), 0);
	setenv("POUNDD_LISTEN", "localhost", 1); // not a numeric address
	assert_int_not_equal(service_run(service, 1), 0);
	setenv("POUNDD_LISTEN", "127.0.0.1", 1);
	setenv("POUNDD_TOKEN_FILE", "/nonexistent", 1);
	assert_int_not_equal(service_run(service, 1), 0);
	token_file(service, path);
	chmod(path, 0644);
	setenv("POUNDD_TOKEN_FILE", path, 1);
	assert_int_not_equal(service_run(service, 1), 0);
	unsetenv("POUNDD_TOKEN_FILE");
	unsetenv("POUNDD_LISTEN");
	service_start(service, 1);
	service_stop(service);
	unlink(path);
	service_free(service);
}

/* Starts another server on the same port, with its own database; returns its outcome. */
static struct program_outcome start_another(const struct service *service, const char *redirection,
                                            char database[128])
{
	const char *build = getenv("POUND_BUILD");
	char command[512];
	snprintf(database, 128, "%s-other", service->database);
	// a server that listens by mistake would not end by itself
	snprintf(command, sizeof command, "timeout 20 %s/poundd --port %d --database %s %s",
	         build ? build : "build/release", service->port, database, redirection);
	return program_run((const char *const[]){"sh", "-c", command, NULL}, NULL);
}

static void a_port_that_another_server_has_is_refused(void **state)
{
	char database[128];
	struct program_outcome other = start_another(*state, "", database);
	program_expect(&other, 1);
	// in the last line only
	const char *message = strstr(other.err, "Address already in use\n");
	assert_non_null(message);
	assert_string_equal(message, "Address already in use\n");
	assert_null(strstr(other.err, "http: "));
	program_free(&other);
}

static void what_is_logged_goes_into_no_file_though_stderr_is_closed(void **state)
{
	char database[128], lock[160];
	struct stat about;
	struct program_outcome other = start_another(*state, "2>&-", database);
	program_expect(&other, 1);
	program_free(&other);
	snprintf(lock, sizeof lock, "%s-lock", database);
	assert_int_equal(stat(lock, &about), 0);
	assert_int_equal(about.st_size, 32); // the number of a study and the identity of the database file
}

static void a_page_of_the_web_cannot_use_the_server(void **state)
{
	struct service *service = *state;
	char *study = service_study(2, 1, 1);
	static const char *const types[] = {"Content-Type: text/plain",
	                                    "Content-Type: application/x-www-form-urlencoded",
	                                    "Content-Type: multipart/form-data; boundary=x"};
	// DNS rebinding: the name of the page's host resolves to this server
	assert_int_equal(status_of(service, "GET", "/v1/studies", "Host: evil.example", NULL), 421);
	assert_int_equal(status_of(service, "GET", "/v1/studies", "Host: evil.example:8437", NULL), 421);
	// a form, or a script without a preflight, cannot send JSON
	for (int i = 0; i < 3; i++) {
		struct answer answer =
		    service_ask(service, &(struct ask){.method = "POST",
		                                       .path = "/v1/studies",
		                                       .headers = {types[i], "Origin: http://evil.example"},
		                                       .body = study,
		                                       .length = strlen(study)});
		assert_int_equal(answer.status, 415);
		answer_free(&answer);
	}
	// requests that change something are refused by their origin, also without a body
	static const char *const foreign[] = {"Origin: http://evil.example", "Origin: null",
	                                      "Sec-Fetch-Site: cross-site", "Sec-Fetch-Site: same-site"};
	char id[17], path[64], own[64];
	service_submit(service, study, id);
	assert_true(service_wait(service, id, "succeeded", 0));
	snprintf(path, sizeof path, "/v1/studies/%s/cancel", id);
	for (int i = 0; i < 4; i++) {
		assert_int_equal(status_of(service, "POST", path, foreign[i], NULL), 403);
		assert_int_equal(
		    status_of(service, "POST", "/v1/studies", "Content-Type: application/json", foreign[i]), 403);
		path[28] = '\0';
		assert_int_equal(status_of(service, "DELETE", path, foreign[i], NULL), 403);
		assert_int_equal(status_of(service, "GET", path, foreign[i], NULL), 200);
		path[28] = '/';
	}
	check_report("3 ways to change something, each with 4 foreign origins: all 403");
	snprintf(own, sizeof own, "Origin: http://127.0.0.1:%d", service->port);
	assert_int_equal(status_of(service, "POST", path, own, "Sec-Fetch-Site: same-origin"), 409);
	path[28] = '\0';
	assert_int_equal(status_of(service, "DELETE", path, own, NULL), 204);
	// the preflight request is refused
	assert_int_equal(status_of(service, "OPTIONS", "/v1/studies", "Origin: http://evil.example",
	                           "Access-Control-Request-Method: POST"),
	                 405);
	assert_int_equal(service_number(service, "SELECT count(*) FROM study"), 0);
	free(study);
}

static void a_name_that_was_given_is_a_host(void **state)
{
	static const char *const settings[][2] = {{"POUNDD_HOST", "pound.example,other.example"}, {NULL}};
	(void)state;
	struct service *service = service_with(settings, 1);
	assert_int_equal(status_of(service, "GET", "/livez", "Host: other.example", NULL), 200);
	assert_int_equal(status_of(service, "GET", "/livez", "Host: evil.example", NULL), 421);
	service_stop(service);
	service_free(service);
}

static void a_token_has_a_share_of_the_queue_and_keys_of_its_own(void **state)
{
	static const char other[] = "another-token-of-another-client-0123456789";
	char path[128], tokens[2][128];
	const char *study = NULL;
	char *large = service_study(20 * SERVICE_ROWS, 5, 1), *small = service_study(2, 1, 1), locations[2][64];
	(void)state;
	struct service *service = service_new();
	token_file(service, path);
	FILE *file = fopen(path, "a");
	fprintf(file, "%s\n", other);
	fclose(file);
	setenv("POUNDD_TOKEN_FILE", path, 1);
	setenv("POUNDD_QUEUE_TOKEN_MAX", "2", 1);
	service_start(service, 1);
	unsetenv("POUNDD_TOKEN_FILE");
	unsetenv("POUNDD_QUEUE_TOKEN_MAX");
	snprintf(tokens[0], sizeof tokens[0], "Authorization: Bearer %s", TOKEN);
	snprintf(tokens[1], sizeof tokens[1], "Authorization: Bearer %s", other);
	// the first four studies are claimed, two are queued, the next one is refused; a repeated key is answered with its
	// stored study; the other token has its own limit of two
	static const struct {
		int token, status;
		bool keyed;
	} posts[] = {{0, 201, false}, {0, 201, false}, {0, 201, false}, {0, 201, false},
	             {0, 201, true},  {0, 201, false}, {0, 429, false}, {0, 201, true},
	             {1, 201, true},  {1, 201, false}, {1, 429, false}};
	enum { OPEN = 4, AGAIN = 7 };
	for (size_t i = 0; i < sizeof posts / sizeof posts[0]; i++) {
		study = i < OPEN ? large : small;
		struct answer answer = service_ask(
		    service, &(struct ask){.method = "POST",
		                           .path = "/v1/studies",
		                           .headers = {"Content-Type: application/json", tokens[posts[i].token],
		                                       posts[i].keyed ? "Idempotency-Key: one" : NULL},
		                           .body = study,
		                           .length = strlen(study)});
		if (answer.status != posts[i].status)
			fail_msg("post %zu: %d %s", i, answer.status, answer.body);
		assert_true(answer.status == 201 || atoi(answer.retry_after) >= 1);
		assert_true(answer.status == 201 ||
		            strstr(answer.body, "the queue has no room for more studies of this token"));
		if (i == AGAIN)
			assert_string_equal(answer.location, locations[0]);
		if (posts[i].keyed)
			strcpy(locations[posts[i].token], answer.location);
		// wait until the study is claimed
		while (i < OPEN && service_number(service, "SELECT count(*) FROM study WHERE status = 'queued'") > 0)
			usleep(1000);
		answer_free(&answer);
	}
	assert_string_not_equal(locations[0], locations[1]);
	unlink(path);
	service_free(service);
	free(small);
	free(large);
}

#define SERVED(test) cmocka_unit_test_setup_teardown(test, service_setup, service_teardown)

CHECK_MAIN(cmocka_unit_test(without_a_right_token_everything_but_the_probes_is_401),
           cmocka_unit_test(the_command_line_sends_the_token_of_its_environment),
           cmocka_unit_test(an_address_that_is_not_loopback_needs_tokens_or_insecure),
           cmocka_unit_test(a_token_has_a_share_of_the_queue_and_keys_of_its_own),
           SERVED(a_port_that_another_server_has_is_refused),
           SERVED(what_is_logged_goes_into_no_file_though_stderr_is_closed),
           SERVED(a_page_of_the_web_cannot_use_the_server), cmocka_unit_test(a_name_that_was_given_is_a_host))
