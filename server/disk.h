/* disk.h - the file system under a database: who owns it, and whether it has room.
 *
 * PATH-lock keeps a second server away, and holds the study with which the last one crashed.  PATH-ballast is given up
 * so that deleting works on a full disk.  PATH is the file's one name, whatever links lead to it. */
#ifndef DISK_H
#define DISK_H

#include <limits.h>
#include <stdatomic.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include <time.h>

/* by which a file is known again when its name may be another's */
struct disk_file {
	uint64_t device, inode,
	    birth; /* an inode may be given to a new file: birth [ns], 0 where the file system has none */
};

struct disk {
	int lock;
	char database[PATH_MAX]; /* its one name */
	char ballast[PATH_MAX + 8], lock_name[PATH_MAX + 8];
	struct disk_file files[2]; /* the database and the lock, as they were opened */
	_Atomic time_t reported;   /* when they were found replaced last */
};

bool disk_take(struct disk *disk,
               const char *path);   /* false: another server has it, or it cannot be; logged */
bool disk_found(struct disk *disk); /* after that: false when a WAL beside it is another file's; logged */
void disk_leave(struct disk *disk);
bool disk_intact(struct disk *disk); /* the files are still those that were opened; else logged */
/* puts another file in the place of the database, which becomes PATH-replaced, as does its WAL; false: logged */
bool disk_replace(struct disk *disk, const char *by);
bool disk_has_wal(const struct disk *disk);
bool disk_sync(const char *path);                     /* the entries of the folder of a file */
void disk_blame(const struct disk *disk, int64_t id); /* notes a study, 0: none; signal-safe */
int64_t disk_blamed(const struct disk *disk);         /* the one noted last */
/* room for new studies, on the disk or in so many reusable bytes of the database, and the ballast is there */
bool disk_roomy(const struct disk *disk, int64_t reusable);
int64_t disk_wal_most(const struct disk *disk); /* bytes of a WAL, up to which it need not be written back */
void disk_relieve(const struct disk *disk);     /* gives the ballast up */
/* descriptor of a file without a name that may hold n bytes; -1: there is no room */
int disk_spool(const struct disk *disk, size_t n);

#endif
