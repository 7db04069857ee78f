/* The file system under a database.
 *
 * Three levels of free space: above the reserve new studies are accepted; below it stored studies still run; on a full
 * disk deleting the ballast file makes room for changes that free more.  Long answers are spooled above the reserve only. */
#include "server/disk.h"

#include <errno.h>
#include <fcntl.h>
#include <libgen.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/file.h>
#include <sys/param.h>
#include <sys/stat.h>
#include <sys/statvfs.h>
#include <time.h>
#include <unistd.h>

#include "server/log.h"

enum {
	RESERVE_MAX = 256 << 20, /* [bytes] */
	BALLAST_MAX = 16 << 20,  /* [bytes] */
	RESERVE_PART = 16,       /* of the whole disk, if that is less */
	BALLAST_PART = 32,
	WAL_MAX = 4 << 20, /* [bytes] */
	WAL_PART = 64,
	SPOOL_PART = 8,           /* of the spare space, for one spooled answer */
	LOCK_TRIES = 50,          /* half a second together */
	LOCK_PAUSE_NS = 10000000, /* [ns] */
};

/* Resolves the path of a database: a lock beside a link to it would let a second server in.  NULL, or the reason of a failure. */
static const char *identify(struct disk *disk, const char *path)
{
	struct stat about;
	if (!realpath(path, disk->database)) {
		// an empty file is a new database; SQLite also creates the target of a dangling link
		int file = open(path, O_WRONLY | O_CREAT | O_CLOEXEC, 0600);
		if (file < 0)
			return strerror(errno);
		close(file);
		if (!realpath(path, disk->database))
			return strerror(errno);
	}
	if (stat(disk->database, &about) != 0)
		return strerror(errno);
	return !S_ISREG(about.st_mode) ? "it is not a file"
	       : about.st_nlink > 1    ? "the file has more than one hard link, so a second server could use it"
	                               : NULL;
}

/* Records the identity of a file, for `same`. */
static bool note(const char *path, struct disk_file *file)
{
	struct statx about;
	if (statx(AT_FDCWD, path, 0, STATX_INO | STATX_BTIME, &about) != 0)
		return false;
	const uint64_t birth = (uint64_t)about.stx_btime.tv_sec * 1000000000 + about.stx_btime.tv_nsec;
	*file = (struct disk_file){.device = (uint64_t)about.stx_dev_major << 32 | about.stx_dev_minor,
	                           .inode = about.stx_ino,
	                           .birth = about.stx_mask & STATX_BTIME ? birth : 0};
	return true;
}

static bool same(const struct disk_file *p, const struct disk_file *q)
{
	return p->device == q->device && p->inode == q->inode && p->birth == q->birth;
}

/* The content of the lock file. */
struct noted {
	int64_t blamed;            /* the study during which the server crashed last, 0: none */
	struct disk_file database; /* the one opened last */
};

static struct noted noted(const struct disk *disk)
{
	struct noted noted = {0};
	// members missing from the shorter file of an earlier version, or unreadable, are 0
	ssize_t n = pread(disk->lock, &noted, sizeof noted, 0);
	(void)n;
	return noted;
}

/* Whether the open files are still the ones at their paths: removing or replacing one would lose every later commit.
 * Logged once a second.
 *
 * Test     service_backup: a_database_that_is_replaced_under_a_server_is_not_written_to
 */
bool disk_intact(struct disk *disk)
{
	struct disk_file database, lock;
	const bool there = note(disk->database, &database) && same(&database, &disk->files[0]),
	           locked = note(disk->lock_name, &lock) && same(&lock, &disk->files[1]);
	const time_t now = time(NULL);
	if (!(there && locked) && atomic_exchange(&disk->reported, now) != now)
		log_line("%s was removed or replaced while the server runs: nothing is accepted until the server is "
		         "restarted with the right file",
		         there ? disk->lock_name : disk->database);
	return there && locked;
}

