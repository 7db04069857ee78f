/* unit_samples.c - the samples of a study as CSV and as a NumPy file, against the run of the study. */
#include <math.h>
#include <string.h>

#include "schema/result/result_json.h"
#include "schema/study/study_json.h"
#include "tests/support/check.h"
#include "tests/support/study_documents.h"

/* A study of two rows, two inputs and four cells, run to its end. */
struct finished {
	struct pound_study *study;
	struct pound_run *run;
};

static struct finished finished(void)
{
	char *few = study_documents_with(study_documents_sensitivity, "\"rows\": 10", "\"rows\": 2");
	char *named = study_documents_with(few, "\"f_e\"", "\"=f'e\\\\\\u03c9,\"");
	char *document = study_documents_with(
	    named, "\"/contact/restitution\", \"values\": [0.2, 0.9]}",
	    "\"/contact/gap_m\", \"values\": [0, 0.001]}, {\"path\": \"/law/type\", \"values\": "
	    "[\"linear\", \"elastoplastic\"]}");
	struct finished f = {.study = study_documents_study(document)};
	f.run = pound_run_create(f.study, 1);
	assert_non_null(f.run);
	for (int b = 0; b < pound_run_blocks(f.run); b++)
		assert_int_equal(pound_run_block(f.run, b, 0), POUND_OK);
	free(few);
	free(named);
	free(document);
	return f;
}

static void finished_free(struct finished *f)
{
	pound_run_free(f->run);
	study_free(f->study);
}

/* The next number of a line, NAN for an empty cell; moves `at` past its comma or line end. */
static double next_number(char **at)
{
	char *end;
	double value = strtod(*at, &end);
	if (end == *at)
		value = NAN;
	*at = end + (*end == '\r' ? 2 : 1);
	return value;
}

static void same_number(double got, double want)
{
	assert_int_equal(isnan(got), isnan(want));
	if (!isnan(want))
		check_near(got, want, 0);
}

static void a_line_for_every_sample_in_the_order_of_the_design(void **state)
{
	(void)state;
	struct finished f = finished();
	size_t length;
	char *csv = samples_to_csv(f.study, f.run, &length);
	static const char header[] =
	    "/contact/gap_m,/law/type,row,sample,\"'=f'e\\\xCF\x89,\",/oscillators/1/mass_kg,"
	    "demand_amplification,demand_amplification.variance,impulse,impulse.variance\r\n";
	static const char *const samples[] = {"A,", "B,", "\"AB_=f'e\\\xCF\x89,\",",
	                                      "AB_/oscillators/1/mass_kg,"};
	static const char *const laws[] = {"linear,", "elastoplastic,"};
	assert_int_equal(strncmp(csv, header, strlen(header)), 0);
	char *at = csv + strlen(header);
	for (int line = 0; line < 4 * 2 * 4; line++) {
		int cell = line / 8, row = line / 4 % 2, sample = line % 4;
		double x[2];
		check_near(next_number(&at), cell / 2 ? 0.001 : 0, 0);
		assert_int_equal(strncmp(at, laws[cell % 2], strlen(laws[cell % 2])), 0);
		at += strlen(laws[cell % 2]);
		check_near(next_number(&at), row, 0);
		assert_int_equal(strncmp(at, samples[sample], strlen(samples[sample])), 0);
		at += strlen(samples[sample]);
		pound_run_sample_inputs(f.run, row, sample, x);
		for (int j = 0; j < 2; j++)
			check_near(next_number(&at), x[j], 0);
		for (int o = 0; o < 2; o++) {
			const struct pound_sample_output output = pound_run_sample_output(f.run, cell, row, sample, o);
			bool applies = o == 1 || cell % 2 == 1; // a linear law has no demand
			assert_true(!applies || output.mean > 0);
			same_number(next_number(&at), applies ? output.mean : NAN);
			same_number(next_number(&at), applies ? output.variance : NAN);
		}
	}
	assert_int_equal(at - csv, length);
	free(csv);
	finished_free(&f);
}

static void a_numpy_file_holds_the_same_numbers(void **state)
{
	(void)state;
	struct finished f = finished();
	size_t length;
	char *npy = samples_to_npy(f.study, f.run, &length);
	const unsigned char *lead = (const unsigned char *)npy;
	static const char dictionary[] =
	    "{'descr': [('/contact/gap_m', '<f8'), ('/law/type', 'S32'), ('row', '<i4'), ('sample', '<i4'), "
	    "('=f\\'e\\\\\xCF\x89,', '<f8'), ('/oscillators/1/mass_kg', '<f8'), ('demand_amplification', '<f8'), "
	    "('demand_amplification.variance', '<f8'), ('impulse', '<f8'), ('impulse.variance', '<f8'), ], "
	    "'fortran_order': False, 'shape': (32,), }";
	assert_int_equal(memcmp(npy, "\x93NUMPY\x03\x00", 8), 0);
	size_t whole = 12 + lead[8] + 256u * lead[9] + 65536u * lead[10];
	assert_int_equal(whole % 64, 0);
	assert_int_equal(memcmp(npy + 12, dictionary, strlen(dictionary)), 0);
	assert_int_equal(npy[whole - 1], '\n');
	enum { RECORD = 8 + 32 + 4 + 4 + 2 * 8 + 4 * 8 };
	assert_int_equal(length, whole + 32 * RECORD);
	const char *last = npy + whole + 31 * RECORD; // cell 3, row 1, sample 3
	double gap, x[2], wanted[2], outputs[4];
	int32_t place[2];
	memcpy(&gap, last, sizeof gap);
	check_near(gap, 0.001, 0);
	assert_string_equal(last + 8, "elastoplastic");
	memcpy(place, last + 40, sizeof place);
	assert_int_equal(place[0], 1);
	assert_int_equal(place[1], 3);
	memcpy(x, last + 48, sizeof x);
	pound_run_sample_inputs(f.run, 1, 3, wanted);
	memcpy(outputs, last + 64, sizeof outputs);
	for (int k = 0; k < 2; k++) {
		check_near(x[k], wanted[k], 0);
		const struct pound_sample_output output = pound_run_sample_output(f.run, 3, 1, 3, k);
		check_near(outputs[2 * k], output.mean, 0);
		check_near(outputs[2 * k + 1], output.variance, 0);
	}
	free(npy);
	finished_free(&f);
}

static void a_run_that_is_stopped_leaves_no_table(void **state)
{
	(void)state;
	struct finished f = finished();
	size_t length;
	pound_run_stop(f.run);
	assert_null(samples_to_csv(f.study, f.run, &length));
	assert_null(samples_to_npy(f.study, f.run, &length));
	finished_free(&f);
}

CHECK_MAIN(cmocka_unit_test(a_line_for_every_sample_in_the_order_of_the_design),
           cmocka_unit_test(a_numpy_file_holds_the_same_numbers),
           cmocka_unit_test(a_run_that_is_stopped_leaves_no_table))
