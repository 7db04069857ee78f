/* unit_growth.c - designs that grow until their intervals are narrow, and results of the first rows: with functions
 * in place of simulations, and with whole studies. */
#include "engine/design/design.h"
#include "engine/pound.h"
#include "schema/study/study_json.h"
#include "tests/support/check.h"
#include "tests/support/functions.h"
#include "tests/support/scenes.h"
#include "tests/support/study_documents.h"

#include <malloc.h>
#include <math.h>
#include <string.h>

enum { D = FUNCTION_INPUTS, SAMPLES = D + 2 };

// designs per coverage; fewer under sanitizers, which are slow
#if defined __SANITIZE_ADDRESS__ || defined __SANITIZE_THREAD__
enum { SEEDS = 6 };
#else
enum { SEEDS = 40 };
#endif

static int method_named(const char *name)
{
	int row = 0;
	while (strcmp(pound_design_name(row), name))
		row++;
	return row;
}

/* A study of a function's four inputs, run here. */
static struct pound_study study_of(const char *method, int rows, uint64_t seed, double half_width,
                                   int max_runs)
{
	static char *names[] = {"y", NULL};
	const struct pound_design design = {
	    .method = method_named(method), .rows = rows, .seed = seed, .until = {half_width, max_runs}};
	struct pound_study study = function_study(&design);
	study.elsewhere = true;
	study.n_outputs = 1;
	study.output_names = names;
	return study;
}

static void assign(struct pound_run *run, const struct function *f, int first)
{
	for (int row = first; row < pound_run_rows(run); row++)
		for (int sample = 0; sample < SAMPLES; sample++) {
			double x[D];
			pound_run_sample_inputs(run, row, sample, x);
			pound_run_sample_assign(run, row, sample, 0, f->y(x), NAN);
		}
}

/* Runs the function's study from start to end; the caller frees the run. */
static struct pound_run *run_of(const struct pound_study *study, const char *function)
{
	struct pound_run *run = pound_run_create(study, 1);
	int first = 0;
	do {
		assign(run, function_named(function), first);
		first = pound_run_rows(run);
		assert_int_equal(pound_run_reduce(run, 0, 0), POUND_OK);
	} while (pound_run_grow(run));
	return run;
}

static double half_of(struct pound_estimate e)
{
	return 0.5 * (e.high - e.low);
}

static double widest_of(const struct pound_result *result)
{
	double widest = 0;
	for (int j = 0; j < D; j++) {
		widest = fmax(widest, half_of(result->cells[0].indices[0].index[POUND_S1][j]));
		widest = fmax(widest, half_of(result->cells[0].indices[0].index[POUND_ST][j]));
	}
	return widest;
}

static const char *const methods[] = {"lhs", "random", "sobol"};

static void a_design_grows_by_whole_batches_and_by_doubling(void **state)
{
	(void)state;
	static const struct {
		const char *method;
		int rows, max_runs, looks[5], most;
	} cases[] = {
	    // 6 runs per row
	    {"lhs", 1000, 60000, {1000, 1200, 1400, 1600, 1800}, 10000},
	    {"lhs", 2, 60000, {1000, 1200, 1400, 1600, 1800}, 10000},
	    {"lhs", 1234, 60000, {1300, 1500, 1700, 1900, 2100}, 10000},
	    {"lhs", 5000, 9000, {1500, 1500, 1500, 1500, 1500}, 1500},
	    {"lhs", 1000, 7000, {1000, 1100, 1100, 1100, 1100}, 1100},
	    {"lhs", 1000, 3000, {500, 500, 500, 500, 500}, 500}, // ten batches of 50
	    {"lhs", 1000, 599, {0, 0, 0, 0, 0}, 0},
	    {"random", 1000, 60000, {1000, 1200, 1400, 1600, 1800}, 10000},
	    {"sobol", 2, 60000, {128, 256, 512, 1024, 2048}, 8192},
	    {"sobol", 500, 6000, {512, 512, 512, 512, 512}, 512},
	    {"sobol", 500, 6144, {512, 1024, 1024, 1024, 1024}, 1024},
	    {"sobol", 5000, 800, {128, 128, 128, 128, 128}, 128},
	    {"sobol", 2, 767, {0, 0, 0, 0, 0}, 0},
	};
	for (size_t k = 0; k < sizeof cases / sizeof cases[0]; k++) {
		const struct pound_study study = study_of(cases[k].method, cases[k].rows, 1, 0.1, cases[k].max_runs);
		for (int look = 0; look < 5; look++)
			assert_int_equal(pound_design_rows(&study, look), cases[k].looks[look]);
		assert_int_equal(pound_design_rows_most(&study), cases[k].most);
	}
	const struct pound_study study = study_of("lhs", 77, 1, 0, 100);
	assert_int_equal(pound_design_rows(&study, 3), 77);
}

