/* document.h - study documents from a file or standard input, and messages about invalid ones. */
#ifndef DOCUMENT_H
#define DOCUMENT_H

#include "client/command.h"
#include "schema/json/json_pointer.h"
#include "schema/json/problems.h"
#include "schema/study/study_json.h"

#include <stddef.h>

/* The name of a document in messages. */
const char *document_name(const char *path);

/* The whole file, or standard input for "-"; on the heap.  NULL: reported on stderr. */
char *document_read(const char *path, size_t *length);

/* The same with the samples of the ground motion files that it names (paths relative to its folder) in place of them; NULL: with the
 * outcome, reported on stderr. */
char *document_whole(const char *path, size_t *length, enum outcome *outcome);

/* The same with the SHA-256 of these files, for a server that stores them, and the study (NULL: it names no file); and reads such a
 * file. */
char *document_hashed(const char *path, size_t *length, enum outcome *outcome, struct pound_study **study);
char *document_file(const char *path, const struct study_source *of, size_t *length);

/* The study of a document that was read from a path, with the files that it names; also of an external model; NULL: with the
 * outcome, reported on stderr. */
struct pound_study *document_study(const char *path, const char *text, size_t length, enum outcome *outcome);

/* Prints a problem body (RFC 9457) on stderr, one error per line, each after `subject`. */
void document_complain(const char *subject, const struct reading *problem);

/* The same for a file or standard input that was read here; returns the outcome. */
enum outcome document_reject(const char *path, const struct problems *problems);

/* Prints warnings about a study's design. */
struct pound_study;
void document_advise(const struct pound_study *study);

/* Prints the subcommands for a document that is a recorded ground motion or the study of an external model. */
void document_hint(const char *text, size_t length);

#endif
