/* listen.h - the address that is listened at, and its socket. */
#ifndef LISTEN_H
#define LISTEN_H

#include <arpa/inet.h>
#include <stdbool.h>

union listen_address {
	struct sockaddr any;
	struct sockaddr_in ip4;
	struct sockaddr_in6 ip6;
};

bool listen_address(const char *text, int port, union listen_address *address); /* false: not in digits */
bool listen_is_loopback(const union listen_address *address);
int listen_open(const union listen_address *address); /* a socket; -1: errno says why */

#endif
