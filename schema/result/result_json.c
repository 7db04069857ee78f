/* result_json.c - writes a study's result as JSON, with the members that the OpenAPI document names. */
#include "schema/result/result_json.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "schema/json/json_writer.h"
#include "schema/result/result_accuracy.h"
#include "schema/result/result_design.h"
#include "schema/result/result_floor.h"
#include "schema/result/result_notes.h"
#include "schema/result/result_row.h"
#include "schema/result/result_separation.h"
#include "schema/result/result_suite.h"
#include "schema/study/fields.h"
#include "schema/study/study_json.h"
#include "schema/study/study_spectrum.h"
#include "schema/study/warnings.h"

/* ---- response ---- */

static const struct {
	const char *member, *name;
	int oscillator;
	size_t offset; /* in struct pound_response */
} measures[] = {
#define X(member, name, oscillator) {#member, name, oscillator, offsetof(struct pound_response, member)},
    POUND_MEASURES(X)
#undef X
};

enum { MEASURES = sizeof measures / sizeof measures[0] };

static bool at_end(int measure)
{
	return strncmp(measures[measure].member, "end_", 4) == 0;
}

/* The measures of one oscillator or of the pair (-1), over the motion or at its end. */
static void write_measures(struct writer *w, const struct pound_response *response, int oscillator, bool end)
{
	for (int k = 0; k < MEASURES; k++)
		if (measures[k].oscillator == oscillator && at_end(k) == end)
			writer_number(w, measures[k].name,
			              *(const double *)(const void *)((const char *)response + measures[k].offset));
}

static void write_signal(struct writer *w, const struct pound_cell *cell, int index)
{
	const struct pound_response *response = &cell->signals[index];
	writer_array(w, "oscillators", WRITER_LINES);
	for (int i = 0; i < POUND_OSCILLATORS; i++) {
		writer_object(w, NULL, WRITER_LINE);
		write_measures(w, response, i, false);
		writer_end(w);
	}
	writer_end(w);
	write_measures(w, response, -1, false);
	writer_object(w, "end", WRITER_LINE);
	write_measures(w, response, -1, true);
	writer_end(w);
}

/* The largest residual of the energy balances in n cells, and the number of responses with one; null: the solver has no energy
 * balance. */
static void write_balance(struct writer *w, const struct pound_cell *cells, int n)
{
	double residual = NAN;
	int known = 0;
	for (int c = 0; c < n; c++)
		for (int i = 0; i < cells[c].n_signals; i++) {
			const double one =
			    cells[c].rows ? cells[c].rows[i].energy_residual : cells[c].signals[i].energy_residual;
			residual = fmax(residual, one);
			known += !isnan(one);
		}
	writer_object(w, "accuracy", WRITER_LINES);
	writer_number(w, "energy_residual", residual);
	writer_whole(w, "energy_responses", known);
	writer_end(w);
}

static void write_outputs(struct writer *w, const struct pound_study *study, const struct pound_cell *cell,
                          const struct pound_scene *scene)
{
	writer_object(w, "outputs", WRITER_LINES);
	for (int o = 0; o < study->n_outputs; o++) {
		char name[STUDY_OUTPUT_SIZE];
		if (pound_output_applies(study->outputs[o], scene))
			writer_number(w, study_output_name(study, o, name), cell->outputs[o]);
	}
	writer_end(w);
}

