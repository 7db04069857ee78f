/* `pound run --worker-listen': the same bytes with workers that are started separately and join or leave at any time.
 *
 * A worker has two processes: one that connects repeatedly, and its child, which serves one connection. */
#include <arpa/inet.h>
#include <signal.h>
#include <string.h>
#include <sys/socket.h>
#include <sys/stat.h>
#include <unistd.h>

#include "engine/pound.h"
#include "tests/support/check.h"
#include "tests/support/groups.h"
#include "tests/support/program.h"
#include "tests/support/service.h"
#include "tests/support/study_documents.h"

enum {
	ROWS = 16 * SERVICE_ROWS, /* of the study: two seconds on one core */
	GONE_MS = 5000,           /* limit for both processes of a worker to exit */
	SEEN_S = 60,              /* limit for an expected text to appear in a file */
};

enum { STUDY, CHECKPOINT, OUT, ERR, TOKEN, OTHER_TOKEN, WORKER_ERR, N_FILES };

static struct {
	char directory[32];
	char files[N_FILES][64]; /* in `directory` */
	char at[32];             /* address that the program listens on */
	char *reference;         /* the result without workers */
	int n_blocks;
} world;

static void token_write(const char *path, char digit)
{
	char token[66] = "";
	memset(token, digit, 64);
	strcat(token, "\n");
	groups_write(path, token);
	assert_int_equal(chmod(path, 0600), 0);
}

static int setup(void **state)
{
	static const char *const names[N_FILES] = {"study.json", "blocks",      "out",       "err",
	                                           "token",      "other-token", "worker-err"};
	char directory[] = "/tmp/pound-test-XXXXXX";
	int n_more;
	(void)state;
	assert_non_null(mkdtemp(directory));
	strcpy(world.directory, directory);
	for (int i = 0; i < N_FILES; i++)
		snprintf(world.files[i], sizeof world.files[i], "%s/%s", directory, names[i]);
	token_write(world.files[TOKEN], 'a');
	token_write(world.files[OTHER_TOKEN], 'b');
	snprintf(world.at, sizeof world.at, "127.0.0.1:%d", groups_port());
	char *study = service_study(ROWS, 5, 1);
	groups_write(world.files[STUDY], study);
	free(study);
	const char *const alone[] = {
	    "pound", "run", "--threads", "1", "--checkpoint", world.files[CHECKPOINT], world.files[STUDY], NULL};
	struct program_outcome outcome = program_run(alone, NULL);
	program_expect(&outcome, 0);
	world.reference = strdup(service_timeless(outcome.out));
	program_free(&outcome);
	groups_records(world.files[CHECKPOINT], &world.n_blocks, &n_more);
	assert_true(world.n_blocks >= 40 && n_more == 0);
	unlink(world.files[CHECKPOINT]);
	return 0;
}

static int teardown(void **state)
{
	(void)state;
	for (int i = 0; i < N_FILES; i++)
		unlink(world.files[i]);
	free(world.reference);
	return rmdir(world.directory);
}

static pid_t worker_start(int token)
{
	return program_start((const char *const[]){"pound-worker", "--threads", "1", "--connect", world.at,
	                                           "--token-file", world.files[token], NULL},
	                     "/dev/null", world.files[WORKER_ERR]);
}

/* The process of a worker that serves a connection; 0: none. */
static pid_t serving(pid_t worker)
{
	char path[64];
	pid_t child = 0;
	snprintf(path, sizeof path, "/proc/%d/task/%d/children", (int)worker, (int)worker);
	FILE *file = fopen(path, "r");
	if (file && fscanf(file, "%d", &child) != 1)
		child = 0;
	if (file)
		fclose(file);
	return child;
}

/* Sends a signal to the process of a worker that connects; fails unless it and its child end. */
static void worker_end(pid_t worker, int signal)
{
	const pid_t child = serving(worker);
	kill(worker, signal);
	assert_int_equal(program_end(worker), 128 + signal);
	for (int ms = 0; child && !groups_is_gone(child); ms++, usleep(1000))
		if (ms > GONE_MS)
			fail_msg("process %d of a worker that was ended is there", (int)child);
}

static pid_t run_start(void)
{
	unlink(world.files[CHECKPOINT]);
	unlink(world.files[ERR]);
	return program_start((const char *const[]){"pound", "run", "--threads", "1", "--worker-listen", world.at,
	                                           "--worker-token-file", world.files[TOKEN], "--checkpoint",
	                                           world.files[CHECKPOINT], world.files[STUDY], NULL},
	                     world.files[OUT], world.files[ERR]);
}

