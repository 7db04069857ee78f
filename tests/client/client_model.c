/* `pound design` and `pound indices`: a user's model from its design to its indices. */
#include <math.h>
#include <string.h>
#include <unistd.h>

#include "schema/json/json_pointer.h"
#include "tests/support/check.h"
#include "tests/support/program.h"
#include "tests/support/study_documents.h"

#define POUND(...) program_run((const char *const[]){"pound", __VA_ARGS__, NULL}, NULL)

/* Writes a text to a new file; the caller deletes the file. */
static void file_of(const char *text, char path[32])
{
	strcpy(path, "/tmp/pound-test-XXXXXX");
	FILE *file = fdopen(mkstemp(path), "w");
	assert_non_null(file);
	fputs(text, file);
	fclose(file);
}

/* Writes the document of an example to a file, and the Ishigami function of its rows as CSV to another. */
static void ishigami(char study[32], char outputs[32])
{
	struct program_outcome document = POUND("example", "design");
	program_expect(&document, 0);
	file_of(document.out, study);
	struct program_outcome rows = POUND("design", study);
	program_expect(&rows, 0);
	char *csv = NULL, *end;
	size_t n;
	FILE *out = open_memstream(&csv, &n);
	fputs("y\n", out);
	for (char *line = strchr(rows.out, '\n') + 1; *line; line = end + 1) {
		double x1 = strtod(line, &end), x2 = strtod(end + 1, &end), x3 = strtod(end + 1, &end);
		fprintf(out, "%.17g\n", sin(x1) + 7.0 * sin(x2) * sin(x2) + 0.1 * pow(x3, 4) * sin(x1));
	}
	fclose(out);
	file_of(csv, outputs);
	free(csv);
	program_free(&rows);
	program_free(&document);
}

static void a_design_has_its_header_and_its_samples(void **state)
{
	(void)state;
	struct program_outcome document = POUND("example", "paper_linear");
	struct program_outcome rows =
	    program_run((const char *const[]){"pound", "design", "-", NULL}, document.out);
	program_expect(&rows, 0);
	assert_string_equal(rows.err, "");
	assert_memory_equal(rows.out, "f_e,f_2,m_2/m_1,eps\n", 20);
	int lines = 0;
	for (const char *c = rows.out; *c; c++)
		lines += *c == '\n';
	assert_int_equal(lines, 1 + 6000);
	program_free(&rows);
	program_free(&document);
}

static void indices_of_outputs_computed_elsewhere_come_as_json_table_and_csv(void **state)
{
	(void)state;
	// closed form of the Ishigami function; tolerance: four times the error over designs with n = 1000
	static const double first[3] = {0.3139, 0.4424, 0.0}, total[3] = {0.5576, 0.4424, 0.2437};
	char study[32], outputs[32];
	ishigami(study, outputs);
	struct program_outcome json = POUND("indices", study, outputs), again = POUND("indices", study, outputs);
	program_expect(&json, 0);
	assert_string_equal(json.out, again.out);
	struct reading *result = reading_open(json.out, json.n_out);
	for (int j = 0; j < 3; j++) {
		check_near(reading_number(result, "/cells/0/outputs/0/inputs/%d/S1", j), first[j], 4 * 0.0099);
		check_near(reading_number(result, "/cells/0/outputs/0/inputs/%d/ST", j), total[j], 4 * 0.0046);
	}
	reading_close(result);
	struct program_outcome table = POUND("indices", "--format", "table", study, outputs);
	program_expect(&table, 0);
	assert_non_null(strstr(table.out, "\n    x3  S1 "));
	assert_null(strstr(table.out, "nan"));
	struct program_outcome csv = POUND("indices", "--format", "csv", study, outputs);
	program_expect(&csv, 0);
	assert_non_null(strstr(csv.out, "\r\ny,"));
	program_free(&csv);
	program_free(&table);
	program_free(&again);
	program_free(&json);
	unlink(study);
	unlink(outputs);
}

