/* study_settings.c - the steps and tolerances that a convergence study compares. */
#include "schema/study/reader.h"

static const struct pound_settings steps = {6, {5e-3, 2e-3, 1e-3, 5e-4, 2e-4, 1e-4}};
static const struct pound_settings tolerances = {5, {1e-2, 1e-4, 1e-6, 1e-8, 1e-10}};

/* Gives every solver with a setting the default list. */
void settings_default(struct pound_study *study)
{
	for (int row = 1; row < POUND_SOLVERS; row++)
		study->convergence.settings[row] = pound_solver_takes_step(row) ? steps : tolerances;
}

/* Reads a list of settings; an empty list excludes its solver from the comparison.
 *
 * Test     unit_study_json: absent_settings_are_some_and_empty_ones_none
 */
void reader_settings(struct reader *r, const struct field *field, const cJSON *node, char *base)
{
	struct pound_settings *settings = (struct pound_settings *)(void *)(base + field->offset);
	const double *values;
	settings->n = reader_numbers(r, field, field + 1, node, &values); // its element is the next row
	for (int k = 0; k < settings->n; k++) {
		size_t length = reader_enter_element(r, k);
		settings->values[k] = values[k];
		if (k > 0 && values[k] >= values[k - 1])
			problems_add(r->problems, r->pointer, "must be smaller than the one before");
		reader_leave(r, length);
	}
}
