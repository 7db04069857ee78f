/* poundd: opens the store, starts the workers, listens, and waits for the signal to stop. */
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include "server/http.h"
#include "server/log.h"
#include "server/options.h"
#include "server/store.h"
#include "server/token.h"
#include "server/work.h"

static int serve(struct server *server, const sigset_t *signals)
{
	server->work = work_start(server->store, server->options->workers);
	if (!server->work)
		return EXIT_FAILURE;
	struct http *http = http_start(server);
	if (http) {
		int caught;
		const char *listen = server->options->listen;
		bool v6 = strchr(listen, ':');
		printf("listening on http://%s%s%s:%d\n", v6 ? "[" : "", listen, v6 ? "]" : "", http_port(http));
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
	struct options options;
	sigset_t signals;
	options_read(&options, argc, argv);
	umask(077);
	// a client that has gone, and a file that may not grow, are errors of a write and no more
	signal(SIGPIPE, SIG_IGN);
	signal(SIGXFSZ, SIG_IGN);
	// blocked before any thread starts, so that only sigwait sees them
	sigemptyset(&signals);
	sigaddset(&signals, SIGTERM);
	sigaddset(&signals, SIGINT);
	pthread_sigmask(SIG_BLOCK, &signals, NULL);

	struct server server = {.options = &options};
	if (options.token_file && !(server.tokens = tokens_open(options.token_file)))
		return EXIT_FAILURE;
	server.store = store_open(options.database);
	if (!server.store)
		return EXIT_FAILURE;
	int status = serve(&server, &signals);
	store_close(server.store);
	tokens_close(server.tokens);
	return status;
}
