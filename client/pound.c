/* pound.c - the command line: the table of subcommands, their options, and the usage printed from both. */
#include "engine/pound.h"
#include "client/command.h"
#include "schema/message/coordinator.h"
#include "schema/result/result_json.h"
#include "schema/study/near_name.h"

#include <argp.h>
#include <assert.h>
#include <errno.h>
#include <sched.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

static const char URL_DEFAULT[] = "http://127.0.0.1:8437";

enum {
	THREADS_MAX = 1024,
	LIMIT_MAX = 100,
	CHANNEL_MAX = 1000,
	FORMATS_MAX = 4, /* with a NULL at the end */
	JOBS = 8,
	JOBS_MAX = 1000,
	REPLICATES_MAX = 100000,
	TIMEOUT_MAX = 10000000, /* [s] */
};

struct command {
	const char *name;
	const char *arguments;            /* as shown in the usage: "" for none, optional ones in brackets */
	const char *takes;                /* keys of the options below */
	bool terminal_table;              /* without --format, a table when stdout is a terminal */
	const char *formats[FORMATS_MAX]; /* names that --format takes, the first is the default */
	enum outcome (*run)(const struct options *);
	const char *help; /* one line */
	const char *more; /* for COMMAND --help */
};

#define TABLE(name) " " #name
#define TABLES      RESULT_TABLES(TABLE)

static const char *const TABLE_NAMES[] = {
#define X(name) #name,
    RESULT_TABLES(X)
#undef X
        NULL};

/* Keys of the options for figures: not printable, so that these options have no short form. */
enum {
	FIGURE_KEY_BEFORE,
#define X(name, values, lowest, highest, text) FIGURE_KEY_##name,
	FIGURE_ARGUMENTS(X)
#undef X
	    FIGURE_KEYS_END
};
/* MOTION_KEYS: the keys of cell and signal */
#define MOTION_KEYS "\1\11"
#define FIGURE_KEYS "\1\2\3\4\5\6\7\10\11\12\13\14"

static_assert(sizeof FIGURE_KEYS == FIGURE_KEYS_END, "the keys of all arguments of figures");
static_assert(FIGURE_KEY_cell == 1 && FIGURE_KEY_signal == 9, "the keys of a motion's arguments");