/* Waits until a file contains a text or a run ends (0: no run); false: the run has ended. */
static bool seen(int file, const char *text, pid_t run)
{
	const double start = groups_now();
	for (bool found = false; !found; usleep(1000)) {
		char *all = program_file(world.files[file], &(size_t){0});
		found = all && strstr(all, text);
		free(all);
		if (!found && run && groups_is_gone(run))
			return false;
		if (groups_now() - start > SEEN_S)
			fail_msg("'%s' was not seen in %s", text, world.files[file]);
	}
	return true;
}

/* Fails unless a run gave the reference result and one record for each block; returns the number of blocks run by
 * workers. */
static int check_same(pid_t run)
{
	int n_once, n_more;
	assert_int_equal(program_end(run), 0);
	char *out = program_file(world.files[OUT], &(size_t){0}),
	     *err = program_file(world.files[ERR], &(size_t){0});
	if (strcmp(service_timeless(out), world.reference) != 0)
		fail_msg("other bytes than without workers");
	groups_records(world.files[CHECKPOINT], &n_once, &n_more);
	assert_int_equal(n_more, 0);
	assert_int_equal(n_once, world.n_blocks);
	const int n = groups_blocks(err);
	free(out);
	free(err);
	return n;
}

static void workers_that_others_start_join_and_leave_at_any_time(void **state)
{
	const int n = check_count(6, 300);
	int by_workers = 0, left = 0, came = 0;
	(void)state;
	srand(1);
	for (int i = 0; i < n; i++) {
		pid_t early = worker_start(TOKEN); // before the program listens
		came++;
		usleep((useconds_t)(rand() % 50000));
		pid_t run = run_start(), late = 0;
		if (seen(ERR, "connected, 1 thread, from 127.0.0.1", run)) {
			usleep((useconds_t)(rand() % 200000));
			late = worker_start(TOKEN);
			came++;
			left += !groups_is_gone(run);
			// end the whole worker, or only its child: then the worker connects again
			if (i % 2 == 0)
				worker_end(early, i % 4 ? SIGKILL : SIGTERM), early = 0;
			else {
				const pid_t child = serving(early);
				if (child > 0)
					kill(child, SIGKILL);
			}
		}
		by_workers += check_same(run);
		if (early)
			worker_end(early, SIGKILL);
		if (late)
			worker_end(late, SIGKILL);
	}
	check_report("workers that came before or while a study ran: %d, of them left while it ran %d; blocks "
	             "%d, by workers %d; lost 0, doubled 0, results that differ 0",
	             came, left, n * world.n_blocks, by_workers);
	assert_true(left > n / 2 && by_workers > 0);
}

static void one_worker_computes_for_one_program_after_the_other(void **state)
{
	const pid_t worker = worker_start(TOKEN);
	int by_workers = 0;
	(void)state;
	for (int i = 0; i < 3; i++) {
		const pid_t run = run_start();
		assert_true(seen(ERR, "connected, 1 thread, from", run));
		by_workers += check_same(run);
	}
	assert_true(by_workers > 0);
	assert_false(groups_is_gone(worker));
	worker_end(worker, SIGTERM);
}

static int connection_open(void)
{
	const struct sockaddr_in at = {.sin_family = AF_INET,
	                               .sin_port = htons((uint16_t)atoi(strchr(world.at, ':') + 1)),
	                               .sin_addr.s_addr = htonl(INADDR_LOOPBACK)};
	const int s = socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0);
	assert_true(s >= 0);
	assert_int_equal(connect(s, (const struct sockaddr *)&at, sizeof at), 0);
	return s;
}

