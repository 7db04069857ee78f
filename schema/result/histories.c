/* histories.c - the motion of the left floor in time, signal after signal, as CSV and as a NumPy file.
 *
 * Nothing of it is stored: the signals are run once more, to the same bits. */
#include <stdio.h>
#include <stdlib.h>

#include "schema/result/npy.h"
#include "schema/result/result_json.h"

// in the order of struct pound_instant
static const char *const columns[] = {"time_s", "u_m", "v_m_s", "acceleration_m_s2", "contact_force_n"};

enum { COLUMNS = sizeof columns / sizeof columns[0] };

struct rows {
	struct writer w;
	int64_t n;
};

static void values_of(const struct pound_instant *instant, double values[COLUMNS])
{
	const double all[COLUMNS] = {instant->time, instant->u, instant->v, instant->acceleration,
	                             instant->force};
	for (int j = 0; j < COLUMNS; j++)
		values[j] = all[j];
}

static void line_add(void *into, int signal, const struct pound_instant *instant)
{
	struct rows *rows = into;
	char text[WRITER_NUMBER_SIZE];
	double values[COLUMNS];
	values_of(instant, values);
	writer_raw(&rows->w, text, (size_t)snprintf(text, sizeof text, "%d", signal));
	for (int j = 0; j < COLUMNS; j++) {
		writer_raw(&rows->w, ",", 1);
		writer_raw(&rows->w, text, (size_t)writer_digits(values[j], text));
	}
	writer_raw(&rows->w, "\r\n", 2);
}

static void record_add(void *into, int signal, const struct pound_instant *instant)
{
	struct rows *rows = into;
	const int32_t number = signal;
	double values[COLUMNS];
	values_of(instant, values);
	writer_raw(&rows->w, (const char *)&number, sizeof number);
	writer_raw(&rows->w, (const char *)values, sizeof values);
	rows->n++;
}

/* Every signal's history; of one that cannot be followed to its end there is what there is, and of a run that is stopped
 * nothing at all. */
static void rows_fill(const struct pound_study *study, struct pound_run *run, pound_run_take *take,
                      struct rows *rows)
{
	for (int signal = 0; signal < study->scene.excitation.signals && !rows->w.failed; signal++)
		if (pound_run_history(run, signal, take, rows) == POUND_STOPPED)
			rows->w.failed = true;
}

/* Histories as CSV.
 *
 * Given    study, run  -         -       a study of spectra; blocks need not be run
 * Returns  value       (length)  -       NULL: out of memory, or the run is stopped
 * Memory   allocates; the caller frees
 *
 * Test     unit_histories: a_line_for_every_sample_and_both_sides_of_every_event, a_run_that_is_stopped_leaves_no_file
 */
char *histories_to_csv(const struct pound_study *study, struct pound_run *run, size_t *length)
{
	struct rows rows = {0};
	writer_init(&rows.w);
	writer_raw(&rows.w, "signal", 6);
	for (int j = 0; j < COLUMNS; j++) {
		writer_raw(&rows.w, ",", 1);
		writer_cell(&rows.w, columns[j]);
	}
	writer_raw(&rows.w, "\r\n", 2);
	rows_fill(study, run, line_add, &rows);
	return writer_take(&rows.w, length);
}

/* Histories as a NumPy structured array, on a little-endian machine.
 *
 * Given, Returns, Memory as histories_to_csv
 *
 * Test     unit_histories: a_numpy_file_holds_the_same_numbers
 */
char *histories_to_npy(const struct pound_study *study, struct pound_run *run, size_t *length)
{
	struct rows rows = {0};
	struct writer file, fields;
	size_t n;
	*length = 0;
	writer_init(&rows.w);
	writer_init(&file);
	writer_init(&fields);
	rows_fill(study, run, record_add, &rows);
	npy_field(&fields, "signal", "", "<i4");
	for (int j = 0; j < COLUMNS; j++)
		npy_field(&fields, columns[j], "", "<f8");
	char *records = writer_take(&rows.w, &n);
	bool headed = npy_head(&file, &fields, rows.n);
	if (records && headed)
		writer_raw(&file, records, n);
	else
		file.failed = true;
	free(records);
	return writer_take(&file, length);
}
