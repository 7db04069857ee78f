/* Failing disk operations, failing allocations, and kills during a migration.
 *
 * tests/support/preload.c makes the n-th call of a kind fail, for n = 1, 2, 3, ... (allocations: with a step), so that
 * every call fails once. */
#include <limits.h>
#include <nettle/sha2.h>
#include <sqlite3.h>
#include <string.h>
#include <sys/wait.h>
#include <unistd.h>

#include "schema/json/json_pointer.h"
#include "server/options.h"
#include "tests/support/faults.h"
#include "tests/support/program.h"
#include "tests/support/service.h"

/* Studies that the server has accepted. */
struct accepted {
	char (*ids)[17]; /* (n) */
	int n, room, refused;
};

/* Posts a small study; fails unless the server accepts it or refuses it with 500 or 503. */
static void post(const struct service *service, int seed, struct accepted *accepted)
{
	char *study = service_study(2, 1, seed);
	struct answer answer = service_post(service, study);
	if (answer.status == 201) {
		if (accepted->n == accepted->room) {
			accepted->room = 2 * accepted->room + 100;
			accepted->ids = realloc(accepted->ids, (size_t)accepted->room * sizeof accepted->ids[0]);
			assert_non_null(accepted->ids);
		}
		strcpy(accepted->ids[accepted->n++], answer.location + strlen("/v1/studies/"));
	} else {
		assert_true(answer.status == 503 || answer.status == 500);
		assert_true(answer.status == 500 || atoi(answer.retry_after) >= 1);
		accepted->refused++;
	}
	free(study);
	answer_free(&answer);
}

/* Fails unless all accepted studies and a new one finish without a restart. */
static void recover(const struct service *service, struct accepted *accepted)
{
	int n = accepted->n;
	post(service, 0, accepted);
	assert_int_equal(accepted->n, n + 1);
	for (int i = 0; i < accepted->n; i++)
		assert_true(service_wait(service, accepted->ids[i], "succeeded", 0));
}

static void a_disk_that_fails_by_chance_loses_nothing_and_the_server_recovers_by_itself(void **state)
{
	struct service *service = service_new();
	struct faults *faults = faults_new(service->directory);
	struct accepted accepted = {0};
	int n = check_count(100, 1000);
	(void)state;
	service_start(service, 2);
	faults->write_fails = 10;
	faults->sync_fails = 50;
	for (int i = 0; i < n; i++)
		post(service, i, &accepted);
	long failed = faults->disk_failed;
	faults->write_fails = faults->sync_fails = 0;
	long calls = faults->disk_calls;
	recover(service, &accepted);
	check_report(
	    "1 %% of writes and 5 %% of syncs fail: %ld of %ld calls; studies accepted %d, lost 0, refused %d",
	    failed, calls, accepted.n, accepted.refused);
	assert_true(failed > n / 20 && accepted.refused > 0 && accepted.n > n / 2);
	service_stop(service);
	faults_free(faults);
	service_free(service);
	free(accepted.ids);
}

/* The end of a log, from the last line that is not the version of SQLite. */
static const char *said(const char *log)
{
	const char *line = "";
	for (const char *at = log; *at; at += strcspn(at, "\n"), at += *at == '\n')
		if (strncmp(at + strcspn(at, " "), " SQLite ", 8) != 0)
			line = at;
	return line;
}

/* Fails unless a start with exit status 1 gave a reason in the last line of its log; empties the log. */
static void expect_reason(const struct service *service, int status)
{
	char *log = program_file(service->log, NULL);
	if (status == 1 && (!log || !*said(log) || strstr(said(log), "Success")))
		fail_msg("a start was refused without a reason: '%s'", log ? log : "");
	free(log);
	assert_true(truncate(service->log, 0) == 0);
}

/* Starts a server with its n-th call on the disk failing, n = 1, 2, ..., until no call fails; `makes`: each start creates
 * the database.  Returns the number of starts; adds the refused ones to `refused`. */