bool disk_has_wal(const struct disk *disk)
{
	char name[PATH_MAX + 8];
	struct stat about;
	snprintf(name, sizeof name, "%s-wal", disk->database);
	return stat(name, &about) == 0 && about.st_size > 0;
}

/* Whether the WAL left by an earlier server belongs to another file, so that its pages must not go into this one.
 *
 * Test     service_backup: a_wal_is_not_applied_to_another_database
 */
static bool strange_wal(const struct disk *disk)
{
	static const struct disk_file none = {0};
	const struct noted before = noted(disk);
	if (!disk_has_wal(disk) || same(&before.database, &none) || same(&before.database, &disk->files[0]))
		return false;
	log_line("%s-wal does not belong to %s, which was restored or replaced: restore a backup with poundd "
	         "--restore; if both files were moved here together, remove %s first",
	         disk->database, disk->database, disk->lock_name);
	return true;
}

/* Locks a database for this process.
 *
 * Given    path   of the database; an empty file is created if there is none
 * Returns  disk   its resolved path is for SQLite too; for disk_leave, whatever the value
 *          value  false: another server has it, or it cannot be locked; logged
 * Test     unit_store: a_store_in_use_is_not_opened_again, a_store_in_use_is_not_opened_by_another_name
 */
bool disk_take(struct disk *disk, const char *path)
{
	char *name = disk->lock_name;
	const char *fault = identify(disk, path);
	disk->lock = -1;
	if (fault) {
		log_line("cannot open the database %s: %s", path, fault);
		return false;
	}
	snprintf(name, sizeof disk->lock_name, "%s-lock", disk->database);
	snprintf(disk->ballast, sizeof disk->ballast, "%s-ballast", disk->database);
	disk->lock = open(name, O_RDWR | O_CREAT | O_CLOEXEC, 0600);
	bool ours = disk->lock >= 0 && flock(disk->lock, LOCK_EX | LOCK_NB) == 0;
	// a server that was just killed keeps its lock until the kernel has freed its memory
	for (int i = 0; !ours && errno == EWOULDBLOCK && i < LOCK_TRIES; i++) {
		nanosleep(&(struct timespec){.tv_nsec = LOCK_PAUSE_NS}, NULL);
		ours = flock(disk->lock, LOCK_EX | LOCK_NB) == 0;
	}
	if (!ours)
		log_line("cannot lock %s: %s", name,
		         errno == EWOULDBLOCK ? "another server uses the database" : strerror(errno));
	return ours && note(disk->database, &disk->files[0]) && note(name, &disk->files[1]) && disk_intact(disk);
}

bool disk_replace(struct disk *disk, const char *by)
{
	static const char *const ends[] = {"", "-wal"};
	static const struct noted nothing = {0};
	char from[PATH_MAX + 16], to[PATH_MAX + 16];
	bool ok = pwrite(disk->lock, &nothing, sizeof nothing, 0) == sizeof nothing;
	for (int i = 0; ok && i < 2; i++) {
		snprintf(from, sizeof from, "%s%s", disk->database, ends[i]);
		snprintf(to, sizeof to, "%s-replaced%s", disk->database, ends[i]);
		unlink(to);
		ok = rename(from, to) == 0 || errno == ENOENT;
	}
	snprintf(from, sizeof from, "%s-shm", disk->database);
	unlink(from);
	ok = ok && rename(by, disk->database) == 0;
	if (!ok)
		log_line("cannot put %s in the place of %s: %s", by, disk->database, strerror(errno));
	return ok && disk_sync(disk->database);
}

/* Checks that a WAL beside the database belongs to it, and records the database as owner of the next; false: it does not, logged. */
bool disk_found(struct disk *disk)
{
	struct noted now = noted(disk);
	if (strange_wal(disk))
		return false;
	now.database = disk->files[0];
	ssize_t n = pwrite(disk->lock, &now, sizeof now, 0);
	(void)n; // on a full disk only this check is lost, not a study
	return true;
}

