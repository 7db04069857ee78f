/* unit_given_table.c - tables of samples as CSV: what is refused; the result has the engine's numbers. */
#include <math.h>
#include <string.h>

#include "engine/given.h"
#include "schema/external/given_table.h"
#include "schema/json/json_pointer.h"
#include "tests/support/check.h"

enum { N = 100 };

/* Points of a lattice of two inputs and their sum: a column for each letter, a, b or y, and 1 for a constant; samples
 * first to end-1 lack the last column. */
static char *text_of(const char *header, const char *columns, int first, int end)
{
	char *text = NULL;
	size_t n;
	FILE *out = open_memstream(&text, &n);
	fprintf(out, "%s\n", header);
	for (int i = 0; i < N; i++) {
		for (const char *c = columns; *c; c++) {
			const int b = (37 * i) % N;
			if (first <= i && i < end && !c[1])
				fputs("nan", out);
			else
				fprintf(out, "%d%s", *c == 'a' ? i : *c == 'b' ? b : *c == 'y' ? i + b : 1, c[1] ? "," : "");
		}
		fputs("\r\n", out);
	}
	fclose(out);
	return text;
}

static void read_all(struct given_table *x, struct given_table *y, const char *inputs, const char *outputs)
{
	struct problems problems;
	given_table_read(x, GIVEN_INPUTS, inputs, strlen(inputs), &problems);
	assert_int_equal(problems.status, PROBLEMS_NONE);
	given_table_read(y, GIVEN_OUTPUTS, outputs, strlen(outputs), &problems);
	assert_int_equal(problems.status, PROBLEMS_NONE);
}

static void indices_of_two_tables_are_those_of_the_engine(void **state)
{
	(void)state;
	struct given_table x, y;
	struct problems problems[2];
	static double points[N * 2], values[4 * N], sums[N];
	static size_t order[N];
	static int cell[N];
	static struct pound_given_indices indices;
	struct pound_input inputs[2] = {{.name = "a"}, {.name = "b"}};
	struct pound_given given = {.n_rows = N, .n_inputs = 2, .sorted = true, .x = points, .inputs = inputs};
	struct pound_given_checks checks;
	double *scratch = calloc(pound_given_scratch(N, 2), sizeof *scratch);
	size_t n;
	char *one = text_of("a,b", "ab", 0, 0), *two = text_of("y", "y", 0, 0),
	     *both = text_of("a,b,y", "aby", 0, 0);
	for (int i = 0; i < N; i++) {
		points[2 * i] = i;
		points[2 * i + 1] = (37 * i) % N;
		sums[i] = points[2 * i] + points[2 * i + 1];
	}
	pound_given_inputs(&given, values, cell, order);
	pound_given_check(&given, scratch, &checks);
	pound_given_estimate(&given, &checks, &(struct pound_given_output){sums, NULL}, scratch, &indices);
	for (int k = 0; k < 2; k++) {
		// a table of outputs may contain the inputs again
		read_all(&x, &y, one, k ? both : two);
		char *json = given_indices(&x, &y, problems, &n);
		assert_non_null(json);
		struct reading *result = reading_open(json, n);
		assert_string_equal(reading_text(result, "/kind"), "given_data");
		check_near(reading_number(result, "/given/samples"), N, 0);
		check_near(reading_number(result, "/cells/0/outputs/0/mean"), indices.mean, 0);
		check_near(reading_number(result, "/cells/0/outputs/0/inputs/1/ST"), indices.total[1].value, 0);
		check_near(reading_number(result, "/cells/0/outputs/0/inputs/0/ST_high"), indices.total[0].high, 0);
		check_near(reading_number(result, "/cells/0/outputs/0/explained"), indices.explained, 0);
		check_near(reading_number(result, "/cells/0/outputs/0/second_order/0/S2"),
		           indices.second[0].estimate.value, 0);
		// the sum is a polynomial
		check_near(indices.explained, 1, 1e-12);
		reading_close(result);
		free(json);
		given_table_free(&x);
		given_table_free(&y);
	}
	free(one);
	free(two);
	free(both);
	free(scratch);
}

