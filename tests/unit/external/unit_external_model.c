/* unit_external_model.c - external models: the design as CSV, their outputs, and the indices from these. */
#include <math.h>
#include <string.h>

#include "engine/design/design.h"
#include "engine/indices/indices.h"
#include "engine/numeric/random.h"
#include "schema/examples/examples.h"
#include "schema/external/external_model.h"
#include "schema/json/json_pointer.h"
#include "schema/result/result_json.h"
#include "schema/study/study_json.h"
#include "tests/support/check.h"
#include "tests/support/functions.h"
#include "tests/support/results.h"
#include "tests/support/scenes.h"
#include "tests/support/study_documents.h"

#define UNIFORM "\"distribution\": {\"type\": \"uniform\", \"min\": 0, \"max\": 1}}"

static const char two_inputs[] =
    "{\"inputs\": [{\"name\": \"p\", " UNIFORM ", {\"name\": \"q, r\", " UNIFORM "],"
    " \"design\": {\"rows\": 6}}";

static void a_study_without_a_scene_is_inputs_and_a_design(void **state)
{
	(void)state;
	static const struct {
		const char *document, *pointer, *detail;
	} refused[] = {
	    {"{}", "/inputs", "is required: an array of 1 to 32 elements"},
	    {"{\"inputs\": [{" UNIFORM "]}", "/inputs/0/name", "is required: a string of 1 to 100 characters"},
	    {"{\"inputs\": [{\"name\": \"row\", " UNIFORM "]}", "/inputs/0/name",
	     "is already the name of a column of the samples (row, sample or an output); expected another name"},
	    {"{\"inputs\": [{\"name\": \"p\", " UNIFORM "], \"sweep\": []}", "/sweep",
	     "is not used without a scene"},
	    {"{\"inputs\": [{\"name\": \"p\", " UNIFORM "], \"solver\": {}}", "/solver",
	     "is not used without a scene"},
	    {"{\"inputs\": [{\"name\": \"p\", " UNIFORM "], \"outputs\": [\"impulse\"]}", "/outputs",
	     "is not used without a scene"},
	    {"{\"inputs\": [{\"name\": \"p\", " UNIFORM "], \"design\": {\"rowz\": 3}}", "/design/rowz",
	     "unknown member, did you mean \"rows\"?"},
	    {"{\"inputs\": [{\"name\": \"p\", " UNIFORM "], \"design\": {\"method\": \"sobol\", \"rows\": 8, "
	     "\"randomisations\": 8}}",
	     "/design/rows", "must be at least 16, two for each randomisation, got 8"},
	    {"{\"kind\": \"response\", \"scene\": {\"oscillators\": [{\"frequency_hz\": 1}, {\"frequency_hz\": "
	     "2}]}}",
	     "/kind", "must be \"sensitivity\": no other kind has a design"},
	};
	for (size_t i = 0; i < sizeof refused / sizeof refused[0]; i++) {
		struct problems problems;
		assert_null(study_design_from_json(refused[i].document, strlen(refused[i].document), &problems));
		assert_int_equal(problems.n, 1);
		assert_string_equal(problems.list[0].pointer, refused[i].pointer);
		assert_string_equal(problems.list[0].detail, refused[i].detail);
	}
	struct pound_study *study = results_design(two_inputs);
	assert_true(study->elsewhere && study->kind == POUND_KIND_SENSITIVITY && study->n_inputs == 2);
	assert_int_equal(study->design.rows, 6);
	study_free(study);
	// a study to be run here needs a scene
	struct problems problems;
	study_documents_refused(two_inputs, &problems);
	// a study with a scene has a design, too
	study = results_design(study_documents_sensitivity);
	assert_false(study->elsewhere);
	study_free(study);
}

