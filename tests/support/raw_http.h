/* raw_http.h - bytes to a server and back, for what no HTTP library would send.
 *
 * What goes wrong in here fails the test. */
#ifndef RAW_HTTP_H
#define RAW_HTTP_H

#include "tests/support/service.h"

struct raw_answer {
	int status;       /* of the first answer, 0: there was none */
	int n;            /* status lines in all that came */
	bool closed;      /* the server ended the connection */
	bool reset;       /* and not in order */
	char text[16384]; /* what came, cut */
};

int raw_open(const struct service *service); /* a socket for close */
void raw_send(int socket, const char *bytes, size_t n);

/* All that comes until the connection ends, or for so many seconds when it is kept. */
void raw_receive(int socket, double seconds, struct raw_answer *answer);

/* One after the other; the connection is closed by us at the end. */
void raw_ask(const struct service *service, const char *bytes, size_t n, double seconds,
             struct raw_answer *answer);

#endif