static void a_grown_design_keeps_its_rows(void **state)
{
	(void)state;
	for (int m = 0; m < 3; m++) {
		const struct pound_study less = study_of(methods[m], 2, 5, 0.1, 9000),
		                         more = study_of(methods[m], 2, 5, 0.01, 30000);
		int rows = pound_design_rows_most(&less);
		assert_true(pound_design_rows_most(&more) > rows);
		double *u = malloc(sizeof *u * 2 * D * (size_t)rows),
		       *v = malloc(sizeof *v * 2 * D * (size_t)pound_design_rows_most(&more));
		pound_design_probabilities(&less, NULL, u);
		pound_design_probabilities(&more, NULL, v);
		assert_memory_equal(u, v, sizeof *u * 2 * D * (size_t)rows);
		free(u), free(v);
	}
}

static void a_design_stops_at_the_first_look_that_finds_every_interval_narrow(void **state)
{
	(void)state;
	static const double half_widths[] = {0.008, 0.008, 0.01};
	for (int m = 0; m < 3; m++) {
		const struct pound_study study = study_of(methods[m], 2, 3, half_widths[m], 60000);
		struct pound_run *run = run_of(&study, "cusp");
		const struct pound_result *result = pound_run_result(run);
		const struct pound_look *last = &result->looks[result->n_looks - 1];
		assert_true(result->n_looks > 1);
		for (int k = 0; k < result->n_looks; k++) {
			assert_int_equal(result->looks[k].rows, pound_design_rows(&study, k));
			assert_true((result->looks[k].half_width <= half_widths[m]) == (k == result->n_looks - 1));
		}
		assert_int_equal(result->rows, last->rows);
		assert_int_equal(result->cells[0].runs, last->rows * SAMPLES);
		check_near(last->half_width, widest_of(result), 0);
		const struct pound_estimate *decider = result->cells[0].indices[0].index[last->index];
		check_near(half_of(decider[last->input]), last->half_width, 0);
		pound_run_free(run);
	}
}

static void max_runs_ends_a_design_that_is_not_narrow_yet(void **state)
{
	(void)state;
	for (int m = 0; m < 3; m++) {
		const struct pound_study study = study_of(methods[m], 2, 3, 1e-6, 9000);
		struct pound_run *run = run_of(&study, "cusp");
		const struct pound_result *result = pound_run_result(run);
		assert_int_equal(result->rows, pound_design_rows_most(&study));
		assert_true(result->rows * SAMPLES <= 9000);
		assert_true(result->looks[result->n_looks - 1].half_width > 1e-6);
		pound_run_free(run);
	}
}

static double constant(const double *u)
{
	(void)u;
	return 1.5;
}

static void nobody_waits_for_the_indices_of_a_constant(void **state)
{
	(void)state;
	const struct function flat = {.name = "flat", .y = constant};
	const struct pound_study study = study_of("sobol", 2, 3, 0.01, 60000);
	struct pound_run *run = pound_run_create(&study, 1);
	assign(run, &flat, 0);
	assert_int_equal(pound_run_reduce(run, 0, 0), POUND_OK);
	assert_false(pound_run_grow(run));
	check_near(pound_run_result(run)->looks[0].half_width, -1, 0);
	pound_run_free(run);
}

