/* Power cuts: every study, result and progress that a client has received is on the disk after a cut, whatever the disk
 * does with unsynced writes.
 *
 * A real poundd accepts studies, runs them and sends results.  tests/support/preload.c records every write, sync, change
 * of size, creation and removal of its database files; the test adds the answers that the client received.  A cut is a
 * position in that record.  Entries synced before the cut are on the disk.  Each later entry is lost, complete, or (a
 * write) present in some of its 512-byte sectors, as on a disk that reorders writes.  The test then opens the database
 * as after a restart: it must be consistent and hold every study and result that the client received, byte for byte.
 *
 * With synchronous=NORMAL the same test must find lost studies; otherwise it could not detect a missing sync. */
#include <fcntl.h>
#include <math.h>
#include <sqlite3.h>
#include <string.h>
#include <unistd.h>

#include "schema/json/json_pointer.h"
#include "server/store.h"
#include "tests/support/faults.h"
#include "tests/support/program.h"
#include "tests/support/service.h"

enum {
	STUDIES = 100,
	BLANKS =
	    24000, /* added to each document: a WAL of 1000 pages is copied into the database, so it must grow fast */
	SECTOR = 512,
	STORE_EVERY = 50, /* every 50th database is also opened by the server's own code */
	LOOKS = 400,      /* recorded answers about the progress of a study, at most */
	SYNC_MS = 100,    /* added to a sync, so that many blocks are committed together */
};

/* Answers that the client received: number i, study i is stored; number STUDIES + i, its result. */
static struct known_study {
	char id[17];
	char *bytes; /* the result */
	size_t length;
} answered[STUDIES];

/* Finished runs in recorded progress i (answer number 2 * STUDIES + i); 0: no such answer. */
static int64_t runs_answered[LOOKS];
enum { N_TOLD = 2 * STUDIES + LOOKS };

/* Content of a file: the synced part of the record, or the file after a cut. */
struct image {
	uint8_t *bytes;
	int64_t size, capacity;
	bool exists;
};

static void resize(struct image *image, int64_t size)
{
	if (size > image->capacity) {
		image->capacity = 2 * size;
		image->bytes = realloc(image->bytes, (size_t)image->capacity);
		assert_non_null(image->bytes);
	}
	if (size > image->size)
		memset(image->bytes + image->size, 0, (size_t)(size - image->size));
	image->size = size;
}

static void copy(struct image *to, const struct image *from)
{
	to->size = 0;
	resize(to, from->size);
	if (from->size)
		memcpy(to->bytes, from->bytes, (size_t)from->size);
	to->exists = from->exists;
}

struct record {
	char *bytes;
	size_t length;
};

static uint64_t random_state;

static unsigned pick(unsigned n)
{
	random_state = random_state * 6364136223846793005u + 1442695040888963407u;
	return (unsigned)((random_state >> 33) % n);
}

enum part { NOTHING, SOME, ALL };

/* Applies an entry of the record to a file, in full or in part. */
static void play(struct image *image, const struct faults_entry *entry, enum part part)
{
	const uint8_t *bytes = (const uint8_t *)(entry + 1);
	if (part == NOTHING)
		return;
	switch ((enum faults_event)entry->event) {
	case FAULTS_OPEN:
	case FAULTS_UNLINK:
		// the content of the file is synced separately, before or after
		image->exists = entry->event == FAULTS_OPEN;
		break;
	case FAULTS_TRUNCATE:
		resize(image, entry->offset);
		break;
	case FAULTS_WRITE:
		if (entry->offset + entry->size > image->size)
			resize(image, entry->offset + entry->size);
		for (int64_t k = 0; k < entry->size; k += SECTOR)
			if (part == ALL || pick(2))
				memcpy(image->bytes + entry->offset + k, bytes + k,
				       (size_t)(entry->size - k < SECTOR ? entry->size - k : SECTOR));
		break;
	case FAULTS_SYNC:
	case FAULTS_TOLD:
		break;
	}
}

/* Entries that are not synced at the current position of the record. */
struct pending {
	const struct faults_entry **entries;
	int n, capacity;
};

