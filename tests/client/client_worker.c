/* `pound run --launcher': the result has the same bytes whichever process runs the blocks, also when launchers fail and
 * when workers or the coordinator are killed.
 *
 * A checkpoint has one record for each block accepted as done.  The tests count records: a block without a record is
 * lost, a block with two records is doubled. */
#include <fcntl.h>
#include <signal.h>
#include <string.h>
#include <sys/stat.h>
#include <time.h>
#include <unistd.h>

#include "engine/pound.h"
#include "tests/support/check.h"
#include "tests/support/groups.h"
#include "tests/support/program.h"
#include "tests/support/service.h"
#include "tests/support/study_documents.h"

#define POUND(...) program_run((const char *const[]){"pound", __VA_ARGS__, NULL}, NULL)

enum {
	ROWS = 4 * SERVICE_ROWS, /* of the disturbed study: half a second on one core */
	GONE_MS = 5000,          /* limit for workers to exit after their coordinator */
};

static struct {
	char directory[32];
	char study[64], checkpoint[64], pids[64], out[64], err[64]; /* files in `directory` */
	char launcher[256]; /* command of a worker with one thread; writes its process id to `pids` */
	char *reference;    /* the result without workers */
	int n_blocks;
	size_t size; /* of the complete checkpoint [bytes] */
} world;

/* Size of the checkpoint [bytes]; 0: no such file. */
static size_t checkpoint_size(void)
{
	struct stat about;
	return stat(world.checkpoint, &about) == 0 ? (size_t)about.st_size : 0;
}

static struct program_outcome run_with(const char *launcher, const char *launchers)
{
	return POUND("run", "--threads", "1", "--launcher", launcher, "--launchers", launchers, "--checkpoint",
	             world.checkpoint, world.study);
}

/* Fails unless the run gave the reference result and its checkpoint has one record for each block. */
static void check_same(struct program_outcome *outcome)
{
	int n_once, n_more;
	program_expect(outcome, 0);
	if (strcmp(service_timeless(outcome->out), world.reference) != 0)
		fail_msg("other bytes than without workers");
	groups_records(world.checkpoint, &n_once, &n_more);
	assert_int_equal(n_more, 0);
	assert_int_equal(n_once, world.n_blocks);
}

static int setup(void **state)
{
	int n_more;
	(void)state;
	strcpy(world.directory, "/tmp/pound-test-XXXXXX");
	assert_non_null(mkdtemp(world.directory));
	snprintf(world.study, sizeof world.study, "%s/study.json", world.directory);
	snprintf(world.checkpoint, sizeof world.checkpoint, "%s/blocks", world.directory);
	snprintf(world.pids, sizeof world.pids, "%s/pids", world.directory);
	snprintf(world.out, sizeof world.out, "%s/out", world.directory);
	snprintf(world.err, sizeof world.err, "%s/err", world.directory);
	const char *build = getenv("POUND_BUILD");
	snprintf(world.launcher, sizeof world.launcher, "echo $$ >>%s; exec %s/pound-worker --threads 1",
	         world.pids, build ? build : "build/release");
	char *study = service_study(ROWS, 5, 1);
	groups_write(world.study, study);
	free(study);
	struct program_outcome alone =
	    POUND("run", "--threads", "1", "--checkpoint", world.checkpoint, world.study);
	program_expect(&alone, 0);
	assert_string_equal(alone.err, "");
	world.reference = strdup(service_timeless(alone.out));
	program_free(&alone);
	groups_records(world.checkpoint, &world.n_blocks, &n_more);
	assert_true(world.n_blocks >= 20 && n_more == 0);
	world.size = checkpoint_size();
	unlink(world.checkpoint);
	return 0;
}

static int teardown(void **state)
{
	const char *const files[] = {world.study, world.checkpoint, world.pids, world.out, world.err};
	(void)state;
	for (size_t i = 0; i < sizeof files / sizeof files[0]; i++)
		unlink(files[i]);
	free(world.reference);
	return rmdir(world.directory);
}

