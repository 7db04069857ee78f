/* unit_motions.c - the ground motions of a study as files: the motions of its runs, and the same numbers in every format. */
#include <float.h>
#include <math.h>
#include <string.h>

#include "schema/examples/examples.h"
#include "schema/record/record.h"
#include "schema/result/result_json.h"
#include "schema/study/fields.h"
#include "schema/study/study_json.h"
#include "tests/support/check.h"
#include "tests/support/study_documents.h"

static struct pound_study *study_of(const char *document)
{
	struct problems problems;
	struct pound_study *study = study_from_json(document, strlen(document), &problems);
	if (!study)
		fail_msg("%s: %s", problems.list[0].pointer, problems.list[0].detail);
	return study;
}

static const char random_scene[] =
    "{\"kind\": \"response\", \"scene\": {\"oscillators\": [{\"frequency_hz\": 1}, {\"frequency_hz\": 2}], "
    "\"contact\": null, \"excitation\": {\"type\": \"kanai_tajimi\", \"signals\": 3, \"peak_m_s2\": 2.5}}}";

/* A study whose motion is taken from another study gives the responses of that study. */
static void motions_are_those_of_the_runs(void **state)
{
	(void)state;
	struct pound_study *study = study_of(random_scene), given = *study;
	struct pound_run *run = pound_run_create(study, 1);
	assert_int_equal(pound_run_block(run, 0, 0), POUND_OK);
	for (int r = 0; r < pound_run_reductions(run); r++)
		assert_int_equal(pound_run_reduce(run, r, 0), POUND_OK);
	for (int signal = 0; signal < 3; signal++) {
		const struct pound_place place = {.signal = signal};
		double step;
		const int n = pound_run_motion_samples(run, &place, &step);
		double *a = malloc((size_t)n * sizeof *a), most = 0;
		pound_run_motion(run, &place, a);
		for (int i = 0; i < n; i++)
			most = fmax(most, fabs(a[i]));
		check_near(most, 2.5, 0);
		given.scene.excitation =
		    (struct pound_excitation){.type = fields_choice(pound_excitation_name, "record"),
		                              .time_step = step,
		                              .signals = 1,
		                              .factor = 1,
		                              .n_record = n,
		                              .record = a};
		struct pound_run *again = pound_run_create(&given, 1);
		assert_int_equal(pound_run_block(again, 0, 0), POUND_OK);
		for (int r = 0; r < pound_run_reductions(again); r++)
			assert_int_equal(pound_run_reduce(again, r, 0), POUND_OK);
		check_near(pound_run_result(again)->cells[0].signals[0].displacement_max_1,
		           pound_run_result(run)->cells[0].signals[signal].displacement_max_1, 0);
		pound_run_free(again);
		free(a);
	}
	pound_run_free(run);
	study_free(study);
}

static void every_form_holds_the_same_numbers(void **state)
{
	(void)state;
	struct pound_study *study = study_of(random_scene);
	struct pound_run *run = pound_run_create(study, 1);
	const struct motion_choice all = {.signals = 3, .name = "all"};
	size_t n_csv, n_npy;
	char *csv = motions_to_csv(run, &all, &n_csv), *npy = motions_to_npy(run, &all, &n_npy), *end = csv;
	assert_non_null(csv);
	assert_non_null(npy);
	assert_memory_equal(csv, "signal,time_s,acceleration_m_s2\r\n", 33);
	int lines = 0;
	for (const char *c = csv; *c; c++)
		lines += *c == '\n';
	enum { ELEMENT = 4 + 2 * 8 };
	const char *element = npy + n_npy - (size_t)(lines - 1) * ELEMENT;
	for (end = strchr(csv, '\n') + 1; *end; element += ELEMENT) {
		int32_t signal;
		double values[2];
		memcpy(&signal, element, sizeof signal);
		memcpy(values, element + sizeof signal, sizeof values);
		assert_int_equal(strtol(end, &end, 10), signal);
		for (int j = 0; j < 2; j++)
			check_near(strtod(end + 1, &end), values[j], 0);
		end += 2;
	}
	free(csv);
	free(npy);
	pound_run_free(run);
	study_free(study);
}

static void a_peer_file_is_read_back(void **state)
{
	(void)state;
	struct pound_study *study = study_of(random_scene);
	struct pound_run *run = pound_run_create(study, 1);
	const struct motion_choice second = {
	    .place = {.signal = 1}, .one = true, .signals = 3, .name = "a study"};
	size_t length;
	char *text = motions_to_peer(run, &second, &length);
	struct record record;
	struct problems problems;
	const struct record_choice choice = {0};
	if (!record_read(text, length, &choice, &record, &problems))
		fail_msg("%s: %s", problems.list[0].pointer, problems.list[0].detail);
	double step, *a = malloc((size_t)record.n * sizeof *a);
	assert_int_equal(pound_run_motion_samples(run, &second.place, &step), record.n);
	pound_run_motion(run, &second.place, a);
	check_near(record.step, step, 0);
	assert_string_equal(record.title, "a study, signal 1");
	// rounded by the division, in decimal digits and by the product
	for (int i = 0; i < record.n; i++)
		check_near(record.acceleration[i], a[i], 2 * DBL_EPSILON * fabs(a[i]));
	record_free(&record);
	free(a);
	free(text);
	pound_run_free(run);
	study_free(study);
}

CHECK_MAIN(cmocka_unit_test(motions_are_those_of_the_runs),
           cmocka_unit_test(every_form_holds_the_same_numbers), cmocka_unit_test(a_peer_file_is_read_back))
