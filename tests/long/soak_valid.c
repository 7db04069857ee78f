/* Valid studies at random, CPU time against the estimate: a histogram. */
#include <math.h>

#include "schema/study/cost.h"
#include "schema/study/study_json.h"
#include "tests/support/check.h"
#include "tests/support/valid_studies.h"

enum { STUDIES = 500, BINS = 13 };

/* [s] largest estimate of a study; times below LEAST count as equal; a study is stopped if it exceeds LONG and its
 * upper estimate */
static const double CPU_MOST = 1.5, LEAST = 0.003, LONG = 6;

static const double FACTOR = 3;

/* Groups of studies by their contacts. */
static const char *const groups[] = {"pairs in linear contact", "rows without contact", "chains with gaps",
                                     "chains that touch at rest"};

/* Per cent of all studies: the least within the factor; the most that take more than three times the estimate; the
 * most that also exceed the upper estimate, as the few trial runs of a study may be among its shorter ones. */
enum { GROUPS = sizeof groups / sizeof groups[0], NEAR_PERCENT = 97, UNDER_PERCENT = 1, HIGH_PERCENT = 3 };

static int group_of(const struct pound_study *study)
{
	const struct pound_contact *contact = &study->scene.contact;
	const bool row = study->scene.n_buildings > 0,
	           linear = !contact->present || pound_contact_force(contact->model) == POUND_FORCE_LINEAR;
	return !row && linear ? 0 : !contact->present ? 1 : contact->gap > 0 ? 2 : 3;
}

/* results of a group */
struct found {
	int n, near, under, high;
	double late, early;
};

static void valid_studies_take_what_is_estimated_before(void **state)
{
	static char text[VALID_STUDY_SIZE];
	int bins[BINS] = {0}, drawn = 0;
	struct found found[GROUPS] = {{0}};
	(void)state;
	uint64_t seed = 1;
	for (int n = 0; n < STUDIES; seed = 0) {
		struct pound_study *study = valid_study(seed, text, &drawn);
		struct cost cost = cost_of(study, 1);
		if (cost.cpu_s <= CPU_MOST) {
			cost_try(&cost, study, NULL);
			// times that the clock cannot resolve count as LEAST
			const double s = fmax(valid_study_taken(study, fmax(LONG, 1.1 * cost.cpu_s_high)), LEAST),
			             ratio = s / fmax(cost.cpu_s, LEAST);
			const int bin = (int)floor(log2(ratio) + 0.5 * BINS);
			struct found *of = &found[group_of(study)];
			bins[bin < 0 ? 0 : bin >= BINS ? BINS - 1 : bin]++;
			of->late = fmax(of->late, ratio);
			of->early = fmax(of->early, 1 / ratio);
			of->near += ratio <= FACTOR && ratio >= 1 / FACTOR;
			of->under += ratio > FACTOR;
			of->high += s > fmax(cost.cpu_s_high, LEAST);
			of->n++;
			n++;
			if (ratio > FACTOR || ratio < 1 / FACTOR)
				check_report("taken over estimated %.2f: %s", ratio, text);
		}
		study_free(study);
	}
	for (int b = 0; b < BINS; b++)
		check_report("taken over estimated %7.3f to %7.3f: %d", exp2(b - 0.5 * BINS),
		             exp2(b + 1 - 0.5 * BINS), bins[b]);
	check_report("%d valid studies of %d drawn", STUDIES, drawn);
	for (int g = 0; g < GROUPS; g++)
		check_report("%s: %d of %d within %g; under by more: %d; over the upper estimate: %d; at most %.1f "
		             "times the estimate, at least 1/%.1f",
		             groups[g], found[g].near, found[g].n, FACTOR, found[g].under, found[g].high,
		             found[g].late, found[g].early);
	int near = 0, under = 0, high = 0;
	for (int g = 0; g < GROUPS; g++) {
		assert_true(found[g].n > 0);
		near += found[g].near;
		under += found[g].under;
		high += found[g].high;
	}
	check_report("%d of %d within %g; under by more: %d; over the upper estimate: %d", near, STUDIES, FACTOR,
	             under, high);
	assert_true(100 * near >= NEAR_PERCENT * STUDIES);
	assert_true(100 * under <= UNDER_PERCENT * STUDIES);
	assert_true(100 * high <= HIGH_PERCENT * STUDIES);
}

CHECK_MAIN(cmocka_unit_test(valid_studies_take_what_is_estimated_before))
