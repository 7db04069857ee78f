/* Valid studies drawn at random, and what each takes beside what is estimated before: a histogram of CPU time. */
#include <math.h>

#include "schema/study/cost.h"
#include "schema/study/study_json.h"
#include "tests/support/check.h"
#include "tests/support/valid_studies.h"

enum { STUDIES = 500, BINS = 13 };

/* [s] estimated, of one study; what counts as nothing; and what is stopped when it is over its upper estimate, too */
static const double CPU_MOST = 1.5, LEAST = 0.003, LONG = 6;

static const double FACTOR = 3;

/* What is known of a study's contacts.  Of the first two none may be under by more; long series of small impacts, which no count
 * can know, leave so many of a hundred of the others, of which the status says so while they run (over_estimate), and which
 * --time-max and --cpu-max end.  97 of 100 of each are to take no more than the upper estimate. */
static const struct group {
	const char *name;
	int near_percent, under_percent;
} groups[] = {{"pairs in linear contact", 95, 0},
              {"rows without contact", 75, 0},
              {"chains with gaps", 75, 8},
              {"chains that touch at rest", 75, 16}};

enum { GROUPS = sizeof groups / sizeof groups[0], HIGH_PERCENT = 5 };

static int group_of(const struct pound_study *study)
{
	const struct pound_contact *contact = &study->scene.contact;
	const bool row = study->scene.n_buildings > 0,
	           linear = !contact->present || pound_contact_force(contact->model) == POUND_FORCE_LINEAR;
	return !row && linear ? 0 : !contact->present ? 1 : contact->gap > 0 ? 2 : 3;
}

/* what was found of a group */
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
		const struct cost cost = cost_of(study, 1);
		if (cost.cpu_s <= CPU_MOST) {
			// what takes less than the clock can resolve is nothing
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
		             groups[g].name, found[g].near, found[g].n, FACTOR, found[g].under, found[g].high,
		             found[g].late, found[g].early);
	for (int g = 0; g < GROUPS; g++) {
		assert_true(found[g].n > 0);
		assert_true(100 * found[g].near >= groups[g].near_percent * found[g].n);
		assert_true(100 * found[g].under <= groups[g].under_percent * found[g].n);
		assert_true(100 * found[g].high <= HIGH_PERCENT * found[g].n);
	}
}

CHECK_MAIN(cmocka_unit_test(valid_studies_take_what_is_estimated_before))