static void a_grown_sobol_design_has_the_indices_of_one_of_that_size_from_the_start(void **state)
{
	(void)state;
	const struct pound_study grown = study_of("sobol", 2, 9, 0.03, 60000);
	struct pound_run *run = run_of(&grown, "g_a");
	int rows = pound_run_rows(run);
	assert_true(rows > 128);
	const struct pound_study whole = study_of("sobol", rows, 9, 0, 0);
	struct pound_run *other = run_of(&whole, "g_a");
	const struct pound_indices *p = pound_run_result(run)->cells[0].indices,
	                           *q = pound_run_result(other)->cells[0].indices;
	for (int k = 0; k < POUND_N_INDICES; k++)
		assert_memory_equal(p->index[k], q->index[k], sizeof *p->index[k] * D);
	pound_run_free(run), pound_run_free(other);
}

/* Fraction of the 8 indices within their intervals when the design stops growing, over seeds. */
static double coverage_at_stop(const char *method, const char *function, double half_width, int seeds)
{
	const struct function *f = function_named(function);
	int within = 0;
	for (int seed = 1; seed <= seeds; seed++) {
		const struct pound_study study = study_of(method, 2, (uint64_t)seed, half_width, 60000);
		struct pound_run *run = run_of(&study, function);
		const struct pound_indices *indices = pound_run_result(run)->cells[0].indices;
		for (int j = 0; j < 2 * D; j++) {
			struct pound_estimate e = indices->index[j < D ? POUND_S1 : POUND_ST][j % D];
			within += e.low <= f->index[j] && f->index[j] <= e.high;
		}
		pound_run_free(run);
	}
	return within / (2. * D * seeds);
}

static void intervals_cover_where_a_design_has_stopped(void **state)
{
	(void)state;
	// 8 indices per design, nominal 95 %, as if two of them were independent: 3.5 standard deviations
	const double allowed = 3.5 * sqrt(0.95 * 0.05 / (2 * SEEDS));
	check_near(coverage_at_stop("sobol", "cusp", 0.03, SEEDS), 0.95, allowed);
	check_near(coverage_at_stop("sobol", "steps", 0.08, SEEDS), 0.95, allowed);
}

/* ---- whole studies ---- */

static const char document[] =
    "{\"kind\": \"sensitivity\", \"scene\": {\"oscillators\": [{\"frequency_hz\": 2}, {\"frequency_hz\": "
    "3.1}],\n"
    " \"excitation\": {\"frequency_hz\": 5, \"cycles\": 4, \"signals\": 3}},\n"
    " \"inputs\": [{\"path\": \"/oscillators/1/frequency_hz\", \"distribution\": {\"type\": \"uniform\", "
    "\"min\": 0.5, "
    "\"max\": 5}},\n"
    "  {\"path\": \"/contact/restitution\", \"distribution\": {\"type\": \"uniform\", \"min\": 0, \"max\": "
    "1}}],\n"
    " \"sweep\": [{\"path\": \"/oscillators/0/frequency_hz\", \"values\": [1, 2]}],\n"
    " \"design\": {\"method\": \"random\", \"rows\": 150}}";

static struct pound_study *study_with(const char *design)
{
	char *text = study_documents_with(document, "\"method\": \"random\", \"rows\": 150", design);
	struct pound_study *study = study_documents_study(text);
	free(text);
	return study;
}

static void a_block_ends_where_the_design_is_looked_at(void **state)
{
	(void)state;
	static const char *const designs[] = {
	    "\"method\": \"lhs\", \"until\": {\"half_width\": 0.1, \"max_runs\": 40000}",
	    "\"method\": \"sobol\", \"until\": {\"half_width\": 0.1, \"max_runs\": 40000}"};
	for (int k = 0; k < 2; k++) {
		struct pound_study *study = study_with(designs[k]);
		struct pound_run *run = pound_run_create(study, 1);
		int64_t runs = 0;
		int block = 0, look = 0;
		for (; pound_design_rows(study, look) < pound_design_rows_most(study); look++) {
			pound_run_rows_take(run, pound_design_rows(study, look));
			for (; block < pound_run_blocks(run); block++)
				runs += pound_run_block_runs(run, block);
			assert_int_equal(runs, pound_design_rows(study, look) * pound_design_row_runs(study));
		}
		assert_true(look > 1);
		pound_run_free(run);
		study_free(study);
	}
}