static int start_on_a_failing_disk(struct service *service, struct faults *faults, bool makes, int *refused)
{
	int starts = 0;
	for (bool failed = true; failed; starts++) {
		if (makes)
			service_erase(service);
		faults->disk_fails_in = starts + 1;
		int status = service_try(service, 1);
		failed = atomic_exchange(&faults->disk_fails_in, 0) <= 0;
		assert_true(status == 0 || (status == 1 && failed));
		expect_reason(service, status);
		*refused += status == 1;
		if (status == 0)
			service_stop(service);
	}
	return starts;
}

static void every_call_on_the_disk_may_fail(void **state)
{
	struct service *service = service_new();
	struct faults *faults = faults_new(service->directory);
	struct accepted accepted = {0};
	int n = check_count(60, 500), refused_starts = 0;
	(void)state;
	int starts = start_on_a_failing_disk(service, faults, true, &refused_starts);
	starts += start_on_a_failing_disk(service, faults, false, &refused_starts);
	service_start(service, 1);
	long before = faults->disk_failed;
	for (int at = 1; at <= n; at++) {
		faults->disk_fails_in = at;
		while (faults->disk_fails_in > 0)
			post(service, at, &accepted);
	}
	long failed = faults->disk_failed - before;
	recover(service, &accepted);
	check_report("the n-th call on the disk fails: at %d starts, of which %d were refused; n = 1 ... %d in "
	             "service, %ld "
	             "failures, studies accepted %d, lost 0, refused %d",
	             starts, refused_starts, n, failed, accepted.n, accepted.refused);
	service_stop(service);
	faults_free(faults);
	service_free(service);
	free(accepted.ids);
}

static void a_copy_that_fails_says_why_and_is_not_left(void **state)
{
	struct service *service = service_new();
	struct faults *faults = faults_new(service->directory);
	struct accepted accepted = {0};
	char path[128];
	const char *const copying[] = {"poundd", "--database", service->database, "--backup", path, NULL};
	int copies = 0, failures = 0;
	(void)state;
	service_start(service, 1);
	recover(service, &accepted);
	service_stop(service);
	snprintf(path, sizeof path, "%s/copy.db", service->directory);
	struct service copy = *service;
	strcpy(copy.database, path);
	for (bool failed = true; failed; copies++) {
		unlink(path);
		faults->disk_fails_in = copies + 1;
		struct program_outcome outcome = program_run(copying, NULL);
		failed = atomic_exchange(&faults->disk_fails_in, 0) <= 0;
		assert_true(outcome.status == 0 || (failed && outcome.status == 1 && *said(outcome.err)));
		assert_int_equal(access(path, F_OK) == 0, outcome.status == 0);
		if (outcome.status == 0) // SQLite tolerates the failure of some calls
			assert_int_equal(service_number(&copy, "SELECT count(*) FROM document"), 2);
		failures += outcome.status;
		program_free(&outcome);
	}
	check_report(
	    "the n-th call on the disk fails: at %d copies, of which %d failed, were reported and removed",
	    copies, failures);
	assert_true(failures > 2);
	// an existing file is not overwritten, even if it is empty
	assert_int_equal(truncate(path, 0), 0);
	struct program_outcome outcome = program_run(copying, NULL);
	program_expect(&outcome, 1);
	assert_non_null(strstr(outcome.err, "File exists"));
	assert_int_equal(access(path, F_OK), 0);
	program_free(&outcome);
	faults_free(faults);
	service_free(service);
	free(accepted.ids);
}

/* A request sent while an allocation fails. */
struct question {
	const char *name, *method, *rest;
	bool fixed; /* the right answer never changes */
};

/* Sends a request for one study after the other while the n-th allocation fails, n = 1, 1 + step, ..., until none fails
 * three times in a row; returns how many requests had a failing allocation. */