static void samples_without_a_number_are_left_out_and_counted(void **state)
{
	(void)state;
	struct given_table x, y;
	struct problems problems[2];
	size_t n;
	char *one = text_of("a,b", "ab", 3, 10), *two = text_of("y", "y", 8, 12), *few = text_of("y", "y", 0, 40);
	read_all(&x, &y, one, two);
	char *json = given_indices(&x, &y, problems, &n);
	assert_non_null(json);
	struct reading *result = reading_open(json, n);
	check_near(reading_number(result, "/given/samples"), N - 9, 0);
	check_near(reading_number(result, "/given/samples_missing"), 9, 0);
	reading_close(result);
	free(json);
	given_table_free(&x);
	given_table_free(&y);
	read_all(&x, &y, one, few);
	assert_null(given_indices(&x, &y, problems, &n));
	assert_string_equal(problems[GIVEN_OUTPUTS].list[0].detail,
	                    "60 samples are complete, expected at least 64: new runs are needed, of more samples "
	                    "or of the rows of `pound design'");
	given_table_free(&x);
	given_table_free(&y);
	free(one);
	free(two);
	free(few);
}

static void what_is_wrong_with_a_table_is_reported_completely(void **state)
{
	(void)state;
	static const struct {
		const char *csv, *pointer, *words;
	} bad[] = {
	    {"", "", "is empty; expected a header"},
	    {"a;b\n1;2\n", "line 1", "has no comma"},
	    {"a,a\n", "line 1, a", "is already the name of column 1"},
	    {",a\n", "line 1", "column 1 has no name"},
	    {"a,3\n", "line 1", "must be the name of a column"},
	    {"a,b\n1,2\n1,x\n", "line 3, b", "must be a decimal number"},
	    {"a,b\n1,2\n1,1e70\n", "line 3, b", "must be at most 1e+60 in magnitude"},
	    {"a,b\n1,inf\n2\n", "line 3", "must have 2 cells, as the header, got 1"},
	    {"row,sample\n1,2\n", "line 1", "has no column of an input"},
	    {"a,b,c,d,e,f,g,h,i,j,k,l,m,n,o,p,q,r,s,t,u,v,w,x,y,z,aa,bb,cc,dd,ee,ff,gg\n", "line 1",
	     "has 33 inputs, expected at most 32"},
	    {"a\xff\n", "line 1", "is not UTF-8"},
	};
	for (size_t k = 0; k < sizeof bad / sizeof bad[0]; k++) {
		struct given_table x;
		struct problems problems;
		bool found = false;
		given_table_read(&x, GIVEN_INPUTS, bad[k].csv, strlen(bad[k].csv), &problems);
		assert_int_equal(problems.status, PROBLEMS_INVALID);
		for (int i = 0; i < problems.n; i++)
			found |= strcmp(problems.list[i].pointer, bad[k].pointer) == 0 &&
			         strstr(problems.list[i].detail, bad[k].words);
		if (!found)
			check_report("%s: %s: %s", bad[k].csv, problems.list[0].pointer, problems.list[0].detail);
		assert_true(found);
		given_table_free(&x);
	}
}

static void tables_that_do_not_go_together_are_refused(void **state)
{
	(void)state;
	struct given_table x, y;
	struct problems problems[2];
	size_t n;
	char *one = text_of("a,b", "ab", 0, 0), *two = text_of("y", "y", 0, 0),
	     *same = text_of("a,b", "a1", 0, 0), *other = text_of("b,y", "ay", 0, 0);
	const struct {
		const char *x, *y, *words;
		enum given_role role;
	} bad[] = {
	    {one, "y\n1\n2\n", "must have 100 samples, as the inputs, got 2", GIVEN_OUTPUTS},
	    {same, two, "has the same value in every complete sample; leave this input out", GIVEN_INPUTS},
	    {one, one, "has no column of an output", GIVEN_OUTPUTS},
	    {one, other, "is 1, but the inputs have 37; check the order of the lines", GIVEN_OUTPUTS},
	};
	for (size_t k = 0; k < sizeof bad / sizeof bad[0]; k++) {
		read_all(&x, &y, bad[k].x, bad[k].y);
		assert_null(given_indices(&x, &y, problems, &n));
		assert_int_equal(problems[bad[k].role].status, PROBLEMS_INVALID);
		assert_int_equal(problems[1 - bad[k].role].status, PROBLEMS_NONE);
		assert_non_null(strstr(problems[bad[k].role].list[0].detail, bad[k].words));
		given_table_free(&x);
		given_table_free(&y);
	}
	free(one);
	free(two);
	free(same);
	free(other);
}