static void who_has_not_the_token_gets_no_block_and_keeps_nobody_out(void **state)
{
	int silent[8], wrong;
	(void)state;
	const pid_t run = run_start();
	assert_true(seen(ERR, "workers may connect to 127.0.0.1:", run));
	for (int i = 0; i < 8; i++)
		silent[i] = connection_open();
	wrong = connection_open();
	assert_int_equal(send(wrong, "GET / HTTP/1.1\r\nHost: a\r\n\r\n", 27, MSG_NOSIGNAL), 27);
	shutdown(wrong, SHUT_WR);
	const pid_t worker = worker_start(TOKEN);
	assert_true(seen(ERR, "connected, 1 thread, from 127.0.0.1", run));
	assert_true(serving(worker) > 0);
	const pid_t other = worker_start(OTHER_TOKEN);
	assert_true(seen(ERR, "the token from 127.0.0.1 differs from the one in --worker-token-file", run));
	seen(WORKER_ERR, "pound-worker: refused: the token from 127.0.0.1 differs from", 0);
	assert_true(check_same(run) > 0);
	worker_end(other, SIGTERM);
	worker_end(worker, SIGTERM);
	for (int i = 0; i < 8; i++)
		close(silent[i]);
	close(wrong);
}

static void what_cannot_be_listened_on_is_said_before_the_study_runs(void **state)
{
	static const struct {
		const char *at;
		int token, status;
		const char *says;
	} cases[] = {
	    {"127.0.0.1", TOKEN, 2, "--worker-listen must be an IP address and a port"},
	    {"localhost:8438", TOKEN, 2, "--worker-listen must be an IP address and a port"},
	    {"192.0.2.1:8438", TOKEN, 1, "cannot listen on 192.0.2.1:8438 for workers: Cannot assign"},
	    {"127.0.0.1:0", STUDY, 1, "chmod 600"},
	    {"127.0.0.1:0", CHECKPOINT, 1, "No such file or directory"},
	};
	(void)state;
	unlink(world.files[CHECKPOINT]);
	for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
		struct program_outcome outcome = program_run(
		    (const char *const[]){"pound", "run", "--worker-listen", cases[i].at, "--worker-token-file",
		                          world.files[cases[i].token], world.files[STUDY], NULL},
		    NULL);
		program_expect(&outcome, cases[i].status);
		assert_string_equal(outcome.out, "");
		if (!strstr(outcome.err, cases[i].says))
			fail_msg("'%s' is not in\n%s", cases[i].says, outcome.err);
		program_free(&outcome);
	}
}

static void a_worker_that_cannot_know_where_to_connect_ends(void **state)
{
	static const struct {
		const char *at;
		int token, status;
		const char *says;
	} cases[] = {
	    {"localhost", TOKEN, 1, "--connect must be HOST:PORT"},
	    {"localhost:", TOKEN, 1, "--connect must be HOST:PORT"},
	    {"localhost:99999", TOKEN, 1, "--connect must be HOST:PORT"},
	    {"http://localhost:8438", TOKEN, 1, "--connect must be HOST:PORT"},
	    {"127.0.0.1:1", STUDY, 1, "chmod 600"},
	};
	(void)state;
	for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
		struct program_outcome outcome =
		    program_run((const char *const[]){"pound-worker", "--connect", cases[i].at, "--token-file",
		                                      world.files[cases[i].token], NULL},
		                NULL);
		program_expect(&outcome, cases[i].status);
		if (!strstr(outcome.err, cases[i].says))
			fail_msg("'%s' is not in\n%s", cases[i].says, outcome.err);
		program_free(&outcome);
	}
}

static void wrong_usage_has_one_status_in_every_program(void **state)
{
	static const char *const programs[] = {"pound", "poundd", "pound-worker"};
	(void)state;
	for (size_t i = 0; i < sizeof programs / sizeof programs[0]; i++) {
		struct program_outcome outcome =
		    program_run((const char *const[]){programs[i], "--no-such-option", NULL}, NULL);
		program_expect(&outcome, 2);
		assert_non_null(strstr(outcome.err, "--no-such-option"));
		program_free(&outcome);
	}
}

int main(int argc, char **argv)
{
	const struct CMUnitTest tests[] = {
	    cmocka_unit_test(workers_that_others_start_join_and_leave_at_any_time),
	    cmocka_unit_test(one_worker_computes_for_one_program_after_the_other),
	    cmocka_unit_test(who_has_not_the_token_gets_no_block_and_keeps_nobody_out),
	    cmocka_unit_test(what_cannot_be_listened_on_is_said_before_the_study_runs),
	    cmocka_unit_test(a_worker_that_cannot_know_where_to_connect_ends),
	    cmocka_unit_test(wrong_usage_has_one_status_in_every_program)};
	(void)argc;
	setup(NULL);
	int failed = check_run(argv[0], tests, (int)(sizeof tests / sizeof tests[0]));
	teardown(NULL);
	return failed;
}
