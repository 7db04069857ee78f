/* failed_rows.c - bound on the effect of failed rows on the indices.
 *
 * The outputs of a failed row are unknown, and runs may fail for the same reason that outputs are large.  The worst case is
 * assumed: every failed row equals the valid row that changes the index most. */
#include "engine/indices/indices.h"

#include <math.h>

/* Moments of the plain estimator, of one row. */
static void row_moments(const struct pound_rows *rows, int row, double *m)
{
	const struct pound_outputs outputs = {.y = rows->plain + (size_t)row * (size_t)rows->n_samples,
	                                      .n_inputs = rows->n_inputs};
	pound_estimator_row(0)->moments(&outputs, m);
}

/* Largest changes of the indices that failed rows can cause.
 *
 * Given    rows       n         valid rows
 *          dropped    m         number of failed rows
 * Returns  accuracy   -         first_dropped, total_dropped; 0 if no row failed, NAN if all failed
 *
 *   max over rows r of |index((n M + m M_r) / (n + m)) - index(M)|
 *
 * with M_r the moments of row r, M their means, and the index as the plain protocol estimates it.
 *
 * Valid    A bound if no failed row contributes more to the moments than the valid rows do
 * Test     unit_failed_rows
 */
void pound_failed_rows_changes(const struct pound_rows *rows, int dropped, struct pound_accuracy *accuracy)
{
	const struct pound_estimator *estimator = pound_estimator_row(0);
	const int n = rows->n_rows, d = rows->n_inputs, n_moments = estimator->n_moments(d);
	double mean[POUND_MOMENTS_MAX] = {0}, m[POUND_MOMENTS_MAX], value[2 * POUND_INPUTS_MAX];
	double changed[2 * POUND_INPUTS_MAX], worst[2 * POUND_INPUTS_MAX] = {0};
	for (int i = 0; i < n && dropped && !pound_stopped(rows->stop); i++) {
		row_moments(rows, i, m);
		for (int k = 0; k < n_moments; k++)
			mean[k] += m[k] / n;
	}
	estimator->indices(mean, d, rows->variance_floor, value);
	for (int i = 0; i < n && dropped && !pound_stopped(rows->stop); i++) {
		row_moments(rows, i, m);
		for (int k = 0; k < n_moments; k++)
			m[k] = ((double)n * mean[k] + dropped * m[k]) / (n + dropped);
		estimator->indices(m, d, rows->variance_floor, changed);
		for (int k = 0; k < 2 * d; k++)
			worst[k] = fmax(worst[k], fabs(changed[k] - value[k]));
	}
	for (int j = 0; j < d; j++) {
		bool known = !dropped || (isfinite(value[j]) && isfinite(value[d + j]));
		accuracy->inputs[j].first_dropped = known ? fmin(1, worst[j]) : NAN;
		accuracy->inputs[j].total_dropped = known ? fmin(1, worst[d + j]) : NAN;
	}
}