// clang-format off
static const struct command COMMANDS[] = {
	{"run", "STUDY.json", "tfToLBQEFk", false, {"json", "table", "csv"}, run_study,
	 "compute a study here, without a server",
	 "Prints the result on standard output: the same bytes as from a server, except `timing'.  "
	 "Ctrl-C stops the study.  With --launcher or --worker-listen, worker processes on this and other machines compute too: client/machines.md."},
	{"design", "STUDY.json", "", false, {0}, model_design,
	 "print the rows of a study's design, to evaluate with a model of your own",
	 "CSV: a header of the inputs' names and, for each row i of the design, the samples A_i, B_i and A_i with "
	 "column j from B_i for every j.  A study without \"scene\" describes the inputs of your own model."},
	{"indices", "STUDY.json Y.csv", "gfT", false, {"json", "table", "csv"}, model_print_indices,
	 "sensitivity indices of the outputs of a model of your own",
	 "Y.csv has a header and a line for each of `pound design', in its order: a column for every output and, where "
	 "it is known, NAME.variance, the variance of a mean over replicates divided by their number; or a column for each "
	 "replicate: NAME.replicate1, NAME.replicate2, ...  With --given, the "
	 "first file is X.csv: samples of the inputs that were drawn or observed elsewhere, with a column for each input; Y.csv "
	 "has the outputs of the same lines.  Lines with the same inputs are replicates."},
	{"evaluate", "STUDY.json", "mNjJOGKSWfT", false, {"json", "table", "csv"}, evaluate_model,
	 "run a model of your own on a study's design by UM-Bridge and print its indices",
	 "Runs every row of `pound design' on the model at --model, several at a time, and prints what `pound indices' prints.  "
	 "With --journal, a command that was stopped continues where it stopped.  A run that the model refuses or fails is "
	 "left out with its row."},
	{"submit", "STUDY.json", "wu", false, {0}, submit_study,
	 "submit a study to the server and print its id",
	 "With --wait, follows the study until it has ended."},
	{"status", "ID", "uf", true, {"json", "table", "csv"}, query_status,
	 "progress of a study", ""},
	{"wait", "ID", "uf", true, {"json", "table", "csv"}, query_wait,
	 "wait until a study has ended, then print its status", ""},
	{"results", "ID", "ufTp", false, {"json", "table", "csv"}, query_results,
	 "result of a study", ""},
	{"samples", "ID", "uf", false, {"csv", "npy"}, query_samples,
	 "inputs and outputs of every sample of a study", ""},
	{"plot", "FIGURE RESULT|ID", "nup" FIGURE_KEYS, false, {0}, plot_figure,
	 "print a figure of a result as SVG",
	 "--names lists the figures.  A result is a file, - or the id of a study on the server; for `history', `force' and `timeline' "
	 "a file of samples as CSV, or an id."},
	{"report", "RESULT|ID [STUDY]", "up", false, {0}, report_print,
	 "a result as one self-contained HTML page",
	 "A result is a file, - or the id of a study on the server, which also has the study document; for a file, "
	 "give it as STUDY."},
	{"archive", "ID [FOLDER]", "uf", false, {"csv", "npy"}, archive_make,
	 "keep a finished study in a folder of its own, with checksums",
	 "Writes study.json, result.json, status.json, samples.csv (or samples.npy) if the study has samples, versions.json and "
	 "SHA256SUMS into FOLDER, by default named by the id; `sha256sum -c SHA256SUMS' in it checks them.  `pound run "
	 "study.json' of the engine_version in versions.json gives the same result again."},
	{"list", "", "sAHlcuf", true, {"json", "table", "csv"}, query_list,
	 "studies on the server, newest first", ""},
	{"cancel", "ID", "uf", true, {"json", "table", "csv"}, query_cancel,
	 "cancel a queued or running study", ""},
	{"delete", "ID", "u", false, {0}, query_delete,
	 "delete a study and its result from the server", ""},
	{"example", "[NAME] [FOLDER]", "n", false, {0}, example_print,
	 "print a complete study document to start from",
	 "Without NAME, the paper's study.  With FOLDER writes it as NAME.json into that folder, and recorded ground motions as "
	 "files beside it.  --names lists the examples."},
	{"record", "FILE...", "UdCPf", true, {"json", "table", "csv"}, record_show,
	 "contents of files of recorded ground motions",
	 "Reads PEER NGA (.AT2), COSMOS (.V1, .V2), ESM and ITACA (.ASC), and columns: time and acceleration, or "
	 "accelerations with --step.  Shows samples, step, PGA, PGV, PGD, Arias intensity, 5-95 % duration, and with "
	 "--periods pseudo-accelerations at 5 % damping.  Nothing is filtered or corrected."},
	{"motion", "STUDY.json", "PRf" MOTION_KEYS, false, {"csv", "npy", "at2"}, motion_show,
	 "the ground motions of a study",
	 "Prints every signal of the first sample, or the signal chosen by --signal; as at2 (PEER) one signal.  With "
	 "--periods pseudo-accelerations at 5 % damping in their place."},
};

