/* The file system under a database.
 *
 * Three levels of what is free: above `reserve` new studies are taken, below it those that are stored still run, and
 * when nothing is left the ballast makes room for what frees more.  Long answers are spooled above the reserve alone. */
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
	RESERVE_PART = 16,       /* of the whole disk, where that is less */
	BALLAST_PART = 32,
	SPOOL_PART = 8,           /* of what is to spare, for one spooled answer */
	LOCK_TRIES = 50,          /* half a second together */
	LOCK_PAUSE_NS = 10000000, /* [ns] */
};

/* Finds the one name of a database: a lock beside a link to it would let a second server in.  NULL, or why there is none. */
static const char *identify(struct disk *disk, const char *path)
{
	struct stat about;
	if (!realpath(path, disk->database)) {
		// an empty file is a new database; SQLite, too, makes the one that a link leads to
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
	       : about.st_nlink > 1
	           ? "the file has another name (a hard link), by which a second server could use it"
	           : NULL;
}

/* Locks a database for this process.
 *
 * Given    path   of the database; an empty one is made if there is none
 * Returns  disk   its one name is for SQLite too; for disk_leave, whatever the value
 *          value  false: another server has it, or the lock cannot be made; logged
 * Test     unit_store: a_store_in_use_is_not_opened_again, a_store_in_use_is_not_opened_by_another_name
 */
bool disk_take(struct disk *disk, const char *path)
{
	char name[sizeof disk->ballast];
	const char *fault = identify(disk, path);
	disk->lock = -1;
	if (fault) {
		log_line("cannot open the database %s: %s", path, fault);
		return false;
	}
	snprintf(name, sizeof name, "%s-lock", disk->database);
	snprintf(disk->ballast, sizeof disk->ballast, "%s-ballast", disk->database);
	disk->lock = open(name, O_RDWR | O_CREAT | O_CLOEXEC, 0600);
	bool ours = disk->lock >= 0 && flock(disk->lock, LOCK_EX | LOCK_NB) == 0;
	// a server that was just killed keeps its lock until its memory is given back
	for (int i = 0; !ours && errno == EWOULDBLOCK && i < LOCK_TRIES; i++) {
		nanosleep(&(struct timespec){.tv_nsec = LOCK_PAUSE_NS}, NULL);
		ours = flock(disk->lock, LOCK_EX | LOCK_NB) == 0;
	}
	if (!ours)
		log_line("cannot lock %s: %s", name,
		         errno == EWOULDBLOCK ? "another server uses the database" : strerror(errno));
	return ours;
}

/* Unlocks it; the ballast goes, if this process has the lock. */
void disk_leave(struct disk *disk)
{
	if (disk->lock < 0)
		return;
	if (flock(disk->lock, LOCK_EX | LOCK_NB) == 0)
		disk_relieve(disk);
	close(disk->lock);
}

/* Puts the entries of a file's folder on the disk, so that a new file is there after a power cut. */
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

/* Notes the study with which the server crashes; it is not for a power cut, so it need not be synced. */
void disk_blame(const struct disk *disk, int64_t id)
{
	ssize_t n = pwrite(disk->lock, &id, sizeof id, 0);
	(void)n;
}

/* The study that was noted last, 0: none. */
int64_t disk_blamed(const struct disk *disk)
{
	int64_t id;
	return pread(disk->lock, &id, sizeof id, 0) == sizeof id ? id : 0;
}

/* Puts the ballast there, if it is not. */
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

/* How large a disk is, and what is free on it above the reserve, 256 MiB or a 16th of a small one [bytes]. */
static bool measure(const struct disk *disk, int64_t *size, int64_t *spare)
{
	struct statvfs of;
	if (fstatvfs(disk->lock, &of) != 0)
		return false;
	*size = (int64_t)of.f_blocks * (int64_t)of.f_frsize;
	*spare = (int64_t)of.f_bavail * (int64_t)of.f_frsize - MIN(*size / RESERVE_PART, RESERVE_MAX);
	return true;
}

/* Whether new studies may be taken: there is something to spare, and the ballast is there.
 *
 * Test     service_disk: a_full_disk_refuses_studies_answers_questions_and_is_survived
 */
bool disk_roomy(const struct disk *disk)
{
	int64_t size, spare;
	return measure(disk, &size, &spare) && ballasted(disk, MIN(size / BALLAST_PART, BALLAST_MAX)) &&
	       spare >= 0;
}

/* Makes a file without a name for bytes, if there is room to spare for them: it is gone when it is closed.
 *
 * Returns  value   its descriptor, for the caller to close; -1: none
 * Test     service_http: long_answers_wait_for_slow_readers_in_files_without_names
 */
int disk_spool(const struct disk *disk, size_t n)
{
	char folder[PATH_MAX];
	int64_t size, spare;
	snprintf(folder, sizeof folder, "%s", disk->database);
	// a part of what is left each time: however many are written at once, they do not use it up
	if (!measure(disk, &size, &spare) || (int64_t)n > spare / SPOOL_PART)
		return -1;
	return open(dirname(folder), O_RDWR | O_TMPFILE | O_CLOEXEC, 0600);
}

/* Gives the ballast up. */
void disk_relieve(const struct disk *disk)
{
	unlink(disk->ballast);
}
