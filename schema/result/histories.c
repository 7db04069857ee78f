/* histories.c - the motion of both oscillators in time, signal after signal, as CSV and as a NumPy file.
 *
 * Nothing of it is stored: the signals are run once more, to the same bits. */
#include <assert.h>
#include <stdio.h>
#include <stdlib.h>

#include "schema/result/npy.h"
#include "schema/result/result_json.h"
#include "schema/study/study_json.h"

// clang-format off
#define COLUMNS(X)                                            \
	X("time_s",                 instant->time)                \
	X("u_m",                    instant->u[0])                \
	X("v_m_s",                  instant->v[0])                \
	X("acceleration_m_s2",      instant->acceleration[0])     \
	X("contact_force_n",        instant->force)               \
	X("u_right_m",              instant->u[1])                \
	X("v_right_m_s",            instant->v[1])                \
	X("acceleration_right_m_s2", instant->acceleration[1])    \
	X("gap_m",                  instant->gap)                 \
	X("ground_m_s2",            instant->ground)
// clang-format on

#define X(name, value) name,
static const char *const columns[] = {COLUMNS(X)};
#undef X

enum {
	N_COLUMNS = sizeof columns / sizeof columns[0],
	ROWS_MAX = 16 * STUDY_HISTORIES_MAX, /* rows, twice what most contacts need: 800 MB as CSV */
};

static_assert(ROWS_MAX == 4000000, "a sentence below names it");

struct rows {
	struct writer w;
	int64_t n;
	const char *reason; /* why there are too many; NULL: there are not */
};

static void values_of(const struct pound_instant *instant, double values[N_COLUMNS])
{
#define X(name, value) value,
	const double all[N_COLUMNS] = {COLUMNS(X)};
#undef X
	for (int j = 0; j < N_COLUMNS; j++)
		values[j] = all[j];
}

static void row_count(struct rows *rows)
{
	rows->n++;
	if (rows->n > ROWS_MAX) {
		rows->w.failed = true;
		rows->reason =
		    "the histories have more than 4000000 rows: ask for fewer signals or a shorter duration";
	}
}

static void line_add(void *into, int signal, const struct pound_instant *instant)
{
	struct rows *rows = into;
	char text[WRITER_NUMBER_SIZE];
	double values[N_COLUMNS];
	values_of(instant, values);
	writer_raw(&rows->w, text, (size_t)snprintf(text, sizeof text, "%d", signal));
	for (int j = 0; j < N_COLUMNS; j++) {
		writer_raw(&rows->w, ",", 1);
		writer_raw(&rows->w, text, (size_t)writer_digits(values[j], text));
	}
	writer_raw(&rows->w, "\r\n", 2);
	row_count(rows);
}

static void record_add(void *into, int signal, const struct pound_instant *instant)
{
	struct rows *rows = into;
	const int32_t number = signal;
	double values[N_COLUMNS];
	values_of(instant, values);
	writer_raw(&rows->w, (const char *)&number, sizeof number);
	writer_raw(&rows->w, (const char *)values, sizeof values);
	row_count(rows);
}

/* The history of a signal, or of every one; of one that cannot be followed to its end there is what there is, and of a run that is stopped
 * nothing at all. */
static void rows_fill(const struct pound_study *study, struct pound_run *run, int signal,
                      pound_run_take *take, struct rows *rows)
{
	const int n = study->scene.excitation.signals, from = signal < 0 ? 0 : signal;
	for (int k = from; k < n && (signal < 0 || k == signal) && !rows->w.failed; k++)
		if (pound_run_history(run, k, take, rows) == POUND_STOPPED)
			rows->w.failed = true;
}

/* Histories as CSV.
 *
 * Given    study, run  -         -       a study of spectra; blocks need not be run
 *          signal      -         -       -1: every one
 * Returns  value       (length)  -       NULL: out of memory or more than ROWS_MAX rows, or the run is stopped
 *          reason      -         -       set where there are too many rows: a sentence
 * Memory   allocates; the caller frees
 *
 * Test     unit_histories: a_line_for_every_sample_and_both_sides_of_every_event, a_run_that_is_stopped_leaves_no_file
 */
char *histories_to_csv(const struct pound_study *study, struct pound_run *run, int signal, size_t *length,
                       const char **reason)
{
	struct rows rows = {0};
	writer_init(&rows.w);
	writer_raw(&rows.w, "signal", 6);
	for (int j = 0; j < N_COLUMNS; j++) {
		writer_raw(&rows.w, ",", 1);
		writer_cell(&rows.w, columns[j]);
	}
	writer_raw(&rows.w, "\r\n", 2);
	rows_fill(study, run, signal, line_add, &rows);
	*reason = rows.reason;
	return writer_take(&rows.w, length);
}

/* Histories as a NumPy structured array, on a little-endian machine.
 *
 * Given, Returns, Memory as histories_to_csv
 *
 * Test     unit_histories: a_numpy_file_holds_the_same_numbers
 */
char *histories_to_npy(const struct pound_study *study, struct pound_run *run, int signal, size_t *length,
                       const char **reason)
{
	struct rows rows = {0};
	struct writer file, fields;
	size_t n;
	*length = 0;
	writer_init(&rows.w);
	writer_init(&file);
	writer_init(&fields);
	rows_fill(study, run, signal, record_add, &rows);
	*reason = rows.reason;
	npy_field(&fields, "signal", "", "<i4");
	for (int j = 0; j < N_COLUMNS; j++)
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
