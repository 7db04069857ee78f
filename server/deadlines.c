/* Connections and their deadlines.
 *
 * libmicrohttpd's own timeout restarts with every byte, so a client that sends one now and then could stay forever;
 * these deadlines are absolute.  The socket of a late connection is shut down, which libmicrohttpd sees as its end.  A
 * connection leaves the list before its descriptor is closed: a reused descriptor is never shut down by mistake. */
#include "server/deadlines.h"

#include <errno.h>
#include <math.h>
#include <poll.h>
#include <stdlib.h>
#include <string.h>
#include <sys/socket.h>
#include <time.h>
#include <unistd.h>

#include "server/log.h"
#include "server/store.h"

enum {
	TICK_NS = 50000000,    /* [ns] */
	LINGER_S = 5,          /* [s] a client may still send after its answer */
	TICK_BYTES = 16 << 20, /* read per tick from all draining connections, while the list is locked */
	GONE_EVERY = 8,        /* ticks between checks whether a waiting client is still connected */
};

double connection_now(void)
{
	struct timespec now;
	clock_gettime(CLOCK_MONOTONIC, &now);
	return (double)now.tv_sec + 1e-9 * (double)now.tv_nsec;
}

/* Reads and discards what has arrived, at most what is left for this tick; false: the client has closed. */
static bool drain(const struct connection *connection, ssize_t *left)
{
	static _Thread_local char bytes[65536];
	ssize_t n = 1;
	while (n > 0 && *left > 0) {
		n = recv(connection->fd, bytes, sizeof bytes, MSG_DONTWAIT);
		*left -= n;
	}
	return n > 0 || (n < 0 && (errno == EAGAIN || errno == EINTR));
}

/* Whether a client has disconnected, seen at two checks, so that an answer made at once is still sent.  A client that only
 * shuts down its sending side counts as disconnected: a closed socket looks the same. */
static bool gone(struct connection *connection)
{
	struct pollfd end = {.fd = connection->fd, .events = POLLRDHUP};
	bool before = connection->gone;
	connection->gone = poll(&end, 1, 0) > 0;
	return before && connection->gone;
}

static void look(struct connections *all, struct connection *connection, double now, int tick, ssize_t *left)
{
	if (connection->draining) {
		if (drain(connection, left) && now < connection->deadline && !all->stopping)
			return;
		close(connection->fd);
		LIST_REMOVE(connection, others);
		free(connection);
		all->n_draining--;
	} else if (connection->handle) {
		if ((connection->fd + tick) % GONE_EVERY == 0)
			connection->unwanted = gone(connection);
		if (now < connection->until && !all->released && !connection->unwanted &&
		    connection->changes == store_changes(all->store, connection->id))
			return;
		// before the request resumes, for it may wait again at once
		all->n_waiting--;
		all->resume(atomic_exchange(&connection->handle, NULL));
	} else if (connection->answering) {
		if (all->released || gone(connection))
			connection->unwanted = true;
	} else if (now > connection->deadline) {
		all->n_late++;
		connection->deadline = INFINITY;
		shutdown(connection->fd, SHUT_RDWR);
	}
}

static void *watch(void *of)
{
	struct connections *all = of;
	bool stopping = false;
	for (int tick = 0; !stopping; tick = (tick + 1) % GONE_EVERY) {
		nanosleep(&(struct timespec){.tv_nsec = TICK_NS}, NULL);
		double now = connection_now();
		ssize_t left = TICK_BYTES;
		pthread_mutex_lock(&all->lock);
		stopping = all->stopping;
		for (struct connection *connection = LIST_FIRST(&all->list), *next; connection; connection = next) {
			next = LIST_NEXT(connection, others);
			look(all, connection, now, tick, &left);
		}
		pthread_mutex_unlock(&all->lock);
	}
	return NULL;
}

/* Starts the watch thread.
 *
 * Given    all      its store, resume and limits
 * Returns  value    false: no thread, logged
 */
bool connections_start(struct connections *all)
{
	LIST_INIT(&all->list);
	pthread_mutex_init(&all->lock, NULL);
	int error = pthread_create(&all->thread, NULL, watch, all);
	if (error)
		log_line("cannot start the thread that watches connections: %s", strerror(error));
	else
		pthread_setname_np(all->thread, "connections"); // for top -H
	return error == 0;
}

/* Ends the watch thread, after all connections were closed. */
void connections_stop(struct connections *all)
{
	all->stopping = true;
	pthread_join(all->thread, NULL);
	pthread_mutex_destroy(&all->lock);
}

/* Adds a new connection.
 *
 * Given    seconds   in which the headers of the first request must arrive
 * Returns  value     for connection_closed; NULL: no memory
 */
struct connection *connection_opened(struct connections *all, int fd, double seconds)
{
	struct connection *connection = calloc(1, sizeof *connection);
	if (!connection)
		return NULL;
	connection->fd = fd;
	connection->deadline = connection_now() + seconds;
	const int n = ++all->n;
	connection->served = n <= all->most;
	connection->probed = n <= all->most_probed;
	pthread_mutex_lock(&all->lock);
	LIST_INSERT_HEAD(&all->list, connection, others);
	pthread_mutex_unlock(&all->lock);
	return connection;
}

/* Removes it from the list, or drains what its client still sends, through a duplicate of its descriptor. */
void connection_closed(struct connections *all, struct connection *connection)
{
	all->n--;
	pthread_mutex_lock(&all->lock);
	int fd = connection->lingers && all->n_draining < all->most_draining ? dup(connection->fd) : -1;
	if (fd >= 0) {
		connection->fd = fd;
		connection->draining = true;
		connection->deadline = connection_now() + LINGER_S;
		all->n_draining++;
	} else
		LIST_REMOVE(connection, others);
	pthread_mutex_unlock(&all->lock);
	if (fd < 0)
		free(connection);
}

/* Registers a suspended request, to be resumed by its handle when its study changes or its time is over. */
void connection_wait(struct connections *all, struct connection *connection, void *handle, int64_t id,
                     unsigned changes, double until)
{
	all->n_waiting++;
	connection->id = id;
	connection->changes = changes;
	connection->until = until;
	connection->handle = handle; // written last: the watch thread reads the others once it is set
}
