/* unit_failed_rows.c - possible changes of the indices by rows left out, against results with such rows added. */
#include "engine/indices/indices.h"
#include "tests/support/check.h"
#include "tests/support/functions.h"

#include <math.h>
#include <string.h>

enum { D = FUNCTION_INPUTS, SAMPLES = D + 2, N = 60, SEED = 3 };

/* Raw indices and bounds from values, some of whose rows may be missing. */
struct bounded {
	struct pound_indices of;
	struct pound_estimate first[POUND_INPUTS_MAX], total[POUND_INPUTS_MAX];
};

static struct bounded *bounded_of(const struct pound_sample_values *values, int dropped)
{
	struct bounded *b = calloc(1, sizeof *b);
	double *scratch = malloc(sizeof *scratch * pound_plain_scratch(values));
	struct pound_rows rows;
	b->of.index[POUND_S1_RAW] = b->first;
	b->of.index[POUND_ST_RAW] = b->total;
	pound_plain_indices(values, (struct pound_resampling){SEED, 8}, scratch, &b->of);
	pound_rows_init(&rows, values, scratch);
	pound_failed_rows_changes(&rows, dropped < 0 ? values->n_rows - rows.n_rows : dropped, &b->of.accuracy);
	free(scratch);
	return b;
}

/* The first n rows, followed by `copies` copies of row r. */
static struct pound_sample_values with_copies(const struct pound_sample_values *values, int r, int copies)
{
	struct pound_sample_values more = *values;
	double *y = malloc(2 * sizeof *y * (size_t)(values->n_rows + copies) * SAMPLES);
	more.n_rows = values->n_rows + copies;
	more.numerator = y;
	more.denominator = y + (size_t)more.n_rows * SAMPLES;
	for (int i = 0; i < more.n_rows; i++)
		for (int p = 0; p < SAMPLES; p++) {
			y[i * SAMPLES + p] = values->numerator[(i < values->n_rows ? i : r) * SAMPLES + p];
			y[(more.n_rows + i) * SAMPLES + p] = 1;
		}
	return more;
}

static void the_bound_is_the_largest_change_that_copies_of_a_row_make(void **state)
{
	(void)state;
	enum { COPIES = 3 };
	struct pound_sample_values values =
	    function_values(function_named("cusp"), N, SEED, (struct function_noise){1, 0, true});
	struct bounded *b = bounded_of(&values, COPIES);
	double first[D] = {0}, total[D] = {0};
	for (int r = 0; r < N; r++) {
		struct pound_sample_values more = with_copies(&values, r, COPIES);
		struct bounded *with = bounded_of(&more, 0);
		for (int j = 0; j < D; j++) {
			first[j] = fmax(first[j], fabs(with->first[j].value - b->first[j].value));
			total[j] = fmax(total[j], fabs(with->total[j].value - b->total[j].value));
			check_near(with->of.accuracy.inputs[j].first_dropped, 0, 0);
		}
		free((double *)more.numerator);
		free(with);
	}
	for (int j = 0; j < D; j++) {
		check_near(b->of.accuracy.inputs[j].first_dropped, first[j], 1e-12);
		check_near(b->of.accuracy.inputs[j].total_dropped, total[j], 1e-12);
		assert_true(first[j] > 0.005 && first[j] < 1);
	}
	free(b);
	function_values_free(&values);
}

static void rows_that_fail_move_no_index_beyond_the_bound(void **state)
{
	(void)state;
	// the first rows fail, up to 20 of them, some with extreme values
	for (int failed = 1; failed <= 20; failed++) {
		struct pound_sample_values values =
		    function_values(function_named("cusp"), N, SEED, (struct function_noise){1, 0, true});
		struct bounded *whole = bounded_of(&values, -1);
		double *y = (double *)values.numerator;
		for (int i = 0; i < failed; i++)
			y[i * SAMPLES + i % SAMPLES] = NAN;
		struct bounded *left = bounded_of(&values, -1);
		for (int j = 0; j < D; j++) {
			check_near(left->first[j].value, whole->first[j].value,
			           left->of.accuracy.inputs[j].first_dropped);
			check_near(left->total[j].value, whole->total[j].value,
			           left->of.accuracy.inputs[j].total_dropped);
		}
		free(whole), free(left);
		function_values_free(&values);
	}
}

static void nothing_is_known_where_no_row_is_left(void **state)
{
	(void)state;
	struct pound_sample_values values =
	    function_values(function_named("cusp"), N, SEED, (struct function_noise){1, 0, true});
	double *y = (double *)values.numerator;
	for (int i = 0; i < N; i++)
		y[i * SAMPLES + i % SAMPLES] = NAN;
	struct bounded *b = bounded_of(&values, -1);
	assert_true(isnan(b->of.accuracy.inputs[0].first_dropped) &&
	            isnan(b->of.accuracy.inputs[0].total_dropped));
	free(b);
	function_values_free(&values);
}

CHECK_MAIN(cmocka_unit_test(the_bound_is_the_largest_change_that_copies_of_a_row_make),
           cmocka_unit_test(rows_that_fail_move_no_index_beyond_the_bound),
           cmocka_unit_test(nothing_is_known_where_no_row_is_left))
