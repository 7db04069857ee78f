/* study_spectrum.c - frequencies of floor spectra as a list or a range; in a sensitivity study each frequency is an output. */
#include "schema/study/study_spectrum.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

#include "schema/json/json_writer.h"
#include "schema/study/reader.h"
#include "schema/study/study_check.h"
#include "schema/study/study_json.h"

/* Largest frequency times the sample step: an oscillator then takes about 1000 steps per sample. */
static const double PITCH_MAX = 100;

/* Whether a member of the current object has a problem. */
static bool wrong(struct reader *r, const char *name)
{
	size_t length = reader_enter(r, name);
	bool is = problems_at(r->problems, r->pointer);
	reader_leave(r, length);
	return is;
}

/* Reads frequencies as a list or as a range.
 *
 * Test     unit_study_spectrum: frequencies_are_a_list_or_a_range
 */
void reader_frequencies(struct reader *r, const struct field *field, const cJSON *node, char *base)
{
	struct pound_spectrum *spectrum = &r->study->spectrum;
	if (cJSON_IsArray(node)) {
		spectrum->n = reader_numbers(r, field, field + 1, node, &spectrum->frequencies_hz); // the next row
		reader_distinct(r, spectrum->frequencies_hz, spectrum->n, "frequency");
	} else if (!cJSON_IsObject(node)) {
		reader_mistyped(r, "an array of frequencies, or an object of min, max and count", node);
	} else if (cJSON_GetObjectItemCaseSensitive(node, "*")) {
		problems_add(r->problems, r->pointer, "has an unknown member, \"*\"");
	} else {
		reader_object(r, field->pattern, node, base);
		if (!wrong(r, "min") && !wrong(r, "max") && spectrum->min_hz >= spectrum->max_hz)
			problems_add(r->problems, r->pointer, "min must be less than max, got %.15g and %.15g",
			             spectrum->min_hz, spectrum->max_hz);
	}
}

static bool asks_for_ordinates(const struct pound_study *study)
{
	for (int o = 0; o < study->n_outputs; o++)
		if (study->outputs[o] >= 0 && pound_output_has_ordinates(study->outputs[o]))
			return true;
	return false;
}

/* A sensitivity study must have both output "floor_spectrum" and spectrum, or neither; the frequencies have no default, as only the
 * user knows which matter.
 *
 * Test     unit_study_cases
 */
void reader_ordinates(struct reader *r, const cJSON *document)
{
	const cJSON *spectrum = cJSON_GetObjectItemCaseSensitive(document, "spectrum");
	bool asked = asks_for_ordinates(r->study);
	if (!r->kind || strcmp(r->kind, study_kind_name(POUND_KIND_SENSITIVITY)) != 0 || r->study->elsewhere)
		return;
	if (spectrum && !asked && !problems_at(r->problems, "/outputs"))
		problems_add(r->problems, "/spectrum", "is not used without output \"floor_spectrum\"");
	if (asked && !cJSON_GetObjectItemCaseSensitive(spectrum, "frequencies_hz"))
		problems_add(r->problems, "/spectrum/frequencies_hz",
		             "is required: 1 to %d frequencies of the floor spectrum", POUND_ORDINATES_MAX);
}

/* ---- checks ---- */

static double highest(const struct pound_spectrum *spectrum)
{
	double most = 0;
	for (int k = 0; k < spectrum->n; k++)
		most = fmax(most, pound_spectrum_frequency(spectrum, k));
	return most;
}

/* Checks the spectrum against the rest of the study.
 *
 * Given    study      -     read, possibly with problems
 * Returns  problems   -     further problems are added
 *
 * Test     unit_study_cases
 */