/* Whether an example takes too long for this test. */
static bool is_long(const char *name)
{
	return strncmp(name, "paper", 5) == 0;
}

static void every_example_gives_the_same_bytes_with_any_number_of_groups(void **state)
{
	static const char *const launchers[] = {"1", "4"};
	struct program_outcome names = POUND("example", "--names");
	int n_examples = 0, n_runs = 0, n_blocks = 0;
	(void)state;
	for (char *name = strtok(names.out, "\n"); name; name = strtok(NULL, "\n")) {
		struct program_outcome document = POUND("example", name);
		groups_write(world.out, document.out);
		const bool runs = !is_long(name) && strstr(document.out, "\"scene\"");
		program_free(&document);
		if (!runs)
			continue;
		struct program_outcome alone = POUND("run", "--threads", "1", world.out);
		program_expect(&alone, 0);
		service_timeless(alone.out);
		const bool stays = strncmp(name, "convergence", 11) == 0; // its result contains CPU times: no workers
		for (int i = 0; i < 2; i++) {
			struct program_outcome outcome = POUND("run", "--threads", "1", "--launcher", world.launcher,
			                                       "--launchers", launchers[i], world.out);
			program_expect(&outcome, 0);
			if (stays)
				assert_non_null(strstr(outcome.err, "no workers are started"));
			else {
				assert_string_equal(service_timeless(outcome.out), alone.out);
				n_blocks += groups_blocks(outcome.err);
				n_runs++;
			}
			program_free(&outcome);
		}
		program_free(&alone);
		n_examples++;
	}
	program_free(&names);
	check_report("examples: %d, by 0, 1 and 4 groups; %d runs with groups, which ran %d blocks; "
	             "results that differ 0",
	             n_examples, n_runs, n_blocks);
	assert_true(n_examples > 10 && n_blocks > n_examples);
}

static pid_t run_start(const char *launcher, const char *launchers)
{
	return program_start((const char *const[]){"pound", "run", "--threads", "1", "--launcher", launcher,
	                                           "--launchers", launchers, "--checkpoint", world.checkpoint,
	                                           world.study, NULL},
	                     world.out, world.err);
}

/* Waits for the end of a run; returns its outcome. */
static struct program_outcome run_end(pid_t pid)
{
	struct program_outcome outcome = {.status = program_end(pid)};
	outcome.out = program_file(world.out, &outcome.n_out);
	outcome.err = program_file(world.err, &outcome.n_err);
	return outcome;
}

/* Waits until the checkpoint of a run has at least this size; false: the run has ended. */
static bool grown(pid_t pid, size_t size)
{
	while (checkpoint_size() < size && !groups_is_gone(pid))
		usleep(500);
	return !groups_is_gone(pid);
}

static void killed_workers_lose_no_block_and_double_none(void **state)
{
	const int n = check_count(20, 500);
	int n_blocks = 0, midway = 0, noticed = 0;
	(void)state;
	srand(1);
	for (int i = 0; i < n; i++) {
		pid_t pids[GROUPS_PIDS_MAX];
		unlink(world.pids);
		unlink(world.checkpoint);
		pid_t pid = run_start(world.launcher, "2");
		groups_wait(world.pids, 2, pids);
		midway += grown(pid, (size_t)rand() % world.size) && kill(pids[rand() % 2], SIGKILL) == 0;
		struct program_outcome outcome = run_end(pid);
		check_same(&outcome);
		n_blocks += groups_blocks(outcome.err);
		noticed += strstr(outcome.err, "ended") != NULL;
		program_free(&outcome);
	}
	check_report("workers killed while they ran: %d, noticed %d; blocks %d, of them run by workers %d; "
	             "lost 0, doubled 0, results that differ 0",
	             midway, noticed, n * world.n_blocks, n_blocks);
	assert_true(midway > n / 2 && noticed > 0 && n_blocks > 0);
}

