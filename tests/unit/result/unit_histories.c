/* unit_histories.c - histories of floors as CSV and as NumPy files. */
#include <math.h>
#include <string.h>

#include "schema/result/result_json.h"
#include "schema/study/study_json.h"
#include "tests/support/check.h"
#include "tests/support/study_documents.h"

static struct pound_study *study;
static struct pound_run *run;

static int set_up(void **state)
{
	(void)state;
	char *document =
	    study_documents_with(study_documents_floor, "\"histories\": false", "\"histories\": true");
	study = study_documents_study(document);
	free(document);
	run = pound_run_create(study, 1);
	return run ? 0 : -1;
}

static int tear_down(void **state)
{
	(void)state;
	pound_run_free(run);
	study_free(study);
	return 0;
}

enum { ROWS = 20000, COLUMNS = 11 };

struct rows {
	int n;
	double values[ROWS][COLUMNS];
};

static struct rows rows;

static void row_take(void *into, int signal, const struct pound_instant *instant)
{
	struct rows *r = into;
	const double values[COLUMNS] = {signal,
	                                instant->time,
	                                instant->u[0],
	                                instant->v[0],
	                                instant->acceleration[0],
	                                instant->force,
	                                instant->u[1],
	                                instant->v[1],
	                                instant->acceleration[1],
	                                instant->gap,
	                                instant->ground};
	assert_true(r->n < ROWS);
	memcpy(r->values[r->n++], values, sizeof values);
}

static void rows_take(void)
{
	rows.n = 0;
	for (int signal = 0; signal < 3; signal++)
		assert_int_equal(pound_run_history(run, signal, row_take, &rows), POUND_OK);
	assert_true(rows.n > 3 * 201);
}

static void a_line_for_every_sample_and_both_sides_of_every_event(void **state)
{
	(void)state;
	size_t length;
	const char *reason;
	char *csv = histories_to_csv(study, run, -1, &length, &reason), *at = csv;
	assert_int_equal(strlen(csv), length);
	static const char head[] =
	    "signal,time_s,u_m,v_m_s,acceleration_m_s2,contact_force_n,u_right_m,v_right_m_s,"
	    "acceleration_right_m_s2,gap_m,ground_m_s2\r\n";
	assert_memory_equal(csv, head, sizeof head - 1);
	at = strchr(at, '\n') + 1;
	rows_take();
	for (int i = 0; i < rows.n; i++)
		for (int j = 0; j < COLUMNS; j++) {
			check_near(strtod(at, &at), rows.values[i][j], 0);
			assert_int_equal(*at, j < COLUMNS - 1 ? ',' : '\r');
			at += j < COLUMNS - 1 ? 1 : 2;
		}
	assert_int_equal(*at, 0);
	free(csv);
}

static void the_history_of_one_signal_is_its_rows_of_all(void **state)
{
	(void)state;
	size_t n_all, n;
	const char *reason;
	char *all = histories_to_csv(study, run, -1, &n_all, &reason);
	char *one = histories_to_csv(study, run, 1, &n, &reason), *lines = strchr(one, '\n') + 1;
	const char *from = strstr(all, "\r\n1,") + 2, *to = strstr(all, "\r\n2,") + 2;
	assert_int_equal(strlen(lines), to - from);
	assert_memory_equal(lines, from, (size_t)(to - from));
	free(one);
	one = histories_to_csv(study, run, 3, &n, &reason); // the study has three
	assert_int_equal(*(strchr(one, '\n') + 1), 0);
	free(one);
	free(all);
}

static void a_numpy_file_holds_the_same_numbers(void **state)
{
	(void)state;
	size_t length;
	const char *reason;
	unsigned char *npy = (unsigned char *)histories_to_npy(study, run, -1, &length, &reason);
	assert_memory_equal(npy, "\x93NUMPY\x03\x00", 8);
	size_t head = 12 + (npy[8] | (size_t)npy[9] << 8);
	assert_int_equal(head % 64, 0);
	rows_take();
	assert_int_equal(length - head, (size_t)rows.n * (4 + (COLUMNS - 1) * 8));
	for (int i = 0; i < rows.n; i++) {
		const unsigned char *at = npy + head + (size_t)i * (4 + (COLUMNS - 1) * 8);
		int32_t signal;
		double values[COLUMNS - 1];
		memcpy(&signal, at, 4);
		memcpy(values, at + 4, sizeof values);
		assert_int_equal(signal, (int)rows.values[i][0]);
		for (int j = 0; j < COLUMNS - 1; j++)
			check_near(values[j], rows.values[i][j + 1], 0);
	}
	free(npy);
}

static void a_run_that_is_stopped_leaves_no_file(void **state)
{
	(void)state;
	size_t length;
	pound_run_stop(run);
	const char *reason = NULL;
	assert_null(histories_to_csv(study, run, -1, &length, &reason));
	assert_null(reason);
	assert_null(histories_to_npy(study, run, -1, &length, &reason));
}

#define WITH_RUN(test) cmocka_unit_test_setup_teardown(test, set_up, tear_down)

CHECK_MAIN(WITH_RUN(a_line_for_every_sample_and_both_sides_of_every_event),
           WITH_RUN(the_history_of_one_signal_is_its_rows_of_all),
           WITH_RUN(a_numpy_file_holds_the_same_numbers), WITH_RUN(a_run_that_is_stopped_leaves_no_file))
