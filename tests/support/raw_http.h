/* raw_http.h - raw bytes to and from a server, for requests that no HTTP library would send.
 *
 * Errors in these functions fail the test. */
#ifndef RAW_HTTP_H
#define RAW_HTTP_H

#include "tests/support/service.h"

struct raw_answer {
	int status;       /* of the first answer, 0: no answer */
	int n;            /* status lines received */
	bool closed;      /* the server ended the connection */
	bool reset;       /* by a TCP reset */
	char text[16384]; /* received bytes, truncated */
};

int raw_open(const struct service *service); /* a socket for close */
void raw_send(int socket, const char *bytes, size_t n);

/* All that comes until the connection ends, or for so many seconds when it is kept. */
void raw_receive(int socket, double seconds, struct raw_answer *answer);

/* Opens, sends, receives, and closes. */
void raw_ask(const struct service *service, const char *bytes, size_t n, double seconds,
             struct raw_answer *answer);

#endif