static void given_samples_have_indices_without_a_study(void **state)
{
	(void)state;
	char study[32], inputs[32], outputs[32];
	ishigami(study, outputs);
	// rows of a design are not a random sample, which a note reports
	struct program_outcome rows = POUND("design", study);
	program_expect(&rows, 0);
	file_of(rows.out, inputs);
	struct program_outcome json = POUND("indices", "--given", inputs, outputs);
	program_expect(&json, 0);
	struct reading *result = reading_open(json.out, json.n_out);
	assert_string_equal(reading_text(result, "/kind"), "given_data");
	assert_non_null(strstr(json.out, "for rows of `pound design' use `pound indices STUDY.json Y.csv'"));
	reading_close(result);
	struct program_outcome table = POUND("indices", "--given", "--format", "table", inputs, outputs);
	program_expect(&table, 0);
	assert_non_null(strstr(table.out, "\n  x3 "));
	assert_null(strstr(table.out, "nan"));
	struct program_outcome csv =
	    POUND("indices", "--given", "--format", "csv", "--table", "conditional_means", inputs, outputs);
	program_expect(&csv, 0);
	assert_non_null(strstr(csv.out, "\r\ny,"));
	struct program_outcome refused =
	    program_run((const char *const[]){"pound", "indices", "--given", inputs, "-", NULL}, "y\n1\n");
	program_expect(&refused, 2);
	assert_string_equal(refused.out, "");
	assert_non_null(strstr(refused.err, "standard input: 1 error: must have "));
	assert_non_null(strstr(refused.err, " samples, as the inputs, got 1\n"));
	program_free(&refused);
	program_free(&csv);
	program_free(&table);
	program_free(&json);
	program_free(&rows);
	unlink(study);
	unlink(inputs);
	unlink(outputs);
}

static void given_samples_are_drawn_and_reported_as_a_study_is(void **state)
{
	(void)state;
	char inputs[32], outputs[32], result[32];
	char *x = NULL, *y = NULL;
	size_t n_x, n_y;
	FILE *in = open_memstream(&x, &n_x), *out = open_memstream(&y, &n_y);
	fputs("a,b\n", in);
	fputs("y\n", out);
	// a grid of 12 x 12; b has no effect
	for (int i = 0; i < 144; i++) {
		fprintf(in, "%d,%d\n", i / 12, i % 12);
		fprintf(out, "%.17g\n", 0.1 * (i / 12));
	}
	fclose(in);
	fclose(out);
	file_of(x, inputs);
	file_of(y, outputs);
	struct program_outcome table = POUND("indices", "--given", "--format", "table", inputs, outputs);
	program_expect(&table, 0);
	assert_non_null(strstr(table.out, "complete factorial design"));
	assert_non_null(strstr(table.out, "1.000 [ 1.000,  1.000]"));
	assert_null(strstr(table.out, "-0.00"));
	assert_null(strstr(table.out, "widest interval"));
	assert_null(strstr(table.out, "not independent"));
	assert_null(strstr(table.out, "Sobol"));
	struct program_outcome json = POUND("indices", "--given", inputs, outputs);
	program_expect(&json, 0);
	file_of(json.out, result);
	static const char *const figures[] = {"indices", "given", "pairs"};
	for (int k = 0; k < 3; k++) {
		struct program_outcome figure = POUND("plot", figures[k], result);
		program_expect(&figure, 0);
		assert_non_null(strstr(figure.out, "</svg>"));
		// one line for each combination: no noise is known
		assert_null(strstr(figure.out, "oise of "));
		program_free(&figure);
	}
	struct program_outcome none = POUND("plot", "widths", result);
	program_expect(&none, 1);
	assert_non_null(strstr(none.err, "given data do not have its numbers; it has: indices, given, pairs"));
	struct program_outcome report = POUND("report", result);
	program_expect(&report, 0);
	assert_non_null(strstr(report.out, "the samples are a complete factorial design"));
	assert_null(strstr(report.out, "The study document"));
	program_free(&report);
	program_free(&none);
	program_free(&json);
	program_free(&table);
	unlink(inputs);
	unlink(outputs);
	unlink(result);
	free(x);
	free(y);
}

static void what_is_wrong_with_both_tables_is_reported_at_once(void **state)
{
	(void)state;
	char inputs[32], outputs[32];
	file_of("a,b\n1,x\n", inputs);
	file_of("y\n1,2\n", outputs);
	struct program_outcome refused = POUND("indices", "--given", inputs, outputs);
	program_expect(&refused, 2);
	assert_non_null(strstr(refused.err, "line 2, b: must be a decimal number"));
	assert_non_null(strstr(refused.err, "line 2: must have 1 cell, as the header, got 2"));
	program_free(&refused);
	unlink(inputs);
	unlink(outputs);
	// few samples
	file_of("a,b\n1,2\n2,1\n", inputs);
	file_of("y\n1\n2\n", outputs);
	refused = POUND("indices", "--given", inputs, outputs);
	program_expect(&refused, 2);
	assert_non_null(strstr(refused.err, "2 samples are complete, expected at least 64: new runs are needed"));
	program_free(&refused);
	unlink(inputs);
	unlink(outputs);
}

