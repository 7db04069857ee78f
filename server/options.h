/* options.h - options of poundd, from flags and the environment: one row each.
 *
 * --port 0 and POUNDD_PORT=0 are the same; a flag wins, an empty variable counts as absent.  Constant after options_read; any thread. */
#ifndef OPTIONS_H
#define OPTIONS_H

#include <stdbool.h>
#include <stddef.h>

#include "schema/message/launcher.h"
#include "schema/study/cost.h"

struct options {
	const char *listen;     /* IP address */
	const char *database;   /* file */
	const char *backup;     /* file to copy the database to, then exit; NULL: serve */
	const char *restore;    /* file to replace the database by, then exit; NULL: serve */
	int keep_days;          /* days from a study's end to its deletion; 0: never */
	int keep_samples_days;  /* days from its end to the deletion of its samples; 0: with the study */
	const char *host;       /* further host names accepted in Host, comma-separated; NULL: none */
	const char *token_file; /* NULL: anyone who reaches the server may use it */
	int insecure;           /* 1: also when it does not listen on loopback */
	int port, workers;
	int connections_max, queue_max, queue_token_max;
	int header_timeout, body_timeout, idle_timeout, wait_max; /* [s] */
	int runs_max, time_max, cpu_max, result_max; /* limits of one study: number, [s], [s], [MiB] */
	int memory_max;                              /* limit of all running studies together [MiB] */
	struct launch launch;                        /* of workers in other processes */
};

struct option_row {
	const char *name;
	int letter;           /* short form, 0: none */
	const char *argument; /* placeholder of its value; NULL: the option takes none */
	const char *text;     /* one line of help */
	const char *absent;   /* its default value; NULL: none */
	size_t offset;        /* in struct options: of an int when max > 0, of a text otherwise */
	int min, max;
};

extern const struct option_row options_table[];
extern const int options_count;

/* the name of a row's variable in the environment */
void options_variable(const struct option_row *row, char *name, size_t size);

void options_read(struct options *options, int argc, char **argv); /* prints and exits on an invalid option */
struct cost options_study_most(const struct options *options);     /* limits of one study */

#endif