static void a_killed_coordinator_goes_on_from_its_checkpoint_and_its_workers_end(void **state)
{
	const int n = check_count(20, 500);
	int kills = 0, finished = 0, restored = 0;
	double gone_most = 0;
	(void)state;
	srand(2);
	unlink(world.checkpoint);
	while (kills < n || finished == 0) {
		unlink(world.pids);
		unlink(world.out); // a result of the previous run
		pid_t pid = run_start(world.launcher, "2");
		// about four kills per study, some of them before its first block
		const size_t more = (size_t)rand() % (world.size / 2);
		if (kills < n && grown(pid, checkpoint_size() + more) && kill(pid, SIGKILL) == 0)
			kills++;
		struct program_outcome outcome = run_end(pid);
		const double killed = groups_now();
		groups_gone(world.pids, GONE_MS);
		gone_most = groups_now() - killed > gone_most ? groups_now() - killed : gone_most;
		if (outcome.status == 0) {
			check_same(&outcome);
			finished++;
			unlink(world.checkpoint);
		} else {
			assert_int_equal(outcome.status, 128 + SIGKILL);
			restored += access(world.checkpoint, F_OK) == 0;
		}
		program_free(&outcome);
	}
	check_report("coordinators killed: %d, of them with blocks to go on with %d; studies finished %d; "
	             "workers were gone "
	             "after %.2f s at most; blocks lost 0, doubled 0, results that differ 0",
	             kills, restored, finished, gone_most);
	assert_true(restored > n / 2);
}

/* ---- launchers that fail, wait or send invalid messages ---- */

// a worker in bash: CONNECT opens the connection; READY sends the token and a READY message with one thread and a
// version of at most 9 characters
#define CONNECT "IFS=: read -r host port token <<<$POUND_WORKER; exec 3<>/dev/tcp/$host/$port; "
#define ZEROS_8 "\\0\\0\\0\\0\\0\\0\\0\\000" // three octal digits: another digit may follow
#define READY(version)                                                                             \
	"version=" version                                                                             \
	"; printf \"$token\\1\\0\\0\\0\\1\\0\\0\\0\\0\\0\\0\\0\\x${#version}\\0\\0\\0" ZEROS_8 ZEROS_8 \
	"$version\" >&3; "
// reads the header of the STUDY message and answers with the digest of another design
#define DESIGN                                                                           \
	"head -c 32 <&3 >/dev/null; printf "                                                 \
	"'\\3\\0\\0\\0\\0\\0\\0\\0\\0\\0\\0\\0\\40\\0\\0\\0\\1\\0\\0\\0\\0\\0\\0\\0" ZEROS_8 \
	"another design, of 32 characters' >&3; "

static const struct {
	const char *what;
	const char *command; /* a bash script */
	const char *reports; /* text expected in stderr */
} launchers[] = {
    {"a launcher that fails", "false", "its launcher ended with status 1 and without a connection"},
    {"a command that is not there", "/nonexistent/pound-worker", "its launcher ended with status 127"},
    {"a launcher that waits", "sleep 99", "worker groups ran 0 of"},
    {"a launcher that waits and takes no SIGTERM", "trap '' TERM; sleep 99; true", "worker groups ran 0 of"},
    {"another version", CONNECT READY("9.9.9") "cat <&3 >/dev/null",
     "refused: pound-worker has version 9.9.9, this program"},
    {"another token",
     "token=$(printf %064d 7);" CONNECT "token=$(printf %064d 7);" READY(POUND_VERSION) "cat <&3 >/dev/null",
     "worker groups ran 0 of"},
    {"no greeting", CONNECT "printf \"$token\" >&3; head -c 1000 /dev/urandom >&3; cat <&3 >/dev/null",
     "its first message is not the greeting"},
    {"another design", CONNECT READY(POUND_VERSION) DESIGN "cat <&3 >/dev/null",
     "refused for this study: its design differs"},
    {"bytes without sense", CONNECT READY(POUND_VERSION) "head -c 5000 /dev/urandom >&3; cat <&3 >/dev/null",
     "the connection ended"},
    {"a worker that goes away with blocks", CONNECT READY(POUND_VERSION) "head -c 32 <&3 >/dev/null",
     "the connection ended"},
};

