/* Studies in SQLite.
 *
 * 1. One connection makes every change and every checkpoint, behind one mutex; the others are read-only and never
 *    checkpoint.  (SQLite before 3.51.3 can damage a WAL database when one connection checkpoints while another commits.)
 * 2. A lock file keeps a second server away from the database (server/disk.c).
 * 3. synchronous=FULL: a COMMIT that returned survives a power cut.
 * 4. Every query is a prepared statement; bytes of clients are only ever bound as values.
 *
 * server/database.c opens the connections. */
#include "server/store.h"

#include <assert.h>
#include <pthread.h>
#include <stdarg.h>
#include <stdatomic.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include <nettle/sha2.h>

#include "engine/pound.h"
#include "server/database.h"
#include "server/disk.h"
#include "server/log.h"

enum {
	// four threads that answer, two for slow answers, a worker and the watchdog may read at once
	READERS = 8,
	CHANGES = 1021,     /* a prime, so that ids use all counters */
	PIECE = 256 * 1024, /* [bytes] of a document copied at a time */
	DAY = 86400 * 1000, /* [ms] */
};

#include "server/statements.inl"

#define DOCUMENT_NAMED "study %016llx: its %s"

struct store {
	struct disk disk;
	struct database writer, readers[READERS]; /* readers prepare only the statements before BEGIN */
	atomic_uint changes[CHANGES];             /* of the studies with id % CHANGES */
	atomic_uint changes_all;                  /* of any study */
};

/* Binds values to a statement; types: i int64_t, d double, t text (NULL: null), b bytes and their size_t.  Texts and bytes
 * must stay valid until `ended`. */
static sqlite3_stmt *bound(struct database *c, enum statement s, const char *types, ...)
{
	sqlite3_stmt *statement = c->statements[s];
	va_list values;
	va_start(values, types);
	for (int i = 1; types[i - 1]; i++)
		if (types[i - 1] == 'i')
			sqlite3_bind_int64(statement, i, va_arg(values, int64_t));
		else if (types[i - 1] == 'd')
			sqlite3_bind_double(statement, i, va_arg(values, double));
		else if (types[i - 1] == 't')
			sqlite3_bind_text(statement, i, va_arg(values, const char *), -1, SQLITE_STATIC);
		else {
			const void *bytes = va_arg(values, const void *);
			sqlite3_bind_blob64(statement, i, bytes, va_arg(values, size_t), SQLITE_STATIC);
		}
	va_end(values);
	return statement;
}

/* Resets a statement after its last step; n: rows it changed or returned. */
static enum store_status ended(struct database *c, sqlite3_stmt *statement, int n)
{
	bool failed = sqlite3_reset(statement) != SQLITE_OK;
	if (failed)
		log_line("database: %s (%d): %.60s", sqlite3_errmsg(c->db), sqlite3_extended_errcode(c->db),
		         sqlite3_sql(statement));
	sqlite3_clear_bindings(statement);
	return failed ? STORE_FAILED : n == 0 ? STORE_NONE : STORE_OK;
}

/* Runs a change, or a query whose result is one number (NULL: not wanted). */
static enum store_status run(struct database *c, sqlite3_stmt *statement, int64_t *number)
{
	int n = 0;
	for (; sqlite3_step(statement) == SQLITE_ROW; n++)
		if (number)
			*number = sqlite3_column_int64(statement, 0);
	return ended(c, statement, sqlite3_stmt_readonly(statement) ? n : sqlite3_changes(c->db));
}

/* Commits or rolls back a transaction whose changes had `status`.  On a full disk SQLite may have rolled back already. */
static enum store_status committed(struct database *c, enum store_status status)
{
	if (status == STORE_OK && run(c, bound(c, COMMIT, ""), NULL) == STORE_FAILED)
		status = STORE_FAILED;
	if (!sqlite3_get_autocommit(c->db))
		run(c, bound(c, ROLLBACK, ""), NULL);
	return status;
}

/* Runs two changes, both or none; without the second (NULL) the first alone. */
static enum store_status both(struct database *c, sqlite3_stmt *first, sqlite3_stmt *second)
{
	enum store_status status = run(c, bound(c, BEGIN, ""), NULL);
	if (status != STORE_FAILED)
		status = run(c, first, NULL);
	if (status == STORE_OK && second)
		status = run(c, second, NULL);
	return committed(c, status);
}