static void write_response(struct writer *w, const struct pound_study *study, const struct pound_cell *cell,
                           const struct pound_scene *scene)
{
	if (cell->rows)
		result_row_modes(w, scene);
	writer_array(w, "signals", WRITER_LINES);
	for (int i = 0; i < cell->n_signals; i++) {
		writer_object(w, NULL, WRITER_LINES);
		writer_whole(w, "index", i);
		if (cell->records)
			result_suite_signal(w, &cell->records[i]);
		if (cell->rows)
			result_row_signal(w, scene, &cell->rows[i]);
		else
			write_signal(w, cell, i);
		writer_end(w);
	}
	writer_end(w);
	write_outputs(w, study, cell, scene);
	bool moves = false;
	for (int i = 0; i < cell->n_signals; i++)
		moves |= cell->rows ? result_row_moves(&cell->rows[i], scene)
		                    : cell->signals[i].displacement_max_free_1 != 0;
	if (cell->runs_failed && cell->runs_failed == cell->runs)
		writer_text(w, "note", "no run has a result, so there are no outputs; work.failures has the reasons");
	else if (cell->runs_failed)
		writer_text(w, "note", "failed runs are left out of the outputs; work.failures has the reasons");
	else if (!moves)
		writer_text(
		    w, "note",
		    "the left oscillator does not move without pounding, so ratios to that response are undefined");
	write_balance(w, cell, 1);
}

/* ---- sensitivity ---- */

#define X(name, text) text,
static const char *const index_names[] = {POUND_INDICES(X)};
static const char *const share_names[] = {POUND_SHARES(X)};
static const char *const named_forms[] = {POUND_NAMED(X)};
#undef X

void result_estimate(struct writer *w, const char *name, const struct pound_estimate *estimate)
{
	char member[64];
	writer_number(w, name, estimate->value);
	snprintf(member, sizeof member, "%s_low", name);
	writer_number(w, member, estimate->low);
	snprintf(member, sizeof member, "%s_high", name);
	writer_number(w, member, estimate->high);
}

/* Whether the noise-corrected variance, the denominator of all indices except the raw ones, may be 0. */
static bool lost_in_noise(const struct pound_indices *indices)
{
	return indices->notes >> POUND_NOTE_NOISE & 1;
}

static void write_excitation(struct writer *w, const struct pound_indices *indices)
{
	struct result_notes said;
	result_notes_init(&said);
	writer_object(w, "excitation", WRITER_LINE);
	for (int k = 0; k < POUND_N_SHARES; k++) {
		result_estimate(w, share_names[k], &indices->share[k]);
		result_notes_add(&said, share_names[k], &indices->share[k],
		                 (struct result_notes_source){.large_only = true});
	}
	result_notes_write(w, &said);
	writer_end(w);
}

/* The indices of the estimator that the study names. */
static void write_named(struct writer *w, const char *estimator, const struct pound_indices *indices, int j,
                        struct result_notes *said)
{
	for (int k = 0; k < POUND_N_NAMED; k++) {
		const bool corrected = k == POUND_NAMED_S1_CORRECTED || k == POUND_NAMED_ST_CORRECTED;
		char name[64];
		snprintf(name, sizeof name, named_forms[k], estimator);
		result_estimate(w, name, &indices->named[k][j]);
		result_notes_add(said, name, &indices->named[k][j],
		                 (struct result_notes_source){.lost = corrected && lost_in_noise(indices)});
	}
}

static void write_input(struct writer *w, const struct pound_study *study,
                        const struct pound_indices *indices, int j)
{
	const struct pound_input *input = &study->inputs[j];
	struct result_notes said;
	result_notes_init(&said);
	writer_object(w, NULL, WRITER_LINE);
	writer_text(w, "name", input->name);
	writer_text(w, "path", input->path);
	for (int k = 0; k < POUND_N_INDICES; k++) {
		const bool raw = k == POUND_S1_RAW || k == POUND_ST_RAW;
		result_estimate(w, index_names[k], &indices->index[k][j]);
		result_notes_add(&said, index_names[k], &indices->index[k][j],
		                 (struct result_notes_source){.lost = !raw && lost_in_noise(indices)});
	}
	if (study->design.estimator)
		write_named(w, pound_estimator_name(study->design.estimator), indices, j, &said);
	result_notes_write(w, &said);
	writer_end(w);
}

