/* Starts poundd as a user would, and sends it requests through libcurl. */
#include "tests/support/service.h"

#include <curl/curl.h>
#include <dirent.h>
#include <errno.h>
#include <fcntl.h>
#include <signal.h>
#include <sqlite3.h>
#include <string.h>
#include <strings.h>
#include <sys/prctl.h>
#include <sys/wait.h>
#include <time.h>
#include <unistd.h>

#include "schema/json/json_pointer.h"

enum { WAIT_MAX_S = 120 }; /* [s] a longer study counts as hung */

struct service *service_new(void)
{
	struct service *service = calloc(1, sizeof *service);
	assert_non_null(service);
	strcpy(service->directory, "/tmp/poundd-test-XXXXXX");
	assert_non_null(mkdtemp(service->directory));
	snprintf(service->database, sizeof service->database, "%s/studies.db", service->directory);
	snprintf(service->log, sizeof service->log, "%s/log", service->directory);
	return service;
}

struct service *service_with(const char *const settings[][2], int n_workers)
{
	struct service *service = service_new();
	for (int i = 0; settings[i][0]; i++)
		setenv(settings[i][0], settings[i][1], 1);
	service_start(service, n_workers);
	for (int i = 0; settings[i][0]; i++)
		unsetenv(settings[i][0]);
	return service;
}

/* Fails if the log of the server has a sanitizer report; the exit status need not show it. */
static void expect_no_report(const struct service *service)
{
	char line[512];
	FILE *log = fopen(service->log, "r");
	while (log && fgets(line, sizeof line, log))
		if (strstr(line, "Sanitizer:") || strstr(line, "runtime error:")) {
			print_error("%s", line);
			for (int i = 0; i < 60 && fgets(line, sizeof line, log); i++)
				print_error("%s", line);
			fail();
		}
	if (log)
		fclose(log);
}

void service_free(struct service *service)
{
	char path[512];
	if (service->pid)
		service_kill(service);
	expect_no_report(service);
	DIR *files = opendir(service->directory);
	assert_non_null(files);
	for (struct dirent *file = readdir(files); file; file = readdir(files)) {
		snprintf(path, sizeof path, "%s/%s", service->directory, file->d_name);
		unlink(path);
	}
	closedir(files);
	rmdir(service->directory);
	free(service);
}

static pid_t spawn(const struct service *service, int n_workers, int out)
{
	const char *build = getenv("POUND_BUILD");
	char program[256], workers[16];
	snprintf(program, sizeof program, "%s/poundd", build ? build : "build/release");
	snprintf(workers, sizeof workers, "%d", n_workers);
	pid_t pid = fork();
	assert_true(pid >= 0);
	if (pid == 0) {
		int log = open(service->log, O_WRONLY | O_CREAT | O_APPEND, 0600);
		prctl(PR_SET_PDEATHSIG, SIGKILL);
		dup2(out, STDOUT_FILENO);
		dup2(log, STDERR_FILENO);
		execl(program, program, "--port", "0", "--database", service->database, "--workers", workers, NULL);
		_exit(127);
	}
	return pid;
}

static int exit_status(pid_t pid)
{
	int status;
	while (waitpid(pid, &status, 0) < 0)
		assert_int_equal(errno, EINTR);
	return WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
}

int service_try(struct service *service, int n_workers)
{
	int out[2];
	assert_int_equal(service->pid, 0);
	assert_int_equal(pipe2(out, O_CLOEXEC), 0);
	service->pid = spawn(service, n_workers, out[1]);
	close(out[1]);
	FILE *lines = fdopen(out[0], "r");
	assert_non_null(lines);
	service->port = 0;
	int matched = fscanf(lines, "listening on http://%*[0-9.]:%d", &service->port), status = 0;
	fclose(lines);
	if (matched != 1) {
		status = exit_status(service->pid);
		service->pid = 0;
		assert_int_not_equal(status, 0);
	}
	return status;
}

void service_start(struct service *service, int n_workers)
{
	if (service_try(service, n_workers) != 0)
		fail_msg("poundd does not listen; see %s", service->log);
}

int service_run(const struct service *service, int n_workers)
{
	return exit_status(spawn(service, n_workers, STDERR_FILENO));
}