/* A free reading connection, locked. */
static struct database *reader(struct store *store)
{
	for (int i = 0; i < READERS; i++)
		if (pthread_mutex_trylock(&store->readers[i].lock) == 0)
			return &store->readers[i];
	pthread_mutex_lock(&store->readers[0].lock);
	return &store->readers[0];
}

static struct database *writer(struct store *store)
{
	pthread_mutex_lock(&store->writer.lock);
	return &store->writer;
}

static enum store_status released(struct database *c, enum store_status status)
{
	pthread_mutex_unlock(&c->lock);
	return status;
}

/* The same for the writer after a change of a study, which wakes clients that wait for it.  A change is reported as done only if
 * the database file is still the one at its path, which the next start will open. */
static enum store_status changed(struct store *store, int64_t id, enum store_status status)
{
	pthread_mutex_unlock(&store->writer.lock);
	if (status == STORE_OK && !disk_intact(&store->disk))
		return STORE_REPLACED;
	if (status == STORE_OK) {
		atomic_fetch_add(&store->changes[id % CHANGES], 1);
		atomic_fetch_add(&store->changes_all, 1);
	}
	return status;
}

/* A number that grows after every change of a study: compare with its value from before the last read.
 *
 * Given    id      of the study; 0: any
 * Returns  value   shared by about one in a thousand other studies
 * Test     service_wait: a_waiting_client_is_answered_at_a_change
 */
unsigned store_changes(struct store *store, int64_t id)
{
	return atomic_load(id ? &store->changes[id % CHANGES] : &store->changes_all);
}

/* Closes the writing connection last, which removes the WAL. */
static void let_go(struct store *store)
{
	for (int i = 0; i < READERS; i++)
		database_close(&store->readers[i]);
	database_close(&store->writer);
	disk_leave(&store->disk);
	free(store);
}

/* Queues running studies again, as store_close does, unless the writing connection stays in use for longer than wait_ms. */
void store_stop(struct store *store, int wait_ms)
{
	for (; pthread_mutex_trylock(&store->writer.lock) != 0; wait_ms--)
		if (wait_ms == 0 || usleep(1000) != 0)
			return;
	released(&store->writer, run(&store->writer, bound(&store->writer, STOPPED, ""), NULL));
}

/* Closes a store that no thread uses any more. */
void store_close(struct store *store)
{
	run(&store->writer, bound(&store->writer, STOPPED, ""), NULL);
	let_go(store);
}

/* Whether there is space for new studies, including free pages of the database; truncates the WAL if space is short. */
static bool roomy(struct store *store)
{
	int64_t reusable = 0;
	struct database *c = reader(store);
	released(c, run(c, bound(c, REUSABLE, ""), &reusable));
	if (disk_roomy(&store->disk, reusable) || !disk_has_wal(&store->disk))
		return disk_roomy(&store->disk, reusable);
	c = writer(store);
	database_truncate(c);
	released(c, STORE_OK);
	return disk_roomy(&store->disk, reusable);
}

/* Opens a database, making it if there is none.  Studies that were running are queued again, except that one which
 * crashed the server three times fails, as does one during which the server ended ten times without storing a block.
 *
 * Given    path    of the database file, or of a link to it; PATH-lock, PATH-ballast, PATH-wal and PATH-shm are beside it
 * Returns  value   for store_close, NULL: in use by another server, not of poundd, or not readable; logged
 * Test     unit_store: a_store_in_use_is_not_opened_again
 */