/* Indices of sets of inputs. */
struct sets {
	const char *name, *index; /* members: name of the list, name of the index */
	const struct pound_set_index *set;
	int n;
	struct result_notes_source source;
};

/* Writes indices of sets of inputs; nothing if the design gives none. */
static void write_sets(struct writer *w, const struct pound_study *study, const struct sets *sets)
{
	if (sets->n == 0)
		return;
	writer_array(w, sets->name, WRITER_LINES);
	for (int k = 0; k < sets->n; k++) {
		const struct pound_set_index *set = &sets->set[k];
		struct result_notes said;
		result_notes_init(&said);
		writer_object(w, NULL, WRITER_LINE);
		writer_array(w, "inputs", WRITER_LINE);
		for (int j = 0; j < study->n_inputs; j++)
			if (set->inputs >> j & 1)
				writer_text(w, NULL, study->inputs[j].name);
		writer_end(w);
		result_estimate(w, sets->index, &set->estimate);
		result_notes_add(&said, sets->index, &set->estimate, sets->source);
		result_notes_write(w, &said);
		writer_end(w);
	}
	writer_end(w);
}

/* Writes the indices of groups of inputs; nothing if none were requested. */
static void write_groups(struct writer *w, const struct pound_study *study,
                         const struct pound_indices *indices)
{
	const struct pound_group_indices *groups = &indices->groups;
	const struct result_notes_source source = {.lost = lost_in_noise(indices)};
	if (groups->n == 0)
		return;
	writer_array(w, "groups", WRITER_LINES);
	for (int g = 0; g < groups->n; g++) {
		struct result_notes said;
		result_notes_init(&said);
		writer_object(w, NULL, WRITER_LINE);
		writer_text(w, "name", study->groups[g].name);
		result_estimate(w, "S1", &groups->first[g]);
		result_estimate(w, "ST", &groups->total[g]);
		result_notes_add(&said, "S1", &groups->first[g], source);
		result_notes_add(&said, "ST", &groups->total[g], source);
		result_notes_write(w, &said);
		writer_end(w);
	}
	writer_end(w);
}

/* Writes the indices of ratios and of the remaining inputs; nothing if none were requested. */
static void write_ratios(struct writer *w, const struct pound_study *study,
                         const struct pound_indices *indices)
{
	const struct pound_ratio_indices *ratios = &indices->ratios;
	int rest[POUND_INPUTS_MAX];
	if (ratios->n == 0)
		return;
	pound_ratio_variables(study, rest);
	writer_object(w, "ratios", WRITER_LINES);
	result_estimate(w, "explained", &ratios->explained);
	if (isnan(ratios->explained.value))
		writer_text(
		    w, "note",
		    "too few rows to estimate the share of the variance that these variables explain; use more rows");
	writer_array(w, "variables", WRITER_LINES);
	for (int k = 0; k < ratios->n; k++) {
		const struct result_notes_source source = {.large_only = true};
		struct result_notes said;
		result_notes_init(&said);
		writer_object(w, NULL, WRITER_LINE);
		writer_text(w, "name",
		            k < study->n_ratios ? study->ratios[k].name
		                                : study->inputs[rest[k - study->n_ratios]].name);
		result_estimate(w, "shapley", &ratios->shapley[k]);
		result_estimate(w, "S1", &ratios->first[k]);
		result_estimate(w, "ST", &ratios->total[k]);
		result_notes_add(&said, "shapley", &ratios->shapley[k], source);
		result_notes_add(&said, "S1", &ratios->first[k], source);
		result_notes_add(&said, "ST", &ratios->total[k], source);
		result_notes_write(w, &said);
		writer_end(w);
	}
	writer_end(w);
	writer_end(w);
}

/* One member of every point of a curve. */
static void write_points(struct writer *w, const char *name, const struct pound_curve *curve, int n,
                         size_t member)
{
	writer_array(w, name, WRITER_LINE);
	for (int k = 0; k < n; k++)
		writer_number(w, NULL, *(const double *)(const void *)((const char *)&curve->mean[k] + member));
	writer_end(w);
}

