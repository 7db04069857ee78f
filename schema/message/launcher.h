/* launcher.h - how worker groups start: by a command (launcher), or by other means, connecting to a port. */
#ifndef LAUNCHER_H
#define LAUNCHER_H

#include <stdbool.h>
#include <sys/types.h>

#include "schema/message/message.h"

/* Options of worker groups. */
struct launch {
	const char *command; /* run by sh -c, POUND_WORKER in its environment; NULL: none */
	const char *host;    /* name of this machine for workers, listens on all addresses; NULL: loopback only */
	int n;               /* number of groups, the command runs once for each; 0: one */
	const char *at;      /* ADDRESS:PORT to which external workers connect; NULL: none */
	const char *token_file;             /* file of the token that external workers send */
	int socket;                         /* listens at that port, ... */
	char token[MESSAGE_TOKEN_SIZE + 1]; /* ... and the token; set by launch_listen */
};

/* NULL, or a sentence about invalid options. */
const char *launch_fault(const struct launch *launch);
/* Listens for external workers, if requested; false: failed.  The text, if not empty, is the error or the address. */
bool launch_listen(struct launch *launch, char *text, size_t size);

struct launcher {
	pid_t pid;   /* also of the process group, 0: none */
	int status;  /* after its end: exit status, or 128 + the signal that ended it */
	int listens; /* socket that listens for the connection, -1: none */
	char token[MESSAGE_TOKEN_SIZE + 1];
};

int launcher_ranks(
    void); /* number of ranks that Open MPI, MPICH or Slurm started with this process; 1: single process */
/* NULL, or an error message */
const char *launcher_start(struct launcher *launcher, const struct launch *launch);
bool launcher_ended(struct launcher *launcher);
void launcher_close(struct launcher *launcher); /* accepts no further connections */
/* Ends all processes of the launcher on this machine.  Workers whose connection was closed have END_WAIT to exit first; a command
 * that never connected gets SIGTERM at once. */
void launcher_stop(struct launcher *launcher, bool connected);

#endif