struct store *store_open(const char *path)
{
	struct store *store = calloc(1, sizeof *store);
	if (!store) {
		log_line("cannot open the database %s: out of memory", path);
		return NULL;
	}
	struct database *w = &store->writer;
	bool ok = disk_take(&store->disk, path) && disk_found(&store->disk);
	const bool crashed = ok && disk_has_wal(&store->disk);
	if (ok)
		disk_relieve(&store->disk);
	ok = ok && database_open(w, store->disk.database, true, statement_text, N_STATEMENTS);
	ok = ok && (!crashed || database_checked(w));
	if (ok)
		database_limit_wal(w, disk_wal_most(&store->disk));
	for (int i = 0; ok && i < READERS; i++)
		ok = database_open(&store->readers[i], store->disk.database, false, statement_text, BEGIN);
	ok = ok && run(w, bound(w, REQUEUE, "i", disk_blamed(&store->disk)), NULL) != STORE_FAILED &&
	     run(w, bound(w, POISON, ""), NULL) != STORE_FAILED &&
	     run(w, bound(w, VAIN, ""), NULL) != STORE_FAILED;
	if (!ok) {
		// running studies are left for the next start to queue, which may still have to count a crash
		let_go(store);
		return NULL;
	}
	disk_blame(&store->disk, 0);
	roomy(store);
	return store;
}

/* Copies the content in column 0 of a row, whose column 1 says whether its digest is right; SQLite's bytes may be unaligned.
 * Adds a zero. */
static enum store_status checked(sqlite3_stmt *row, char **content, size_t *length)
{
	if (!sqlite3_column_int(row, 1))
		return STORE_CORRUPT;
	*length = (size_t)sqlite3_column_bytes(row, 0);
	*content = malloc(*length + 1);
	if (!*content)
		return STORE_FAILED;
	if (*length)
		memcpy(*content, sqlite3_column_blob(row, 0), *length);
	(*content)[*length] = '\0';
	return STORE_OK;
}

/* Releases a connection after a row was read, or found damaged. */
static enum store_status content_read(struct database *c, sqlite3_stmt *row, const char *place,
                                      enum store_status status)
{
	if (ended(c, row, 1) == STORE_FAILED && status == STORE_NONE)
		status = STORE_FAILED;
	if (status == STORE_CORRUPT)
		log_line("%s is damaged", place);
	return released(c, status);
}

/* The content of the only row of a query, logged by its place if damaged; releases the connection. */
static enum store_status content_of(struct database *c, sqlite3_stmt *row, const char *place, char **content,
                                    size_t *length)
{
	enum store_status status = STORE_NONE;
	if (sqlite3_step(row) == SQLITE_ROW)
		status = checked(row, content, length);
	return content_read(c, row, place, status);
}

/* The study submitted before with a key; STORE_NONE: no such study, or no key. */
static enum store_status keyed(struct database *c, const char *key, const char *request, size_t length,
                               int64_t *id)
{
	enum store_status status = key ? run(c, bound(c, KEYED, "t", key), id) : STORE_NONE;
	if (status != STORE_OK)
		return status;
	status = run(c, bound(c, SAME, "ib", *id, request, length), NULL);
	return status == STORE_OK ? STORE_REPEATED : status == STORE_NONE ? STORE_CLASH : status;
}

/* Whether one more study may be queued.  Under the writer's lock, so that simultaneous submissions are counted one after the
 * other. */
static enum store_status room_of(struct database *c, const struct store_study *study)
{
	const struct {
		int64_t most;
		const char *client;
		enum store_status reached;
	} limits[] = {{study->queue_max, NULL, STORE_CROWDED},
	              {study->own_max, study->client, STORE_CLIENT_CROWDED}};
	assert(study->own_max == 0 || study->client);
	for (int i = 0; i < 2; i++) {
		int64_t n;
		if (limits[i].most == 0)
			continue;
		if (run(c, bound(c, COUNT, "tti", "queued", limits[i].client, limits[i].most), &n) != STORE_OK)
			return STORE_FAILED;
		if (n >= limits[i].most)
			return limits[i].reached;
	}
	return STORE_OK;
}

#include "server/store_records.inl"

/* Queues a new study; it is on the disk when this returns.
 *
 * Given    request   (length) bytes   as the client sent them
 * Returns  id        of the study, or of the earlier study with the key
 * Status   STORE_REPEATED the same bytes were submitted with the key before: nothing new is stored
 *          STORE_CLASH    other bytes were submitted with the key before
 *          STORE_CROWDED, STORE_CLIENT_CROWDED: a limit of the study is reached
 *          STORE_FULL     the disk has no room for new studies
 *          STORE_UNRECORDED   a record that it names is no longer stored
 *          STORE_FAILED   nothing is stored
 * Test     service_resume: accepted_studies_survive_sigkill, unit_store: no_more_are_queued_than_may_be
 */
