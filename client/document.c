/* document.c - reads study documents and lists their errors. */
#include "client/document.h"

#include "client/table.h"
#include "schema/record/record.h"
#include "schema/result/result_design.h"
#include "schema/study/study_json.h"

#include <errno.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { HTTP_INVALID = 422 };

/* The path for messages; "standard input" for "-". */
const char *document_name(const char *path)
{
	return strcmp(path, "-") == 0 ? "standard input" : path;
}

/* Reads a whole file, or standard input for "-", and terminates it with 0; NULL: failed, see errno. */
static char *file_read(const char *path, size_t *length)
{
	FILE *file = strcmp(path, "-") == 0 ? stdin : fopen(path, "rb");
	char *text = NULL, part[65536];
	size_t n;
	FILE *all = file ? open_memstream(&text, length) : NULL;
	while (all && (n = fread(part, 1, sizeof part, file)) > 0)
		fwrite(part, 1, n, all);
	bool good = all && !ferror(file);
	int error = errno;
	if (all && fclose(all) != 0)
		good = false;
	if (file && file != stdin)
		fclose(file);
	if (!good) {
		free(text);
		errno = error;
		return NULL;
	}
	return text;
}

/* Reads a study document without checking its contents.
 *
 * Memory   allocates; NULL: cannot be read, reported on stderr
 */
char *document_read(const char *path, size_t *length)
{
	char *text = file_read(path, length);
	if (!text)
		command_complain("cannot read %s: %s", document_name(path), strerror(errno));
	return text;
}

/* Reads a file that a document names; a relative path starts at the folder of the document. */
static char *named_read(const void *with, const struct study_source *of, size_t *length,
                        char why[STUDY_WHY_SIZE])
{
	const char *document = with, *name = of->file, *end = strrchr(document, '/');
	char *path = NULL;
	if (!name) {
		snprintf(why, STUDY_WHY_SIZE, "is on a server: give the file, too");
		return NULL;
	}
	const int folder = *name == '/' || !end ? 0 : (int)(end - document) + 1;
	if (asprintf(&path, "%.*s%s%s", folder, document, !folder && *name == '-' ? "./" : "", name) < 0)
		path = NULL;
	char *text = path ? file_read(path, length) : NULL;
	if (!text)
		snprintf(why, STUDY_WHY_SIZE, "cannot be read: %s", strerror(path ? errno : ENOMEM));
	free(path);
	return text;
}

/* Reads a document.  If it names files of recorded ground motions, `copy` makes a document that others can read without them.
 *
 * Given    copy     -   study_inline or study_name_hashes
 * Returns  value    -   the document unchanged if it names no files
 *          study    -   for study_free; NULL: the document names no files, or is invalid
 */
static char *read_with_files(const char *path, size_t *length, enum outcome *outcome,
                             char *(*copy)(const struct study_document *, const struct pound_study *,
                                           size_t *),
                             struct pound_study **study)
{
	*outcome = OUTCOME_FAILED;
	*study = NULL;
	char *text = document_read(path, length);
	if (!text || !study_names_files(text, *length))
		return text;
	const struct study_files files = {.read = named_read, .with = path};
	const struct study_document document = {.text = text, .length = *length, .files = &files};
	struct problems *problems = malloc(sizeof *problems);
	*study = problems ? study_from_document(&document, problems) : NULL;
	char *copied = *study ? copy(&document, *study, length) : NULL;
	if (problems && !*study)
		*outcome = document_reject(path, problems);
	else if (!copied)
		command_complain("%s", pound_status_text(POUND_NOMEM));
	free(problems);
	free(text);
	return copied;
}

/* Reads a document, and replaces names of files of recorded ground motions by the samples in the files.
 *
 * Returns  value    -   the document unchanged if it names no files
 *          outcome  -   OUTCOME_USAGE: the document names files, and it or one of the files is invalid
 * Memory   allocates; NULL: failed, reported on stderr
 * Test     client_suite: a_suite_is_read_from_files_beside_the_study
 */
char *document_whole(const char *path, size_t *length, enum outcome *outcome)
{
	struct pound_study *study;
	char *whole = read_with_files(path, length, outcome, study_inline, &study);
	if (study)
		study_free(study);
	return whole;
}

