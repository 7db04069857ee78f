/* A real Slurm cluster of four nodes on this machine: worker groups by srun and sbatch, MPI ranks, and a node that
 * loses power.
 *
 * Skipped without slurmctld, slurmd, munge and root. */
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include "tests/support/check.h"
#include "tests/support/groups.h"
#include "tests/support/program.h"
#include "tests/support/service.h"

enum {
	ROWS = 90000, /* of the study: 12 s on one core */
	SIGNALS = 5,
	RUNS = 5 * SIGNALS * ROWS,
	START_S = 60, /* until the nodes are idle or the groups connected */
	LINE = 640,
};

#define POUND(...) program_run((const char *const[]){"pound", __VA_ARGS__, NULL}, NULL)

static struct {
	char directory[64], study[96], checkpoint[96], out[96], err[96];
	char *build; /* absolute: jobs run in other directories */
	char launcher[LINE], ranks[LINE];
	char *document;
	struct service_bytes reference;
	int n_blocks;
} world;

/* Runs a command; returns its status. */
static int shell(const char *format, const char *argument, int number)
{
	char line[LINE];
	snprintf(line, sizeof line, format, argument, number);
	return system(line);
}

static bool there_is_slurm(void)
{
	return geteuid() == 0 && system("command -v slurmctld slurmd munged srun unshare >/dev/null") == 0;
}

static void nodes_wait(void)
{
	const double start = groups_now();
	while (system("[ $(sinfo -h -t idle -o %D) = 4 ] 2>/dev/null") != 0) {
		if (groups_now() - start > START_S) {
			assert_int_equal(system("sinfo >&2; tail -qn 5 \"$(dirname $SLURM_CONF)\"/*.log >&2"), 0);
			fail_msg("the four nodes of Slurm are not idle after %d s", START_S);
		}
		usleep(200000);
	}
}

static void slurm_start(void)
{
	char conf[96];
	snprintf(conf, sizeof conf, "%s/slurm.conf", world.directory);
	setenv("SLURM_CONF", conf, 1);
	assert_int_equal(shell("tests/support/slurm-cluster start %s", world.directory, 0), 0);
	nodes_wait();
}

static int setup(void **state)
{
	const char *build = getenv("POUND_BUILD");
	int n_more;
	(void)state;
	// not in /tmp, as every node has its own
	strcpy(world.directory, "/var/tmp/pound-slurm-XXXXXX");
	assert_non_null(mkdtemp(world.directory));
	world.build = realpath(build ? build : "build/release", NULL);
	assert_non_null(world.build);
	if (!strncmp(world.build, "/tmp/", 5))
		fail_msg("%s is in /tmp, which every node has for itself: build in another folder", world.build);
	snprintf(world.study, sizeof world.study, "%s/study.json", world.directory);
	snprintf(world.checkpoint, sizeof world.checkpoint, "%s/blocks", world.directory);
	snprintf(world.out, sizeof world.out, "%s/out", world.directory);
	snprintf(world.err, sizeof world.err, "%s/err", world.directory);
	snprintf(world.launcher, sizeof world.launcher,
	         "exec srun -D / -N 1 -n 1 --exclusive %s/pound-worker --threads 1", world.build);
	snprintf(world.ranks, sizeof world.ranks,
	         "exec srun -D / --mpi=pmix -N 4 -n 4 %s/pound-worker-mpi --threads 1", world.build);
	world.document = service_study(ROWS, SIGNALS, 1);
	groups_write(world.study, world.document);
	world.reference = service_uninterrupted(world.document, 2);
	struct program_outcome alone = POUND("run", "--checkpoint", world.checkpoint, world.study);
	program_expect(&alone, 0);
	assert_string_equal(service_timeless(alone.out), world.reference.result);
	program_free(&alone);
	groups_records(world.checkpoint, &world.n_blocks, &n_more);
	slurm_start();
	return 0;
}

static int teardown(void **state)
{
	(void)state;
	shell("tests/support/slurm-cluster stop %s; sleep 2", world.directory, 0);
	free(world.build);
	free(world.document);
	free(world.reference.result);
	free(world.reference.samples);
	return shell("rm -r %s", world.directory, 0);
}

/* Waits until a number of lines in the program's messages report a connected group. */
static void connections_wait(const char *log, int n)
{
	const double start = groups_now();
	for (int connected = 0; connected < n; usleep(10000)) {
		char *text = program_file(log, &(size_t){0});
		connected = 0;
		for (const char *at = text; at && (at = strstr(at, ": connected, ")); at++)
			connected++;
		free(text);
		if (groups_now() - start > START_S)
			fail_msg("%d groups of %d are connected after %d s", connected, n, START_S);
	}
}

static pid_t run_start(const char *launcher, const char *launchers)
{
	unlink(world.checkpoint);
	unlink(world.err); // messages of an earlier run report connections, too
	return program_start((const char *const[]){"pound", "run", "--threads", "1", "--launcher", launcher,
	                                           "--launchers", launchers, "--checkpoint", world.checkpoint,
	                                           world.study, NULL},
	                     world.out, world.err);
}

/* Fails unless a run has the reference's bytes and a record of each block. */
static void run_check(const char *what, double start)
{
	int n_once, n_more;
	char *out = program_file(world.out, &(size_t){0}), *err = program_file(world.err, &(size_t){0});
	assert_string_equal(service_timeless(out), world.reference.result);
	groups_records(world.checkpoint, &n_once, &n_more);
	assert_int_equal(n_more, 0);
	assert_int_equal(n_once, world.n_blocks);
	check_report("%s: %.1f s, blocks run by groups %d of %d, lost 0, doubled 0, same bytes", what,
	             groups_now() - start, groups_blocks(err), world.n_blocks);
	assert_true(groups_blocks(err) > 0);
	free(out);
	free(err);
}