static int starve(const struct service *service, struct faults *faults, const struct question *question,
                  char (*ids)[17], int n_ids, int step)
{
	int unanswered = 0, refused = 0, failed = 0, asked = 0;
	char path[128], *study = service_study(2, 1, 1);
	struct answer right = {0};
	if (question->fixed)
		right = service_get(service, question->rest, ids[0]);
	for (int at = 1, spared = 0; spared < 3; at += step) {
		long before = faults->memory_failed;
		snprintf(path, sizeof path, question->rest, ids[asked++ % n_ids]);
		faults->memory_fails_in = at;
		bool posts = !strcmp(question->method, "POST");
		struct answer answer =
		    service_ask(service, &(struct ask){.method = question->method,
		                                       .path = path,
		                                       .headers = {"Content-Type: application/json"},
		                                       .body = posts ? study : NULL,
		                                       .length = posts ? strlen(study) : 0,
		                                       .may_fail = true});
		faults->memory_fails_in = 0;
		unanswered += answer.status == 0;
		refused += answer.status >= 500;
		failed += faults->memory_failed > before;
		spared = faults->memory_failed > before ? 0 : spared + 1;
		if (answer.status != 0 && answer.status != 500 && answer.status != 503)
			assert_true(answer.status == 200 || answer.status == 201);
		if (question->fixed && answer.status == 200) {
			assert_int_equal(answer.length, right.length);
			assert_memory_equal(answer.body, right.body, right.length);
		}
		answer_free(&answer);
	}
	answer_free(&right);
	check_report("the n-th allocation fails: %-10s %4d failures, %3d answered 500 or 503, %3d not answered",
	             question->name, failed, refused, unanswered);
	free(study);
	return failed;
}

static void every_allocation_of_a_request_may_fail(void **state)
{
	static const struct question questions[] = {
	    {"submit", "POST", "/v1/studies", false},
	    {"status", "GET", "/v1/studies/%s", false},
	    {"list", "GET", "/v1/studies", false},
	    {"request", "GET", "/v1/studies/%s/request", true},
	    {"results", "GET", "/v1/studies/%s/results", true},
	    {"table", "GET", "/v1/studies/%s/results?format=csv", true},
	    {"samples", "GET", "/v1/studies/%s/samples", true},
	    {"metrics", "GET", "/metrics", false},
	};
	enum { QUESTIONS = sizeof questions / sizeof questions[0], FRESH = 100 };
	if (!SERVICE_MEMORY)
		skip();
	struct service *service = service_new();
	struct faults *faults = faults_new(service->directory);
	char *study = service_study(20, 1, 1), id[1][17];
	int step = check_soaks() ? 1 : 3;
	(void)state;
	service_start(service, 1);
	service_submit(service, study, id[0]);
	assert_true(service_wait(service, id[0], "succeeded", 0));
	struct answer before = service_get(service, "/v1/studies/%s/results", id[0]);
	int failed = starve(service, faults, &questions[0], id, 1, step);
	// studies accepted meanwhile finish; the status requests below use new studies because a reported status is cached
	struct accepted accepted = {0};
	for (int i = 0; i < FRESH; i++)
		post(service, i, &accepted);
	recover(service, &accepted);
	while (service_number(service, "SELECT count(*) FROM study WHERE finished IS NULL"))
		usleep(5000);
	// SQLite's caches may grow in some rounds; a leak grows in every round
	long left = LONG_MAX;
	for (int round = 0; round < 3; round++) {
		long live = faults->memory_live;
		for (int q = 1; q < QUESTIONS; q++)
			failed += q == 1 ? starve(service, faults, &questions[q], accepted.ids, FRESH, step)
			                 : starve(service, faults, &questions[q], id, 1, step * (1 + 2 * round));
		long grown = faults->memory_live - live;
		left = grown < left ? grown : left;
	}
	struct answer after = service_get(service, "/v1/studies/%s/results", id[0]);
	assert_string_equal(after.body, before.body);
	assert_int_equal(service_number(service, "SELECT count(*) FROM study WHERE status = 'failed'"), 0);
	char *check = service_text(service, "PRAGMA integrity_check");
	assert_string_equal(check, "ok");
	check_report("%d allocations failed; not given back in a round %ld", failed, left);
	assert_true(failed > 200 / step);
	assert_true(left < 5);
	service_stop(service);
	answer_free(&before);
	answer_free(&after);
	faults_free(faults);
	service_free(service);
	free(accepted.ids);
	free(check);
	free(study);
}

