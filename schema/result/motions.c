/* motions.c - writes the ground motions of a study by signal as CSV and as a NumPy file, and one of them as a PEER file.
 *
 * Ground motions are not stored: they are generated again, with bit-identical results. */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "schema/record/record.h"
#include "schema/result/motion_spectrum.h"
#include "schema/result/npy.h"
#include "schema/result/result_json.h"
#include "schema/study/study_json.h"

bool motions_choose(const struct pound_study *study, const struct pound_run *run, struct pound_place place,
                    struct motion_choice *choice, char why[static 100])
{
	const int signals = study->scene.excitation.signals;
	const struct {
		const char *what;
		int least, value, most;
	} limits[] = {{"cell", 0, place.cell, study_cells(study) - 1},
	              {"row", 1, place.row + 1, pound_run_rows(run)},
	              {"signal", 0, place.signal < 0 ? 0 : place.signal, signals - 1}};
	for (int k = 0; k < 3; k++)
		if (limits[k].value < limits[k].least || limits[k].value > limits[k].most) {
			snprintf(why, 100, "%s must be a whole number from %d to %d, got %d", limits[k].what,
			         limits[k].least, limits[k].most, limits[k].value);
			return false;
		}
	*choice = (struct motion_choice){
	    .place = place,
	    .one = place.signal >= 0,
	    .signals = signals,
	    .records = study->scene.excitation.n_records ? study->scene.excitation.records : NULL,
	    .name = study->name ? study->name : "a ground motion"};
	choice->place.signal = choice->one ? place.signal : 0;
	return true;
}

int64_t motions_samples(const struct pound_run *run, const struct motion_choice *choice)
{
	struct pound_place place = choice->place;
	const int end = choice->one ? place.signal + 1 : choice->signals;
	int64_t n = 0;
	for (double step; place.signal < end; place.signal++)
		n += pound_run_motion_samples(run, &place, &step);
	return n;
}

/* Generates a ground motion; false: out of memory. */
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

/* Calls put for every sample of the chosen signals, in order; false: out of memory. */
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

/* Ground motions as a NumPy structured array, on a little-endian machine; otherwise as motions_to_csv. */
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

/* One ground motion as a PEER file (.AT2), in g with all digits; otherwise as motions_to_csv. */
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

/* Adds the rows of one ground motion; false: out of memory or a failed run. */
static bool spectrum_add(struct writer *w, const struct pound_run *run, const struct motion_choice *choice,
                         const struct pound_place *place, const struct periods *periods)
{
	double psa[PERIODS_MAX];
	struct record motion;
	const bool has = motion_of(run, place, &motion) && motion_spectrum(&motion, periods, psa) == POUND_OK;
	record_free(&motion);
	for (int k = 0; k < periods->n && has; k++) {
		char text[4 * WRITER_NUMBER_SIZE];
		const double values[] = {periods->period[k], psa[k]};
		writer_raw(w, text, (size_t)snprintf(text, sizeof text, "%d", place->signal));
		if (choice->records) {
			const struct pound_suite_signal signal = pound_run_motion_record(run, place);
			writer_raw(w, text, (size_t)snprintf(text, sizeof text, ",%d,", signal.record));
			writer_raw(w, text, (size_t)writer_digits(signal.factor, text));
		}
		for (int j = 0; j < 2; j++) {
			writer_raw(w, ",", 1);
			writer_raw(w, text, (size_t)writer_digits(values[j], text));
		}
		writer_raw(w, "\n", 1);
	}
	return has;
}

/* Response spectra as CSV.
 *
 * Given    periods  at least one
 * Returns  value    (length)   NULL: out of memory
 * Memory   allocates; the caller frees
 *
 * Test     client_suite: spectra_name_the_records
 */
char *motions_to_spectra(const struct pound_run *run, const struct motion_choice *choice,
                         const struct periods *periods, size_t *length)
{
	struct writer w;
	struct pound_place place = choice->place;
	const int end = choice->one ? place.signal + 1 : choice->signals;
	const char *head =
	    choice->records ? "signal,record,factor,period_s,psa_m_s2\n" : "signal,period_s,psa_m_s2\n";
	writer_init(&w);
	writer_raw(&w, head, strlen(head));
	for (; place.signal < end && !w.failed; place.signal++)
		w.failed |= !spectrum_add(&w, run, choice, &place, periods);
	return writer_take(&w, length);
}
