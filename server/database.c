/* One SQLite connection: its settings, its prepared statements, and the version of the database. */
#include "server/database.h"

#include <errno.h>
#include <fcntl.h>
#include <limits.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include <nettle/sha2.h>

#include "server/disk.h"
#include "server/log.h"

static const char schema_text[] =
#include "server/store.sql.inc"
    ;

enum {
	APPLICATION_ID = 0x706f756e, /* as in store.sql */
	USER_VERSION = 7,            /* as in store.sql */
	PAGE = 4096,                 /* [bytes] */
	BUSY_MS = 5000,              /* [ms] */
	RESET_SAFE = 3051003, /* the version of SQLite from which two connections may change a WAL database */
};

/* Statements that migrate a database from version n to version n + 1. */
static const char *const steps[USER_VERSION] = {
    [1] = "ALTER TABLE study ADD COLUMN crashes INTEGER NOT NULL DEFAULT 0;"
          "ALTER TABLE block ADD COLUMN wall_s REAL NOT NULL DEFAULT 0;"
          "CREATE INDEX block_progress ON block (study, attempt, runs, cpu_s);"
          "UPDATE document SET sha256 = digest(name || ' ' || study || ' ', content) "
          "WHERE sha256 = digest(name, content)",
    [2] = "ALTER TABLE study ADD COLUMN client TEXT;"
          "DROP INDEX study_status;"
          "CREATE INDEX study_status ON study (status, id, client)",
    [3] = "ALTER TABLE study ADD COLUMN runs_done INTEGER NOT NULL DEFAULT 0;"
          "ALTER TABLE study ADD COLUMN cpu_s REAL NOT NULL DEFAULT 0;"
          "ALTER TABLE study ADD COLUMN attempt_kept INTEGER NOT NULL DEFAULT 0;"
          "UPDATE study SET (runs_done, cpu_s, attempt_kept) = "
          "(SELECT coalesce(sum(runs), 0), total(cpu_s), coalesce(max(attempt), 0) FROM block WHERE study = "
          "id)",
    // keys have a client prefix since version 3; a key that was submitted again since then belongs to the second study
    [4] = "UPDATE OR IGNORE study SET idempotency_key = ' ' || idempotency_key "
          "WHERE client IS NULL AND idempotency_key NOT GLOB ' *'",
    [5] = "ALTER TABLE study ADD COLUMN cpu_s_estimated REAL NOT NULL DEFAULT 0;"
          "ALTER TABLE study ADD COLUMN memory INTEGER NOT NULL DEFAULT 0",
    [6] = "CREATE TABLE record (sha256 TEXT PRIMARY KEY, created INTEGER NOT NULL, content BLOB NOT NULL) "
          "STRICT;"
          "CREATE TABLE study_record (study INTEGER NOT NULL REFERENCES study ON DELETE CASCADE, "
          "record TEXT NOT NULL REFERENCES record, PRIMARY KEY (study, record)) STRICT, WITHOUT ROWID;"
          "CREATE INDEX study_record_names ON study_record (record);"
          "CREATE TRIGGER record_unnamed AFTER DELETE ON study_record "
          "WHEN NOT EXISTS (SELECT 1 FROM study_record WHERE record = OLD.record) "
          "BEGIN DELETE FROM record WHERE sha256 = OLD.record; END",
};

static bool done(const struct database *d, const char *sql)
{
	return sqlite3_exec(d->db, sql, NULL, NULL, NULL) == SQLITE_OK;
}

/* The first value of a query's first row, as text; "": no row. */
static const char *answer(const struct database *d, const char *sql, char text[32])
{
	sqlite3_stmt *read = NULL;
	bool came =
	    sqlite3_prepare_v2(d->db, sql, -1, &read, NULL) == SQLITE_OK && sqlite3_step(read) == SQLITE_ROW;
	const unsigned char *value = came ? sqlite3_column_text(read, 0) : NULL;
	snprintf(text, 32, "%s", value ? (const char *)value : "");
	sqlite3_finalize(read);
	return text;
}

/* Sets a PRAGMA, and reads it back. */
static bool set(const struct database *d, const char *name, const char *value)
{
	char make[64], ask[64], text[32];
	snprintf(make, sizeof make, "PRAGMA %s = %s", name, value);
	snprintf(ask, sizeof ask, "PRAGMA %s", name);
	bool holds = done(d, make) && !strcmp(answer(d, ask, text), value);
	if (!holds)
		log_line("database: cannot set %s to %s: %s", name, value, sqlite3_errmsg(d->db));
	return holds;
}