/* Node 2 loses power. */
static void node_kill(void)
{
	assert_int_equal(shell("tests/support/slurm-cluster kill %s 2", world.directory, 0), 0);
}

/* Node 2 is started again, without its job: Slurm would consider it running until SlurmdTimeout. */
static void node_start(void)
{
	assert_int_equal(system("squeue -h -o %A | xargs -r scancel"), 0);
	assert_int_equal(shell("tests/support/slurm-cluster node %s 2", world.directory, 0), 0);
	nodes_wait();
}

static void four_groups_by_srun_of_slurm(void **state)
{
	(void)state;
	double start = groups_now();
	pid_t pid = run_start(world.launcher, "4");
	connections_wait(world.err, 4);
	assert_int_equal(program_end(pid), 0);
	run_check("four groups by srun", start);
	nodes_wait();
}

static void a_killed_node_of_slurm_costs_its_blocks_only(void **state)
{
	(void)state;
	double start = groups_now();
	pid_t pid = run_start(world.launcher, "4");
	connections_wait(world.err, 4);
	node_kill();
	assert_int_equal(program_end(pid), 0);
	run_check("four groups by srun, one node killed", start);
	char *err = program_file(world.err, &(size_t){0});
	assert_non_null(strstr(err, "the connection ended"));
	free(err);
	node_start();
}

static void a_batch_job_of_slurm_goes_on_without_a_node(void **state)
{
	char script[96], text[4 * LINE], line[LINE];
	(void)state;
	snprintf(script, sizeof script, "%s/job", world.directory);
	snprintf(
	    text, sizeof text,
	    "#!/bin/sh\nexec %s/pound run --threads 1 --launchers 4 --worker-host $(hostname) --launcher '%s' "
	    "--checkpoint %s %s >%s 2>%s\n",
	    world.build, world.launcher, world.checkpoint, world.study, world.out, world.err);
	groups_write(script, text);
	unlink(world.checkpoint);
	unlink(world.err);
	double start = groups_now();
	snprintf(line, sizeof line, "sbatch -D / --no-kill -N 4 -o /dev/null %s >/dev/null", script);
	assert_int_equal(system(line), 0);
	connections_wait(world.err, 4);
	node_kill();
	while (system("[ -z \"$(squeue -h -t R,PD)\" ]") != 0)
		usleep(100000);
	run_check("a batch job of four nodes, one of them killed", start);
	node_start();
}

static void a_server_goes_on_without_a_node_of_slurm(void **state)
{
	struct service *service = service_new();
	char id[17];
	(void)state;
	setenv("POUNDD_LAUNCHER", world.launcher, 1);
	setenv("POUNDD_LAUNCHERS", "4", 1);
	service_start(service, 1);
	unsetenv("POUNDD_LAUNCHER");
	unsetenv("POUNDD_LAUNCHERS");
	double start = groups_now();
	service_submit(service, world.document, id);
	connections_wait(service->log, 4);
	node_kill();
	assert_true(service_wait(service, id, "succeeded", 0));
	struct service_bytes bytes = service_bytes(service, id);
	service_bytes_compare(&bytes, &world.reference);
	assert_int_equal(service_number(service, "SELECT sum(runs) FROM block"), RUNS);
	assert_int_equal(service_number(service, "SELECT runs_done FROM study"), RUNS);
	check_report("a server with four groups, one node killed: %.1f s, lost 0, doubled 0, same bytes",
	             groups_now() - start);
	service_stop(service);
	service_free(service);
	node_start();
}

static void ranks_of_mpi_by_slurm(void **state)
{
	char program[300];
	(void)state;
	snprintf(program, sizeof program, "%s/pound-worker-mpi", world.build);
	if (access(program, X_OK) != 0)
		skip();
	double start = groups_now();
	pid_t pid = run_start(world.ranks, "1");
	connections_wait(world.err, 1);
	assert_int_equal(program_end(pid), 0);
	run_check("a group of four ranks by srun --mpi=pmix", start);
	nodes_wait();
	start = groups_now();
	pid = run_start(world.ranks, "1");
	connections_wait(world.err, 1);
	node_kill();
	assert_int_equal(program_end(pid), 0);
	run_check("a group of four ranks, one node killed", start);
	node_start();
}

int main(int argc, char **argv)
{
	const struct CMUnitTest tests[] = {cmocka_unit_test(four_groups_by_srun_of_slurm),
	                                   cmocka_unit_test(a_killed_node_of_slurm_costs_its_blocks_only),
	                                   cmocka_unit_test(a_batch_job_of_slurm_goes_on_without_a_node),
	                                   cmocka_unit_test(a_server_goes_on_without_a_node_of_slurm),
	                                   cmocka_unit_test(ranks_of_mpi_by_slurm)};
	const char *wanted = getenv("T");
	(void)argc;
	// no cluster is started for other tests
	const int n = (int)(sizeof tests / sizeof tests[0]);
	if (wanted && *wanted && !strstr(wanted, "slurm"))
		return 0;
	if (!there_is_slurm()) {
		check_report("slurmctld, slurmd, munge and root are needed");
		printf("[  SKIPPED ] %d test(s)\n", n);
		return 0;
	}
	setup(NULL);
	int failed = check_run(argv[0], tests, n);
	teardown(NULL);
	return failed;
}
