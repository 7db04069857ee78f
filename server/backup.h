/* backup.h - copies of a database.  false: it failed, and is logged. */
#ifndef BACKUP_H
#define BACKUP_H

#include <stdbool.h>

bool backup_make(const char *path, const char *to);      /* of one that may be in use */
bool backup_restore(const char *path, const char *from); /* of one that is not in use, by a copy */

#endif
