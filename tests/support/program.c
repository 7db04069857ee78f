/* program.c - fork, exec, and pipes for program.h. */
#include "tests/support/program.h"

#include <fcntl.h>
#include <poll.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/ioctl.h>
#include <sys/prctl.h>
#include <sys/wait.h>
#include <unistd.h>

#include "tests/support/check.h"
#include "tests/support/service.h"

static void give_up(const char *what)
{
	perror(what);
	abort();
}

/* Replaces the child by the program; does not return. */
static void become(const char *const arguments[])
{
	const char *build = getenv("POUND_BUILD");
	char path[512];
	snprintf(path, sizeof path, "%s/%s", build ? build : "build/release", arguments[0]);
	char **argv = (char **)arguments;
	if (access(path, X_OK) == 0)
		execv(path, argv);
	else
		execvp(arguments[0], argv);
	perror(arguments[0]);
	_exit(127);
}

static int exit_status(int status)
{
	return WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
}

/* Reads both outputs until they close, and meanwhile writes the input. */
static void exchange(int in, const char *input, int out, FILE *out_file, int err, FILE *err_file)
{
	size_t n = input ? strlen(input) : 0, written = 0;
	struct pollfd ends[] = {
	    {.fd = in, .events = POLLOUT}, {.fd = out, .events = POLLIN}, {.fd = err, .events = POLLIN}};
	FILE *files[] = {NULL, out_file, err_file};
	while (ends[1].fd >= 0 || ends[2].fd >= 0) {
		if (written == n && ends[0].fd >= 0) {
			close(in);
			ends[0].fd = -1;
		}
		if (poll(ends, 3, -1) < 0)
			give_up("poll");
		if (ends[0].fd >= 0 && ends[0].revents) {
			ssize_t k = write(in, input + written, n - written);
			// a program that does not read the remaining input has closed its end
			written = k < 0 ? n : written + (size_t)k;
		}
		for (int i = 1; i < 3; i++) {
			char bytes[65536];
			if (ends[i].fd < 0 || !ends[i].revents)
				continue;
			ssize_t k = read(ends[i].fd, bytes, sizeof bytes);
			if (k > 0)
				fwrite(bytes, 1, (size_t)k, files[i]);
			else
				ends[i].fd = -1;
		}
	}
	if (ends[0].fd >= 0)
		close(in);
	close(out);
	close(err);
}

struct program_outcome program_run(const char *const arguments[], const char *input)
{
	struct program_outcome outcome = {0};
	int in[2], out[2], err[2], status;
	if (pipe2(in, O_CLOEXEC) || pipe2(out, O_CLOEXEC) || pipe2(err, O_CLOEXEC))
		give_up("pipe2");
	signal(SIGPIPE, SIG_IGN);
	pid_t pid = fork();
	if (pid < 0)
		give_up("fork");
	if (pid == 0) {
		signal(SIGPIPE, SIG_DFL);
		dup2(in[0], STDIN_FILENO);
		dup2(out[1], STDOUT_FILENO);
		dup2(err[1], STDERR_FILENO);
		become(arguments);
	}
	close(in[0]);
	close(out[1]);
	close(err[1]);
	FILE *out_file = open_memstream(&outcome.out, &outcome.n_out);
	FILE *err_file = open_memstream(&outcome.err, &outcome.n_err);
	exchange(in[1], input, out[0], out_file, err[0], err_file);
	fclose(out_file);
	fclose(err_file);
	if (waitpid(pid, &status, 0) != pid)
		give_up("waitpid");
	outcome.status = exit_status(status);
	return outcome;
}

void program_expect(const struct program_outcome *outcome, int status)
{
	if (outcome->status == status)
		return;
	// not with print_error, which truncates long texts
	fprintf(stderr, "%sstderr:\n%sstatus %d instead of %d\n", outcome->out, outcome->err, outcome->status,
	        status);
	fail();
}

void program_free(struct program_outcome *outcome)
{
	free(outcome->out);
	free(outcome->err);
	*outcome = (struct program_outcome){0};
}

pid_t program_start(const char *const arguments[], const char *out, const char *err)
{
	pid_t pid = fork();
	if (pid < 0)
		give_up("fork");
	if (pid == 0) {
		// the program ends with a failed test
		prctl(PR_SET_PDEATHSIG, SIGKILL);
		int in_file = open("/dev/null", O_RDONLY | O_CLOEXEC);
		int out_file = open(out, O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC, 0600);
		int err_file = open(err, O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC, 0600);
		dup2(in_file, STDIN_FILENO);
		dup2(out_file, STDOUT_FILENO);
		dup2(err_file, STDERR_FILENO);
		become(arguments);
	}
	return pid;
}

int program_end(pid_t pid)
{
	int status;
	if (waitpid(pid, &status, 0) != pid)
		give_up("waitpid");
	return exit_status(status);
}

int program_setup(void **state)
{
	char url[64];
	int status = service_setup(state);
	const struct service *service = *state;
	snprintf(url, sizeof url, "http://127.0.0.1:%d", service->port);
	setenv("POUND_URL", url, 1);
	return status;
}

char *program_file(const char *path, size_t *n)
{
	FILE *file = fopen(path, "rb");
	char *text = NULL, bytes[65536];
	size_t size = 0, k;
	if (!file)
		return NULL;
	FILE *into = open_memstream(&text, &size);
	while ((k = fread(bytes, 1, sizeof bytes, file)) > 0)
		fwrite(bytes, 1, k, into);
	fclose(into);
	fclose(file);
	if (n)
		*n = size;
	return text;
}

char *program_drawn(const char *const arguments[], int columns)
{
	struct winsize size = {.ws_col = (unsigned short)columns, .ws_row = 25};
	int terminal = posix_openpt(O_RDWR | O_NOCTTY | O_CLOEXEC);
	assert_true(terminal >= 0 && grantpt(terminal) == 0 && unlockpt(terminal) == 0);
	assert_int_equal(ioctl(terminal, TIOCSWINSZ, &size), 0);
	// held open here, so that the output is not lost when the program ends
	int other = open(ptsname(terminal), O_RDWR | O_NOCTTY | O_CLOEXEC);
	setenv("TERM", "xterm", 1);
	assert_int_equal(program_end(program_start(arguments, "/dev/null", ptsname(terminal))), 0);
	char *text = calloc(1, 65536);
	size_t n = 0;
	for (struct pollfd end = {.fd = terminal, .events = POLLIN}; n < 65535 && poll(&end, 1, 0) == 1;) {
		ssize_t k = read(terminal, text + n, 65535 - n);
		assert_true(k > 0);
		n += (size_t)k;
	}
	close(other);
	close(terminal);
	return text;
}
