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
	STORE_CORRUPT,        /* found, but not what was written */
	STORE_FAILED,         /* the disk or the memory; logged */
	STORE_REPEATED,       /* an earlier study has that key, and the same bytes */
	STORE_CLASH,          /* an earlier study has that key, and other bytes */
	STORE_FULL,           /* the disk has no room for new studies */
	STORE_REPLACED,       /* the database file is another: what was changed is lost; logged */
	STORE_CROWDED,        /* as many studies are queued as there may be */
	STORE_CLIENT_CROWDED, /* as many of its client are as there may be */
	STORE_UNRECORDED,     /* a record that it names is not there any more */
};

struct store;

enum { STORE_CLIENT_SIZE = 32 /* [bytes] of a token's name */ };

/* a new one */
struct store_study {
	const char *kind, *name; /* name: NULL if none */
	int64_t runs;
	double cpu_s;       /* estimated [s] */
	int64_t memory;     /* estimated, while it runs [bytes] */
	const char *hash;   /* of its meaning, hex */
	const char *key;    /* Idempotency-Key it was submitted with, NULL: none */
	const char *client; /* name of the token it was submitted with, NULL: there are none */
	int64_t queue_max;  /* studies that may be queued, 0: any number */
	int64_t own_max;    /* of them its client's, 0: any number */
	int n_records;
	const char *const *records; /* that it names  (n_records) SHA-256, hexadecimal */
};
typedef void store_study_reader(void *to,
                                const struct study_status *study); /* of texts that end with the call */

struct store *store_open(const char *path); /* NULL: refused or failed, and logged */
void store_stop(struct store *store, int wait_ms);
void store_close(struct store *store);
enum store_status store_ready(struct store *store); /* FULL, FAILED: it takes no study now */
/* descriptor of a file beside the database that has no name and may hold n bytes; -1: there is no room */
int store_spool(const struct store *store, size_t n);

enum store_status store_submit(struct store *store, const struct store_study *study, const char *request,
                               size_t length, int64_t *id);
enum store_status store_study(struct store *store, int64_t id, store_study_reader *reader, void *to);
/* which studies are listed, newest first */
struct store_filter {
	const char *status, *name,
	    *hash;      /* of this status, with this text in the name, of this meaning; NULL: any */
	int64_t before; /* only ids below; INT64_MAX: all */
	int limit;      /* at most so many */
};
enum store_status store_list(struct store *store, const struct store_filter *filter,
                             store_study_reader *reader, void *to);
enum store_status store_document(struct store *store, int64_t id, const char *name, char **content,
                                 size_t *length); /* on the heap, for the caller to free */
enum store_status store_length(struct store *store, int64_t id, const char *name, size_t *length);
/* its first bytes, zero-terminated, fewer than size; what they say is not checked against its digest */
enum store_status store_start(struct store *store, int64_t id, const char *name, char *into, size_t size);
/* copies one by pieces; STORE_FAILED: the file does not take it, or the database does not give it */
enum store_status store_document_to(struct store *store, int64_t id, const char *name, int file);
enum store_status store_count(struct store *store, const char *status, int64_t *n);
/* grows with every change of a study (0: of any); studies may share one */
unsigned store_changes(struct store *store, int64_t id);
enum store_status store_cancel(struct store *store, int64_t id); /* NONE: neither queued nor running */
enum store_status store_delete(struct store *store, int64_t id);
/* Deletes one study that ended more than `days` ago, or the blocks of one that ended more than `days_blocks` ago; 0: never.
 * false: there is none. */
bool store_expire(struct store *store, int days, int days_blocks);

/* A file of a recorded ground motion, by its SHA-256 (hexadecimal): REPEATED if it was there; and its bytes, a zero behind them, on
 * the heap. */
enum store_status store_put_record(struct store *store, const char *sha256, const char *content,
                                   size_t length);
enum store_status store_record(struct store *store, const char *sha256, char **content, size_t *length);

struct store_claimed {
	int64_t id, memory;             /* estimated [bytes] */
	double cpu_s;                   /* estimated [s] 0: not known */
	char client[STORE_CLIENT_SIZE]; /* name of its token; "": none */
};

/* The oldest queued study becomes running, if there is one of another token than `avoided` that one; STORE_NONE when none is
 * queued, or it takes more memory [bytes] than that. */
enum store_status store_claim(struct store *store, int64_t memory_most, const char *avoided,
                              struct store_claimed *claimed);
void store_blame(const struct store *store, int64_t id); /* the server crashes with it; signal-safe */

struct store_block {
	int64_t study;
	int number;
	int64_t runs;  /* pounding runs in it */
	double cpu_s;  /* [s] */
	double wall_s; /* since its study started, without the time between sessions [s] */
	int n;
	const double *values; /* (n) */
	bool kept;            /* by store_keep: its study was still running */
};
typedef bool store_block_reader(void *to, const struct store_block *block); /* false: no more are wanted */

/* keeps finished blocks in one commit, those whose studies still run */
enum store_status store_keep(struct store *store, struct store_block *const blocks[], int n);
/* the stored blocks of this engine version; CORRUPT: others or damaged ones were left out */
enum store_status store_blocks(struct store *store, int64_t id, store_block_reader *reader, void *to);
enum store_status store_prune(struct store *store, int64_t id); /* deletes what is left out */

enum store_status store_spent(struct store *store, int64_t id,
                              double cpu_s); /* more than its blocks took; NONE: it is not running any more */
/* A running study ends, once: with a result, or with the reason why it failed (the other is NULL). */
enum store_status store_finish(struct store *store, int64_t id, const char *result, size_t length,
                               const char *error, double cpu_s);

#endif
