/* The estimated cost of a study as a function of its members.  soak_cost measures the accuracy of the estimate. */
#include "schema/study/cost.h"

#include <math.h>
#include <string.h>

#include "schema/study/study_json.h"
#include "tests/support/check.h"

static struct cost cost_of_text(const char *format, ...)
{
	static struct problems problems;
	char text[4096];
	va_list values;
	va_start(values, format);
	int n = vsnprintf(text, sizeof text, format, values);
	va_end(values);
	struct pound_study *study = study_from_json(text, (size_t)n, &problems);
	if (!study)
		fail_msg("%s %s\n%s", problems.list[0].pointer, problems.list[0].detail, text);
	struct cost cost = cost_of(study, 1);
	study_free(study);
	return cost;
}

#define OSCILLATORS "\"oscillators\": [{\"frequency_hz\": 2}, {\"frequency_hz\": 3}]"
#define DESIGN                                                                                             \
	"{\"kind\": \"sensitivity\", \"scene\": {" OSCILLATORS                                                 \
	", \"excitation\": {\"signals\": %d}}, \"inputs\": ["                                                  \
	"{\"path\": \"/contact/restitution\", \"distribution\": {\"type\": \"uniform\", \"min\": 0, \"max\": " \
	"1}}%s], "                                                                                             \
	"\"design\": {\"method\": \"sobol\", \"rows\": %d}%s}"

static void what_is_asked_twice_costs_twice(void **state)
{
	(void)state;
	struct cost one = cost_of_text(DESIGN, 5, "", 1000, "");
	// the constant cost of a study does not double: less than 1/20 of the total
	const struct cost twice[] = {
	    cost_of_text(DESIGN, 5, "", 2000, ""),
	    cost_of_text(DESIGN, 10, "", 1000, ""),
	    cost_of_text(DESIGN, 5, "", 1000,
	                 ", \"sweep\": [{\"path\": \"/oscillators/0/damping_ratio\", \"values\": [0.02, 0.05]}]"),
	};
	for (size_t i = 0; i < sizeof twice / sizeof twice[0]; i++) {
		assert_int_equal(twice[i].runs, 2 * one.runs);
		// the cells of the sweep share their ground motions and the other body
		if (i < 2)
			check_near(twice[i].cpu_s / one.cpu_s, 2, 0.1);
		else
			assert_true(twice[i].cpu_s > 1.4 * one.cpu_s && twice[i].cpu_s < 1.95 * one.cpu_s);
		check_near(twice[i].bytes / one.bytes, 2, 0.1);
	}
}

static void a_motion_is_as_long_as_it_is_in_the_mean(void **state)
{
	(void)state;
	// cycles at a frequency uniform in [1, 3] Hz last on average as long as at 2 / ln 3 = 1.8205 Hz, not as at 1 Hz
	static const char varied[] = ", {\"path\": \"/excitation/frequency_hz\", \"distribution\": {\"type\": "
	                             "\"uniform\", \"min\": 1, \"max\": 3}}";
	static const char as_long[] = ", {\"path\": \"/excitation/frequency_hz\", \"distribution\": {\"type\": "
	                              "\"uniform\", \"min\": 1.8204, \"max\": 1.8206}}";
	struct cost fixed = cost_of_text(DESIGN, 5, as_long, 3000, ""),
	            mean = cost_of_text(DESIGN, 5, varied, 3000, "");
	check_near(mean.cpu_s / fixed.cpu_s, 1, 0.01);
}

static void finer_steps_stiffer_contacts_and_more_trials_cost_more(void **state)
{
	(void)state;
	static const char form[] =
	    "{\"kind\": \"response\", \"scene\": {" OSCILLATORS ", \"contact\": {\"stiffness_ratio\": %g}, "
	    "\"excitation\": {\"signals\": 1000}}%s}";
	double soft = cost_of_text(form, 1e2, "").cpu_s, stiff = cost_of_text(form, 1e8, "").cpu_s;
	double coarse =
	    cost_of_text(form, 1e2, ", \"solver\": {\"method\": \"newmark\", \"step_s\": 1e-4}").cpu_s;
	double fine = cost_of_text(form, 1e2, ", \"solver\": {\"method\": \"newmark\", \"step_s\": 1e-5}").cpu_s;
	double adaptive = cost_of_text(form, 1e2, ", \"solver\": {\"method\": \"adaptive\"}").cpu_s;
	double follows = cost_of_text(form, 1e8, ", \"solver\": {\"method\": \"adaptive\"}").cpu_s;
	// the exact solver passes many contact oscillations at once, the adaptive solver takes steps in each of them
	assert_true(stiff > 1.3 * soft && stiff < 3 * soft);
	assert_true(follows > 2 * adaptive);
	check_near(fine / coarse, 10, 0.5);
	assert_true(adaptive > 20 * soft);
	static const char trials[] =
	    "{\"kind\": \"convergence\", \"scene\": {" OSCILLATORS "}, \"convergence\": {"
	    "\"newmark\": {\"steps_s\": [%s]}, \"central_difference\": {\"steps_s\": []}, "
	    "\"adaptive\": {\"tolerances\": []}}}";
	struct cost few = cost_of_text(trials, "1e-3"), many = cost_of_text(trials, "1e-3, 1e-5");
	assert_true(many.cpu_s > few.cpu_s + 1000 * 1e-8 * 800);
	assert_int_equal(many.runs, few.runs + few.runs / 3);
}