static bool has_points(const struct pound_curve *curve)
{
	int k = 0;
	while (k < POUND_CURVE && isnan(curve->mean[k].value))
		k++;
	return k < POUND_CURVE;
}

/* Writes the mean output given each input; nothing if there are no curves. */
void result_curves(struct writer *w, const struct pound_study *study, const struct pound_curve *curves)
{
	if (!curves || !has_points(&curves[0]))
		return;
	writer_array(w, "conditional_means", WRITER_LINES);
	for (int j = 0; j < study->n_inputs; j++) {
		const struct pound_curve *curve = &curves[j];
		const struct pound_distribution *distribution = &study->inputs[j].distribution;
		const int n = pound_conditional_points(distribution);
		writer_object(w, NULL, WRITER_LINES);
		writer_text(w, "name", study->inputs[j].name);
		writer_text(w, "path", study->inputs[j].path);
		writer_array(w, "x", WRITER_LINE);
		for (int k = 0; k < n; k++)
			writer_number(w, NULL, pound_conditional_x(distribution, k));
		writer_end(w);
		write_points(w, "mean", curve, n, offsetof(struct pound_estimate, value));
		write_points(w, "low", curve, n, offsetof(struct pound_estimate, low));
		write_points(w, "high", curve, n, offsetof(struct pound_estimate, high));
		writer_end(w);
	}
	writer_end(w);
}

static void write_indices(struct writer *w, const struct pound_study *study,
                          const struct pound_indices *indices, int o)
{
	writer_object(w, NULL, WRITER_LINES);
	writer_text(w, "name", study->elsewhere ? study->output_names[o] : pound_output_name(study->outputs[o]));
	result_floor_ordinate(w, study, indices, o);
	result_row_place(w, study, o);
	writer_number(w, "mean", indices->mean);
	writer_number(w, "variance", indices->variance);
	writer_number(w, "noise_share", indices->noise_share);
	writer_number(w, "ratio_bias", indices->ratio_bias);
	result_notes_output(w, indices);
	write_excitation(w, indices);
	writer_array(w, "inputs", WRITER_LINES);
	for (int j = 0; j < study->n_inputs; j++)
		write_input(w, study, indices, j);
	writer_end(w);
	const struct pound_set_indices *sets = &indices->sets;
	const struct result_notes_source source = {.lost = lost_in_noise(indices), .large_only = true};
	write_sets(w, study, &(struct sets){"second_order", "S2", sets->second, sets->n_second, source});
	write_sets(w, study, &(struct sets){"closed", "S_closed", sets->closed, sets->n_closed, source});
	write_groups(w, study, indices);
	write_ratios(w, study, indices);
	result_curves(w, study, indices->curves);
	result_accuracy_output(w, study, indices);
	writer_end(w);
}

static void write_sensitivity(struct writer *w, const struct pound_study *study,
                              const struct pound_cell *cell, const struct pound_scene *scene)
{
	writer_array(w, "outputs", WRITER_LINES);
	for (int o = 0; o < study->n_outputs; o++)
		if (study->elsewhere || pound_output_applies(study->outputs[o], scene))
			write_indices(w, study, &cell->indices[o], o);
	writer_end(w);
}

/* ---- convergence ---- */

static void write_error(struct writer *w, const char *name, const struct pound_deviation *error)
{
	char member[48];
	snprintf(member, sizeof member, "%s_error_mean", name);
	writer_number(w, member, error->mean);
	snprintf(member, sizeof member, "%s_error_max", name);
	writer_number(w, member, error->largest);
}