static void pend(struct pending *pending, const struct faults_entry *entry)
{
	if (pending->n == pending->capacity) {
		pending->capacity = 2 * pending->capacity + 64;
		pending->entries = realloc(pending->entries, (size_t)pending->capacity * sizeof *pending->entries);
		assert_non_null(pending->entries);
	}
	pending->entries[pending->n++] = entry;
}

/* A creation or removal is on the disk when the folder is synced, a write or change of size when its file is. */
static bool settled_by(const struct faults_entry *entry, const struct faults_entry *sync)
{
	bool of_folder = entry->event == FAULTS_OPEN || entry->event == FAULTS_UNLINK;
	return sync->file == (of_folder ? FAULTS_FOLDER : entry->file);
}

static void settle(struct image images[FAULTS_FILES], struct pending *pending,
                   const struct faults_entry *sync)
{
	int n = 0;
	for (int i = 0; i < pending->n; i++)
		if (settled_by(pending->entries[i], sync))
			play(&images[pending->entries[i]->file], pending->entries[i], ALL);
		else
			pending->entries[n++] = pending->entries[i];
	pending->n = n;
}

static void write_file(const char *path, const struct image *image)
{
	unlink(path);
	if (!image->exists)
		return;
	int file = open(path, O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC, 0600);
	assert_true(file >= 0);
	assert_int_equal(write(file, image->bytes, (size_t)image->size), image->size);
	close(file);
}

/* Whether study `id` has document `name` with these bytes (NULL: any); false also if the database cannot be read. */
static bool has(sqlite3_stmt *question, int64_t id, const char *name, const char *bytes, size_t length)
{
	sqlite3_bind_int64(question, 1, id);
	sqlite3_bind_text(question, 2, name, -1, SQLITE_STATIC);
	bool there = sqlite3_step(question) == SQLITE_ROW &&
	             (!bytes || ((size_t)sqlite3_column_bytes(question, 0) == length &&
	                         !memcmp(sqlite3_column_blob(question, 0), bytes, length)));
	sqlite3_reset(question);
	return there;
}

struct damage {
	int cuts, corrupt, lost; /* all cuts; cuts with an inconsistent database; cuts that lost answered data */
	int opened;              /* databases opened by the server's code */
	int syncs, checkpoints;  /* syncs in the record: of any file; of the database file */
};

/* Runs in all blocks; -1: no block, or the table of studies has another sum. */
static int64_t blocks_runs(sqlite3 *db)
{
	sqlite3_stmt *sum = NULL;
	int64_t runs = -1;
	if (sqlite3_prepare_v2(db,
	                       "SELECT coalesce(sum(runs), 0) FROM block "
	                       "GROUP BY 1 = 1 HAVING sum(runs) = (SELECT sum(runs_done) FROM study)",
	                       -1, &sum, NULL) == SQLITE_OK &&
	    sqlite3_step(sum) == SQLITE_ROW)
		runs = sqlite3_column_int64(sum, 0);
	sqlite3_finalize(sum);
	return runs;
}

/* Opens the database that a cut left and compares it with the answers before the cut. */
static void judge(const char *path, const bool known[N_TOLD], struct damage *damage)
{
	sqlite3 *db;
	sqlite3_stmt *check = NULL, *document = NULL;
	int lost = 0;
	damage->cuts++;
	sqlite3_open(path, &db);
	bool whole = sqlite3_prepare_v2(db, "PRAGMA integrity_check", -1, &check, NULL) == SQLITE_OK &&
	             sqlite3_step(check) == SQLITE_ROW &&
	             !strcmp((const char *)sqlite3_column_text(check, 0), "ok");
	sqlite3_finalize(check);
	sqlite3_prepare_v2(
	    db, "SELECT content FROM document JOIN study ON study = id WHERE id = ?1 AND document.name = ?2", -1,
	    &document, NULL);
	for (int i = 0; i < STUDIES; i++) {
		int64_t id = (int64_t)strtoull(answered[i].id, NULL, 16);
		lost += known[i] && !(document && has(document, id, "request", NULL, 0));
		lost += known[STUDIES + i] &&
		        !(document && has(document, id, "result", answered[i].bytes, answered[i].length));
	}
	sqlite3_finalize(document);
	for (int i = 0; i < LOOKS; i++)
		lost += known[2 * STUDIES + i] && blocks_runs(db) < runs_answered[i];
	sqlite3_close(db);
	damage->corrupt += !whole;
	damage->lost += lost > 0;
	if (whole && !lost && damage->cuts % STORE_EVERY == 0) {
		struct store *store = store_open(path);
		assert_non_null(store);
		store_close(store);
		damage->opened++;
	}
}

