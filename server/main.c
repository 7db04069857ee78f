/* poundd: opens the store, starts the workers, listens, and waits for the signal to stop. */
#include <argp.h>
#include <limits.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include "engine/pound.h"
#include "server/http.h"
#include "server/log.h"
#include "server/store.h"
#include "server/work.h"

enum { WORKERS_MAX = 1024 };

struct options {
	const char *listen, *database;
	int port, n_workers;
};

static int whole(const char *text, int min, int max, const char *option, struct argp_state *state)
{
	char *rest;
	long value = strtol(text, &rest, 10);
	if (rest == text || *rest || value < min || value > max)
		argp_error(state, "--%s must be a whole number in [%d, %d], got '%s'", option, min, max, text);
	return (int)value;
}

static error_t option(int key, char *value, struct argp_state *state)
{
	struct options *options = state->input;
	if (key == 'p')
		options->port = whole(value, 0, 65535, "port", state);
	else if (key == 'l')
		options->listen = value;
	else if (key == 'd')
		options->database = value;
	else if (key == 'w')
		options->n_workers = whole(value, 1, WORKERS_MAX, "workers", state);
	else
		return ARGP_ERR_UNKNOWN;
	return 0;
}

static const struct argp_option option_table[] = {
    {"port", 'p', "PORT", 0, "Listen on PORT, 0: any that is free (8437)", 0},
    {"listen", 'l', "ADDRESS", 0, "Listen on ADDRESS (127.0.0.1)", 0},
    {"database", 'd', "FILE", 0, "Keep studies in FILE (poundd.db)", 0},
    {"workers", 'w', "N", 0, "Compute with N threads (one for each core)", 0},
    {0},
};

const char *argp_program_version = "poundd " POUND_VERSION;

static int serve(struct server *server, const struct options *options, const sigset_t *signals)
{
	server->work = work_start(server->store, server->n_workers);
	if (!server->work)
		return EXIT_FAILURE;
	struct http *http = http_start(options->listen, options->port, server);
	if (http) {
		int caught;
		bool v6 = strchr(options->listen, ':');
		printf("listening on http://%s%s%s:%d\n", v6 ? "[" : "", options->listen, v6 ? "]" : "",
		       http_port(http));
		fflush(stdout);
		sigwait(signals, &caught);
		log_line("stopping: %s", strsignal(caught));
		http_stop(http);
	}
	work_stop(server->work);
	return http ? EXIT_SUCCESS : EXIT_FAILURE;
}

int main(int argc, char **argv)
{
	static const struct argp argp = {
	    option_table, option, NULL, "Serves pounding studies over HTTP.", 0, 0, 0};
	long cores = sysconf(_SC_NPROCESSORS_ONLN);
	struct options options = {.listen = "127.0.0.1",
	                          .database = "poundd.db",
	                          .port = 8437,
	                          .n_workers = cores < 1             ? 1
	                                       : cores > WORKERS_MAX ? WORKERS_MAX
	                                                             : (int)cores};
	sigset_t signals;
	argp_parse(&argp, argc, argv, 0, NULL, &options);
	umask(077);
	// a client that has gone, and a file that may not grow, are errors of a write and no more
	signal(SIGPIPE, SIG_IGN);
	signal(SIGXFSZ, SIG_IGN);
	// blocked before any thread starts, so that only sigwait sees them
	sigemptyset(&signals);
	sigaddset(&signals, SIGTERM);
	sigaddset(&signals, SIGINT);
	pthread_sigmask(SIG_BLOCK, &signals, NULL);

	struct server server = {.store = store_open(options.database), .n_workers = options.n_workers};
	if (!server.store)
		return EXIT_FAILURE;
	int status = serve(&server, &options, &signals);
	store_close(server.store);
	return status;
}
