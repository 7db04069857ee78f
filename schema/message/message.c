/* message.c - sends, receives and checks messages; a row for each type has the valid values of a head, unused fields are 0. */
#include "schema/message/message.h"

#include <errno.h>
#include <math.h>
#include <netinet/in.h>
#include <netinet/tcp.h>
#include <stdlib.h>
#include <string.h>
#include <sys/socket.h>
#include <sys/time.h>
#include <sys/uio.h>

#include <nettle/sha2.h>

// clang-format off
static const struct row {
	enum message_sender sender;
	int32_t block_min, block_max;
	uint32_t n_min, n_max; /* if the status is POUND_OK; else there is no body */
	uint32_t unit;         /* unit of n [bytes] */
	bool study, status, cpu_s; /* fields that it uses */
} kinds[] = {
	[MESSAGE_READY]  = {MESSAGE_OF_WORKER,      1, MESSAGE_THREADS_MAX, 1, MESSAGE_VERSION_MAX, 1, false, false, false},
	[MESSAGE_STUDY]  = {MESSAGE_OF_COORDINATOR, 0, 0, 1, MESSAGE_DOCUMENT_MAX, 1, true, false, false},
	[MESSAGE_DESIGN] = {MESSAGE_OF_WORKER,      0, 0, MESSAGE_DIGEST_SIZE, MESSAGE_DIGEST_SIZE, 1, true, true, false},
	[MESSAGE_BLOCK]  = {MESSAGE_OF_COORDINATOR, 0, INT32_MAX, 0, 0, 1, true, false, false},
	[MESSAGE_VALUES] = {MESSAGE_OF_WORKER,      0, INT32_MAX, 1, MESSAGE_VALUES_MAX, sizeof(double), true, true, true},
	[MESSAGE_DROP]   = {MESSAGE_OF_COORDINATOR, 0, 0, 0, 0, 1, true, false, false},
	[MESSAGE_REFUSE] = {MESSAGE_OF_COORDINATOR, 0, 0, 1, MESSAGE_TEXT_MAX, 1, false, false, false},
};
// clang-format on

static bool is_status(int32_t status)
{
	static const int32_t known[] = {
#define X(name, value, ...) value,
	    POUND_STATUS(X)
#undef X
	};
	for (size_t i = 0; i < sizeof known / sizeof known[0]; i++)
		if (known[i] == status)
			return true;
	return false;
}

/* Checks every field of a head.
 *
 * Returns  value   NULL, or a sentence
 * Test     unit_message: every_field_of_a_head_is_checked
 */
const char *message_fault(const struct message *m, enum message_sender sender)
{
	if (m->type < MESSAGE_READY || m->type > MESSAGE_REFUSE)
		return "its type is unknown";
	const struct row *row = &kinds[m->type];
	if (row->sender != sender)
		return "its type is not one that this side sends";
	if (m->block < row->block_min || m->block > row->block_max)
		return m->type == MESSAGE_READY ? "its number of threads is out of range"
		                                : "its block is out of range";
	if (row->status ? !is_status(m->status) : m->status != POUND_OK)
		return "its status is unknown";
	const bool has_body = m->status == POUND_OK;
	if (m->n < (has_body ? row->n_min : 0) || m->n > (has_body ? row->n_max : 0))
		return "the length of its body is out of range";
	if ((m->study != 0) != row->study)
		return "its study is out of range";
	if (row->cpu_s ? !(isfinite(m->cpu_s) && m->cpu_s >= 0) : !(m->cpu_s == 0))
		return "its time is out of range";
	return NULL;
}

size_t message_body_size(const struct message *m)
{
	return (size_t)m->n * kinds[m->type].unit;
}