static void every_allocation_of_the_start_may_fail(void **state)
{
	if (!SERVICE_MEMORY)
		skip();
	struct service *service = service_new();
	struct faults *faults = faults_new(service->directory);
	// the server's own allocations are among the first and the last OURS; most of those between are SQLite's
	enum { OURS = 150 };
	int starts = 0, refused = 0, step = check_soaks() ? 3 : 29;
	(void)state;
	service_start(service, 1);
	service_stop(service);
	faults->memory_calls = 0;
	service_start(service, 1);
	const long all = faults->memory_calls;
	service_stop(service);
	for (int at = 1, spared = 0; spared < 3; at += at < OURS || at > all - OURS ? 1 : step, starts++) {
		long before = faults->memory_failed;
		faults->memory_fails_in = at;
		int status = service_try(service, 1);
		faults->memory_fails_in = 0;
		// 127: the dynamic loader had no memory for the program
		assert_true(status == 0 || status == 1 || status == 127);
		expect_reason(service, status);
		refused += status != 0;
		spared = faults->memory_failed > before ? 0 : spared + 1;
		// a server never serves with a default in place of a given option
		assert_true(status != 0 || service->port != atoi(options_table[0].absent));
		if (status == 0)
			service_stop(service);
	}
	check_report("the n-th allocation fails at %d starts: %d refused, the others serve", starts, refused);
	faults_free(faults);
	service_free(service);
}

static void put_document(sqlite3 *db, int64_t id, const char *name, const char *content)
{
	struct sha256_ctx hash;
	uint8_t sha256[SHA256_DIGEST_SIZE];
	sqlite3_stmt *add;
	sha256_init(&hash);
	sha256_update(&hash, strlen(name), (const uint8_t *)name);
	sha256_update(&hash, strlen(content), (const uint8_t *)content);
	sha256_digest(&hash, sizeof sha256, sha256);
	assert_int_equal(sqlite3_prepare_v2(db, "INSERT INTO document VALUES (?1, ?2, ?3, ?4)", -1, &add, NULL),
	                 SQLITE_OK);
	sqlite3_bind_int64(add, 1, id);
	sqlite3_bind_text(add, 2, name, -1, SQLITE_STATIC);
	sqlite3_bind_blob(add, 3, sha256, sizeof sha256, SQLITE_STATIC);
	sqlite3_bind_blob(add, 4, content, (int)strlen(content), SQLITE_STATIC);
	assert_int_equal(sqlite3_step(add), SQLITE_DONE);
	sqlite3_finalize(add);
}

enum { OLD_STUDIES = 12 };

/* A database as version 1 left it: finished studies, a running one and a queued one. */
static void make_version_1(const struct service *service)
{
	static const char row[] = "INSERT INTO study (id, status, kind, hash, runs, created, started, finished, "
	                          "attempt, idempotency_key) "
	                          "VALUES (%d, '%s', 'sensitivity', 'hash', 10, 1, 1, %s, 1, 'tower %d')";
	sqlite3 *db;
	char *schema = program_file("tests/cases/store_1.sql", NULL);
	assert_non_null(schema);
	service_erase(service);
	assert_int_equal(sqlite3_open(service->database, &db), SQLITE_OK);
	assert_int_equal(sqlite3_exec(db, "PRAGMA journal_mode = WAL", NULL, NULL, NULL), SQLITE_OK);
	assert_int_equal(sqlite3_exec(db, schema, NULL, NULL, NULL), SQLITE_OK);
	for (int i = 1; i <= OLD_STUDIES; i++) {
		char sql[512], *study = service_study(2, 1, i);
		bool over = i < OLD_STUDIES - 1;
		snprintf(sql, sizeof sql, row, i,
		         over              ? "succeeded"
		         : i < OLD_STUDIES ? "running"
		                           : "queued",
		         over ? "2" : "NULL", i);
		assert_int_equal(sqlite3_exec(db, sql, NULL, NULL, NULL), SQLITE_OK);
		put_document(db, i, "request", study);
		if (over)
			put_document(db, i, "result", "{\"a\": 1}\n");
		free(study);
	}
	sqlite3_close(db);
	free(schema);
}