static void rows_come_in_the_order_of_the_contract_and_read_back_to_the_same_numbers(void **state)
{
	(void)state;
	struct pound_study *study = results_design(two_inputs);
	struct pound_run *run = pound_run_create(study, 1);
	size_t n, n_rest;
	char *head = model_rows(study, run, 0, 2, &n), *rest = model_rows(study, run, 2, 4, &n_rest);
	assert_memory_equal(head, "p,\"q, r\"\n", 9);
	double x[6 * 2 * 2];
	pound_design_probabilities(study, NULL, x);
	pound_design_values(study, x, NULL, x);
	char *at = head + 9;
	for (int row = 0; row < 6; row++)
		for (int sample = 0; sample < 4; sample++) {
			const double *a = x + row * 4, *b = a + 2;
			// A, B, A with column 0 from B, A with column 1 from B
			const double wanted[4][2] = {{a[0], a[1]}, {b[0], b[1]}, {b[0], a[1]}, {a[0], b[1]}};
			for (int j = 0; j < 2; j++) {
				assert_true(strtod(at, &at) == wanted[sample][j]);
				assert_int_equal(*at++, j ? '\n' : ',');
			}
			if (row == 1 && sample == 3) {
				assert_ptr_equal(at, head + n);
				at = rest;
			}
		}
	assert_ptr_equal(at, rest + n_rest);
	free(head), free(rest);
	pound_run_free(run);
	study_free(study);
}

/* ---- indices ---- */

// statistics_golden.json, estimators_d2_n6: A, B, AB1, AB2 of each row
static const double golden[6][4] = {{3.3, 3.13, 3.25, 3.65},  {1.96, 2.68, 2.88, 2.3},
                                    {3.75, 2.98, 3.6, 3.27},  {3.94, 2.15, 2.62, 2.7},
                                    {1.05, 3.88, 2.65, 3.08}, {1.7, 3.78, 2.26, 2.66}};

static double index_of(const struct reading *result, int output, int input, const char *name)
{
	return reading_number(result, "/cells/0/outputs/%d/inputs/%d/%s", output, input, name);
}

/* The golden rows as CSV, each line by the format, which gets the output and its variance. */
static char *golden_csv(const char *header, const char *format, double variance)
{
	char *csv = NULL;
	size_t n;
	FILE *out = open_memstream(&csv, &n);
	fputs(header, out);
	for (int i = 0; i < 6; i++)
		for (int p = 0; p < 4; p++)
			fprintf(out, format, golden[i][p], variance * (1 + p));
	fclose(out);
	return csv;
}

static void outputs_computed_elsewhere_give_the_golden_indices(void **state)
{
	(void)state;
	char *csv = golden_csv("y\n", "%.17g\n", 0.0);
	struct reading *result = results_of_lines(two_inputs, csv);
	check_near(index_of(result, 0, 0, "S1_raw"), 0.572576783750673, 1e-12);
	check_near(index_of(result, 0, 1, "S1_raw"), 0.755503894911683, 1e-12);
	check_near(index_of(result, 0, 0, "ST_raw"), 0.880662387875659, 1e-12);
	check_near(index_of(result, 0, 1, "ST_raw"), 1.13121640616328, 2e-12);
	assert_string_equal(reading_text(result, "/cells/0/outputs/0/name"), "y");
	assert_string_equal(reading_text(result, "/cells/0/outputs/0/inputs/1/name"), "q, r");
	check_near(reading_number(result, "/cells/0/runs"), 24.0, 0.0);
	check_near(reading_number(result, "/cells/0/runs_failed"), 0.0, 0.0);
	assert_false(reading_has(result, "/timing"));
	reading_close(result);
	free(csv);
}

/* Corrected indices by their definition, for independent noise of variance v (1 + p) in sample p of every row:
 * S = (P_BC - P_AB) / ((P_AA + P_BB) / 2), T = (P_AA + P_CC - 2 P_AC) / (2 w), about the mean of all samples. */
static void corrected(double v, double value[4])
{
	double g = 0.0, pair = 0.0, all = 0.0;
	for (int k = 0; k < 24; k++)
		g += golden[k / 4][k % 4] / 24;
	for (int k = 0; k < 24; k++) {
		double y = golden[k / 4][k % 4] - g, square = y * y - v * (1 + k % 4);
		all += square / 24;
		pair += k % 4 < 2 ? square / 12 : 0.0;
	}
	for (int j = 0; j < 2; j++) {
		double above = 0.0, square = 0.0;
		for (int i = 0; i < 6; i++) {
			double a = golden[i][0] - g, b = golden[i][1] - g, c = golden[i][2 + j] - g;
			above += (b * c - a * b) / 6;
			square += (a * a - v + c * c - v * (3 + j) - 2.0 * a * c) / 6;
		}
		value[j] = above / pair;
		value[2 + j] = 0.5 * square / all;
	}
}

