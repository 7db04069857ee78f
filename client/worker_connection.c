/* Options and connection of pound-worker. */
#include "client/worker_connection.h"

#include <argp.h>
#include <errno.h>
#include <netdb.h>
#include <sched.h>
#include <signal.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/prctl.h>
#include <sys/socket.h>
#include <sys/wait.h>
#include <time.h>
#include <unistd.h>

#include "schema/message/listen.h"

enum {
	ADDRESS_SIZE = 512,
	/* pause between attempts to connect [ms]: first; longest if nothing listens; longest after a refusal */
	PAUSE_MIN = 250,
	PAUSE_MAX = 2000,
	PAUSE_REFUSED_MAX = 60000,
	LASTED = 10, /* [s] after a connection of this length the pause is PAUSE_MIN again */
};

/* Where to connect, and with what token. */
struct place {
	char text[ADDRESS_SIZE]; /* host and port point into it */
	const char *host, *port;
	char token[MESSAGE_TOKEN_SIZE + 1];
};

__attribute__((format(printf, 1, 2))) static void complain(const char *format, ...)
{
	va_list values;
	va_start(values, format);
	fputs("pound-worker: ", stderr);
	vfprintf(stderr, format, values);
	fputs("\n", stderr);
	va_end(values);
}

#define FAIL(...) (complain(__VA_ARGS__), exit(EXIT_FAILURE))

/* Cuts a text at its last colon (an IPv6 address contains colons) and returns the text behind it; NULL: no colon. */
static char *cut(char *text)
{
	char *colon = strrchr(text, ':');
	if (colon)
		*colon++ = '\0';
	return colon;
}

/* Splits HOST:PORT, where the host may be in brackets; false: not of this form. */
static bool split(struct place *place)
{
	char *port = cut(place->text), *host = place->text;
	const size_t n = strlen(host);
	const bool bracketed = n > 2 && host[0] == '[' && host[n - 1] == ']';
	if (bracketed)
		host[n - 1] = '\0';
	place->host = host + bracketed;
	place->port = port;
	return port && *place->host && !strchr(host, '/') && strspn(port, "0123456789") == strlen(port) &&
	       atol(port) >= 1 && atol(port) <= UINT16_MAX;
}

static void place_of_options(struct place *place, const struct worker_options *options)
{
	const char *fault = listen_token(options->token_file, place->token);
	if (fault)
		FAIL("token file %s: %s", options->token_file, fault);
	if (snprintf(place->text, sizeof place->text, "%s", options->at) >= (int)sizeof place->text ||
	    !split(place))
		FAIL("--connect must be HOST:PORT, with a port from 1 to 65535");
}

static void place_of_launcher(struct place *place)
{
	const char *given = getenv("POUND_WORKER");
	if (!given)
		FAIL("POUND_WORKER is not set: start pound-worker by `pound run --launcher' or poundd --launcher, or "
		     "give --connect and --token-file");
	const bool fits = snprintf(place->text, sizeof place->text, "%s", given) < (int)sizeof place->text;
	const char *token = fits ? cut(place->text) : NULL;
	if (!token || strlen(token) != MESSAGE_TOKEN_SIZE || !split(place))
		FAIL("POUND_WORKER must be HOST:PORT:TOKEN");
	strcpy(place->token, token);
}

/* Connects to the first reachable address of a host; -1: failed, `why` is the reason. */
static int connect_to(const struct place *place, const char **why)
{
	const struct addrinfo wanted = {.ai_socktype = SOCK_STREAM};
	struct addrinfo *found = NULL;
	int s = -1;
	const int unknown = getaddrinfo(place->host, place->port, &wanted, &found);
	if (unknown != 0) {
		*why = gai_strerror(unknown);
		return -1;
	}
	for (struct addrinfo *at = found; at && s < 0; at = at->ai_next) {
		s = socket(at->ai_family, at->ai_socktype | SOCK_CLOEXEC, at->ai_protocol);
		if (s >= 0 && connect(s, at->ai_addr, at->ai_addrlen) != 0) {
			*why = strerror(errno);
			close(s);
			s = -1;
		}
	}
	freeaddrinfo(found);
	return s;
}

/* Sends the token and the first message; returns NULL, or the error. */
static const char *greet(int s, const struct place *place, int n_threads)
{
	const struct message ready = {
	    .type = MESSAGE_READY, .block = n_threads, .n = (uint32_t)strlen(POUND_VERSION)};
	message_prepare(s);
	return send(s, place->token, MESSAGE_TOKEN_SIZE, MSG_NOSIGNAL) == MESSAGE_TOKEN_SIZE &&
	               message_send(s, &ready, POUND_VERSION)
	           ? NULL
	           : strerror(errno);
}

/* Signal handler that ends the program: process 1 of a container ignores signals without a handler. */
static void end(int signal)
{
	_exit(128 + signal);
}

/* Makes this process, which serves a connection, end together with its parent. */
static void end_with(pid_t parent)
{
	prctl(PR_SET_PDEATHSIG, SIGTERM);
	if (getppid() != parent)
		_exit(EXIT_FAILURE);
}

