/* journal.h - what was evaluated already, in a file: a line for each run, so that a command that was killed goes on.
 *
 * A line is written with one call as soon as its run has ended; a line that was cut by a crash is dropped. */
#ifndef JOURNAL_H
#define JOURNAL_H

#include "client/command.h"

struct journal;

/* A run in the journal: `values` are its outputs  (n), NAN each: it failed. */
typedef void journal_reader(void *to, long run, const double *values);

/* Opens or makes the file and reads what is in it.  `head` is its first line, which says what was evaluated; `n` outputs.
 * NULL: complained about, with the outcome; a path NULL is no journal, which takes everything and keeps nothing. */
struct journal *journal_open(const char *path, const char *head, int n, journal_reader *reader, void *to,
                             enum outcome *outcome);
bool journal_add(struct journal *journal, long run, const double *values); /* false: complained about */
void journal_close(struct journal *journal);

#endif