void message_prepare(int socket)
{
	const int on = 1, silence = MESSAGE_SILENCE, silence_ms = 1000 * MESSAGE_SILENCE,
	          every = MESSAGE_SILENCE / 3, times = 3;
	const struct timeval limit = {.tv_sec = MESSAGE_SILENCE};
	setsockopt(socket, IPPROTO_TCP, TCP_NODELAY, &on, sizeof on);
	setsockopt(socket, SOL_SOCKET, SO_KEEPALIVE, &on, sizeof on);
	setsockopt(socket, IPPROTO_TCP, TCP_KEEPIDLE, &every, sizeof silence);
	setsockopt(socket, IPPROTO_TCP, TCP_KEEPINTVL, &every, sizeof every);
	setsockopt(socket, IPPROTO_TCP, TCP_KEEPCNT, &times, sizeof times);
	setsockopt(socket, IPPROTO_TCP, TCP_USER_TIMEOUT, &silence_ms, sizeof silence_ms);
	setsockopt(socket, SOL_SOCKET, SO_SNDTIMEO, &limit, sizeof limit);
}

bool message_send(int socket, const struct message *m, const void *body)
{
	struct iovec parts[2] = {{(void *)(uintptr_t)m, sizeof *m},
	                         {(void *)(uintptr_t)body, message_body_size(m)}};
	struct msghdr all = {.msg_iov = parts, .msg_iovlen = 2};
	while (parts[0].iov_len + parts[1].iov_len > 0) {
		ssize_t sent = sendmsg(socket, &all, MSG_NOSIGNAL);
		if (sent < 0 && errno == EINTR)
			continue;
		if (sent <= 0)
			return false;
		for (int i = 0; i < 2; i++) {
			size_t part = (size_t)sent < parts[i].iov_len ? (size_t)sent : parts[i].iov_len;
			parts[i].iov_base = (char *)parts[i].iov_base + part;
			parts[i].iov_len -= part;
			sent -= (ssize_t)part;
		}
	}
	return true;
}

bool message_receive(int socket, void *bytes, size_t n)
{
	for (size_t at = 0; at < n;) {
		ssize_t got = recv(socket, (char *)bytes + at, n - at, 0);
		if (got < 0 && errno == EINTR)
			continue;
		if (got <= 0)
			return false;
		at += (size_t)got;
	}
	return true;
}

/* Receives a message.
 *
 * Memory   allocates; the caller frees the body
 * Test     unit_message: a_connection_that_ends_at_any_byte_is_an_end
 */
bool message_take(int socket, enum message_sender sender, struct message *m, char **body)
{
	*body = NULL;
	if (!message_receive(socket, m, sizeof *m) || message_fault(m, sender))
		return false;
	size_t n = message_body_size(m);
	if (n == 0)
		return true;
	*body = malloc(n);
	if (*body && message_receive(socket, *body, n))
		return true;
	free(*body);
	*body = NULL;
	return false;
}

bool message_design(const struct pound_study *study, struct pound_run *run,
                    uint8_t digest[MESSAGE_DIGEST_SIZE])
{
	const int n_blocks = pound_run_blocks_most(run);
	double *x = calloc((size_t)study->n_inputs + 1, sizeof *x);
	bool *all = malloc((size_t)n_blocks * sizeof *all);
	struct sha256_ctx hash;
	sha256_init(&hash);
	sha256_update(&hash, sizeof POUND_VERSION, (const uint8_t *)POUND_VERSION);
	for (int block = 0; all && block < n_blocks; block++) {
		const uint64_t size = pound_run_block_size(run, block);
		sha256_update(&hash, sizeof size, (const uint8_t *)&size);
		all[block] = true;
	}
	// the first two samples of a row (A, B) contain all values of a design; a growing design draws all its rows at the start
	const int rows = all && pound_study_sampled(study) ? pound_run_rows_done(run, all) : 0;
	for (int row = 0; x && row < rows; row++)
		for (int sample = 0; sample < 2; sample++) {
			pound_run_sample_inputs(run, row, sample, x);
			sha256_update(&hash, (size_t)study->n_inputs * sizeof *x, (const uint8_t *)x);
		}
	sha256_digest(&hash, MESSAGE_DIGEST_SIZE, digest);
	const bool made = x && all;
	free(x);
	free(all);
	return made;
}

bool message_movable(const struct pound_study *study)
{
	return study->kind != POUND_KIND_CONVERGENCE && pound_solver_is_portable(study->solver.method);
}
