/* study_separation.c - studies of the gap needed: reading, checks, defaults and size. */
#include "schema/study/study_separation.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

#include "schema/study/cost.h"
#include "schema/study/study_check.h"
#include "schema/study/study_json.h"

enum {
	POINTER_SIZE = 64,
	GAPS_ROUND = 41, /* most gaps of a study that lists none */
	ROW_BYTES = 200, /* bytes in a result: of a gap with rate and curve; NUMBER_BYTES: of the gap of a run */
	NUMBER_BYTES = 22,
};

static const double probabilities_absent[] = {0.5, 0.16, 0.1, 0.05, 0.02, 0.01};

/* The lists of numbers, and their order. */
static const struct {
	const char *pattern;
	size_t n, values; /* offsets in struct pound_separation */
	int way;          /* 1: ascending, -1: descending, 0: any order */
} lists[] = {
#define LIST(name, member, way)                                             \
	{                                                                       \
		"/separation/" name, offsetof(struct pound_separation, n_##member), \
		    offsetof(struct pound_separation, member), way                  \
	}
    LIST("gaps_m", gaps, 1),
    LIST("probabilities", probabilities, 0),
    LIST("hazard/intensities", intensities, 1),
    LIST("hazard/annual_rates", rates, -1),
    LIST("return_periods_years", periods, 0),
#undef LIST
};

enum { LISTS = sizeof lists / sizeof lists[0] };

/* Reads a list of numbers.
 *
 * Test     unit_study_cases
 */
void reader_separation(struct reader *r, const struct field *field, const cJSON *node, char *base)
{
	int k = 0;
	while (strcmp(lists[k].pattern, field->pattern) != 0)
		k++;
	char *separation = base + offsetof(struct pound_study, separation);
	const double *values;
	const int n = reader_numbers(r, field, field + 1, node, &values); // its element is the next row
	memcpy(separation + lists[k].n, &n, sizeof n);
	memcpy(separation + lists[k].values, &values, sizeof(const double *));
	for (int i = 1; i < n; i++) {
		size_t length = reader_enter_element(r, i);
		if (lists[k].way > 0 && values[i] <= values[i - 1])
			problems_add(r->problems, r->pointer, "must be greater than the one before");
		if (lists[k].way < 0 && values[i] >= values[i - 1])
			problems_add(r->problems, r->pointer, "must be less than the one before");
		reader_leave(r, length);
	}
}

void reader_undesigned(struct reader *r, const cJSON *document)
{
	const cJSON *design = cJSON_GetObjectItemCaseSensitive(document, "design"), *member;
	if (!r->kind || strcmp(r->kind, "separation") != 0 ||
	    cJSON_GetObjectItemCaseSensitive(document, "inputs") || !cJSON_IsObject(design))
		return;
	cJSON_ArrayForEach(member, design)
	{
		char pointer[POINTER_SIZE];
		snprintf(pointer, sizeof pointer, "/design/%.40s", member->string);
		if (strcmp(member->string, "seed") != 0 && !problems_at(r->problems, pointer))
			problems_add(r->problems, pointer, "is not used without \"inputs\"");
	}
}

/* Index of the sweep with that path; -1: none */
static int sweep_of(const struct pound_study *study, const char *path)
{
	int s = study->n_sweeps - 1;
	while (s >= 0 && (!path || !study->sweeps[s].path || strcmp(study->sweeps[s].path, path) != 0))
		s--;
	return s;
}

static void check_intensity(const struct pound_study *study, struct problems *problems)
{
	static const char pointer[] = "/separation/intensity";
	const char *path = study->separation.intensity;
	const int s = sweep_of(study, path);
	char values[POINTER_SIZE];
	if (!path || problems_over(problems, "/sweep") || problems_at(problems, pointer))
		return;
	if (s < 0 && problems_at(problems, "/sweep"))
		return; // one of them may be meant to have that path
	if (s < 0) {
		problems_add(problems, pointer, "must be the path of a sweep, such as \"/excitation/peak_m_s2\"");
		return;
	}
	const struct pound_sweep *sweep = &study->sweeps[s];
	snprintf(values, sizeof values, "/sweep/%d/values", s);
	if (problems_at(problems, values))
		return;
	if (sweep->n_values < 2 || sweep->n_values > POUND_STRIPES_MAX)
		problems_add(problems, values, "must have 2 to %d values, as they are the intensities; has %d",
		             POUND_STRIPES_MAX, sweep->n_values);
	for (int i = 0; i < sweep->n_values; i++) {
		if (sweep->values[i] > (i ? sweep->values[i - 1] : 0))
			continue;
		snprintf(values, sizeof values, "/sweep/%d/values/%d", s, i);
		problems_add(problems, values, "must be %s, as the values are the intensities",
		             i ? "greater than the one before" : "greater than 0");
	}
}

/* Checks members against each other.
 *
 * Test     unit_study_cases
 */
void study_separation_check(const struct pound_study *study, struct problems *problems)
{
	const struct pound_separation *s = &study->separation;
	if (study->kind != POUND_KIND_SEPARATION || problems_over(problems, "/separation"))
		return;
	check_intensity(study, problems);
	if (problems_at(problems, "/separation/hazard"))
		return;
	if (s->n_intensities && s->n_intensities != s->n_rates)
		problems_add(problems, "/separation/hazard/annual_rates",
		             "must have as many elements as intensities: %d, has %d", s->n_intensities, s->n_rates);
	if (s->n_intensities && !s->intensity)
		problems_add(problems, "/separation/hazard",
		             "needs \"intensity\": the path of the sweep over the intensities");
	if (s->n_periods && !s->n_intensities)
		problems_add(problems, "/separation/return_periods_years", "needs \"hazard\"");
}

/* Fills in defaults and outputs of a valid study.
 *
 * Test     unit_separation_result: outputs_with_pounding_are_those_of_a_response
 */
void study_separation_lay(struct pound_study *study)
{
	static const char *const own[][3] = {
	    {"gap_needed_m", "peak_displacement_free_m", "peak_displacement_free_right_m"},
	    {"gap_needed_m", "level_displacement_free_left_m", "level_displacement_free_right_m"}};
	struct pound_separation *s = &study->separation;
	int rows[POUND_OUTPUTS_MAX], n = 0;
	if (study->kind != POUND_KIND_SEPARATION)
		return;
	s->stripes = s->intensity ? sweep_of(study, s->intensity) : -1;
	if (!s->n_probabilities) {
		s->probabilities = probabilities_absent;
		s->n_probabilities = sizeof probabilities_absent / sizeof probabilities_absent[0];
	}
	for (size_t k = 0; k < sizeof own[0] / sizeof own[0][0]; k++) {
		const int row = fields_choice(pound_output_name, own[study->scene.n_buildings > 0][k]);
		if (study_check_applies(study, row))
			rows[n++] = row;
	}
	s->n_own = n;
	for (int o = 0; o < study->n_outputs; o++) {
		int k = 0;
		while (k < s->n_own && rows[k] != study->outputs[o])
			k++;
		if (k == s->n_own)
			rows[n++] = study->outputs[o];
	}
	memcpy(study->outputs, rows, sizeof *rows * (size_t)n);
	study->n_outputs = n;
	s->n_own *= pound_study_gaps(study); // as study_places_lay makes one of each per contact
}

struct pound_study study_separation_like(const struct pound_study *study)
{
	struct pound_study like = *study;
	if (study->kind == POUND_KIND_SEPARATION)
		like.kind = pound_study_sampled(study) ? POUND_KIND_SENSITIVITY : POUND_KIND_RESPONSE;
	like.unbalanced = study->unbalanced || study->kind == POUND_KIND_SEPARATION;
	like.scene.contact.present = study->scene.contact.present && pound_study_pounds(study);
	return like;
}

/* Bytes of the gaps needed in a result. */
double study_separation_bytes(const struct pound_study *study)
{
	const struct pound_separation *s = &study->separation;
	const int gaps = s->n_gaps ? s->n_gaps : GAPS_ROUND;
	const double runs = pound_study_sampled(study) ? 0 : study->scene.excitation.signals;
	if (study->kind != POUND_KIND_SEPARATION)
		return 0;
	return study_cells(study) * pound_study_gaps(study) *
	       (ROW_BYTES * (2.0 * gaps + s->n_probabilities) + NUMBER_BYTES * runs);
}
