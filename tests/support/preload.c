/* Wraps functions of the C library for a poundd (LD_PRELOAD): injects faults, records and counts as faults.h requests.
 *
 * Files are recognized by their names at open; calls for files other than the database, its WAL or journal, or their folder
 * are unchanged.  An entry of the record is one appending write, so that threads and processes do not mix. */
#include <dlfcn.h>
#include <errno.h>
#include <fcntl.h>
#include <signal.h>
#include <stdarg.h>
#include <stdbool.h>
#include <stdlib.h>
#include <string.h>
#include <sys/mman.h>
#include <sys/syscall.h>
#include <sys/uio.h>
#include <time.h>
#include <unistd.h>

#include <sqlite3.h>

#include "tests/support/faults.h"

enum { FILES_MAX = 4096 };

static struct faults *faults;        /* NULL: not attached yet, or no faults requested */
static int record = -1;              /* file descriptor */
static signed char kinds[FILES_MAX]; /* enum faults_file + 1 of a file descriptor, 0: another */

__attribute__((constructor)) static void begin(void)
{
	const char *path = getenv(FAULTS_VARIABLE);
	int file = path ? open(path, O_RDWR | O_CLOEXEC) : -1;
	if (file < 0)
		return;
	void *shared = mmap(NULL, sizeof *faults, PROT_READ | PROT_WRITE, MAP_SHARED, file, 0);
	close(file);
	if (shared == MAP_FAILED)
		abort();
	struct faults *mine = shared;
	if (mine->records) {
		char name[256];
		strcat(strcpy(name, mine->folder), "/record");
		record = open(name, O_WRONLY | O_APPEND | O_CREAT | O_CLOEXEC, 0600);
	}
	faults = mine;
}

/* enum faults_file + 1 of a path, 0: another file */
static int kind_of(const char *path)
{
	static const char *const ends[] = {".db", "-wal", "-journal"};
	size_t n = faults ? strlen(faults->folder) : 0;
	if (!faults || strncmp(path, faults->folder, n) != 0)
		return 0;
	if (!path[n])
		return FAULTS_FOLDER + 1;
	for (int i = 0; i < 3; i++)
		if (strlen(path) > strlen(ends[i]) && !strcmp(path + strlen(path) - strlen(ends[i]), ends[i]))
			return i + 1;
	return 0;
}

static int kind_at(int file)
{
	return faults && file >= 0 && file < FILES_MAX ? kinds[file] : 0;
}

static void note(int event, int kind, int64_t offset, const void *bytes, size_t n)
{
	const struct faults_entry entry = {
	    .event = event, .file = kind - 1, .offset = offset, .size = (int64_t)n};
	struct iovec parts[] = {{(void *)&entry, sizeof entry}, {(void *)bytes, n}};
	if (record >= 0 && writev(record, parts, n ? 2 : 1) < 0)
		abort();
}

/* Decrements a countdown of calls; true for the call that reaches its end. */
static bool due(atomic_long *calls)
{
	return atomic_load(calls) > 0 && atomic_fetch_sub(calls, 1) == 1;
}

/* Whether a disk call is to fail: at random with probability of_1000 / 1000, or by countdown. */
static bool fails(int of_1000)
{
	static _Thread_local uint64_t state = 88172645463325252;
	atomic_fetch_add(&faults->disk_calls, 1);
	if (due(&faults->disk_kills_in))
		raise(SIGKILL);
	state ^= state << 13;
	state ^= state >> 7;
	state ^= state << 17;
	bool failed = due(&faults->disk_fails_in) || (int)(state % 1000) < of_1000;
	if (failed) {
		atomic_fetch_add(&faults->disk_failed, 1);
		errno = EIO;
	}
	return failed;
}

int open(const char *path, int flags, ...)
{
	va_list values;
	va_start(values, flags);
	mode_t mode = flags & O_CREAT ? va_arg(values, mode_t) : 0;
	va_end(values);
	int kind = kind_of(path);
	bool is_new = kind && (flags & O_CREAT) && access(path, F_OK) != 0;
	int file = (int)syscall(SYS_openat, AT_FDCWD, path, flags, mode);
	if (faults)
		atomic_fetch_add(&faults->files_opened, 1);
	if (file >= 0 && file < FILES_MAX)
		kinds[file] = (signed char)kind;
	if (is_new && file >= 0)
		note(FAULTS_OPEN, kind, 0, NULL, 0);
	return file;
}

