/* Repeated SIGKILL at random moments while a client submits studies, requests their status and fetches results.
 *
 * The client gives every study a key and submits it again until it gets an answer.  At the end each study is stored once,
 * with the result of an undisturbed server.  A result that the client has fetched never changes, its timing included,
 * so it was stored only once. */
#include <signal.h>
#include <string.h>
#include <sys/wait.h>
#include <unistd.h>

#include "schema/json/json_pointer.h"
#include "tests/support/service.h"

enum {
	DOCUMENTS = 4,   /* different documents, with 1 to 4 times ROWS */
	ROWS = 40,       /* x 5 samples x 5 signals: one to three blocks */
	PER_SESSION = 1, /* new studies per session: about what the server can finish in a session */
	SESSIONS_MAX = 1000,
	STEPS = 4,           /* steps of progress before the kill, at most */
	DELAY_US_MAX = 8000, /* delay of the kill after these steps, at most */
	LOOK_US = 5000,      /* between two requests for the status of an unfinished study */
};

static struct submission {
	bool answered;
	char id[17];
	char *result; /* as first fetched; NULL: not yet */
} submissions[SESSIONS_MAX * PER_SESSION];
static int n_submissions;

static char *document_of(int number)
{
	return service_study(ROWS * (1 + number % DOCUMENTS), 5, number % DOCUMENTS);
}

/* Results of an undisturbed server, without their timing. */
static void undisturbed(char *results[DOCUMENTS])
{
	struct service *service = service_new();
	service_start(service, 2);
	for (int d = 0; d < DOCUMENTS; d++) {
		char *study = document_of(d), id[17];
		service_submit(service, study, id);
		assert_true(service_wait(service, id, "succeeded", 0));
		struct answer answer = service_get(service, "/v1/studies/%s/results", id);
		assert_int_equal(answer.status, 200);
		results[d] = service_timeless(answer.body);
		free(study);
	}
	service_stop(service);
	service_free(service);
}

/* Submits study `number`, for the first time or again; false: no answer. */
static bool submit(const struct service *service, int number)
{
	char key[64], *study = document_of(number);
	snprintf(key, sizeof key, "study-%d", number);
	struct answer answer = service_post_keyed(service, study, key);
	struct submission *s = &submissions[number];
	if (answer.status) {
		assert_int_equal(answer.status, 201);
		strcpy(s->id, answer.location + strlen("/v1/studies/"));
		s->answered = true;
	}
	free(study);
	answer_free(&answer);
	return s->answered;
}

/* Requests a result; fails if it differs from the result fetched before.  false: no answer. */
static bool look(const struct service *service, struct submission *s)
{
	char path[64];
	snprintf(path, sizeof path, "/v1/studies/%s/results", s->id);
	struct answer answer =
	    service_ask(service, &(struct ask){.method = "GET", .path = path, .may_fail = true});
	bool answered = answer.status != 0;
	if (answer.status == 200 && !s->result) {
		s->result = answer.body;
		return true;
	}
	if (answer.status == 200)
		assert_string_equal(answer.body, s->result);
	else if (answered) {
		assert_int_equal(answer.status, 404);
		assert_null(s->result);
	}
	answer_free(&answer);
	return answered;
}

/* Finished runs of a study; -1: no answer. */
static double runs_done(const struct service *service, const struct submission *s)
{
	char path[64];
	snprintf(path, sizeof path, "/v1/studies/%s", s->id);
	struct answer answer =
	    service_ask(service, &(struct ask){.method = "GET", .path = path, .may_fail = true});
	double runs = -1;
	if (answer.status) {
		struct reading *status = answer_read(&answer);
		runs = reading_number(status, "/runs_done");
		reading_close(status);
	}
	answer_free(&answer);
	return runs;
}

/* Starts a server, submits studies and requests results until some blocks are done, then goes on until the server is
 * killed. */
static void session(struct service *service)
{
	int mine = 0, steps = rand() % (STEPS + 1), delay = rand() % DELAY_US_MAX;
	double runs_before = 0;
	pid_t killer = 0;
	service_start(service, 2);
	for (bool alive = true; alive;) {
		int first = 0;
		while (first < n_submissions && submissions[first].result)
			first++;
		if (n_submissions > 0 && !submissions[n_submissions - 1].answered)
			alive = submit(service, n_submissions - 1);
		else if (mine++ < PER_SESSION)
			alive = submit(service, n_submissions++);
		else if (first == n_submissions) {
			steps--;
			alive = look(service, &submissions[rand() % n_submissions]);
		} else if ((alive = look(service, &submissions[first])) && !submissions[first].result) {
			double runs = runs_done(service, &submissions[first]);
			alive = runs >= 0;
			steps -= runs > runs_before;
			runs_before = runs;
			usleep(LOOK_US);
		} else
			steps--;
		if (steps <= 0 && !killer && (killer = fork()) == 0) {
			usleep((useconds_t)delay);
			kill(service->pid, SIGKILL);
			_exit(0);
		}
	}
	assert_int_equal(waitpid(killer, NULL, 0), killer);
	service_kill(service);
}

static void kills_lose_no_study_double_none_and_change_no_byte(void **state)
{
	int n = check_count(100, SESSIONS_MAX), differ = 0, seen = 0;
	char *results[DOCUMENTS];
	struct service *service = service_new();
	(void)state;
	srand(1);
	undisturbed(results);
	for (int k = 0; k < n; k++) {
		session(service);
		if (k % 10 == 9) {
			char *check = service_text(service, "PRAGMA integrity_check");
			assert_string_equal(check, "ok");
			free(check);
		}
	}
	int64_t resumed;
	service_start(service, 2);
	assert_true(submissions[n_submissions - 1].answered || submit(service, n_submissions - 1));
	for (int i = 0; i < n_submissions; i++) {
		seen += submissions[i].result != NULL;
		assert_true(service_wait(service, submissions[i].id, "succeeded", 0));
		assert_true(look(service, &submissions[i]));
		differ += strcmp(service_timeless(submissions[i].result), results[i % DOCUMENTS]) != 0;
	}
	service_stop(service);
	resumed = service_number(service, "SELECT count(*) FROM study WHERE attempt > 1");
	check_report(
	    "kills: %d; studies accepted %d, lost 0; %lld went on after a kill, %d results seen before the last; "
	    "results that differ %d",
	    n, n_submissions, (long long)resumed, seen, differ);
	assert_int_equal(differ, 0);
	assert_int_equal(service_number(service, "SELECT count(*) FROM study"), n_submissions);
	assert_int_equal(service_number(service, "SELECT count(*) FROM document WHERE name = 'result'"),
	                 n_submissions);
	// enough studies were interrupted and enough results fetched for the test to mean something
	assert_true(n_submissions >= n / 2 && resumed >= n / 4 && seen > n / 4);
	for (int i = 0; i < n_submissions; i++)
		free(submissions[i].result);
	for (int d = 0; d < DOCUMENTS; d++)
		free(results[d]);
	service_free(service);
}

CHECK_MAIN(cmocka_unit_test(kills_lose_no_study_double_none_and_change_no_byte))
