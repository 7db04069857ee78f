/* Where the server listens. */
#include "server/listen.h"

#include <errno.h>
#include <unistd.h>

enum { BACKLOG = 1024 };

bool listen_address(const char *text, int port, union listen_address *address)
{
	*address = (union listen_address){.ip6 = {.sin6_family = AF_INET6, .sin6_port = htons((uint16_t)port)}};
	if (inet_pton(AF_INET6, text, &address->ip6.sin6_addr) == 1)
		return true;
	*address = (union listen_address){.ip4 = {.sin_family = AF_INET, .sin_port = htons((uint16_t)port)}};
	return inet_pton(AF_INET, text, &address->ip4.sin_addr) == 1;
}

bool listen_is_loopback(const union listen_address *address)
{
	return address->any.sa_family == AF_INET6 ? IN6_IS_ADDR_LOOPBACK(&address->ip6.sin6_addr)
	                                          : ntohl(address->ip4.sin_addr.s_addr) >> 24 == 127;
}

/* A socket that listens at an address, -1: none, and errno says why; made here, for libmicrohttpd would log another line
 * about it, without the port. */
int listen_open(const union listen_address *address)
{
	const int on = 1;
	const bool v6 = address->any.sa_family == AF_INET6;
	const socklen_t size = v6 ? sizeof address->ip6 : sizeof address->ip4;
	int fd = socket(address->any.sa_family, SOCK_STREAM | SOCK_NONBLOCK | SOCK_CLOEXEC, 0);
	bool ok = fd >= 0 && setsockopt(fd, SOL_SOCKET, SO_REUSEADDR, &on, sizeof on) == 0 &&
	          (!v6 || setsockopt(fd, IPPROTO_IPV6, IPV6_V6ONLY, &on, sizeof on) == 0) &&
	          bind(fd, &address->any, size) == 0 && listen(fd, BACKLOG) == 0;
	if (fd >= 0 && !ok) {
		int error = errno;
		close(fd);
		errno = error;
	}
	return ok ? fd : -1;
}