static const struct argp_option OPTIONS[] = {
	{"threads", 't', "N",      0, "compute with N threads (default: number of cores)", 0},
	{"samples", 'o', "FILE",   0, "also write every sample, the histories, or the contacts, to FILE (NumPy if it ends in .npy, else CSV)", 0},
	{"launcher",   'L', "COMMAND", 0, "command that starts worker processes, such as 'srun pound-worker'", 0},
	{"launchers",  'B', "N",   0, "run this command N times; each is a worker group that starts and fails independently (default: 1)", 0},
	{"worker-host", 'Q', "HOST", 0, "name or address of this machine for workers on other machines; listens on all addresses (default: loopback)", 0},
	{"worker-listen", 'E', "ADDRESS:PORT", 0, "address and port at which workers that are started elsewhere connect", 0},
	{"worker-token-file", 'F', "FILE", 0, "token of those workers: 64 hexadecimal digits", 0},
	{"checkpoint", 'k', "FILE", 0, "keep finished blocks in FILE, and continue with those in it", 0},
	{"wait",    'w', NULL,     0, "follow the study until it has ended", 0},
	{"status",  's', "STATE",  0, "only queued, running, succeeded, failed or cancelled studies", 0},
	{"name",    'A', "TEXT",   0, "only studies with this text in their name; case matters", 0},
	{"hash",    'H', "HASH",   0, "only studies with this study_hash, as in a result: the same study, whatever its name", 0},
	{"limit",   'l', "N",      0, "at most N studies", 0},
	{"cursor",  'c', "CURSOR", 0, "continue an earlier list", 0},
	{"names",   'n', NULL,     0, "print the available names", 0},
	{"given",   'g', NULL,     0, "the first file has samples of the inputs as CSV, in place of a study", 0},
	{"url",     'u', "URL",    0, "URL of the server (default: $POUND_URL or http://127.0.0.1:8437)", 0},
	{"format",  'f', "FORMAT", 0, "format of the output", 0},
	{"table",   'T', "NAME",   0, "one table of a result, if it has it:" TABLES "; or all (only --format table); default: a summary (table), the first of its kind (csv)", 0},
	{"unit",    'U', "UNIT",   0, "unit of accelerations, for files that do not name it: g, cm/s2 or m/s2", 0},
	{"step",    'd', "S",      0, "time step in s, for files that have accelerations alone", 0},
	{"row",     'R', "N",      0, "row of the design, from 1 (default: 1)", 0},
	{"channel", 'C', "N",      0, "channel to read, for files that have several", 0},
	{"periods", 'P', "LIST",   0, "comma-separated periods of a response spectrum, in s", 0},
	{"partial", 'p', NULL,     0, "intermediate result of the completed rows, if the study is still running", 0},
	{"model",   'm', "URL",    0, "URL of the model's server", 0},
	{"name",    'N', "NAME",   0, "name of the model there (default: the first)", 0},
	{"jobs",    'j', "N",      0, "runs at the same time (default: 8)", 0},
	{"journal", 'J', "FILE",   0, "keep every run in FILE, and skip the runs that FILE already has", 0},
	{"outputs", 'O', "NAMES",  0, "comma-separated names of the outputs (default: y1,y2,...)", 0},
	{"config",  'G', "JSON",   0, "configuration of the model, an object", 0},
	{"replicates", 'K', "N",   0, "runs of a random model at each point; their mean and the variance of that mean are used; needs --seed-member", 0},
	{"seed-member", 'S', "NAME", 0, "member of the configuration that is set to the number of a run: 0, 1, ...", 0},
	{"timeout", 'W', "S",      0, "seconds for one run (default: no limit)", 0},
#define X(name, values, lowest, highest, text) {#name, FIGURE_KEY_##name, "VALUE", 0, text, 0},
	FIGURE_ARGUMENTS(X)
#undef X
};
// clang-format on

enum {
	N_COMMANDS = sizeof COMMANDS / sizeof COMMANDS[0],
	N_OPTIONS = sizeof OPTIONS / sizeof OPTIONS[0],
};

struct parsing {
	const struct command *command;
	struct options options;
};

static int whole_number(struct argp_state *state, const char *option, const char *text, int max)
{
	char *end;
	errno = 0;
	long value = strtol(text, &end, 10);
	if (*end || end == text || errno || value < 1 || value > max)
		argp_error(state, "%s must be a whole number from 1 to %d, got '%s'", option, max, text);
	return (int)value;
}

static double positive_number(struct argp_state *state, const char *option, const char *text)
{
	char *end;
	const double value = strtod(text, &end);
	if (*end || end == text || !(value > 0 && value <= 1e6))
		argp_error(state, "%s must be a number in (0, 1e6], got '%s'", option, text);
	return value;
}

static void take_argument(struct argp_state *state, struct parsing *parsing, const char *argument)
{
	const char *takes = parsing->command->arguments, *second = strchr(takes, ' ');
	parsing->options.files[parsing->options.n_files++] = argument;
	if (strstr(takes, "...") && parsing->options.argument)
		return;
	if (!*takes || (parsing->options.argument && !second) || parsing->options.second)
		argp_error(state, "'%s' is an unexpected argument", argument);
	*(parsing->options.argument ? &parsing->options.second : &parsing->options.argument) = argument;
}

/* Ends the command: a name is not among the choices; `more` is where to see them. */
static void refuse_name(struct argp_state *state, const char *what, const char *name,
                        const char *const choices[], const char *more)
{
	struct near_name_search search = near_name_begin(name);
	for (; *choices; choices++)
		near_name_try(&search, *choices);
	const char *meant = near_name_found(&search);
	argp_error(state, "no %s '%s' here%s%s%s %s", what, name, meant ? ", did you mean '" : ";",
	           meant ? meant : "", meant ? "'?" : "", more);
}

static void check_table(struct argp_state *state, const struct options *options)
{
	char *padded = command_text(" %s ", options->table ? options->table : "inputs");
	bool all = options->table && strcmp(options->table, "all") == 0 && strcmp(options->format, "table") == 0;
	if (!all && (strchr(padded + 1, ' ') != strrchr(padded, ' ') || !strstr(TABLES " ", padded)))
		refuse_name(state, "table", options->table, TABLE_NAMES,
		            "there are:" TABLES ", and all with --format table");
	if (options->table && strcmp(options->format, "json") == 0)
		argp_error(state, "--table needs --format table or --format csv");
	free(padded);
}