static void check_same_indices(const struct pound_study *study, const struct pound_result *p,
                               const struct pound_result *q)
{
	for (int cell = 0; cell < p->n_cells; cell++)
		for (int o = 0; o < study->n_outputs; o++)
			for (int k = 0; k < POUND_N_INDICES; k++)
				assert_memory_equal(p->cells[cell].indices[o].index[k], q->cells[cell].indices[o].index[k],
				                    sizeof(struct pound_estimate) * (size_t)study->n_inputs);
}

static void an_intermediate_result_has_whole_rows_only(void **state)
{
	(void)state;
	struct pound_study *study = study_with("\"method\": \"random\", \"rows\": 150");
	struct pound_run *run = pound_run_create(study, 1);
	const int n_blocks = pound_run_blocks(run), missing = n_blocks / 2;
	bool *done = calloc((size_t)pound_run_blocks_most(run), sizeof *done);
	int64_t runs = 0;
	assert_true(n_blocks > 3 && pound_run_blocks_most(run) == n_blocks);
	assert_int_equal(pound_run_rows_done(run, done), 0);
	for (int b = n_blocks - 1; b >= 0; b--)
		if (b != missing) {
			assert_int_equal(pound_run_block(run, b, 0), POUND_OK);
			done[b] = true;
			runs += b < missing ? pound_run_block_runs(run, b) : 0;
		}
	const int rows = pound_run_rows_done(run, done);
	// 24 runs per row; the missing block begins within a row
	assert_int_equal(rows, runs / pound_design_row_runs(study));
	assert_true(runs % pound_design_row_runs(study) > 0);
	pound_run_rows_take(run, rows);
	for (int k = 0; k < pound_run_reductions(run); k++)
		assert_int_equal(pound_run_reduce(run, k, 0), POUND_OK);
	const struct pound_result *result = pound_run_result(run);
	assert_int_equal(result->rows, rows);
	assert_int_equal(result->cells[0].runs, rows * 12);

	// the rows of a random design begin with those of a shorter one
	struct pound_study *shorter = study_with("\"method\": \"random\", \"rows\": 150");
	shorter->design.rows = rows;
	struct pound_run *whole = specimen_run(shorter);
	check_same_indices(study, result, pound_run_result(whole));
	pound_run_free(run), pound_run_free(whole);
	study_free(study), study_free(shorter);
	free(done);
}

/* The reductions of a view come between the blocks of its run, and change nothing of the run's result. */
static void a_view_has_the_result_of_its_rows_while_the_run_goes_on(void **state)
{
	(void)state;
	struct pound_study *study = study_with("\"method\": \"random\", \"rows\": 150");
	struct pound_run *run = pound_run_create(study, 1);
	const int n_blocks = pound_run_blocks(run);
	bool *done = calloc((size_t)pound_run_blocks_most(run), sizeof *done);
	for (int b = 0; b < n_blocks / 2; b++) {
		assert_int_equal(pound_run_block(run, b, 0), POUND_OK);
		done[b] = true;
	}
	struct pound_run *view = pound_run_view(run, 2, NULL);
	const int rows = pound_run_rows_done(run, done), few = rows / 2;
	assert_true(few >= 30);
	pound_run_rows_take(view, few);
	pound_run_rows_complete(view, rows);
	for (int k = 0; k < pound_run_reductions(view); k++) {
		assert_int_equal(pound_run_reduce(view, k, k % 2), POUND_OK);
		if (n_blocks / 2 + k < n_blocks)
			assert_int_equal(pound_run_block(run, n_blocks / 2 + k, 0), POUND_OK);
	}
	for (int b = n_blocks / 2 + pound_run_reductions(view); b < n_blocks; b++)
		assert_int_equal(pound_run_block(run, b, 0), POUND_OK);
	const struct pound_result *result = pound_run_result(view);
	assert_int_equal(result->rows, few);
	assert_int_equal(result->rows_done, rows);
	struct pound_study *shorter = study_with("\"method\": \"random\", \"rows\": 150");
	shorter->design.rows = few;
	struct pound_run *first = specimen_run(shorter), *whole = specimen_run(study);
	check_same_indices(study, result, pound_run_result(first));
	// the view is gone, and what it shared is not
	pound_run_free(view);
	for (int k = 0; k < pound_run_reductions(run); k++)
		assert_int_equal(pound_run_reduce(run, k, 0), POUND_OK);
	assert_int_equal(pound_run_result(run)->rows, 150);
	check_same_indices(study, pound_run_result(run), pound_run_result(whole));
	pound_run_free(run), pound_run_free(first), pound_run_free(whole);
	study_free(study), study_free(shorter);
	free(done);
}