enum store_status store_submit(struct store *store, const struct store_study *study, const char *request,
                               size_t length, int64_t *id)
{
	const bool has_room = roomy(store);
	struct database *c = writer(store);
	enum store_status status = keyed(c, study->key, request, length, id);
	if (status != STORE_NONE)
		return released(c, status);
	status = room_of(c, study);
	if (status == STORE_OK && !has_room)
		status = STORE_FULL;
	if (status == STORE_OK)
		status = run(c, bound(c, NEXT, ""), id);
	if (status == STORE_OK)
		status = study_add(c, study, *id, request, length);
	return changed(store, *id, status);
}

static const char *text(sqlite3_stmt *row, int column)
{
	return (const char *)sqlite3_column_text(row, column);
}

static enum store_status studies(struct database *c, sqlite3_stmt *rows, store_study_reader *each, void *to)
{
	int n = 0;
	for (; sqlite3_step(rows) == SQLITE_ROW; n++) {
		const struct study_status study = {
		    .id = sqlite3_column_int64(rows, 0),
		    .status = text(rows, 1),
		    .kind = text(rows, 2),
		    .name = text(rows, 3),
		    .created = text(rows, 4),
		    .started = text(rows, 5),
		    .finished = text(rows, 6),
		    .error = text(rows, 7),
		    .runs = sqlite3_column_int64(rows, 8),
		    .runs_done = sqlite3_column_int64(rows, 9),
		    .cpu_s = sqlite3_column_double(rows, 10),
		    .cpu_s_estimated = sqlite3_column_double(rows, 11),
		    .queue_position = sqlite3_column_int64(rows, 12),
		    .cpu_s_before = sqlite3_column_double(rows, 13),
		};
		each(to, &study);
	}
	return released(c, ended(c, rows, n));
}

/* Passes one study to a reader, which is not called if there is no such study. */
enum store_status store_study(struct store *store, int64_t id, store_study_reader *each, void *to)
{
	struct database *c = reader(store);
	return studies(c, bound(c, STUDY, "i", id), each, to);
}

/* Passes a page of studies to a reader, newest first.
 *
 * Given    each     called with `to` and each study
 * Test     service_list: the_list_is_newest_first_and_pages_by_cursor,
 *          unit_store: a_list_has_the_studies_of_a_status_a_name_and_a_hash
 */
enum store_status store_list(struct store *store, const struct store_filter *filter, store_study_reader *each,
                             void *to)
{
	struct database *c = reader(store);
	return studies(c,
	               bound(c, filter->status ? LIST_OF : LIST, "iittt", filter->before, (int64_t)filter->limit,
	                     filter->status, filter->name, filter->hash),
	               each, to);
}

/* Reads a document of a study: its "request" or its "result".
 *
 * Returns  content   (length) bytes, and a zero behind them; allocated when STORE_OK
 * Status   STORE_NONE      no such study, or no result yet
 *          STORE_CORRUPT   these are not the bytes that were stored
 */
enum store_status store_document(struct store *store, int64_t id, const char *name, char **content,
                                 size_t *length)
{
	char place[64];
	snprintf(place, sizeof place, DOCUMENT_NAMED, (unsigned long long)id, name);
	struct database *c = reader(store);
	return content_of(c, bound(c, DOCUMENT, "it", id, name), place, content, length);
}

/* The length of a document, without reading its content. */
enum store_status store_length(struct store *store, int64_t id, const char *name, size_t *length)
{
	int64_t n = 0;
	struct database *c = reader(store);
	enum store_status status = run(c, bound(c, LENGTH, "it", id, name), &n);
	*length = (size_t)n;
	return released(c, status);
}