static void whatever_a_launcher_does_the_bytes_are_the_same(void **state)
{
	double most = 0;
	(void)state;
	for (size_t i = 0; i < sizeof launchers / sizeof launchers[0]; i++) {
		char command[1024];
		groups_write(world.err, launchers[i].command);
		snprintf(command, sizeof command, "exec bash %s", world.err);
		unlink(world.checkpoint);
		double start = groups_now();
		struct program_outcome outcome = run_with(command, "1");
		most = groups_now() - start > most ? groups_now() - start : most;
		check_same(&outcome);
		if (!strstr(outcome.err, launchers[i].reports))
			fail_msg("%s: '%s' is not in\n%s", launchers[i].what, launchers[i].reports, outcome.err);
		assert_int_equal(groups_blocks(outcome.err), 0);
		program_free(&outcome);
	}
	check_report(
	    "launchers that fail, wait or send what is wrong: %d; results that differ 0; longest run %.1f s",
	    (int)(sizeof launchers / sizeof launchers[0]), most);
}

static void a_late_worker_takes_part(void **state)
{
	char command[320];
	(void)state;
	snprintf(command, sizeof command, "sleep 0.05; %s", world.launcher);
	unlink(world.checkpoint);
	struct program_outcome outcome = run_with(command, "2");
	check_same(&outcome);
	assert_non_null(strstr(outcome.err, "worker group 2: connected, 1 thread\n"));
	assert_true(groups_blocks(outcome.err) > 0);
	program_free(&outcome);
}

/* --worker-host sets the host name in POUND_WORKER, by which workers on other machines connect. */
static void workers_connect_to_the_host_that_the_user_names(void **state)
{
	char command[640];
	(void)state;
	snprintf(command, sizeof command, "case $POUND_WORKER in localhost:*) ;; *) exit 9;; esac; %s",
	         world.launcher);
	struct program_outcome outcome =
	    POUND("run", "--threads", "1", "--worker-host", "localhost", "--launcher", command, world.study);
	program_expect(&outcome, 0);
	assert_string_equal(service_timeless(outcome.out), world.reference);
	assert_non_null(strstr(outcome.err, "worker group 1: connected, 1 thread\n"));
	program_free(&outcome);
	char host[600];
	memset(host, 'a', sizeof host - 1);
	host[sizeof host - 1] = '\0';
	outcome = POUND("run", "--threads", "1", "--worker-host", host, "--launcher", command, world.study);
	assert_non_null(strstr(outcome.err, "the name of --worker-host is too long"));
	program_free(&outcome);
	outcome = POUND("run", "--worker-host", "localhost", world.study);
	program_expect(&outcome, 2);
	program_free(&outcome);
}

static bool connected(const char *log)
{
	char *text = program_file(log, &(size_t){0});
	const bool found = text && strstr(text, ": connected, ");
	free(text);
	return found;
}

static void blocks_of_a_worker_that_does_not_go_on_run_elsewhere(void **state)
{
	pid_t pids[GROUPS_PIDS_MAX];
	(void)state;
	unlink(world.pids);
	unlink(world.checkpoint);
	double start = groups_now();
	pid_t pid = run_start(world.launcher, "1");
	groups_wait(world.pids, 1, pids);
	// a worker holds blocks from its connection until nearly the end of the study
	while (!connected(world.err) && !groups_is_gone(pid))
		usleep(1000);
	assert_true(grown(pid, checkpoint_size() + world.size / 8));
	assert_int_equal(kill(pids[0], SIGSTOP), 0);
	struct program_outcome outcome = run_end(pid);
	check_same(&outcome);
	check_report("a worker that was stopped with blocks: the run ended after %.1f s, same bytes",
	             groups_now() - start);
	assert_true(groups_is_gone(pids[0]));
	program_free(&outcome);
}