void service_stop(struct service *service)
{
	kill(service->pid, SIGTERM);
	int status = exit_status(service->pid);
	service->pid = 0;
	if (status != 0) {
		char end[256];
		snprintf(end, sizeof end, "tail -n 60 %s >&2", service->log);
		fail_msg("poundd ended with %d; the end of its log%s is above", status,
		         system(end) ? ", unreadable," : "");
	}
}

void service_kill(struct service *service)
{
	kill(service->pid, SIGKILL);
	exit_status(service->pid);
	service->pid = 0;
}

static size_t receive(char *bytes, size_t size, size_t n, void *to)
{
	struct answer *answer = to;
	n *= size;
	answer->body = realloc(answer->body, answer->length + n + 1);
	assert_non_null(answer->body);
	memcpy(answer->body + answer->length, bytes, n);
	answer->length += n;
	answer->body[answer->length] = '\0';
	return n;
}

static size_t receive_header(char *line, size_t size, size_t n, void *to)
{
	struct answer *answer = to;
	const struct {
		const char *name;
		char *value;
		size_t size;
	} kept[] = {{"Location: ", answer->location, sizeof answer->location},
	            {"Content-Type: ", answer->type, sizeof answer->type},
	            {"Allow: ", answer->allow, sizeof answer->allow},
	            {"ETag: ", answer->etag, sizeof answer->etag},
	            {"Retry-After: ", answer->retry_after, sizeof answer->retry_after}};
	for (size_t i = 0; i < sizeof kept / sizeof kept[0]; i++) {
		size_t name = strlen(kept[i].name);
		if (n > name + 2 && !strncasecmp(line, kept[i].name, name))
			snprintf(kept[i].value, kept[i].size, "%.*s", (int)(n - name - 2), line + name);
	}
	return size * n;
}

struct answer service_ask(const struct service *service, const struct ask *ask)
{
	struct answer answer = {0};
	struct curl_slist *headers = NULL;
	char url[8192];
	long status;
	CURL *curl = curl_easy_init();
	assert_non_null(curl);
	snprintf(url, sizeof url, "http://127.0.0.1:%d%s", service->port, ask->path);
	receive("", 1, 0, &answer); // an answer without a body has an empty one
	curl_easy_setopt(curl, CURLOPT_URL, url);
	curl_easy_setopt(curl, CURLOPT_PROXY, "");
	curl_easy_setopt(curl, CURLOPT_PATH_AS_IS, 1L);
	curl_easy_setopt(curl, CURLOPT_TIMEOUT, 60L);
	curl_easy_setopt(curl, CURLOPT_WRITEFUNCTION, receive);
	curl_easy_setopt(curl, CURLOPT_WRITEDATA, &answer);
	curl_easy_setopt(curl, CURLOPT_HEADERFUNCTION, receive_header);
	curl_easy_setopt(curl, CURLOPT_HEADERDATA, &answer);
	if (ask->body) {
		curl_easy_setopt(curl, CURLOPT_POSTFIELDSIZE_LARGE, (curl_off_t)ask->length);
		curl_easy_setopt(curl, CURLOPT_POSTFIELDS, ask->body);
	}
	curl_easy_setopt(curl, CURLOPT_NOBODY, (long)!strcmp(ask->method, "HEAD"));
	curl_easy_setopt(curl, CURLOPT_CUSTOMREQUEST, ask->method);
	for (size_t i = 0; i < sizeof ask->headers / sizeof ask->headers[0]; i++)
		if (ask->headers[i])
			headers = curl_slist_append(headers, ask->headers[i]);
	curl_easy_setopt(curl, CURLOPT_HTTPHEADER, headers);
	CURLcode code = curl_easy_perform(curl);
	if (code != CURLE_OK && !ask->may_fail)
		fail_msg("%s %s: %s", ask->method, ask->path, curl_easy_strerror(code));
	curl_easy_getinfo(curl, CURLINFO_RESPONSE_CODE, &status);
	answer.status = code == CURLE_OK ? (int)status : 0;
	curl_slist_free_all(headers);
	curl_easy_cleanup(curl);
	return answer;
}

struct answer service_get(const struct service *service, const char *format, ...)
{
	char path[256];
	va_list values;
	va_start(values, format);
	vsnprintf(path, sizeof path, format, values);
	va_end(values);
	return service_ask(service, &(struct ask){.method = "GET", .path = path});
}

