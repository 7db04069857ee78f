/* command.h - options and exit status of the subcommands.
 *
 * A subcommand is one row of the table in pound.c and one function with this signature.  The functions at the end are in command.c. */
#ifndef COMMAND_H
#define COMMAND_H

#include <stdbool.h>

#include "schema/figure/figure.h"
#include "schema/message/launcher.h"

/* exit status of the program */
enum outcome {
	OUTCOME_OK,
	OUTCOME_FAILED,
	OUTCOME_USAGE,        /* wrong usage or an invalid study */
	OUTCOME_STUDY_FAILED, /* the study failed or was cancelled */
	OUTCOME_UNREACHED,    /* no answer from the server */
};

struct options {
	const char *argument; /* the first argument of the subcommand: a file, an id or a name; NULL: none */
	const char *second;   /* indices, plot, report, archive, example: the second argument */
	const char **files;   /* (n_files) arguments of a subcommand that takes any number of files */
	int n_files;
	const char *unit;       /* record: unit of a file that does not give one; NULL: unknown */
	double step;            /* record: time step of a file without times [s]; 0: unknown */
	int channel;            /* record: in a file with several channels, from 1; 0: not chosen */
	const char *periods;    /* record: of the response spectrum, comma-separated; NULL: none */
	int row;                /* motion: of the design, from 0 */
	const char *url;        /* of the server */
	const char *format;     /* one of the formats of the subcommand */
	const char *table;      /* of a sensitivity result, by its name there; NULL: all, or the first as CSV */
	const char *status;     /* list: only studies in this state; NULL: all */
	const char *name;       /* list: only studies with this text in their name; NULL: all */
	const char *hash;       /* list: only studies of this hash; NULL: all */
	const char *cursor;     /* list: where the previous page ended; NULL: the newest */
	const char *samples;    /* run: file for every sample, or for the histories; NULL: none */
	int limit;              /* list: studies on a page; 0: the server's default */
	int threads;            /* run */
	const char *checkpoint; /* run: file of finished blocks; NULL: none */
	bool wait;              /* submit */
	bool names;             /* example, plot */
	bool given;             /* indices: both arguments are samples */
	bool partial;           /* results, plot: from the complete rows, while the study runs */
	struct figure_choice choice; /* plot */
	struct launch launch;        /* run: workers in other processes */
	struct {
		const char *model;       /* URL of its server */
		const char *name;        /* of the model on this server; NULL: the first */
		const char *outputs;     /* comma-separated names; NULL: y1, y2, ... */
		const char *config;      /* JSON object for the model; NULL: {} */
		const char *seed_member; /* member of config that is set to the run number; NULL: none */
		const char *journal;     /* file; NULL: none */
		int jobs;                /* requests at a time */
		int replicates;          /* runs per sample; 0: one */
		int timeout;             /* of a request [s]; 0: none */
	} evaluate;
};

enum outcome run_study(const struct options *options);
enum outcome model_design(const struct options *options);
enum outcome model_print_indices(const struct options *options);
enum outcome evaluate_model(const struct options *options);
enum outcome submit_study(const struct options *options);
enum outcome query_status(const struct options *options);
enum outcome query_wait(const struct options *options);
enum outcome query_results(const struct options *options);
enum outcome query_samples(const struct options *options);
enum outcome query_list(const struct options *options);
enum outcome archive_make(const struct options *options);
enum outcome query_cancel(const struct options *options);
enum outcome query_delete(const struct options *options);
enum outcome report_print(const struct options *options);
enum outcome plot_figure(const struct options *options);
enum outcome example_print(const struct options *options);
enum outcome record_show(const struct options *options);
enum outcome motion_show(const struct options *options);

/* Whether an argument is the id of a study on the server, not a file. */
bool command_is_id(const char *text);

/* One line on stderr that starts with the program's name. */
void command_complain(const char *format, ...) __attribute__((format(printf, 1, 2)));

/* printf into allocated memory, which the caller frees. */
char *command_text(const char *format, ...) __attribute__((format(printf, 1, 2)));

/* Appends to a text: frees it and returns the longer one, which the caller frees. */
char *command_append(char *text, const char *format, ...) __attribute__((format(printf, 2, 3)));

/* Replaces control characters of a text, which could control the terminal, by '?'. */
void command_tame(char *text);

/* Returns allocated memory; ends the program when it is NULL. */
void *command_sure(void *memory);

#endif
