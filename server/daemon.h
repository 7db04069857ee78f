/* daemon.h - the threads that answer requests. */
#ifndef DAEMON_H
#define DAEMON_H

#include "server/http.h"

bool daemon_start(struct server *server); /* false: logged */
int daemon_port(const struct server *server);
/* what is under way is answered, who waits gets 503; false: an answer was not given up in time */
bool daemon_stop(struct server *server);

#endif
