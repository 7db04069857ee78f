/* pilot.c - chooses the number of signals per row of a study: a pilot of few rows, and the best split of the runs.
 *
 * 1. The pilot is a separate Latin hypercube of 32 to 128 rows with six signals each, at most a tenth of the runs unless 32 rows
 *    need more; its runs are not reused.
 * 2. Every S1 and ST of every output and cell gives its variance components (signal_split.c).  With n rows of R signals the half
 *    width is h(R, n)^2 = 1.96^2 (rows + signals / R + pairs / (R (R - 1))) / n + bias(R)^2.
 * 3. With a fixed number of runs N = n R samples the widest index decides.  If one index is widest for all R, and without bias,
 *    R = 1 + sqrt(pairs / rows) minimizes N h^2.  For a growing design, each R has a fewest number of rows with which no interval
 *    is wider than requested; the R of least cost is taken, or, if no R reaches the goal, the R that comes nearest.
 *
 * A row costs more than its runs because of the estimation of indices: ROW_RUNS runs per output. */
#include "engine/run/run.h"

#include <math.h>

#include "engine/indices/signal_split.h"

enum {
	PILOT_MOST = 128, /* rows */
	PILOT_SHARE = 10, /* of the runs */
	ROW_RUNS =
	    4, /* CPU time of the indices, per output, row and look, in runs of the reference scene: make bench */
};

static const int signals_of[POUND_SPLITS] = {2, 3, 4, 5, 6, 8, 10, 12, 16, 20, 25, 32};

static int64_t runs_of(const struct pound_study *study)
{
	return study->design.until.half_width > 0 ? study->design.until.max_runs : study->design.runs;
}

/* The pilot of a study. */
struct pound_study pound_pilot_study(const struct pound_study *study)
{
	struct pound_study pilot = *study;
	pilot.scene.excitation.signals = POUND_SPLIT_SIGNALS;
	pilot.design = (struct pound_design){.rows = 1,
	                                     .seed = study->design.seed ^ UINT64_C(0x9e3779b97f4a7c15),
	                                     .row = study->design.row,
	                                     .common_signals = study->design.common_signals};
	pilot.n_groups = pilot.n_ratios = 0;
	const int64_t rows = runs_of(study) / (PILOT_SHARE * pound_design_row_runs(&pilot));
	pilot.design.rows = rows < POUND_SPLIT_PILOT_LEAST ? POUND_SPLIT_PILOT_LEAST
	                    : rows > PILOT_MOST            ? PILOT_MOST
	                                                   : (int)rows;
	return pilot;
}

int pound_study_pilot_rows(const struct pound_study *study)
{
	return pound_pilot_study(study).design.rows;
}

int64_t pound_study_pilot_runs(const struct pound_study *study)
{
	const struct pound_study pilot = pound_pilot_study(study);
	return pilot.design.rows * pound_design_row_runs(&pilot);
}

/* Test     unit_pilot: a_split_study_is_the_study_with_that_split */
void pound_study_split(const struct pound_study *study, int signals, struct pound_study *as_split)
{
	const int64_t left = runs_of(study) - pound_study_pilot_runs(study);
	*as_split = *study;
	as_split->design.split = false;
	as_split->scene.excitation.signals = signals;
	if (study->design.until.half_width > 0) {
		as_split->design.until.max_runs = left > 0 ? (int)left : 0;
		return;
	}
	int64_t rows = left / pound_design_row_runs(as_split);
	rows = rows < POUND_ROWS_MAX ? rows : POUND_ROWS_MAX;
	as_split->design.rows = rows > 0 ? (int)rows : 0;
	as_split->design.runs = 0;
	// a Sobol' sequence is balanced with a power of two of rows in each scramble
	const int nets = pound_design_grouping(as_split).n;
	if (!pound_design_quasi_random(as_split->design.method))
		return;
	for (as_split->design.rows = nets; as_split->design.rows <= rows / 2;)
		as_split->design.rows *= 2;
}

/* Evaluation of a number of signals, over the indices taken so far. */
struct tried {
	struct pound_study study;
	int first, most; /* rows */
	double needed;   /* rows for the index that needs most */
	double error;    /* squared half width of the widest index, with the most rows */
	struct pound_look worst;
	struct pound_split_parts parts;
};

/* Takes an index into account. */
static void tried_take(struct tried *t, const struct pound_split_parts *parts, const struct pound_look *at)
{
	const int r = t->study.scene.excitation.signals;
	const double wanted = t->study.design.until.half_width, bias = pound_split_bias(parts, r);
	const double variance = POUND_NORMAL_95 * POUND_NORMAL_95 * pound_split_variance(parts, r);
	const double error = variance / t->most + bias * bias;
	const double allowed = wanted * wanted - bias * bias;
	const double needed = wanted > 0.0 && allowed > 0.0 ? variance / allowed : INFINITY;
	t->needed = fmax(t->needed, needed);
	if (error > t->error) {
		t->error = error;
		t->worst = *at;
		t->parts = *parts;
	}
}

