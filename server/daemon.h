/* daemon.h - the threads that answer requests. */
#ifndef DAEMON_H
#define DAEMON_H

#include "server/http.h"

bool daemon_start(struct server *server); /* false: logged */
int daemon_port(const struct server *server);
/* answers requests under way, sends 503 to waiting clients; false: a slow answer was not abandoned in time */
bool daemon_stop(struct server *server);

#endif
