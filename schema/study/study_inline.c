/* study_inline.c - a document that names files of recorded ground motions -> the same with their samples in it. */
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

struct copy {
	struct writer w;
	const cJSON *records; /* of the suite */
	const struct pound_study *read;
	bool hashes; /* instead of samples */
};

static void write_value(struct copy *copy, const char *name, const cJSON *value);

/* Writes a record, the samples of its file in place of what is said about that, or that and its SHA-256. */
static void write_record(struct copy *copy, const cJSON *record, int k)
{
	const struct pound_record *read = &copy->read->scene.excitation.records[k];
	const char *const of_file = copy->hashes ? " sha256 " : " file sha256 unit channel time_step_s name ";
	writer_object(&copy->w, NULL, WRITER_LINE);
	const cJSON *member;
	cJSON_ArrayForEach(member, record)
	{
		char word[32];
		snprintf(word, sizeof word, " %s ", member->string);
		if (!strstr(of_file, word))
			write_value(copy, member->string, member);
	}
	if (copy->hashes) {
		writer_text(&copy->w, "sha256", study_source_of(copy->read, k)->sha256);
		writer_end(&copy->w);
		return;
	}
	if (read->name)
		writer_text(&copy->w, "name", read->name);
	writer_number(&copy->w, "time_step_s", read->time_step);
	writer_array(&copy->w, "acceleration_m_s2", WRITER_LINE);
	for (int i = 0; i < read->n; i++)
		writer_number(&copy->w, NULL, read->a[i]);
	writer_end(&copy->w);
	writer_end(&copy->w);
}

/* Writes a value as it is; numbers read back to the same doubles. */
static void write_value(struct copy *copy, const char *name, const cJSON *value)
{
	struct writer *w = &copy->w;
	if (cJSON_IsObject(value) || cJSON_IsArray(value)) {
		int k = 0;
		(cJSON_IsObject(value) ? writer_object : writer_array)(w, name, WRITER_LINE);
		for (const cJSON *child = value->child; child; child = child->next, k++)
			if (value == copy->records && is_file(child))
				write_record(copy, child, k);
			else
				write_value(copy, child->string, child);
		writer_end(w);
	} else if (cJSON_IsNumber(value))
		writer_number(w, name, value->valuedouble);
	else if (cJSON_IsBool(value))
		writer_bool(w, name, cJSON_IsTrue(value));
	else
		writer_text(w, name, value->valuestring); // null has none
}

static char *copied(const struct study_document *document, const struct pound_study *study, bool hashes,
                    size_t *length)
{
	struct json_fault fault;
	cJSON *root = json_parse(document->text, document->length, &fault);
	if (!root)
		return NULL;
	struct copy copy = {.records = records_of(root), .read = study, .hashes = hashes};
	writer_init(&copy.w);
	write_value(&copy, NULL, root);
	cJSON_Delete(root);
	return writer_take(&copy.w, length);
}

/* Puts samples in place of the files that a document names.
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
	return copied(document, study, false, length);
}

/* Puts the SHA-256 of every file beside its name, as study_inline puts samples in its place.
 *
 * Test     unit_suite: a_file_is_known_by_its_hash
 */
char *study_name_hashes(const struct study_document *document, const struct pound_study *study,
                        size_t *length)
{
	return copied(document, study, true, length);
}