/* Takes the indices of an output in a cell of the pilot. */
static void output_take(struct pound_run *pilot, int cell, int output, struct tried tried[POUND_SPLITS],
                        double *scratch)
{
	const struct pound_cells *c = &pilot->campaign;
	const int d = c->study->n_inputs;
	const size_t n = pound_cells_values_size(c, pilot->rows);
	const struct pound_sampling sampling = pound_run_sampling(pilot);
	struct pound_split_parts parts[2 * POUND_INPUTS_MAX];
	struct pound_sample_values values = pound_cells_values(c, pilot->rows, scratch);
	values.stop = pilot->stop;
	pound_run_columns(pilot, cell, output, scratch, scratch + n);
	pound_split_estimate(&values, &sampling, c->study->design.seed, scratch + 2 * n, parts);
	for (int i = 0; i < 2 * d; i++) {
		const struct pound_look at = {
		    .cell = cell, .output = output, .input = i % d, .index = i < d ? POUND_S1 : POUND_ST};
		for (int k = 0; k < POUND_SPLITS && !isnan(parts[i].rows); k++)
			if (tried[k].first >= POUND_ROWS_MIN)
				tried_take(&tried[k], &parts[i], &at);
	}
}

/* Predicted number of rows with a number of signals; reached: with these rows every interval is narrow enough. */
static double rows_foreseen(const struct tried *t, bool *reached)
{
	*reached = t->needed <= t->most;
	return *reached ? fmax(t->needed, t->first) : t->most;
}

/* Chooses the best number of signals.
 *
 * Returns  split   choices, and the index that decided
 */
static void choose(const struct tried tried[POUND_SPLITS], struct pound_split *split)
{
	double best[2] = {INFINITY, INFINITY};
	for (int k = 0; k < POUND_SPLITS; k++) {
		const struct tried *t = &tried[k];
		if (t->first < POUND_ROWS_MIN)
			continue;
		bool reached;
		const double rows = rows_foreseen(t, &reached);
		const double samples = (double)pound_design_row_runs(&t->study),
		             bias = pound_split_bias(&t->parts, signals_of[k]);
		const double half = sqrt((t->error - bias * bias) * t->most / rows + bias * bias);
		split->choices[split->n_choices++] = (struct pound_split_choice){
		    signals_of[k], (int)ceil(rows), half, fabs(bias), (int64_t)(ceil(rows) * samples)};
		const double cells = samples / (pound_design_samples(&t->study) * signals_of[k]);
		const double cost = reached ? rows * (samples + cells * ROW_RUNS * t->study.n_outputs) : t->error;
		if (!(cost < best[reached]) || (!reached && best[true] < INFINITY))
			continue;
		best[reached] = cost;
		split->signals = signals_of[k];
		split->decided_by = t->worst;
		split->decided_by.rows = (int)ceil(rows);
		split->decided_by.half_width = half;
		split->between = t->parts.rows;
		split->within = t->parts.signals;
		split->pairs = t->parts.pairs;
	}
}

static bool awaited(const struct pound_study *study, int output, const struct pound_scene *scene)
{
	const int one = study->design.until.output;
	return pound_output_applies(study->outputs[output], scene) &&
	       (one == 0 || study->outputs[output] == one - 1);
}

size_t pound_pilot_scratch(const struct pound_run *pilot)
{
	const struct pound_cells *c = &pilot->campaign;
	const struct pound_sample_values shape = pound_cells_values(c, c->n_rows, NULL);
	return 2 * pound_cells_values_size(c, c->n_rows) + pound_split_scratch(&shape);
}

/* Runs the pilot of a study whose design is split, and takes the best split.
 *
 * Given    pilot     -                       of pound_pilot_study(&run->study), not run yet
 * Returns  run       -                       the study with its number of signals; the split in the result
 * Status   POUND_STOPPED  stop was set
 * Memory   scratch   (pound_pilot_scratch)
 * Test     unit_pilot
 */
enum pound_status pound_pilot_run(struct pound_run *run, struct pound_run *pilot, double *scratch)
{
	const struct pound_study given = run->study;
	const struct pound_cells *c = &pilot->campaign;
	struct pound_split *split = &run->result.split;
	struct tried tried[POUND_SPLITS];
	*split = (struct pound_split){.pilot_rows = c->n_rows, .pilot_runs = pound_study_pilot_runs(&given)};
	for (int b = 0; b < pound_run_blocks(pilot); b++) {
		const enum pound_status status = pound_run_block(pilot, b, 0);
		if (status)
			return status;
	}
	for (int k = 0; k < POUND_SPLITS; k++) {
		tried[k] = (struct tried){.worst.half_width = -1.0};
		pound_study_split(&given, signals_of[k], &tried[k].study);
		tried[k].first = pound_design_rows(&tried[k].study, 0);
		tried[k].most = pound_design_rows_most(&tried[k].study);
	}
	for (int cell = 0; cell < c->n_cells; cell++) {
		const struct pound_scene scene = pound_cells_scene(c, cell, 0, 0, NULL);
		for (int o = 0; o < given.n_outputs && !pound_stopped(pilot->stop); o++)
			if (awaited(&given, o, &scene))
				output_take(pilot, cell, o, tried, scratch);
	}
	if (pound_stopped(pilot->stop))
		return POUND_STOPPED;
	choose(tried, split);
	pound_study_split(&given, split->signals, &run->study);
	// a look takes time: first at 1/8 of the predicted rows; fewer than predicted may do, as residuals of polynomials shrink
	if (given.design.until.half_width > 0)
		run->study.design.rows = (int)fmax(given.design.rows, split->decided_by.rows / 8);
	split->rows = run->study.design.rows;
	return POUND_OK;
}
