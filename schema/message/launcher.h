/* launcher.h - a command that starts workers, and the connection that they open. */
#ifndef LAUNCHER_H
#define LAUNCHER_H

#include <stdbool.h>
#include <sys/types.h>

#include "schema/message/message.h"

/* What starts worker groups. */
struct launch {
	const char *command; /* run by sh -c, POUND_WORKER in its environment; NULL: no workers */
	const char
	    *host; /* by which workers reach this machine: listen on all addresses; NULL: on loopback only */
	int n;     /* groups: the command runs once for each */
};

struct launcher {
	pid_t pid;   /* of its process group, 0: none */
	int status;  /* exit status of one that has ended, 128 + signal of one that a signal ended */
	int listens; /* the socket that waits for the connection, -1: none */
	char token[MESSAGE_TOKEN_SIZE + 1];
};

int launcher_ranks(
    void); /* that this process is one of, as Open MPI, MPICH or Slurm started it; 1: it is alone */
/* NULL, or what failed */
const char *launcher_start(struct launcher *launcher, const struct launch *launch);
bool launcher_ended(struct launcher *launcher);
/* A connection that starts with the token; -1: there is none, or it starts with something else and is closed. */
int launcher_accept(const struct launcher *launcher);
void launcher_close(struct launcher *launcher); /* takes no connection any more */
/* Ends all of its processes on this machine.  Workers whose connection was closed get END_WAIT to exit first, a command
 * that never connected gets SIGTERM at once. */
void launcher_stop(struct launcher *launcher, bool connected);

#endif
