/* service.h - a real poundd in a child process, on a free port, with a database in a directory of its own.
 *
 *   struct service *service = service_new();
 *   service_start(service, 2);
 *   struct answer created = service_post(service, study);
 *   ...
 *   service_stop(service);
 *   service_free(service);
 *
 * Errors in these functions fail the test. */
#ifndef SERVICE_H
#define SERVICE_H

#include "tests/support/check.h"

#include <stdint.h>
#include <sys/types.h>

/* Rows of a study that runs long enough to be queried, cancelled or killed meanwhile; whether the memory of a process can be
 * measured: the sanitizers have their own allocator. */
#if defined __SANITIZE_ADDRESS__ || defined __SANITIZE_THREAD__
enum { SERVICE_ROWS = 200, SERVICE_MEMORY = 0 };
#else
enum { SERVICE_ROWS = 900, SERVICE_MEMORY = 1 };
#endif

struct service {
	pid_t pid; /* 0: not running */
	int port;
	char directory[64], database[96], log[96];
};

struct service *service_new(void); /* a directory, no server yet */
/* one that runs with settings of its environment, such as {{"POUNDD_QUEUE_MAX", "3"}, {NULL}} */
struct service *service_with(const char *const settings[][2], int n_workers);
void service_free(struct service *service);                 /* kills what runs, removes the directory */
void service_start(struct service *service, int n_workers); /* returns when it listens */
int service_try(struct service *service, int n_workers);    /* 0: it listens; else its exit status */
int service_run(const struct service *service,
                int n_workers);             /* another one: its exit status, when it ends */
void service_stop(struct service *service); /* SIGTERM; it must exit with 0 */
void service_kill(struct service *service); /* SIGKILL */

struct answer {
	int status;
	char *body; /* (length) bytes and a zero */
	size_t length;
	char location[64], type[64], allow[64], etag[64], retry_after[16];
};

struct ask {
	const char *method, *path;
	const char *headers[3];
	const char *body;
	size_t length;
	bool may_fail; /* status 0: no answer */
};

struct answer service_ask(const struct service *service, const struct ask *ask);
struct answer service_get(const struct service *service, const char *format, ...)
    __attribute__((format(printf, 2, 3)));
struct answer service_post(const struct service *service, const char *study);
/* with an Idempotency-Key, NULL: none; status 0: no answer */
struct answer service_post_keyed(const struct service *service, const char *study, const char *key);
void answer_free(struct answer *answer);

struct reading *answer_read(const struct answer *answer); /* its JSON, for reading_close */

/* Posts a study that must be accepted; the id is 16 characters. */
void service_submit(const struct service *service, const char *study, char id[17]);
/* Waits until a study has a status, or is finished, or has runs_done >= runs; returns whether it has that status. */
bool service_wait(const struct service *service, const char *id, const char *status, double runs);

/* A number out of the server's database. */
int64_t service_number(const struct service *service, const char *sql);
/* Changes the database of a server that does not run. */
void service_change(const struct service *service, const char *sql);
double service_resident_mb(const struct service *service); /* [MB = 1e6 bytes] */
void service_erase(const struct service *service);         /* its database, when it is stopped */
/* A text out of the server's database, for free. */
char *service_text(const struct service *service, const char *sql);

/* A sensitivity study of `rows` rows and `signals` signals of 2 s each, with 3 inputs: 5 x rows x signals runs, which
 * the engine cuts into blocks of about 750.  For free. */
char *service_study(int rows, int signals, int seed);

/* A finished study whose samples, histories of so many signals, take a fifth of a second and 3.6 MB for each to make. */
void service_histories(const struct service *service, int signals, char id[17]);

/* A result with its timing taken out; in place. */
char *service_timeless(char *result);

/* All output of a study, except its timing. */
struct service_bytes {
	char *result, *samples;
};

struct service_bytes service_bytes(const struct service *service,
                                   const char *id); /* of one that has succeeded */
/* The result of a study in a server of its own, with so many workers and nothing in between. */
struct service_bytes service_uninterrupted(const char *study, int n_workers);
/* Fails the test unless they are the same; frees the first. */
void service_bytes_compare(struct service_bytes *bytes, const struct service_bytes *reference);

int service_setup(void **state);    /* a service that runs with two workers */
int service_teardown(void **state); /* stops it */

#endif