static void a_variance_column_takes_independent_noise_out(void **state)
{
	(void)state;
	const double v = 0.01;
	double wanted[4];
	corrected(v, wanted);
	char *csv = golden_csv("y,y.variance\n", "%.17g,%.17g\n", v);
	struct reading *result = results_of_lines(two_inputs, csv);
	for (int j = 0; j < 2; j++) {
		check_near(index_of(result, 0, j, "S1_pick_freeze"), wanted[j], 1e-12);
		check_near(index_of(result, 0, j, "ST_pick_freeze"), wanted[2 + j], 1e-12);
		assert_true(isnan(index_of(result, 0, j, "S2_excitation")));
	}
	check_near(index_of(result, 0, 0, "S1_raw"), 0.572576783750673, 1e-12);
	assert_true(reading_number(result, "/cells/0/outputs/0/noise_share") > 0.0);
	assert_true(isnan(reading_number(result, "/cells/0/outputs/0/excitation/ST_one_signal")));
	reading_close(result);
	// rows whose samples share their noise would need covariances, which are not given
	char *document = study_documents_with(two_inputs, "\"rows\": 6", "\"rows\": 6, \"signals\": \"common\"");
	result = results_of_lines(document, csv);
	check_near(index_of(result, 0, 0, "S1_raw"), 0.572576783750673, 1e-12);
	assert_true(isnan(index_of(result, 0, 0, "S1_pick_freeze")));
	assert_true(isnan(index_of(result, 0, 0, "ST")));
	assert_non_null(strstr(reading_text(result, "/cells/0/outputs/0/note"), "share their noise"));
	reading_close(result);
	free(document);
	free(csv);
}

/* Outputs p + q + z of a study's design as CSV; z has twice the variance of an input, and is drawn once per row or
 * once per sample; its variance is in a separate column or missing. */
static char *noisy_csv(const char *document, bool shared, bool variance)
{
	struct pound_study *study = results_design(document);
	double *x = malloc(sizeof *x * (size_t)study->design.rows * 4);
	char *csv = NULL;
	size_t n;
	FILE *out = open_memstream(&csv, &n);
	pound_design_probabilities(study, NULL, x);
	pound_design_values(study, x, NULL, x);
	fputs(variance ? "y,y.variance\n" : "y\n", out);
	for (int row = 0; row < study->design.rows; row++)
		for (int sample = 0; sample < 4; sample++) {
			const struct pound_stream stream = {
			    .seed = 1, .row = (uint32_t)row, .sample = shared ? 0 : (uint32_t)sample};
			const unsigned from_b = pound_order_mask(2, sample);
			const double p = x[row * 4 + 2 * (from_b & 1)], q = x[row * 4 + 2 * (from_b >> 1 & 1) + 1];
			fprintf(out, "%.17g", p + q + M_SQRT2 * pound_random_uniform(stream, 0));
			fputs(variance ? ",0.16666666666666666\n" : "\n", out);
		}
	fclose(out);
	free(x);
	study_free(study);
	return csv;
}

/* p, q and z have 1/4, 1/4 and 1/2 of the variance of y; p and q have half of the variance of the mean response each;
 * with independent noise in every sample ST contains all but S1 of the other input. */
static void indices_of_a_noisy_model_are_exact_or_null(void **state)
{
	(void)state;
	static const struct {
		bool shared, variance;
		double first, total;
	} cases[] = {{true, false, 0.25, NAN},
	             {true, true, 0.5, NAN},
	             {false, false, 0.25, 0.75},
	             {false, true, 0.5, 0.5}};
	for (int k = 0; k < 4; k++) {
		char *document = study_documents_with(two_inputs, "\"rows\": 6",
		                                      cases[k].shared ? "\"rows\": 400, \"signals\": \"common\""
		                                                      : "\"rows\": 400");
		char *csv = noisy_csv(document, cases[k].shared, cases[k].variance);
		struct reading *result = results_of_lines(document, csv);
		for (int j = 0; j < 2; j++) {
			const double first = index_of(result, 0, j, "S1"), total = index_of(result, 0, j, "ST");
			// twice half an interval of 95 %: four standard errors
			check_near(first, cases[k].first, 2 * (index_of(result, 0, j, "S1_high") - first));
			assert_int_equal(isnan(total), isnan(cases[k].total));
			if (!isnan(total))
				check_near(total, cases[k].total, 2 * (index_of(result, 0, j, "ST_high") - total));
			assert_true(isfinite(index_of(result, 0, j, "S1_raw")));
		}
		const char *note = reading_text(result, "/cells/0/outputs/0/note");
		assert_int_equal(note && strstr(note, "use independent noise for each sample"), cases[k].shared);
		assert_int_equal(note && strstr(note, "including the noise"), cases[k].shared && !cases[k].variance);
		reading_close(result);
		free(csv), free(document);
	}
}

