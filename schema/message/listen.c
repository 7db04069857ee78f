/* listen.c - addresses, listening sockets and tokens. */
#include "schema/message/listen.h"

#include <ctype.h>
#include <errno.h>
#include <fcntl.h>
#include <poll.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <sys/time.h>
#include <time.h>
#include <unistd.h>

#include <nettle/memops.h>

enum {
	BACKLOG = 1024,
	TOKEN_WAIT = 2, /* [s] within which a connection must send its token */
};

bool listen_address(const char *text, int port, union listen_address *address)
{
	*address = (union listen_address){.ip6 = {.sin6_family = AF_INET6, .sin6_port = htons((uint16_t)port)}};
	if (inet_pton(AF_INET6, text, &address->ip6.sin6_addr) == 1)
		return true;
	*address = (union listen_address){.ip4 = {.sin_family = AF_INET, .sin_port = htons((uint16_t)port)}};
	return inet_pton(AF_INET, text, &address->ip4.sin_addr) == 1;
}

/* Reads a numeric address and a port.
 *
 * Given    text   such as 10.0.0.1:8438, [::]:8438
 * Returns  value  false: anything else
 * Test     unit_listen: an_address_and_its_port_are_read_and_nothing_else_is
 */
bool listen_address_and_port(const char *text, union listen_address *address)
{
	char host[INET6_ADDRSTRLEN + 2], *end;
	const char *colon = strrchr(text, ':');
	const size_t n = colon ? (size_t)(colon - text) : 0;
	if (n == 0 || n >= sizeof host || !isdigit((unsigned char)colon[1]))
		return false;
	const long port = strtol(colon + 1, &end, 10);
	const bool bracketed = text[0] == '[' && colon[-1] == ']';
	snprintf(host, sizeof host, "%.*s", (int)n - 2 * bracketed, text + bracketed);
	return !*end && port <= UINT16_MAX && listen_address(host, (int)port, address) &&
	       bracketed == (address->any.sa_family == AF_INET6);
}

bool listen_is_loopback(const union listen_address *address)
{
	return address->any.sa_family == AF_INET6 ? IN6_IS_ADDR_LOOPBACK(&address->ip6.sin6_addr)
	                                          : ntohl(address->ip4.sin_addr.s_addr) >> 24 == 127;
}

/* A socket that listens at an address, -1: failed, see errno.  Opened here and not by libmicrohttpd, which would log a failure
 * itself, without the port. */
int listen_open(const union listen_address *address, enum listen_families families)
{
	const int on = 1, only = families == LISTEN_ONE_FAMILY;
	const bool v6 = address->any.sa_family == AF_INET6;
	const socklen_t size = v6 ? sizeof address->ip6 : sizeof address->ip4;
	int fd = socket(address->any.sa_family, SOCK_STREAM | SOCK_NONBLOCK | SOCK_CLOEXEC, 0);
	bool ok = fd >= 0 && setsockopt(fd, SOL_SOCKET, SO_REUSEADDR, &on, sizeof on) == 0 &&
	          (!v6 || setsockopt(fd, IPPROTO_IPV6, IPV6_V6ONLY, &only, sizeof only) == 0) &&
	          bind(fd, &address->any, size) == 0 && listen(fd, BACKLOG) == 0;
	if (fd >= 0 && !ok) {
		int error = errno;
		close(fd);
		errno = error;
	}
	return ok ? fd : -1;
}

int listen_port(int socket)
{
	union listen_address at = {0};
	socklen_t size = sizeof at;
	getsockname(socket, &at.any, &size);
	return ntohs(at.ip6.sin6_port); // at the same offset in both families
}

int listen_accept(int socket, char peer[LISTEN_PEER_SIZE])
{
	union listen_address from = {0};
	socklen_t size = sizeof from;
	const int connection = accept4(socket, &from.any, &size, SOCK_CLOEXEC);
	const bool v6 = from.any.sa_family == AF_INET6;
	if (connection < 0 ||
	    !inet_ntop(from.any.sa_family, v6 ? (const void *)&from.ip6.sin6_addr : &from.ip4.sin_addr, peer,
	               LISTEN_PEER_SIZE))
		peer[0] = '\0';
	return connection;
}

/* Receives a whole token within TOKEN_WAIT. */
static bool token_receive(int connection, char token[MESSAGE_TOKEN_SIZE])
{
	struct timespec now, until;
	clock_gettime(CLOCK_MONOTONIC, &until);
	until.tv_sec += TOKEN_WAIT;
	for (size_t n = 0; n < MESSAGE_TOKEN_SIZE;) {
		clock_gettime(CLOCK_MONOTONIC, &now);
		const long ms = 1000 * (until.tv_sec - now.tv_sec) + (until.tv_nsec - now.tv_nsec) / 1000000;
		struct pollfd file = {.fd = connection, .events = POLLIN};
		const ssize_t got = ms > 0 && poll(&file, 1, (int)ms) > 0
		                        ? recv(connection, token + n, MESSAGE_TOKEN_SIZE - n, MSG_DONTWAIT)
		                        : 0;
		if (got <= 0)
			return false;
		n += (size_t)got;
	}
	return true;
}

/* Reads the token and compares it in constant time.
 *
 * Test     unit_listen: only_the_whole_token_lets_a_connection_in, a_token_in_drops_comes_too_late
 */
enum listen_entry listen_entry(int connection, const char token[MESSAGE_TOKEN_SIZE])
{
	char sent[MESSAGE_TOKEN_SIZE];
	const struct timeval silence = {.tv_sec = MESSAGE_SILENCE};
	if (!token_receive(connection, sent))
		return LISTEN_NO_TOKEN;
	setsockopt(connection, SOL_SOCKET, SO_RCVTIMEO, &silence, sizeof silence);
	message_prepare(connection);
	return memeql_sec(sent, token, sizeof sent) ? LISTEN_TOKEN : LISTEN_OTHER_TOKEN;
}

/* Reads the token of a file.
 *
 * Given    file    mode 0600 or stricter; contains 64 hexadecimal digits
 * Returns  value   NULL, or an error message
 * Test     unit_listen: a_token_file_that_cannot_be_used_is_refused_with_the_reason
 */
const char *listen_token(const char *file, char token[MESSAGE_TOKEN_SIZE + 1])
{
	char line[MESSAGE_TOKEN_SIZE + 3] = ""; // and \r\n
	struct stat about;
	// O_NONBLOCK: opening a pipe without a writer must not block
	const int in = open(file, O_RDONLY | O_CLOEXEC | O_NONBLOCK);
	if (in < 0)
		return strerror(errno);
	const bool is_file = fstat(in, &about) == 0 && S_ISREG(about.st_mode);
	const ssize_t n = is_file ? read(in, line, sizeof line - 1) : 0;
	close(in);
	if (!is_file)
		return "is not a file";
	if (about.st_mode & (S_IRWXG | S_IRWXO))
		return "may be used by others: chmod 600";
	line[strcspn(line, "\r\n")] = '\0';
	if (about.st_size != n || strlen(line) != MESSAGE_TOKEN_SIZE ||
	    strspn(line, "0123456789abcdefABCDEF") != MESSAGE_TOKEN_SIZE)
		return "is not a token of 64 hexadecimal digits, as `openssl rand -hex 32' makes one";
	memcpy(token, line, MESSAGE_TOKEN_SIZE + 1);
	return NULL;
}