static void an_intermediate_result_that_is_made_soon_has_a_limit_of_its_work(void **state)
{
	(void)state;
	static const int designs[] = {20, 150, 200000};
	for (size_t k = 0; k < sizeof designs / sizeof designs[0]; k++) {
		struct pound_study *study = study_with("\"method\": \"random\", \"rows\": 20");
		study->design.rows = designs[k];
		struct pound_run *run = pound_run_create(study, 1);
		const int of_row = pound_run_reductions(run) * pound_run_samples(run),
		          rows = pound_run_rows_quick(run);
		if (designs[k] * of_row <= POUND_VALUES_QUICK)
			assert_int_equal(rows, designs[k]);
		else
			assert_in_range(rows * of_row, POUND_VALUES_QUICK - of_row, POUND_VALUES_QUICK);
		pound_run_free(run);
		study_free(study);
	}
	// so many cells that the rows which all indices need are more work: 700 cells of 6 samples
	enum { CELLS = 700 };
	double values[CELLS];
	struct pound_study *study = study_with("\"method\": \"random\", \"rows\": 40");
	for (int v = 0; v < CELLS; v++)
		values[v] = 1.0 + 0.001 * v;
	assert_true(study->n_sweeps > 0);
	struct pound_sweep sweep = study->sweeps[0];
	study->sweeps[0].values = values;
	study->sweeps[0].n_values = CELLS;
	struct pound_run *run = pound_run_create(study, 1);
	assert_int_equal(pound_run_rows_quick(run), 30);
	pound_run_free(run);
	study->sweeps[0] = sweep;
	study_free(study);
}

/* Studies of the same shape one after another, in memory that is reused without being cleared. */
static void a_study_finds_nothing_of_the_one_before_it_in_memory(void **state)
{
	(void)state;
	enum { ROWS = 330, SIZE = sizeof(struct pound_estimate) * D };
	const struct pound_study study = study_of("lhs", ROWS, 2, 0, 0), other = study_of("lhs", ROWS, 1, 0, 0);
	char before[POUND_N_INDICES][SIZE];
	// no memory is returned to the system; the sanitizers' allocators ignore this
	mallopt(M_MMAP_MAX, 0);
	mallopt(M_TRIM_THRESHOLD, 1 << 30);
	for (int round = 0; round < 3; round++) {
		struct pound_run *run = run_of(round == 1 ? &other : &study, "g_a");
		for (int k = 0; k < POUND_N_INDICES; k++) {
			const struct pound_estimate *index = pound_run_result(run)->cells[0].indices[0].index[k];
			if (round == 0)
				memcpy(before[k], index, SIZE);
			else if (round == 2)
				assert_memory_equal(before[k], index, SIZE);
		}
		pound_run_free(run);
	}
}

/* Totals of x0 / 2 + 2 x1 / 3 + x2 + 2 x3 have the ratios 9 : 16 : 36 : 144; two inputs with equally many waves have
 * equal totals, which no polynomial explains. */
static double four_effects(const double *x)
{
	return x[0] / 2 + 2 * x[1] / 3 + x[2] + 2 * x[3];
}

static double two_effects(const double *x)
{
	return sin(40 * M_PI * x[0]) + sin(40 * M_PI * x[1]);
}

