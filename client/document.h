/* document.h - a study document as a file or standard input, and what is said about a bad one. */
#ifndef DOCUMENT_H
#define DOCUMENT_H

#include "client/command.h"
#include "schema/json/json_pointer.h"
#include "schema/json/problems.h"
#include "schema/study/study_json.h"

#include <stddef.h>

/* What a document is called in messages. */
const char *document_name(const char *path);

/* The whole file, or standard input for "-"; on the heap.  NULL: said on stderr why. */
char *document_read(const char *path, size_t *length);

/* The same with the samples of the files of ground motions that it names, their paths from its folder; NULL: with the outcome,
 * said on stderr why. */
char *document_whole(const char *path, size_t *length, enum outcome *outcome);

/* The same with the SHA-256 of these files, for a server that has them, and the study (NULL: it names none); and such a file. */
char *document_hashed(const char *path, size_t *length, enum outcome *outcome, struct pound_study **study);
char *document_file(const char *path, const struct study_source *of, size_t *length);

/* The study of a document that was read from a path, with the files that it names, also of a model that is run elsewhere; NULL:
 * with the outcome, said on stderr why. */
struct pound_study *document_study(const char *path, const char *text, size_t length, enum outcome *outcome);

/* Says what a problem body (RFC 9457) says, every error on its own line, `subject` in front. */
void document_complain(const char *subject, const struct reading *problem);

/* The same for a file or standard input that was read here; the outcome that is left. */
enum outcome document_reject(const char *path, const struct problems *problems);

/* Says what there is to say about a study's design. */
struct pound_study;
void document_advise(const struct pound_study *study);

/* Says what a document is for that is no study but the design of one. */
void document_hint(const char *text, size_t length);

#endif
