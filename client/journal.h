/* journal.h - the finished runs of an evaluation in a file, one line per run, so that a killed command can be resumed.
 *
 * A line is written by one call as soon as its run has ended; a line cut off by a crash is dropped. */
#ifndef JOURNAL_H
#define JOURNAL_H

#include "client/command.h"

struct journal;

/* A run in the journal: `values` are its outputs  (n); all NAN: it failed. */
typedef void journal_reader(void *to, long run, const double *values);

/* Opens or creates the file and reads its runs.  `head` is its first line, which identifies the evaluation; `n` outputs.
 * NULL: reported on stderr, with the outcome; with path NULL, the journal accepts all runs and stores none. */
struct journal *journal_open(const char *path, const char *head, int n, journal_reader *reader, void *to,
                             enum outcome *outcome);
bool journal_add(struct journal *journal, long run, const double *values); /* false: reported on stderr */
void journal_close(struct journal *journal);

#endif
