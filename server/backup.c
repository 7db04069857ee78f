/* Backup and restoration of a database. */
#include "server/backup.h"

#include <limits.h>
#include <stdio.h>
#include <unistd.h>

#include "server/database.h"
#include "server/disk.h"
#include "server/log.h"

/* Copies a database, which a server may use at the same time.
 *
 * Given    path    of the database
 *          to      of the copy, which must not exist
 * Test     service_backup: a_copy_made_while_studies_run_is_a_whole_database
 */
bool backup_make(const char *path, const char *to)
{
	struct database reading = {0};
	bool copied = database_open(&reading, path, false, NULL, 0) && database_copy(&reading, to);
	database_close(&reading);
	return copied;
}

/* Replaces a database that no server uses by a copy of another; the old one is kept as PATH-replaced, with its WAL.
 *
 * Given    from    a database of poundd, such as --backup makes; it is not changed
 * Returns  value   false: nothing has changed, or only PATH-replaced is there; logged
 * Test     service_backup: a_copy_is_restored_in_the_place_of_a_database_and_its_wal
 */
bool backup_restore(const char *path, const char *from)
{
	struct disk disk = {.lock = -1};
	struct database reading = {0};
	char made[PATH_MAX + 16];
	bool ok = disk_take(&disk, path);
	snprintf(made, sizeof made, "%s-restored", disk.database);
	if (ok)
		unlink(made); // left by an interrupted restoration
	ok = ok && database_open(&reading, from, false, NULL, 0) && database_ours(&reading, from) &&
	     database_checked(&reading) && database_copy(&reading, made) && disk_replace(&disk, made);
	if (ok)
		log_line("%s was replaced by a copy of %s; the old database is kept as %s-replaced", disk.database,
		         from, disk.database);
	database_close(&reading);
	disk_leave(&disk);
	return ok;
}
