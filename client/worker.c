/* pound-worker: one process that runs blocks for a coordinator until its connection ends; with --connect another process serves the next connection. */
#include <stdio.h>
#include <stdlib.h>
#include <unistd.h>

#include <gsl/gsl_errno.h>

#include "client/thread_pool.h"
#include "client/worker_connection.h"
#include "schema/message/launcher.h"

static void send_answer(void *to, const struct message *message, const void *body)
{
	// the coordinator has closed the connection, so nobody needs further answers
	if (!message_send(*(const int *)to, message, body))
		_exit(EXIT_SUCCESS);
}

int main(int argc, char **argv)
{
	const struct worker_options options = worker_options(argc, argv);
	struct message message = {0};
	char *body;
	gsl_set_error_handler_off();
	if (launcher_ranks() > 1 && !options.at) {
		fprintf(stderr,
		        "pound-worker: this is one of %d ranks, each of which would be a group: start one by -n 1, "
		        "or all of "
		        "them as one group by pound-worker-mpi (make MPI=1)\n",
		        launcher_ranks());
		return EXIT_FAILURE;
	}
	int connection = worker_connect(&options, options.n_threads, true);
	struct thread_pool *pool = thread_pool_start(options.n_threads, send_answer, &connection);
	bool sense = pool, asked = false;
	for (; sense && worker_take(connection, &message, &body); asked = true)
		sense = thread_pool_take(pool, &message, body);
	const bool refused = message.type == MESSAGE_REFUSE;
	if (options.at && !asked && !refused)
		fputs("pound-worker: the connection ended before a study was received\n", stderr);
	// _exit, because the threads of the pool still run
	_exit(sense && !refused && (asked || !options.at) ? EXIT_SUCCESS : EXIT_FAILURE);
}
