/* backup.h - copies of a database.  false: failed, logged. */
#ifndef BACKUP_H
#define BACKUP_H

#include <stdbool.h>

bool backup_make(const char *path, const char *to);      /* copies one that may be in use */
bool backup_restore(const char *path, const char *from); /* replaces one not in use by a copy */

#endif
