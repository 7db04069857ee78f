/* Trial runs of studies for a limited time. */
#include "schema/study/trial.h"

#include "schema/study/cost.h"
#include "schema/study/study_json.h"
#include "tests/support/check.h"

/* A study of 4 signals takes less than a millisecond, one of 100,000 takes seconds. */
#define TEXT                                                                                                 \
	"{\"kind\": \"response\", \"scene\": {\"oscillators\": [{\"frequency_hz\": 2}, {\"frequency_hz\": 3}], " \
	"\"excitation\": {\"signals\": %d}}}"

static struct pound_study *study_of(int signals)
{
	struct problems problems;
	char text[512];
	const int n = snprintf(text, sizeof text, TEXT, signals);
	struct pound_study *study = study_from_json(text, (size_t)n, &problems);
	assert_non_null(study);
	return study;
}

static void a_trial_ends_when_its_time_is_over(void **state)
{
	(void)state;
	struct pound_study *shorter = study_of(4), *longer = study_of(100000);
	const atomic_bool unwanted = true;
	assert_true(trial_run(shorter, true, 1000, NULL).complete);
	const struct trial stopped = trial_run(longer, true, 0.02, NULL);
	assert_false(stopped.complete);
	assert_true(stopped.cpu_s >= 0.02);
	// a flag of the caller ends it much sooner
	assert_false(trial_run(longer, true, 1000, &unwanted).complete);
	study_free(shorter);
	study_free(longer);
}

/* Small studies have no trial runs; for others, twice the study has about twice the estimate, within the noise of clocks. */
static void a_trial_corrects_the_count(void **state)
{
	(void)state;
	struct pound_study *shorter = study_of(4), *longer = study_of(50000), *twice = study_of(100000);
	struct cost of_shorter = cost_of(shorter, 1), of_longer = cost_of(longer, 1),
	            of_twice = cost_of(twice, 1);
	const struct cost counted = of_shorter, counted_long = of_longer;
	assert_false(cost_tried(&of_shorter));
	cost_try(&of_shorter, shorter, NULL);
	assert_memory_equal(&of_shorter, &counted, sizeof counted);
	assert_true(cost_tried(&of_longer));
	cost_try(&of_longer, longer, NULL);
	cost_try(&of_twice, twice, NULL);
	assert_true(of_longer.cpu_s != counted_long.cpu_s);
	assert_true(of_twice.cpu_s > of_longer.cpu_s && of_twice.cpu_s < 4 * of_longer.cpu_s);
	assert_true(of_longer.cpu_s_high > of_longer.cpu_s);
	study_free(shorter);
	study_free(longer);
	study_free(twice);
}

CHECK_MAIN(cmocka_unit_test(a_trial_ends_when_its_time_is_over), cmocka_unit_test(a_trial_corrects_the_count))
