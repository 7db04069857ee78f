/* Worker groups of several ranks of MPI: the same bytes for any number of ranks, also when one is killed.
 *
 * Skipped without mpirun or without pound-worker-mpi (make MPI=1). */
#include <fcntl.h>
#include <signal.h>
#include <string.h>
#include <time.h>
#include <unistd.h>

#include "tests/support/check.h"
#include "tests/support/groups.h"
#include "tests/support/program.h"
#include "tests/support/service.h"

#define POUND(...) program_run((const char *const[]){"pound", __VA_ARGS__, NULL}, NULL)

enum {
	ROWS = 16000,        /* of the disturbed study: two seconds on one core */
	KILLED_AT_MS = 1000, /* latest kill after the start of the group's processes */
	GONE_MS = 5000,
	SHORT_STUDIES = 40, /* more studies than a group holds at a time */
};

static struct {
	char directory[32], study[64], checkpoint[64], pids[64], out[64], err[64]; /* files in `directory` */
	char *reference;
	int n_blocks;
} world;

static bool there_are_ranks(void)
{
	const char *build = getenv("POUND_BUILD");
	char program[256];
	snprintf(program, sizeof program, "%s/pound-worker-mpi", build ? build : "build/release");
	return access(program, X_OK) == 0 && system("command -v mpirun >/dev/null") == 0;
}

/* A launcher of n_ranks ranks; writes the process ids of mpirun, then of the ranks, to `pids`. */
static const char *launcher(int n_ranks)
{
	static char command[512];
	const char *build = getenv("POUND_BUILD");
	snprintf(command, sizeof command,
	         "echo $$ >>%s; exec mpirun --oversubscribe --bind-to none -n %d -x POUND_WORKER sh -c "
	         "'echo $$ >>%s; exec %s/pound-worker-mpi --threads 1'",
	         world.pids, n_ranks, world.pids, build ? build : "build/release");
	return command;
}