/* The cost of a row depends on its floors, increases with slower contact models, and is less without contact. */
static void a_row_costs_by_its_floors_and_its_contacts(void **state)
{
	(void)state;
	static const char form[] =
	    "{\"kind\": \"response\", \"scene\": {\"law\": {\"type\": \"linear\"}, \"contact\": %s, "
	    "\"buildings\": ["
	    "{\"storeys\": %d, \"frequency_hz\": 1}, {\"storeys\": %d, \"frequency_hz\": 1.4}], \"excitation\": "
	    "{\"signals\": 100}}}";
	double small = cost_of_text(form, "{}", 5, 5).cpu_s, large = cost_of_text(form, "{}", 20, 20).cpu_s,
	       apart = cost_of_text(form, "null", 20, 20).cpu_s,
	       rigid = cost_of_text(form, "{\"model\": \"rigid\"}", 20, 20).cpu_s;
	assert_true(large > 4 * small && large < 64 * small);
	assert_true(apart < 0.5 * large && rigid > large);
}

/* A correction is one more response of each body without pounding; a search with many corrections ends after a few. */
static void a_search_for_a_target_demand_costs_by_its_responses(void **state)
{
	(void)state;
	static const char form[] =
	    "{\"kind\": \"response\", \"scene\": {\"law\": {\"type\": \"%s\", \"corrections\": %d}, " OSCILLATORS
	    ", \"excitation\": {\"signals\": 1000}}}";
	double paper = cost_of_text(form, "elastoplastic", 1).cpu_s;
	double some = cost_of_text(form, "elastoplastic", 4).cpu_s,
	       many = cost_of_text(form, "elastoplastic", 50).cpu_s;
	assert_true(some > 1.5 * paper && many > 1.2 * some && many < 5 * paper);
	check_near(cost_of_text(form, "elastoplastic", 100).cpu_s / many, 1, 0);
	// without a yield displacement there is nothing to correct
	check_near(cost_of_text(form, "linear", 50).cpu_s / cost_of_text(form, "linear", 1).cpu_s, 1, 0);
}

/* Above two radians per sample each radian takes a step: twice as many for twice the frequency. */
static void an_oscillator_that_turns_often_in_a_sample_costs_by_its_turns(void **state)
{
	(void)state;
	static const char form[] =
	    "{\"kind\": \"response\", \"scene\": {\"oscillators\": [{\"frequency_hz\": 2}, {\"frequency_hz\": "
	    "%g}], "
	    "\"contact\": null, \"excitation\": {\"signals\": 1000}}, \"solver\": {\"method\": \"%s\"}}";
	static const char *const solvers[] = {"event", "adaptive"};
	for (int k = 0; k < 2; k++) {
		double slow = cost_of_text(form, 3.0, solvers[k]).cpu_s,
		       mapped = cost_of_text(form, 29.0, solvers[k]).cpu_s;
		double fast = cost_of_text(form, 1e4, solvers[k]).cpu_s,
		       faster = cost_of_text(form, 2e4, solvers[k]).cpu_s;
		// the adaptive solver has no maps
		if (k == 0)
			check_near(mapped / slow, 1, 0);
		else
			assert_true(mapped > 2 * slow);
		check_near(faster / fast, 2, 0.05);
	}
}

/* Short documents with long run times: measured on one core, within a factor of three. */
static void what_is_not_a_run_is_counted_too(void **state)
{
	(void)state;
	static const char pulses[] =
	    "{\"kind\": \"floor_spectrum\", \"scene\": {" OSCILLATORS ", \"excitation\": {\"signals\": 500}}, "
	    "\"spectrum\": {\"frequencies_hz\": {\"count\": 10000}, \"pulses\": %d}}";
	static const char rows[] = "{\"kind\": \"sensitivity\", \"scene\": {" OSCILLATORS
	                           ", \"excitation\": {\"signals\": 1, \"cycles\": "
	                           "0.1}}, \"inputs\": ["
	                           "{\"path\": \"/contact/restitution\", \"distribution\": {\"type\": "
	                           "\"uniform\", \"min\": 0, \"max\": 1}},"
	                           "{\"path\": \"/contact/stiffness_ratio\", \"distribution\": {\"type\": "
	                           "\"uniform\", \"min\": 50, \"max\": "
	                           "100}},"
	                           "{\"path\": \"/oscillators/0/damping_ratio\", \"distribution\": {\"type\": "
	                           "\"uniform\", \"min\": 0.01, "
	                           "\"max\": 0.1}},"
	                           "{\"path\": \"/oscillators/1/damping_ratio\", \"distribution\": {\"type\": "
	                           "\"uniform\", \"min\": 0.01, "
	                           "\"max\": 0.1}}], \"design\": {\"rows\": %d}}";
	const double train = cost_of_text(pulses, 1000000).cpu_s, design = cost_of_text(rows, 1000000).cpu_s;
	assert_true(train > 160000 / 3.0 && train < 160000 * 3.0);
	assert_true(design > 112 / 3.0 && design < 112 * 3.0);
}

CHECK_MAIN(cmocka_unit_test(a_row_costs_by_its_floors_and_its_contacts),
           cmocka_unit_test(what_is_not_a_run_is_counted_too),
           cmocka_unit_test(a_search_for_a_target_demand_costs_by_its_responses),
           cmocka_unit_test(an_oscillator_that_turns_often_in_a_sample_costs_by_its_turns),
           cmocka_unit_test(what_is_asked_twice_costs_twice),
           cmocka_unit_test(a_motion_is_as_long_as_it_is_in_the_mean),
           cmocka_unit_test(finer_steps_stiffer_contacts_and_more_trials_cost_more))
