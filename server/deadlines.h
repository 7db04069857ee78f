/* deadlines.h - the open connections: their deadlines, requests that wait for a study or a slow answer, and clients that
 * still send after their answer.
 *
 * The watch thread checks all connections 20 times per second.  Any thread. */
#ifndef DEADLINES_H
#define DEADLINES_H

#include <pthread.h>
#include <stdatomic.h>
#include <stdbool.h>
#include <stdint.h>
#include <sys/queue.h>

struct store;

/* Written by the threads of its requests, except the members of the watch thread. */
struct connection {
	LIST_ENTRY(connection) others; /* the watch thread's, as are fd and draining */
	int fd;
	bool draining; /* libmicrohttpd closed it; fd is our duplicate */
	bool served;   /* false: it exceeds the limit of connections, ... */
	bool probed;   /* ... but operations that need no token are answered */
	bool lingers;  /* when it is closed, what its client still sends is read for a while, so that the
	                            client gets our answer and not a connection reset */
	_Atomic double deadline; /* [s] monotonic, when its socket is shut down */
	_Atomic(void *) handle;  /* of a suspended request, NULL: none, ... */
	int64_t id;              /* ... the study it waits for, ... */
	unsigned changes;        /* ... store_changes of the study at the last check, ... */
	double until;            /* ... and until when [s] monotonic */
	atomic_bool answering;   /* a slow answer is being made, ... */
	atomic_bool unwanted;    /* ... but the client no longer waits for it; the watch thread's, as is ... */
	bool gone;               /* ... that the client had disconnected at the last check */
};

struct connections {
	struct store *store;
	void (*resume)(void *handle);
	int most;             /* connections that are served */
	int most_probed;      /* connections that are served or answered probes */
	int most_waiting;     /* requests that may wait for a study */
	int most_draining;    /* closed connections that are still read */
	atomic_int n, n_late; /* open; shut down after their deadline, in total */
	atomic_int n_waiting; /* suspended requests */
	atomic_bool released; /* no request may wait any more */
	atomic_bool stopping;
	pthread_t thread;
	pthread_mutex_t lock; /* protects what follows; while it is held, the descriptors in the list stay open */
	LIST_HEAD(, connection) list;
	int n_draining;
};

/* store, resume and the limits are set before; false: no thread, logged */
bool connections_start(struct connections *all);
void connections_stop(struct connections *all); /* after all connections were closed */

struct connection *connection_opened(struct connections *all, int fd, double seconds); /* NULL: no memory */
void connection_closed(struct connections *all,
                       struct connection *connection); /* just before its fd is closed */
void connection_wait(struct connections *all, struct connection *connection, void *handle, int64_t id,
                     unsigned changes, double until);

double connection_now(void); /* [s] monotonic */

#endif
