/* listen.h - where a program listens, and the token by which a connection of a worker is let in. */
#ifndef LISTEN_H
#define LISTEN_H

#include <arpa/inet.h>
#include <stdbool.h>

#include "schema/message/message.h"

union listen_address {
	struct sockaddr any;
	struct sockaddr_in ip4;
	struct sockaddr_in6 ip6;
};

/* Whether the address :: takes connections by IPv4, too. */
enum listen_families { LISTEN_ONE_FAMILY, LISTEN_BOTH_FAMILIES };

bool listen_address(const char *text, int port, union listen_address *address); /* false: not in digits */
bool listen_address_and_port(const char *text,
                             union listen_address *address); /* ADDRESS:PORT, [ADDRESS]:PORT */
bool listen_is_loopback(const union listen_address *address);
/* a socket; -1: errno says why */
int listen_open(const union listen_address *address, enum listen_families families);
int listen_port(int socket); /* that it listens on */

enum { LISTEN_PEER_SIZE = INET6_ADDRSTRLEN };

/* A connection, not yet let in, and the address that it is from; -1: there is none now. */
int listen_accept(int socket, char peer[LISTEN_PEER_SIZE]);
/* What a connection starts with. */
enum listen_entry { LISTEN_TOKEN, LISTEN_OTHER_TOKEN, LISTEN_NO_TOKEN };
/* It has 2 s for all of its token. */
enum listen_entry listen_entry(int connection, const char token[MESSAGE_TOKEN_SIZE]);
/* The token of a file; NULL, or what is wrong with the file. */
const char *listen_token(const char *file, char token[MESSAGE_TOKEN_SIZE + 1]);

#endif
