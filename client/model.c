/* model.c - external models: `pound design` prints the samples to run, `pound indices` reads the outputs. */
#include "client/model.h"
#include "client/command.h"
#include "client/document.h"
#include "client/show.h"
#include "schema/external/external_model.h"
#include "schema/external/given_table.h"
#include "schema/study/study_json.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { ROWS_AT_ONCE = 1000 };

struct pound_study *model_study(const char *path, enum outcome *outcome)
{
	size_t n;
	struct problems problems;
	char *document = document_whole(path, &n, outcome);
	if (!document)
		return NULL;
	struct pound_study *study = study_design_from_json(document, n, &problems);
	free(document);
	*outcome = OUTCOME_FAILED;
	if (!study) {
		*outcome = document_reject(path, &problems);
		return NULL;
	}
	study->elsewhere = true;
	document_advise(study);
	return study;
}

static enum outcome no_memory(void)
{
	command_complain("%s", pound_status_text(POUND_NOMEM));
	return OUTCOME_FAILED;
}

/* `pound design STUDY.json`: the rows of its design as CSV.
 *
 * Test     client_model: a_design_has_its_header_and_its_samples
 */
enum outcome model_design(const struct options *options)
{
	enum outcome outcome;
	struct pound_study *study = model_study(options->argument, &outcome);
	if (!study)
		return outcome;
	study->n_outputs = 0; // the run is only used for its design
	struct pound_run *run = pound_run_create(study, 1);
	outcome = run ? OUTCOME_OK : no_memory();
	const int rows = run ? pound_run_rows(run) : 0;
	for (int row = 0; row < rows && outcome == OUTCOME_OK; row += ROWS_AT_ONCE) {
		int left = rows - row;
		size_t n;
		char *lines = model_rows(study, run, row, left < ROWS_AT_ONCE ? left : ROWS_AT_ONCE, &n);
		if (!lines)
			outcome = no_memory();
		else if (fwrite(lines, 1, n, stdout) < n)
			outcome = OUTCOME_FAILED; // main reports the reason
		free(lines);
	}
	pound_run_free(run);
	study_free(study);
	return outcome;
}

/* Reads a CSV table from a file; false: failed, reported on stderr. */
static bool table_read(struct given_table *table, enum given_role role, const char *path,
                       enum outcome *outcome)
{
	size_t n;
	struct problems problems;
	char *csv = document_read(path, &n);
	*table = (struct given_table){0};
	*outcome = OUTCOME_FAILED;
	if (!csv)
		return false;
	given_table_read(table, role, csv, n, &problems);
	free(csv);
	*outcome = problems.status == PROBLEMS_NONE ? OUTCOME_OK : document_reject(path, &problems);
	return *outcome == OUTCOME_OK;
}

/* `pound indices --given X.csv Y.csv`: indices from given samples, without a design.
 *
 * Test     client_model: given_samples_have_indices_without_a_study
 */
static enum outcome given_print(const struct options *options)
{
	enum outcome outcome, of_outputs;
	struct given_table x, y;
	// both are read, so that all errors are reported at once
	const bool inputs = table_read(&x, GIVEN_INPUTS, options->argument, &outcome),
	           outputs = table_read(&y, GIVEN_OUTPUTS, options->second, &of_outputs);
	outcome = inputs ? of_outputs : outcome;
	if (inputs && outputs) {
		size_t n;
		struct problems problems[2]; // of each role
		char *json = given_indices(&x, &y, problems, &n);
		outcome = json ? show_result(json, n, options) : OUTCOME_FAILED;
		for (int role = 0; role < 2 && !json; role++)
			if (problems[role].status != PROBLEMS_NONE)
				outcome = document_reject(role == GIVEN_INPUTS ? options->argument : options->second,
				                          &problems[role]);
		free(json);
	}
	given_table_free(&x);
	given_table_free(&y);
	return outcome;
}

/* `pound indices STUDY.json Y.csv`: indices of the outputs of an external model.
 *
 * Test     client_model: indices_of_outputs_computed_elsewhere_come_as_json_table_and_csv
 */
enum outcome model_print_indices(const struct options *options)
{
	enum outcome outcome = OUTCOME_USAGE;
	size_t n_csv, n;
	struct problems problems;
	if (strcmp(options->argument, "-") == 0 && strcmp(options->second, "-") == 0) {
		command_complain("only one of the two files can be standard input");
		return OUTCOME_USAGE;
	}
	if (options->given)
		return given_print(options);
	struct pound_study *study = model_study(options->argument, &outcome);
	const char *ending = strrchr(options->argument, '.');
	if (!study && ending && strcmp(ending, ".csv") == 0)
		command_complain("is %s a table of inputs? pound indices --given %s %s", options->argument,
		                 options->argument, options->second);
	char *csv = study ? document_read(options->second, &n_csv) : NULL;
	if (csv) {
		char *json = model_indices(study, csv, n_csv, &problems, &n);
		// a location that is a JSON Pointer is in the study, any other location is in the outputs
		const bool of_study = !json && problems.n > 0 && problems.list[0].pointer[0] == '/';
		outcome = json ? show_result(json, n, options)
		               : document_reject(of_study ? options->argument : options->second, &problems);
		free(json);
	}
	free(csv);
	study_free(study);
	return outcome;
}