/* The errors of one setting; the reference has none. */
static void write_trial(struct writer *w, const struct pound_trial *trial)
{
	writer_object(w, NULL, WRITER_LINE);
	writer_text(w, "method", pound_solver_name(trial->solver.method));
	writer_number(w, "step_s", trial->solver.step);
	writer_number(w, "tolerance", trial->solver.tolerance);
	writer_whole(w, "runs_failed", trial->runs_failed);
	write_error(w, "displacement", &trial->displacement);
	write_error(w, "demand", &trial->demand);
	write_error(w, "impulse", &trial->impulse);
	write_error(w, "history", &trial->history);
	writer_number(w, "order", trial->order);
	writer_end(w);
}

/* Trial 0 is the reference, trial 1 an independent check of the reference. */
static void write_trials(struct writer *w, const struct pound_result *result)
{
	writer_whole(w, "runs", result->cells[0].runs);
	writer_whole(w, "runs_failed", result->cells[0].runs_failed);
	if (result->trials[0].runs_failed * (int64_t)result->n_trials == result->cells[0].runs)
		writer_text(w, "note",
		            "the reference run failed, so there are no errors; work.failures has the reasons");
	writer_array(w, "rows", WRITER_LINES);
	for (int j = 0; j < result->n_trials; j++)
		write_trial(w, &result->trials[j]);
	writer_end(w);
	writer_object(w, "orders", WRITER_LINE);
	for (int row = 1; row < POUND_SOLVERS; row++)
		writer_number(w, pound_solver_name(row),
		              pound_convergence_order(result->trials, result->n_trials, row));
	writer_end(w);
	writer_object(w, "accuracy", WRITER_LINES);
	writer_text(w, "reference", pound_solver_name(result->trials[0].solver.method));
	writer_number(w, "second_opinion_displacement", result->trials[1].displacement.largest);
	writer_number(w, "second_opinion_impulse", result->trials[1].impulse.largest);
	writer_number(w, "second_opinion_history", result->trials[1].history.largest);
	writer_end(w);
}

/* CPU time per run of each trial. */
static void write_run_times(struct writer *w, const struct pound_result *result)
{
	writer_array(w, "run_cpu_s", WRITER_LINE);
	for (int j = 0; j < result->n_trials; j++)
		writer_number(w, NULL, result->trials[j].cpu);
	writer_end(w);
}

/* ---- cells ---- */

/* Requested outputs that do not exist in this cell. */
static void write_not_applicable(struct writer *w, const struct pound_study *study,
                                 const struct pound_scene *scene)
{
	int n = 0;
	for (int o = 0; o < study->n_outputs; o++)
		n += !pound_output_applies(study->outputs[o], scene);
	if (!n)
		return;
	writer_array(w, "not_applicable", WRITER_LINES);
	for (int o = 0; o < study->n_outputs; o++) {
		char note[128];
		if (pound_output_applies(study->outputs[o], scene))
			continue;
		snprintf(note, sizeof note, "needs %s", pound_output_needs(study->outputs[o], scene));
		writer_object(w, NULL, WRITER_LINE);
		writer_text(w, "name", pound_output_name(study->outputs[o]));
		writer_text(w, "note", note);
		writer_end(w);
	}
	writer_end(w);
}

static void write_cell(struct writer *w, const struct pound_study *study, const struct pound_result *result,
                       int c)
{
	const struct pound_cell *cell = &result->cells[c];
	struct pound_scene scene;
	void *row = NULL; // buildings of the cell
	study_cell(study, c, &scene);
	if (cell->rows) {
		row = malloc(pound_row_bytes(&study->scene));
		w->failed |= !row;
		if (!row)
			return;
		study_cell_row(study, c, row, &scene);
	}
	writer_whole(w, "runs", cell->runs);
	writer_whole(w, "runs_failed", cell->runs_failed);
	if (pound_study_sampled(study))
		writer_whole(w, "rows_dropped", cell->rows_dropped);
	if (study->kind == POUND_KIND_SEPARATION)
		result_separation_cell(w, study, &scene, result, c);
	if (pound_study_sampled(study))
		write_sensitivity(w, study, cell, &scene);
	else if (study->kind == POUND_KIND_SEPARATION)
		write_outputs(w, study, cell, &scene);
	else
		write_response(w, study, cell, &scene);
	if (!study->elsewhere)
		write_not_applicable(w, study, &scene);
	free(row);
}

