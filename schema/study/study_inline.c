/* study_inline.c - copies of a document with recorded ground motions: samples in place of files, files with their SHA-256, or files
 * in place of samples. */
#include <cjson/cJSON.h>
#include <stdio.h>
#include <string.h>

#include "schema/json/json.h"
#include "schema/json/json_writer.h"
#include "schema/study/study_json.h"

static cJSON *records_of(const cJSON *document)
{
	const cJSON *scene = cJSON_GetObjectItemCaseSensitive(document, "scene"),
	            *excitation = cJSON_GetObjectItemCaseSensitive(scene, "excitation");
	return cJSON_GetObjectItemCaseSensitive(excitation, "records");
}

static bool is_file(const cJSON *record)
{
	return cJSON_GetObjectItemCaseSensitive(record, "file") ||
	       cJSON_GetObjectItemCaseSensitive(record, "sha256");
}

bool study_names_files(const char *text, size_t length)
{
	struct json_fault fault;
	bool names = false;
	cJSON *document = json_parse(text, length, &fault);
	const cJSON *record;
	cJSON_ArrayForEach(record, records_of(document)) names |= is_file(record);
	cJSON_Delete(document);
	return names;
}

/* How a copy writes records, and which records it changes. */
enum form { SAMPLES, HASHES, FILES };

static const struct {
	bool of_file;        /* changes records with a file; false: records with samples */
	const char *dropped; /* members left out, each between spaces */
} forms[] = {
    [SAMPLES] = {true, " file sha256 unit channel time_step_s name "},
    [HASHES] = {true, " sha256 "},
    [FILES] = {false, " time_step_s acceleration_m_s2 "},
};

struct copy {
	struct writer w;
	const cJSON *records; /* array of the suite's records */
	const struct pound_study *read;
	enum form form;
};

/* Writes a record in the form of the copy. */
static void write_record(struct copy *copy, const cJSON *record, int k)
{
	const struct pound_record *read = &copy->read->scene.excitation.records[k];
	writer_object(&copy->w, NULL, WRITER_LINE);
	const cJSON *member;
	cJSON_ArrayForEach(member, record)
	{
		char word[32];
		snprintf(word, sizeof word, " %s ", member->string);
		if (!strstr(forms[copy->form].dropped, word))
			json_write(&copy->w, member->string, member, NULL, NULL);
	}
	if (copy->form == HASHES)
		writer_text(&copy->w, "sha256", study_source_of(copy->read, k)->sha256);
	else if (copy->form == FILES) {
		char file[STUDY_FILE_SIZE];
		study_record_file(k, file);
		writer_text(&copy->w, "file", file);
	} else {
		if (read->name)
			writer_text(&copy->w, "name", read->name);
		writer_number(&copy->w, "time_step_s", read->time_step);
		writer_array(&copy->w, "acceleration_m_s2", WRITER_LINE);
		for (int i = 0; i < read->n; i++)
			writer_number(&copy->w, NULL, read->a[i]);
		writer_end(&copy->w);
	}
	writer_end(&copy->w);
}

/* Called for each value: writes a record that the copy changes; false: json_write copies the value. */
static bool replace(void *with, const cJSON *parent, const cJSON *child, int k)
{
	struct copy *copy = with;
	const bool about = parent == copy->records && is_file(child) == forms[copy->form].of_file;
	if (about)
		write_record(copy, child, k);
	return about;
}

static char *copied(const struct study_document *document, const struct pound_study *study, enum form form,
                    size_t *length)
{
	struct json_fault fault;
	cJSON *root = json_parse(document->text, document->length, &fault);
	if (!root)
		return NULL;
	struct copy copy = {.records = records_of(root), .read = study, .form = form};
	writer_init(&copy.w);
	json_write(&copy.w, NULL, root, replace, &copy);
	cJSON_Delete(root);
	return writer_take(&copy.w, length);
}

/* Replaces the files that a document names by their samples.
 *
 * Given    document   -         -    valid
 *          study      -         -    read from it
 * Returns  value      (length)  -    a document of the same study, with the same hash and the same result
 * Memory   allocates; NULL: out of memory
 *
 * Test     unit_suite: files_and_their_samples_are_the_same_study
 */
char *study_inline(const struct study_document *document, const struct pound_study *study, size_t *length)
{
	return copied(document, study, SAMPLES, length);
}

/* Adds the SHA-256 of every file beside its name; otherwise as study_inline.
 *
 * Test     unit_suite: a_file_is_known_by_its_hash
 */
char *study_name_hashes(const struct study_document *document, const struct pound_study *study,
                        size_t *length)
{
	return copied(document, study, HASHES, length);
}

/* Replaces samples by file names (study_record_file).  The caller writes the files.
 *
 * Test     client_suite: from_files_to_a_figure_in_three_commands
 */
char *study_with_files(const struct study_document *document, const struct pound_study *study, size_t *length)
{
	return copied(document, study, FILES, length);
}

void study_record_file(int k, char file[STUDY_FILE_SIZE])
{
	snprintf(file, STUDY_FILE_SIZE, "record_%02d.AT2", k + 1);
}
