/* HTTP requests and responses through a plain socket. */
#include "tests/support/raw_http.h"

#include <arpa/inet.h>
#include <errno.h>
#include <poll.h>
#include <string.h>
#include <sys/socket.h>
#include <time.h>
#include <unistd.h>

int raw_open(const struct service *service)
{
	const struct sockaddr_in to = {.sin_family = AF_INET,
	                               .sin_port = htons((uint16_t)service->port),
	                               .sin_addr.s_addr = htonl(INADDR_LOOPBACK)};
	int s = socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0);
	assert_true(s >= 0);
	assert_int_equal(connect(s, (const struct sockaddr *)&to, sizeof to), 0);
	return s;
}

void raw_send(int s, const char *bytes, size_t n)
{
	while (n > 0) {
		ssize_t sent = send(s, bytes, n, MSG_NOSIGNAL);
		if (sent < 0) // the server may have closed it already
			return;
		bytes += sent;
		n -= (size_t)sent;
	}
}

static double now(void)
{
	struct timespec time;
	clock_gettime(CLOCK_MONOTONIC, &time);
	return (double)time.tv_sec + 1e-9 * (double)time.tv_nsec;
}

void raw_receive(int s, double seconds, struct raw_answer *answer)
{
	static const char line[] = "HTTP/1.1 ";
	double end = now() + seconds;
	size_t n = 0;
	*answer = (struct raw_answer){0};
	while (!answer->closed && now() < end) {
		char bytes[65536];
		struct pollfd ready = {.fd = s, .events = POLLIN};
		if (poll(&ready, 1, (int)(1e3 * (end - now())) + 1) <= 0)
			continue;
		ssize_t came = recv(s, bytes, sizeof bytes, 0);
		answer->closed = came <= 0;
		answer->reset = came < 0 && errno == ECONNRESET;
		for (ssize_t i = 0; i < came && n < sizeof answer->text - 1; i++)
			answer->text[n++] = bytes[i] ? bytes[i] : '?';
	}
	if (!strncmp(answer->text, line, strlen(line)))
		answer->status = atoi(answer->text + strlen(line));
	for (const char *at = strstr(answer->text, line); at; at = strstr(at + 1, line))
		answer->n++;
}

void raw_ask(const struct service *service, const char *bytes, size_t n, double seconds,
             struct raw_answer *answer)
{
	int s = raw_open(service);
	raw_send(s, bytes, n);
	raw_receive(s, seconds, answer);
	close(s);
}
