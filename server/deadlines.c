/* Connections and their deadlines.
 *
 * libmicrohttpd's own timeout starts again with every byte, which lets a client that sends one now and then stay for
 * ever; these deadlines are absolute.  Who is late has his socket shut down, which libmicrohttpd sees as the end.  A
 * connection is taken off the list before its descriptor is closed, so that none is shut down that is another's. */
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
	LINGER_S = 5,          /* [s] a client may go on sending */
	TICK_BYTES = 16 << 20, /* read of all of them in a tick, while the list is locked */
	GONE_EVERY = 8,        /* ticks after which one that waits is asked whether it is still there */
};

double connection_now(void)
{
	struct timespec now;
	clock_gettime(CLOCK_MONOTONIC, &now);
	return (double)now.tv_sec + 1e-9 * (double)now.tv_nsec;
}

/* Reads what has come, and no more than is left for this tick; false: nothing more will. */
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

/* Whether a client has gone, for a tick at least, so that who is answered at once is.  One who only says that he sends no more
 * is taken for one: a closed socket looks like that. */
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
		// before it goes on, for it may wait again at once
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

/* Starts to watch over connections.
 *
 * Given    all      its store, resume, most and most_draining
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

/* Ends the watch, after all of them were closed. */
void connections_stop(struct connections *all)
{
	all->stopping = true;
	pthread_join(all->thread, NULL);
	pthread_mutex_destroy(&all->lock);
}

/* Watches over a new connection.
 *
 * Given    seconds   in which it must have come to something
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

/* Takes it off the list, or drains what its client is still sending, by a descriptor of our own. */
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

/* Has a suspended request resumed by its handle, when a study changes or its time is over. */
void connection_wait(struct connections *all, struct connection *connection, void *handle, int64_t id,
                     unsigned changes, double until)
{
	all->n_waiting++;
	connection->id = id;
	connection->changes = changes;
	connection->until = until;
	connection->handle = handle; // the last, for it says that the others are there
}