static int setup(void **state)
{
	(void)state;
	// tests may run as root, in a container
	setenv("OMPI_ALLOW_RUN_AS_ROOT", "1", 1);
	setenv("OMPI_ALLOW_RUN_AS_ROOT_CONFIRM", "1", 1);
	strcpy(world.directory, "/tmp/pound-test-XXXXXX");
	assert_non_null(mkdtemp(world.directory));
	snprintf(world.study, sizeof world.study, "%s/study.json", world.directory);
	snprintf(world.checkpoint, sizeof world.checkpoint, "%s/blocks", world.directory);
	snprintf(world.pids, sizeof world.pids, "%s/pids", world.directory);
	snprintf(world.out, sizeof world.out, "%s/out", world.directory);
	snprintf(world.err, sizeof world.err, "%s/err", world.directory);
	char *study = service_study(ROWS, 5, 1);
	groups_write(world.study, study);
	free(study);
	int n_more;
	struct program_outcome alone =
	    POUND("run", "--threads", "1", "--checkpoint", world.checkpoint, world.study);
	program_expect(&alone, 0);
	world.reference = strdup(service_timeless(alone.out));
	program_free(&alone);
	groups_records(world.checkpoint, &world.n_blocks, &n_more);
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

static void one_two_and_four_ranks_give_the_same_bytes(void **state)
{
	static const char *const names[] = {"gap", "rigid_wall", "row_of_three", "sensitivity_small"};
	int n_blocks = 0, n_examples = 0;
	(void)state;
	if (!there_are_ranks())
		skip();
	for (int n = 1; n <= 4; n *= 2) {
		struct program_outcome outcome =
		    POUND("run", "--threads", "1", "--launcher", launcher(n), world.study);
		char words[64];
		program_expect(&outcome, 0);
		assert_string_equal(service_timeless(outcome.out), world.reference);
		snprintf(words, sizeof words, "connected, %d thread", n);
		assert_non_null(strstr(outcome.err, words));
		n_blocks += groups_blocks(outcome.err);
		program_free(&outcome);
	}
	for (size_t i = 0; i < sizeof names / sizeof names[0]; i++) {
		struct program_outcome document = POUND("example", names[i]);
		if (document.status == 0) {
			groups_write(world.out, document.out);
			struct program_outcome alone = POUND("run", "--threads", "1", world.out),
			                       ranks =
			                           POUND("run", "--threads", "1", "--launcher", launcher(4), world.out);
			program_expect(&ranks, 0);
			assert_string_equal(service_timeless(ranks.out), service_timeless(alone.out));
			program_free(&alone);
			program_free(&ranks);
			n_examples++;
		}
		program_free(&document);
	}
	check_report("a study by 1, 2 and 4 ranks, which ran %d blocks, and %d examples by 4: the same bytes; "
	             "processes left 0",
	             n_blocks, n_examples);
	assert_true(n_blocks > 0 && n_examples > 0);
	groups_gone(world.pids, GONE_MS);
}

/* Kills process `which` of a group of four ranks (0: mpirun) after a random time, during their start or later. */
static void kill_one(int which, int *noticed, int *n_blocks)
{
	pid_t pids[GROUPS_PIDS_MAX];
	unlink(world.pids);
	unlink(world.checkpoint);
	pid_t pid =
	    program_start((const char *const[]){"pound", "run", "--threads", "1", "--launcher", launcher(4),
	                                        "--checkpoint", world.checkpoint, world.study, NULL},
	                  world.out, world.err);
	groups_wait(world.pids, 5, pids);
	usleep((useconds_t)(1000 * (rand() % KILLED_AT_MS)));
	kill(pids[which], SIGKILL);
	assert_int_equal(program_end(pid), 0);
	size_t n;
	int n_once, n_more;
	char *out = program_file(world.out, &n), *err = program_file(world.err, &n);
	assert_string_equal(service_timeless(out), world.reference);
	groups_records(world.checkpoint, &n_once, &n_more);
	assert_int_equal(n_more, 0);
	assert_int_equal(n_once, world.n_blocks);
	*noticed += strstr(err, "the connection ended") != NULL || strstr(err, "without a connection") != NULL;
	*n_blocks += groups_blocks(err);
	free(out);
	free(err);
}

static void a_killed_rank_ends_its_group_and_changes_no_byte(void **state)
{
	const int n = check_count(10, 200);
	int noticed = 0, n_blocks = 0;
	double most = 0;
	(void)state;
	if (!there_are_ranks())
		skip();
	srand(1);
	for (int i = 0; i < n; i++) {
		kill_one(i % 5, &noticed, &n_blocks);
		const double gone = groups_gone(world.pids, GONE_MS);
		most = gone > most ? gone : most;
	}
	check_report("ranks or mpirun killed: %d, noticed %d; blocks run by ranks %d; lost 0, doubled 0, results "
	             "that differ 0; processes were gone %.2f s after the end",
	             n, noticed, n_blocks, most);
	assert_true(noticed > n / 2);
}

static void a_server_gives_many_studies_to_a_group_of_ranks(void **state)
{
	char ids[SHORT_STUDIES][17], large_id[17], path[64];
	(void)state;
	if (!there_are_ranks())
		skip();
	unlink(world.pids);
	char *reference_study = service_study(300, 5, 1), *large = service_study(2 * ROWS, 5, 1);
	struct service_bytes reference = service_uninterrupted(reference_study, 1);
	setenv("POUNDD_LAUNCHER", launcher(4), 1);
	struct service *service = service_new();
	service_start(service, 1);
	unsetenv("POUNDD_LAUNCHER");
	service_submit(service, large, large_id);
	assert_true(service_wait(service, large_id, "running", 10000));
	for (int i = 0; i < SHORT_STUDIES; i++)
		service_submit(service, reference_study, ids[i]);
	for (int i = 0; i < SHORT_STUDIES; i++) {
		assert_true(service_wait(service, ids[i], "succeeded", 0));
		struct service_bytes bytes = service_bytes(service, ids[i]);
		service_bytes_compare(&bytes, &reference);
	}
	snprintf(path, sizeof path, "/v1/studies/%s/cancel", large_id);
	struct answer answer = service_ask(service, &(struct ask){.method = "POST", .path = path});
	assert_int_equal(answer.status, 200);
	answer_free(&answer);
	answer = service_get(service, "/metrics");
	assert_non_null(strstr(answer.body, "\npound_worker_groups 1\n"));
	const char *blocks = strstr(answer.body, "\npound_worker_blocks_total ");
	assert_non_null(blocks);
	check_report(
	    "%d studies beside a long one by a server with 4 ranks, which ran %d blocks; results that differ 0",
	    SHORT_STUDIES, atoi(blocks + strlen("\npound_worker_blocks_total ")));
	answer_free(&answer);
	service_stop(service);
	groups_gone(world.pids, GONE_MS);
	service_free(service);
	free(reference.result);
	free(reference.samples);
	free(reference_study);
	free(large);
}

int main(int argc, char **argv)
{
	const struct CMUnitTest tests[] = {cmocka_unit_test(one_two_and_four_ranks_give_the_same_bytes),
	                                   cmocka_unit_test(a_killed_rank_ends_its_group_and_changes_no_byte),
	                                   cmocka_unit_test(a_server_gives_many_studies_to_a_group_of_ranks)};
	(void)argc;
	setup(NULL);
	int failed = check_run(argv[0], tests, (int)(sizeof tests / sizeof tests[0]));
	teardown(NULL);
	return failed;
}