/* Unlocks it; the ballast file is deleted if this process has the lock. */
void disk_leave(struct disk *disk)
{
	if (disk->lock < 0)
		return;
	if (flock(disk->lock, LOCK_EX | LOCK_NB) == 0)
		disk_relieve(disk);
	close(disk->lock);
}

/* Syncs the folder of a file, so that a new file's entry survives a power cut. */
bool disk_sync(const char *path)
{
	char folder[PATH_MAX];
	snprintf(folder, sizeof folder, "%s", path);
	int file = open(dirname(folder), O_RDONLY | O_DIRECTORY | O_CLOEXEC);
	bool synced = file >= 0 && fsync(file) == 0;
	if (!synced)
		log_line("cannot sync the folder of %s: %s", path, strerror(errno));
	if (file >= 0)
		close(file);
	return synced;
}

/* Records the study during which the server crashes; it need not survive a power cut, so it is not synced. */
void disk_blame(const struct disk *disk, int64_t id)
{
	ssize_t n = pwrite(disk->lock, &id, sizeof id, 0);
	(void)n;
}

/* The study that was recorded last, 0: none. */
int64_t disk_blamed(const struct disk *disk)
{
	return noted(disk).blamed;
}

/* Creates the ballast file, if it does not exist. */
static bool ballasted(const struct disk *disk, int64_t size)
{
	int file = open(disk->ballast, O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, 0600);
	if (file < 0)
		return errno == EEXIST;
	bool whole = posix_fallocate(file, 0, size) == 0;
	close(file);
	if (!whole)
		disk_relieve(disk);
	return whole;
}

/* Size of the disk, and free space above the reserve, which is 256 MiB or 1/16 of a small disk [bytes]. */
static bool measure(const struct disk *disk, int64_t *size, int64_t *spare)
{
	struct statvfs of;
	if (fstatvfs(disk->lock, &of) != 0)
		return false;
	*size = (int64_t)of.f_blocks * (int64_t)of.f_frsize;
	*spare = (int64_t)of.f_bavail * (int64_t)of.f_frsize - MIN(*size / RESERVE_PART, RESERVE_MAX);
	return true;
}

/* On a small disk a long WAL could leave no space for its pages in the database itself. */
int64_t disk_wal_most(const struct disk *disk)
{
	int64_t size, spare;
	return measure(disk, &size, &spare) ? MIN(size / WAL_PART, WAL_MAX) : WAL_MAX;
}

/* Whether new studies may be accepted: there is spare space on the disk or in the database's free pages, and the ballast file
 * exists.  Data for free pages pass through the WAL, for which half of the reserve must be free.
 *
 * Given    reusable   [bytes] of free pages
 * Test     service_disk: a_full_disk_refuses_studies_answers_questions_and_is_survived,
 *          studies_that_are_deleted_make_room
 */
bool disk_roomy(const struct disk *disk, int64_t reusable)
{
	int64_t size, spare;
	if (!measure(disk, &size, &spare) || !ballasted(disk, MIN(size / BALLAST_PART, BALLAST_MAX)))
		return false;
	return spare >= 0 || (spare + reusable >= 0 && spare >= -MIN(size / RESERVE_PART, RESERVE_MAX) / 2);
}

/* Opens an unnamed temporary file for n bytes, if there is spare space for them; closing deletes it.
 *
 * Returns  value   its descriptor, for the caller to close; -1: no space
 * Test     service_http: long_answers_wait_for_slow_readers_in_files_without_names
 */
int disk_spool(const struct disk *disk, size_t n)
{
	char folder[PATH_MAX];
	int64_t size, spare;
	snprintf(folder, sizeof folder, "%s", disk->database);
	// a fraction of the remaining space for each file: many files at once do not use it up
	if (!measure(disk, &size, &spare) || (int64_t)n > spare / SPOOL_PART)
		return -1;
	return open(dirname(folder), O_RDWR | O_TMPFILE | O_CLOEXEC, 0600);
}

/* Deletes the ballast file. */
void disk_relieve(const struct disk *disk)
{
	unlink(disk->ballast);
}
