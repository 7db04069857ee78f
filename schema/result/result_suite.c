/* result_suite.c - writes the recorded ground motions of a result as JSON: records and their factors. */
#include "schema/result/result_suite.h"

#include <math.h>
#include <string.h>

/* Whether the factors differ between samples or cells. */
static bool varies(const struct pound_study *study)
{
	static const char *const paths[] = {"/excitation/factor", "/excitation/scale/intensity_m_s2"};
	bool is = false;
	for (int p = 0; p < 2; p++) {
		for (int j = 0; j < study->n_inputs; j++)
			is |= strcmp(study->inputs[j].path, paths[p]) == 0;
		for (int s = 0; s < study->n_sweeps; s++)
			is |= strcmp(study->sweeps[s].path, paths[p]) == 0;
	}
	return is;
}

static double peak_of(const struct pound_record *record)
{
	double peak = 0;
	for (int i = 0; i < record->n; i++)
		peak = fmax(peak, fabs(record->a[i]));
	return peak;
}

static void write_record(struct writer *w, const struct pound_excitation *suite, int k, double reference,
                         double factor, double difference)
{
	const struct pound_record *record = &suite->records[k];
	writer_object(w, NULL, WRITER_LINE);
	writer_whole(w, "index", k);
	if (record->name)
		writer_text(w, "name", record->name);
	writer_whole(w, "samples", record->n);
	writer_number(w, "time_step_s", record->time_step);
	writer_number(w, "pga_m_s2", peak_of(record));
	writer_bool(w, "reversed", record->reversed);
	writer_number(w, "reference_m_s2", reference);
	writer_number(w, "factor", factor);
	writer_number(w, "interpolation_difference", difference);
	writer_end(w);
}

/* Writes the records of a suite: peak as given, error of linear interpolation between samples, peak or spectral acceleration before
 * scaling (null: not scaled), and the factor of the samples (null: it varies; the signals of a response have it).
 *
 * Test     unit_suite: factors_come_back_in_the_result
 */
void result_suite(struct writer *w, const struct pound_study *study, const struct pound_result *result)
{
	const struct pound_excitation *suite = &study->scene.excitation;
	if (!suite->n_records)
		return;
	writer_object(w, "suite", WRITER_LINES);
	writer_text(w, "scale", pound_scale_name(suite->scale.to));
	writer_array(w, "records", WRITER_LINES);
	for (int k = 0; k < suite->n_records; k++) {
		const double reference = result->references ? result->references[k] : NAN;
		const double scaled = result->references ? suite->scale.intensity / reference : 1;
		write_record(w, suite, k, reference,
		             varies(study) ? NAN : suite->factor * suite->records[k].factor * scaled,
		             result->differences[k]);
	}
	writer_end(w);
	writer_end(w);
}

void result_suite_signal(struct writer *w, const struct pound_suite_signal *signal)
{
	writer_whole(w, "record", signal->record);
	writer_number(w, "factor", signal->factor);
}
