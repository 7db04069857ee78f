/* faults.h - a poundd whose disk and memory fail as a test asks, and whose writes are recorded.
 *
 *   struct faults *faults = faults_new(service->directory);
 *   service_start(service, 2);               with tests/support/preload.c between the server and the C library
 *   faults->memory_fails_in = 17;            the 17th allocation from now gets nothing
 *   faults->write_fails = 10;                1 % of the writes end with EIO
 *   faults_free(faults);                     the next server is sound
 *
 * The struct lies in a file that test and server share.  Only the database and its WAL are disturbed and recorded. */
#ifndef FAULTS_H
#define FAULTS_H

#include <stdatomic.h>
#include <stdbool.h>
#include <stdint.h>

struct faults {
	char folder[128]; /* of the database */
	// each counts its calls down, and the one that reaches 0 fails; 0: none does
	atomic_long disk_fails_in;   /* a write, sync or change of size: EIO */
	atomic_long disk_kills_in;   /* likewise, but the process dies before it */
	atomic_long memory_fails_in; /* an allocation: NULL */
	// of 1000 calls so many fail
	atomic_int write_fails, sync_fails;
	// what happened
	atomic_long disk_calls, disk_failed, memory_calls, memory_failed;
	atomic_long memory_live;  /* allocations not freed */
	atomic_long files_opened; /* any */
	atomic_bool records;      /* writes go to FOLDER/record as well */
	atomic_bool normal;       /* connections are changed to synchronous=NORMAL after the server has looked */
	atomic_int sync_ms;       /* a sync takes so much longer [ms] */
	atomic_long clock_s;      /* the wall clock is so far off [s] */
};

struct faults *faults_new(const char *folder);
void faults_free(struct faults *faults);

/* The record of what happened to the files, in the order in which it did. */
enum faults_event {
	FAULTS_OPEN,     /* a file that was not there is created */
	FAULTS_WRITE,    /* `size` bytes at `offset` */
	FAULTS_TRUNCATE, /* to `offset` bytes */
	FAULTS_SYNC,     /* what was written before is on the disk */
	FAULTS_UNLINK,
	FAULTS_TOLD, /* the test's own: the client knows it now, by number `offset` */
};
enum faults_file { FAULTS_DATABASE, FAULTS_WAL, FAULTS_JOURNAL, FAULTS_FOLDER, FAULTS_FILES };

struct __attribute__((packed)) faults_entry { // one after the other in a file
	int32_t event, file;
	int64_t offset, size; /* the bytes of a write follow */
};

/* Adds to the record what a client was answered. */
void faults_answered(const struct faults *faults, int64_t number);

#define FAULTS_VARIABLE "POUND_FAULTS" /* the file that is shared */

#endif
