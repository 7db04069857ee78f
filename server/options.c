/* A table with a row for every option, for argp's flags and for the variables of the environment. */
#include "server/options.h"

#include <argp.h>
#include <ctype.h>
#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "engine/pound.h"
#include "schema/message/coordinator.h"
#include "server/memory.h"

enum {
	WORKERS_MAX = 1024,
	FIRST_KEY = 256, /* above all letters */
	WRONG_USAGE = 2, /* exit status, the same as pound's */
};

#define AT(member) offsetof(struct options, member)

// clang-format off
const struct option_row options_table[] = {
	{"port",            'p', "PORT",    "port to listen on; 0: any free port", "8437", AT(port), 0, 65535},
	{"listen",          'l', "ADDRESS", "address to listen on; one that is not loopback needs --token-file or --insecure",
	 "127.0.0.1", AT(listen), 0, 0},
	{"database",        'd', "FILE",    "file that keeps the studies", "poundd.db", AT(database), 0, 0},
	{"backup",          0,   "FILE",    "copy the database to FILE, which must not exist, and exit; a server may run meanwhile",
	 NULL, AT(backup), 0, 0},
	{"restore",         0,   "FILE",    "replace the database by a copy of FILE, keep the old one as DATABASE-replaced, and exit; no server may run",
	 NULL, AT(restore), 0, 0},
	{"workers",         'w', "N",       "threads that run studies (default: one per core)", NULL, AT(workers), 1, WORKERS_MAX},
	{"launcher",        0,   "COMMAND", "command that starts worker processes, such as 'srun pound-worker'", NULL, AT(launch.command), 0, 0},
	{"launchers",       0,   "N",       "run this command N times; each is a worker group that starts and fails independently (absent: once)",
	 NULL, AT(launch.n), 1, COORDINATOR_GROUPS_MAX},
	{"worker-host",     0,   "HOST",    "name or address by which workers on other machines reach this machine (absent: only local workers can connect)",
	 NULL, AT(launch.host), 0, 0},
	{"worker-listen",   0,   "ADDRESS:PORT", "address and port at which workers that are started elsewhere connect", NULL, AT(launch.at), 0, 0},
	{"worker-token-file", 0, "FILE",    "token of those workers: 64 hexadecimal digits", NULL, AT(launch.token_file), 0, 0},
	{"keep-days",       0,   "N",       "days until a finished study is deleted; 0: never", "0", AT(keep_days), 0, 36500},
	{"keep-samples-days", 0, "N",       "days until the samples of a finished study are deleted; 0: when the study is", "0", AT(keep_samples_days), 0, 36500},
	{"host",            0,   "NAMES",   "comma-separated host names to accept in Host, in addition to localhost and IP addresses",
	 NULL, AT(host), 0, 0},
	{"token-file",      0,   "FILE",    "file of bearer tokens, one per line; requests without a valid token get 401", NULL, AT(token_file), 0, 0},
	{"insecure",        0,   NULL,      "listen on any address without tokens", "0", AT(insecure), 0, 1},
	{"connections-max", 0,   "N",       "open connections at most; further ones get 503", "2048", AT(connections_max), 1, 4000},
	{"queue-max",       0,   "N",       "queued studies at most; further ones get 503", "10000", AT(queue_max), 1, 1000000},
	{"queue-token-max", 0,   "N",       "queued studies of one token at most; further ones get 429", "100", AT(queue_token_max), 1, 1000000},
	{"header-timeout",  0,   "S",       "seconds in which the headers of the first request must arrive", "10", AT(header_timeout), 1, 3600},
	{"body-timeout",    0,   "S",       "seconds in which the body of a request must arrive", "30", AT(body_timeout), 1, 3600},
	{"idle-timeout",    0,   "S",       "seconds from an answer until the headers of the next request must have arrived", "60", AT(idle_timeout), 1, 3600},
	{"wait-max",        0,   "S",       "longest wait of a request with Prefer: wait, in seconds", "30", AT(wait_max), 1, 3600},
	{"runs-max",        0,   "N",       "pounding runs of one study at most", "10000000", AT(runs_max), 1, 10000000},
	{"time-max",        0,   "S",       "seconds that one study may run; after that it fails with `timeout`", "172800", AT(time_max), 1, 100000000},
	{"cpu-max",         0,   "S",       "estimated seconds of one core that one study may take; a study that takes three times as many fails with `cpu-limit`", "86400", AT(cpu_max), 1, 100000000},
	{"result-max",      0,   "MIB",     "estimated MiB that one study may take in the database", "1024", AT(result_max), 1, 1000000},
	{"memory-max",      0,   "MIB",     "estimated MiB of memory of all running studies (absent: half the memory of the machine or the control group)", NULL, AT(memory_max), 1, 1000000000},
};
// clang-format on
const int options_count = sizeof options_table / sizeof options_table[0];

