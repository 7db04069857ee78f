/* result_accuracy.c - error estimates of a sensitivity result, in numbers and in one sentence. */
#include "schema/result/result_accuracy.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

#include "schema/study/study_json.h"

/* Errors by source, of an output or the worst of all, and the least that signals add to the widest interval. */
struct errors {
	double of[POUND_ERROR_NONE], excitation_low;
};

/* Writes that few rows and few signals cannot be distinguished as sources of the widest interval, and how to find out. */
static void write_undecided(struct writer *w, const struct pound_study *study, const struct errors *errors,
                            const char *index)
{
	const double high = errors->of[POUND_ERROR_EXCITATION];
	const char *noise = study->elsewhere ? "replicates" : "signals";
	char least[40] = "0", note[500];
	if (errors->excitation_low > 0)
		snprintf(least, sizeof least, "%.2g", errors->excitation_low);
	snprintf(
	    note, sizeof note,
	    "Whether more rows or more %s would narrow the widest interval cannot be decided with so few %s: "
	    "their noise makes up between %s and %.2g of its half-width of %.2g%s%s%s.",
	    noise, noise, least, high, errors->of[POUND_ERROR_SAMPLING], *index ? ", of " : "", index,
	    study->elsewhere ? "" : "; design.signals = auto finds out");
	writer_text(w, "note", note);
}

/* Writes the error estimates, and the dominant one: larger than all others together.
 *
 * Given    index   name of the index with the largest error from sampling or integration
 */
static void write_errors(struct writer *w, const struct pound_study *study, const struct errors *all,
                         const char *index)
{
	const double *errors = all->of;
	enum pound_error dominant = pound_accuracy_dominant(errors, all->excitation_low);
	writer_object(w, "errors", WRITER_LINE);
	for (int k = 0; k < POUND_ERROR_NONE; k++) {
		writer_number(w, pound_error_name(k), errors[k]);
		if (k == POUND_ERROR_EXCITATION)
			writer_number(w, "excitation_low", all->excitation_low);
	}
	writer_end(w);
	writer_text(w, "dominant", pound_error_name(dominant));
	if (pound_accuracy_undecided(errors, all->excitation_low))
		write_undecided(w, study, all, index);
	if (!*index)
		index = "an index";
	if (dominant == POUND_ERROR_NONE)
		return;
	const struct {
		const char *sentence;
		bool of_index;
	} notes[] = {
	    [POUND_ERROR_SAMPLING] = {"The number of rows is the largest source of error: the largest half-width "
	                              "of an interval is %.2g, of ",
	                              true},
	    [POUND_ERROR_EXCITATION] =
	        {study->elsewhere
	             ? "The number of replicates is the largest source of error: their noise makes up at "
	               "least %.2g of the largest half-width of an interval, of "
	             : "The number of signals is the largest source of error: their noise makes up at "
	               "least %.2g of the largest half-width of an interval, of ",
	         true},
	    [POUND_ERROR_INTEGRATION] = {"Integration is the largest source of error: up to %.2g in ", true},
	    [POUND_ERROR_FAILED_ROWS] = {"Failed rows are the largest source of error: if all were like the most "
	                                 "extreme valid row, an index would change by up to %.2g",
	                                 false}};
	char note[400];
	int n = snprintf(note, sizeof note, notes[dominant].sentence,
	                 dominant == POUND_ERROR_EXCITATION ? all->excitation_low : errors[dominant]);
	snprintf(note + n, sizeof note - (size_t)n, "%s.", notes[dominant].of_index ? index : "");
	writer_text(w, "note", note);
}

/* The name of the least certain index of an output: with the widest interval, or with the largest integration error if that
 * dominates. */
static void least_certain(const struct pound_study *study, const struct pound_accuracy *accuracy, char *text,
                          size_t size)
{
	const bool runs =
	    pound_accuracy_dominant(accuracy->errors, accuracy->excitation_low) == POUND_ERROR_INTEGRATION;
	double worst = -1;
	for (int j = 0; j < study->n_inputs; j++) {
		double of[] = {
		    runs ? accuracy->inputs[j].first_change : accuracy->inputs[j].first_half[POUND_LEVELS - 1],
		    runs ? accuracy->inputs[j].total_change : accuracy->inputs[j].total_half[POUND_LEVELS - 1]};
		for (int k = 0; k < 2; k++)
			if (of[k] > worst) {
				worst = of[k];
				snprintf(text, size, "%s of %s", k ? "ST" : "S1", study->inputs[j].name);
			}
	}
}

static void write_halves(struct writer *w, const char *name, const struct pound_accuracy *accuracy,
                         const double half[POUND_LEVELS])
{
	writer_array(w, name, WRITER_LINE);
	for (int k = 0; k < POUND_LEVELS; k++)
		if (accuracy->rows[k] > 0)
			writer_number(w, NULL, half[k]);
	writer_end(w);
}

/* Writes the error estimates of one output of one cell.
 *
 * Test     unit_result_json: every_output_says_how_far_it_may_be_off
 */