/* Several ranks of this program would each compute the whole study. */
static void check_ranks(struct argp_state *state)
{
	if (launcher_ranks() > 1)
		argp_error(
		    state,
		    "this is one of %d ranks: start pound once, and its workers by --launcher '... pound-worker'",
		    launcher_ranks());
}

static error_t take_option(int key, char *value, struct argp_state *state)
{
	struct parsing *parsing = state->input;
	struct options *options = &parsing->options;
	switch (key) {
	case 't':
		options->threads = whole_number(state, "--threads", value, THREADS_MAX);
		return 0;
	case 'L':
		options->launch.command = value;
		return 0;
	case 'Q':
		options->launch.host = value;
		return 0;
	case 'B':
		options->launch.n = whole_number(state, "--launchers", value, COORDINATOR_GROUPS_MAX);
		return 0;
	case 'E':
		options->launch.at = value;
		return 0;
	case 'F':
		options->launch.token_file = value;
		return 0;
	case 'k':
		options->checkpoint = value;
		return 0;
	case 'l':
		options->limit = whole_number(state, "--limit", value, LIMIT_MAX);
		return 0;
	case 'w':
		options->wait = true;
		return 0;
	case 'n':
		options->names = true;
		return 0;
	case 'g':
		options->given = true;
		return 0;
	case 'o':
		options->samples = value;
		return 0;
	case 's':
		options->status = value;
		return 0;
	case 'A':
		options->name = value;
		return 0;
	case 'H':
		options->hash = value;
		return 0;
	case 'c':
		options->cursor = value;
		return 0;
	case 'u':
		options->url = value;
		return 0;
	case 'f':
		for (int i = 0; i < FORMATS_MAX && parsing->command->formats[i]; i++)
			if (strcmp(value, parsing->command->formats[i]) == 0) {
				options->format = value;
				return 0;
			}
		refuse_name(state, "format", value, parsing->command->formats, "see --help");
		return 0;
	case 'U':
		options->unit = value;
		return 0;
	case 'd':
		options->step = positive_number(state, "--step", value);
		return 0;
	case 'R':
		options->row = whole_number(state, "--row", value, POUND_ROWS_MAX) - 1;
		return 0;
	case 'C':
		options->channel = whole_number(state, "--channel", value, CHANNEL_MAX);
		return 0;
	case 'P':
		options->periods = value;
		return 0;
	case 'T':
		options->table = value;
		return 0;
	case 'p':
		options->partial = true;
		return 0;
	case 'm':
		options->evaluate.model = value;
		return 0;
	case 'N':
		options->evaluate.name = value;
		return 0;
	case 'j':
		options->evaluate.jobs = whole_number(state, "--jobs", value, JOBS_MAX);
		return 0;
	case 'J':
		options->evaluate.journal = value;
		return 0;
	case 'O':
		options->evaluate.outputs = value;
		return 0;
	case 'G':
		options->evaluate.config = value;
		return 0;
	case 'K':
		options->evaluate.replicates = whole_number(state, "--replicates", value, REPLICATES_MAX);
		return 0;
	case 'S':
		options->evaluate.seed_member = value;
		return 0;
	case 'W':
		options->evaluate.timeout = whole_number(state, "--timeout", value, TIMEOUT_MAX);
		return 0;
#define X(name, values, lowest, highest, text) \
	case FIGURE_KEY_##name:                    \
		options->choice.name = value;          \
		return 0;
		FIGURE_ARGUMENTS(X)
#undef X
	case ARGP_KEY_ARG:
		take_argument(state, parsing, value);
		return 0;
	case ARGP_KEY_END:
		check_table(state, options);
		if (options->names)
			return 0;
		if (strchr(parsing->command->takes, 'm') && !options->evaluate.model)
			argp_error(state, "--model is missing");
		if (launch_fault(&options->launch))
			argp_error(state, "%s", launch_fault(&options->launch));
		if (strchr(parsing->command->takes, 'L'))
			check_ranks(state);
		if (options->evaluate.replicates && !options->evaluate.seed_member)
			argp_error(state, "--replicates needs --seed-member: otherwise all replicates may be equal");
		if (!options->argument && *parsing->command->arguments && *parsing->command->arguments != '[')
			argp_error(state, "%s is missing", parsing->command->arguments);
		if (!options->second && strchr(parsing->command->arguments, ' ') &&
		    strchr(parsing->command->arguments, ' ')[1] != '[')
			argp_error(state, "%s is missing", strchr(parsing->command->arguments, ' ') + 1);
		return 0;
	}
	return ARGP_ERR_UNKNOWN;
}