static void blank_lines_at_the_end_are_no_samples(void **state)
{
	(void)state;
	struct given_table x;
	struct problems problems;
	static const char two[] = "\xEF\xBB\xBF"
	                          "a,b,row\r\n1,2,0\r\n3,,1\r\n\r\n\n",
	                  one[] = "a\n1\n\n";
	given_table_read(&x, GIVEN_INPUTS, two, sizeof two - 1, &problems);
	assert_int_equal(problems.status, PROBLEMS_NONE);
	assert_int_equal(x.n_rows, 2);
	assert_int_equal(x.n_columns, 2);
	check_near(x.cells[2], 3.0, 0.0);
	assert_true(isnan(x.cells[3]));
	given_table_free(&x);
	// in a single column an empty cell is a missing number
	given_table_read(&x, GIVEN_INPUTS, one, sizeof one - 1, &problems);
	assert_int_equal(x.n_rows, 2);
	given_table_free(&x);
}

/* Inputs and outputs of N lines as CSV. */
struct tables {
	char *x, *y;
	FILE *inputs, *outputs;
	size_t n_x, n_y;
};

static void tables_open(struct tables *t, const char *outputs, const char *inputs)
{
	*t = (struct tables){0};
	t->inputs = open_memstream(&t->x, &t->n_x);
	t->outputs = open_memstream(&t->y, &t->n_y);
	fprintf(t->inputs, "%s\n", inputs);
	fprintf(t->outputs, "%s\n", outputs);
}

/* The result of both tables; NULL: refused. */
static struct reading *tables_close(struct tables *t, struct problems problems[2])
{
	struct given_table x, y;
	size_t n;
	fclose(t->inputs);
	fclose(t->outputs);
	read_all(&x, &y, t->x, t->y);
	char *json = given_indices(&x, &y, problems, &n);
	struct reading *result = json ? reading_open(json, n) : NULL;
	free(json);
	given_table_free(&x);
	given_table_free(&y);
	free(t->x);
	free(t->y);
	return result;
}

static bool notes_have(const struct reading *result, const char *words)
{
	const char *note;
	for (int k = 0; (note = reading_text(result, "/given/notes/%d", k)); k++)
		if (strstr(note, words))
			return true;
	return false;
}

/* Points of a lattice in no order of either input, as pseudo-random as the tests need. */
static double point(int i, int input)
{
	uint32_t bits = (uint32_t)(2 * i + input + 1) * 2654435769u;
	bits ^= bits >> 15;
	bits *= 2246822519u;
	bits ^= bits >> 13;
	return bits / 4294967296.0;
}