static void a_design_stops_when_the_order_of_the_inputs_is_certain(void **state)
{
	(void)state;
	static const struct function different = {.name = "different", .y = four_effects},
	                             same = {.name = "same", .y = two_effects};
	for (int k = 0; k < 2; k++) {
		struct pound_study study = study_of("lhs", 1000, 3, 1e-6, 12000);
		study.design.until.goal = POUND_GOAL_ORDER;
		struct pound_run *run = pound_run_create(&study, 1);
		int first = 0;
		do {
			assign(run, k ? &same : &different, first);
			first = pound_run_rows(run);
			assert_int_equal(pound_run_reduce(run, 0, 0), POUND_OK);
		} while (pound_run_grow(run));
		const struct pound_result *result = pound_run_result(run);
		const struct pound_look *last = &result->looks[result->n_looks - 1];
		if (k) {
			// equal indices never have a certain order, so max_runs ends the growth
			assert_int_equal(last->rows, 2000);
			assert_true(last->half_width > 1e-6 && last->index == POUND_ST);
		} else {
			assert_int_equal(result->n_looks, 1);
			check_near(last->half_width, -1, 0);
			for (int j = 1; j < D; j++)
				assert_true(result->cells[0].indices[0].index[POUND_ST][j].low >
				            result->cells[0].indices[0].index[POUND_ST][j - 1].high);
		}
		pound_run_free(run);
	}
}

static void a_design_waits_for_one_output_alone(void **state)
{
	(void)state;
	char *waiting =
	    study_documents_with(study_documents_sensitivity, "\"rows\": 10",
	                         "\"until\": {\"half_width\": 0.9, \"max_runs\": 4000, \"output\": \"impulse\"}");
	struct pound_study *study = study_documents_study(waiting);
	int impulse = 0;
	while (impulse < study->n_outputs && strcmp(pound_output_name(study->outputs[impulse]), "impulse") != 0)
		impulse++;
	assert_true(impulse > 0 && impulse < study->n_outputs);
	assert_int_equal(study->design.until.output, 1 + study->outputs[impulse]);
	struct pound_run *run = pound_run_create(study, 1);
	int block = 0;
	do {
		for (; block < pound_run_blocks(run); block++)
			assert_int_equal(pound_run_block(run, block, 0), POUND_OK);
		for (int k = 0; k < pound_run_reductions(run); k++)
			assert_int_equal(pound_run_reduce(run, k, 0), POUND_OK);
	} while (pound_run_grow(run));
	const struct pound_result *result = pound_run_result(run);
	assert_int_equal(result->n_looks, 1);
	assert_int_equal(result->looks[0].output, impulse);
	pound_run_free(run);
	study_free(study);
	free(waiting);
}

CHECK_MAIN(cmocka_unit_test(a_design_stops_when_the_order_of_the_inputs_is_certain),
           cmocka_unit_test(a_design_waits_for_one_output_alone),
           cmocka_unit_test(a_study_finds_nothing_of_the_one_before_it_in_memory),
           cmocka_unit_test(a_design_grows_by_whole_batches_and_by_doubling),
           cmocka_unit_test(a_grown_design_keeps_its_rows),
           cmocka_unit_test(a_design_stops_at_the_first_look_that_finds_every_interval_narrow),
           cmocka_unit_test(max_runs_ends_a_design_that_is_not_narrow_yet),
           cmocka_unit_test(nobody_waits_for_the_indices_of_a_constant),
           cmocka_unit_test(a_grown_sobol_design_has_the_indices_of_one_of_that_size_from_the_start),
           cmocka_unit_test(intervals_cover_where_a_design_has_stopped),
           cmocka_unit_test(a_block_ends_where_the_design_is_looked_at),
           cmocka_unit_test(an_intermediate_result_has_whole_rows_only),
           cmocka_unit_test(a_view_has_the_result_of_its_rows_while_the_run_goes_on),
           cmocka_unit_test(an_intermediate_result_that_is_made_soon_has_a_limit_of_its_work))
