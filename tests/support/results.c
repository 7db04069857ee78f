#include "tests/support/results.h"

#include <stdlib.h>
#include <string.h>

#include "schema/external/external_model.h"
#include "schema/result/result_json.h"
#include "schema/study/study_json.h"
#include "tests/support/check.h"
#include "tests/support/scenes.h"
#include "tests/support/study_documents.h"

struct pound_study *results_design(const char *document)
{
	struct problems problems;
	struct pound_study *study = study_design_from_json(document, strlen(document), &problems);
	if (!study)
		fail_msg("%s: %s", problems.list[0].pointer, problems.list[0].detail);
	return study;
}

/* Opens a result and frees its text. */
static struct reading *opened(char *json, size_t length)
{
	struct reading *result = reading_open(json, length);
	assert_non_null(result);
	free(json);
	return result;
}

struct reading *results_of_study(const char *document)
{
	static const struct timing timing = {1, 1, 1};
	struct pound_study *study = study_documents_study(document);
	struct pound_run *run = pound_run_create(study, 1);
	size_t length;
	assert_non_null(run);
	assert_int_equal(specimen_compute(run), POUND_OK);
	char *json = result_to_json(study, pound_run_result(run), &timing, &length);
	pound_run_free(run);
	study_free(study);
	return opened(json, length);
}

struct reading *results_of_lines(const char *document, const char *csv)
{
	struct problems problems;
	size_t length;
	struct pound_study *study = results_design(document);
	char *json = model_indices(study, csv, strlen(csv), &problems, &length);
	if (!json)
		fail_msg("%s: %s", problems.list[0].pointer, problems.list[0].detail);
	study_free(study);
	return opened(json, length);
}
