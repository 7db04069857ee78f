/* study_suite.c - recorded ground motions as the signals of a scene: reads their members and checks them against each other.
 *
 * 1. A record's samples are in the document, or in a file in a format of a database, which schema/record reads.
 * 2. The longest time step of the records becomes the time step of the excitation.
 * 3. The member "to" of the scale decides which other members the scale has. */
#include "schema/study/study_suite.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "schema/record/record.h"
#include "schema/study/reader.h"
#include "schema/study/study_check.h"
#include "schema/study/study_json.h"

enum { POINTER_SIZE = 80 };

static const char RECORD[] = "/scene/excitation/records/*", SCALE[] = "/scene/excitation/scale";

/* Least peak of a record that is scaled, and largest acceleration before and after a factor [m/s2]. */
static const double PEAK_LEAST = 1e-100, PEAK_MOST = 1e100;
/* Relative difference up to which two time steps count as equal, because files print few digits. */
static const double STEP_EQUAL = 1e-6;
/* Largest time step over the period of a spectral acceleration. */
static const double STEPS_MOST = 100;

int suite_room(size_t length)
{
	const size_t most = length / strlen("{\"file\":\"a\"}") + 1;
	return most < STUDY_RECORDS_MAX ? (int)most : STUDY_RECORDS_MAX;
}

/* ---- one record ---- */

/* Adds a problem of a member of the current object. */
static void complain(struct reader *r, const char *name, const char *what)
{
	const size_t length = reader_enter(r, name);
	problems_add(r->problems, r->pointer, "%s", what);
	reader_leave(r, length);
}

static bool has(const cJSON *object, const char *name)
{
	return cJSON_GetObjectItemCaseSensitive(object, name);
}

/* Adds the problems of reading a file, each with its position in the file. */
static void complain_of_file(struct reader *r, const char *name, const struct problems *of_file)
{
	char what[sizeof of_file->list[0].detail + sizeof of_file->list[0].pointer];
	for (int k = 0; k < of_file->n; k++) {
		const struct problem *p = &of_file->list[k];
		snprintf(what, sizeof what, "%s%s%s", p->pointer, *p->pointer ? ": " : "", p->detail);
		complain(r, name, what);
	}
	if (of_file->status == PROBLEMS_NOMEM)
		r->problems->status = PROBLEMS_NOMEM;
}

/* Adds a problem for each member of the document that contradicts the file. */
static void compare(struct reader *r, const struct suite_record *of, const struct record *record)
{
	char what[96];
	if (of->unit && strcmp(of->unit, record->unit) != 0) {
		snprintf(what, sizeof what, "differs from the file's, %s", record->unit);
		complain(r, "unit", what);
	}
	if (of->record.time_step > 0 && fabs(of->record.time_step / record->step - 1) > STEP_EQUAL) {
		snprintf(what, sizeof what, "differs from the file's, %.15g s", record->step);
		complain(r, "time_step_s", what);
	}
	if (of->channel > 1 && strcmp(record->format, "cosmos") != 0)
		complain(r, "channel", "is too large: the file has one acceleration");
}

/* Reads the samples of a file. */
static void read_file(struct reader *r, struct suite_record *of, struct suite_source *source)
{
	char why[STUDY_WHY_SIZE] = "cannot be read here: give acceleration_m_s2", sha256[STUDY_HASH_SIZE];
	const char *name = of->file ? "file" : "sha256";
	size_t n;
	snprintf(source->named.sha256, sizeof source->named.sha256, "%s", of->sha256 ? of->sha256 : "");
	source->named.file = of->file;
	char *text = r->files ? r->files->read(r->files->with, &source->named, &n, why) : NULL;
	if (!text) {
		complain(r, name, why);
		return;
	}
	study_digest(text, n, sha256);
	if (of->sha256 && strcmp(of->sha256, sha256) != 0) {
		snprintf(why, sizeof why, "differs from the file's, %s", sha256);
		complain(r, "sha256", why);
	}
	memcpy(source->named.sha256, sha256, sizeof sha256);
	const struct record_choice choice = {
	    .unit = of->unit, .step = of->record.time_step, .channel = of->channel};
	struct problems *problems = malloc(sizeof *problems);
	struct record record;
	if (!problems)
		r->problems->status = PROBLEMS_NOMEM;
	else if (record_read(text, n, &choice, &record, problems)) {
		compare(r, of, &record);
		of->record.n = record.n;
		of->record.time_step = record.step;
		of->record.a = source->samples = record.acceleration;
	} else
		complain_of_file(r, name, problems);
	free(problems);
	free(text);
}

static bool is_unit(const char *name)
{
	int row = 0;
	while (record_unit_name(row) && strcmp(record_unit_name(row), name) != 0)
		row++;
	return record_unit_name(row);
}

/* Samples of the records before record k. */
static double samples_before(const struct reader *r, int k)
{
	double samples = 0;
	for (int j = 0; j < k; j++)
		samples += r->study->scene.excitation.records[j].n;
	return samples;
}

