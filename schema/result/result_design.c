/* result_design.c - the rows of a sensitivity result: all, as many as were enough, or the first ones so far. */
#include "schema/result/result_design.h"

#include <math.h>
#include <stdio.h>

#include "schema/study/study_json.h"
#include "schema/study/study_spectrum.h"

#define X(name, text) text,
static const char *const index_names[] = {POUND_INDICES(X)};
#undef X

/* The study as run: with the number of signals that the engine chose, if it did. */
static struct pound_study as_run_of(const struct pound_study *study, const struct pound_result *result)
{
	struct pound_study as_run = *study;
	if (result->split.signals)
		pound_study_split(study, result->split.signals, &as_run);
	return as_run;
}

static bool grows(const struct pound_study *study)
{
	return study->design.until.half_width > 0;
}

/* Whether more rows will follow; results of external models are never partial. */
static bool partial(const struct pound_study *study, const struct pound_result *result)
{
	if (study->elsewhere)
		return false;
	return grows(study) ? result->n_looks == 0 : result->rows < study->design.rows;
}

static int64_t runs_of(const struct pound_study *study, int rows)
{
	return rows * pound_design_row_runs(study);
}

static void write_look(struct writer *w, const char *name, const struct pound_study *study,
                       const struct pound_result *result, const struct pound_look *look)
{
	const struct pound_cell *cell = &result->cells[look->cell];
	char output[STUDY_OUTPUT_SIZE];
	writer_object(w, name, WRITER_LINE);
	writer_whole(w, "rows", look->rows);
	writer_whole(w, "runs", runs_of(study, look->rows));
	writer_number(w, "half_width", look->half_width < 0 ? NAN : look->half_width);
	if (look->half_width >= 0) {
		writer_text(w, "index", index_names[look->index]);
		writer_text(w, "input", study->inputs[look->input].name);
		writer_text(w, "output", study_output_name(study, look->output, output));
		writer_object(w, "sweep", WRITER_LINE);
		for (int s = 0; s < study->n_sweeps; s++)
			study_value(w, study->sweeps[s].path, study->sweeps[s].path, cell->sweep[s]);
		writer_end(w);
	}
	writer_end(w);
}

/* Why the engine chose this number of signals: variances from the pilot, and the predicted half-width for each number of signals. */
static void write_split(struct writer *w, const struct pound_study *study, const struct pound_result *result)
{
	const struct pound_split *split = &result->split;
	char note[600], output[STUDY_OUTPUT_SIZE];
	writer_object(w, "signals", WRITER_LINES);
	writer_whole(w, "signals", split->signals);
	writer_object(w, "pilot", WRITER_LINE);
	writer_whole(w, "rows", split->pilot_rows);
	writer_whole(w, "runs", split->pilot_runs);
	writer_end(w);
	writer_object(w, "variance", WRITER_LINE);
	writer_number(w, "between_rows", split->between);
	writer_number(w, "within_rows", split->within);
	writer_number(w, "pairs_of_signals", split->pairs);
	writer_end(w);
	if (split->decided_by.half_width >= 0)
		write_look(w, "decided_by", study, result, &split->decided_by);
	writer_array(w, "choices", WRITER_LINES);
	for (int k = 0; k < split->n_choices; k++) {
		const struct pound_split_choice *choice = &split->choices[k];
		writer_object(w, NULL, WRITER_LINE);
		writer_whole(w, "signals", choice->signals);
		writer_whole(w, "rows", choice->rows);
		writer_whole(w, "runs", choice->runs);
		writer_number(w, "half_width", choice->half_width);
		writer_number(w, "bias", choice->bias);
		writer_end(w);
	}
	writer_end(w);
	if (split->decided_by.half_width < 0)
		snprintf(
		    note, sizeof note,
		    "the pilot found no variance beyond the noise of signals, so the number of signals is a guess");
	else
		snprintf(
		    note, sizeof note,
		    "with %d signals %s; the widest predicted interval is %s of input %s, output %s. Its "
		    "variance from n rows of R signals is (between_rows + within_rows / R + pairs_of_signals / (R (R "
		    "- 1))) / n",
		    split->signals,
		    grows(study) ? "every interval is predicted to be narrow enough at the least cost"
		                 : "the widest interval is predicted to be the narrowest for these runs",
		    index_names[split->decided_by.index], study->inputs[split->decided_by.input].name,
		    study_output_name(study, split->decided_by.output, output));
	writer_text(w, "note", note);
	writer_end(w);
}