/* ---- checkpoints ---- */

static void bytes_write(const char *bytes, size_t n)
{
	FILE *file = fopen(world.checkpoint, "w");
	assert_non_null(file);
	assert_int_equal(fwrite(bytes, 1, n, file), n);
	assert_int_equal(fclose(file), 0);
}

static void a_checkpoint_cut_at_any_byte_of_its_last_record_goes_on_to_the_same_bytes(void **state)
{
	// a response study of 5 gaps: few blocks, and a short last record
	struct program_outcome document = POUND("example", "gap");
	(void)state;
	groups_write(world.out, document.out);
	program_free(&document);
	unlink(world.checkpoint);
	struct program_outcome whole =
	    POUND("run", "--threads", "1", "--checkpoint", world.checkpoint, world.out);
	program_expect(&whole, 0);
	service_timeless(whole.out);
	const size_t n = checkpoint_size();
	char *bytes = program_file(world.checkpoint, &(size_t){0});
	uint32_t place[2];
	size_t at = strcspn(bytes, "\n") + 1, last = at;
	while (at < n) {
		last = at;
		memcpy(place, bytes + at, sizeof place);
		at += sizeof place + 32 + place[1] * sizeof(double);
	}
	const size_t step = (n - last) / 60 + 1;
	int cuts = 0;
	for (size_t cut = last; cut <= n; cut += cut + step > n && cut < n ? n - cut : step, cuts++) {
		bytes_write(bytes, cut);
		struct program_outcome outcome =
		    POUND("run", "--threads", "1", "--checkpoint", world.checkpoint, world.out);
		program_expect(&outcome, 0);
		assert_string_equal(service_timeless(outcome.out), whole.out);
		assert_int_equal(checkpoint_size(), n);
		program_free(&outcome);
	}
	// one bit of the last record changed
	for (size_t i = last; i < n; i += step, cuts++) {
		bytes[i] ^= 4;
		bytes_write(bytes, n);
		bytes[i] ^= 4;
		struct program_outcome outcome =
		    POUND("run", "--threads", "1", "--checkpoint", world.checkpoint, world.out);
		program_expect(&outcome, 0);
		assert_string_equal(service_timeless(outcome.out), whole.out);
		program_free(&outcome);
	}
	check_report("checkpoints cut or changed in their last record: %d; results that differ 0", cuts);
	free(bytes);
	program_free(&whole);
}

static void a_checkpoint_of_another_study_or_program_is_refused(void **state)
{
	static const char *const others[] = {"pound checkpoint 0.0.1 0123456789abcdef\n", "something else\n"};
	static const char *const words[] = {"another study or another version", "not a checkpoint file"};
	(void)state;
	for (int i = 0; i < 2; i++) {
		bytes_write(others[i], strlen(others[i]));
		size_t n = checkpoint_size();
		struct program_outcome outcome = POUND("run", "--checkpoint", world.checkpoint, world.study);
		program_expect(&outcome, 1);
		assert_string_equal(outcome.out, "");
		if (i == 1 && !strstr(outcome.err, words[i]))
			fail_msg("%s", outcome.err);
		assert_int_equal(checkpoint_size(), n);
		program_free(&outcome);
	}
	unlink(world.checkpoint);
	struct program_outcome document = POUND("example", "gap");
	groups_write(world.out, document.out);
	program_free(&document);
	struct program_outcome other = POUND("run", "--checkpoint", world.checkpoint, world.out);
	program_expect(&other, 0);
	program_free(&other);
	other = POUND("run", "--checkpoint", world.checkpoint, world.study);
	program_expect(&other, 1);
	assert_non_null(strstr(other.err, words[0]));
	program_free(&other);
}