static int cores(void)
{
	cpu_set_t set;
	int n = sched_getaffinity(0, sizeof set, &set) == 0 ? CPU_COUNT(&set) : 1;
	return n < THREADS_MAX ? n : THREADS_MAX;
}

/* Names the formats of a subcommand in the help of its --format, written to `text` of n characters. */
static void formats_name(const struct command *command, struct argp_option *taken, size_t n, char *text)
{
	while (taken->key && taken->key != 'f')
		taken++;
	int length = snprintf(text, n, "%s", taken->doc ? taken->doc : "");
	for (int i = 0; i < FORMATS_MAX && command->formats[i]; i++)
		length += snprintf(text + length, n - (size_t)length, "%s%s", i ? ", " : ": ", command->formats[i]);
	if (command->terminal_table)
		snprintf(text + length, n - (size_t)length, " (on a terminal: table)");
	taken->doc = taken->key ? text : NULL;
}

/* Reads a subcommand's options and runs it. */
static enum outcome command_run(const struct command *command, int argc, char **argv)
{
	struct argp_option taken[N_OPTIONS + 1] = {0};
	char name[32], text[1000], formats[80];
	for (int i = 0, n = 0; i < N_OPTIONS; i++)
		if (strchr(command->takes, OPTIONS[i].key))
			taken[n++] = OPTIONS[i];
	formats_name(command, taken, sizeof formats, formats);
	snprintf(name, sizeof name, "pound %s", command->name);
	const int length = snprintf(text, sizeof text, "%c%s.%s%s", command->help[0] - 'a' + 'A',
	                            command->help + 1, *command->more ? "  " : "", command->more);
	assert(length < (int)sizeof text);
	argv[0] = name;
	const char *url = getenv("POUND_URL");
	struct parsing parsing = {
	    .command = command,
	    .options = {.files = command_sure(calloc((size_t)argc, sizeof(const char *))),
	                .url = url && *url ? url : URL_DEFAULT,
	                .format =
	                    command->terminal_table && isatty(STDOUT_FILENO) ? "table" : command->formats[0],
	                .threads = cores(),
	                .evaluate.jobs = JOBS},
	};
	// NULL instead of an empty list, with which argp's help leaks memory
	struct argp argp = {.options = taken->key ? taken : NULL,
	                    .parser = take_option,
	                    .args_doc = command->arguments,
	                    .doc = text};
	argp_parse(&argp, argc, argv, 0, NULL, &parsing);
	enum outcome outcome = command->run(&parsing.options);
	free(parsing.options.files);
	return outcome;
}

static void usage(FILE *out)
{
	fputs("Usage: pound COMMAND [OPTION...] [ARGUMENT]\n"
	      "Earthquake-induced pounding of neighboring buildings and its sensitivity to their properties.\n\n",
	      out);
	for (int i = 0; i < N_COMMANDS; i++) {
		char call[32];
		snprintf(call, sizeof call, "%s %s", COMMANDS[i].name, COMMANDS[i].arguments);
		fprintf(out, "  %-24s  %s\n", call, COMMANDS[i].help);
	}
	fputs("\nSTUDY.json may be - for standard input.  More: `pound COMMAND --help', `pound --version'.\n"
	      "Exit status: 0 done, 1 failed, 2 wrong usage or an invalid study, 3 the study failed or was\n"
	      "canceled, 4 the server cannot be reached.\n",
	      out);
}

int main(int argc, char **argv)
{
	argp_program_version = "pound " POUND_VERSION;
	argp_err_exit_status = OUTCOME_USAGE;
	if (argc < 2) {
		usage(stderr);
		return OUTCOME_USAGE;
	}
	if (strcmp(argv[1], "--help") == 0 || strcmp(argv[1], "-h") == 0) {
		usage(stdout);
		return OUTCOME_OK;
	}
	if (strcmp(argv[1], "--version") == 0 || strcmp(argv[1], "-V") == 0) {
		puts(argp_program_version);
		return OUTCOME_OK;
	}
	for (int i = 0; i < N_COMMANDS; i++) {
		if (strcmp(argv[1], COMMANDS[i].name) != 0)
			continue;
		enum outcome outcome = command_run(&COMMANDS[i], argc - 1, argv + 1);
		if (fflush(stdout) != 0 || ferror(stdout)) {
			command_complain("cannot write the output: %s", strerror(errno));
			return OUTCOME_FAILED;
		}
		return outcome;
	}
	command_complain("unknown command '%s'; see pound --help", argv[1]);
	return OUTCOME_USAGE;
}
