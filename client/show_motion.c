/* show_motion.c - `pound motion`: the ground motions of a study, for use in other programs. */
#include "client/command.h"
#include "client/document.h"
#include "schema/result/motion_spectrum.h"
#include "schema/result/result_json.h"
#include "schema/study/study_json.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static enum outcome motions_print(const struct options *options, const struct pound_run *run,
                                  const struct motion_choice *choice, const struct periods *periods)
{
	static const struct {
		const char *format;
		char *(*form)(const struct pound_run *run, const struct motion_choice *choice, size_t *length);
	} forms[] = {{"csv", motions_to_csv}, {"npy", motions_to_npy}, {"at2", motions_to_peer}};
	size_t n = 0;
	char *bytes = NULL;
	if (periods->n)
		bytes = motions_to_spectra(run, choice, periods, &n);
	for (int k = 0; k < 3 && !periods->n; k++)
		if (strcmp(options->format, forms[k].format) == 0)
			bytes = forms[k].form(run, choice, &n);
	if (bytes)
		fwrite(bytes, 1, n, stdout);
	else
		command_complain("%s", pound_status_text(POUND_NOMEM));
	free(bytes);
	return bytes ? OUTCOME_OK : OUTCOME_FAILED;
}

/* `pound motion STUDY.json`: the ground motions of a study, or with --periods their response spectra.
 *
 * Test     client_record: motions_of_a_study_are_written_in_every_form
 */
enum outcome motion_show(const struct options *options)
{
	size_t n;
	struct periods periods;
	struct problems problems;
	struct motion_choice choice;
	if (!motion_spectrum_periods(options->periods, &periods)) {
		command_complain("--periods takes %s, got '%s'", motion_spectrum_expected, options->periods);
		return OUTCOME_USAGE;
	}
	enum outcome outcome;
	char *document = document_whole(options->argument, &n, &outcome);
	if (!document)
		return outcome;
	struct pound_study *study = study_from_json(document, n, &problems);
	free(document);
	if (!study)
		return document_reject(options->argument, &problems);
	struct pound_run *run = pound_run_create(study, 1);
	const struct pound_place place = {.cell = options->choice.cell ? atoi(options->choice.cell) : 0,
	                                  .row = options->row,
	                                  .signal = options->choice.signal ? atoi(options->choice.signal) : -1};
	char why[100];
	outcome = OUTCOME_FAILED;
	if (!run)
		command_complain("%s", pound_status_text(POUND_NOMEM));
	else if (!motions_choose(study, run, place, &choice, why)) {
		command_complain("--%s", why);
		outcome = OUTCOME_USAGE;
	} else
		outcome = motions_print(options, run, &choice, &periods);
	pound_run_free(run);
	study_free(study);
	return outcome;
}