/* Like document_whole, but adds the SHA-256 of each file to its name, for a server that stores the files.
 *
 * Returns  study    -   its files are read by document_file; for study_free; NULL: the document names no files
 * Test     client_suite: a_server_gives_the_same_bytes
 */
char *document_hashed(const char *path, size_t *length, enum outcome *outcome, struct pound_study **study)
{
	return read_with_files(path, length, outcome, study_name_hashes, study);
}

struct pound_study *document_study(const char *path, const char *text, size_t length, enum outcome *outcome)
{
	const struct study_files files = {.read = named_read, .with = path};
	struct problems problems;
	struct reading *reading = reading_open(text, length);
	struct pound_study *study =
	    study_from_document(&(struct study_document){.text = text,
	                                                 .length = length,
	                                                 .files = &files,
	                                                 .design = reading && !reading_has(reading, "/scene")},
	                        &problems);
	reading_close(reading);
	*outcome = study ? OUTCOME_OK : document_reject(path, &problems);
	return study;
}

/* Reads a file that a document names; reports a failure on stderr. */
char *document_file(const char *path, const struct study_source *of, size_t *length)
{
	char why[STUDY_WHY_SIZE];
	char *bytes = named_read(path, of, length, why);
	if (!bytes)
		command_complain("%s %s", of->file, why);
	return bytes;
}

/* Prints the errors of a problem document (RFC 9457), in its order. */
void document_complain(const char *subject, const struct reading *problem)
{
	int n = reading_count(problem, "/errors");
	double more = reading_number(problem, "/errors_not_listed");
	const char *detail = reading_text(problem, "/detail"), *title = reading_text(problem, "/title");
	const char *first = reading_text(problem, "/errors/0/pointer");
	char errors[64];
	if (n > 0 && reading_number(problem, "/status") == HTTP_INVALID) {
		snprintf(errors, sizeof errors, "%.0f error%s", n + fmax(more, 0.0), n > 1 ? "s" : "");
		detail = errors;
	}
	if (!detail)
		detail = title ? title : "the server gave no reason";
	if (n == 1 && first && !*first) {
		// about the whole document: one line
		command_complain("%s: %s: %s", subject, detail, reading_text(problem, "/errors/0/detail"));
		return;
	}
	command_complain("%s: %s", subject, detail);
	for (int i = 0; i < n; i++) {
		const char *pointer = reading_text(problem, "/errors/%d/pointer", i);
		const char *what = reading_text(problem, "/errors/%d/detail", i);
		command_complain("  %s: %s", pointer && *pointer ? pointer : "(document)", what ? what : "");
	}
	if (more > 0.0)
		command_complain("  and %.0f more", more);
}

/* Reports the errors of a document with the same texts as the server. */
enum outcome document_reject(const char *path, const struct problems *problems)
{
	if (problems->status == PROBLEMS_NOMEM) {
		command_complain("%s", pound_status_text(POUND_NOMEM));
		return OUTCOME_FAILED;
	}
	char place[64];
	snprintf(place, sizeof place, "line %d, column %d", problems->line, problems->column);
	const struct problem_head head = {.status = problems->status == PROBLEMS_MALFORMED ? 400 : 422,
	                                  .detail = place};
	size_t n;
	char *json = problem_to_json(&head, problems, &n);
	struct reading *reading = json ? reading_open(json, n) : NULL;
	if (reading)
		document_complain(document_name(path), reading);
	else
		command_complain("out of memory");
	reading_close(reading);
	free(json);
	return OUTCOME_USAGE;
}

void document_advise(const struct pound_study *study)
{
	char note[RESULT_NOTE_SIZE];
	if (pound_study_sampled(study) && result_design_note(study, note, sizeof note))
		command_complain("note: %s", note);
}

void document_hint(const char *text, size_t length)
{
	if (record_recognized(text, length))
		command_complain("this is a recorded ground motion: `pound record' shows it");
	struct problems problems;
	struct pound_study *study = study_design_from_json(text, length, &problems);
	if (study && study->elsewhere)
		command_complain("a study without \"scene\" is for a model of your own: `pound design' prints the "
		                 "samples to run, `pound indices' reads the outputs");
	if (study)
		study_free(study);
}
