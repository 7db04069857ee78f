/* show_example.c - the study documents that are built in. */
#include "client/command.h"
#include "client/document.h"
#include "schema/examples/examples.h"
#include "schema/record/record.h"
#include "schema/study/near_name.h"

#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

static const char EXAMPLE_DEFAULT[] = "paper";

/* Writes a new file; false: failed or it exists, reported on stderr. */
static bool put(const char *folder, const char *name, const char *bytes, size_t n)
{
	char *path = command_text("%s/%s", folder, name);
	FILE *file = fopen(path, "wx");
	bool written = file && fwrite(bytes, 1, n, file) == n;
	if (file)
		written = fclose(file) == 0 && written;
	if (!written)
		command_complain("%s: %s", path, strerror(errno));
	free(path);
	return written;
}

/* Writes the records of a suite as files. */
static bool put_records(const char *folder, const struct pound_excitation *suite)
{
	for (int k = 0; k < suite->n_records; k++) {
		const struct pound_record *of = &suite->records[k];
		struct record record = {.n = of->n, .step = of->time_step, .acceleration = (double *)of->a};
		char name[STUDY_FILE_SIZE];
		size_t n;
		snprintf(record.title, sizeof record.title, "%s", of->name ? of->name : "a record");
		study_record_file(k, name);
		char *text = command_sure(record_to_peer(&record, &n));
		const bool written = put(folder, name, text, n);
		free(text);
		if (!written)
			return false;
	}
	return true;
}

/* Writes an example as a file, and the records in it as files beside it. */
static enum outcome write_files(const char *name, const char *text, const char *folder)
{
	struct problems problems;
	const struct study_document document = {.text = text, .length = strlen(text)};
	struct pound_study *study = study_from_document(&document, &problems); // NULL: no "scene" in it
	const bool suite = study && study->scene.excitation.n_records;
	size_t n = document.length;
	char *file = command_text("%s.json", name),
	     *copy = suite ? command_sure(study_with_files(&document, study, &n)) : NULL;
	const bool there = mkdir(folder, 0777) == 0 || errno == EEXIST;
	if (!there)
		command_complain("%s: %s", folder, strerror(errno));
	const bool written = there && put(folder, file, copy ? copy : text, n) &&
	                     (!suite || put_records(folder, &study->scene.excitation));
	free(copy);
	free(file);
	if (study)
		study_free(study);
	return written ? OUTCOME_OK : OUTCOME_FAILED;
}

/* `pound example [NAME] [FOLDER]`
 *
 * Test     client_suite: from_files_to_a_figure_in_three_commands
 */
enum outcome example_print(const struct options *options)
{
	const char *name = options->argument ? options->argument : EXAMPLE_DEFAULT;
	if (options->names) {
		for (int i = 0; example_name(i); i++)
			printf("%s\n", example_name(i));
		return OUTCOME_OK;
	}
	const char *text = example_text(name);
	if (text && options->second)
		return write_files(name, text, options->second);
	if (text) {
		fputs(text, stdout);
		return OUTCOME_OK;
	}
	struct near_name_search search = near_name_begin(name);
	for (int i = 0; example_name(i); i++)
		near_name_try(&search, example_name(i));
	const char *meant = near_name_found(&search);
	command_complain("no example '%s'%s%s%s there are:", name, meant ? ", did you mean '" : ";",
	                 meant ? meant : "", meant ? "'?" : "");
	for (int i = 0; example_name(i); i++)
		command_complain("  %-24s %s", example_name(i), example_title(i));
	return OUTCOME_USAGE;
}
