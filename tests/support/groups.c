#include "tests/support/groups.h"

#include <arpa/inet.h>
#include <string.h>
#include <sys/socket.h>
#include <time.h>
#include <unistd.h>

#include "tests/support/check.h"
#include "tests/support/program.h"

enum {
	BLOCKS_MAX = 4000,
	LISTED_S = 60, /* [s] limit for launchers to start */
};

double groups_now(void)
{
	struct timespec now;
	clock_gettime(CLOCK_MONOTONIC, &now);
	return (double)now.tv_sec + 1e-9 * (double)now.tv_nsec;
}

void groups_write(const char *path, const char *text)
{
	FILE *file = fopen(path, "w");
	assert_non_null(file);
	fputs(text, file);
	assert_int_equal(fclose(file), 0);
}

int groups_pids(const char *path, pid_t pids[GROUPS_PIDS_MAX])
{
	int n = 0;
	FILE *file = fopen(path, "r");
	while (file && n < GROUPS_PIDS_MAX && fscanf(file, "%d", &pids[n]) == 1)
		n++;
	if (file)
		fclose(file);
	return n;
}

void groups_wait(const char *path, int n, pid_t pids[GROUPS_PIDS_MAX])
{
	const double start = groups_now();
	for (int listed; (listed = groups_pids(path, pids)) < n; usleep(1000))
		if (groups_now() - start > LISTED_S)
			fail_msg("%d workers of %d have started after %d s", listed, n, LISTED_S);
}

bool groups_is_gone(pid_t pid)
{
	char path[64], state = 'X';
	snprintf(path, sizeof path, "/proc/%d/stat", (int)pid);
	FILE *file = fopen(path, "r");
	if (file && fscanf(file, "%*d %*s %c", &state) != 1)
		state = 'X';
	if (file)
		fclose(file);
	return state == 'X' || state == 'Z';
}

double groups_gone(const char *file, int limit_ms)
{
	pid_t pids[GROUPS_PIDS_MAX];
	const double start = groups_now();
	for (int i = groups_pids(file, pids) - 1; i >= 0; i--)
		while (!groups_is_gone(pids[i])) {
			if (groups_now() - start > 1e-3 * limit_ms)
				fail_msg("process %d is there after %d ms", (int)pids[i], limit_ms);
			usleep(1000);
		}
	return groups_now() - start;
}

int groups_port(void)
{
	struct sockaddr_in at = {.sin_family = AF_INET, .sin_addr.s_addr = htonl(INADDR_LOOPBACK)};
	socklen_t size = sizeof at;
	const int s = socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0);
	assert_true(s >= 0 && bind(s, (const struct sockaddr *)&at, size) == 0);
	assert_int_equal(getsockname(s, (struct sockaddr *)&at, &size), 0);
	close(s);
	return ntohs(at.sin_port);
}

int groups_blocks(const char *err)
{
	const char *line = strstr(err, "worker groups ran ");
	assert_non_null(line);
	return atoi(line + strlen("worker groups ran "));
}

void groups_records(const char *checkpoint, int *n_once, int *n_more)
{
	static int of_block[BLOCKS_MAX];
	size_t n;
	char *bytes = program_file(checkpoint, &n);
	assert_non_null(bytes);
	memset(of_block, 0, sizeof of_block);
	char *at = memchr(bytes, '\n', n);
	assert_non_null(at);
	for (at++; at < bytes + n;) {
		uint32_t place[2]; // number of the block, number of doubles
		memcpy(place, at, sizeof place);
		assert_true(place[0] < BLOCKS_MAX);
		of_block[place[0]]++;
		at += sizeof place + 32 + place[1] * sizeof(double);
	}
	assert_ptr_equal(at, bytes + n);
	*n_once = *n_more = 0;
	for (int block = 0; block < BLOCKS_MAX; block++) {
		*n_once += of_block[block] == 1;
		*n_more += of_block[block] > 1;
	}
	free(bytes);
}