/* The same noise as columns of a variance, as columns of replicates and as lines with the same inputs: one output, the same noise. */
static void variances_and_replicates_are_no_outputs(void **state)
{
	(void)state;
	enum { ROWS = 200 };
	static const char *const headers[] = {"y,y.variance", "y.replicate1,y.replicate2", "y"};
	double first[3];
	for (int k = 0; k < 3; k++) {
		struct tables t;
		struct problems problems[2];
		tables_open(&t, headers[k], "a,b");
		for (int i = 0; i < ROWS; i++) {
			const double a = point(i, 0), b = point(i, 1), y = a + b, off = 0.25 * (point(i + ROWS, 0) - 0.5);
			for (int line = 0; line < (k == 2 ? 2 : 1); line++)
				fprintf(t.inputs, "%.17g,%.17g\n", a, b);
			// the variance of a mean of two that are off by the same: off^2
			if (k == 0)
				fprintf(t.outputs, "%.17g,%.17g\n", y, off * off);
			else
				fprintf(t.outputs, "%.17g%s%.17g\n", y + off, k == 1 ? "," : "\n", y - off);
		}
		struct reading *result = tables_close(&t, problems);
		assert_non_null(result);
		assert_int_equal(reading_count(result, "/cells/0/outputs"), 1);
		assert_string_equal(reading_text(result, "/cells/0/outputs/0/name"), "y");
		check_near(reading_number(result, "/given/samples"), ROWS, 0);
		check_near(reading_number(result, "/cells/0/runs"), k == 2 ? 2 * ROWS : ROWS, 0);
		// uniform in +-1/8: 1/192, of 1/6 and this: 0.03
		check_near(reading_number(result, "/cells/0/outputs/0/noise_share"), 0.03, 0.01);
		assert_false(notes_have(result, "cannot separate the noise") ||
		             notes_have(result, "not independent") || notes_have(result, "pattern"));
		assert_true(notes_have(result, "are replicates") == (k == 2));
		first[k] = reading_number(result, "/cells/0/outputs/0/inputs/0/S1");
		check_near(first[k], 0.5, 0.1);
		reading_close(result);
	}
	check_near(first[1], first[0], 1e-9);
	check_near(first[2], first[0], 1e-9);
}

static void columns_that_do_not_make_an_output_are_refused(void **state)
{
	(void)state;
	static const struct {
		const char *header, *cells, *pointer, *words;
	} bad[] = {
	    {"z,y.variance", "1,1", "y", "has a variance, but no column of its own"},
	    {"y,z,y.variance", "1,1,1", "z", "has no variance, but other outputs have"},
	    {"y,y.variance", "1,-1", "line 2, y.variance", "must be at least 0, got -1"},
	    {"y.replicate1", "1", "y", "must have its replicates numbered from 1 on, at least 2"},
	    {"y.replicate1,y.replicate3", "1,1", "y", "must have its replicates numbered from 1 on, at least 2"},
	    {"y.replicate1,y.replicate2,z", "1,1,1", "z", "must have columns NAME.replicate1"},
	};
	for (size_t k = 0; k < sizeof bad / sizeof bad[0]; k++) {
		struct tables t;
		struct problems problems[2];
		tables_open(&t, bad[k].header, "a,b");
		for (int i = 0; i < N; i++) {
			fprintf(t.inputs, "%.17g,%.17g\n", point(i, 0), point(i, 1));
			fprintf(t.outputs, "%s\n", bad[k].cells);
		}
		assert_null(tables_close(&t, problems));
		check_report("%s: %s", problems[GIVEN_OUTPUTS].list[0].pointer,
		             problems[GIVEN_OUTPUTS].list[0].detail);
		assert_string_equal(problems[GIVEN_OUTPUTS].list[0].pointer, bad[k].pointer);
		assert_non_null(strstr(problems[GIVEN_OUTPUTS].list[0].detail, bad[k].words));
	}
}

/* Lines sorted by an output: the inputs that it depends on are sorted nearly, which is no chain. */
static void a_sorted_table_is_no_markov_chain(void **state)
{
	(void)state;
	enum { ROWS = 400 };
	for (int sorted = 0; sorted < 2; sorted++) {
		struct tables t;
		struct problems problems[2];
		tables_open(&t, "y", "a,b");
		for (int i = 0; i < ROWS; i++) {
			// a and y ascend, but for a shuffle of neighbors in a; without the sorted output it looks like a chain
			const double y = sorted ? i : point(i, 0), a = i + 30 * point(i, 1);
			fprintf(t.inputs, "%.17g,%.17g\n", a, point(i, 0));
			fprintf(t.outputs, "%.17g\n", y);
		}
		struct reading *result = tables_close(&t, problems);
		assert_non_null(result);
		assert_true(notes_have(result, "successive samples are correlated") == !sorted);
		reading_close(result);
	}
}