static void write_cells(struct writer *w, const struct pound_study *study, const struct pound_result *result)
{
	writer_array(w, "cells", WRITER_LINES);
	for (int c = 0; c < result->n_cells; c++) {
		writer_object(w, NULL, WRITER_LINES);
		writer_object(w, "sweep", WRITER_LINE);
		for (int s = 0; s < study->n_sweeps; s++)
			study_value(w, study->sweeps[s].path, study->sweeps[s].path, result->cells[c].sweep[s]);
		writer_end(w);
		write_cell(w, study, result, c);
		writer_end(w);
	}
	writer_end(w);
}

/* ---- work ---- */

static void leave_out(struct writer *w, int64_t n, const char *what, const char *why)
{
	char sentence[200];
	if (n <= 0)
		return;
	snprintf(sentence, sizeof sentence, "%lld %s: %s", (long long)n, what, why);
	writer_text(w, NULL, sentence);
}

/* Runs that were not needed, in sentences, from the counts. */
static void write_left_out(struct writer *w, const struct pound_study *study, const struct pound_work *work)
{
	static const char repeated[] = "equal to one already made", unasked[] = "no output needs them";
	static const char linear[] = "linear responses without pounding",
	                  nonlinear[] = "nonlinear responses without pounding",
	                  with[] = "responses with pounding";
	int64_t made = work->pounding_runs.run + work->never_touching + work->moving_alike;
	writer_array(w, "left_out", WRITER_LINES);
	leave_out(w, work->signals.asked - work->signals.run, "ground motions", repeated);
	leave_out(w, work->free_runs.asked - work->free_runs.run, linear, repeated);
	leave_out(w, work->yield_given, linear, "the yield displacement is given");
	const bool row = study->scene.n_buildings > 0;
	leave_out(w, work->linear_unasked,
	          row ? "linear responses of other buildings without pounding"
	              : "linear responses of the right oscillator without pounding",
	          unasked);
	if (work->yield_runs.asked + work->nonlinear_unasked == 0)
		writer_text(w, NULL, "all nonlinear responses without pounding: no law needs them");
	leave_out(w, work->yield_runs.asked - work->yield_runs.run, nonlinear, repeated);
	leave_out(w, work->nonlinear_unasked,
	          row ? "last nonlinear responses of other buildings without pounding"
	              : "last nonlinear responses of the right oscillator without pounding",
	          unasked);
	leave_out(w, work->never_touching, with,
	          row ? "the responses without pounding never close a gap"
	              : "the responses without pounding never close the gap");
	leave_out(w, work->moving_alike, with,
	          row ? "equal buildings move together and never touch with force"
	              : "equal oscillators move together and never touch with force");
	if (!pound_study_pounds(study))
		writer_text(w, NULL, "all responses with pounding: no output needs them");
	else if (study->scene.contact.present)
		leave_out(w, work->pounding_runs.asked - made, with, repeated);
	else
		writer_text(w, NULL, "all responses with pounding: the scene has no contact");
	writer_end(w);
}

/* How the searches for yield displacements ended; nothing without searches. */
static void write_searches(struct writer *w, const struct pound_work *work)
{
	if (!work->yield_searches)
		return;
	writer_object(w, "yield_searches", WRITER_LINE);
	writer_text(w, "what", "yield displacements searched for the target demand");
	writer_whole(w, "searches", work->yield_searches);
	writer_whole(w, "jumps", work->yield_jumps);
	writer_whole(w, "corrections_used_up", work->yield_missed);
	if (work->yield_jumps + work->yield_missed)
		writer_text(w, "note",
		            "a search that did not end at the target demand uses the nearest demand found; if "
		            "corrections are used up, allow more");
	writer_end(w);
}