void options_variable(const struct option_row *row, char *name, size_t size)
{
	snprintf(name, size, "POUNDD_%s", row->name);
	for (char *c = name; *c; c++)
		*c = *c == '-' ? '_' : (char)toupper((unsigned char)*c);
}

static int key_of(const struct option_row *row)
{
	return row->letter ? row->letter : FIRST_KEY + (int)(row - options_table);
}

struct reading {
	struct options *options;
	bool given[sizeof options_table / sizeof options_table[0]]; /* by a flag */
};

/* Sets an option, or ends the program with a message that says what `name` accepts. */
static void take(struct argp_state *state, const struct option_row *row, const char *name, const char *value)
{
	const struct reading *reading = state->input;
	char *at = (char *)reading->options + row->offset, *rest;
	if (row->max == 0) {
		*(const char **)(void *)at = value;
		if (!*value)
			argp_error(state, "%s must not be empty", name);
		return;
	}
	long number = strtol(value, &rest, 10);
	*(int *)(void *)at = (int)number;
	if (rest == value || *rest || number < row->min || number > row->max)
		argp_error(state, "%s must be a whole number in [%d, %d], got '%s'", name, row->min, row->max, value);
}

/* Takes options without a flag from the environment; an empty variable counts as absent. */
static void take_variables(struct argp_state *state)
{
	const struct reading *reading = state->input;
	for (int i = 0; i < options_count; i++) {
		char name[64];
		options_variable(&options_table[i], name, sizeof name);
		const char *value = getenv(name);
		if (!reading->given[i] && value && *value)
			take(state, &options_table[i], name, value);
	}
}

/* Called by argp first, for each flag, and last, so that variables overridden by flags are not checked. */
static error_t parse(int key, char *value, struct argp_state *state)
{
	struct reading *reading = state->input;
	if (key == ARGP_KEY_END)
		take_variables(state);
	for (int i = 0; i < options_count; i++) {
		const struct option_row *row = &options_table[i];
		char name[64];
		if (key == ARGP_KEY_INIT && row->absent)
			take(state, row, row->name, row->absent);
		if (key != key_of(row))
			continue;
		snprintf(name, sizeof name, "--%s", row->name);
		take(state, row, name, value ? value : "1");
		reading->given[i] = true;
		return 0;
	}
	return key == ARGP_KEY_INIT || key == ARGP_KEY_END ? 0 : ARGP_ERR_UNKNOWN;
}

const char *argp_program_version = "poundd " POUND_VERSION;

/* Reads flags and environment; --help, --version and invalid options end the program.
 *
 * Returns  options   its texts point into argv and the environment
 * Test     unit_options: every_option_is_taken_as_a_flag_and_from_the_environment,
 *          what_a_flag_overrides_is_not_judged
 */
void options_read(struct options *options, int argc, char **argv)
{
	struct argp_option flags[sizeof options_table / sizeof options_table[0] + 1] = {0};
	char texts[sizeof options_table / sizeof options_table[0]][192];
	const struct argp argp = {.options = flags,
	                          .parser = parse,
	                          .doc =
	                              "Serves pounding studies over HTTP.\vEvery option may be given in the "
	                              "environment as well: --port as "
	                              "POUNDD_PORT, --token-file as POUNDD_TOKEN_FILE.  Flags take precedence."};
	long cores = sysconf(_SC_NPROCESSORS_ONLN);
	*options = (struct options){.workers = cores < 1             ? 1
	                                       : cores > WORKERS_MAX ? WORKERS_MAX
	                                                             : (int)cores,
	                            .memory_max = memory_share("")};
	for (int i = 0; i < options_count; i++) {
		const struct option_row *row = &options_table[i];
		snprintf(texts[i], sizeof texts[i], row->absent && row->argument ? "%s (%s)" : "%s", row->text,
		         row->absent);
		flags[i] = (struct argp_option){
		    .name = row->name, .key = key_of(row), .arg = row->argument, .doc = texts[i]};
	}
	struct reading reading = {.options = options};
	argp_err_exit_status = WRONG_USAGE;
	// invalid options have ended the program in argp_parse; the only failure left is out of memory
	if (argp_parse(&argp, argc, argv, 0, NULL, &reading) != 0) {
		fputs("poundd: out of memory\n", stderr);
		exit(EXIT_FAILURE);
	}
}

static const double MIB = 1 << 20;

struct cost options_study_most(const struct options *options)
{
	return (struct cost){.runs = options->runs_max,
	                     .cpu_s = options->cpu_max,
	                     .bytes = MIB * options->result_max,
	                     .memory = MIB * options->memory_max};
}