/* x1 + x2 x3 of independent bits with noise, in lines drawn at random: 0.25 by x1, and 0.1875 by x2 x3, a third each for x2, x3 and
 * both; the variance of the noise is 0.25. */
static void samples_at_few_points_have_the_noise_of_their_spread(void **state)
{
	(void)state;
	enum { SEEDS = 40, ROWS = 600 };
	static const double first[] = {4 / 7.0, 1 / 7.0, 1 / 7.0}, total[] = {4 / 7.0, 2 / 7.0, 2 / 7.0};
	int missed = 0;
	double share = 0.0;
	for (int seed = 0; seed < SEEDS; seed++) {
		struct tables t;
		struct problems problems[2];
		tables_open(&t, "y", "x1,x2,x3");
		for (int i = seed * ROWS; i < (seed + 1) * ROWS; i++) {
			const int a = point(i, 0) < 0.5, b = point(i, 1) < 0.5, c = point(i + SEEDS * ROWS, 0) < 0.5;
			const double noise = sqrt(12) * (point(i + SEEDS * ROWS, 1) - 0.5);
			fprintf(t.inputs, "%d,%d,%d\n", a, b, c);
			fprintf(t.outputs, "%.17g\n", a + b * c + 0.5 * noise);
		}
		struct reading *result = tables_close(&t, problems);
		assert_non_null(result);
		check_near(reading_number(result, "/given/samples"), ROWS, 0);
		check_near(reading_number(result, "/given/points"), 8, 0);
		assert_false(notes_have(result, "cannot separate the noise"));
		assert_true(notes_have(result, "samples with the same inputs is its noise"));
		share += reading_number(result, "/cells/0/outputs/0/noise_share") / SEEDS;
		for (int j = 0; j < 3; j++) {
			static const char *const names[] = {"S1", "ST"};
			for (int k = 0; k < 2; k++) {
				const char *at = "/cells/0/outputs/0/inputs";
				const double exact = k == 0 ? first[j] : total[j],
				             low = reading_number(result, "%s/%d/%s_low", at, j, names[k]),
				             high = reading_number(result, "%s/%d/%s_high", at, j, names[k]);
				assert_true(isfinite(low) && isfinite(high));
				missed += !(low <= exact && exact <= high);
			}
		}
		reading_close(result);
	}
	check_report("%d of %d intervals missed", missed, SEEDS * 6);
	assert_true(missed <= 0.08 * SEEDS * 6);
	check_near(share, 0.25 / (0.25 + 0.4375), 0.01);
}

static void few_different_inputs_are_refused(void **state)
{
	(void)state;
	struct tables t;
	struct problems problems[2];
	tables_open(&t, "y", "a,b");
	for (int i = 0; i < N; i++) {
		fprintf(t.inputs, "%.17g,%.17g\n", point(i / 2, 0), point(i / 2, 1));
		fprintf(t.outputs, "%d\n", i);
	}
	assert_null(tables_close(&t, problems));
	assert_string_equal(problems[GIVEN_INPUTS].list[0].detail,
	                    "the 100 complete lines are replicates of 50 points, expected at least 64 points: "
	                    "new runs at other points are needed");
}

CHECK_MAIN(cmocka_unit_test(indices_of_two_tables_are_those_of_the_engine),
           cmocka_unit_test(samples_without_a_number_are_left_out_and_counted),
           cmocka_unit_test(what_is_wrong_with_a_table_is_reported_completely),
           cmocka_unit_test(tables_that_do_not_go_together_are_refused),
           cmocka_unit_test(blank_lines_at_the_end_are_no_samples),
           cmocka_unit_test(variances_and_replicates_are_no_outputs),
           cmocka_unit_test(columns_that_do_not_make_an_output_are_refused),
           cmocka_unit_test(a_sorted_table_is_no_markov_chain),
           cmocka_unit_test(samples_at_few_points_have_the_noise_of_their_spread),
           cmocka_unit_test(few_different_inputs_are_refused))
