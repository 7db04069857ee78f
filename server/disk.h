/* disk.h - the file system under a database: its lock file, its ballast file and free space.
 *
 * PATH-lock keeps a second server away, and records the study during which the last server crashed.  PATH-ballast is
 * deleted so that deleting studies works on a full disk.  PATH is resolved: symbolic links are followed. */
#ifndef DISK_H
#define DISK_H

#include <limits.h>
#include <stdatomic.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include <time.h>

/* identifies a file even when its path has become another file's */
struct disk_file {
	uint64_t device, inode,
	    birth; /* inodes are reused, hence the birth time [ns]; 0 where the file system has none */
};

struct disk {
	int lock;
	char database[PATH_MAX]; /* its resolved path */
	char ballast[PATH_MAX + 8], lock_name[PATH_MAX + 8];
	struct disk_file files[2]; /* the database and the lock, when they were opened */
	_Atomic time_t reported;   /* when their replacement was logged last */
};

bool disk_take(struct disk *disk,
               const char *path);   /* locks it; false: another server has the lock, or an error; logged */
bool disk_found(struct disk *disk); /* after that: false: the WAL belongs to another file; logged */
void disk_leave(struct disk *disk);
bool disk_intact(struct disk *disk); /* the files at the paths are the opened ones; else logged */
/* renames the database and its WAL to PATH-replaced and PATH-replaced-wal, and `by` to PATH; false: logged */
bool disk_replace(struct disk *disk, const char *by);
bool disk_has_wal(const struct disk *disk);
bool disk_sync(const char *path);                     /* fsync of the folder of a file */
void disk_blame(const struct disk *disk, int64_t id); /* records a study, 0: none; async-signal-safe */
int64_t disk_blamed(const struct disk *disk);         /* the study recorded last */
/* there is space for new studies, on the disk or in the database's reusable bytes, and the ballast exists */
bool disk_roomy(const struct disk *disk, int64_t reusable);
int64_t disk_wal_most(const struct disk *disk); /* [bytes] of the WAL up to which no checkpoint is needed */
void disk_relieve(const struct disk *disk);     /* deletes the ballast file */
/* descriptor of an unnamed temporary file for n bytes; -1: no space */
int disk_spool(const struct disk *disk, size_t n);

#endif
