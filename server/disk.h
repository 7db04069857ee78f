/* disk.h - the file system under a database: who owns it, and whether it has room.
 *
 * PATH-lock keeps a second server away, and holds the study with which the last one crashed.  PATH-ballast is given up
 * so that deleting works on a full disk.  PATH is the file's one name, whatever links lead to it. */
#ifndef DISK_H
#define DISK_H

#include <limits.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

struct disk {
	int lock;
	char database[PATH_MAX]; /* its one name */
	char ballast[PATH_MAX + 8];
};

bool disk_take(struct disk *disk,
               const char *path); /* false: another server has it, or it cannot be; logged */
void disk_leave(struct disk *disk);
bool disk_sync(const char *path);                     /* the entries of the folder of a file */
void disk_blame(const struct disk *disk, int64_t id); /* notes a study, 0: none; signal-safe */
int64_t disk_blamed(const struct disk *disk);         /* the one noted last */
bool disk_roomy(const struct disk *disk);             /* room for new studies, and the ballast is there */
void disk_relieve(const struct disk *disk);           /* gives the ballast up */
/* descriptor of a file without a name that may hold n bytes; -1: there is no room */
int disk_spool(const struct disk *disk, size_t n);

#endif
