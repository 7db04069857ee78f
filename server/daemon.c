/* libmicrohttpd, started on a socket and stopped: a few threads, each with its connections.  Its callbacks are in server/http.c. */
#include "server/daemon.h"

#include <errno.h>
#include <math.h>
#include <stdio.h>
#include <string.h>
#include <sys/param.h>
#include <sys/resource.h>
#include <time.h>

#include "schema/message/coordinator.h"
#include "schema/message/listen.h"
#include "server/http_calls.h"
#include "server/log.h"

enum {
	THREADS = 4,
	TURNS = 2,               /* slow answers made at a time */
	CONNECTIONS_MAX = 4096,  /* of libmicrohttpd: further clients would hang unanswered */
	CONNECTIONS_MIN = 8,     /* at least; they are divided among the threads */
	DRAINING_MAX = 256,      /* clients that still send after their answer */
	PROBES = 64,             /* connections beyond the limit that get answers to probes */
	SPOOLED_MAX = 256,       /* answers in files */
	FILES_BESIDE = 48,       /* descriptors other than connections: 33, and short-lived ones */
	OF_ADDRESS_MAX = 64,     /* connections of one address, unless it is loopback */
	POOL = 32 * 1024,        /* [bytes] of a connection: twice HEAD_BYTES_MAX, for the parsed head */
	STOP_S = 5,              /* [s] for requests under way when the server stops */
	STOP_TICK_NS = 10000000, /* [ns] */
};

static const double STOP_ASIDE_S = 0.3; /* [s] for abandoned answers to end */

static void notice(void *of, struct MHD_Connection *connection, void **context,
                   enum MHD_ConnectionNotificationCode code)
{
	struct server *server = of;
	int fd = MHD_get_connection_info(connection, MHD_CONNECTION_INFO_CONNECTION_FD)->connect_fd;
	if (code == MHD_CONNECTION_NOTIFY_STARTED)
		*context = connection_opened(&server->connections, fd, server->options->header_timeout);
	else if (*context)
		connection_closed(&server->connections, *context);
}

/* Connections that arrive while the server stops are closed: else clients that keep connecting would keep it running. */
static enum MHD_Result welcome(void *of, const struct sockaddr *address, socklen_t n)
{
	const struct server *server = of;
	(void)address;
	(void)n;
	return server->stopping ? MHD_NO : MHD_YES;
}

/* Called by libmicrohttpd for its messages, perhaps a hundred thousand times per second: at most one per second is logged. */
static void log_library(void *of, const char *format, va_list values)
{
	struct server *server = of;
	const double now = connection_now();
	double reported = server->library_reported;
	char text[256];
	if (now < reported + 1 || !atomic_compare_exchange_strong(&server->library_reported, &reported, now)) {
		server->library_unreported++;
		return;
	}
	vsnprintf(text, sizeof text, format, values);
	text[strcspn(text, "\n")] = '\0';
	log_line("http: %s (%d earlier messages omitted)", text, atomic_exchange(&server->library_unreported, 0));
}

/* Divides the descriptors that this process may open, after raising their limit as needed: when accept(2) finds no free
 * descriptor, the accepting thread spins.
 *
 * Returns  value   connections that libmicrohttpd may have, 0: too few, logged; nearly all are served, the others get 503
 */
static int share_files(struct server *server, int wanted)
{
	struct connections *connections = &server->connections;
	struct rlimit files = {RLIM_INFINITY, RLIM_INFINITY};
	const struct launch *launch = &server->options->launch;
	// a worker group has a listening socket, its connection and an eventfd that wakes its thread
	const int beside = FILES_BESIDE + 3 * MAX(launch->n, launch->command != NULL) +
	                   (launch->at ? 2 * COORDINATOR_GROUPS_MAX : 0);
	const rlim_t most = CONNECTIONS_MAX + DRAINING_MAX + SPOOLED_MAX + (rlim_t)beside;
	if (getrlimit(RLIMIT_NOFILE, &files) == 0 && files.rlim_cur < most) {
		struct rlimit more = {MIN(files.rlim_max, most), files.rlim_max};
		if (setrlimit(RLIMIT_NOFILE, &more) == 0)
			files = more;
	}
	const int left = (int)MIN(files.rlim_cur, most) - beside;
	connections->most_draining = MIN(left / 4, DRAINING_MAX);
	server->spools.most = MIN(left / 8, SPOOLED_MAX);
	const int all = MIN(left - connections->most_draining - server->spools.most, CONNECTIONS_MAX);
	connections->most = MIN(wanted, all - 1 - all / 64);
	connections->most_probed = MIN(connections->most + PROBES, all - 1 - all / 64);
	connections->most_waiting = (connections->most + 1) / 2;
	if (all < CONNECTIONS_MIN)
		log_line("the limit of open files (ulimit -n) is %d, too low to serve connections",
		         (int)files.rlim_cur);
	else if (connections->most < wanted)
		log_line("the limit of open files (ulimit -n) is %d: at most %d connections are served at a time "
		         "instead of %d",
		         (int)files.rlim_cur, connections->most, wanted);
	return all < CONNECTIONS_MIN ? 0 : all;
}

