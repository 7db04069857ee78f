/* samples.c - writes all samples of a sensitivity study, inputs and outputs, as CSV and as a NumPy file.
 *
 * By cell, row i, samples A_i, B_i, AB_i of each input, and further mixtures of A and B if the design has them: the order that
 * `pound indices` reads. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "schema/json/json_writer.h"
#include "schema/result/npy.h"
#include "schema/result/result_json.h"
#include "schema/study/fields.h"
#include "schema/study/study_json.h"
#include "schema/study/study_spectrum.h"

/* One line of the table. */
struct sample {
	const struct pound_study *study;
	const struct pound_run *run;
	struct pound_scene scene; /* of the cell */
	int cell, row, sample;
	double x[POUND_INPUTS_MAX];
};

typedef void put_sample(struct writer *w, const struct sample *sample);

/* Calls put for every sample; sets w->failed if the run is stopped meanwhile. */
static void samples_each(const struct pound_study *study, const struct pound_run *run, struct writer *w,
                         put_sample *put)
{
	struct sample s = {.study = study, .run = run};
	for (s.cell = 0; s.cell < study_cells(study); s.cell++) {
		study_cell(study, s.cell, &s.scene);
		for (s.row = 0; s.row < pound_run_rows(run) && !w->failed; s.row++) {
			w->failed = pound_run_stopped(run);
			for (s.sample = 0; s.sample < pound_run_samples(run); s.sample++) {
				pound_run_sample_inputs(run, s.row, s.sample, s.x);
				put(w, &s);
			}
		}
	}
}

/* An output and its variance, NAN if the cell does not have the output. */
static void output_of(const struct sample *s, int o, double *mean, double *variance)
{
	struct pound_sample_output output = {NAN, NAN};
	if (pound_output_applies(s->study->outputs[o], &s->scene))
		output = pound_run_sample_output(s->run, s->cell, s->row, s->sample, o);
	*mean = output.mean;
	*variance = output.variance;
}

/* ---- CSV ---- */

static void put_number(struct writer *w, double value)
{
	char digits[WRITER_NUMBER_SIZE];
	if (!isnan(value))
		writer_raw(w, digits, (size_t)writer_digits(value, digits));
}

static void put_text(struct writer *w, const char *prefix, const char *text, const char *suffix)
{
	char whole[512];
	snprintf(whole, sizeof whole, "%s%s%s", prefix, text, suffix);
	writer_cell(w, whole);
}

static void put_header(struct writer *w, const struct pound_study *study)
{
	char name[STUDY_OUTPUT_SIZE];
	for (int s = 0; s < study->n_sweeps; s++) {
		put_text(w, "", study->sweeps[s].path, "");
		writer_raw(w, ",", 1);
	}
	writer_raw(w, "row,sample", 10);
	for (int j = 0; j < study->n_inputs; j++) {
		writer_raw(w, ",", 1);
		put_text(w, "", study->inputs[j].name, "");
	}
	for (int o = 0; o < study->n_outputs; o++) {
		writer_raw(w, ",", 1);
		put_text(w, "", study_output_name(study, o, name), "");
		writer_raw(w, ",", 1);
		put_text(w, "", study_output_name(study, o, name), ".variance");
	}
	writer_raw(w, "\r\n", 2);
}

/* "A", "B", or a mixture: the matrix of most columns, the other one, and the names of the inputs from the other: "AB_f_2". */
static void put_sample_name(struct writer *w, const struct pound_study *study, int sample)
{
	char name[2 + POUND_INPUTS_MAX * 128];
	const unsigned from_b = pound_design_mask(study, sample), all = pound_inputs_all(study->n_inputs);
	const bool mostly_b =
	    sample == 1 || (sample >= 2 + study->n_inputs && 2 * __builtin_popcount(from_b) > study->n_inputs);
	const unsigned named = mostly_b ? all ^ from_b : from_b;
	int n = snprintf(name, sizeof name, "%s", mostly_b ? named ? "BA" : "B" : named ? "AB" : "A");
	for (int j = 0; j < study->n_inputs; j++)
		if (named >> j & 1)
			n += snprintf(name + n, sizeof name - (size_t)n, "_%s", study->inputs[j].name);
	writer_cell(w, name);
}

