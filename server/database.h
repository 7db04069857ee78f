/* database.h - an SQLite connection with poundd's settings and prepared statements, to a database of this version.  Only
 * store.c and backup.c use it. */
#ifndef DATABASE_H
#define DATABASE_H

#include <pthread.h>
#include <stdbool.h>
#include <stdint.h>

#include <sqlite3.h>

enum { DATABASE_STATEMENTS_MAX = 48 };

struct database {
	pthread_mutex_t lock; /* held while the connection is used */
	sqlite3 *db;
	sqlite3_stmt *statements[DATABASE_STATEMENTS_MAX];
};

/* writes: also creates the database or migrates it to this version; false: logged; close it in either case */
bool database_open(struct database *database, const char *path, bool writes, const char *const statements[],
                   int n);
void database_close(struct database *database);
bool database_ours(const struct database *database,
                   const char *path);                   /* of this or an earlier version; false: logged */
bool database_checked(const struct database *database); /* SQLite's quick_check passes; false: logged */
void database_limit_wal(const struct database *database,
                        int64_t bytes);                  /* checkpoint when the WAL has so many */
void database_truncate(const struct database *database); /* its WAL, unless a reader uses it */
bool database_copy(const struct database *database, const char *path); /* false: logged */

#endif
