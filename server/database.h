/* database.h - an SQLite connection as poundd has it: with its settings and prepared statements, on a database of this
 * version.  Only store.c uses it. */
#ifndef DATABASE_H
#define DATABASE_H

#include <pthread.h>
#include <stdbool.h>
#include <stdint.h>

#include <sqlite3.h>

enum { DATABASE_STATEMENTS_MAX = 48 };

struct database {
	pthread_mutex_t lock; /* of the users */
	sqlite3 *db;
	sqlite3_stmt *statements[DATABASE_STATEMENTS_MAX];
};

/* one that writes makes the database or brings it to this version; false: logged, and still to be closed */
bool database_open(struct database *database, const char *path, bool writes, const char *const statements[],
                   int n);
void database_close(struct database *database);
bool database_ours(const struct database *database,
                   const char *path);                   /* of any version up to this; false: logged */
bool database_checked(const struct database *database); /* its pages hold together; false: logged */
void database_limit_wal(const struct database *database,
                        int64_t bytes);                  /* it is written back when it has so many */
void database_truncate(const struct database *database); /* its WAL, if nobody reads it now */
bool database_copy(const struct database *database, const char *path); /* false: logged */

#endif
