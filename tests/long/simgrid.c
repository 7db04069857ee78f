/* simgrid.c - a study on up to 1,000 threads of a cluster, simulated by SimGrid: `make simgrid`.
 *
 * Block times are measured here in runs of the paper's campaign; 10,000 blocks repeat these times.  A server assigns
 * blocks as schema/message/coordinator.c does, two ahead for each thread, and receives results one at a time.  Nodes
 * have 10 Gb/s and 50 us; a block's result has 40 kB, and takes the server the time that soak_limits measures.
 *
 *   efficiency = sum of block times / (threads * time from the first block to the last)
 *
 * Source   Casanova et al. 2014, J. Parallel Distrib. Comput. 74, 2899-2917 (SimGrid); client/machines.md */
#include <assert.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/wait.h>
#include <time.h>
#include <unistd.h>

#include <simgrid/actor.h>
#include <simgrid/comm.h>
#include <simgrid/engine.h>
#include <simgrid/host.h>
#include <simgrid/mailbox.h>

#include "engine/pound.h"
#include "schema/examples/examples.h"
#include "schema/study/study_json.h"

enum { TIMED = 200, BLOCKS = 10000, AHEAD = 2, BLOCK_BYTES = 40000, HEAD_BYTES = 32, FLOPS = 1000000000 };

static const int thread_counts[] = {64, 256, 512, 1000};
static const double server_us[] = {146, 237}; // per block, 1 and 4 groups: make soak T=worker_limits

static double block_s[TIMED];

/* state of a simulation; its actors run one at a time */
static struct {
	int n_threads, handed_out, done;
	double cost_s;      /* server time per block */
	double work_s;      /* total time of all blocks */
	double busy_s, end; /* busy time of the server; time at which the last result was received */
} world;

static double cpu_now(void)
{
	struct timespec now;
	clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &now);
	return (double)now.tv_sec + 1e-9 * (double)now.tv_nsec;
}

static void time_blocks(void)
{
	static struct problems problems;
	const char *text = example_text("paper");
	struct pound_study *study = study_from_json(text, strlen(text), &problems);
	struct pound_run *run = study ? pound_run_create(study, 1) : NULL;
	assert(run);
	// from the whole design, as consecutive blocks may be alike
	const int n = pound_run_blocks(run);
	for (int k = 0; k < TIMED; k++) {
		const double start = cpu_now();
		const enum pound_status status = pound_run_block(run, (int)((double)k * n / TIMED), 0);
		assert(status == POUND_OK);
		block_s[k] = cpu_now() - start;
	}
	pound_run_free(run);
	study_free(study);
}

static sg_mailbox_t inbox(int thread)
{
	char name[32];
	snprintf(name, sizeof name, "thread-%d", thread);
	return sg_mailbox_by_name(name);
}

static void worker(int argc, char **argv)
{
	const int thread = atoi(argv[1]);
	(void)argc;
	sg_mailbox_set_receiver(
	    sg_mailbox_get_name(inbox(thread))); // bytes arrive before they are requested, as through a socket
	for (;;) {
		const double *s = sg_mailbox_get(inbox(thread));
		if (*s < 0)
			return;
		sg_actor_sleep_for(*s); // each thread has its own core
		int *number = malloc(sizeof *number);
		assert(number);
		*number = thread;
		sg_comm_detach(sg_mailbox_put_init(sg_mailbox_by_name("server"), number, BLOCK_BYTES), NULL);
	}
}

/* Sends a thread its next block, or the end. */
static void hand(int thread)
{
	static double none = -1;
	double *next = &none;
	if (world.handed_out < BLOCKS) {
		next = &block_s[world.handed_out++ % TIMED];
		world.work_s += *next;
	}
	sg_comm_detach(sg_mailbox_put_init(inbox(thread), next, HEAD_BYTES), NULL);
}

static void server(int argc, char **argv)
{
	(void)argc;
	(void)argv;
	sg_mailbox_set_receiver("server");
	for (int k = 0; k < AHEAD; k++)
		for (int thread = 0; thread < world.n_threads; thread++)
			hand(thread);
	for (; world.done < BLOCKS; world.done++) {
		int *thread = sg_mailbox_get(sg_mailbox_by_name("server"));
		sg_actor_execute(FLOPS * world.cost_s);
		world.busy_s += world.cost_s;
		hand(*thread);
		free(thread);
	}
	world.end = simgrid_get_clock();
}

/* A cluster of a server and a number of nodes, in a file that SimGrid reads. */
static void platform(int nodes)
{
	char name[] = "/tmp/pound-simgrid-XXXXXX.xml";
	const int file = mkstemps(name, 4);
	assert(file >= 0);
	dprintf(file,
	        "<?xml version='1.0'?>\n<!DOCTYPE platform SYSTEM \"https://simgrid.org/simgrid.dtd\">\n"
	        "<platform version=\"4.1\"><cluster id=\"nodes\" prefix=\"node-\" suffix=\"\" radical=\"0-%d\" "
	        "speed=\"1Gf\" bw=\"10Gbps\" lat=\"25us\"/></platform>\n",
	        nodes);
	close(file);
	simgrid_load_platform(name);
	unlink(name);
}

/* One simulation in a separate process, as SimGrid allows one per process. */
static void simulate(int n_threads, double cost_us, int argc, char **argv)
{
	simgrid_init(&argc, argv);
	platform(n_threads);
	world.n_threads = n_threads;
	world.cost_s = 1e-6 * cost_us;
	sg_actor_create("server", sg_host_by_name("node-0"), server, 0, NULL);
	for (int thread = 0; thread < n_threads; thread++) {
		char node[32], number[16];
		snprintf(node, sizeof node, "node-%d", thread + 1);
		snprintf(number, sizeof number, "%d", thread);
		sg_actor_create(node, sg_host_by_name(node), worker, 2, (char *const[]){(char[]){"worker"}, number});
	}
	simgrid_run();
	const double mean = world.work_s / BLOCKS;
	printf("| %d | %.0f | %.0f %% | %.0f %% | %.0f %% |\n", n_threads, cost_us,
	       100 * world.work_s / (n_threads * world.end), 100 * fmin(1, mean / (n_threads * world.cost_s)),
	       100 * world.busy_s / world.end);
}

int main(int argc, char **argv)
{
	time_blocks();
	double sum = 0, most = 0;
	for (int k = 0; k < TIMED; k++)
		sum += block_s[k], most = fmax(most, block_s[k]);
	printf("%d blocks timed: mean %.1f ms, longest %.1f ms; %d blocks simulated\n\n", TIMED,
	       1e3 * sum / TIMED, 1e3 * most, BLOCKS);
	printf("| threads | server, a block [us] | efficiency | calculated | server busy |\n| --- | --- | --- | "
	       "--- | --- |\n");
	for (size_t c = 0; c < sizeof server_us / sizeof server_us[0]; c++)
		for (size_t k = 0; k < sizeof thread_counts / sizeof thread_counts[0]; k++) {
			int status = 0;
			fflush(stdout);
			const pid_t child = fork();
			if (child == 0) {
				simulate(thread_counts[k], server_us[c], argc, argv);
				fflush(stdout);
				_exit(0);
			}
			if (child < 0 || waitpid(child, &status, 0) != child || status != 0)
				return EXIT_FAILURE;
		}
	return EXIT_SUCCESS;
}
