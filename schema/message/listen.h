/* listen.h - listening sockets, and the token that authenticates a worker's connection. */
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

/* Whether a socket at :: accepts IPv4 connections, too. */
enum listen_families { LISTEN_ONE_FAMILY, LISTEN_BOTH_FAMILIES };

bool listen_address(const char *text, int port, union listen_address *address); /* false: not numeric */
bool listen_address_and_port(const char *text,
                             union listen_address *address); /* ADDRESS:PORT, [ADDRESS]:PORT */
bool listen_is_loopback(const union listen_address *address);
/* a socket; -1: failed, see errno */
int listen_open(const union listen_address *address, enum listen_families families);
int listen_port(int socket); /* port of the socket */

enum { LISTEN_PEER_SIZE = INET6_ADDRSTRLEN };

/* A connection, not yet authenticated, and the address of its peer; -1: none now. */
int listen_accept(int socket, char peer[LISTEN_PEER_SIZE]);
/* First bytes of a connection. */
enum listen_entry { LISTEN_TOKEN, LISTEN_OTHER_TOKEN, LISTEN_NO_TOKEN };
/* Reads and compares the token; the whole token must arrive within 2 s. */
enum listen_entry listen_entry(int connection, const char token[MESSAGE_TOKEN_SIZE]);
/* Reads the token of a file; NULL, or an error message. */
const char *listen_token(const char *file, char token[MESSAGE_TOKEN_SIZE + 1]);

#endif