/* Fails unless an old study posted again with its key is answered with the same study. */
static void expect_same(const struct service *service, int number, const char *id)
{
	char key[64], *study = service_study(2, 1, number);
	snprintf(key, sizeof key, "tower %d", number);
	struct answer answer = service_post_keyed(service, study, key);
	assert_int_equal(answer.status, 201);
	assert_string_equal(answer.location + strlen("/v1/studies/"), id);
	answer_free(&answer);
	free(study);
}

static void a_migration_that_is_killed_anywhere_leaves_the_old_database_or_the_new(void **state)
{
	static const char all[] =
	    "SELECT group_concat(hex(content)) FROM (SELECT content FROM document ORDER BY study, name)";
	static const struct {
		const char *sql; /* 1 after a step of the migration */
		int version;     /* version of the database after the step */
	} added[] = {{"SELECT count(*) FROM pragma_table_info('block') WHERE name = 'wall_s'", 2},
	             {"SELECT count(*) FROM pragma_table_info('study') WHERE name = 'client'", 3},
	             {"SELECT count(*) FROM pragma_table_info('study') WHERE name = 'attempt_kept'", 4},
	             {"SELECT count(*) = 12 FROM study WHERE idempotency_key = ' tower ' || id", 5},
	             {"SELECT count(*) FROM pragma_table_info('study') WHERE name = 'memory'", 6},
	             {"SELECT count(*) FROM sqlite_schema WHERE name = 'record_unnamed'", 7}};
	struct service *service = service_new();
	struct faults *faults = faults_new(service->directory);
	int kills = 0, old = 0;
	(void)state;
	make_version_1(service);
	char *content = service_text(service, all);
	for (int at = 1;; at++) {
		make_version_1(service);
		faults->disk_kills_in = at;
		int status = service_try(service, 1);
		// worker threads write too, so the kill may come when the server already listens
		bool spared = atomic_exchange(&faults->disk_kills_in, 0) > 0;
		if (status == 0 && spared)
			break;
		if (status == 0)
			service_kill(service);
		else
			assert_int_equal(status, 128 + 9);
		kills++;
		char *now = service_text(service, all);
		int64_t version = service_number(service, "PRAGMA user_version");
		assert_string_equal(now, content);
		for (size_t k = 0; k < sizeof added / sizeof added[0]; k++)
			assert_int_equal(service_number(service, added[k].sql), version >= added[k].version);
		assert_true(version >= 1 && version <= 7);
		old += version == 1;
		free(now);
	}
	check_report(
	    "migration: killed at %d places, the database was of the old version after %d, of the new after %d",
	    kills, old, kills - old);
	assert_true(old > 0 && old < kills);
	for (int i = 1; i <= OLD_STUDIES; i++) {
		char id[17];
		snprintf(id, sizeof id, "%016x", i);
		assert_true(service_wait(service, id, "succeeded", 0));
		struct answer answer = service_get(service, "/v1/studies/%s/results", id);
		assert_int_equal(answer.status, 200);
		answer_free(&answer);
		expect_same(service, i, id);
	}
	service_stop(service);
	faults_free(faults);
	service_free(service);
	free(content);
}

CHECK_MAIN(cmocka_unit_test(a_disk_that_fails_by_chance_loses_nothing_and_the_server_recovers_by_itself),
           cmocka_unit_test(every_call_on_the_disk_may_fail),
           cmocka_unit_test(a_copy_that_fails_says_why_and_is_not_left),
           cmocka_unit_test(every_allocation_of_a_request_may_fail),
           cmocka_unit_test(every_allocation_of_the_start_may_fail),
           cmocka_unit_test(a_migration_that_is_killed_anywhere_leaves_the_old_database_or_the_new))
