/* Valid studies drawn at random, and what each takes beside what is estimated before: a histogram of CPU time. */
#include <math.h>

#include "schema/study/cost.h"
#include "schema/study/study_json.h"
#include "tests/support/check.h"
#include "tests/support/valid_studies.h"

enum { STUDIES = 500, BINS = 13 };

static const double CPU_MOST =
    1.5; /* [s] estimated, of one study: what takes four times as long is stopped */

/* What the chance of how bodies meet leaves: so many of a hundred may be farther off, and none more than that. */
static const double FACTOR = 3, FAR = 8;
enum { NEAR_PERCENT = 95 };

static void valid_studies_take_what_is_estimated_before(void **state)
{
	static char text[VALID_STUDY_SIZE];
	int bins[BINS] = {0}, n = 0, near = 0, under = 0, drawn = 0;
	double late = 1, early = 1;
	(void)state;
	for (uint64_t seed = 1; n < STUDIES; seed = 0) {
		struct pound_study *study = valid_study(seed, text, &drawn);
		const struct cost cost = cost_of(study, 1);
		if (cost.cpu_s <= CPU_MOST) {
			// what takes less than the clock and the start of a study tells is nothing
			const double s = fmax(valid_study_taken(study, 4 * CPU_MOST), 0.003),
			             told = fmax(cost.cpu_s, 0.003), ratio = s / told;
			const int bin = (int)floor(log2(ratio) + 0.5 * BINS);
			bins[bin < 0 ? 0 : bin >= BINS ? BINS - 1 : bin]++;
			late = fmax(late, ratio);
			early = fmax(early, 1 / ratio);
			near += ratio <= FACTOR && ratio >= 1 / FACTOR;
			under += ratio > FACTOR;
			n++;
			if (ratio > FACTOR || ratio < 1 / FACTOR)
				check_report("taken over estimated %.2f: %s", ratio, text);
		}
		study_free(study);
	}
	for (int b = 0; b < BINS; b++)
		check_report("taken over estimated %7.3f to %7.3f: %d", exp2(b - 0.5 * BINS),
		             exp2(b + 1 - 0.5 * BINS), bins[b]);
	check_report(
	    "%d of %d valid studies, of %d drawn, within %g; under by more: %d; at most %.1f times the estimate, "
	    "at least 1/%.1f",
	    near, n, drawn, FACTOR, under, late, early);
	assert_true(100 * near >= NEAR_PERCENT * n);
	assert_true(late < FAR);
}

CHECK_MAIN(cmocka_unit_test(valid_studies_take_what_is_estimated_before))