void result_accuracy_output(struct writer *w, const struct pound_study *study,
                            const struct pound_indices *indices)
{
	const struct pound_accuracy *accuracy = &indices->accuracy;
	writer_object(w, "accuracy", WRITER_LINES);
	writer_whole(w, "runs_checked", accuracy->runs_checked);
	writer_whole(w, "runs_unchecked", accuracy->runs_unchecked);
	writer_number(w, "difference_median", accuracy->difference_median);
	writer_number(w, "difference_largest", accuracy->difference_largest);
	writer_number(w, "variance_share", accuracy->variance_share);
	writer_number(w, "slope", accuracy->slope.value);
	writer_number(w, "slope_low", accuracy->slope.low);
	writer_number(w, "slope_high", accuracy->slope.high);
	writer_number(w, "rows_to_halve",
	              isfinite(accuracy->rows_to_halve) ? ceil(accuracy->rows_to_halve) : NAN);
	writer_array(w, "rows", WRITER_LINE);
	for (int k = 0; k < POUND_LEVELS; k++)
		if (accuracy->rows[k] > 0)
			writer_whole(w, NULL, accuracy->rows[k]);
	writer_end(w);
	writer_array(w, "inputs", WRITER_LINES);
	for (int j = 0; j < study->n_inputs; j++) {
		writer_object(w, NULL, WRITER_LINE);
		writer_text(w, "name", study->inputs[j].name);
		writer_number(w, "S1_integration", accuracy->inputs[j].first_change);
		writer_number(w, "ST_integration", accuracy->inputs[j].total_change);
		writer_number(w, "S1_failed_rows", accuracy->inputs[j].first_dropped);
		writer_number(w, "ST_failed_rows", accuracy->inputs[j].total_dropped);
		write_halves(w, "S1_half_widths", accuracy, accuracy->inputs[j].first_half);
		write_halves(w, "ST_half_widths", accuracy, accuracy->inputs[j].total_half);
		writer_end(w);
	}
	writer_end(w);
	char index[160] = "";
	least_certain(study, accuracy, index, sizeof index);
	struct errors errors = {.excitation_low = accuracy->excitation_low};
	memcpy(errors.of, accuracy->errors, sizeof errors.of);
	write_errors(w, study, &errors, index);
	writer_end(w);
}

/* Writes the largest error estimates over all outputs and cells.
 *
 * Test     unit_result_json: every_output_says_how_far_it_may_be_off
 */
void result_accuracy_study(struct writer *w, const struct pound_study *study,
                           const struct pound_result *result)
{
	double median = NAN, largest = NAN;
	struct errors errors = {.excitation_low = NAN};
	int64_t checked = 0;
	for (int k = 0; k < POUND_ERROR_NONE; k++)
		errors.of[k] = NAN;
	for (int c = 0; c < result->n_cells; c++) {
		struct pound_scene scene;
		int64_t checked_of_cell = 0;
		study_cell(study, c, &scene);
		for (int o = 0; o < study->n_outputs; o++) {
			const struct pound_accuracy *accuracy = &result->cells[c].indices[o].accuracy;
			if (!study->elsewhere && !pound_output_applies(study->outputs[o], &scene))
				continue;
			if (accuracy->runs_checked > checked_of_cell)
				checked_of_cell = accuracy->runs_checked;
			median = fmax(median, accuracy->difference_median);
			largest = fmax(largest, accuracy->difference_largest);
			if (!(accuracy->errors[POUND_ERROR_SAMPLING] <= errors.of[POUND_ERROR_SAMPLING]))
				errors.excitation_low = accuracy->excitation_low;
			for (int k = 0; k < POUND_ERROR_NONE; k++)
				errors.of[k] = fmax(errors.of[k], accuracy->errors[k]);
		}
		checked += checked_of_cell;
	}
	writer_object(w, "accuracy", WRITER_LINES);
	if (!study->elsewhere)
		writer_text(w, "check",
		            "runs repeated with half the sample step; pounding can be chaotic, so single runs may "
		            "differ by rounding alone");
	writer_whole(w, "runs_checked", checked);
	writer_number(w, "difference_median", median);
	writer_number(w, "difference_largest", largest);
	write_errors(w, study, &errors, "");
	writer_end(w);
}

/* Writes the CPU time of n/8, n/4, n/2 and n rows. */
void result_accuracy_timing(struct writer *w, const struct pound_result *result, double cpu_s)
{
	const int *rows = result->cells[0].indices[0].accuracy.rows;
	writer_array(w, "rows", WRITER_LINE);
	for (int k = 0; k < POUND_LEVELS; k++) {
		if (!rows[k])
			continue;
		writer_object(w, NULL, WRITER_LINE);
		writer_whole(w, "rows", rows[k]);
		writer_number(w, "cpu_s", cpu_s * rows[k] / rows[POUND_LEVELS - 1]);
		writer_end(w);
	}
	writer_end(w);
}