static void read_record(struct reader *r, const cJSON *node, int k)
{
	struct suite_record got = {0};
	const int before = r->problems->n;
	reader_defaults(RECORD, (char *)&got);
	if (!reader_object(r, RECORD, node, (char *)&got))
		return;
	const bool inside = has(node, "acceleration_m_s2");
	if (inside == (has(node, "file") || has(node, "sha256")))
		problems_add(r->problems, r->pointer, "must have one of file and acceleration_m_s2");
	else if (inside && !has(node, "time_step_s"))
		complain(r, "time_step_s", "is required with acceleration_m_s2: a number greater than 0 s");
	else if (got.unit && !is_unit(got.unit))
		complain(r, "unit", "must be one of \"g\", \"cm/s2\", \"m/s2\"");
	if (got.sha256 && strspn(got.sha256, "0123456789abcdef") != STUDY_HASH_SIZE - 1)
		complain(r, "sha256", "must be 64 hexadecimal digits, 0 to 9 and a to f");
	for (int m = 0; m < 2; m++) {
		static const char *const of_files[] = {"unit", "channel"};
		if (inside && has(node, of_files[m]))
			complain(r, of_files[m], "is only used with file");
	}
	if (!inside && r->problems->n == before && samples_before(r, k) <= STUDY_SUITE_SAMPLES_MAX)
		read_file(r, &got, &r->suite[k]);
	if (!got.record.name)
		got.record.name = got.file;
	((struct pound_record *)r->study->scene.excitation.records)[k] = got.record; // in the study's block
}

void reader_samples(struct reader *r, const struct field *field, const cJSON *node, char *base)
{
	struct pound_record *record = &((struct suite_record *)(void *)base)->record;
	record->n = reader_numbers(r, field, field + 1, node, &record->a); // its element is the next row
}

/* Reads the records of a suite and derives the time step of the excitation.
 *
 * Test     unit_study_cases, unit_suite
 */
void reader_records(struct reader *r, const struct field *field, const cJSON *node, char *base)
{
	(void)base;
	struct pound_excitation *e = &r->study->scene.excitation;
	e->n_records = reader_each(r, field, node, read_record);
	for (int k = 0; k < e->n_records; k++)
		e->time_step = fmax(e->time_step, e->records[k].time_step);
}

/* ---- scale ---- */

/* Reads the scale of the records.
 *
 * Test     unit_study_cases
 */
void reader_scale(struct reader *r, const struct field *field, const cJSON *node, char *base)
{
	static const struct {
		const char *name;
		bool optional;
		enum pound_scale_to least; /* first scale with this member; later scales have it too */
	} members[] = {{"intensity_m_s2", false, POUND_SCALE_PGA},
	               {"period_s", false, POUND_SCALE_SA},
	               {"damping_ratio", true, POUND_SCALE_SA}};
	const struct pound_scale *scale = &r->study->scene.excitation.scale;
	if (!reader_object(r, field->pattern, node, base) ||
	    problems_at(r->problems, "/scene/excitation/scale/to"))
		return;
	for (size_t m = 0; m < sizeof members / sizeof members[0]; m++) {
		char what[160], expected[96];
		fields_expected(fields_find((snprintf(what, sizeof what, "%s/%s", SCALE, members[m].name), what)),
		                expected, sizeof expected);
		const bool used = scale->to >= (int)members[m].least, there = has(node, members[m].name);
		snprintf(what, sizeof what, used ? "is required: %s" : "is not used by scale \"%s\"",
		         used ? expected : pound_scale_name(scale->to));
		if (there != used && !(used && members[m].optional))
			complain(r, members[m].name, what);
	}
}

/* ---- all together ---- */

static double peak_of(const struct pound_record *record)
{
	double peak = 0;
	for (int i = 0; i < record->n; i++)
		peak = fmax(peak, fabs(record->a[i]));
	return peak;
}

static void check_record(const struct pound_study *study, int k, double most, struct problems *problems)
{
	const struct pound_excitation *e = &study->scene.excitation;
	const struct pound_record *record = &e->records[k];
	const double peak = peak_of(record);
	char pointer[POINTER_SIZE];
	snprintf(pointer, sizeof pointer, "/scene/excitation/records/%d", k);
	if (e->scale.to != POUND_SCALE_NONE && !(peak >= PEAK_LEAST))
		problems_add(problems, pointer, "cannot be scaled: its largest acceleration is %.3g m/s2", peak);
	if (!(peak <= PEAK_MOST) || (isfinite(most) && !(peak * record->factor * most <= PEAK_MOST)))
		problems_add(problems, pointer, "accelerations must be at most %.3g m/s2, got %.3g", PEAK_MOST,
		             peak * fmax(1, record->factor * most));
	if (e->scale.to >= POUND_SCALE_SA && record->time_step > STEPS_MOST * e->scale.period)
		problems_add(
		    problems, "/scene/excitation/scale/period_s",
		    "must be at least 1/%.0f of the time step of every record, %.15g s of record %d, got %.15g",
		    STEPS_MOST, record->time_step, k, e->scale.period);
}

/* Checks all records and their scale.
 *
 * Test     unit_study_cases
 */
void study_suite_check(const struct pound_study *study, struct problems *problems)
{
	const struct pound_excitation *e = &study->scene.excitation;
	double samples = 0, low, factor = NAN;
	if (!e->n_records || problems_at(problems, "/scene/excitation/records") ||
	    problems_at(problems, "/scene/excitation/scale"))
		return;
	if (study_check_known(study, "/excitation/factor", problems))
		study_check_reach(study, "/excitation/factor", &low, &factor);
	for (int k = 0; k < e->n_records; k++) {
		samples += e->records[k].n;
		check_record(study, k, factor, problems);
	}
	if (samples > STUDY_SUITE_SAMPLES_MAX)
		problems_exceed(problems, "/scene/excitation/records", samples, STUDY_SUITE_SAMPLES_MAX,
		                "all records together may have at most %d samples, have %.0f",
		                STUDY_SUITE_SAMPLES_MAX, samples);
}