/* The SQL function digest(place, bytes): SHA-256 of the place where the bytes belong, followed by the bytes. */
static void digest(sqlite3_context *call, int n, sqlite3_value **values)
{
	struct sha256_ctx hash;
	uint8_t sha256[SHA256_DIGEST_SIZE];
	sha256_init(&hash);
	for (int i = 0; i < n; i++) {
		const void *bytes = sqlite3_value_blob(values[i]);
		sha256_update(&hash, (size_t)sqlite3_value_bytes(values[i]), bytes);
	}
	sha256_digest(&hash, sizeof sha256, sha256);
	sqlite3_result_blob(call, sha256, sizeof sha256, SQLITE_TRANSIENT);
}

static bool connected(struct database *d, const char *path, bool writes)
{
	int flags = writes ? SQLITE_OPEN_READWRITE | SQLITE_OPEN_CREATE : SQLITE_OPEN_READONLY;
	pthread_mutex_init(&d->lock, NULL);
	flags |= SQLITE_OPEN_NOMUTEX | SQLITE_OPEN_EXRESCODE;
	bool ok = sqlite3_open_v2(path, &d->db, flags, NULL) == SQLITE_OK &&
	          sqlite3_create_function(d->db, "digest", 2, SQLITE_UTF8 | SQLITE_DETERMINISTIC, NULL, digest,
	                                  NULL, NULL) == SQLITE_OK;
	if (ok) {
		sqlite3_db_config(d->db, SQLITE_DBCONFIG_DEFENSIVE, 1, NULL);
		sqlite3_db_config(d->db, SQLITE_DBCONFIG_NO_CKPT_ON_CLOSE, !writes, NULL);
	} else
		log_line("cannot open the database %s: %s", path, sqlite3_errmsg(d->db));
	return ok;
}

static bool configured(const struct database *d, bool writes)
{
	static const struct {
		const char *name, *value;
		bool
		    in_file; // stored in the file: only the writer sets it; a backup that was never opened has another value
	} settings[] = {
	    {"busy_timeout", "5000", false},
	    {"journal_mode", "wal", true},
	    {"synchronous", "2", false}, // FULL
	    {"foreign_keys", "1", false},
	    {"trusted_schema", "0", false},
	    {"cell_size_check", "1", false},
	    {"wal_autocheckpoint", "1000", false},
	    {"mmap_size", "0", false},
	    {"secure_delete", "0", false},
	    {"journal_size_limit", "4194304", false},
	};
	for (size_t i = 0; i < sizeof settings / sizeof settings[0]; i++)
		if ((writes || !settings[i].in_file) && !set(d, settings[i].name, settings[i].value))
			return false;
	return true;
}

/* Whether the database passes SQLite's quick_check: for a server that was killed, or a file not copied by --backup.
 *
 * Test     service_backup: a_wal_is_not_applied_to_another_database
 */
bool database_checked(const struct database *d)
{
	char text[32];
	bool whole = !strcmp(answer(d, "PRAGMA quick_check(1)", text), "ok");
	if (!whole)
		log_line("the database is damaged: %s; poundd --restore replaces it by a backup",
		         *text ? text : sqlite3_errmsg(d->db));
	return whole;
}

void database_limit_wal(const struct database *d, int64_t bytes)
{
	sqlite3_wal_autocheckpoint(d->db, (int)(bytes / PAGE));
}

/* Checkpoints and truncates the WAL, to free its disk space, without waiting for readers. */
void database_truncate(const struct database *d)
{
	sqlite3_busy_timeout(d->db, 0);
	sqlite3_wal_checkpoint_v2(d->db, NULL, SQLITE_CHECKPOINT_TRUNCATE, NULL, NULL);
	sqlite3_busy_timeout(d->db, BUSY_MS);
}

/* Writes a copy of the present state of the database, which others may use; it is on the disk when this returns.
 *
 * Given    path    of the copy, which must not exist
 * Returns  value   false: logged, and the incomplete copy is removed
 * Test     service_backup: a_copy_made_while_studies_run_is_a_whole_database
 *          service_faults: a_copy_that_fails_says_why_and_is_not_left
 */
