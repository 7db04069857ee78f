/* Files of recorded ground motions: stored once, by their SHA-256, for the studies that name them. */
#include "server/records.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "schema/study/study_json.h"
#include "server/store.h"

/* ---- studies ---- */

static char *stored_read(const void *with, const struct study_source *of, size_t *length,
                         char why[STUDY_WHY_SIZE])
{
	struct store *store = *(struct store *const *)with;
	char *content = NULL;
	if (!*of->sha256) {
		snprintf(why, STUDY_WHY_SIZE,
		         "needs the sha256 of a file stored on the server: use `pound submit', or first PUT "
		         "/v1/records/{sha256}");
		return NULL;
	}
	const enum store_status found = store_record(store, of->sha256, &content, length);
	if (found == STORE_NONE)
		snprintf(why, STUDY_WHY_SIZE, "is not stored here: PUT /v1/records/%s", of->sha256);
	else if (found != STORE_OK)
		snprintf(why, STUDY_WHY_SIZE, "%s",
		         found == STORE_CORRUPT ? "is damaged in the database: PUT it again"
		                                : "cannot be read now; please try again");
	return found == STORE_OK ? content : NULL;
}

/* Reads a study; the files that it names are read from the store.
 *
 * Test     service_records: a_study_that_names_records_gives_the_bytes_of_its_samples
 */
struct pound_study *records_study(struct store *store, const char *text, size_t length,
                                  struct problems *problems)
{
	const struct study_files files = {.read = stored_read, .with = &store};
	return study_from_document(&(struct study_document){.text = text, .length = length, .files = &files},
	                           problems);
}

char *records_inline(struct store *store, const char *text, size_t *length, const struct pound_study *study)
{
	const struct study_files files = {.read = stored_read, .with = &store};
	const struct study_document document = {.text = text, .length = *length, .files = &files};
	return study_inline(&document, study, length);
}

int records_named(const struct pound_study *study, const char **sha256)
{
	int n = 0;
	for (int k = 0; k < study->scene.excitation.n_records; k++) {
		const struct study_source *of = study_source_of(study, k);
		if (of)
			sha256[n++] = of->sha256;
	}
	return n;
}

/* ---- routes ---- */

static const char *sha256_of(const struct request *request)
{
	return strrchr(request->path, '/') + 1;
}

struct reply records_put(struct request *request)
{
	char sha256[STUDY_HASH_SIZE], detail[160];
	if (request->length == 0)
		return http_problem(API_BAD_REQUEST, "the body must be the file of a recorded ground motion", NULL);
	study_digest(request->body, request->length, sha256);
	if (strcmp(sha256, sha256_of(request)) != 0) {
		snprintf(detail, sizeof detail, "the SHA-256 of the body is %s and differs from the path", sha256);
		return http_problem(API_BAD_REQUEST, detail, NULL);
	}
	const enum store_status status =
	    store_put_record(request->server->store, sha256, request->body, request->length);
	return status == STORE_OK         ? (struct reply){.status = 201}
	       : status == STORE_REPEATED ? (struct reply){.status = 204}
	                                  : http_refusal(status, "");
}

struct reply records_get(struct request *request)
{
	struct reply reply = {.status = 200, .type = "application/octet-stream"};
	const enum store_status status =
	    store_record(request->server->store, sha256_of(request), &reply.body, &reply.length);
	// the first digits are enough: the bytes at a path never change
	snprintf(reply.etag, sizeof reply.etag, "\"%.32s\"", sha256_of(request));
	return status == STORE_OK ? reply : http_refusal(status, "there is no such record");
}
