/* Limits of worker groups: blocks per second into the database, up to 1,024 threads whose blocks sleep, CPU time of
 * blocks by ranks.
 *
 * The sleeping workers are pound-worker and pound-worker-mpi with tests/support/instant_blocks.c in place of the
 * simulation. */
#include <string.h>
#include <unistd.h>

#include "schema/json/json_pointer.h"
#include "tests/support/check.h"
#include "tests/support/groups.h"
#include "tests/support/program.h"
#include "tests/support/service.h"

enum {
	ROWS = 60000,      /* of the study for sleeping blocks */
	SIGNALS = 5,       /* 1,981 blocks */
	BLOCK_US = 25000,  /* time of a block of the paper's campaign [us] */
	PAPER_ROWS = 4000, /* of the study for real blocks */
};

static struct {
	char *document, *small;
	char build[256];
} world;

/* CPU time of a server [s] without its computing threads, which have a positive nice value. */
static double cpu_of_service(const struct service *service)
{
	char command[320];
	snprintf(command, sizeof command,
	         "cat /proc/%d/task/*/stat | sed 's/.*) //' | awk '$17 < 10 {n += $12 + $13} END {print n + 0}'",
	         (int)service->pid);
	FILE *pipe = popen(command, "r");
	double ticks = 0;
	assert_non_null(pipe);
	assert_int_equal(fscanf(pipe, "%lf", &ticks), 1);
	pclose(pipe);
	return ticks / (double)sysconf(_SC_CLK_TCK);
}

/* Runs the study by sleeping workers until its blocks are stored.  Returns blocks per second over the middle nine
 * tenths; cpu_us is the server's CPU time per block [us]. */
static double rate(const char *launcher, int n_groups, int block_us, int *n_blocks, double *cpu_us)
{
	char text[32], id[17], groups[16];
	snprintf(text, sizeof text, "%d", block_us);
	snprintf(groups, sizeof groups, "%d", n_groups);
	setenv("POUND_BLOCK_US", text, 1);
	const char *const settings[][2] = {{"POUNDD_LAUNCHER", launcher}, {"POUNDD_LAUNCHERS", groups}, {NULL}};
	struct service *service = service_with(settings, 1);
	// the groups connect during a study that is canceled, so that all of them run the next one from its start
	service_submit(service, world.document, id);
	for (int connected = 0; connected < n_groups; usleep(5000)) {
		char *log = program_file(service->log, &(size_t){0});
		connected = 0;
		for (const char *at = log; (at = strstr(at, ": connected, ")); at++)
			connected++;
		free(log);
	}
	char path[64];
	snprintf(path, sizeof path, "/v1/studies/%s/cancel", id);
	struct answer answer = service_ask(service, &(struct ask){.method = "POST", .path = path});
	answer_free(&answer);
	usleep(500000);
	const double cpu = cpu_of_service(service);
	service_submit(service, world.document, id);
	// progress from the table of studies: reading blocks would delay checkpoints of the WAL
	char sql[192];
	snprintf(sql, sizeof sql, "SELECT runs_done = runs FROM study WHERE id = %lld", strtoll(id, NULL, 16));
	while (!service_number(service, sql))
		usleep(50000);
	const double spent = cpu_of_service(service) - cpu;
	snprintf(sql, sizeof sql, "SELECT count(*) FROM block WHERE study = %lld", strtoll(id, NULL, 16));
	*n_blocks = (int)service_number(service, sql);
	// the middle nine tenths: the server's own thread, with its nice value, may finish its last block late
	double at[2];
	for (int i = 0; i < 2; i++) {
		snprintf(sql, sizeof sql,
		         "SELECT 1e6 * wall_s FROM block WHERE study = %lld ORDER BY wall_s LIMIT 1 OFFSET %d",
		         strtoll(id, NULL, 16), *n_blocks * (i ? 19 : 1) / 20);
		at[i] = 1e-6 * (double)service_number(service, sql);
	}
	const double took = at[1] - at[0];
	*cpu_us = 1e6 * spent / *n_blocks;
	service_kill(service);
	service_free(service);
	unsetenv("POUND_BLOCK_US");
	return 0.9 * *n_blocks / took;
}

static void worker_limits_of_blocks_into_the_database(void **state)
{
	char launcher[384];
	double most = 0;
	(void)state;
	for (int n = 1; n <= 16; n *= 4) {
		int n_blocks;
		double cpu_us;
		snprintf(launcher, sizeof launcher, "exec %s/tests/worker-instant --threads 64", world.build);
		const double rate_s = rate(launcher, n, 0, &n_blocks, &cpu_us);
		most = rate_s > most ? rate_s : most;
		check_report("%4d groups of 64 threads, blocks without time: %6.0f blocks/s into the database, %.0f "
		             "us of the server each",
		             n, rate_s, cpu_us);
	}
	assert_true(most > 0);
}

