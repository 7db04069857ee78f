/* archive.c - a finished study as a folder: its document, its results, the versions that made them, and checksums. */
#include "client/answer.h"
#include "client/follow.h"
#include "schema/json/json_pointer.h"
#include "schema/json/json_writer.h"

#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include <nettle/sha2.h>

#include "engine/pound.h"

enum { HTTP_CONFLICT = 409, FORM = 1 /* version of the archive format */ };

static const char MANIFEST[] = "SHA256SUMS";

struct archive {
	struct wire *wire;
	const struct options *options;
	char *folder; /* temporary name while the files are written */
	FILE *manifest;
};

/* Reports which file could not be written, and why (errno). */
static enum outcome unwritten(const struct archive *archive, const char *name)
{
	command_complain("%s/%s: %s", archive->folder, name, strerror(errno));
	return OUTCOME_FAILED;
}

/* Creates an empty file of the archive; NULL: failed, see errno. */
static FILE *file_new(const struct archive *archive, const char *name)
{
	char *path = command_text("%s/%s", archive->folder, name);
	FILE *file = fopen(path, "wx");
	free(path);
	return file;
}

/* Syncs a file and closes it. */
static bool file_done(FILE *file)
{
	const bool kept = fflush(file) == 0 && !ferror(file) && fsync(fileno(file)) == 0;
	return fclose(file) == 0 && kept;
}

/* Writes a file, and its line of the manifest in the format of sha256sum. */
static enum outcome put(struct archive *archive, const char *name, const char *bytes, size_t n)
{
	struct sha256_ctx hash;
	uint8_t digest[SHA256_DIGEST_SIZE];
	FILE *file = file_new(archive, name);
	if (!file || fwrite(bytes, 1, n, file) != n || !file_done(file))
		return unwritten(archive, name);
	sha256_init(&hash);
	sha256_update(&hash, n, (const uint8_t *)bytes);
	sha256_digest(&hash, sizeof digest, digest);
	for (size_t i = 0; i < sizeof digest; i++)
		fprintf(archive->manifest, "%02x", digest[i]);
	fprintf(archive->manifest, "  %s\n", name);
	return OUTCOME_OK;
}

/* Fetches /v1/studies/{id}{rest} and writes the body to a file.  Samples that the study does not have are only reported. */
static enum outcome fetch(struct archive *archive, const char *rest, const char *type, const char *name)
{
	struct wire_reply reply;
	char *path = answer_path(archive->wire, archive->options->argument, rest);
	const struct wire_request request = {.method = "GET", .path = path, .accept = type, .made = true};
	enum outcome outcome = wire_send(archive->wire, &request, &reply);
	if (outcome == OUTCOME_OK && reply.status == HTTP_CONFLICT && strcmp(rest, "/samples") == 0) {
		struct reading *problem = reading_open(reply.body, reply.n_body);
		const char *detail = problem ? reading_text(problem, "/detail") : NULL;
		command_complain("%s: archived without samples: %s", archive->options->argument,
		                 detail ? detail : "");
		reading_close(problem);
	} else
		outcome = answer_judge(archive->wire, outcome, archive->options->argument, &reply);
	if (outcome == OUTCOME_OK && reply.status != HTTP_CONFLICT)
		outcome = put(archive, name, reply.body, reply.n_body);
	wire_reply_free(&reply);
	free(path);
	return outcome;
}

/* Writes the versions of the client, the server and the engine that computed the result. */
static enum outcome versions(struct archive *archive, const char *engine)
{
	struct wire_reply reply;
	enum outcome outcome = answer_take(
	    archive->wire, &(struct wire_request){.method = "GET", .path = "/version"}, "version", &reply);
	struct reading *server = outcome == OUTCOME_OK ? reading_open(reply.body, reply.n_body) : NULL;
	struct writer w;
	size_t n;
	writer_init(&w);
	writer_object(&w, NULL, WRITER_LINES);
	writer_whole(&w, "archive", FORM);
	writer_text(&w, "engine_version", engine);
	writer_text(&w, "poundd", server ? reading_text(server, "/version") : NULL);
	writer_text(&w, "pound", POUND_VERSION);
	writer_end(&w);
	char *text = command_sure(writer_take(&w, &n));
	if (outcome == OUTCOME_OK)
		outcome = put(archive, "versions.json", text, n);
	free(text);
	reading_close(server);
	wire_reply_free(&reply);
	return outcome;
}