bool database_copy(const struct database *d, const char *path)
{
	// creating the empty file ourselves, which SQLite accepts, ensures that no other file is removed after a failure
	int file = open(path, O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, 0600);
	if (file < 0) {
		log_line("cannot make %s: %s", path, strerror(errno));
		return false;
	}
	// :memory: is a file here
	char *sql = sqlite3_mprintf("VACUUM INTO '%q%q'", *path == '/' ? "" : "./", path);
	bool copied = sql && done(d, sql);
	if (!copied)
		log_line("cannot write %s: %s", path, sql ? sqlite3_errmsg(d->db) : "out of memory");
	sqlite3_free(sql);
	bool synced = copied && fsync(file) == 0;
	if (copied && !synced)
		log_line("cannot sync %s: %s", path, strerror(errno));
	close(file);
	synced = synced && disk_sync(path);
	if (!synced)
		unlink(path);
	return synced;
}

/* Runs statements and sets the version of the database in one transaction. */
static bool versioned(const struct database *d, const char *sql, int version)
{
	char end[64];
	snprintf(end, sizeof end, "PRAGMA user_version = %d; COMMIT", version);
	bool made = done(d, "BEGIN IMMEDIATE") && done(d, sql) && done(d, end);
	if (!made)
		log_line("cannot convert the database to version %d: %s", version, sqlite3_errmsg(d->db));
	return made;
}

/* Keeps a copy of a database of version n as PATH-vN, and migrates the database to this version. */
static bool migrated(const struct database *d, const char *path, int version)
{
	char copy[PATH_MAX];
	snprintf(copy, sizeof copy, "%s-v%d", path, version);
	// left by an interrupted migration
	unlink(copy);
	bool ok = database_copy(d, copy);
	for (; ok && version < USER_VERSION; version++)
		ok = versioned(d, steps[version], version + 1);
	if (ok)
		log_line("%s was migrated to version %d; the old database is kept as %s", path, version, copy);
	return ok;
}

/* The version of a database, 0: empty, -1: it cannot be read, is not of poundd, or of a newer version. */
static int version_of(const struct database *d, const char *path)
{
	char text[32];
	int application = atoi(answer(d, "PRAGMA application_id", text));
	int version = atoi(answer(d, "PRAGMA user_version", text));
	answer(d, "SELECT count(*) FROM sqlite_schema", text);
	if (application == 0 && !strcmp(text, "0"))
		return 0;
	if (application == APPLICATION_ID && version >= 1 && version <= USER_VERSION)
		return version;
	if (*text)
		log_line("%s is not a database of poundd, or belongs to a newer one: its version is %d, at most %d "
		         "is supported",
		         path, version, USER_VERSION);
	else
		log_line("cannot read the database %s: %s", path, sqlite3_errmsg(d->db));
	return -1;
}

bool database_ours(const struct database *d, const char *path)
{
	return version_of(d, path) > 0;
}

/* Creates the tables of a new database, or migrates an older one to this version. */
static bool founded(const struct database *d, const char *path, int version)
{
	return version == 0 ? versioned(d, schema_text, USER_VERSION) && disk_sync(path)
	                    : version == USER_VERSION || migrated(d, path, version);
}

static bool prepared(struct database *d, const char *const statements[], int n)
{
	for (int s = 0; s < n; s++)
		if (sqlite3_prepare_v3(d->db, statements[s], -1, SQLITE_PREPARE_PERSISTENT, &d->statements[s],
		                       NULL) != SQLITE_OK) {
			log_line("database: %s: %s", statements[s], sqlite3_errmsg(d->db));
			return false;
		}
	return true;
}

/* Opens a connection.
 *
 * Given    path         of the database file
 *          writes       whether it may change the database, creating or migrating it first; else it never checkpoints
 *          statements   (n)   to prepare
 * Returns  database     for database_close, whatever the value
 *          value        false: it cannot be opened, is not of poundd, or of a newer version; logged
 * Test     service_faults: a_migration_that_is_killed_anywhere_leaves_the_old_database_or_the_new
 *          unit_store: keys_of_every_version_stand_for_their_studies
 */
bool database_open(struct database *d, const char *path, bool writes, const char *const statements[], int n)
{
	if (writes && sqlite3_libversion_number() < RESET_SAFE)
		log_line("SQLite %s can damage the database if another program writes to it while poundd runs",
		         sqlite3_libversion());
	if (!connected(d, path, writes))
		return false;
	// journal_mode is stored in the file: check first that the database is of poundd
	int version = writes ? version_of(d, path) : USER_VERSION;
	return version >= 0 && configured(d, writes) && founded(d, path, version) && prepared(d, statements, n);
}

/* Closes it, opened or not. */
void database_close(struct database *d)
{
	for (int s = 0; s < DATABASE_STATEMENTS_MAX; s++)
		sqlite3_finalize(d->statements[s]);
	sqlite3_close(d->db);
}