/* Cuts the power at n random positions of the record and judges each database. */
static struct damage cut(const struct record *record, int n)
{
	struct damage damage = {0};
	struct image images[FAULTS_FILES] = {0}, after = {0};
	struct pending pending = {0};
	bool known[N_TOLD] = {0};
	char folder[64], path[96], file[112], removal[96];
	static const char *const ends[] = {"", "-wal", "-journal"};
	snprintf(folder, sizeof folder, "%s/pound-test-XXXXXX",
	         access("/dev/shm", W_OK) == 0 ? "/dev/shm" : "/tmp");
	assert_non_null(mkdtemp(folder));
	snprintf(path, sizeof path, "%s/cut.db", folder);
	int entries = 0, entry_number = 0;
	for (size_t at = 0; at < record->length; entries++)
		at += sizeof(struct faults_entry) + (size_t)((const struct faults_entry *)(record->bytes + at))->size;
	for (size_t at = 0; at < record->length; entry_number++) {
		const struct faults_entry *entry = (const struct faults_entry *)(record->bytes + at);
		at += sizeof *entry + (size_t)entry->size;
		if (entry->event == FAULTS_TOLD)
			known[entry->offset] = true;
		else if (entry->event == FAULTS_SYNC) {
			settle(images, &pending, entry);
			damage.syncs++;
			damage.checkpoints += entry->file == FAULTS_DATABASE;
		} else
			pend(&pending, entry);
		// number of cuts at this entry when n cuts are spread at random over all entries
		for (int left = n - damage.cuts; left > 0 && (int)pick((unsigned)(entries - entry_number)) < left;
		     left--) {
			for (int f = 0; f < FAULTS_FOLDER; f++) {
				copy(&after, &images[f]);
				for (int i = 0; i < pending.n; i++)
					if (pending.entries[i]->file == f)
						play(&after, pending.entries[i], (enum part)pick(3));
				snprintf(file, sizeof file, "%s%s", path, ends[f]);
				write_file(file, &after);
			}
			judge(path, known, &damage);
		}
	}
	for (int f = 0; f < FAULTS_FILES; f++)
		free(images[f].bytes);
	free(after.bytes);
	free(pending.entries);
	snprintf(removal, sizeof removal, "rm -r %s", folder);
	assert_int_equal(system(removal), 0);
	return damage;
}

/* Runs studies on a server; returns the record of its disk. */
static struct record recorded(bool normal)
{
	struct service *service = service_new();
	struct faults *faults = faults_new(service->directory);
	struct record record;
	char path[128];
	faults->records = true;
	faults->normal = normal;
	service_start(service, 2);
	for (int i = 0; i < STUDIES; i++) {
		char *study = service_study(2, 1, i);
		size_t n = strlen(study);
		study = realloc(study, n + BLANKS + 1);
		assert_non_null(study);
		memset(study + n, ' ', BLANKS);
		study[n + BLANKS] = '\0';
		service_submit(service, study, answered[i].id);
		faults_answered(faults, i);
		free(study);
		if (i % 4 != 0)
			continue;
		assert_true(service_wait(service, answered[i].id, "succeeded", 0));
		struct answer result = service_get(service, "/v1/studies/%s/results", answered[i].id);
		assert_int_equal(result.status, 200);
		faults_answered(faults, STUDIES + i);
		free(answered[i].bytes);
		answered[i].bytes = result.body;
		answered[i].length = result.length;
	}
	service_kill(service);
	snprintf(path, sizeof path, "%s/record", service->directory);
	record.bytes = program_file(path, &record.length);
	assert_non_null(record.bytes);
	faults_free(faults);
	service_free(service);
	return record;
}

