/* journal.c - lines `run,value,...` after a first line that identifies the evaluation. */
#include "client/journal.h"

#include "schema/json/json_writer.h"

#include <errno.h>
#include <fcntl.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/file.h>
#include <unistd.h>

struct journal {
	const char *path;
	int fd;         /* -1: no journal is kept */
	int n;          /* outputs of a run */
	double *values; /* (n) */
};

/* Reads a line `run,value,...`.  false: the line has another form. */
static bool line_read(const struct journal *journal, char *line, long *run)
{
	char *end;
	*run = strtol(line, &end, 10);
	bool is = end > line && *run >= 0;
	for (int o = 0; is && o < journal->n; o++) {
		is = *end == ',';
		line = end + is;
		journal->values[o] = strncmp(line, "null", 4) == 0 ? NAN : strtod(line, &end);
		end = isnan(journal->values[o]) ? line + 4 : end;
	}
	return is && *end == '\0';
}

/* Reads all complete lines, and truncates an incomplete last line.  false: the journal of another evaluation, or damaged. */
static bool lines_read(struct journal *journal, const char *head, journal_reader *reader, void *to)
{
	char *line = NULL;
	size_t room = 0;
	ssize_t n;
	off_t whole = 0;
	long run, number = 0;
	FILE *file = command_sure(fdopen(dup(journal->fd), "r"));
	bool same = true;
	while (same && (n = getline(&line, &room, file)) > 0 && line[n - 1] == '\n') {
		line[n - 1] = '\0';
		if (number++ == 0) {
			same = strcmp(line, head) == 0;
			if (!same)
				command_complain("'%s' is the journal of another evaluation:\n  has    %s\n  wanted %s",
				                 journal->path, line, head);
		} else if (line_read(journal, line, &run))
			reader(to, run, journal->values);
		else {
			same = false;
			command_complain("'%s' line %ld: is not a run with %d outputs", journal->path, number,
			                 journal->n);
		}
		whole += n;
	}
	free(line);
	fclose(file);
	return same && ftruncate(journal->fd, whole) == 0 && lseek(journal->fd, 0, SEEK_END) >= 0;
}

static bool put(struct journal *journal, const char *text, size_t n)
{
	const bool whole = write(journal->fd, text, n) == (ssize_t)n;
	if (!whole)
		command_complain("cannot write '%s': %s", journal->path, strerror(errno));
	return whole;
}

struct journal *journal_open(const char *path, const char *head, int n, journal_reader *reader, void *to,
                             enum outcome *outcome)
{
	struct journal *journal = command_sure(calloc(1, sizeof *journal));
	*journal = (struct journal){
	    .path = path, .fd = -1, .n = n, .values = command_sure(calloc((size_t)n, sizeof(double)))};
	if (!path)
		return journal;
	*outcome = OUTCOME_FAILED;
	journal->fd = open(path, O_RDWR | O_CREAT | O_APPEND | O_CLOEXEC, 0666);
	if (journal->fd < 0)
		command_complain("cannot open '%s': %s", path, strerror(errno));
	else if (flock(journal->fd, LOCK_EX | LOCK_NB) != 0)
		command_complain("'%s' is used by another evaluation", path);
	else if (!lines_read(journal, head, reader, to))
		*outcome = OUTCOME_USAGE;
	else {
		char *first = command_text("%s\n", head);
		bool begun = lseek(journal->fd, 0, SEEK_END) > 0 || put(journal, first, strlen(first));
		free(first);
		if (begun)
			return journal;
	}
	journal_close(journal);
	return NULL;
}

bool journal_add(struct journal *journal, long run, const double *values)
{
	struct writer w;
	char digits[WRITER_NUMBER_SIZE];
	size_t n;
	if (journal->fd < 0)
		return true;
	writer_init(&w);
	writer_raw(&w, digits, (size_t)snprintf(digits, sizeof digits, "%ld", run));
	for (int o = 0; o < journal->n; o++) {
		writer_raw(&w, ",", 1);
		writer_raw(&w, digits, (size_t)writer_digits(values[o], digits));
	}
	writer_raw(&w, "\n", 1);
	char *line = command_sure(writer_take(&w, &n));
	const bool kept = put(journal, line, n);
	free(line);
	return kept;
}

void journal_close(struct journal *journal)
{
	if (journal->fd >= 0)
		close(journal->fd);
	free(journal->values);
	free(journal);
}
