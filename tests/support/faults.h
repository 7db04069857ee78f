/* faults.h - a poundd with injected faults of disk and memory, and with recorded writes.
 *
 *   struct faults *faults = faults_new(service->directory);
 *   service_start(service, 2);               with tests/support/preload.c preloaded before the C library
 *   faults->memory_fails_in = 17;            the 17th allocation from now fails
 *   faults->write_fails = 10;                1 % of the writes end with EIO
 *   faults_free(faults);                     the next server has no faults
 *
 * The struct is in a file that test and server map.  Only accesses to the database and its WAL fail and are recorded. */
#ifndef FAULTS_H
#define FAULTS_H

#include <stdatomic.h>
#include <stdbool.h>
#include <stdint.h>

struct faults {
	char folder[128]; /* of the database */
	// each is decremented per call, and the call that reaches 0 fails; 0: no call fails
	atomic_long disk_fails_in;   /* a write, sync or change of size: EIO */
	atomic_long disk_kills_in;   /* likewise, but the process dies before it */
	atomic_long memory_fails_in; /* an allocation: NULL */
	// failing calls per 1000
	atomic_int write_fails, sync_fails;
	// what happened
	atomic_long disk_calls, disk_failed, memory_calls, memory_failed;
	atomic_long memory_live;  /* allocations not freed */
	atomic_long files_opened; /* any */
	atomic_bool records;      /* writes go to FOLDER/record as well */
	atomic_bool
	    normal; /* connections are changed to synchronous=NORMAL after the server has checked the setting */
	atomic_int sync_ms;  /* added to the duration of a sync [ms] */
	atomic_long clock_s; /* offset of the wall clock [s] */
};

struct faults *faults_new(const char *folder);
void faults_free(struct faults *faults);

/* The record of operations on the files, in order. */
enum faults_event {
	FAULTS_OPEN,     /* a file that was not there is created */
	FAULTS_WRITE,    /* `size` bytes at `offset` */
	FAULTS_TRUNCATE, /* to `offset` bytes */
	FAULTS_SYNC,     /* earlier writes are on the disk */
	FAULTS_UNLINK,
	FAULTS_TOLD, /* added by the test: the client has received answer number `offset` */
};
enum faults_file { FAULTS_DATABASE, FAULTS_WAL, FAULTS_JOURNAL, FAULTS_FOLDER, FAULTS_FILES };

struct __attribute__((packed)) faults_entry { // one after the other in a file
	int32_t event, file;
	int64_t offset, size; /* the bytes of a write follow */
};

/* Adds to the record that a client has received an answer. */
void faults_answered(const struct faults *faults, int64_t number);

#define FAULTS_VARIABLE "POUND_FAULTS" /* environment variable: the shared file */

#endif
