/* Valid studies drawn at random, and what each takes beside what is estimated before: a histogram of CPU time. */
#include <math.h>

#include "schema/study/cost.h"
#include "schema/study/study_json.h"
#include "tests/support/check.h"
#include "tests/support/valid_studies.h"

enum { STUDIES = 500, BINS = 13 };

static const double CPU_MOST =
    1.5; /* [s] estimated, of one study: what takes four times as long is stopped */

/* Two groups: pairs in a contact that is linear throughout, and chains, which are rows and other contacts.  What the chance of
 * how bodies meet leaves: so many of a hundred may be farther off. */
static const double FACTOR = 3;
static const struct group {
	const char *name;
	int near_percent;
	double late_most;
} groups[] = {{"pairs in linear contact", 95, 4}, {"chains", 85, 30}};

enum { GROUPS = sizeof groups / sizeof groups[0] };

static int group_of(const struct pound_study *study)
{
	return study->scene.n_buildings ||
	       (study->scene.contact.present &&
	        pound_contact_force(study->scene.contact.model) != POUND_FORCE_LINEAR);
}

static void valid_studies_take_what_is_estimated_before(void **state)
{
	static char text[VALID_STUDY_SIZE];
	int bins[BINS] = {0}, n = 0, drawn = 0, of[GROUPS] = {0}, near[GROUPS] = {0}, under[GROUPS] = {0};
	double late[GROUPS] = {1, 1}, early[GROUPS] = {1, 1};
	(void)state;
	for (uint64_t seed = 1; n < STUDIES; seed = 0) {
		struct pound_study *study = valid_study(seed, text, &drawn);
		const struct cost cost = cost_of(study, 1);
		if (cost.cpu_s <= CPU_MOST) {
			// what takes less than the clock can resolve is nothing
			const double s = fmax(valid_study_taken(study, 4 * CPU_MOST), 0.003),
			             estimated = fmax(cost.cpu_s, 0.003), ratio = s / estimated;
			const int bin = (int)floor(log2(ratio) + 0.5 * BINS), g = group_of(study);
			bins[bin < 0 ? 0 : bin >= BINS ? BINS - 1 : bin]++;
			late[g] = fmax(late[g], ratio);
			early[g] = fmax(early[g], 1 / ratio);
			near[g] += ratio <= FACTOR && ratio >= 1 / FACTOR;
			under[g] += ratio > FACTOR;
			of[g]++;
			n++;
			if (ratio > FACTOR || ratio < 1 / FACTOR)
				check_report("taken over estimated %.2f: %s", ratio, text);
		}
		study_free(study);
	}
	for (int b = 0; b < BINS; b++)
		check_report("taken over estimated %7.3f to %7.3f: %d", exp2(b - 0.5 * BINS),
		             exp2(b + 1 - 0.5 * BINS), bins[b]);
	check_report("%d valid studies of %d drawn", n, drawn);
	for (int g = 0; g < GROUPS; g++)
		check_report(
		    "%s: %d of %d within %g; under by more: %d; at most %.1f times the estimate, at least 1/%.1f",
		    groups[g].name, near[g], of[g], FACTOR, under[g], late[g], early[g]);
	for (int g = 0; g < GROUPS; g++) {
		assert_true(100 * near[g] >= groups[g].near_percent * of[g]);
		assert_true(late[g] <= groups[g].late_most);
	}
}

CHECK_MAIN(cmocka_unit_test(valid_studies_take_what_is_estimated_before))