/* Likewise on a slow disk, so that a commit has many blocks, while a client requests the progress. */
static struct record blocks_recorded(double *blocks_a_commit)
{
	enum { ROWS = 6 * SERVICE_ROWS, SIGNALS = 5 };
	struct service *service = service_new();
	struct faults *faults = faults_new(service->directory);
	struct record record;
	char path[128], id[17], *study = service_study(ROWS, SIGNALS, 1);
	faults->records = true;
	faults->sync_ms = SYNC_MS;
	service_start(service, 2);
	service_submit(service, study, id);
	int looks = 0;
	for (int64_t runs = 0, before = 0; looks < LOOKS && runs < (int64_t)ROWS * SIGNALS * 5; before = runs) {
		struct answer answer = service_get(service, "/v1/studies/%s", id);
		struct reading *status = answer_read(&answer);
		runs = (int64_t)reading_number(status, "/runs_done");
		reading_close(status);
		answer_free(&answer);
		if (runs > before) {
			runs_answered[looks] = runs;
			faults_answered(faults, 2 * STUDIES + looks++);
		}
		usleep(1000);
	}
	service_kill(service);
	*blocks_a_commit = (double)service_number(service, "SELECT count(*) FROM block") / looks;
	snprintf(path, sizeof path, "%s/record", service->directory);
	record.bytes = program_file(path, &record.length);
	assert_non_null(record.bytes);
	faults_free(faults);
	service_free(service);
	free(study);
	return record;
}

static void a_cut_loses_no_block_of_a_commit_that_returned(void **state)
{
	double blocks_a_commit;
	struct record record = blocks_recorded(&blocks_a_commit);
	(void)state;
	random_state = 1;
	struct damage damage = cut(&record, check_count(1000, 10000));
	check_report("power cuts, %.1f blocks a commit: %d in a record of %d syncs; databases damaged %d, blocks "
	             "lost in %d; %d "
	             "opened by the server",
	             blocks_a_commit, damage.cuts, damage.syncs, damage.corrupt, damage.lost, damage.opened);
	assert_true(blocks_a_commit > 4);
	assert_int_equal(damage.corrupt, 0);
	assert_int_equal(damage.lost, 0);
	assert_true(damage.opened > 0);
	free(record.bytes);
}

static struct damage cut_of(bool normal, int n)
{
	struct record record = recorded(normal);
	random_state = 1;
	struct damage damage = cut(&record, n);
	check_report(
	    "power cuts, synchronous=%s: %d in a record of %d syncs (%d of the database); databases damaged %d, "
	    "studies or results lost in %d; %d opened by the server",
	    normal ? "NORMAL" : "FULL", damage.cuts, damage.syncs, damage.checkpoints, damage.corrupt,
	    damage.lost, damage.opened);
	assert_int_equal(damage.cuts, n);
	free(record.bytes);
	return damage;
}

static void what_a_client_was_answered_is_on_the_disk_whatever_the_moment_of_a_power_cut(void **state)
{
	struct damage damage = cut_of(false, check_count(1000, 10000));
	(void)state;
	assert_int_equal(damage.corrupt, 0);
	assert_int_equal(damage.lost, 0);
	assert_true(damage.opened > 0);
	// the WAL was copied into the database, so cuts during that copy are tested
	assert_true(damage.checkpoints > 2);
}

static void the_same_cuts_lose_studies_when_the_disk_is_not_synced_at_every_commit(void **state)
{
	enum { N = 100 };
	(void)state;
	assert_true(cut_of(true, N).lost > N / 4);
}

CHECK_MAIN(cmocka_unit_test(a_cut_loses_no_block_of_a_commit_that_returned),
           cmocka_unit_test(what_a_client_was_answered_is_on_the_disk_whatever_the_moment_of_a_power_cut),
           cmocka_unit_test(the_same_cuts_lose_studies_when_the_disk_is_not_synced_at_every_commit))