void study_spectrum_check(const struct pound_study *study, struct problems *problems)
{
	const struct pound_spectrum *spectrum = &study->spectrum;
	bool whole = study->kind == POUND_KIND_FLOOR_SPECTRUM, asked = asks_for_ordinates(study);
	if (asked && study->kind != POUND_KIND_SENSITIVITY)
		problems_add(problems, "/outputs",
		             "\"floor_spectrum\" is an output of sensitivity studies; kind "
		             "\"floor_spectrum\" has whole spectra");
	if (!whole && !(asked && study->kind == POUND_KIND_SENSITIVITY))
		return;
	static const char frequencies[] = "/spectrum/frequencies_hz";
	if (problems_at(problems, frequencies) || problems_over(problems, frequencies))
		return;
	const bool signals = study_check_known(study, "/excitation/signals", problems);
	double least = 0, step = 0, most = highest(spectrum);
	if (study_check_known(study, "/excitation/time_step_s", problems))
		study_check_reach(study, "/excitation/time_step_s", &least, &step);
	if (most * step > PITCH_MAX)
		problems_add(problems, "/spectrum/frequencies_hz",
		             "must be at most %.15g / time_step_s = %.15g Hz, got %.15g", PITCH_MAX, PITCH_MAX / step,
		             most);
	if (asked && spectrum->n > POUND_ORDINATES_MAX)
		problems_add(problems, "/spectrum/frequencies_hz",
		             "must have at most %d frequencies in a sensitivity study, has %d", POUND_ORDINATES_MAX,
		             spectrum->n);
	if (whole && spectrum->histories && signals && !problems_at(problems, "/histories") &&
	    study_check_steps_known(study, problems) &&
	    study_samples(study) * study->scene.excitation.signals > STUDY_HISTORIES_MAX)
		problems_exceed(problems, "/histories", study_samples(study) * study->scene.excitation.signals,
		                STUDY_HISTORIES_MAX, "needs %.15g samples over all signals; the limit is %d",
		                study_samples(study) * study->scene.excitation.signals, STUDY_HISTORIES_MAX);
	double ordinates = (double)spectrum->n * study->scene.excitation.signals;
	if (whole && signals && ordinates > STUDY_ORDINATES_MAX)
		problems_exceed(problems, "/spectrum/frequencies_hz", ordinates, STUDY_ORDINATES_MAX,
		                "needs %.15g frequencies over all signals; the limit is %d", ordinates,
		                STUDY_ORDINATES_MAX);
}

/* ---- outputs ---- */

/* Removes a spectrum that is not requested, and makes one output of each ordinate.
 *
 * Test     unit_study_spectrum: every_frequency_is_an_output
 */
void study_spectrum_lay(struct pound_study *study)
{
	struct pound_spectrum *spectrum = &study->spectrum;
	if (study->kind == POUND_KIND_FLOOR_SPECTRUM)
		return;
	if (!asks_for_ordinates(study)) {
		*spectrum = (struct pound_spectrum){0};
		return;
	}
	int outputs[POUND_OUTPUTS_MAX], n = 0;
	for (int o = 0; o < study->n_outputs; o++)
		for (int k = 0; k < (pound_output_has_ordinates(study->outputs[o]) ? spectrum->n : 1); k++)
			outputs[n++] = study->outputs[o];
	memcpy(study->outputs, outputs, sizeof *outputs * (size_t)n);
	study->n_outputs = n;
}

const char *study_output_name(const struct pound_study *study, int output, char name[STUDY_OUTPUT_SIZE])
{
	char digits[WRITER_NUMBER_SIZE];
	if (study->elsewhere)
		return study->output_names[output];
	const int k = pound_study_ordinate(study, output), at = pound_study_place(study, output),
	          contact = pound_study_contact(study, output);
	if (at >= 0) {
		const struct pound_storey_place *place = &study->scene.places[at];
		snprintf(name, STUDY_OUTPUT_SIZE, "%s.building_%d.storey_%d",
		         pound_output_name(study->outputs[output]), place->building, place->storey);
		return name;
	}
	if (contact >= 0) {
		snprintf(name, STUDY_OUTPUT_SIZE, "%s.contact_%d", pound_output_name(study->outputs[output]),
		         contact);
		return name;
	}
	if (k < 0)
		return pound_output_name(study->outputs[output]);
	writer_digits(pound_spectrum_frequency(&study->spectrum, k), digits);
	snprintf(name, STUDY_OUTPUT_SIZE, "%s.%s_hz", pound_output_name(study->outputs[output]), digits);
	return name;
}
