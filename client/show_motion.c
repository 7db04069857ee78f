/* show_motion.c - `pound motion`: the ground motions of a study, to be used elsewhere. */
#include "client/command.h"
#include "client/document.h"
#include "client/motion_spectrum.h"
#include "client/table.h"
#include "schema/result/result_json.h"
#include "schema/study/study_json.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* What is to be written; false: said why there is no such motion. */
static bool choice_of(const struct options *options, const struct pound_study *study,
                      const struct pound_run *run, struct motion_choice *choice)
{
	const int signals = study->scene.excitation.signals;
	*choice = (struct motion_choice){
	    .place = {.cell = options->choice.cell ? atoi(options->choice.cell) : 0,
	              .row = options->row,
	              .signal = options->choice.signal ? atoi(options->choice.signal) : 0},
	    .one = options->choice.signal,
	    .signals = signals,
	    .records = study->scene.excitation.n_records ? study->scene.excitation.records : NULL,
	    .name = study->name ? study->name : "a ground motion"};
	const struct {
		const char *option;
		int value, n;
	} limits[] = {{"--cell", choice->place.cell, study_cells(study)},

	              {"--signal", choice->place.signal, signals}};
	for (int k = 0; k < 2; k++)
		if (limits[k].value < 0 || limits[k].value >= limits[k].n) {
			command_complain("%s must be a whole number from 0 to %d, got %d", limits[k].option,
			                 limits[k].n - 1, limits[k].value);
			return false;
		}
	if (options->row >= pound_run_rows(run)) {
		command_complain("--row must be a whole number from 1 to %d, got %d", pound_run_rows(run),
		                 options->row + 1);
		return false;
	}
	return true;
}

/* Pseudo-accelerations of each chosen signal, a row for each period; of a suite with its record and factor. */
static enum outcome spectra_print(const struct pound_run *run, const struct motion_choice *choice,
                                  const struct periods *periods)
{
	static const char *const names[] = {"signal", "record", "factor", "period_s", "psa_m_s2", NULL},
	                         *const plain[] = {"signal", "period_s", "psa_m_s2", NULL};
	struct table *table = table_open(choice->records ? names : plain);
	struct pound_place place = choice->place;
	enum pound_status status = POUND_OK;
	const int end = choice->one ? place.signal + 1 : choice->signals;
	for (place.signal = choice->one ? place.signal : 0; place.signal < end && status == POUND_OK;
	     place.signal++) {
		double psa[PERIODS_MAX];
		struct record motion = {0};
		motion.n = pound_run_motion_samples(run, &place, &motion.step);
		motion.acceleration = command_sure(malloc((size_t)motion.n * sizeof *motion.acceleration));
		pound_run_motion(run, &place, motion.acceleration);
		status = motion_spectrum(&motion, periods, psa);
		record_free(&motion);
		for (int k = 0; k < periods->n && status == POUND_OK; k++) {
			table_number(table, place.signal);
			if (choice->records) {
				const struct pound_suite_signal signal = pound_run_motion_record(run, &place);
				table_number(table, signal.record);
				table_number(table, signal.factor);
			}
			table_number(table, periods->period[k]);
			table_number(table, psa[k]);
		}
	}
	if (status == POUND_OK)
		table_print_csv(table);
	else
		command_complain("the response spectrum cannot be computed: %s", pound_status_error(status));
	table_close(table);
	return status == POUND_OK ? OUTCOME_OK : OUTCOME_FAILED;
}

static enum outcome motions_print(const struct options *options, const struct pound_run *run,
                                  const struct motion_choice *choice)
{
	static const struct {
		const char *format;
		char *(*form)(const struct pound_run *run, const struct motion_choice *choice, size_t *length);
	} forms[] = {{"csv", motions_to_csv}, {"npy", motions_to_npy}, {"at2", motions_to_peer}};
	size_t n = 0;
	char *bytes = NULL;
	for (int k = 0; k < 3; k++)
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
	if (!motion_spectrum_periods(options->periods, &periods))
		return OUTCOME_USAGE;
	enum outcome outcome;
	char *document = document_whole(options->argument, &n, &outcome);
	if (!document)
		return outcome;
	struct pound_study *study = study_from_json(document, n, &problems);
	free(document);
	if (!study)
		return document_reject(options->argument, &problems);
	struct pound_run *run = pound_run_create(study, 1);
	outcome = OUTCOME_FAILED;
	if (!run)
		command_complain("%s", pound_status_text(POUND_NOMEM));
	else if (!choice_of(options, study, run, &choice))
		outcome = OUTCOME_USAGE;
	else
		outcome = periods.n ? spectra_print(run, &choice, &periods) : motions_print(options, run, &choice);
	pound_run_free(run);
	study_free(study);
	return outcome;
}