enum store_status store_start(struct store *store, int64_t id, const char *name, char *into, size_t size)
{
	struct database *c = reader(store);
	sqlite3_stmt *row = bound(c, LENGTH, "it", id, name);
	sqlite3_blob *blob = NULL;
	const bool there = sqlite3_step(row) == SQLITE_ROW;
	const int64_t length = there ? sqlite3_column_int64(row, 0) : 0, rowid = sqlite3_column_int64(row, 1);
	const int n = length < (int64_t)size ? (int)length : (int)size - 1;
	const bool read = there &&
	                  sqlite3_blob_open(c->db, "main", "document", "content", rowid, 0, &blob) == SQLITE_OK &&
	                  sqlite3_blob_read(blob, into, n, 0) == SQLITE_OK;
	sqlite3_blob_close(blob);
	into[read ? n : 0] = '\0';
	const bool failed = ended(c, row, 1) == STORE_FAILED;
	return released(c, read ? STORE_OK : there || failed ? STORE_FAILED : STORE_NONE);
}

/* Copies a blob's bytes to a file in chunks, hashing them; false: reading the database or writing the file failed. */
static bool pieces_copy(sqlite3_blob *blob, struct sha256_ctx *hash, int file)
{
	static _Thread_local char piece[PIECE];
	const int length = sqlite3_blob_bytes(blob);
	bool ok = true;
	for (int at = 0, n; ok && at < length; at += n) {
		n = length - at < PIECE ? length - at : PIECE;
		ok = sqlite3_blob_read(blob, piece, n, at) == SQLITE_OK && write(file, piece, (size_t)n) == n;
		sha256_update(hash, (size_t)n, (const uint8_t *)piece);
	}
	return ok;
}

/* Copies a document to a file without having all of it in memory.
 *
 * Given    file   empty, open for writing
 * Status   STORE_NONE      no such study, or no such document yet
 *          STORE_CORRUPT   these are not the bytes that were stored
 *          STORE_FAILED    they could not be read or written
 * Test     service_http: a_long_result_holds_nobody_up
 */
enum store_status store_document_to(struct store *store, int64_t id, const char *name, int file)
{
	struct database *c = reader(store);
	sqlite3_stmt *row = bound(c, LENGTH, "it", id, name);
	sqlite3_blob *blob = NULL;
	char place[64];
	enum store_status status = STORE_NONE;
	if (sqlite3_step(row) == SQLITE_ROW) {
		struct sha256_ctx hash;
		uint8_t sha256[SHA256_DIGEST_SIZE];
		// as DOCUMENT_DIGEST has it
		const int n_place = snprintf(place, sizeof place, "%s %lld ", name, (long long)id);
		sha256_init(&hash);
		sha256_update(&hash, (size_t)n_place, (const uint8_t *)place);
		bool copied = sqlite3_blob_open(c->db, "main", "document", "content", sqlite3_column_int64(row, 1), 0,
		                                &blob) == SQLITE_OK &&
		              pieces_copy(blob, &hash, file);
		sha256_digest(&hash, sizeof sha256, sha256);
		bool same = sqlite3_column_bytes(row, 2) == sizeof sha256 &&
		            !memcmp(sqlite3_column_blob(row, 2), sha256, sizeof sha256);
		status = !copied ? STORE_FAILED : same ? STORE_OK : STORE_CORRUPT;
	}
	sqlite3_blob_close(blob);
	snprintf(place, sizeof place, DOCUMENT_NAMED, (unsigned long long)id, name);
	return content_read(c, row, place, status);
}

/* Counts the studies of a status. */
enum store_status store_count(struct store *store, const char *status, int64_t *n)
{
	struct database *c = reader(store);
	return released(c, run(c, bound(c, COUNT, "tti", status, NULL, INT64_C(-1)), n));
}

/* Whether studies can be stored: STORE_FULL when the disk has no room for new ones.
 *
 * Test     service_disk: a_full_disk_refuses_studies_answers_questions_and_is_survived
 */
enum store_status store_ready(struct store *store)
{
	int64_t n;
	enum store_status status = store_count(store, "queued", &n);
	return status != STORE_OK           ? status
	       : !disk_intact(&store->disk) ? STORE_REPLACED
	       : roomy(store)               ? STORE_OK
	                                    : STORE_FULL;
}

/* An unnamed temporary file for a long answer. */
int store_spool(const struct store *store, size_t n)
{
	return disk_spool(&store->disk, n);
}

