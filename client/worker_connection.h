/* worker_connection.h - options of pound-worker, and its connection to the coordinator, `pound run` or poundd. */
#ifndef WORKER_CONNECTION_H
#define WORKER_CONNECTION_H

#include <stdbool.h>

#include "schema/message/message.h"

struct worker_options {
	int n_threads;
	const char *at; /* HOST:PORT to connect to, repeatedly; NULL: once, to the address in POUND_WORKER */
	const char *token_file;
};

/* Reads the options; --help, --version and invalid options end the program. */
struct worker_options worker_options(int argc, char **argv);
/* Connects and greets; ends the program when that is not possible.  With --connect and `again`, it retries until it
 * succeeds, and connects again after each connection: each is served by a child process, in which this returns. */
int worker_connect(const struct worker_options *options, int n_threads, bool again);
/* The next message of the coordinator; false: the connection has ended, or this worker was refused, which is reported on stderr. */
bool worker_take(int connection, struct message *message, char **body);

#endif