static void put_line(struct writer *w, const struct sample *s)
{
	char number[16];
	for (int k = 0; k < s->study->n_sweeps; k++) {
		const struct pound_sweep *sweep = &s->study->sweeps[k];
		double value = study_cell_sweep(s->study, s->cell, k);
		const char *choice = study_choice(sweep->path, value);
		if (choice)
			put_text(w, "", choice, "");
		else
			put_number(w, value);
		writer_raw(w, ",", 1);
	}
	writer_raw(w, number, (size_t)snprintf(number, sizeof number, "%d,", s->row));
	put_sample_name(w, s->study, s->sample);
	for (int j = 0; j < s->study->n_inputs; j++) {
		writer_raw(w, ",", 1);
		put_number(w, s->x[j]);
	}
	for (int o = 0; o < s->study->n_outputs; o++) {
		double mean, variance;
		output_of(s, o, &mean, &variance);
		writer_raw(w, ",", 1);
		put_number(w, mean);
		writer_raw(w, ",", 1);
		put_number(w, variance);
	}
	writer_raw(w, "\r\n", 2);
}

bool samples_exist(const struct pound_study *study)
{
	return pound_study_sampled(study) || histories_exist(study);
}

/* The samples as CSV; missing values are empty cells.
 *
 * Given    study, run  -         -       a finished sensitivity study
 * Returns  value       (length)  -       NULL: out of memory, or the run is stopped
 * Memory   allocates; the caller frees
 *
 * Test     unit_samples: a_line_for_every_sample_in_the_order_of_the_design
 */
char *samples_to_csv(const struct pound_study *study, const struct pound_run *run, size_t *length)
{
	struct writer w;
	writer_init(&w);
	put_header(&w, study);
	samples_each(study, run, &w, put_line);
	return writer_take(&w, length);
}

/* ---- NumPy ---- */

enum { CHOICE_SIZE = 32 }; // bytes of a swept choice's name

static bool put_npy_head(struct writer *w, const struct pound_study *study, int64_t n)
{
	struct writer record;
	char name[STUDY_OUTPUT_SIZE];
	writer_init(&record);
	for (int s = 0; s < study->n_sweeps; s++)
		npy_field(&record, study->sweeps[s].path, "", study_choice(study->sweeps[s].path, 0) ? "S32" : "<f8");
	npy_field(&record, "row", "", "<i4");
	npy_field(&record, "sample", "", "<i4");
	for (int j = 0; j < study->n_inputs; j++)
		npy_field(&record, study->inputs[j].name, "", "<f8");
	for (int o = 0; o < study->n_outputs; o++) {
		npy_field(&record, study_output_name(study, o, name), "", "<f8");
		npy_field(&record, study_output_name(study, o, name), ".variance", "<f8");
	}
	return npy_head(w, &record, n);
}

static void put_record(struct writer *w, const struct sample *s)
{
	for (int k = 0; k < s->study->n_sweeps; k++) {
		const struct pound_sweep *sweep = &s->study->sweeps[k];
		double value = study_cell_sweep(s->study, s->cell, k);
		const char *choice = study_choice(sweep->path, value);
		char bytes[CHOICE_SIZE] = {0};
		if (choice)
			memcpy(bytes, choice, strnlen(choice, sizeof bytes));
		writer_raw(w, choice ? bytes : (const char *)&value, choice ? sizeof bytes : sizeof value);
	}
	const int32_t at[2] = {s->row, s->sample};
	writer_raw(w, (const char *)at, sizeof at);
	writer_raw(w, (const char *)s->x, sizeof(double) * (size_t)s->study->n_inputs);
	for (int o = 0; o < s->study->n_outputs; o++) {
		double pair[2];
		output_of(s, o, &pair[0], &pair[1]);
		writer_raw(w, (const char *)pair, sizeof pair);
	}
}

/* The samples as a NumPy structured array, on a little-endian machine; `sample` is 0 for A, 1 for B, 2 + j for
 * AB of input j; swept choices are byte strings, missing values NaN.
 *
 * Given    study, run  -         -       a finished sensitivity study
 * Returns  value       (length)  -       the bytes of an .npy file; NULL: out of memory, or the run is stopped
 * Memory   allocates; the caller frees
 *
 * Source   numpy.lib.format, version 3.0
 * Test     unit_samples: a_numpy_file_holds_the_same_numbers
 */
char *samples_to_npy(const struct pound_study *study, const struct pound_run *run, size_t *length)
{
	struct writer w;
	*length = 0;
	writer_init(&w);
	int64_t n = (int64_t)study_cells(study) * pound_run_rows(run) * pound_run_samples(run);
	if (!put_npy_head(&w, study, n))
		return NULL;
	samples_each(study, run, &w, put_record);
	return writer_take(&w, length);
}