struct answer service_post(const struct service *service, const char *study)
{
	return service_ask(service, &(struct ask){.method = "POST",
	                                          .path = "/v1/studies",
	                                          .headers = {"Content-Type: application/json"},
	                                          .body = study,
	                                          .length = strlen(study)});
}

struct answer service_post_keyed(const struct service *service, const char *study, const char *key)
{
	char header[500];
	snprintf(header, sizeof header, "Idempotency-Key: %s", key ? key : "");
	return service_ask(service,
	                   &(struct ask){.method = "POST",
	                                 .path = "/v1/studies",
	                                 .headers = {"Content-Type: application/json", key ? header : NULL},
	                                 .body = study,
	                                 .length = strlen(study),
	                                 .may_fail = true});
}

void answer_free(struct answer *answer)
{
	free(answer->body);
	*answer = (struct answer){0};
}

struct reading *answer_read(const struct answer *answer)
{
	struct reading *reading = reading_open(answer->body, answer->length);
	if (!reading)
		fail_msg("not JSON: %.200s", answer->body);
	return reading;
}

void service_submit(const struct service *service, const char *study, char id[17])
{
	static const char path[] = "/v1/studies/";
	struct answer created = service_post(service, study);
	if (created.status != 201)
		fail_msg("%d instead of 201: %s", created.status, created.body);
	assert_int_equal(strncmp(created.location, path, strlen(path)), 0);
	assert_int_equal(strlen(created.location), strlen(path) + 16);
	strcpy(id, created.location + strlen(path));
	answer_free(&created);
}

bool service_wait(const struct service *service, const char *id, const char *status, double runs)
{
	const struct timespec pause = {.tv_nsec = 5000000};
	time_t start = time(NULL);
	while (time(NULL) < start + WAIT_MAX_S) {
		struct answer answer = service_get(service, "/v1/studies/%s", id);
		assert_int_equal(answer.status, 200);
		struct reading *now = answer_read(&answer);
		bool there = !strcmp(reading_text(now, "/status"), status);
		bool over = reading_text(now, "/finished") != NULL;
		bool far = reading_number(now, "/runs_done") >= runs;
		reading_close(now);
		answer_free(&answer);
		if ((there && far) || over)
			return there;
		nanosleep(&pause, NULL);
	}
	fail_msg("study %s is not %s after %d s", id, status, WAIT_MAX_S);
	return false;
}

char *service_text(const struct service *service, const char *sql)
{
	sqlite3 *db;
	sqlite3_stmt *query;
	assert_int_equal(sqlite3_open_v2(service->database, &db, SQLITE_OPEN_READONLY, NULL), SQLITE_OK);
	sqlite3_db_config(db, SQLITE_DBCONFIG_NO_CKPT_ON_CLOSE, 1, NULL);
	sqlite3_busy_timeout(db, 5000);
	assert_int_equal(sqlite3_prepare_v2(db, sql, -1, &query, NULL), SQLITE_OK);
	assert_int_equal(sqlite3_step(query), SQLITE_ROW);
	const unsigned char *value = sqlite3_column_text(query, 0);
	char *text = strdup(value ? (const char *)value : "");
	sqlite3_finalize(query);
	sqlite3_close(db);
	return text;
}

int64_t service_number(const struct service *service, const char *sql)
{
	char *text = service_text(service, sql);
	int64_t number = strtoll(text, NULL, 10);
	free(text);
	return number;
}

void service_change(const struct service *service, const char *sql)
{
	sqlite3 *db;
	assert_int_equal(service->pid, 0);
	assert_int_equal(sqlite3_open(service->database, &db), SQLITE_OK);
	assert_int_equal(sqlite3_exec(db, sql, NULL, NULL, NULL), SQLITE_OK);
	assert_int_equal(sqlite3_close(db), SQLITE_OK);
}

void service_erase(const struct service *service)
{
	static const char *const ends[] = {"", "-wal", "-shm"};
	char path[256];
	assert_int_equal(service->pid, 0);
	for (size_t i = 0; i < sizeof ends / sizeof ends[0]; i++) {
		snprintf(path, sizeof path, "%s%s", service->database, ends[i]);
		unlink(path);
	}
}

