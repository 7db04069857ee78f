/* Worker groups of several ranks of MPI: the same bytes for any number of ranks, also when one is killed.
 *
 * Skipped where there is no mpirun or no pound-worker-mpi (make MPI=1). */
#include <fcntl.h>
#include <signal.h>
#include <string.h>
#include <time.h>
#include <unistd.h>

#include "tests/support/check.h"
#include "tests/support/program.h"
#include "tests/support/service.h"

#define POUND(...) program_run((const char *const[]){"pound", __VA_ARGS__, NULL}, NULL)

enum {
	ROWS = 4000, /* of the study that is disturbed */
	GONE_MS = 5000,
	PIDS_MAX = 64,
	SHORT_STUDIES = 40, /* more than a group may know at a time */
};

static struct {
	char directory[32], study[64], pids[64], out[64], err[64]; /* files in it */
	char *reference;
} world;

static double now_s(void)
{
	struct timespec now;
	clock_gettime(CLOCK_MONOTONIC, &now);
	return (double)now.tv_sec + 1e-9 * (double)now.tv_nsec;
}

static bool there_are_ranks(void)
{
	const char *build = getenv("POUND_BUILD");
	char program[256];
	snprintf(program, sizeof program, "%s/pound-worker-mpi", build ? build : "build/release");
	return access(program, X_OK) == 0 && system("command -v mpirun >/dev/null") == 0;
}

/* A launcher of so many ranks, whose processes are added to a file: mpirun first. */
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

static void text_write(const char *path, const char *text)
{
	FILE *file = fopen(path, "w");
	assert_non_null(file);
	fputs(text, file);
	assert_int_equal(fclose(file), 0);
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
	snprintf(world.pids, sizeof world.pids, "%s/pids", world.directory);
	snprintf(world.out, sizeof world.out, "%s/out", world.directory);
	snprintf(world.err, sizeof world.err, "%s/err", world.directory);
	char *study = service_study(ROWS, 5, 1);
	text_write(world.study, study);
	free(study);
	struct program_outcome alone = POUND("run", "--threads", "1", world.study);
	program_expect(&alone, 0);
	world.reference = strdup(service_timeless(alone.out));
	program_free(&alone);
	return 0;
}

static int teardown(void **state)
{
	const char *const files[] = {world.study, world.pids, world.out, world.err};
	(void)state;
	for (size_t i = 0; i < sizeof files / sizeof files[0]; i++)
		unlink(files[i]);
	free(world.reference);
	return rmdir(world.directory);
}

static int pids_read(pid_t pids[PIDS_MAX])
{
	int n = 0;
	FILE *file = fopen(world.pids, "r");
	while (file && n < PIDS_MAX && fscanf(file, "%d", &pids[n]) == 1)
		n++;
	if (file)
		fclose(file);
	return n;
}

static bool is_gone(pid_t pid)
{
	char path[64], state = 'X';
	snprintf(path, sizeof path, "/proc/%d/stat", (int)pid);
	FILE *file = fopen(path, "r");
	if (file && fscanf(file, "%*d %*s %c", &state) != 1)
		state = 'X';
	if (file)
		fclose(file);
	return state == 'X' || state == 'Z';
}

/* Waits until all processes of launchers have ended; how long that took [s]. */
static double all_gone(void)
{
	pid_t pids[PIDS_MAX];
	const double start = now_s();
	for (int i = pids_read(pids) - 1; i >= 0; i--)
		while (!is_gone(pids[i])) {
			if (now_s() - start > 1e-3 * GONE_MS)
				fail_msg("process %d is there %d ms later", (int)pids[i], GONE_MS);
			usleep(1000);
		}
	return now_s() - start;
}

static int blocks_elsewhere(const char *err)
{
	const char *line = strstr(err, "worker groups ran ");
	assert_non_null(line);
	return atoi(line + strlen("worker groups ran "));
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
		n_blocks += blocks_elsewhere(outcome.err);
		program_free(&outcome);
	}
	for (size_t i = 0; i < sizeof names / sizeof names[0]; i++) {
		struct program_outcome document = POUND("example", names[i]);
		if (document.status == 0) {
			text_write(world.out, document.out);
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
	all_gone();
}

/* Kills process `which` of a group of four ranks (0: mpirun) after some time. */
static void kill_one(int which, int *noticed, int *n_blocks)
{
	pid_t pids[PIDS_MAX];
	unlink(world.pids);
	pid_t pid = program_start(
	    (const char *const[]){"pound", "run", "--threads", "1", "--launcher", launcher(4), world.study, NULL},
	    world.out, world.err);
	while (pids_read(pids) < 5)
		usleep(1000);
	usleep((useconds_t)(1000 * (rand() % 1500)));
	kill(pids[which], SIGKILL);
	assert_int_equal(program_end(pid), 0);
	size_t n;
	char *out = program_file(world.out, &n), *err = program_file(world.err, &n);
	assert_string_equal(service_timeless(out), world.reference);
	*noticed += strstr(err, "the connection ended") != NULL || strstr(err, "without a connection") != NULL;
	*n_blocks += blocks_elsewhere(err);
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
		const double gone = all_gone();
		most = gone > most ? gone : most;
	}
	check_report("ranks or mpirun killed: %d, noticed %d; blocks run by ranks %d; results that differ 0; "
	             "processes were gone "
	             "%.2f s after the end",
	             n, noticed, n_blocks, most);
	assert_true(noticed > 0);
}

static void a_server_gives_many_studies_to_a_group_of_ranks(void **state)
{
	char ids[SHORT_STUDIES][17], large_id[17], path[64];
	(void)state;
	if (!there_are_ranks())
		skip();
	unlink(world.pids);
	char *reference_study = service_study(300, 5, 1), *large = service_study(6 * ROWS, 5, 1);
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
	all_gone();
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