/* The samples of a row share their signals by default; in a scene without random signals there is nothing to share. */
static void a_scene_without_random_signals_has_no_noise_to_share(void **state)
{
	(void)state;
	static const char form[] =
	    "{\"kind\": \"sensitivity\", \"scene\": {\"oscillators\": [{\"frequency_hz\": 2}, {\"frequency_hz\": "
	    "3}], "
	    "\"excitation\": %s}, \"inputs\": [{\"path\": \"/oscillators/1/mass_kg\", " UNIFORM
	    ", {\"path\": \"/contact/restitution\", " UNIFORM "], \"design\": {\"rows\": 100}}";
	static const char *const excitations[] = {
	    "{\"type\": \"harmonic\", \"frequency_hz\": 2, \"duration_s\": 4, \"time_step_s\": 0.01}",
	    "{\"type\": \"kanai_tajimi\", \"frequency_hz\": 2}"};
	for (int random = 0; random < 2; random++) {
		char document[1024], *positive;
		snprintf(document, sizeof document, form, excitations[random]);
		positive = study_documents_with(document, "\"min\": 0", "\"min\": 0.5"); // of the mass
		char *csv = noisy_csv(positive, true, false);
		struct reading *result = results_of_lines(positive, csv);
		assert_int_equal(isnan(index_of(result, 0, 0, "ST")), random);
		assert_int_equal(isnan(index_of(result, 0, 0, "S1_pick_freeze")), random);
		assert_true(isfinite(index_of(result, 0, 0, "S1")));
		reading_close(result);
		free(csv), free(positive);
	}
}

static void an_inert_input_has_no_total_once_replicates_give_the_noise(void **state)
{
	(void)state;
	enum { N = 1000, D = FUNCTION_INPUTS, SAMPLES = D + 2, R = 5 };
	const struct function *f = function_named("ishigami");
	struct pound_sample_values values = function_values(f, N, 42, (struct function_noise){R, 1.0, false});
	char *csv = NULL;
	size_t n;
	FILE *out = open_memstream(&csv, &n);
	fputs("y.variance,y\n", out);
	for (int k = 0; k < N * SAMPLES; k++) {
		double mean = 0.0, square = 0.0;
		for (int r = 0; r < R; r++)
			mean += values.numerator[k * R + r] / R;
		for (int r = 0; r < R; r++)
			square += pow(values.numerator[k * R + r] - mean, 2);
		fprintf(out, "%.17g,%.17g\n", square / (R - 1) / R, mean);
	}
	fclose(out);
	struct reading *result =
	    results_of_lines("{\"inputs\": [{\"name\": \"a\", " UNIFORM ", {\"name\": \"b\", " UNIFORM
	                     ", {\"name\": \"c\", " UNIFORM ", {\"name\": \"d\", " UNIFORM "]}",
	                     csv);
	// nu = sigma^2 / (R V) = 0.2: raw T of an input without effect is nu / (1 + nu); corrected: RMSE 0.0097 for this function
	check_near(index_of(result, 0, 3, "ST_raw"), 0.2 / 1.2, 4 * 0.0097);
	check_near(index_of(result, 0, 3, "ST_pick_freeze"), 0.0, 4 * 0.0097);
	for (int j = 0; j < D; j++) {
		check_near(index_of(result, 0, j, "ST"), f->index[D + j], 4 * 0.030);
		check_near(index_of(result, 0, j, "S1"), f->index[j], 4 * 0.034);
	}
	reading_close(result);
	function_values_free(&values);
	free(csv);
}

