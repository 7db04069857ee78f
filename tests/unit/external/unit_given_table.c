/* unit_given_table.c - tables of samples as CSV: what is refused, and whether the numbers in the result are the engine's. */
#include <math.h>
#include <string.h>

#include "engine/given.h"
#include "schema/external/given_table.h"
#include "schema/json/json_pointer.h"
#include "tests/support/check.h"

enum { N = 100 };

/* Points of a lattice of two inputs and their sum: a column for each letter, a, b or y, and 1 for a constant; of samples
 * first to end-1 the last column is missing. */
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
	struct problems problems;
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
		// outputs in a table with the inputs again are the same outputs
		read_all(&x, &y, one, k ? both : two);
		char *json = given_indices(&x, &y, &problems, &n);
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
	struct problems problems;
	size_t n;
	char *one = text_of("a,b", "ab", 3, 10), *two = text_of("y", "y", 8, 12), *few = text_of("y", "y", 0, 40);
	read_all(&x, &y, one, two);
	char *json = given_indices(&x, &y, &problems, &n);
	assert_non_null(json);
	struct reading *result = reading_open(json, n);
	check_near(reading_number(result, "/given/samples"), N - 9, 0);
	check_near(reading_number(result, "/given/samples_missing"), 9, 0);
	reading_close(result);
	free(json);
	given_table_free(&x);
	given_table_free(&y);
	read_all(&x, &y, one, few);
	assert_null(given_indices(&x, &y, &problems, &n));
	assert_string_equal(
	    problems.list[0].detail,
	    "60 samples are complete, expected at least 64; with fewer runs use a study: `pound design'");
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
	    {"a,b\n1,inf\n2\n", "line 3", "has 1 cells, the header has 2"},
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
	struct problems problems;
	size_t n;
	char *one = text_of("a,b", "ab", 0, 0), *two = text_of("y", "y", 0, 0),
	     *same = text_of("a,b", "a1", 0, 0), *other = text_of("b,y", "ay", 0, 0);
	const struct {
		const char *x, *y, *words;
	} bad[] = {
	    {one, "y\n1\n2\n", "has 2 samples, but the inputs have 100"},
	    {same, two, "has the same value in every complete sample; leave this input out"},
	    {one, one, "has no column of an output"},
	    {one, other, "is 1, but the inputs have 37; check the order of the lines"},
	};
	for (size_t k = 0; k < sizeof bad / sizeof bad[0]; k++) {
		read_all(&x, &y, bad[k].x, bad[k].y);
		assert_null(given_indices(&x, &y, &problems, &n));
		assert_int_equal(problems.status, PROBLEMS_INVALID);
		assert_non_null(strstr(problems.list[0].detail, bad[k].words));
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
	// of one column an empty cell is a missing number
	given_table_read(&x, GIVEN_INPUTS, one, sizeof one - 1, &problems);
	assert_int_equal(x.n_rows, 2);
	given_table_free(&x);
}

CHECK_MAIN(cmocka_unit_test(indices_of_two_tables_are_those_of_the_engine),
           cmocka_unit_test(samples_without_a_number_are_left_out_and_counted),
           cmocka_unit_test(what_is_wrong_with_a_table_is_reported_completely),
           cmocka_unit_test(tables_that_do_not_go_together_are_refused),
           cmocka_unit_test(blank_lines_at_the_end_are_no_samples))
