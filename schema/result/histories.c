/* histories.c - writes histories by signal as CSV and as a NumPy file: the motion of both oscillators of a floor spectrum study, the
 * contacts of a response study.
 *
 * Histories are not stored: the signals are run again, with bit-identical results. */
#include <assert.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>

#include "engine/solver/solver.h"
#include "schema/result/npy.h"
#include "schema/result/result_json.h"
#include "schema/study/study_json.h"

// clang-format off
#define HISTORY(X)                                            \
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

#define IMPACTS(X)                                            \
	X("time_s",                 impact->begin)                \
	X("duration_s",             impact->end - impact->begin)  \
	X("cell",                   impact->cell)                 \
	X("contact",                impact->contact)              \
	X("left_building",          row ? impact->left_building : (double)NAN) \
	X("left_level",             impact->levels[0])            \
	X("right_level",            impact->levels[1])            \
	X("approach_speed_m_s",     impact->speed)                \
	X("impulse_n_s",            impact->impulse)
// clang-format on

enum {
	COLUMNS_MAX = 10,
	ROWS_MAX = 16 * STUDY_HISTORIES_MAX, /* rows, twice what most contacts need: 800 MB as CSV */
};

static_assert(ROWS_MAX == 4000000, "a sentence below names it");

/* Columns after `signal`. */
static const struct columns {
	int n;
	const char *names[COLUMNS_MAX];
} HISTORY_COLUMNS =
#define X(name, value) name,
    {10, {HISTORY(X)}},
  IMPACT_COLUMNS = {9, {IMPACTS(X)}};
#undef X

enum format { FORMAT_CSV, FORMAT_NPY };

struct rows {
	struct writer w;
	enum format format;
	const struct columns *columns;
	int signal;
	int64_t n;
	const char *reason; /* message if there are too many rows; NULL: there are not */
};

static void row_add(struct rows *rows, const double *values)
{
	char text[WRITER_NUMBER_SIZE];
	const int32_t number = rows->signal;
	const int n = rows->columns->n;
	if (rows->format == FORMAT_NPY) {
		writer_raw(&rows->w, (const char *)&number, sizeof number);
		writer_raw(&rows->w, (const char *)values, sizeof *values * (size_t)n);
	} else {
		writer_raw(&rows->w, text, (size_t)snprintf(text, sizeof text, "%d", number));
		for (int j = 0; j < n; j++) {
			writer_raw(&rows->w, ",", 1);
			if (isfinite(values[j])) // not finite: an empty cell
				writer_raw(&rows->w, text, (size_t)writer_digits(values[j], text));
		}
		writer_raw(&rows->w, "\r\n", 2);
	}
	rows->n++;
	if (rows->n > ROWS_MAX) {
		rows->w.failed = true;
		rows->reason =
		    "the histories have more than 4000000 rows: ask for fewer signals or a shorter duration";
	}
}

#define X(name, value) value,
static void instant_add(void *into, int signal, const struct pound_instant *instant)
{
	struct rows *rows = into;
	const double values[] = {HISTORY(X)};
	rows->signal = signal;
	row_add(rows, values);
}

static void impact_add(void *into, const struct pound_impact *impact)
{
	const bool row = isfinite(impact->levels[0]);
	const double values[] = {IMPACTS(X)};
	row_add(into, values);
}
#undef X

/* The history of one signal, or of all (-1).  A failed signal has the rows up to its failure; a stopped run has no rows. */
static void rows_fill(const struct pound_study *study, struct pound_run *run, int signal, struct rows *rows)
{
	const int n = study->scene.excitation.signals, from = signal < 0 ? 0 : signal;
	for (int k = from; k < n && (signal < 0 || k == signal) && !rows->w.failed; k++) {
		rows->signal = k;
		const enum pound_status status = study->spectrum.histories
		                                     ? pound_run_history(run, k, instant_add, rows)
		                                     : pound_run_impacts(run, k, impact_add, rows);
		rows->w.failed |= status == POUND_STOPPED;
	}
}

/* Whether a study has samples that are computed by running it again: histories, or contacts of a response study within the same
 * limit on samples of ground motion. */
bool histories_exist(const struct pound_study *study)
{
	return study->spectrum.histories ||
	       (study->kind == POUND_KIND_RESPONSE && study->scene.contact.present &&
	        study->solver.method == POUND_SOLVER_EVENT &&
	        study_samples(study) * study->scene.excitation.signals * study_cells(study) <=
	            STUDY_HISTORIES_MAX);
}

static struct rows rows_of(const struct pound_study *study, enum format format)
{
	struct rows rows = {.format = format,
	                    .columns = study->spectrum.histories ? &HISTORY_COLUMNS : &IMPACT_COLUMNS};
	writer_init(&rows.w);
	return rows;
}

/* Histories as CSV.
 *
 * Given    study, run  -         -       histories_exist; blocks need not be run
 *          signal      -         -       -1: all
 * Returns  value       (length)  -       NULL: out of memory, more than ROWS_MAX rows, or the run was stopped
 *          reason      -         -       a sentence if there are too many rows, else NULL
 * Memory   allocates; the caller frees
 *
 * Test     unit_histories: a_line_for_every_sample_and_both_sides_of_every_event, a_run_that_is_stopped_leaves_no_file;
 *          unit_impacts
 */
char *histories_to_csv(const struct pound_study *study, struct pound_run *run, int signal, size_t *length,
                       const char **reason)
{
	struct rows rows = rows_of(study, FORMAT_CSV);
	writer_raw(&rows.w, "signal", 6);
	for (int j = 0; j < rows.columns->n; j++) {
		writer_raw(&rows.w, ",", 1);
		writer_cell(&rows.w, rows.columns->names[j]);
	}
	writer_raw(&rows.w, "\r\n", 2);
	rows_fill(study, run, signal, &rows);
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
	struct rows rows = rows_of(study, FORMAT_NPY);
	struct writer file, fields;
	size_t n;
	*length = 0;
	writer_init(&file);
	writer_init(&fields);
	rows_fill(study, run, signal, &rows);
	*reason = rows.reason;
	npy_field(&fields, "signal", "", "<i4");
	for (int j = 0; j < rows.columns->n; j++)
		npy_field(&fields, rows.columns->names[j], "", "<f8");
	char *records = writer_take(&rows.w, &n);
	bool headed = npy_head(&file, &fields, rows.n);
	if (records && headed)
		writer_raw(&file, records, n);
	else
		file.failed = true;
	free(records);
	return writer_take(&file, length);
}
