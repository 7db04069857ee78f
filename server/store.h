/* store.h - studies on disk: an SQLite database in WAL with synchronous=FULL, one writing connection.
 *
 * What a function reports as done is on the disk.  Times are milliseconds since 1970.  Any thread. */
#ifndef STORE_H
#define STORE_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "schema/study/study_status.h"

enum store_status {
	STORE_OK,
	STORE_NONE,           /* no such study or document, or the study is not in the state asked for */
	STORE_CORRUPT,        /* found, but damaged: its digest differs */
	STORE_FAILED,         /* disk error or out of memory; logged */
	STORE_REPEATED,       /* an earlier study has that key, and the same bytes */
	STORE_CLASH,          /* an earlier study has that key, and other bytes */
	STORE_FULL,           /* the disk has no room for new studies */
	STORE_REPLACED,       /* the database file was removed or replaced: the change is lost; logged */
	STORE_CROWDED,        /* the queue is full */
	STORE_CLIENT_CROWDED, /* the queue has no room for more studies of this client */
	STORE_UNRECORDED,     /* a record that the study names is no longer stored */
};

struct store;

enum { STORE_CLIENT_SIZE = 32 /* [bytes] of a token's name */ };

/* a new study */
struct store_study {
	const char *kind, *name; /* name: NULL if none */
	int64_t runs;
	double cpu_s;       /* estimated [s] */
	int64_t memory;     /* estimated, while it runs [bytes] */
	const char *hash;   /* of its meaning (study_hash), hexadecimal */
	const char *key;    /* Idempotency-Key it was submitted with, NULL: none */
	const char *client; /* name of the token it was submitted with, NULL: none */
	int64_t queue_max;  /* limit of queued studies, 0: none */
	int64_t own_max;    /* limit of queued studies of its client, 0: none */
	int n_records;
	const char *const *records; /* (n_records) SHA-256 of the records it names, hexadecimal */
};
typedef void store_study_reader(void *to,
                                const struct study_status *study); /* the texts are valid during the call */

struct store *store_open(const char *path); /* NULL: refused or failed, and logged */
void store_stop(struct store *store, int wait_ms);
void store_close(struct store *store);
enum store_status store_ready(struct store *store); /* FULL, REPLACED, FAILED: no new study can be stored */
/* descriptor of an unnamed temporary file beside the database for n bytes; -1: no space */
int store_spool(const struct store *store, size_t n);

enum store_status store_submit(struct store *store, const struct store_study *study, const char *request,
                               size_t length, int64_t *id);
enum store_status store_study(struct store *store, int64_t id, store_study_reader *reader, void *to);
/* which studies are listed, newest first */
struct store_filter {
	const char *status, *name, *hash; /* this status, this text in the name, this study_hash; NULL: any */
	int64_t before;                   /* only ids below; INT64_MAX: all */
	int limit;                        /* most studies to list */
};
enum store_status store_list(struct store *store, const struct store_filter *filter,
                             store_study_reader *reader, void *to);
enum store_status store_document(struct store *store, int64_t id, const char *name, char **content,
                                 size_t *length); /* on the heap, for the caller to free */
enum store_status store_length(struct store *store, int64_t id, const char *name, size_t *length);
/* the first bytes of a document, fewer than size, zero-terminated; not checked against its digest */
enum store_status store_start(struct store *store, int64_t id, const char *name, char *into, size_t size);
/* copies a document in chunks; STORE_FAILED: it could not be read from the database or written to the file */
enum store_status store_document_to(struct store *store, int64_t id, const char *name, int file);
enum store_status store_count(struct store *store, const char *status, int64_t *n);
/* a number that grows with every change of a study (0: of any study); studies may share a number */
unsigned store_changes(struct store *store, int64_t id);
enum store_status store_cancel(struct store *store, int64_t id); /* NONE: neither queued nor running */
enum store_status store_delete(struct store *store, int64_t id);
/* Deletes one study that ended more than `days` ago, or the blocks of one that ended more than `days_blocks` ago; 0: never.
 * false: nothing was to be deleted. */
bool store_expire(struct store *store, int days, int days_blocks);

/* Stores a file of a recorded ground motion by its SHA-256 (hexadecimal), REPEATED: it was stored already; and reads it: its bytes,
 * with a zero after them, on the heap. */
enum store_status store_put_record(struct store *store, const char *sha256, const char *content,
                                   size_t length);
enum store_status store_record(struct store *store, const char *sha256, char **content, size_t *length);

struct store_claimed {
	int64_t id, memory;             /* estimated [bytes] */
	double cpu_s;                   /* estimated [s], 0: not known */
	char client[STORE_CLIENT_SIZE]; /* name of its token; "": none */
};

/* The oldest queued study becomes running, or the oldest of a token other than `avoided` if there is one; STORE_NONE: no study is
 * queued, or this study needs more than memory_most [bytes]. */
enum store_status store_claim(struct store *store, int64_t memory_most, const char *avoided,
                              struct store_claimed *claimed);
void store_blame(const struct store *store, int64_t id); /* the server crashes in it; async-signal-safe */

struct store_block {
	int64_t study;
	int number;
	int64_t runs;  /* pounding runs in it */
	double cpu_s;  /* [s] */
	double wall_s; /* since its study started, without the time when no server ran [s] */
	int n;
	const double *values; /* (n) */
	bool kept;            /* set by store_keep: its study was still running */
};
typedef bool store_block_reader(void *to, const struct store_block *block); /* false: stop */

/* stores finished blocks in one transaction, except blocks of studies that no longer run */
enum store_status store_keep(struct store *store, struct store_block *const blocks[], int n);
/* the stored blocks of this engine version; CORRUPT: damaged blocks or blocks of another version were left out */
enum store_status store_blocks(struct store *store, int64_t id, store_block_reader *reader, void *to);
enum store_status store_prune(struct store *store, int64_t id); /* deletes the blocks left out */

enum store_status
store_spent(struct store *store, int64_t id,
            double cpu_s); /* in total, when more than its blocks took; NONE: it is not running */
/* A running study ends, once: with a result, or with the reason why it failed (the other is NULL). */
enum store_status store_finish(struct store *store, int64_t id, const char *result, size_t length,
                               const char *error, double cpu_s);

#endif
