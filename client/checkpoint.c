/* A head, then a record for each block, appended in the order in which they end:
 *
 *   "pound checkpoint VERSION HASH\n"       of the program and of the study's meaning
 *   number n digest values                  two 32-bit numbers, SHA-256 over head, number, n and values, n doubles
 *
 * Reading stops at the first incomplete or damaged record; the file is truncated there, and the missing blocks run again. */
#include "client/checkpoint.h"

#include <errno.h>
#include <fcntl.h>
#include <pthread.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <sys/uio.h>
#include <unistd.h>

#include <nettle/sha2.h>

#include "client/command.h"
#include "schema/study/study_json.h"

struct record {
	uint32_t number, n;
	uint8_t digest[SHA256_DIGEST_SIZE];
};

struct checkpoint {
	const char *path;
	int file;
	struct pound_run *run;
	char head[160];
	pthread_mutex_t lock; /* serializes appends to the file */
	int error;            /* errno of the first write that failed */
	bool unsynced;
};

static void digest_of(const struct checkpoint *c, const struct record *record, const double *values,
                      uint8_t digest[SHA256_DIGEST_SIZE])
{
	const uint32_t place[2] = {record->number, record->n};
	struct sha256_ctx hash;
	sha256_init(&hash);
	sha256_update(&hash, strlen(c->head), (const uint8_t *)c->head);
	sha256_update(&hash, sizeof place, (const uint8_t *)place);
	sha256_update(&hash, record->n * sizeof *values, (const uint8_t *)values);
	sha256_digest(&hash, SHA256_DIGEST_SIZE, digest);
}

/* Restores the complete records.
 *
 * Returns  value   offset behind the last complete record; -1: no memory
 */
static off_t records_read(struct checkpoint *c, checkpoint_restored *restored, void *to)
{
	const int n_blocks = pound_run_blocks_most(c->run);
	off_t at = (off_t)strlen(c->head);
	size_t most = 0;
	for (int block = 0; block < n_blocks; block++)
		most = pound_run_block_size(c->run, block) > most ? pound_run_block_size(c->run, block) : most;
	double *values = malloc((most + 1) * sizeof *values);
	if (!values)
		return -1;
	for (struct record record; pread(c->file, &record, sizeof record, at) == sizeof record;) {
		uint8_t digest[SHA256_DIGEST_SIZE];
		const ssize_t size = (ssize_t)(record.n * sizeof *values);
		if (record.number >= (uint32_t)n_blocks ||
		    record.n != pound_run_block_size(c->run, (int)record.number) ||
		    pread(c->file, values, (size_t)size, at + (off_t)sizeof record) != size)
			break;
		digest_of(c, &record, values, digest);
		if (memcmp(digest, record.digest, sizeof digest) != 0)
			break;
		pound_run_block_restore(c->run, (int)record.number, values);
		restored(to, (int)record.number);
		at += (off_t)sizeof record + size;
	}
	free(values);
	return at;
}

/* Locks the file and reads it.  Returns NULL, or the error. */
static const char *file_take(struct checkpoint *c, checkpoint_restored *restored, void *to)
{
	char head[sizeof c->head] = "";
	const size_t n = strlen(c->head);
	struct stat about;
	// two programs that append to the same file would mix their records
	const struct flock whole = {.l_type = F_WRLCK, .l_whence = SEEK_SET};
	if (c->file < 0 || fstat(c->file, &about) != 0)
		return strerror(errno);
	if (fcntl(c->file, F_SETLK, &whole) != 0)
		return "another program uses it";
	const ssize_t got = pread(c->file, head, n, 0);
	// a program that was interrupted while it wrote the head left only its beginning
	if (about.st_size < (off_t)n && got >= 0 && memcmp(head, c->head, (size_t)got) == 0) {
		if (ftruncate(c->file, 0) != 0 || pwrite(c->file, c->head, n, 0) != (ssize_t)n)
			return strerror(errno);
		return NULL;
	}
	if (strncmp(head, "pound checkpoint ", 17) != 0)
		return "it is not a checkpoint file";
	if (memcmp(head, c->head, n) != 0)
		return "it belongs to another study or another version of pound; name another file";
	off_t end = records_read(c, restored, to);
	if (end < 0)
		return pound_status_text(POUND_NOMEM);
	return ftruncate(c->file, end) == 0 ? NULL : strerror(errno);
}

/* Opens a checkpoint.
 *
 * Given    path      created if it does not exist
 *          restored  called with `to` and the number of each restored block
 * Test     client_worker: a_checkpoint_cut_at_any_byte_of_its_last_record_goes_on_to_the_same_bytes
 */
struct checkpoint *checkpoint_open(const char *path, const struct pound_study *study, struct pound_run *run,
                                   checkpoint_restored *restored, void *to)
{
	char hash[STUDY_HASH_SIZE];
	struct checkpoint *c = command_sure(calloc(1, sizeof *c));
	command_sure(study_hash(study, hash) ? c : NULL);
	snprintf(c->head, sizeof c->head, "pound checkpoint %s %s\n", POUND_VERSION, hash);
	c->path = path;
	c->run = run;
	c->file = open(path, O_RDWR | O_CREAT | O_CLOEXEC | O_APPEND, 0666);
	pthread_mutex_init(&c->lock, NULL);
	const char *fault = file_take(c, restored, to);
	if (!fault)
		return c;
	command_complain("checkpoint '%s': %s", path, fault);
	if (c->file >= 0)
		close(c->file);
	free(c);
	return NULL;
}

void checkpoint_add(struct checkpoint *c, int block, const double *values)
{
	if (!c)
		return;
	struct record record = {.number = (uint32_t)block, .n = (uint32_t)pound_run_block_size(c->run, block)};
	const size_t size = record.n * sizeof *values;
	const struct iovec parts[] = {{&record, sizeof record}, {(void *)(uintptr_t)values, size}};
	digest_of(c, &record, values, record.digest);
	pthread_mutex_lock(&c->lock);
	// records behind an incomplete one cannot be read, so stop writing after a failed write
	if (!c->error && writev(c->file, parts, 2) != (ssize_t)(sizeof record + size))
		c->error = errno ? errno : ENOSPC;
	c->unsynced = true;
	pthread_mutex_unlock(&c->lock);
}

void checkpoint_sync(struct checkpoint *c)
{
	if (!c)
		return;
	pthread_mutex_lock(&c->lock);
	bool due = c->unsynced;
	c->unsynced = false;
	pthread_mutex_unlock(&c->lock);
	if (due && fdatasync(c->file) != 0 && !c->error)
		c->error = errno;
}

bool checkpoint_close(struct checkpoint *c)
{
	if (!c)
		return true;
	checkpoint_sync(c);
	bool whole = !c->error;
	if (!whole)
		command_complain("checkpoint '%s' is incomplete: %s", c->path, strerror(c->error));
	close(c->file);
	free(c);
	return whole;
}
