/* deadlines.h - the open connections: how long each may take, who waits for a study or an answer, who is still sending.
 *
 * A thread looks at all of them 20 times a second.  Any thread. */
#ifndef DEADLINES_H
#define DEADLINES_H

#include <pthread.h>
#include <stdatomic.h>
#include <stdbool.h>
#include <stdint.h>
#include <sys/queue.h>

struct store;

/* Written by the threads of its requests, but for what is the watch's. */
struct connection {
	LIST_ENTRY(connection) others; /* the watch's, as are fd and draining */
	int fd;
	bool draining; /* closed by its owner; fd is our own */
	bool served;   /* false: it came when there were as many as may be, ... */
	bool probed;   /* ... but is answered what needs no token, as a few more are */
	bool lingers;  /* when it is closed, what its client is still sending is read for a while, so that
	                            it finds our answer and not a reset connection */
	_Atomic double deadline; /* [s] monotonic, when it is shut down */
	_Atomic(void *) handle;  /* of a suspended request, NULL: none, ... */
	int64_t id;              /* ... the study it waits for, ... */
	unsigned changes;        /* ... its store_changes when it was looked at, ... */
	double until;            /* ... and for how long [s] monotonic */
	atomic_bool answering;   /* an answer is made that may take long, ... */
	atomic_bool unwanted;    /* ... and nobody waits for it any more; the watch's, as is ... */
	bool gone;               /* ... that its client was not there when it last looked */
};

struct connections {
	struct store *store;
	void (*resume)(void *handle);
	int most;             /* are served */
	int most_probed;      /* of those that are not, the ones that are answered probes count too */
	int most_waiting;     /* wait for a study */
	int most_draining;    /* are read from after their answer */
	atomic_int n, n_late; /* open; shut down for being late, ever */
	atomic_int n_waiting; /* suspended requests */
	atomic_bool released; /* nobody waits any more */
	atomic_bool stopping;
	pthread_t thread;
	pthread_mutex_t
	    lock; /* of what follows, and of the descriptors in the list, which stay open while it is held */
	LIST_HEAD(, connection) list;
	int n_draining;
};

/* with store, resume, most and most_draining; false: no thread, logged */
bool connections_start(struct connections *all);
void connections_stop(struct connections *all); /* after all of them were closed */

struct connection *connection_opened(struct connections *all, int fd, double seconds); /* NULL: no memory */
void connection_closed(struct connections *all, struct connection *connection); /* just before its fd is */
void connection_wait(struct connections *all, struct connection *connection, void *handle, int64_t id,
                     unsigned changes, double until);

double connection_now(void); /* [s] monotonic */

#endif