/* A change that frees space: on a full disk it may use the ballast file's space. */
static enum store_status relieved(struct store *store, enum statement s, int64_t id)
{
	struct database *c = writer(store);
	enum store_status status = run(c, bound(c, s, "i", id), NULL);
	if (status == STORE_FAILED) {
		disk_relieve(&store->disk);
		status = run(c, bound(c, s, "i", id), NULL);
	}
	return changed(store, id, status);
}

/* Cancels a study; STORE_NONE when it is neither queued nor running. */
enum store_status store_cancel(struct store *store, int64_t id)
{
	return relieved(store, CANCEL, id);
}

/* Deletes a study with its documents and blocks. */
enum store_status store_delete(struct store *store, int64_t id)
{
	return relieved(store, DELETE, id);
}

/* Deletes one expired study, or else the blocks of one.  One at a time, so that no other change waits for long.
 *
 * Given    days          that an ended study is kept; 0: without limit
 *          days_blocks   that its blocks, from which samples are made, are kept; 0: as long as the study
 * Returns  value         true: deleted one, call again
 * Test     unit_store: what_ended_too_long_ago_is_deleted_and_nothing_else
 */
bool store_expire(struct store *store, int days, int days_blocks)
{
	const struct {
		int64_t days;
		enum statement find, end;
		const char *what;
	} rules[] = {{days, EXPIRED, DELETE, "deleted"},
	             {days_blocks, EXPIRED_BLOCKS, SHED, "its samples are deleted"}};
	records_expire(store);
	for (int i = 0; i < 2; i++) {
		int64_t id = 0;
		struct database *c = reader(store);
		if (rules[i].days == 0)
			released(c, STORE_NONE);
		else if (released(c, run(c, bound(c, rules[i].find, "i", rules[i].days * DAY), &id)) == STORE_OK &&
		         relieved(store, rules[i].end, id) == STORE_OK) {
			log_line("study %016llx ended more than %lld d ago: %s", (unsigned long long)id,
			         (long long)rules[i].days, rules[i].what);
			return true;
		}
	}
	return false;
}

/* Claims the oldest queued study, after all others those whose last three attempts stored no block; it becomes running, and the
 * attempt is counted.
 *
 * Given    memory_most   bytes   that it may need; no later study is claimed instead, so that it is not passed over
 *          avoided       token whose studies are claimed only when there are no others; "": none
 * Returns  claimed       the study
 * Status   STORE_NONE    nothing is queued, or the study needs more memory
 * Test     unit_store: a_study_of_another_token_is_claimed_before_an_older_one,
 *          service_estimates: two_studies_that_do_not_fit_together_run_one_after_the_other
 */
enum store_status store_claim(struct store *store, int64_t memory_most, const char *avoided,
                              struct store_claimed *claimed)
{
	int n = 0;
	struct database *c = writer(store);
	sqlite3_stmt *row = bound(c, CLAIM, "it", memory_most, avoided);
	for (; sqlite3_step(row) == SQLITE_ROW; n++) {
		*claimed = (struct store_claimed){.id = sqlite3_column_int64(row, 0),
		                                  .memory = sqlite3_column_int64(row, 1),
		                                  .cpu_s = sqlite3_column_double(row, 2)};
		snprintf(claimed->client, sizeof claimed->client, "%s", text(row, 3));
	}
	enum store_status status = ended(c, row, n);
	return changed(store, status == STORE_OK ? claimed->id : 0, status);
}

/* Stores the CPU time of a running study, when reductions have raised it above the sum of its blocks. */
enum store_status store_spent(struct store *store, int64_t id, double cpu_s)
{
	struct database *c = writer(store);
	return changed(store, id, run(c, bound(c, SPENT, "id", id, cpu_s), NULL));
}

/* Records, in the signal handler of a crashing server, the study during which it crashed. */
void store_blame(const struct store *store, int64_t id)
{
	disk_blame(&store->disk, id);
}

/* Stores finished blocks of running studies, all in one transaction.
 *
 * Given    blocks   (n) pointers
 * Returns  blocks   `kept`: false for one whose study was canceled or deleted, which is not stored
 * Status   STORE_FAILED   none is stored
 * Test     unit_store: blocks_are_kept_together_and_only_while_their_studies_run
 */
