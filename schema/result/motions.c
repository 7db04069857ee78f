/* motions.c - the ground motions of a study, signal after signal, as CSV, as a NumPy file, and one of them as PEER text.
 *
 * Nothing of them is stored: they are made once more, to the same bits. */
#include <stdio.h>
#include <stdlib.h>

#include "schema/record/record.h"
#include "schema/result/npy.h"
#include "schema/result/result_json.h"

/* A ground motion; false: out of memory. */
static bool motion_of(const struct pound_run *run, const struct pound_place *place, struct record *motion)
{
	*motion = (struct record){0};
	motion->n = pound_run_motion_samples(run, place, &motion->step);
	motion->acceleration = malloc((size_t)motion->n * sizeof *motion->acceleration);
	if (motion->acceleration)
		pound_run_motion(run, place, motion->acceleration);
	return motion->acceleration;
}

typedef void put_sample(struct writer *w, int signal, double time, double acceleration);

/* The samples of the chosen signals, in turn; false: out of memory. */
static bool samples_each(const struct pound_run *run, const struct motion_choice *choice, struct writer *w,
                         put_sample *put, int64_t *n)
{
	struct pound_place place = choice->place;
	const int end = choice->one ? place.signal + 1 : choice->signals;
	for (place.signal = choice->one ? place.signal : 0; place.signal < end && !w->failed; place.signal++) {
		struct record motion;
		if (!motion_of(run, &place, &motion))
			return false;
		for (int i = 0; i < motion.n; i++)
			put(w, place.signal, i * motion.step, motion.acceleration[i]);
		*n += motion.n;
		record_free(&motion);
	}
	return !w->failed;
}

static void line_add(struct writer *w, int signal, double time, double acceleration)
{
	const double values[] = {time, acceleration};
	char text[WRITER_NUMBER_SIZE];
	writer_raw(w, text, (size_t)snprintf(text, sizeof text, "%d", signal));
	for (int j = 0; j < 2; j++) {
		writer_raw(w, ",", 1);
		writer_raw(w, text, (size_t)writer_digits(values[j], text));
	}
	writer_raw(w, "\r\n", 2);
}

static void element_add(struct writer *w, int signal, double time, double acceleration)
{
	const int32_t number = signal;
	const double values[] = {time, acceleration};
	writer_raw(w, (const char *)&number, sizeof number);
	writer_raw(w, (const char *)values, sizeof values);
}

/* Ground motions as CSV.
 *
 * Given    run      of a study with a scene; blocks need not be run
 * Returns  value    (length)   NULL: out of memory
 * Memory   allocates; the caller frees
 *
 * Test     unit_motions: every_form_holds_the_same_numbers
 */
char *motions_to_csv(const struct pound_run *run, const struct motion_choice *choice, size_t *length)
{
	static const char head[] = "signal,time_s,acceleration_m_s2\r\n";
	struct writer w;
	int64_t n = 0;
	writer_init(&w);
	writer_raw(&w, head, sizeof head - 1);
	w.failed = !samples_each(run, choice, &w, line_add, &n);
	return writer_take(&w, length);
}

/* Ground motions as a NumPy structured array, on a little-endian machine; the rest as motions_to_csv. */
char *motions_to_npy(const struct pound_run *run, const struct motion_choice *choice, size_t *length)
{
	struct writer elements, file, fields;
	size_t size;
	int64_t n = 0;
	writer_init(&elements);
	writer_init(&file);
	writer_init(&fields);
	elements.failed = !samples_each(run, choice, &elements, element_add, &n);
	npy_field(&fields, "signal", "", "<i4");
	npy_field(&fields, "time_s", "", "<f8");
	npy_field(&fields, "acceleration_m_s2", "", "<f8");
	char *bytes = writer_take(&elements, &size);
	if (npy_head(&file, &fields, n) && bytes)
		writer_raw(&file, bytes, size);
	else
		file.failed = true;
	free(bytes);
	return writer_take(&file, length);
}

/* One ground motion as a PEER file (.AT2), in g with all digits; the rest as motions_to_csv. */
char *motions_to_peer(const struct pound_run *run, const struct motion_choice *choice, size_t *length)
{
	struct record motion;
	if (!motion_of(run, &choice->place, &motion))
		return NULL;
	if (choice->records) {
		const struct pound_suite_signal signal = pound_run_motion_record(run, &choice->place);
		const char *name = choice->records[signal.record].name;
		snprintf(motion.title, sizeof motion.title, "%s, record %d times %.15g", name ? name : choice->name,
		         signal.record, signal.factor);
	} else
		snprintf(motion.title, sizeof motion.title, "%s, signal %d", choice->name, choice->place.signal);
	char *text = record_to_peer(&motion, length);
	record_free(&motion);
	return text;
}
