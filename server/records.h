/* records.h - files of recorded ground motions: their routes, and studies that name them. */
#ifndef RECORDS_H
#define RECORDS_H

#include "engine/pound.h"
#include "schema/json/problems.h"
#include "server/http.h"

/* The study of a document, as study_from_json returns it, for study_free; the files that it names are read from the store. */
struct pound_study *records_study(struct store *store, const char *text, size_t length,
                                  struct problems *problems);
/* The document with samples in place of the files that it names; on the heap, NULL: out of memory. */
char *records_inline(struct store *store, const char *text, size_t *length, const struct pound_study *study);
/* The SHA-256 of the files that a study names; returns how many. */
int records_named(const struct pound_study *study, const char **sha256);

struct reply records_put(struct request *request);
struct reply records_get(struct request *request);

#endif