static void worker_limits_of_a_thousand_threads(void **state)
{
	char launcher[384];
	(void)state;
	for (int n = 1; n <= 16; n *= 4) {
		int n_blocks;
		double cpu_us;
		snprintf(launcher, sizeof launcher, "exec %s/tests/worker-instant --threads 64", world.build);
		const double rate_s = rate(launcher, n, BLOCK_US, &n_blocks, &cpu_us), ideal = 64e6 * n / BLOCK_US;
		check_report(
		    "%4d threads (groups of 64), %d blocks that sleep for 25 ms: %6.0f blocks/s, %3.0f %% of ideal",
		    64 * n, n_blocks, rate_s, 100 * rate_s / ideal);
	}
}

static bool there_are_ranks(void)
{
	char program[300];
	snprintf(program, sizeof program, "%s/tests/ranks-instant", world.build);
	return access(program, X_OK) == 0 && system("command -v mpirun >/dev/null") == 0;
}

static void worker_limits_of_ranks(void **state)
{
	char launcher[512];
	(void)state;
	if (!there_are_ranks())
		skip();
	for (int n = 2; n <= 32; n *= 4)
		for (int us = 0; us <= BLOCK_US; us += BLOCK_US) {
			int n_blocks;
			double cpu_us;
			snprintf(launcher, sizeof launcher,
			         "exec mpirun --oversubscribe --bind-to none -n %d -x POUND_WORKER -x POUND_BLOCK_US "
			         "%s/tests/ranks-instant --threads 4",
			         n, world.build);
			const double rate_s = rate(launcher, 1, us, &n_blocks, &cpu_us);
			check_report("%4d ranks of 4 threads, blocks of %d us: %6.0f blocks/s%s", n, us, rate_s,
			             us ? "" : " through rank 0");
			if (us)
				check_report("     %.0f %% of ideal", 100 * rate_s * us / (4e6 * n));
		}
}

/* CPU time of a study [s], of all processes. */
static double cpu_of(const char *launcher)
{
	char file[] = "/tmp/pound-test-XXXXXX";
	close(mkstemp(file));
	groups_write(file, world.small);
	struct program_outcome outcome =
	    launcher ? program_run((const char *const[]){"pound", "run", "--threads", "1", "--launcher", launcher,
	                                                 file, NULL},
	                           NULL)
	             : program_run((const char *const[]){"pound", "run", "--threads", "1", file, NULL}, NULL);
	program_expect(&outcome, 0);
	const char *cpu = strstr(outcome.out, "\"cpu_s\": ");
	assert_non_null(cpu);
	const double seconds = strtod(cpu + strlen("\"cpu_s\": "), NULL);
	program_free(&outcome);
	unlink(file);
	return seconds;
}

static void worker_limits_of_cpu_time(void **state)
{
	static const int ranks[] = {1, 2, 32};
	const double alone = cpu_of(NULL);
	(void)state;
	if (!there_are_ranks())
		skip();
	check_report("CPU time of a study by one thread: %.2f s", alone);
	for (int i = 0; i < 3; i++) {
		char launcher[512];
		snprintf(launcher, sizeof launcher,
		         "exec mpirun --oversubscribe --bind-to none -n %d -x POUND_WORKER %s/pound-worker-mpi "
		         "--threads 1",
		         ranks[i], world.build);
		check_report("by one thread and %2d ranks: %.2f times that", ranks[i], cpu_of(launcher) / alone);
	}
}

static int setup(void **state)
{
	const char *build = getenv("POUND_BUILD");
	(void)state;
	setenv("OMPI_ALLOW_RUN_AS_ROOT", "1", 1);
	setenv("OMPI_ALLOW_RUN_AS_ROOT_CONFIRM", "1", 1);
	snprintf(world.build, sizeof world.build, "%s", build ? build : "build/release");
	world.document = service_study(ROWS, SIGNALS, 1);
	world.small = service_study(PAPER_ROWS, SIGNALS, 1);
	return 0;
}

static int teardown(void **state)
{
	(void)state;
	free(world.document);
	free(world.small);
	return 0;
}

int main(int argc, char **argv)
{
	const struct CMUnitTest tests[] = {cmocka_unit_test(worker_limits_of_blocks_into_the_database),
	                                   cmocka_unit_test(worker_limits_of_a_thousand_threads),
	                                   cmocka_unit_test(worker_limits_of_ranks),
	                                   cmocka_unit_test(worker_limits_of_cpu_time)};
	(void)argc;
	setup(NULL);
	int failed = check_run(argv[0], tests, (int)(sizeof tests / sizeof tests[0]));
	teardown(NULL);
	return failed;
}
