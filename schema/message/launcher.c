/* The command gets a process group of its own, so that all it starts on this machine can be ended, and POUND_WORKER, which
 * says where to connect and with what token: host:port:token. */
#include "schema/message/launcher.h"

#include <errno.h>
#include <fcntl.h>
#include <netinet/in.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/prctl.h>
#include <sys/random.h>
#include <sys/socket.h>
#include <sys/time.h>
#include <sys/wait.h>
#include <unistd.h>

#include <nettle/memops.h>

enum {
	TOKEN_WAIT = 2,   /* [s] for a connection to say its token */
	END_WAIT = 3,     /* [s] from the end of the connection to SIGTERM, and from there to SIGKILL */
	PAUSE_US = 10000, /* between two looks whether it has ended */
};

enum reach { LOOPBACK, ALL_ADDRESSES };

extern char **environ;

int launcher_ranks(void)
{
	static const char *const counts[] = {"OMPI_COMM_WORLD_SIZE", "PMI_SIZE", "SLURM_STEP_NUM_TASKS"};
	int most = 1;
	for (size_t i = 0; i < sizeof counts / sizeof counts[0]; i++) {
		const char *n = getenv(counts[i]);
		most = n && atoi(n) > most ? atoi(n) : most;
	}
	return most;
}

static int bound(int family, const struct sockaddr *at, socklen_t size)
{
	const int off = 0;
	int s = socket(family, SOCK_STREAM | SOCK_CLOEXEC | SOCK_NONBLOCK, 0);
	if (s >= 0 && family == AF_INET6)
		setsockopt(s, IPPROTO_IPV6, IPV6_V6ONLY, &off, sizeof off);
	if (s >= 0 && (bind(s, at, size) != 0 || listen(s, 16) != 0)) {
		close(s);
		s = -1;
	}
	return s;
}

/* Listens on a free port, of loopback or of every address of this machine; -1: not possible. */
static int listen_on(enum reach reach, int *port)
{
	const struct sockaddr_in6 all = {.sin6_family = AF_INET6, .sin6_addr = IN6ADDR_ANY_INIT};
	const struct sockaddr_in at = {.sin_family = AF_INET,
	                               .sin_addr.s_addr =
	                                   htonl(reach == ALL_ADDRESSES ? INADDR_ANY : INADDR_LOOPBACK)};
	struct sockaddr_in6 got;
	socklen_t size = sizeof got;
	int s = reach == ALL_ADDRESSES ? bound(AF_INET6, (const struct sockaddr *)&all, sizeof all) : -1;
	if (s < 0) // loopback, or a machine without IPv6
		s = bound(AF_INET, (const struct sockaddr *)&at, sizeof at);
	if (s < 0 || getsockname(s, (struct sockaddr *)&got, &size) != 0)
		return -1;
	*port = ntohs(got.sin6_port); // at the same offset in both families
	return s;
}

/* The environment with one more entry, or one in the place of another. */
static char **environment_with(char *entry)
{
	size_t n = 0, name = strcspn(entry, "=") + 1;
	while (environ[n])
		n++;
	char **all = calloc(n + 2, sizeof *all);
	for (size_t i = 0, k = 0; all && i <= n; i++)
		if (i == n)
			all[k] = entry;
		else if (strncmp(environ[i], entry, name) != 0)
			all[k++] = environ[i];
	return all;
}

/* In the new process: all that was set for this program is as it was. */
static void become(const char *command, char **environment)
{
	sigset_t none;
	sigemptyset(&none);
	setpgid(0, 0);
	prctl(PR_SET_PDEATHSIG, SIGTERM);
	for (int s = 1; s < SIGRTMIN; s++)
		signal(s, SIG_DFL);
	sigprocmask(SIG_SETMASK, &none, NULL);
	int nothing = open("/dev/null", O_RDONLY);
	dup2(nothing, STDIN_FILENO);
	// the result goes to stdout
	dup2(STDERR_FILENO, STDOUT_FILENO);
	close_range(STDERR_FILENO + 1, ~0U, 0);
	execle("/bin/sh", "sh", "-c", command, (char *)NULL, environment);
	_exit(127);
}

const char *launcher_start(struct launcher *l, const struct launch *launch)
{
	uint8_t secret[MESSAGE_TOKEN_SIZE / 2];
	char entry[512];
	int port = 0;
	const char *host = launch->host ? launch->host : "127.0.0.1";
	*l = (struct launcher){.listens = listen_on(launch->host ? ALL_ADDRESSES : LOOPBACK, &port)};
	if (l->listens < 0)
		return "no free port to listen on";
	if (getrandom(secret, sizeof secret, 0) != sizeof secret)
		return "the system gave no random numbers";
	for (size_t i = 0; i < sizeof secret; i++)
		snprintf(l->token + 2 * i, 3, "%02x", secret[i]);
	if (snprintf(entry, sizeof entry, "POUND_WORKER=%s:%d:%s", host, port, l->token) >= (int)sizeof entry)
		return "the name of --worker-host is too long";
	char **environment = environment_with(entry);
	pid_t pid = environment ? fork() : -1;
	if (pid == 0)
		become(launch->command, environment);
	free(environment);
	if (pid < 0)
		return "no process can be started";
	setpgid(pid, pid);
	l->pid = pid;
	return NULL;
}

bool launcher_ended(struct launcher *l)
{
	siginfo_t about = {0};
	if (l->pid == 0)
		return true;
	bool ended = waitid(P_PID, (id_t)l->pid, &about, WEXITED | WNOHANG | WNOWAIT) != 0 || about.si_pid != 0;
	if (ended)
		l->status = about.si_code == CLD_EXITED ? about.si_status : 128 + about.si_status;
	return ended;
}

int launcher_accept(const struct launcher *l)
{
	char token[MESSAGE_TOKEN_SIZE];
	const struct timeval limit = {.tv_sec = TOKEN_WAIT}, silence = {.tv_sec = MESSAGE_SILENCE};
	int s = accept4(l->listens, NULL, NULL, SOCK_CLOEXEC);
	if (s < 0)
		return -1;
	setsockopt(s, SOL_SOCKET, SO_RCVTIMEO, &limit, sizeof limit);
	if (!message_receive(s, token, sizeof token) || !memeql_sec(token, l->token, sizeof token)) {
		close(s);
		return -1;
	}
	setsockopt(s, SOL_SOCKET, SO_RCVTIMEO, &silence, sizeof silence);
	message_prepare(s);
	return s;
}

void launcher_close(struct launcher *l)
{
	if (l->listens >= 0)
		close(l->listens);
	l->listens = -1;
}

void launcher_stop(struct launcher *l, bool connected)
{
	static const int signals[] = {0, SIGTERM, SIGKILL};
	launcher_close(l);
	for (int s = !connected; s < 3 && !launcher_ended(l); s++) {
		if (signals[s])
			kill(-l->pid, signals[s]);
		// one that is stopped takes SIGTERM when it goes on
		if (signals[s] == SIGTERM)
			kill(-l->pid, SIGCONT);
		for (int i = 0; i < 1000000 / PAUSE_US * END_WAIT && !launcher_ended(l); i++)
			usleep(PAUSE_US);
	}
	if (l->pid) {
		// processes that the command left behind
		kill(-l->pid, SIGKILL);
		waitpid(l->pid, NULL, 0);
	}
	l->pid = 0;
}