static void write_work(struct writer *w, const struct pound_study *study, const struct pound_work *work)
{
	writer_object(w, "work", WRITER_LINES);
#define X(member, text)                           \
	writer_object(w, #member, WRITER_LINE);       \
	writer_text(w, "what", text);                 \
	writer_whole(w, "asked", work->member.asked); \
	writer_whole(w, "run", work->member.run);     \
	writer_end(w);
	POUND_STAGES(X)
	if (work->free_pair_runs.asked) {
		X(free_pair_runs, study->scene.n_buildings ? "responses of all buildings together without pounding"
		                                           : "responses of both bodies together without pounding")
	}
	if (work->chain_runs.asked) {
		X(chain_runs,
		  "responses of both bodies again, for accelerations, forces, speeds, residuals or energies")
	}
#undef X
	writer_whole(w, "never_touching", work->never_touching);
	writer_whole(w, "moving_alike", work->moving_alike);
	writer_whole(w, "contacts", work->contacts);
	write_searches(w, work);
	result_failures(w, work);
	write_left_out(w, study, work);
	writer_end(w);
}

/* ---- the document ---- */

static void write_timing(struct writer *w, const struct pound_study *study, const struct pound_result *result,
                         const struct timing *timing)
{
	writer_object(w, "timing", WRITER_LINE);
	writer_number(w, "wall_s", timing->wall_s);
	writer_number(w, "cpu_s", timing->cpu_s);
	writer_whole(w, "threads", timing->threads);
	if (pound_study_sampled(study))
		result_accuracy_timing(w, result, timing->cpu_s);
	if (result->n_trials)
		write_run_times(w, result);
	writer_end(w);
}

/* Writes a result as JSON.
 *
 * Given    study     -         -       read by study_from_json
 *          result    -         -       of that study
 *          timing    -         s       NULL: no member "timing"
 * Returns  value     (length)  -       JSON; NULL: out of memory
 * Memory   allocates; the caller frees
 *
 * Test     unit_result_json
 */
char *result_to_json(const struct pound_study *study, const struct pound_result *result,
                     const struct timing *timing, size_t *length)
{
	struct writer w;
	char hash[STUDY_HASH_SIZE];
	*length = 0;
	if (!study_hash(study, hash))
		return NULL;
	writer_init(&w);
	writer_object(&w, NULL, WRITER_LINES);
	writer_text(&w, "kind", study_kind_name(study->kind));
	if (study->name)
		writer_text(&w, "name", study->name);
	writer_text(&w, "engine_version", POUND_VERSION);
	writer_text(&w, "study_hash", hash);
	writer_seed(&w, "seed", study->design.seed);
	if (pound_study_sampled(study))
		result_design(&w, study, result);
	warnings_write(&w, study, result);
	result_suite(&w, study, result);
	if (study->kind == POUND_KIND_CONVERGENCE)
		write_trials(&w, result);
	else if (study->kind == POUND_KIND_FLOOR_SPECTRUM)
		result_floor_spectra(&w, study, result);
	else if (study->kind == POUND_KIND_RESPONSE && study->n_sweeps == 0)
		write_cell(&w, study, result, 0);
	else
		write_cells(&w, study, result);
	if (study->kind == POUND_KIND_SEPARATION)
		result_separation_fragility(&w, study, result);
	if (!study->elsewhere)
		write_work(&w, study, &result->work);
	if (pound_study_sampled(study))
		result_accuracy_study(&w, study, result);
	else if (study->kind == POUND_KIND_RESPONSE && study->n_sweeps > 0)
		write_balance(&w, result->cells, result->n_cells);
	if (timing)
		write_timing(&w, study, result, timing);
	writer_end(&w);
	return writer_take(&w, length);
}