/* libmicrohttpd on that socket, with at most n connections. */
static struct MHD_Daemon *serving(struct server *server, const union listen_address *address, int fd, int n)
{
	return MHD_start_daemon(MHD_USE_AUTO_INTERNAL_THREAD | MHD_USE_ERROR_LOG | MHD_ALLOW_SUSPEND_RESUME, 0,
	                        welcome, server, http_answer, server, MHD_OPTION_EXTERNAL_LOGGER, log_library,
	                        server, MHD_OPTION_LISTEN_SOCKET, fd, MHD_OPTION_NOTIFY_COMPLETED, http_completed,
	                        server, MHD_OPTION_NOTIFY_CONNECTION, notice, server, MHD_OPTION_URI_LOG_CALLBACK,
	                        http_begin, server, MHD_OPTION_THREAD_POOL_SIZE, (unsigned)THREADS,
	                        MHD_OPTION_CONNECTION_LIMIT, (unsigned)n, MHD_OPTION_PER_IP_CONNECTION_LIMIT,
	                        listen_is_loopback(address) ? 0u : (unsigned)OF_ADDRESS_MAX,
	                        MHD_OPTION_CONNECTION_MEMORY_LIMIT, (size_t)POOL, MHD_OPTION_END);
}

/* Starts to answer requests, at the address and the port of the options.
 *
 * Given    server   whose options, store, work and tokens are set; it must outlive the service
 * Returns  value    for daemon_stop; false when it cannot or must not listen there, logged
 * Test     service_security: an_address_that_is_not_loopback_needs_tokens_or_insecure
 *          service_http: with_few_descriptors_fewer_are_served_and_nothing_spins
 */
bool daemon_start(struct server *server)
{
	const struct options *options = server->options;
	union listen_address address;
	if (!listen_address(options->listen, options->port, &address)) {
		log_line("cannot listen on %s: not an IP address", options->listen);
		return false;
	}
	if (!listen_is_loopback(&address) && !server->tokens && !options->insecure) {
		log_line("cannot listen on %s: it is not a loopback address, so it needs --token-file, or --insecure",
		         options->listen);
		return false;
	}
	sem_init(&server->turns, 0, TURNS);
	pthread_mutex_init(&server->shares.lock, NULL);
	server->number = (unsigned long long)time(NULL) << 32;
	server->connections.store = server->spools.store = server->store;
	server->connections.resume = http_resume;
	const int n = share_files(server, options->connections_max);
	if (n == 0)
		return false;
	if (!connections_start(&server->connections))
		return false;
	int fd = listen_open(&address, LISTEN_ONE_FAMILY);
	server->daemon = fd >= 0 ? serving(server, &address, fd, n) : NULL;
	if (server->daemon)
		return true;
	log_line("cannot listen on %s port %d: %s", options->listen, options->port, strerror(errno));
	connections_stop(&server->connections);
	return false;
}

/* The port listened on. */
int daemon_port(const struct server *server)
{
	return MHD_get_daemon_info(server->daemon, MHD_DAEMON_INFO_BIND_PORT)->port;
}

/* Stops answering.  Clients that wait for a study get 503; requests under way have a few seconds to end, slow answers,
 * which are abandoned, less.
 *
 * Returns  value   false: a slow answer did not end in time, so memory that it may use must not be freed before the program
 *                  exits
 */
bool daemon_stop(struct server *server)
{
	const double now = connection_now(), until = now + STOP_S, aside_until = now + STOP_ASIDE_S;
	server->stopping = true;
	server->connections.released = true;
	while ((server->aside > 0 && connection_now() < aside_until) ||
	       (server->under_way > server->aside && connection_now() < until))
		nanosleep(&(struct timespec){.tv_nsec = STOP_TICK_NS}, NULL);
	// libmicrohttpd must not be stopped with suspended connections
	if (server->aside > 0)
		return false;
	MHD_stop_daemon(server->daemon);
	connections_stop(&server->connections);
	return true;
}