int open64(const char *path, int flags, ...) __attribute__((alias("open")));

ssize_t pwrite(int file, const void *bytes, size_t n, off_t offset)
{
	int kind = kind_at(file);
	if (kind && fails(faults->write_fails))
		return -1;
	if (kind)
		note(FAULTS_WRITE, kind, offset, bytes, n);
	return syscall(SYS_pwrite64, file, bytes, n, offset);
}

ssize_t pwrite64(int file, const void *bytes, size_t n, off_t offset) __attribute__((alias("pwrite")));

int ftruncate(int file, off_t size)
{
	int kind = kind_at(file);
	if (kind && fails(0))
		return -1;
	if (kind)
		note(FAULTS_TRUNCATE, kind, size, NULL, 0);
	return (int)syscall(SYS_ftruncate, file, size);
}

int ftruncate64(int file, off_t size) __attribute__((alias("ftruncate")));

static int synced(int file, long call)
{
	int kind = kind_at(file);
	if (kind && fails(faults->sync_fails))
		return -1;
	if (kind && faults->sync_ms)
		usleep(1000 * (useconds_t)faults->sync_ms);
	int done = (int)syscall(call, file);
	if (kind && done == 0)
		note(FAULTS_SYNC, kind, 0, NULL, 0);
	return done;
}

int fsync(int file)
{
	return synced(file, SYS_fsync);
}

int fdatasync(int file)
{
	return synced(file, SYS_fdatasync);
}

int unlink(const char *path)
{
	int kind = kind_of(path);
	if (kind && fails(0))
		return -1;
	if (kind)
		note(FAULTS_UNLINK, kind, 0, NULL, 0);
	return (int)syscall(SYS_unlink, path);
}

int clock_gettime(clockid_t clock, struct timespec *time)
{
	int status = (int)syscall(SYS_clock_gettime, clock, time);
	if (faults && clock == CLOCK_REALTIME)
		time->tv_sec += atomic_load(&faults->clock_s);
	return status;
}

/* For a test, sets synchronous = NORMAL here, because the server prepares its statements after the check of its settings. */
int sqlite3_prepare_v3(sqlite3 *db, const char *sql, int n, unsigned flags, sqlite3_stmt **statement,
                       const char **rest)
{
	static int (*prepare)(sqlite3 *, const char *, int, unsigned, sqlite3_stmt **, const char **);
	static int (*exec)(sqlite3 *, const char *, int (*)(void *, int, char **, char **), void *, char **);
	if (!prepare) {
		*(void **)&exec = dlsym(RTLD_NEXT, "sqlite3_exec");
		*(void **)&prepare = dlsym(RTLD_NEXT, "sqlite3_prepare_v3");
	}
	if (faults && faults->normal)
		exec(db, "PRAGMA synchronous = NORMAL", NULL, NULL, NULL);
	return prepare(db, sql, n, flags, statement, rest);
}

#if !defined __SANITIZE_ADDRESS__ && !defined __SANITIZE_THREAD__

void *__libc_malloc(size_t size);
void *__libc_calloc(size_t n, size_t size);
void *__libc_realloc(void *memory, size_t size);
void *__libc_memalign(size_t alignment, size_t size);
void __libc_free(void *memory);

static bool refused(void)
{
	if (!faults)
		return false;
	atomic_fetch_add(&faults->memory_calls, 1);
	if (!due(&faults->memory_fails_in))
		return false;
	atomic_fetch_add(&faults->memory_failed, 1);
	errno = ENOMEM;
	return true;
}

static void *counted(void *memory)
{
	if (memory && faults)
		atomic_fetch_add(&faults->memory_live, 1);
	return memory;
}

void *malloc(size_t size)
{
	return refused() ? NULL : counted(__libc_malloc(size));
}

void *calloc(size_t n, size_t size)
{
	return refused() ? NULL : counted(__libc_calloc(n, size));
}

void *realloc(void *memory, size_t size)
{
	if (refused())
		return NULL;
	void *moved = __libc_realloc(memory, size);
	return memory ? moved : counted(moved);
}

void *aligned_alloc(size_t alignment, size_t size)
{
	return refused() ? NULL : counted(__libc_memalign(alignment, size));
}

void free(void *memory)
{
	if (memory && faults)
		atomic_fetch_sub(&faults->memory_live, 1);
	__libc_free(memory);
}

#endif