static void a_run_without_a_number_takes_its_row_out_of_every_output(void **state)
{
	(void)state;
	static const char *const missing[] = {"", "nan", "NA", "NaN", " "};
	for (size_t k = 0; k < sizeof missing / sizeof missing[0]; k++) {
		char *csv = NULL;
		size_t n;
		FILE *out = open_memstream(&csv, &n);
		fputs("y,z\n", out);
		for (int i = 0; i < 6; i++)
			for (int p = 0; p < 4; p++)
				fprintf(out, i == 2 && p == 3 ? "%.17g,%s\n" : "%.17g,1\n", golden[i][p], missing[k]);
		fclose(out);
		struct reading *result = results_of_lines(two_inputs, csv);
		check_near(reading_number(result, "/cells/0/runs_failed"), 1.0, 0.0);
		check_near(reading_number(result, "/cells/0/rows_dropped"), 1.0, 0.0);
		// as from five rows; centered Saltelli estimate by hand
		double mu = 0.0, square = 0.0, above = 0.0;
		for (int i = 0; i < 6; i++)
			mu += i == 2 ? 0.0 : (golden[i][0] + golden[i][1]) / 10;
		for (int i = 0; i < 6; i++) {
			const double *y = golden[i];
			square += i == 2 ? 0.0 : (pow(y[0] - mu, 2) + pow(y[1] - mu, 2)) / 10;
			above += i == 2 ? 0.0 : (y[1] - mu) * (y[2] - y[0]) / 5;
		}
		check_near(index_of(result, 0, 0, "S1_raw"), above / square, 1e-12);
		// the other output is constant
		assert_true(isnan(index_of(result, 1, 0, "ST")));
		assert_non_null(strstr(reading_text(result, "/cells/0/outputs/1/note"), "the same for every row"));
		reading_close(result);
		free(csv);
	}
}

static void spelling_and_further_columns_do_not_change_the_result(void **state)
{
	(void)state;
	size_t n, n_other, n_rows;
	struct problems problems;
	struct pound_study *study = results_design(two_inputs);
	struct pound_run *run = pound_run_create(study, 1);
	char *plain = golden_csv("y\n", "%.17g\n", 0.0), *rows = model_rows(study, run, 0, 6, &n_rows);
	// the design's own columns, quotes, spaces, line ends and byte order mark of a spreadsheet
	char *csv = NULL;
	FILE *out = open_memstream(&csv, &n_other);
	fputs("\xEF\xBB\xBFrow, \"y\" ,p,\"q, r\",sample\r\n", out);
	char *line = strchr(rows, '\n') + 1;
	for (int k = 0; k < 24; k++) {
		int length = (int)strcspn(line, "\n");
		fprintf(out, "%d,\"%.17g\",%.*s,AB_p\r\n", k / 4, golden[k / 4][k % 4], length, line);
		line += length + 1;
	}
	fputs("\r\n\n", out);
	fclose(out);
	char *json = model_indices(study, plain, strlen(plain), &problems, &n);
	char *other = model_indices(study, csv, n_other, &problems, &n_other);
	assert_non_null(json);
	assert_non_null(other);
	assert_string_equal(json, other);
	free(json), free(other), free(plain), free(rows), free(csv);
	pound_run_free(run);
	study_free(study);
}

static void a_quote_that_begins_the_text_is_the_first_of_its_cell(void **state)
{
	(void)state;
	char *plain = golden_csv("y\n", "%.17g\n", 0.0), *quoted = golden_csv("\"\"y\"\n", "%.17g\n", 0.0);
	struct pound_study *study = results_design(two_inputs);
	struct problems problems;
	size_t n, n_quoted;
	char *json = model_indices(study, plain, strlen(plain), &problems, &n);
	// the byte before the text, here another quote, is not read
	char *other = model_indices(study, quoted + 1, strlen(quoted + 1), &problems, &n_quoted);
	assert_non_null(json);
	assert_non_null(other);
	assert_string_equal(json, other);
	free(json), free(other), free(plain), free(quoted);
	study_free(study);
}