/* Writes all files of the archive. */
static enum outcome fill(struct archive *archive, const struct wire_reply *result)
{
	const bool npy = strcmp(archive->options->format, "npy") == 0;
	struct reading *reading = reading_open(result->body, result->n_body);
	const char *engine = reading ? reading_text(reading, "/engine_version") : NULL;
	enum outcome outcome = put(archive, "result.json", result->body, result->n_body);
	if (outcome == OUTCOME_OK)
		outcome = versions(archive, engine);
	if (outcome == OUTCOME_OK)
		outcome = fetch(archive, "/request", NULL, "study.json");
	if (outcome == OUTCOME_OK)
		outcome = fetch(archive, "", NULL, "status.json");
	if (outcome == OUTCOME_OK)
		outcome = npy ? fetch(archive, "/samples", "application/octet-stream", "samples.npy")
		              : fetch(archive, "/samples", "text/csv", "samples.csv");
	reading_close(reading);
	return outcome;
}

/* Deletes the files of an incomplete archive. */
static void discard(const struct archive *archive)
{
	static const char *const names[] = {"result.json", "versions.json", "study.json", "status.json",
	                                    "samples.csv", "samples.npy",   MANIFEST};
	for (size_t i = 0; i < sizeof names / sizeof names[0]; i++) {
		char *path = command_text("%s/%s", archive->folder, names[i]);
		unlink(path);
		free(path);
	}
	rmdir(archive->folder);
}

/* Writes the folder under a temporary name, and renames it when it is complete. */
static enum outcome folder_make(struct archive *archive, const char *folder, const struct wire_reply *result)
{
	archive->folder = command_text("%s.partial", folder);
	enum outcome outcome = OUTCOME_FAILED;
	if (access(folder, F_OK) == 0)
		command_complain("%s: exists already; give another folder", folder);
	else if (mkdir(archive->folder, 0777) != 0)
		command_complain("%s: %s", archive->folder, strerror(errno));
	else {
		archive->manifest = file_new(archive, MANIFEST);
		outcome = archive->manifest ? fill(archive, result) : unwritten(archive, MANIFEST);
		if (archive->manifest && !file_done(archive->manifest) && outcome == OUTCOME_OK)
			outcome = unwritten(archive, MANIFEST);
		if (outcome == OUTCOME_OK && rename(archive->folder, folder) != 0) {
			command_complain("%s: %s", folder, strerror(errno));
			outcome = OUTCOME_FAILED;
		}
		if (outcome != OUTCOME_OK)
			discard(archive);
	}
	free(archive->folder);
	return outcome;
}

/* `pound archive ID [FOLDER]`: the folder is complete, or does not exist.
 *
 * Returns  value   OUTCOME_STUDY_FAILED: the study failed or was canceled; OUTCOME_FAILED: it has no result yet
 * Test     client_archive: an_archive_has_everything_and_its_checksums_hold
 */
enum outcome archive_make(const struct options *options)
{
	struct archive archive = {.wire = wire_open(options->url), .options = options};
	struct wire_reply result;
	const struct wire_request request = {.method = "GET", .accept = "application/json", .made = true};
	enum outcome outcome = answer_about(archive.wire, request, options->argument, "/results", &result);
	if (outcome == OUTCOME_OK)
		outcome = folder_make(&archive, options->second ? options->second : options->argument, &result);
	else if (result.status == HTTP_CONFLICT && follow_failed(archive.wire, options->argument))
		outcome = OUTCOME_STUDY_FAILED;
	wire_reply_free(&result);
	wire_close(archive.wire);
	return outcome;
}
