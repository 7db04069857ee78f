/* options.h - options of poundd, from flags and the environment: one row each.
 *
 * --port 0 and POUNDD_PORT=0 are the same; a flag wins, an empty variable is none.  Constant after options_read; any thread. */
#ifndef OPTIONS_H
#define OPTIONS_H

#include <stdbool.h>
#include <stddef.h>

#include "schema/message/launcher.h"
#include "schema/study/cost.h"

struct options {
	const char *listen;     /* address in digits */
	const char *database;   /* file */
	const char *backup;     /* file to copy it to, and no more; NULL: serve */
	const char *restore;    /* file to put in its place, and no more; NULL: serve */
	int keep_days;          /* after its end a study is deleted; 0: never */
	int keep_samples_days;  /* after its end its samples are; 0: with the study */
	const char *host;       /* further names the server is asked by, between commas; NULL: none */
	const char *token_file; /* NULL: anyone who reaches the server may use it */
	int insecure;           /* 1: that holds for any address */
	int port, workers;
	int connections_max, queue_max, queue_token_max;
	int header_timeout, body_timeout, idle_timeout, wait_max; /* [s] */
	int runs_max, time_max, cpu_max, result_max;              /* of one study: number, [s], [s], [MiB] */
	int memory_max;                                           /* of all that run [MiB] */
	struct launch launch;                                     /* of workers in other processes */
};

struct option_row {
	const char *name;
	int letter;           /* short form, 0: none */
	const char *argument; /* what its value is called; NULL: a switch */
	const char *text;     /* one line for people */
	const char *absent;   /* its value when nobody gives one; NULL: none */
	size_t offset;        /* in struct options: a whole number when max > 0, a text otherwise */
	int min, max;
};

extern const struct option_row options_table[];
extern const int options_count;

/* the name of a row's variable in the environment */
void options_variable(const struct option_row *row, char *name, size_t size);

void options_read(struct options *options, int argc, char **argv); /* prints and exits on a wrong one */
struct cost options_study_most(const struct options *options);     /* that one study may take */

#endif
