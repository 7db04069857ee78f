/* Connections and their deadlines.
 *
 * libmicrohttpd's own timeout starts again with every byte, which lets a client that sends one now and then stay for
 * ever; these deadlines are absolute.  Who is late has his socket shut down, which libmicrohttpd sees as the end.  A
 * connection is taken off the list before its descriptor is closed, so that none is shut down that is another's. */
#include "server/connection.h"

#include <errno.h>
#include <math.h>
#include <pthread.h>
#include <stdlib.h>
#include <sys/socket.h>
#include <time.h>
#include <unistd.h>

#include "server/store.h"

enum {
	TICK_NS = 50000000,    /* [ns] */
	LINGER_S = 5,          /* [s] a client may go on sending */
	LINGERING_MAX = 256,   /* clients who do so */
	TICK_BYTES = 16 << 20, /* read of one of them in a tick */
};

struct connection {
	struct connection *next, **link; /* link: what points here */
	int fd;
	double deadline;  /* [s] monotonic */
	bool served;      /* it was not one too many when it came */
	bool lingers;     /* to be drained when it is closed */
	bool draining;    /* closed by its owner; fd is our own */
	void *handle;     /* NULL: does not wait */
	int64_t id;       /* of the study waited for */
	unsigned changes; /* of that study, when it was looked at */
	double until;     /* [s] monotonic */
};

struct connections {
	struct store *store;
	connection_resumer *resume;
	pthread_t thread;
	pthread_mutex_t lock; /* of all below */
	struct connection *first;
	int most, n, n_draining, n_late;
	bool released, stopping;
};

double connection_now(void)
{
	struct timespec now;
	clock_gettime(CLOCK_MONOTONIC, &now);
	return (double)now.tv_sec + 1e-9 * (double)now.tv_nsec;
}

static void put(struct connections *all, struct connection *connection)
{
	connection->next = all->first;
	connection->link = &all->first;
	if (all->first)
		all->first->link = &connection->next;
	all->first = connection;
}

static void take(struct connection *connection)
{
	*connection->link = connection->next;
	if (connection->next)
		connection->next->link = connection->link;
}

/* Reads what has come; false: nothing more will. */
static bool drain(const struct connection *connection)
{
	static _Thread_local char bytes[65536];
	ssize_t n = 1;
	for (ssize_t sum = 0; n > 0 && sum < TICK_BYTES; sum += n)
		n = recv(connection->fd, bytes, sizeof bytes, MSG_DONTWAIT);
	return n > 0 || (n < 0 && (errno == EAGAIN || errno == EINTR));
}

static void look(struct connections *all, struct connection *connection, double now)
{
	if (connection->draining) {
		if (drain(connection) && now < connection->deadline && !all->stopping)
			return;
		close(connection->fd);
		take(connection);
		free(connection);
		all->n_draining--;
	} else if (connection->handle) {
		if (now < connection->until && !all->released &&
		    connection->changes == store_changes(all->store, connection->id))
			return;
		all->resume(connection->handle);
		connection->handle = NULL;
	} else if (now > connection->deadline) {
		shutdown(connection->fd, SHUT_RDWR);
		connection->deadline = INFINITY;
		all->n_late++;
	}
}

static void *watch(void *of)
{
	struct connections *all = of;
	bool stopping = false;
	while (!stopping) {
		nanosleep(&(struct timespec){.tv_nsec = TICK_NS}, NULL);
		double now = connection_now();
		pthread_mutex_lock(&all->lock);
		stopping = all->stopping;
		for (struct connection *connection = all->first, *next; connection; connection = next) {
			next = connection->next;
			look(all, connection, now);
		}
		pthread_mutex_unlock(&all->lock);
	}
	return NULL;
}

/* Starts to watch over connections.
 *
 * Given    store    whose changes are waited for
 *          resume   called with the handle of who waited
 *          most     connections are served; those beyond are to be told so and closed
 * Returns  value    for connections_stop; NULL: no memory, no thread
 */
struct connections *connections_start(struct store *store, connection_resumer *resume, int most)
{
	struct connections *all = calloc(1, sizeof *all);
	if (!all)
		return NULL;
	all->store = store;
	all->resume = resume;
	all->most = most;
	pthread_mutex_init(&all->lock, NULL);
	if (pthread_create(&all->thread, NULL, watch, all) == 0)
		return all;
	free(all);
	return NULL;
}

void connections_release(struct connections *all)
{
	pthread_mutex_lock(&all->lock);
	all->released = true;
	pthread_mutex_unlock(&all->lock);
}

void connections_stop(struct connections *all)
{
	pthread_mutex_lock(&all->lock);
	all->stopping = true;
	pthread_mutex_unlock(&all->lock);
	pthread_join(all->thread, NULL);
	pthread_mutex_destroy(&all->lock);
	free(all);
}

static int count(struct connections *all, const int *n)
{
	pthread_mutex_lock(&all->lock);
	int value = *n;
	pthread_mutex_unlock(&all->lock);
	return value;
}

int connections_open(struct connections *all)
{
	return count(all, &all->n);
}

int connections_late(struct connections *all)
{
	return count(all, &all->n_late);
}

struct connection *connection_opened(struct connections *all, int fd, double seconds)
{
	struct connection *connection = calloc(1, sizeof *connection);
	if (!connection)
		return NULL;
	connection->fd = fd;
	connection->deadline = connection_now() + seconds;
	pthread_mutex_lock(&all->lock);
	put(all, connection);
	connection->served = ++all->n <= all->most;
	pthread_mutex_unlock(&all->lock);
	return connection;
}

bool connection_served(const struct connection *connection)
{
	return connection->served;
}

void connection_closed(struct connections *all, struct connection *connection)
{
	pthread_mutex_lock(&all->lock);
	all->n--;
	int fd = connection->lingers && all->n_draining < LINGERING_MAX ? dup(connection->fd) : -1;
	if (fd >= 0) {
		connection->fd = fd;
		connection->draining = true;
		connection->deadline = connection_now() + LINGER_S;
		all->n_draining++;
	} else
		take(connection);
	pthread_mutex_unlock(&all->lock);
	if (fd < 0)
		free(connection);
}

void connection_allow(struct connections *all, struct connection *connection, double seconds)
{
	pthread_mutex_lock(&all->lock);
	connection->deadline = connection_now() + seconds;
	pthread_mutex_unlock(&all->lock);
}

void connection_linger(struct connections *all, struct connection *connection)
{
	pthread_mutex_lock(&all->lock);
	connection->lingers = true;
	pthread_mutex_unlock(&all->lock);
}

void connection_wait(struct connections *all, struct connection *connection, void *handle, int64_t id,
                     unsigned changes, double until)
{
	pthread_mutex_lock(&all->lock);
	connection->handle = handle;
	connection->id = id;
	connection->changes = changes;
	connection->until = until;
	connection->deadline = INFINITY;
	pthread_mutex_unlock(&all->lock);
}