double service_resident_mb(const struct service *service)
{
	char path[64];
	long pages = 0;
	snprintf(path, sizeof path, "/proc/%d/statm", (int)service->pid);
	FILE *file = fopen(path, "r");
	assert_non_null(file);
	assert_int_equal(fscanf(file, "%*d %ld", &pages), 1);
	fclose(file);
	return 1e-6 * (double)pages * (double)sysconf(_SC_PAGESIZE);
}

char *service_study(int rows, int signals, int seed)
{
	static const char form[] =
	    "{\"kind\": \"sensitivity\", \"name\": \"study %d\",\n"
	    " \"scene\": {\"oscillators\": [{\"frequency_hz\": 2}, {\"frequency_hz\": 3.1}],\n"
	    "  \"excitation\": {\"type\": \"kanai_tajimi\", \"frequency_hz\": 5, \"cycles\": 10, \"signals\": "
	    "%d}},\n"
	    " \"inputs\": [\n"
	    "  {\"path\": \"/oscillators/1/frequency_hz\", \"distribution\": {\"type\": \"uniform\", \"min\": "
	    "0.5, \"max\": 5}},\n"
	    "  {\"path\": \"/oscillators/1/mass_kg\", \"distribution\": {\"type\": \"uniform\", \"min\": 1, "
	    "\"max\": 6}},\n"
	    "  {\"path\": \"/contact/restitution\", \"distribution\": {\"type\": \"uniform\", \"min\": 0, "
	    "\"max\": 1}}],\n"
	    " \"design\": {\"rows\": %d, \"seed\": %d},\n"
	    " \"outputs\": [\"force_amplification\", \"impulse\"]}\n";
	char *study = NULL;
	assert_true(asprintf(&study, form, seed, signals, rows, seed) > 0);
	return study;
}

char *service_timeless(char *result)
{
	char *line = strstr(result, "\n  \"timing\":");
	assert_non_null(line);
	char *rest = strchr(line + 1, '\n');
	assert_non_null(rest);
	memmove(line, rest, strlen(rest) + 1);
	return result;
}

static char *body_of(const struct service *service, const char *path, const char *id)
{
	struct answer answer = service_get(service, path, id);
	if (answer.status != 200)
		fail_msg("%s: %d instead of 200: %s", path, answer.status, answer.body);
	return answer.body;
}

struct service_bytes service_bytes(const struct service *service, const char *id)
{
	return (struct service_bytes){service_timeless(body_of(service, "/v1/studies/%s/results", id)),
	                              body_of(service, "/v1/studies/%s/samples", id)};
}

struct service_bytes service_uninterrupted(const char *study, int n_workers)
{
	struct service *service = service_new();
	char id[17];
	service_start(service, n_workers);
	service_submit(service, study, id);
	assert_true(service_wait(service, id, "succeeded", 0));
	struct service_bytes bytes = service_bytes(service, id);
	service_stop(service);
	service_free(service);
	return bytes;
}

void service_histories(const struct service *service, int signals, char id[17])
{
	static const char format[] =
	    "{\"kind\": \"floor_spectrum\", \"scene\": {\"oscillators\": [{\"frequency_hz\": 2}, "
	    "{\"frequency_hz\": 3}], \"excitation\": {\"type\": \"kanai_tajimi\", \"frequency_hz\": 1, "
	    "\"cycles\": 20, \"signals\": %d}}, \"spectrum\": {\"frequencies_hz\": [1]}, \"histories\": true}";
	char study[sizeof format + 16];
	snprintf(study, sizeof study, format, signals);
	service_submit(service, study, id);
	assert_true(service_wait(service, id, "succeeded", 0));
}

void service_bytes_compare(struct service_bytes *bytes, const struct service_bytes *reference)
{
	assert_string_equal(bytes->result, reference->result);
	assert_string_equal(bytes->samples, reference->samples);
	free(bytes->result);
	free(bytes->samples);
}

int service_setup(void **state)
{
	struct service *service = service_new();
	service_start(service, 2);
	*state = service;
	return 0;
}

int service_teardown(void **state)
{
	struct service *service = *state;
	if (service->pid)
		service_stop(service);
	service_free(service);
	return 0;
}
