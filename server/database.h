/* database.h - an SQLite connection as poundd has it: with its settings and prepared statements, on a database of this
 * version.  Only store.c uses it. */
#ifndef DATABASE_H
#define DATABASE_H

#include <pthread.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include <nettle/sha2.h>
#include <sqlite3.h>

enum { DATABASE_STATEMENTS_MAX = 32 };

struct database {
	pthread_mutex_t lock; /* of the users */
	sqlite3 *db;
	sqlite3_stmt *statements[DATABASE_STATEMENTS_MAX];
};

/* one that writes makes the database or brings it to this version; false: logged, and still to be closed */
bool database_open(struct database *database, const char *path, bool writes);
bool database_prepare(struct database *database, const char *const statements[], int n);
void database_close(struct database *database);
int64_t database_number(const struct database *database, const char *sql); /* -1: none */
bool database_copy(const struct database *database, const char *path);     /* false: logged */

/* what stored bytes are checked with: where they belong, and themselves */
void database_digest(const char *place, const void *bytes, size_t n, uint8_t sha256[SHA256_DIGEST_SIZE]);
void database_document_place(int64_t study, const char *name, char place[64]);

#endif
