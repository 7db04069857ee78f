/* connection.h - the open connections: how long each may take, who waits for a study, who is still sending.
 *
 * A thread looks at all of them 20 times a second.  Any thread. */
#ifndef CONNECTION_H
#define CONNECTION_H

#include <stdbool.h>
#include <stdint.h>

struct store;
struct connections;
struct connection;

typedef void connection_resumer(void *handle);

/* `most` connections are served; NULL: no memory */
struct connections *connections_start(struct store *store, connection_resumer *resume, int most);
void connections_release(struct connections *all); /* nobody waits, now and from now on */
void connections_stop(struct connections *all);    /* after all of them were closed */
int connections_open(struct connections *all);     /* how many */
int connections_late(struct connections *all);     /* how many were closed for being late, ever */

/* A connection that must have come to something within so many seconds; NULL: no memory. */
struct connection *connection_opened(struct connections *all, int fd, double seconds);
bool connection_served(
    const struct connection *connection); /* false: it came when there were as many as may be */
void connection_closed(struct connections *all, struct connection *connection); /* just before its fd is */

/* It is closed unless this is called again within so many seconds. */
void connection_allow(struct connections *all, struct connection *connection, double seconds);

/* When it is closed, what the client is still sending is read for a while, so that it finds our answer and not a
 * reset connection. */
void connection_linger(struct connections *all, struct connection *connection);

/* Resumes `handle` when a study changes (store_changes is not `changes`) or at a time [s, monotonic]. */
void connection_wait(struct connections *all, struct connection *connection, void *handle, int64_t id,
                     unsigned changes, double until);

double connection_now(void); /* [s] monotonic */

#endif
