/* launcher.h - what worker groups come from: a command that starts them, or a port to which others start them. */
#ifndef LAUNCHER_H
#define LAUNCHER_H

#include <stdbool.h>
#include <sys/types.h>

#include "schema/message/message.h"

/* Where worker groups come from. */
struct launch {
	const char *command; /* run by sh -c, POUND_WORKER in its environment; NULL: none */
	const char
	    *host;      /* by which workers reach this machine: listen on all addresses; NULL: on loopback only */
	int n;          /* groups: the command runs once for each; 0: once */
	const char *at; /* ADDRESS:PORT to which workers that others start connect; NULL: there is none */
	const char *token_file;             /* of the token that those send */
	int socket;                         /* that listens there, ... */
	char token[MESSAGE_TOKEN_SIZE + 1]; /* ... and its token, from launch_listen on */
};

/* NULL, or which options do not go together. */
const char *launch_fault(const struct launch *launch);
/* Listens for workers that others start, if it is to; false: it cannot.  The text, when there is one, says so or says where. */
bool launch_listen(struct launch *launch, char *text, size_t size);

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
void launcher_close(struct launcher *launcher); /* takes no connection any more */
/* Ends all of its processes on this machine.  Workers whose connection was closed get END_WAIT to exit first, a command
 * that never connected gets SIGTERM at once. */
void launcher_stop(struct launcher *launcher, bool connected);

#endif
