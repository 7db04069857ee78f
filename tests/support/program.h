/* program.h - runs the built programs as a user does: with arguments and a standard input, and checks their output
 * and exit status.  POUND_BUILD is the folder of the programs. */
#ifndef PROGRAM_H
#define PROGRAM_H

#include <stdbool.h>
#include <stddef.h>
#include <sys/types.h>

enum { ARGUMENTS_MAX = 16 };

struct program_outcome {
	int status; /* exit status; 128 + signal when a signal ended it */
	char *out;  /* (n_out) and a NUL */
	size_t n_out;
	char *err; /* (n_err) and a NUL */
	size_t n_err;
};

/* Runs a program to its end.  `arguments` starts with its name: one of POUND_BUILD, or one of PATH when it has no
 * such file; `input` is its standard input, NULL: empty. */
struct program_outcome program_run(const char *const arguments[], const char *input);

/* Fails the test, showing what the program printed, unless it ended with this status. */
void program_expect(const struct program_outcome *outcome, int status);
void program_free(struct program_outcome *outcome);

/* Starts a program and leaves it running; its stdout and stderr go to the files named, its stdin is empty. */
pid_t program_start(const char *const arguments[], const char *out, const char *err);

/* Waits for its end: exit status, or 128 + signal. */
int program_end(pid_t pid);

/* What a program, which must succeed, writes to a terminal of so many columns as its stderr; the caller frees it. */
char *program_drawn(const char *const arguments[], int columns);

/* A poundd of the test's own (service.h), its address in POUND_URL; service_teardown ends it. */
int program_setup(void **state);

/* Whole file with a NUL behind it; the caller frees it.  NULL: no such file. */
char *program_file(const char *path, size_t *n);

#endif