static void a_column_may_have_the_longest_name_of_an_input(void **state)
{
	(void)state;
	char name[401] = "", document[800], header[420];
	for (int k = 0; k < 100; k++)
		strcat(name, "\xf0\x9f\x8f\xa0");
	snprintf(document, sizeof document,
	         "{\"inputs\": [{\"name\": \"%s\", " UNIFORM "], \"design\": {\"rows\": 6}}", name);
	snprintf(header, sizeof header, "%s,y\n", name);
	struct pound_study *study = results_design(document);
	struct pound_run *run = pound_run_create(study, 1);
	char *csv = NULL;
	size_t n;
	FILE *out = open_memstream(&csv, &n);
	fputs(header, out);
	for (int row = 0; row < 6; row++)
		for (int sample = 0; sample < 3; sample++) {
			double x;
			pound_run_sample_inputs(run, row, sample, &x);
			fprintf(out, "%.17g,%.17g\n", x, x * x);
		}
	fclose(out);
	struct reading *result = results_of_lines(document, csv);
	assert_int_equal(reading_count(result, "/cells/0/outputs"), 1);
	assert_string_equal(reading_text(result, "/cells/0/outputs/0/name"), "y");
	reading_close(result);
	free(csv);
	pound_run_free(run);
	study_free(study);
}

static void the_samples_of_a_study_give_its_raw_indices_again(void **state)
{
	(void)state;
	struct problems problems;
	size_t n_csv, n;
	const char *document = example_text("sensitivity_small");
	struct pound_study *study = results_design(document);
	struct pound_run *run = specimen_run(study);
	const struct pound_cell *cell = &pound_run_result(run)->cells[0];
	char *csv = samples_to_csv(study, run, &n_csv);
	char *json = model_indices(study, csv, n_csv, &problems, &n);
	assert_non_null(json);
	struct reading *result = reading_open(json, n);
	for (int o = 0; o < study->n_outputs; o++) {
		assert_string_equal(reading_text(result, "/cells/0/outputs/%d/name", o),
		                    pound_output_name(study->outputs[o]));
		for (int j = 0; j < study->n_inputs; j++) {
			check_near(index_of(result, o, j, "S1_raw"), cell->indices[o].index[POUND_S1_RAW][j].value,
			           1e-12);
			check_near(index_of(result, o, j, "ST_raw"), cell->indices[o].index[POUND_ST_RAW][j].value,
			           1e-12);
		}
		// the samples share their signals, whose variances are too uncertain
		assert_non_null(strstr(reading_text(result, "/cells/0/outputs/%d/note", o), "share their noise"));
	}
	reading_close(result);
	free(json), free(csv);
	pound_run_free(run);
	study_free(study);
}

