/* worker_connection.h - options of pound-worker, and its connection to the program that it computes for. */
#ifndef WORKER_CONNECTION_H
#define WORKER_CONNECTION_H

#include <stdbool.h>

#include "schema/message/message.h"

struct worker_options {
	int n_threads;
	const char *at; /* HOST:PORT to connect to, again and again; NULL: once, as POUND_WORKER says */
	const char *token_file;
};

/* Reads the options; help, the version and mistakes end the program. */
struct worker_options worker_options(int argc, char **argv);
/* Connects and greets; ends the program when that is not possible.  With --connect and `again`, it is tried until it
 * succeeds, and whenever a connection has ended: each is served in a process of its own, which is where this returns. */
int worker_connect(const struct worker_options *options, int n_threads, bool again);
/* The next message of the coordinator; false: the connection has ended, or this worker was refused, which is said. */
bool worker_take(int connection, struct message *message, char **body);

#endif