static void several_ranks_of_pound_run_are_wrong_usage(void **state)
{
	(void)state;
	setenv("OMPI_COMM_WORLD_SIZE", "4", 1);
	struct program_outcome outcome = POUND("run", world.study);
	unsetenv("OMPI_COMM_WORLD_SIZE");
	program_expect(&outcome, 2);
	assert_string_equal(outcome.out, "");
	assert_non_null(strstr(outcome.err, "--launcher"));
	program_free(&outcome);
}

// a token of valid length
#define TOKEN_16 "0123456789abcdef"
#define TOKEN    TOKEN_16 TOKEN_16 TOKEN_16 TOKEN_16

static void a_worker_that_no_launcher_started_says_so(void **state)
{
	(void)state;
	struct program_outcome outcome = program_run((const char *const[]){"pound-worker", NULL}, NULL);
	program_expect(&outcome, 1);
	assert_non_null(strstr(outcome.err, "--launcher"));
	program_free(&outcome);
	setenv("POUND_WORKER", "127.0.0.1:1:" TOKEN, 1);
	outcome = program_run((const char *const[]){"pound-worker", NULL}, NULL);
	program_expect(&outcome, 1);
	assert_non_null(strstr(outcome.err, "cannot connect to 127.0.0.1, port 1: Connection refused; "));
	assert_non_null(strstr(outcome.err, "--worker-host"));
	program_free(&outcome);
	setenv("POUND_WORKER", "nonsense", 1);
	outcome = program_run((const char *const[]){"pound-worker", NULL}, NULL);
	unsetenv("POUND_WORKER");
	program_expect(&outcome, 1);
	assert_non_null(strstr(outcome.err, "POUND_WORKER must be HOST:PORT:TOKEN"));
	program_free(&outcome);
	setenv("OMPI_COMM_WORLD_SIZE", "4", 1);
	outcome = program_run((const char *const[]){"pound-worker", NULL}, NULL);
	unsetenv("OMPI_COMM_WORLD_SIZE");
	program_expect(&outcome, 1);
	assert_non_null(strstr(outcome.err, "this is one of 4 ranks"));
	program_free(&outcome);
	outcome = program_run((const char *const[]){"pound-worker", "--version", NULL}, NULL);
	program_expect(&outcome, 0);
	assert_string_equal(outcome.out, "pound-worker " POUND_VERSION "\n");
	program_free(&outcome);
}

int main(int argc, char **argv)
{
	const struct CMUnitTest tests[] = {
	    cmocka_unit_test(every_example_gives_the_same_bytes_with_any_number_of_groups),
	    cmocka_unit_test(killed_workers_lose_no_block_and_double_none),
	    cmocka_unit_test(a_killed_coordinator_goes_on_from_its_checkpoint_and_its_workers_end),
	    cmocka_unit_test(whatever_a_launcher_does_the_bytes_are_the_same),
	    cmocka_unit_test(a_late_worker_takes_part),
	    cmocka_unit_test(workers_connect_to_the_host_that_the_user_names),
	    cmocka_unit_test(blocks_of_a_worker_that_does_not_go_on_run_elsewhere),
	    cmocka_unit_test(a_checkpoint_cut_at_any_byte_of_its_last_record_goes_on_to_the_same_bytes),
	    cmocka_unit_test(a_checkpoint_of_another_study_or_program_is_refused),
	    cmocka_unit_test(several_ranks_of_pound_run_are_wrong_usage),
	    cmocka_unit_test(a_worker_that_no_launcher_started_says_so)};
	(void)argc;
	setup(NULL);
	int failed = check_run(argv[0], tests, (int)(sizeof tests / sizeof tests[0]));
	teardown(NULL);
	return failed;
}