static void what_is_wrong_is_said_and_ends_with_2(void **state)
{
	(void)state;
	char study[32], outputs[32];
	ishigami(study, outputs);
	static const struct {
		const char *input, *words;
	} bad[] = {{"y\n1\n", "has 1 lines after the header, expected 5000"},
	           {"", "is empty; expected a header"}};
	for (int i = 0; i < 2; i++) {
		struct program_outcome refused =
		    program_run((const char *const[]){"pound", "indices", study, "-", NULL}, bad[i].input);
		program_expect(&refused, 2);
		assert_string_equal(refused.out, "");
		assert_non_null(strstr(refused.err, "standard input: "));
		assert_non_null(strstr(refused.err, bad[i].words));
		program_free(&refused);
	}
	static const char *const calls[][5] = {{"pound", "indices", "-", "-"},
	                                       {"pound", "indices", "study.json"},
	                                       {"pound", "design"},
	                                       {"pound", "design", "a", "b"}};
	for (int i = 0; i < 4; i++) {
		struct program_outcome refused = program_run(calls[i], "{}");
		program_expect(&refused, 2);
		program_free(&refused);
	}
	// problems of a study are reported for the study, not for the file of outputs
	struct program_outcome swept = POUND("indices", "schema/examples/paper.json", outputs);
	program_expect(&swept, 2);
	assert_non_null(strstr(swept.err, "paper.json: 1 error\npound:   /sweep: "));
	program_free(&swept);
	struct program_outcome lost = POUND("indices", study, "/no/such/file");
	program_expect(&lost, 1);
	program_free(&lost);
	lost = POUND("indices", "/no/such/study", outputs);
	program_expect(&lost, 1);
	program_free(&lost);
	char inputs[32];
	file_of("f,g\n1,2\n", inputs);
	struct program_outcome table = POUND("indices", inputs, outputs);
	program_expect(&table, 2);
	assert_non_null(strstr(table.err, ": expected a value, found f\n"));
	program_free(&table);
	unlink(inputs);
	unlink(study);
	unlink(outputs);
}

static void what_there_is_to_say_about_a_design_is_said_on_stderr(void **state)
{
	(void)state;
	struct program_outcome until = POUND("example", "until"), design = POUND("example", "design");
	char *points = study_documents_with(design.out, "\"lhs\"", "\"sobol\"");
	struct program_outcome grown =
	    program_run((const char *const[]){"pound", "design", "-", NULL}, until.out);
	struct program_outcome uneven = program_run((const char *const[]){"pound", "design", "-", NULL}, points);
	struct program_outcome run = program_run((const char *const[]){"pound", "run", "-", NULL}, design.out);
	program_expect(&grown, 0);
	program_expect(&uneven, 0);
	program_expect(&run, 2);
	assert_string_equal(
	    grown.err, "pound: note: the design grows: these are its first 128 rows; a run takes up to 8192\n");
	int lines = 0;
	for (const char *c = grown.out; *c; c++)
		lines += *c == '\n';
	assert_int_equal(lines, 1 + 128 * 5);
	assert_non_null(
	    strstr(uneven.err, "pound: note: 1000 rows are not a power of two for each of 8 randomisations"));
	// the study of an external model cannot be run by pound
	assert_non_null(strstr(run.err, "`pound design'"));
	assert_non_null(strstr(run.err, "`pound indices'"));
	program_free(&run);
	program_free(&uneven);
	program_free(&grown);
	free(points);
	program_free(&design);
	program_free(&until);
}

CHECK_MAIN(cmocka_unit_test(given_samples_have_indices_without_a_study),
           cmocka_unit_test(given_samples_are_drawn_and_reported_as_a_study_is),
           cmocka_unit_test(what_is_wrong_with_both_tables_is_reported_at_once),
           cmocka_unit_test(what_there_is_to_say_about_a_design_is_said_on_stderr),
           cmocka_unit_test(a_design_has_its_header_and_its_samples),
           cmocka_unit_test(indices_of_outputs_computed_elsewhere_come_as_json_table_and_csv),
           cmocka_unit_test(what_is_wrong_is_said_and_ends_with_2))
