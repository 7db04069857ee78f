/* launcher.c - starts the command of a worker group in its own process group, so that all its processes on this machine can be
 * ended, with POUND_WORKER=host:port:token in the environment: where to connect, and the token to send. */
#include "schema/message/launcher.h"

#include <errno.h>
#include <fcntl.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/prctl.h>
#include <sys/random.h>
#include <sys/wait.h>
#include <unistd.h>

#include "schema/message/listen.h"

enum {
	END_WAIT = 3,     /* [s] from the end of the connection to SIGTERM, and from there to SIGKILL */
	PAUSE_US = 10000, /* between two checks whether it has ended */
};

extern char **environ;

/* Checks the options of worker groups.
 *
 * Test     client_pound: wrong_usage_ends_with_2_and_prints_no_data
 */
const char *launch_fault(const struct launch *launch)
{
	union listen_address address;
	if (!launch->command && (launch->host || launch->n))
		return "--launchers and --worker-host need --launcher, the command that starts workers";
	if (!launch->at != !launch->token_file)
		return "--worker-listen and --worker-token-file need each other";
	if (launch->at && !listen_address_and_port(launch->at, &address))
		return "--worker-listen must be an IP address and a port, such as 127.0.0.1:8438 or [::]:8438";
	return NULL;
}

bool launch_listen(struct launch *launch, char *text, size_t size)
{
	union listen_address address;
	text[0] = '\0';
	if (!launch->at)
		return true;
	const char *fault = listen_token(launch->token_file, launch->token);
	listen_address_and_port(launch->at, &address);
	launch->socket = fault ? -1 : listen_open(&address, LISTEN_BOTH_FAMILIES);
	if (fault)
		snprintf(text, size, "token file %s: %s", launch->token_file, fault);
	else if (launch->socket < 0)
		snprintf(text, size, "cannot listen on %s for workers: %s", launch->at, strerror(errno));
	else
		snprintf(text, size, "workers may connect to %.*s:%d", (int)(strrchr(launch->at, ':') - launch->at),
		         launch->at, listen_port(launch->socket));
	return launch->socket >= 0;
}

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

/* A copy of the environment with an entry added or replaced. */
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

/* In the child process: resets signal handlers and mask and closes files, then runs the command. */
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
	// stdout of this program is for results
	dup2(STDERR_FILENO, STDOUT_FILENO);
	close_range(STDERR_FILENO + 1, ~0U, 0);
	execle("/bin/sh", "sh", "-c", command, (char *)NULL, environment);
	_exit(127);
}

/* Listens on a free port. */
static int listens_at(const char *text)
{
	union listen_address address;
	listen_address(text, 0, &address);
	return listen_open(&address, LISTEN_BOTH_FAMILIES);
}

const char *launcher_start(struct launcher *l, const struct launch *launch)
{
	uint8_t secret[MESSAGE_TOKEN_SIZE / 2];
	char entry[512];
	const char *host = launch->host ? launch->host : "127.0.0.1";
	*l = (struct launcher){.listens = listens_at(launch->host ? "::" : "127.0.0.1")};
	if (l->listens < 0 && launch->host) // no IPv6 on this machine
		l->listens = listens_at("0.0.0.0");
	if (l->listens < 0)
		return "no free port to listen on";
	if (getrandom(secret, sizeof secret, 0) != sizeof secret)
		return "the system gave no random numbers";
	for (size_t i = 0; i < sizeof secret; i++)
		snprintf(l->token + 2 * i, 3, "%02x", secret[i]);
	if (snprintf(entry, sizeof entry, "POUND_WORKER=%s:%d:%s", host, listen_port(l->listens), l->token) >=
	    (int)sizeof entry)
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
		// a stopped process handles SIGTERM only after SIGCONT
		if (signals[s] == SIGTERM)
			kill(-l->pid, SIGCONT);
		for (int i = 0; i < 1000000 / PAUSE_US * END_WAIT && !launcher_ended(l); i++)
			usleep(PAUSE_US);
	}
	if (l->pid) {
		// processes left by the command
		kill(-l->pid, SIGKILL);
		waitpid(l->pid, NULL, 0);
	}
	l->pid = 0;
}