enum store_status store_keep(struct store *store, struct store_block *const blocks[], int n)
{
	struct database *c = writer(store);
	enum store_status status = run(c, bound(c, BEGIN, ""), NULL) == STORE_FAILED ? STORE_FAILED : STORE_OK;
	for (int i = 0; i < n && status != STORE_FAILED; i++) {
		struct store_block *b = blocks[i];
		status = run(c,
		             bound(c, KEEP, "iiiddb", b->study, (int64_t)b->number, b->runs, b->cpu_s, b->wall_s,
		                   b->values, (size_t)b->n * sizeof(double)),
		             NULL);
		b->kept = status == STORE_OK;
		// the sums of a study, once, after its last block here
		bool last = b->kept;
		for (int j = i + 1; j < n; j++)
			last = last && blocks[j]->study != b->study;
		if (last)
			status = run(c, bound(c, PROGRESS, "i", b->study), NULL);
	}
	status = committed(c, status == STORE_FAILED ? STORE_FAILED : STORE_OK);
	if (status == STORE_OK)
		for (int i = 0; i < n; i++)
			atomic_fetch_add(&store->changes[blocks[i]->study % CHANGES], blocks[i]->kept);
	return changed(store, n > 0 ? blocks[0]->study : 0, status);
}

/* Passes the stored blocks to a reader, by number, until it returns false; leaves out damaged blocks and blocks of another version.
 *
 * Status   STORE_CORRUPT  at least one was left out
 *          STORE_FAILED   disk error or out of memory: some may be missing
 */
enum store_status store_blocks(struct store *store, int64_t id, store_block_reader *each, void *to)
{
	struct database *c = reader(store);
	sqlite3_stmt *rows = bound(c, BLOCKS, "i", id);
	int n = 0;
	bool wanted = true, corrupt = false, starved = false;
	for (; wanted && !starved && sqlite3_step(rows) == SQLITE_ROW; n++) {
		char *content;
		size_t length;
		struct store_block block = {.number = sqlite3_column_int(rows, 2),
		                            .runs = sqlite3_column_int64(rows, 3),
		                            .cpu_s = sqlite3_column_double(rows, 4),
		                            .wall_s = sqlite3_column_double(rows, 5)};
		enum store_status status = checked(rows, &content, &length);
		if (status != STORE_OK) {
			log_line("study %016llx: block %d %s", (unsigned long long)id, block.number,
			         status == STORE_CORRUPT ? "cannot be used" : "found no memory");
			corrupt |= status == STORE_CORRUPT;
			starved |= status == STORE_FAILED;
			continue;
		}
		block.n = (int)(length / sizeof(double));
		block.values = (const double *)content;
		wanted = each(to, &block);
		free(content);
	}
	enum store_status status = ended(c, rows, n);
	return released(c, starved ? STORE_FAILED : corrupt && status == STORE_OK ? STORE_CORRUPT : status);
}

/* Deletes the blocks that store_blocks leaves out, with their progress; STORE_NONE: there are none.
 *
 * Test     service_resume: blocks_of_another_version_are_not_counted
 */
enum store_status store_prune(struct store *store, int64_t id)
{
	struct database *c = writer(store);
	return changed(store, id, both(c, bound(c, PRUNE, "i", id), bound(c, RECOUNT, "i", id)));
}

/* Ends a running study.
 *
 * Given    result   (length) bytes   as the client gets it; NULL: it failed
 *          error    why it failed, a sentence; NULL: it did not
 *          cpu_s    of the whole study [s]
 * Status   STORE_NONE   it is not running any more; nothing is stored
 * Test     unit_store: a_study_finishes_once
 */
enum store_status store_finish(struct store *store, int64_t id, const char *result, size_t length,
                               const char *error, double cpu_s)
{
	assert(!result != !error);
	struct database *c = writer(store);
	enum store_status status =
	    both(c, bound(c, FINISH, "ittd", id, result ? "succeeded" : "failed", error, cpu_s),
	         result ? bound(c, ADD, "itb", id, "result", result, length) : NULL);
	return changed(store, id, status);
}
