/* given_repeats.c - repeated inputs of given data: replicates of a random model, levels, factorial designs. */
#include <gsl/gsl_cdf.h>
#include <gsl/gsl_sort_double.h>
#include <string.h>

#include "engine/given.h"
#include "engine/indices/indices.h"
#include "engine/numeric/hash.h"

enum {
	ROWS_PER_VALUE = 5, // of an input with few values, on average
};

/* ---- replicates ---- */

int pound_given_join_slots(int n_rows)
{
	return pound_hash_slots(n_rows);
}

/* Some adjacent columns of the inputs. */
struct columns {
	int n_rows, n_inputs, first, n;
	const double *x; /* (n_rows x n_inputs) */
};

/* Numbers the rows by their values in some columns, in the order of appearance.
 *
 * Returns  number  (n_rows)
 *          value   how many different ones
 */
static int distinct_number(const struct columns *of, int *table, int *number)
{
	const int n_rows = of->n_rows, n_inputs = of->n_inputs, n = of->n;
	const double *x = of->x + of->first;
	const int slots = pound_hash_slots(n_rows);
	int distinct = 0;
	memset(table, -1, sizeof *table * (size_t)slots);
	for (int i = 0; i < n_rows; i++) {
		double key[POUND_INPUTS_MAX];
		for (int j = 0; j < n; j++)
			key[j] = x[(size_t)i * n_inputs + j] + 0.0; // -0 equals 0
		int slot = pound_hash_slot(0, key, n, slots), same = -1;
		for (; same < 0 && table[slot] >= 0; slot = (slot + 1) & (slots - 1)) {
			const double *other = x + (size_t)table[slot] * n_inputs;
			bool equal = true;
			for (int j = 0; j < n; j++)
				equal &= other[j] == key[j];
			same = equal ? number[table[slot]] : -1;
		}
		if (same < 0)
			table[slot] = i;
		number[i] = same < 0 ? distinct++ : same;
	}
	return distinct;
}

/* Joins rows with the same values of all inputs into samples.
 *
 * Given    x        (n_rows x n_inputs)       finite
 * Returns  sample   (n_rows)                  of each row, in the order of their first rows
 *          value    -                         number of samples; n_rows: no row has replicates
 * Memory   table    (pound_given_join_slots)
 *
 * Repeats are replicates if some input has another value in more than half of the different samples: points that were drawn, and
 * run several times.  Inputs that all have few values repeat each other's combinations by chance or by design: their frequencies
 * are those of the distribution, and each row is a sample.  So is each row with one input alone.
 *
 * Test     unit_given_repeats: rows_with_the_same_inputs_are_replicates_unless_all_inputs_have_few_values
 */
int pound_given_join(int n_rows, int n_inputs, const double *x, int *table, int *sample)
{
	int most = 0;
	for (int j = 0; j < n_inputs; j++) {
		const int values = distinct_number(&(struct columns){n_rows, n_inputs, j, 1, x}, table, sample);
		most = values > most ? values : most;
	}
	const int n = pound_given_points(n_rows, n_inputs, x, table, sample);
	if (n < n_rows && n_inputs > 1 && 2 * most > n)
		return n;
	for (int i = 0; i < n_rows; i++)
		sample[i] = i;
	return n_rows;
}

/* Numbers the rows by the values of all inputs, in the order of appearance.
 *
 * Test     unit_given_table: samples_at_few_points_have_the_noise_of_their_spread
 */
int pound_given_points(int n_rows, int n_inputs, const double *x, int *table, int *point)
{
	return distinct_number(&(struct columns){n_rows, n_inputs, 0, n_inputs, x}, table, point);
}

/* ---- distributions ---- */

/* Row of the discrete distribution. */
static int discrete_row(void)
{
	int row = 0;
	while (!pound_distribution_steps(row))
		row++;
	return row;
}

/* How evenly the rows are spread over the combinations of the levels: chi square of equal numbers; 0: exactly. */
static double unevenness(const struct pound_given *given, int cells, size_t *count)
{
	const double each = (double)given->n_rows / cells;
	double sum = 0.0;
	memset(count, 0, sizeof *count * (size_t)cells);
	for (int i = 0; i < given->n_rows; i++)
		count[given->cell[i]]++;
	for (int c = 0; c < cells; c++)
		sum += (count[c] - each) * (count[c] - each) / each;
	return sum;
}

/* Whether the numbers of rows are more equal than random levels have them in one of a hundred cases. */
static bool almost_equal(double uneven, int cells)
{
	return uneven > 0.0 && gsl_cdf_chisq_P(uneven, cells - 1.0) < 0.01;
}

/* Empirical distributions: each value with its frequency; and whether the rows are a complete factorial design.
 *
 * Given    given      n_rows, n_inputs, x, inputs with names
 * Returns  inputs     distributions, which point into values
 *          given      replicates, unbalanced, levels, cell
 * Memory   values     (2 x n_inputs x n_rows)
 *          cell       (n_rows)  held by given
 *          order      (n_rows)
 *
 * Test     unit_given_data: an_input_of_few_values_is_discrete
 */
void pound_given_inputs(struct pound_given *given, double *values, int *cell, size_t *order)
{
	const int n = given->n_rows, d = given->n_inputs;
	int cells = 1; // combinations of levels; 0: more than rows
	given->cell = cell;
	memset(cell, 0, sizeof *cell * (size_t)n);
	for (int j = 0; j < d; j++) {
		double *value = values + (size_t)j * 2 * n, *weight = value + n;
		int distinct = 0;
		gsl_sort_index(order, given->x + j, (size_t)d, (size_t)n);
		for (int k = 0; k < n; k++) {
			const double x = given->x[order[k] * (size_t)d + j];
			if (distinct == 0 || x != value[distinct - 1]) {
				value[distinct] = x;
				weight[distinct++] = 0.0;
			}
			weight[distinct - 1]++;
			given->levels[j] = distinct;
		}
		cells = cells > n / distinct ? 0 : cells * distinct;
		for (int k = 0, level = -1; k < n && cells > 0; k++) {
			level += k == 0 || given->x[order[k] * (size_t)d + j] != given->x[order[k - 1] * (size_t)d + j];
			cell[order[k]] = cell[order[k]] * distinct + level;
		}
		given->inputs[j].distribution = (struct pound_distribution){
		    .type = discrete_row(), .n_values = distinct, .values = value, .weights = weight};
	}
	// one input with another value in every row has no levels
	const bool levels = cells > 0 && (d > 1 || cells < n);
	const double uneven = levels ? unevenness(given, cells, order) : 0.0;
	const bool factorial = levels && uneven == 0.0;
	given->replicates = factorial ? n / cells : 0;
	given->unbalanced = d > 1 && levels && almost_equal(uneven, cells);
	for (int j = 0; j < d && !factorial; j++) {
		struct pound_distribution *distribution = &given->inputs[j].distribution;
		double *value = values + (size_t)j * 2 * n, *weight = value + n;
		// few samples with few repeated values: a continuous input; all n values are listed, so that it has no levels
		if (distribution->n_values > POUND_CURVE || n >= ROWS_PER_VALUE * distribution->n_values)
			continue;
		gsl_sort_index(order, given->x + j, (size_t)d, (size_t)n);
		for (int k = 0; k < n; k++) {
			value[k] = given->x[order[k] * (size_t)d + j];
			weight[k] = 1.0;
		}
		distribution->n_values = n;
	}
}