static void every_fault_of_the_outputs_is_reported_with_its_line(void **state)
{
	(void)state;
	// a pointer has room for 159 bytes
	char long_cell[520] = "", long_place[160] = "line 1, ";
	memset(long_cell, '0', 512);
	strcat(long_cell, "1\n");
	memset(long_place + 8, '0', 148);
	strcpy(long_place + 156, "...");
	const struct {
		const char *header, *line, *last; /* all lines but the last, and the last */
		const char *pointer, *detail;
	} refused[] = {
	    {"y\n", "1\n", "", "", "has 23 lines after the header, expected 24: 4 samples for each of 6 rows"},
	    {"y\n", "1\n", "1\n1\n", "",
	     "has 25 lines after the header, expected 24: 4 samples for each of 6 rows"},
	    {"y\n", "1\n", "abc\n", "line 25, y",
	     "must be a decimal number, or empty or nan for a failed run, got \"abc\""},
	    {"y\n", "1\n", "inf\n", "line 25, y",
	     "must be a decimal number, or empty or nan for a failed run, got \"inf\""},
	    {"y\n", "1\n", "-1e999\n", "line 25, y",
	     "must be a decimal number, or empty or nan for a failed run, got \"-1e999\""},
	    {"y\n", "1\n", "0x10\n", "line 25, y",
	     "must be a decimal number, or empty or nan for a failed run, got \"0x10\""},
	    // many lines with the same fault give one message
	    {"y\n", "0x1\n", "1\n", "lines 2, 3, 4 and 20 more, y",
	     "must be a decimal number, or empty or nan for a failed run, got \"0x1\" (line 2)"},
	    {"y,z\n", "1,2,3\n", "1,2\n", "lines 2, 3, 4 and 20 more",
	     "must have 2 cells, as the header, got 3 (line 2)"},
	    {"y\n", "1\n", "1,5\n", "line 25", "must have 1 cell, as the header, got 2"},
	    {"y,z\n", "1,2\n", "1\n", "line 25", "must have 2 cells, as the header, got 1"},
	    {"y,y.variance\n", "1,2\n", "1,-2\n", "line 25, y.variance", "must be at least 0, got -2"},
	    {"y,y.variance\n", "1,2\n", "1,1e121\n", "line 25, y.variance", "must be at most 1e+120, got 1e121"},
	    {"y\n", "1\n", "-1e200\n", "line 25, y", "must be at most 1e+60 in magnitude, got -1e200"},
	    {"z.variance\n", "1\n", "1\n", "line 1, z.variance", "has no matching output column"},
	    {"p\n", "0.5\n", "0.5\n", "line 1",
	     "has no output column; expected one per output, and NAME.variance where that is known, or "
	     "NAME.replicate1, NAME.replicate2, ..."},
	    {"y;z\n", "1;2\n", "1;2\n", "line 1", "has no comma; columns must be separated by commas"},
	    {"y,y\n", "1,2\n", "1,2\n", "line 1, y", "is already the name of column 1"},
	    {"1.25\n", "1\n", "1\n", "line 1", "must be the name of a column, got \"1.25\""},
	    {"y,\n", "1,2\n", "1,2\n", "line 1",
	     "column 2 has no name; pandas writes its index this way unless index=False"},
	    {"pression \xe9lev\xe9"
	     "e\n",
	     "1\n", "1\n", "line 1", "is not UTF-8"},
	    {"y\n", "1\n", "\xb5\n", "line 25", "is not UTF-8"},
	    // its first 511 digits are another number; a truncated name is another name
	    {"y\n", "1\n", long_cell, "line 25, y",
	     "must be a decimal number, or empty or nan for a failed run, got "
	     "\"000000000000000000000000000000000000000000000000000000000000\""},
	    {long_cell, "1\n", "1\n", long_place, "must be shorter than 512 bytes"},
	    {"y\n", "nan\n", "\n", "", "no row of the design has all its outputs, so there are no indices"},
	    {"", "", "\n\n", "", "is empty; expected a header and one line per sample of the design"},
	};
	struct pound_study *study = results_design(two_inputs);
	for (size_t i = 0; i < sizeof refused / sizeof refused[0]; i++) {
		struct problems problems;
		char csv[800] = "";
		size_t n;
		strcat(csv, refused[i].header);
		for (int k = 0; k < 23; k++)
			strcat(csv, refused[i].line);
		strcat(csv, refused[i].last);
		assert_null(model_indices(study, csv, strlen(csv), &problems, &n));
		bool reported = false;
		for (int k = 0; k < problems.n; k++)
			reported |= strcmp(problems.list[k].pointer, refused[i].pointer) == 0 &&
			            strcmp(problems.list[k].detail, refused[i].detail) == 0;
		if (!reported)
			fail_msg("%s: %s, not %s: %s", problems.list[0].pointer, problems.list[0].detail,
			         refused[i].pointer, refused[i].detail);
	}
	study_free(study);
}

static void every_spelling_of_a_decimal_number_is_one(void **state)
{
	(void)state;
	static const struct {
		const char *text;
		bool number;
	} cases[] = {{"1", true},      {"-1.", true},       {"+.5", true},  {"1e3", true},    {"1.5E-3", true},
	             {"1e-999", true}, {".", false},        {"-", false},   {"+-1", false},   {"1e", false},
	             {"1e+", false},   {"e1", false},       {"1 2", false}, {"1_0", false},   {"nan(1)", false},
	             {"-nan", false},  {"infinity", false}, {"0b1", false}, {"1.2.3", false}, {"0x1p3", false}};
	struct pound_study *study = results_design(two_inputs);
	for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
		struct problems problems;
		char csv[400] = "y\n";
		size_t n = 0;
		for (int k = 0; k < 23; k++)
			strcat(csv, k % 2 ? "1\n" : "2\n");
		strcat(strcat(csv, cases[i].text), "\n");
		char *json = model_indices(study, csv, strlen(csv), &problems, &n);
		if ((json != NULL) != cases[i].number)
			fail_msg("'%s' is%s taken", cases[i].text, json ? "" : " not");
		assert_true(!json || strstr(json, "\"runs_failed\": 0"));
		free(json);
	}
	study_free(study);
}