/* Why the design stopped growing, and the widest interval at that point. */
static void write_growth(struct writer *w, const struct pound_study *study, const struct pound_result *result)
{
	const struct pound_until *until = &study->design.until;
	const struct pound_look *last = &result->looks[result->n_looks - 1];
	const bool reached = last->half_width <= until->half_width;
	const bool order = until->goal == POUND_GOAL_ORDER;
	char note[500], output[STUDY_OUTPUT_SIZE], of[STUDY_OUTPUT_SIZE + 16] = "";
	if (until->output)
		snprintf(of, sizeof of, " of output %s", pound_output_name(until->output - 1));
	const char *which = order ? "interval of ST that overlaps another input's" : "interval of S1 and ST";
	int n =
	    snprintf(note, sizeof note, "%s%severy %s%s has a half-width of at most %.3g",
	             reached ? "" : "max_runs allows no more rows, and not ",
	             reached && order && last->half_width < 0 ? "the order of the inputs by ST is certain: " : "",
	             which, of, until->half_width);
	if (last->half_width >= 0)
		snprintf(note + n, sizeof note - (size_t)n,
		         "; the widest is the interval of %s of input %s, output %s", index_names[last->index],
		         study->inputs[last->input].name, study_output_name(study, last->output, output));
	writer_number(w, "half_width", until->half_width);
	writer_whole(w, "max_runs", until->max_runs);
	if (order)
		writer_text(w, "goal", "order");
	if (until->output)
		writer_text(w, "output", pound_output_name(until->output - 1));
	writer_bool(w, "reached", reached);
	writer_whole(w, "rows", last->rows);
	writer_whole(w, "runs", runs_of(study, last->rows));
	write_look(w, "decided_by", study, result, last);
	writer_array(w, "looks", WRITER_LINES);
	for (int k = 0; k < result->n_looks; k++)
		write_look(w, NULL, study, result, &result->looks[k]);
	writer_end(w);
	writer_text(w, "note", note);
}

/* A note about a design: Sobol' points are most uniform if each randomisation has a power of two of them.
 *
 * Test     unit_result_json: points_that_do_not_fill_their_nets_are_noted
 */
bool result_design_note(const struct pound_study *study, char *text, size_t size)
{
	const struct pound_design *design = &study->design;
	int full = design->randomisations;
	*text = 0;
	if (grows(study) && study->elsewhere)
		snprintf(text, size, "the design grows: these are its first %d rows; a run takes up to %d",
		         pound_design_rows(study, 0), pound_design_rows_most(study));
	if (grows(study) || !pound_design_quasi_random(design->method))
		return *text;
	while (full < design->rows)
		full *= 2;
	if (full != design->rows)
		snprintf(text, size,
		         "%d rows are not a power of two for each of %d randomisations, so the points are less "
		         "uniform and the intervals wider than they could be; use %d or %d rows",
		         design->rows, design->randomisations, full / 2, full);
	return *text;
}

/* Writes the members `design`, `partial` (of an intermediate result) and `stopping` (of a growing design).
 *
 * Test     unit_result_json: a_result_says_why_its_design_grew_no_further
 */
void result_design(struct writer *w, const struct pound_study *asked, const struct pound_result *result)
{
	const struct pound_study as_run = as_run_of(asked, result), *study = &as_run;
	const bool nets = pound_design_quasi_random(study->design.method);
	char note[RESULT_NOTE_SIZE];
	writer_object(w, "design", WRITER_LINE);
	writer_text(w, "method", pound_design_name(study->design.method));
	writer_whole(w, "rows", result->rows);
	if (result->split.signals)
		writer_whole(w, "signals", result->split.signals);
	if (nets)
		writer_whole(w, "randomisations", study->design.randomisations);
	if (result_design_note(study, note, sizeof note))
		writer_text(w, "note", note);
	writer_end(w);
	if (partial(study, result)) {
		const bool all = result->rows_done <= result->rows;
		writer_object(w, "partial", WRITER_LINE);
		writer_whole(w, "rows", result->rows);
		writer_whole(w, "rows_most", pound_design_rows_most(study));
		writer_whole(w, "rows_done", all ? result->rows : result->rows_done);
		writer_text(
		    w, "note",
		    all ? "result of the rows that were complete when it was made, not of the whole study"
		        : "result of the first rows, so that it comes at once; the result of all complete rows "
		          "is being made: ask again in a few seconds");
		writer_end(w);
	} else if (result->n_looks || result->split.signals) {
		writer_object(w, "stopping", WRITER_LINES);
		if (result->split.signals)
			write_split(w, study, result);
		if (result->n_looks)
			write_growth(w, study, result);
		writer_end(w);
	}
}