/* Connects again and again; returns only in the child process that serves a connection. */
static int connect_again(struct place *place, const char *token_file)
{
	const char *why = "no socket", *said = "";
	const pid_t parent = getpid();
	signal(SIGTERM, end);
	if (signal(SIGINT, end) == SIG_IGN)
		signal(SIGINT, SIG_IGN);
	for (unsigned pause = PAUSE_MIN, most;; pause = 2 * pause < most ? 2 * pause : most) {
		char token[MESSAGE_TOKEN_SIZE + 1];
		if (!listen_token(token_file, token)) // the file may have been replaced
			memcpy(place->token, token, sizeof token);
		int s = connect_to(place, &why), status = 0;
		if (s < 0 && strcmp(why, said) != 0)
			complain("waiting for %s, port %s: %s", place->host, place->port, why);
		said = s < 0 ? why : "";
		most = s < 0 ? PAUSE_MAX : PAUSE_REFUSED_MAX;
		const time_t start = time(NULL);
		const pid_t pid = s < 0 ? -1 : fork();
		if (pid == 0) {
			end_with(parent);
			complain("connected to %s, port %s", place->host, place->port);
			return s;
		}
		if (s >= 0 && pid < 0)
			complain("cannot start a process: %s", strerror(errno));
		if (s >= 0)
			close(s);
		const bool ended = pid > 0 && waitpid(pid, &status, 0) == pid;
		if (ended && WIFSIGNALED(status))
			complain("the process of the connection was ended by signal %d", WTERMSIG(status));
		if (ended && (status == 0 || time(NULL) - start >= LASTED))
			pause = PAUSE_MIN;
		usleep(1000 * pause);
	}
}

int worker_connect(const struct worker_options *options, int n_threads, bool again)
{
	struct place place;
	const char *why = "no socket";
	if (options->at)
		place_of_options(&place, options);
	else
		place_of_launcher(&place);
	const int s =
	    options->at && again ? connect_again(&place, options->token_file) : connect_to(&place, &why);
	if (s < 0)
		FAIL("cannot connect to %s, port %s: %s%s", place.host, place.port, why,
		     options->at ? ""
		                 : "; on another machine than the program that started this one, that program needs "
		                   "--worker-host with a name or address by which this machine reaches it");
	why = greet(s, &place, n_threads);
	if (why)
		FAIL("cannot send to %s: %s", place.host, why);
	return s;
}

bool worker_take(int connection, struct message *message, char **body)
{
	if (!message_take(connection, MESSAGE_OF_COORDINATOR, message, body))
		return false;
	if (message->type != MESSAGE_REFUSE)
		return true;
	complain("refused: %.*s", (int)message->n, *body);
	free(*body);
	*body = NULL;
	return false;
}

/* Default number of threads: the cores that this process may use. */
static int cores(void)
{
	cpu_set_t set;
	// sched_getaffinity fails on more processors than a cpu_set_t holds; then count all
	const long n =
	    sched_getaffinity(0, sizeof set, &set) == 0 ? CPU_COUNT(&set) : sysconf(_SC_NPROCESSORS_ONLN);
	return n < MESSAGE_THREADS_MAX ? (int)n : MESSAGE_THREADS_MAX;
}

const char *argp_program_version = "pound-worker " POUND_VERSION;

static error_t take(int key, char *value, struct argp_state *state)
{
	struct worker_options *options = state->input;
	char *end;
	switch (key) {
	case 't': {
		long n = strtol(value, &end, 10);
		if (end == value || *end || n < 1 || n > MESSAGE_THREADS_MAX)
			argp_error(state, "--threads must be a whole number from 1 to %d, got '%s'", MESSAGE_THREADS_MAX,
			           value);
		options->n_threads = (int)n;
		return 0;
	}
	case 'c':
		options->at = value;
		return 0;
	case 'f':
		options->token_file = value;
		return 0;
	case ARGP_KEY_END:
		if (!options->at != !options->token_file)
			argp_error(state, "--connect and --token-file need each other");
		return 0;
	default:
		return ARGP_ERR_UNKNOWN;
	}
}

struct worker_options worker_options(int argc, char **argv)
{
	static const struct argp_option rows[] = {
	    {"threads", 't', "N", 0, "compute with N threads (default: cores this process may use)", 0},
	    {"connect", 'c', "HOST:PORT", 0,
	     "compute for the `pound run' or poundd that listens at this address (--worker-listen), again and "
	     "again",
	     0},
	    {"token-file", 'f', "FILE", 0, "token of that program's --worker-token-file", 0},
	    {0}};
	static const struct argp argp = {.options = rows,
	                                 .parser = take,
	                                 .doc = "Runs blocks of studies for a `pound run' or poundd, which "
	                                        "starts it by --launcher or listens for it "
	                                        "by --worker-listen.\vA launcher sets POUND_WORKER, which says "
	                                        "where to connect: HOST:PORT:TOKEN."};
	struct worker_options options = {.n_threads = cores()};
	argp_err_exit_status = 2; // the same as pound
	argp_parse(&argp, argc, argv, 0, NULL, &options);
	return options;
}
