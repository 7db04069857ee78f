/* Estimates of CPU time: a short version of soak_valid. */
#include <math.h>

#include "schema/study/cost.h"
#include "schema/study/study_json.h"
#include "tests/support/check.h"
#include "tests/support/valid_studies.h"

enum { STUDIES = 60, NEAR_PERCENT = 85 };

static const double CPU_MOST = 0.1; /* [s] largest estimate */

/* Wider than in soak_valid, as other programs may use the machine meanwhile, and it may have fewer lanes. */
#if defined __SANITIZE_ADDRESS__ || defined __SANITIZE_THREAD__
static const double FACTOR = 60;
#else
static const double FACTOR = 4;
#endif

static void estimates_are_near_what_studies_take(void **state)
{
	static char text[VALID_STUDY_SIZE];
	int n = 0, near = 0, drawn = 0;
	double late = 1, early = 1, over = 0;
	(void)state;
	for (uint64_t seed = 4; n < STUDIES; seed = 0) {
		struct pound_study *study = valid_study(seed, text, &drawn);
		struct cost cost = cost_of(study, 1);
		if (cost.cpu_s <= CPU_MOST) {
			cost_try(&cost, study, NULL);
			const double s = fmax(valid_study_taken(study, 100 * CPU_MOST), 0.003),
			             ratio = s / fmax(cost.cpu_s, 0.003);
			late = fmax(late, ratio);
			over = fmax(over, s / fmax(cost.cpu_s_high, 0.003));
			early = fmax(early, 1 / ratio);
			near += ratio <= FACTOR && ratio >= 1 / FACTOR;
			n++;
		}
		study_free(study);
	}
	check_report(
	    "%d of %d studies within a factor of %g; at most %.1f times the estimate, %.1f times the upper "
	    "one, at least 1/%.1f",
	    near, n, FACTOR, late, over, early);
	assert_true(100 * near >= NEAR_PERCENT * n);
	assert_true(over < FACTOR / 2);
}

CHECK_MAIN(cmocka_unit_test(estimates_are_near_what_studies_take))