/* The rows that `pound design` prints of a growing design are the rows that `pound indices` reads: those of its first look. */
static void a_design_that_grows_is_that_of_its_first_look(void **state)
{
	(void)state;
	struct problems problems;
	size_t n, n_csv;
	char *csv = NULL;
	struct pound_study *study = results_design(example_text("until"));
	struct pound_run *run = pound_run_create(study, 1);
	assert_int_equal(pound_run_rows(run), pound_design_rows(study, 0));
	FILE *out = open_memstream(&csv, &n_csv);
	fputs("y\n", out);
	for (int row = 0; row < pound_run_rows(run); row++)
		for (int sample = 0; sample < pound_run_samples(run); sample++) {
			double x[POUND_INPUTS_MAX];
			pound_run_sample_inputs(run, row, sample, x);
			fprintf(out, "%.17g\n", x[0]);
		}
	fclose(out);
	char *json = model_indices(study, csv, n_csv, &problems, &n);
	assert_non_null(json);
	struct reading *result = reading_open(json, n);
	assert_false(reading_has(result, "/partial") || reading_has(result, "/stopping"));
	assert_non_null(strstr(reading_text(result, "/design/note"), "these are its first"));
	// y is the first input
	check_near(index_of(result, 0, 0, "S1_raw"), 1.0, 0.05);
	check_near(index_of(result, 0, 1, "ST_raw"), 0.0, 0.0);
	reading_close(result);
	free(json), free(csv);
	pound_run_free(run);
	study_free(study);
}

static void lines_in_another_order_are_noticed_by_the_inputs_in_them(void **state)
{
	(void)state;
	struct problems problems;
	size_t n, n_csv;
	char *csv = NULL;
	struct pound_study *study = results_design(two_inputs);
	FILE *out = open_memstream(&csv, &n_csv);
	fputs("p,y\n", out);
	for (int k = 0; k < 24; k++)
		fputs("0.5,1\n", out);
	fclose(out);
	assert_null(model_indices(study, csv, n_csv, &problems, &n));
	assert_int_equal(problems.n, 1);
	assert_string_equal(problems.list[0].pointer, "lines 2, 3, 4 and 21 more, p");
	assert_non_null(strstr(problems.list[0].detail, "is 0.5, but the design has "));
	free(csv);
	study_free(study);
}

static void outputs_of_a_sweep_are_refused(void **state)
{
	(void)state;
	struct problems problems;
	size_t n;
	struct pound_study *study = results_design(study_documents_sensitivity);
	assert_int_equal(study->n_sweeps, 1);
	assert_null(model_indices(study, "y\n", 2, &problems, &n));
	assert_string_equal(problems.list[0].pointer, "/sweep");
	study_free(study);
}

CHECK_MAIN(cmocka_unit_test(every_spelling_of_a_decimal_number_is_one),
           cmocka_unit_test(a_design_that_grows_is_that_of_its_first_look),
           cmocka_unit_test(a_study_without_a_scene_is_inputs_and_a_design),
           cmocka_unit_test(rows_come_in_the_order_of_the_contract_and_read_back_to_the_same_numbers),
           cmocka_unit_test(outputs_computed_elsewhere_give_the_golden_indices),
           cmocka_unit_test(a_variance_column_takes_independent_noise_out),
           cmocka_unit_test(indices_of_a_noisy_model_are_exact_or_null),
           cmocka_unit_test(a_scene_without_random_signals_has_no_noise_to_share),
           cmocka_unit_test(an_inert_input_has_no_total_once_replicates_give_the_noise),
           cmocka_unit_test(a_run_without_a_number_takes_its_row_out_of_every_output),
           cmocka_unit_test(spelling_and_further_columns_do_not_change_the_result),
           cmocka_unit_test(the_samples_of_a_study_give_its_raw_indices_again),
           cmocka_unit_test(a_quote_that_begins_the_text_is_the_first_of_its_cell),
           cmocka_unit_test(a_column_may_have_the_longest_name_of_an_input),
           cmocka_unit_test(every_fault_of_the_outputs_is_reported_with_its_line),
           cmocka_unit_test(lines_in_another_order_are_noticed_by_the_inputs_in_them),
           cmocka_unit_test(outputs_of_a_sweep_are_refused))
