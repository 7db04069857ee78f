/* poundd: opens the store, starts the workers, listens, and waits for the signal to stop. */
#include <errno.h>
#include <fcntl.h>
#include <malloc.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/socket.h>
#include <sys/stat.h>
#include <sys/un.h>
#include <time.h>
#include <unistd.h>

#include <gsl/gsl_errno.h>

#include "server/backup.h"
#include "server/daemon.h"
#include "server/log.h"
#include "server/options.h"
#include "server/store.h"
#include "server/token.h"
#include "server/workers.h"

enum {
	STOP_MAX = 25, /* [s] from the signal to the exit in any case: accepted studies are on the disk */
	EXPIRY_PERIOD = 60000000, /* [us] between two searches for studies to delete */
	STORE_WAIT_MS = 100, /* for the writing connection to the database, when workers do not exit in time */
};

/* Opens /dev/null for each closed standard stream: else a file opened later would get its number, and the output. */
static void hold_streams(void)
{
	int file = open("/dev/null", O_RDWR);
	while (file >= 0 && file <= STDERR_FILENO)
		file = dup(file);
	close(file);
}

/* Reports our state to systemd, if it has started us; see sd_notify(3) for the states. */
static void notify(const char *state)
{
	const char *path = getenv("NOTIFY_SOCKET");
	struct sockaddr_un to = {.sun_family = AF_UNIX};
	size_t n = path ? strlen(path) : 0;
	if (n == 0 || n >= sizeof to.sun_path)
		return;
	memcpy(to.sun_path, path, n);
	// a socket in the abstract namespace
	if (path[0] == '@')
		to.sun_path[0] = '\0';
	socklen_t size = (socklen_t)(offsetof(struct sockaddr_un, sun_path) + n);
	int end = socket(AF_UNIX, SOCK_DGRAM | SOCK_CLOEXEC, 0);
	if (sendto(end, state, strlen(state), MSG_NOSIGNAL | MSG_DONTWAIT, (struct sockaddr *)&to, size) < 0)
		log_line("cannot notify systemd %s: %s", state, strerror(errno));
	close(end);
}

/* Waits for the signal to stop; meanwhile deletes expired studies one at a time, and notifies systemd's watchdog, if enabled,
 * while the store answers.
 *
 * Test     service_retention: studies_and_samples_are_deleted_when_their_time_is_up
 */
static int await(const struct server *server, const sigset_t *signals)
{
	const struct options *options = server->options;
	const char *watchdog = getenv("WATCHDOG_USEC");
	const long long half = watchdog ? atoll(watchdog) / 2 : 0,
	                period = half > 0 && half < EXPIRY_PERIOD ? half : EXPIRY_PERIOD;
	for (;;) {
		int64_t n;
		const bool more = store_expire(server->store, options->keep_days, options->keep_samples_days);
		const struct timespec pause = {.tv_sec = more ? 0 : period / 1000000,
		                               .tv_nsec = more ? 0 : period % 1000000 * 1000};
		const int caught = sigtimedwait(signals, NULL, &pause);
		if (caught > 0)
			return caught;
		if (errno == EAGAIN && half > 0 && store_count(server->store, "queued", &n) == STORE_OK)
			notify("WATCHDOG=1");
	}
}

static int serve(struct server *server, const sigset_t *signals)
{
	server->work = work_start(server->store, server->options->workers, server->options->time_max,
	                          server->options->cpu_max, (int64_t)server->options->memory_max << 20,
	                          &server->options->launch);
	if (!server->work)
		return EXIT_FAILURE;
	bool listens = partial_maker_start(&server->partial_maker, server) && daemon_start(server), ended = true;
	if (listens) {
		const char *listen = server->options->listen;
		bool v6 = strchr(listen, ':');
		printf("listening on http://%s%s%s:%d\n", v6 ? "[" : "", listen, v6 ? "]" : "", daemon_port(server));
		fflush(stdout);
		notify("READY=1");
		log_line("stopping: %s", strsignal(await(server, signals)));
		notify("STOPPING=1");
		// the next signal or the alarm ends the program at once
		alarm(STOP_MAX);
		pthread_sigmask(SIG_UNBLOCK, signals, NULL);
		ended = daemon_stop(server);
	}
	ended &= partial_maker_stop(&server->partial_maker);
	ended &= work_stop(server->work, ended);
	// accepted studies are on the disk: the next start resumes them as after a crash
	if (!ended)
		store_stop(server->store, STORE_WAIT_MS);
	if (!ended)
		_exit(listens ? EXIT_SUCCESS : EXIT_FAILURE);
	return listens ? EXIT_SUCCESS : EXIT_FAILURE;
}

int main(int argc, char **argv)
{
	struct options options;
	sigset_t signals;
	hold_streams();
	options_read(&options, argc, argv);
	umask(077);
	const char *fault = launch_fault(&options.launch);
	if (fault) {
		log_line("%s", fault);
		return EXIT_FAILURE;
	}
	if (options.backup)
		return backup_make(options.database, options.backup) ? EXIT_SUCCESS : EXIT_FAILURE;
	if (options.restore)
		return backup_restore(options.database, options.restore) ? EXIT_SUCCESS : EXIT_FAILURE;
	// memory of one large body or result returns to the system when it is freed
	mallopt(M_MMAP_THRESHOLD, 256 * 1024);
	mallopt(M_TRIM_THRESHOLD, 1024 * 1024);
	// GSL's default handler aborts: out of memory must end the attempt, not the server
	gsl_set_error_handler_off();
	// a closed connection and the file size limit must be errors of write(2), not kill the server
	signal(SIGPIPE, SIG_IGN);
	signal(SIGXFSZ, SIG_IGN);
	// no configuration to reload, no log file to reopen; and a closed terminal must not end studies
	signal(SIGHUP, SIG_IGN);
	// blocked before any thread starts, so that only this one sees them
	sigemptyset(&signals);
	sigaddset(&signals, SIGTERM);
	sigaddset(&signals, SIGINT);
	pthread_sigmask(SIG_BLOCK, &signals, NULL);

	struct server server = {.options = &options,
	                        .answers.lock = PTHREAD_MUTEX_INITIALIZER,
	                        .partials.lock = PTHREAD_MUTEX_INITIALIZER};
	if (options.token_file && !(server.tokens = tokens_open(options.token_file)))
		return EXIT_FAILURE;
	char said[512];
	const bool listens = launch_listen(&options.launch, said, sizeof said);
	if (*said)
		log_line("%s", said);
	if (!listens)
		return EXIT_FAILURE;
	server.document = api_document(&server.document_length);
	if (!server.document)
		log_line("cannot make the OpenAPI document: out of memory");
	server.store = server.document ? store_open(options.database) : NULL;
	int status = server.store ? serve(&server, &signals) : EXIT_FAILURE;
	if (server.store)
		store_close(server.store);
	answer_cache_free(&server.answers);
	partial_results_free(&server.partials);
	free(server.document);
	free(server.tokens);
	return status;
}
