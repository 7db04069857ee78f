/* unit_study_json.c - every member of a study document, right and wrong, and where each mistake is told. */
#include <math.h>
#include <string.h>

#include "schema/study/fields.h"
#include "schema/study/study_json.h"
#include "tests/support/check.h"
#include "tests/support/study_documents.h"

#define COUNT(array) ((int)(sizeof(array) / sizeof(array)[0]))

/* One wrong value and one right one for a member of documents_sensitivity, at least one row for each field. */
struct member {
	const char *pattern, *from, *right, *wrong, *pointer, *detail;
};

static const struct member members[] = {
    {"/kind", "\"kind\": \"sensitivity\"", "\"kind\": \"sensitivity\" ", "\"kind\": \"sensitivty\"", "/kind",
     "must be one of \"response\", \"sensitivity\", \"convergence\", \"floor_spectrum\", got \"sensitivty\", "
     "did you mean "
     "\"sensitivity\"?"},
    {"/name", "\"a study\"", "\"\\u00fc \\\"x\\\"\"", "\"a\\u0007b\"", "/name",
     "must not hold control characters"},
    {"/name", "\"a study\"", "\"\"", "7", "/name", "must be a text of 0 to 200 characters, got 7"},
    {"/scene/law/type", "\"elastoplastic\"", "\"origin_oriented\"", "\"elasto_plastic\"", "/scene/law/type",
     "must be one of \"linear\", \"elastoplastic\", \"nonlinear_elastic\", \"origin_oriented\", got "
     "\"elasto_plastic\", did you mean \"elastoplastic\"?"},
    {"/scene/law/hardening_ratio", "\"hardening_ratio\": 0.05", "\"hardening_ratio\": 1",
     "\"hardening_ratio\": 1.01", "/scene/law/hardening_ratio", "must be in [0, 1], got 1.01"},
    {"/scene/law/target_demand", "\"target_demand\": 2", "\"target_demand\": 1", "\"target_demand\": 0.99",
     "/scene/law/target_demand", "must be at least 1, got 0.99"},
    {"/scene/law/yield_displacement_m", "\"target_demand\": 2", "\"yield_displacement_m\": 1e-3",
     "\"yield_displacement_m\": 0", "/scene/law/yield_displacement_m", "must be greater than 0, got 0"},
    {"/scene/law/corrections", "\"corrections\": 1", "\"corrections\": 0", "\"corrections\": 1.5",
     "/scene/law/corrections", "must be a whole number, got 1.5"},
    {"/scene/law/corrections", "\"corrections\": 1", "\"corrections\": 100", "\"corrections\": 101",
     "/scene/law/corrections", "must be in [0, 100], got 101"},
    {"/scene/oscillators/*/mass_kg", "\"mass_kg\": 1", "\"mass_kg\": 1e-6", "\"mass_kg\": 0",
     "/scene/oscillators/0/mass_kg", "must be greater than 0, got 0"},
    {"/scene/oscillators/*/frequency_hz", "\"frequency_hz\": 2,", "\"frequency_hz\": 1e3,",
     "\"frequency_hz\": -2,", "/scene/oscillators/0/frequency_hz", "must be greater than 0, got -2"},
    {"/scene/oscillators/*/damping_ratio", "\"damping_ratio\": 0.02", "\"damping_ratio\": 0",
     "\"damping_ratio\": 1", "/scene/oscillators/1/damping_ratio", "must be in [0, 1), got 1"},
    {"/scene/oscillators/*/rigid_wall", "\"rigid_wall\": false", "\"rigid_wall\" : false",
     "\"rigid_wall\": 0", "/scene/oscillators/0/rigid_wall", "must be true or false, got 0"},
    {"/scene/oscillators/*/law/type", "\"type\": \"linear\"", "\"type\": \"nonlinear_elastic\"",
     "\"type\": 1", "/scene/oscillators/1/law/type",
     "must be one of \"linear\", \"elastoplastic\", \"nonlinear_elastic\", \"origin_oriented\", got 1"},
    {"/scene/oscillators/*/law/hardening_ratio", "\"hardening_ratio\": 0.1", "\"hardening_ratio\": 0",
     "\"hardening_ratio\": -0.1", "/scene/oscillators/1/law/hardening_ratio", "must be in [0, 1], got -0.1"},
    {"/scene/oscillators/*/law/target_demand", "\"yield_displacement_m\": 0.25", "\"target_demand\": 4",
     "\"target_demand\": \"4\"", "/scene/oscillators/1/law/target_demand", "must be a number, got \"4\""},
    {"/scene/oscillators/*/law/yield_displacement_m", "\"yield_displacement_m\": 0.25",
     "\"yield_displacement_m\": 1", "\"yield_displacement_m\": -1",
     "/scene/oscillators/1/law/yield_displacement_m", "must be greater than 0, got -1"},
    {"/scene/oscillators/*/law/corrections", "\"corrections\": 2", "\"corrections\": 3",
     "\"corrections\": true", "/scene/oscillators/1/law/corrections", "must be a whole number, got true"},
    {"/scene/contact/model", "\"kelvin_voigt\"", "\"kelvin_\\u0076oigt\"", "\"hertz\"",
     "/scene/contact/model", "must be \"kelvin_voigt\", got \"hertz\""},
    {"/scene/contact/stiffness_ratio", "\"stiffness_ratio\": 100", "\"stiffness_ratio\": 1e8",
     "\"stiffness_ratio\": 0", "/scene/contact/stiffness_ratio", "must be greater than 0, got 0"},
    {"/scene/contact/restitution", "\"restitution\": 0.6", "\"restitution\": 0", "\"restitution\": 1.4",
     "/scene/contact/restitution", "must be in [0, 1], got 1.4"},
    {"/scene/contact/gap_m", "\"gap_m\": 0.01", "\"gap_m\": -0.0", "\"gap_m\": -0.1", "/scene/contact/gap_m",
     "must be at least 0, got -0.1"},
    {"/scene/contact/tension", "\"tension\": true", "\"tension\": false", "\"tension\": \"true\"",
     "/scene/contact/tension", "must be true or false, got \"true\""},
    {"/scene/excitation/type", "\"type\": \"kanai_tajimi\"", "\"type\":\"kanai_tajimi\"",
     "\"type\": \"kanai-tajimi\"", "/scene/excitation/type",
     "must be one of \"kanai_tajimi\", \"white_noise\", \"harmonic\", \"record\", got \"kanai-tajimi\", did "
     "you mean "
     "\"kanai_tajimi\"?"},
    {"/scene/excitation/frequency_hz", "\"frequency_hz\": 2.5", "\"frequency_hz\": 1", "\"frequency_hz\": 0",
     "/scene/excitation/frequency_hz", "must be greater than 0, got 0"},
    {"/scene/excitation/damping_ratio", "\"damping_ratio\": 0.6", "\"damping_ratio\": 1.5",
     "\"damping_ratio\": 0", "/scene/excitation/damping_ratio", "must be greater than 0, got 0"},
    {"/scene/excitation/high_pass_ratio", "\"high_pass_ratio\": 0.1", "\"high_pass_ratio\": 0.2",
     "\"high_pass_ratio\": null", "/scene/excitation/high_pass_ratio", "must be a number, got null"},
    {"/scene/excitation/cycles", "\"cycles\": 20", "\"cycles\": 2.5", "\"cycles\": -20",
     "/scene/excitation/cycles", "must be greater than 0, got -20"},
    {"/scene/excitation/duration_s", "\"cycles\": 20", "\"cycles\": 21", "\"duration_s\": 8",
     "/scene/excitation/duration_s", "is not used by excitation \"kanai_tajimi\""},
    {"/scene/excitation/rise", "\"rise\": 0.15", "\"rise\": 0.75", "\"rise\": 1.1", "/scene/excitation/rise",
     "must be in [0, 1], got 1.1"},
    {"/scene/excitation/fall", "\"fall\": 0.25", "\"fall\": 0", "\"fall\": [0.25]", "/scene/excitation/fall",
     "must be a number, got an array"},
    {"/scene/excitation/time_step_s", "\"time_step_s\": 0.01", "\"time_step_s\": 0.005", "\"time_step_s\": 0",
     "/scene/excitation/time_step_s", "must be greater than 0, got 0"},
    {"/scene/excitation/peak_m_s2", "\"peak_m_s2\": 1", "\"peak_m_s2\": 9.81", "\"peak_m_s2\": 0",
     "/scene/excitation/peak_m_s2", "must be greater than 0, got 0"},
    {"/scene/excitation/signals", "\"signals\": 5", "\"signals\": 1", "\"signals\": 0",
     "/scene/excitation/signals", "must be in [1, 100000], got 0"},
    {"/scene/excitation/acceleration_m_s2", "\"cycles\": 20", "\"cycles\": 20.0",
     "\"acceleration_m_s2\": [0, 1]", "/scene/excitation/acceleration_m_s2",
     "is not used by excitation \"kanai_tajimi\""},
    {"/inputs/*/path", "\"/excitation/frequency_hz\"", "\"/excitation/cycles\"", "\"/excitation/frequency\"",
     "/inputs/0/path", "names nothing in \"scene\", did you mean \"/excitation/frequency_hz\"?"},
    {"/inputs/*/name", "\"f_e\"", "\"\\u03c9\"", "\"\"", "/inputs/0/name",
     "must be a text of 1 to 100 characters, got 0"},
    {"/inputs/*/distribution/type", "\"type\": \"uniform\"", "\"type\": \"log_uniform\"",
     "\"type\": \"logUniform\"", "/inputs/0/distribution/type",
     "must be one of \"uniform\", \"log_uniform\", \"reciprocal_uniform\", \"normal\", \"truncated_normal\", "
     "\"lognormal\", \"triangular\", \"beta\", \"discrete\", got \"logUniform\", did you mean "
     "\"log_uniform\"?"},
    {"/inputs/*/distribution/values", "\"uniform\", \"min\": 0.5, \"max\": 5",
     "\"discrete\", \"values\": [0.5, 1, 2.5], \"weights\": [1, 2, 1]",
     "\"discrete\", \"values\": [0.5, 2.5, 1]", "/inputs/0/distribution",
     "every value must be greater than the one before"},
    {"/inputs/*/distribution/values/*", "\"uniform\", \"min\": 0.5, \"max\": 5",
     "\"discrete\", \"values\": [0.5, 1]", "\"discrete\", \"values\": [0.5, -2e100]",
     "/inputs/0/distribution/values/1", "must be in [-1e+100, 1e+100], got -2e+100"},
    {"/inputs/*/distribution/weights/*", "\"uniform\", \"min\": 0.5, \"max\": 5",
     "\"discrete\", \"values\": [1, 2], \"weights\": [1, 1e-300]",
     "\"discrete\", \"values\": [1, 2], \"weights\": [1, 0]", "/inputs/0/distribution/weights/1",
     "must be in (0, 1e+100], got 0"},
    {"/inputs/*/distribution/values", "\"uniform\", \"min\": 0.5, \"max\": 5",
     "\"discrete\", \"values\": [0.5]", "\"discrete\", \"values\": [1, 2], \"weights\": [1]",
     "/inputs/0/distribution", "there must be as many weights as values, 2, not 1"},
    {"/inputs/*/distribution/values", "\"uniform\", \"min\": 0.5, \"max\": 5",
     "\"discrete\", \"values\": [0.5, 5]", "\"discrete\", \"values\": [0, 5]", "/inputs/0/distribution",
     "gives values from 0 to 5, but /excitation/frequency_hz must be greater than 0"},
    {"/inputs/*/distribution/values", "\"uniform\", \"min\": 0.5, \"max\": 5",
     "\"discrete\", \"values\": [0.5, 5]", "\"discrete\"", "/inputs/0/distribution/values",
     "is required: an array of numbers, ascending"},
    {"/inputs/*/distribution/values", "\"uniform\", \"min\": 0.5, \"max\": 5",
     "\"discrete\", \"values\": [0.5, 5]", "\"discrete\", \"values\": [1, 2], \"min\": 1",
     "/inputs/0/distribution/min", "is not used by distribution \"discrete\""},
    {"/sweep/*/path", "\"/contact/restitution\"", "\"/oscillators/0/damping_ratio\"", "\"/contact/modell\"",
     "/sweep/0/path", "names nothing in \"scene\", did you mean \"/contact/model\"?"},
    {"/sweep/*/values", "[0.2, 0.9]", "[0]", "[0.2, 1.4]", "/sweep/0/values/1", "must be in [0, 1], got 1.4"},
    {"/ratios/*/name", "\"reciprocal_uniform\", \"max\": 6}}]",
     "\"uniform\", \"min\": 1, \"max\": 6}}], \"ratios\": [{\"name\": \"q\", \"of\": "
     "[\"/excitation/frequency_hz\", \"/oscillators/1/mass_kg\"]}]",
     "\"uniform\", \"min\": 1, \"max\": 6}}], \"ratios\": [{\"name\": 7, \"of\": "
     "[\"/excitation/frequency_hz\", \"/oscillators/1/mass_kg\"]}]",
     "/ratios/0/name", "must be a text of 1 to 100 characters, got 7"},
    {"/ratios/*/of", "\"reciprocal_uniform\", \"max\": 6}}]",
     "\"uniform\", \"min\": 1, \"max\": 6}}], \"ratios\": [{\"name\": \"q\", \"of\": "
     "[\"/excitation/frequency_hz\", \"/oscillators/1/mass_kg\"]}]",
     "\"uniform\", \"min\": 1, \"max\": 6}}], \"ratios\": [{\"name\": \"q\", \"of\": "
     "[\"/excitation/frequency_hz\"]}]",
     "/ratios/0/of", "must be an array of 2 elements, got one of 1"},
    {"/ratios/*/of/*", "\"reciprocal_uniform\", \"max\": 6}}]",
     "\"uniform\", \"min\": 1, \"max\": 6}}], \"ratios\": [{\"name\": \"q\", \"of\": "
     "[\"/excitation/frequency_hz\", \"/oscillators/1/mass_kg\"]}]",
     "\"uniform\", \"min\": 1, \"max\": 6}}], \"ratios\": [{\"name\": \"q\", \"of\": "
     "[\"/excitation/frequency_hz\", 3]}]",
     "/ratios/0/of/1", "must be a text of 1 to 200 characters, got 3"},
    {"/ratios/*/of/*", "\"reciprocal_uniform\", \"max\": 6}}]",
     "\"uniform\", \"min\": 1, \"max\": 6}}], \"ratios\": [{\"name\": \"q\", \"of\": "
     "[\"/excitation/frequency_hz\", \"/oscillators/1/mass_kg\"]}]",
     "\"uniform\", \"min\": 1, \"max\": 6}}], \"ratios\": [{\"name\": \"q\", \"of\": "
     "[\"/excitation/frequency_hz\", \"/contact/gap_m\"]}]",
     "/ratios/0/of/1", "is the path of no input of this study"},
    {"/ratios/*/of/*", "\"reciprocal_uniform\", \"max\": 6}}]",
     "\"uniform\", \"min\": 1, \"max\": 6}}], \"ratios\": [{\"name\": \"q\", \"of\": "
     "[\"/excitation/frequency_hz\", \"/oscillators/1/mass_kg\"]}]",
     "\"uniform\", \"min\": 1, \"max\": 6}}], \"ratios\": [{\"name\": \"q\", \"of\": "
     "[\"/excitation/frequency_hz\", \"/excitation/frequency_hz\"]}]",
     "/ratios/0/of/1", "an input that is above in one ratio may be in no other place"},
    {"/ratios/*/of/*", "\"reciprocal_uniform\", \"max\": 6}}]",
     "\"uniform\", \"min\": 1, \"max\": 6}}], \"ratios\": [{\"name\": \"q\", \"of\": "
     "[\"/excitation/frequency_hz\", \"/oscillators/1/mass_kg\"]}]",
     "\"reciprocal_uniform\", \"max\": 6}}], \"ratios\": [{\"name\": \"q\", \"of\": "
     "[\"/excitation/frequency_hz\", \"/oscillators/1/mass_kg\"]}]",
     "/ratios/0/of/1", "names /inputs/1, but inputs of a ratio are \"uniform\" or \"log_uniform\" above 0"},
    {"/design/method", "\"method\": \"lhs\"", "\"method\": \"random\"", "\"method\": \"LHS\"",
     "/design/method", "must be one of \"lhs\", \"random\", \"sobol\", got \"LHS\", did you mean \"lhs\"?"},
    {"/design/rows", "\"rows\": 10", "\"rows\": 2", "\"rows\": 1", "/design/rows",
     "must be in [2, 1048576], got 1"},
    {"/design/rows", "\"rows\": 10", "\"rows\": 1.6e1", "\"rows\": 10.5", "/design/rows",
     "must be a whole number, got 10.5"},
    {"/design/randomisations", "\"method\": \"lhs\", \"rows\": 10",
     "\"method\": \"sobol\", \"randomisations\": 16, \"rows\": 64",
     "\"method\": \"sobol\", \"randomisations\": 3, \"rows\": 64", "/design/randomisations",
     "must be in [4, 32], got 3"},
    {"/design/rows", "\"method\": \"lhs\", \"rows\": 10", "\"method\": \"sobol\", \"rows\": 16",
     "\"method\": \"sobol\", \"rows\": 15", "/design/rows",
     "must be at least 16, two for each randomisation, got 15"},
    {"/design/randomisations", "\"rows\": 10", "\"rows\": 11", "\"rows\": 10, \"randomisations\": 8",
     "/design/randomisations", "is not used by design \"lhs\""},
    {"/design/until/half_width", "\"rows\": 10", "\"until\": {\"half_width\": 0.03}",
     "\"until\": {\"half_width\": 0}", "/design/until/half_width", "must be in (0, 1), got 0"},
    {"/design/until/half_width", "\"rows\": 10", "\"until\": {\"half_width\": 0.3, \"max_runs\": 5000}",
     "\"until\": {\"max_runs\": 5000}", "/design/until/half_width", "is required: a number in (0, 1)"},
    {"/design/until/max_runs", "\"rows\": 10", "\"until\": {\"half_width\": 0.3, \"max_runs\": 4000}",
     "\"until\": {\"half_width\": 0.3, \"max_runs\": 3999}", "/design/until/max_runs",
     "must be at least 4000: 100 rows of 40 runs"},
    {"/design/seed", "\"seed\": 42", "\"seed\": \"18446744073709551615\"",
     "\"seed\": \"18446744073709551616\"", "/design/seed",
     "must be a whole number below 2^53, or one below 2^64 written as text, got \"18446744073709551616\""},
    {"/design/seed", "\"seed\": 42", "\"seed\": 9007199254740991", "\"seed\": 9007199254740993",
     "/design/seed",
     "must be a whole number below 2^53, or one below 2^64 written as text, got 9007199254740992"},
    {"/design/seed", "\"seed\": 42", "\"seed\": 0", "\"seed\": -1", "/design/seed",
     "must be a whole number below 2^53, or one below 2^64 written as text, got -1"},
    {"/design/signals", "\"signals\": \"common\"", "\"signals\": \"independent\"", "\"signals\": true",
     "/design/signals", "must be one of \"independent\", \"common\", got true"},
    {"/design/estimator", "\"signals\": \"common\"", "\"signals\": \"common\", \"estimator\": \"janon\"",
     "\"signals\": \"common\", \"estimator\": \"jannon\"", "/design/estimator",
     "must be one of \"saltelli_2010\", \"jansen\", \"janon\", \"martinez\", \"sobol_2007\", "
     "\"saltelli_2002\", "
     "\"azzini_rosati\", got \"jannon\", did you mean \"janon\"?"},
    {"/design/order", "\"signals\": \"common\"", "\"signals\": \"common\", \"order\": \"factorial\"",
     "\"signals\": \"common\", \"order\": 2", "/design/order",
     "must be one of \"total\", \"second\", \"factorial\", got 2"},
    {"/outputs/*", "\"impulse\"]", "\"impulse\" ]", "\"impuls\"]", "/outputs/1",
     "must be one of \"force_amplification\", \"demand_amplification\", \"impulse\", \"floor_spectrum\", got "
     "\"impuls\", did you "
     "mean "
     "\"impulse\"?"},
    {"/solver/method", "\"method\": \"event\"", "\"method\":  \"event\"", "\"method\": \"euler\"",
     "/solver/method",
     "must be one of \"event\", \"newmark\", \"central_difference\", \"adaptive\", got \"euler\""},
    {"/solver/tolerance", "\"tolerance\": 1e-9", "\"tolerance\": 1e-3", "\"tolerance\": 0",
     "/solver/tolerance", "must be in (0, 1), got 0"},
    {"/solver/tolerance", "\"event\", \"tolerance\": 1e-9", "\"adaptive\", \"tolerance\": 1e-6",
     "\"newmark\", \"tolerance\": 1e-6", "/solver/tolerance", "is not used by solver \"newmark\""},
    {"/solver/step_s", "\"event\", \"tolerance\": 1e-9", "\"newmark\", \"step_s\": 1e-3",
     "\"newmark\", \"step_s\": 0", "/solver/step_s", "must be greater than 0, got 0"},
};

/* And of documents_convergence. */
static const struct member trial_members[] = {
    {"/convergence/newmark/steps_s/*", "[0.01, 0.001]", "[7]", "[0.01, 0]", "/convergence/newmark/steps_s/1",
     "must be greater than 0, got 0"},
    {"/convergence/newmark/steps_s/*", "[0.01, 0.001]", "[]", "[0.01, 0.001, 0.002]",
     "/convergence/newmark/steps_s/2", "must be smaller than the one before"},
    {"/convergence/central_difference/steps_s/*", "[0.005]", "[0.005, 1e-8]", "[0.01, 1e-9]",
     "/convergence/central_difference/steps_s/1",
     "asks for 1e+07 steps in one sample interval, at most 1000000"},
    {"/convergence/adaptive/tolerances/*", "[1e-4]", "[0.9, 1e-4]", "[1]",
     "/convergence/adaptive/tolerances/0", "must be in (0, 1), got 1"},
    {"/convergence/adaptive/tolerances/*", "[1e-4]", "[1e-3]", "1e-4", "/convergence/adaptive/tolerances",
     "must be an array of 0 to 16 elements, got 0.0001"},
    {"/convergence/history_s", "\"history_s\": 2", "\"history_s\": 1e9", "\"history_s\": 0",
     "/convergence/history_s", "must be greater than 0, got 0"},
    {"/convergence", "\"convergence\": {", "\"convergence\" : {", "\"sweep\": [], \"convergence\": {",
     "/sweep", "is not used by kind \"convergence\""},
    {"/convergence", "\"convergence\": {", "\"convergence\" : {", "\"solver\": {}, \"convergence\": {",
     "/solver", "is not used by kind \"convergence\""},
    {"/convergence", "\"signals\": 2", "\"signals\": 1", "\"signals\": 30000", "/scene/excitation/signals",
     "asks for 180000 pounding runs, a study may have at most 100000"},
};

/* And of documents_floor. */
static const struct member floor_members[] = {
    {"/spectrum/frequencies_hz/*", "{\"min\": 0.5, \"max\": 50, \"count\": 9}", "[5, 2.5]", "[5, 0]",
     "/spectrum/frequencies_hz/1", "must be greater than 0, got 0"},
    {"/spectrum/frequencies_hz/*", "{\"min\": 0.5, \"max\": 50, \"count\": 9}", "[1e-3]", "[2, 5, 2]",
     "/spectrum/frequencies_hz/2", "is the same as frequency 0"},
    {"/spectrum/frequencies_hz/*", "{\"min\": 0.5, \"max\": 50, \"count\": 9}", "{}", "7",
     "/spectrum/frequencies_hz",
     "must be an array of frequencies, or an object of min, max and count, got 7"},
    {"/spectrum/frequencies_hz/*", "\"min\": 0.5", "\"min\": 5", "\"*\": 5", "/spectrum/frequencies_hz",
     "has an unknown member, \"*\""},
    {"/spectrum/frequencies_hz/min", "\"min\": 0.5", "\"min\": 49", "\"min\": 50", "/spectrum/frequencies_hz",
     "min must be less than max, got 50 and 50"},
    {"/spectrum/frequencies_hz/max", "\"max\": 50", "\"max\": 1e4", "\"max\": 10001",
     "/spectrum/frequencies_hz", "must be at most 100 over the sample step, 10000 Hz, got 10001"},
    {"/spectrum/frequencies_hz/count", "\"count\": 9", "\"count\": 2", "\"count\": 1",
     "/spectrum/frequencies_hz/count", "must be in [2, 10000], got 1"},
    {"/spectrum/damping_ratio", "\"damping_ratio\": 0.02", "\"damping_ratio\": 0", "\"damping_ratio\": 1",
     "/spectrum/damping_ratio", "must be in [0, 1), got 1"},
    {"/spectrum/pulses", "\"pulses\": 15", "\"pulses\": 0", "\"pulses\": -1", "/spectrum/pulses",
     "must be in [0, 1000000], got -1"},
    {"/histories", "\"histories\": false", "\"histories\": true", "\"histories\": 1", "/histories",
     "must be true or false, got 1"},
    {"/spectrum", "\"seed\": 7}", "\"seed\": 8}", "\"seed\": 7}, \"outputs\": [\"impulse\"]", "/outputs",
     "is not used by kind \"floor_spectrum\""},
    {"/spectrum", "\"signals\": 3", "\"signals\": 1", "\"signals\": 1000000", "/scene/excitation/signals",
     "must be in [1, 100000], got 1000000"},
};

static const struct {
	const char *document;
	const struct member *members;
	int n;
} kinds[] = {
    {documents_sensitivity, members, COUNT(members)},
    {documents_convergence, trial_members, COUNT(trial_members)},
    {documents_floor, floor_members, COUNT(floor_members)},
};

static void a_right_value_of_every_member_is_taken(void **state)
{
	(void)state;
	for (int k = 0; k < COUNT(kinds); k++)
		for (int i = 0; i < kinds[k].n; i++) {
			const struct member *member = &kinds[k].members[i];
			char *document = documents_with(kinds[k].document, member->from, member->right);
			study_free(documents_study(document));
			free(document);
		}
}

static void a_wrong_value_of_any_member_is_told_with_its_pointer(void **state)
{
	(void)state;
	for (int k = 0; k < COUNT(kinds); k++)
		for (int i = 0; i < kinds[k].n; i++) {
			const struct member *member = &kinds[k].members[i];
			char *document = documents_with(kinds[k].document, member->from, member->wrong);
			documents_problem(document, member->pointer, member->detail);
			free(document);
		}
}

static void every_field_has_a_right_and_a_wrong_example_here(void **state)
{
	(void)state;
	for (int f = 0; f < fields_count; f++) {
		const struct field *field = &fields[f];
		bool found = field->type >= FIELD_OBJECT || strstr(field->pattern, "acceleration_m_s2/*");
		for (int k = 0; k < COUNT(kinds); k++)
			for (int i = 0; i < kinds[k].n; i++)
				found |= strcmp(kinds[k].members[i].pattern, field->pattern) == 0;
		if (!found)
			fail_msg("no example of %s", field->pattern);
	}
}

static void absent_settings_are_some_and_empty_ones_none(void **state)
{
	(void)state;
	struct pound_study *s = documents_study(documents_convergence);
	assert_int_equal(pound_convergence_trials(s), 2 + 2 + 1 + 1);
	assert_int_equal(s->convergence.settings[1].n, 2);
	check_near(s->convergence.settings[1].values[1], 0.001, 0);
	assert_int_equal(study_runs(s), 12);
	study_free(s);
	char *document = documents_with(documents_response, "response", "convergence");
	s = documents_study(document);
	free(document);
	for (int row = 0; row < POUND_SOLVERS; row++)
		assert_true(row ? s->convergence.settings[row].n >= 4 : s->convergence.settings[row].n == 0);
	check_near(s->convergence.history, 2, 0);
	study_free(s);
	document = documents_with(documents_convergence, "[0.01, 0.001]", "[]");
	s = documents_study(document);
	assert_int_equal(s->convergence.settings[1].n, 0);
	study_free(s);
	free(document);
}

static void what_a_document_says_is_in_the_study(void **state)
{
	(void)state;
	struct pound_study *s = documents_study(documents_sensitivity);
	const struct pound_scene *scene = &s->scene;
	assert_int_equal(s->kind, POUND_KIND_SENSITIVITY);
	assert_string_equal(s->name, "a study");
	assert_string_equal(pound_law_name(scene->law.type), "elastoplastic");
	check_near(scene->law.hardening_ratio, 0.05, 0);
	check_near(scene->law.target_demand, 2, 0);
	check_near(scene->law.yield_displacement, 0, 0);
	assert_int_equal(scene->law.corrections, 1);
	assert_false(scene->oscillators[0].has_law);
	assert_true(scene->oscillators[1].has_law);
	check_near(scene->oscillators[0].frequency_hz, 2, 0);
	check_near(scene->oscillators[1].mass, 3, 0);
	check_near(scene->oscillators[1].damping_ratio, 0.02, 0);
	check_near(scene->oscillators[1].law.hardening_ratio, 0.1, 0);
	check_near(scene->oscillators[1].law.yield_displacement, 0.25, 0);
	assert_int_equal(scene->oscillators[1].law.corrections, 2);
	assert_true(scene->contact.present && scene->contact.tension);
	check_near(scene->contact.gap, 0.01, 0);
	check_near(scene->excitation.cycles, 20, 0);
	check_near(scene->excitation.duration, 0, 0);
	assert_int_equal(scene->excitation.signals, 5);
	assert_int_equal(s->n_inputs, 2);
	assert_string_equal(s->inputs[0].name, "f_e");
	assert_string_equal(s->inputs[1].name, "/oscillators/1/mass_kg");
	assert_int_equal(s->inputs[1].field.offset, offsetof(struct pound_scene, oscillators[1].mass));
	check_near(s->inputs[0].distribution.p[1], 5, 0);
	assert_int_equal(s->n_sweeps, 1);
	assert_int_equal(s->sweeps[0].field.offset, offsetof(struct pound_scene, contact.restitution));
	assert_int_equal(s->sweeps[0].n_values, 2);
	check_near(s->sweeps[0].values[1], 0.9, 0);
	assert_int_equal(s->design.rows, 10);
	assert_int_equal(s->design.seed, 42);
	assert_true(s->design.common_signals);
	assert_int_equal(s->n_outputs, 2);
	assert_string_equal(pound_output_name(s->outputs[1]), "impulse");
	check_near(s->solver.tolerance, 1e-9, 0);
	study_free(s);
}

static void absent_members_have_the_defaults_of_the_contract(void **state)
{
	(void)state;
	struct pound_study *s = documents_study(documents_response);
	const struct pound_excitation *e = &s->scene.excitation;
	assert_null(s->name);
	assert_string_equal(pound_law_name(s->scene.law.type), "linear");
	check_near(s->scene.law.hardening_ratio, 0.05, 0);
	check_near(s->scene.law.target_demand, 2, 0);
	assert_int_equal(s->scene.law.corrections, 1);
	for (int i = 0; i < 2; i++) {
		check_near(s->scene.oscillators[i].mass, 1, 0);
		check_near(s->scene.oscillators[i].damping_ratio, 0.05, 0);
		assert_false(s->scene.oscillators[i].rigid_wall || s->scene.oscillators[i].has_law);
	}
	assert_true(s->scene.contact.present && s->scene.contact.tension);
	check_near(s->scene.contact.stiffness_ratio, 100, 0);
	check_near(s->scene.contact.restitution, 0.6, 0);
	check_near(s->scene.contact.gap, 0, 0);
	assert_string_equal(pound_excitation_name(e->type), "kanai_tajimi");
	check_near(e->frequency_hz, 2.5, 0);
	check_near(e->damping_ratio, 0.6, 0);
	check_near(e->high_pass_ratio, 0.1, 0);
	check_near(e->cycles, 20, 0);
	check_near(e->rise, 0.15, 0);
	check_near(e->fall, 0.25, 0);
	check_near(e->time_step, 0.01, 0);
	check_near(e->peak, 1, 0);
	assert_int_equal(e->signals, 5);
	assert_int_equal(s->design.rows, 1000);
	assert_int_equal(s->design.seed, 42);
	assert_true(s->design.common_signals);
	assert_int_equal(s->n_outputs, 2);
	assert_string_equal(pound_output_name(s->outputs[0]), "force_amplification");
	assert_string_equal(pound_output_name(s->outputs[1]), "impulse");
	study_free(s);
}

#define SCENE(excitation) \
	"{\"kind\": \"response\", \"scene\": {\"oscillators\": [{\"frequency_hz\": 2}, {\"frequency_hz\": 3}], \
\"excitation\": " excitation "}}"

static void an_excitation_has_its_own_members_only(void **state)
{
	(void)state;
	struct pound_study *s =
	    documents_study(SCENE("{\"type\": \"record\", \"acceleration_m_s2\": [0, 1e0, -0.5]}"));
	assert_int_equal(s->scene.excitation.n_record, 3);
	assert_int_equal(s->scene.excitation.signals, 1);
	check_near(s->scene.excitation.record[2], -0.5, 0);
	study_free(s);
	s = documents_study(SCENE("{\"type\": \"harmonic\", \"duration_s\": 3}"));
	assert_int_equal(s->scene.excitation.signals, 1);
	check_near(s->scene.excitation.duration, 3, 0);
	check_near(s->scene.excitation.rise, 0, 0);
	study_free(s);
	study_free(documents_study(
	    SCENE("{\"type\": \"white_noise\", \"duration_s\": 3, \"rise\": 0, \"signals\": 2}")));
	documents_problem(
	    SCENE("{\"type\": \"harmonic\", \"duration_s\": 3, \"time_step_s\": 0.02, \"frequency_hz\": 25}"),
	    "/scene/excitation/frequency_hz",
	    "a sine needs more than two samples a cycle: at a time step of 0.02 s it must be below 25 Hz, got "
	    "25");
	study_free(documents_study(
	    SCENE("{\"type\": \"harmonic\", \"duration_s\": 3, \"time_step_s\": 0.02, \"frequency_hz\": 24.9}")));
	documents_problem(SCENE("{\"type\": \"harmonic\"}"), "/scene/excitation/duration_s",
	                  "is required: a number greater than 0 s");
	documents_problem(SCENE("{\"type\": \"record\"}"), "/scene/excitation/acceleration_m_s2",
	                  "is required: an array of 2 to 10000000 elements");
	documents_problem(SCENE("{\"type\": \"record\", \"acceleration_m_s2\": [1]}"),
	                  "/scene/excitation/acceleration_m_s2",
	                  "must be an array of 2 to 10000000 elements, got one of 1");
	documents_problem(SCENE("{\"type\": \"record\", \"acceleration_m_s2\": [1, \"x\"]}"),
	                  "/scene/excitation/acceleration_m_s2/1", "must be a number, got \"x\"");
	documents_problem(SCENE("{\"type\": \"record\", \"acceleration_m_s2\": [1, 2], \"signals\": 1}"),
	                  "/scene/excitation/signals", "is not used by excitation \"record\"");
	documents_problem(SCENE("{\"type\": \"white_noise\", \"duration_s\": 3, \"frequency_hz\": 1}"),
	                  "/scene/excitation/frequency_hz", "is not used by excitation \"white_noise\"");
}

static void members_are_known_once_and_used(void **state)
{
	(void)state;
	static const struct {
		const char *from, *to, *pointer, *detail;
	} cases[] = {
	    {"\"restitution\"", "\"restituton\"", "/scene/contact/restituton",
	     "unknown member, did you mean \"restitution\"?"},
	    {"\"restitution\"", "\"Restitution\"", "/scene/contact/Restitution",
	     "unknown member, did you mean \"restitution\"?"},
	    {"\"gap_m\"", "\"gap\"", "/scene/contact/gap", "unknown member, did you mean \"gap_m\"?"},
	    {"\"mass_kg\": 1,", "\"mass\": 1,", "/scene/oscillators/0/mass",
	     "unknown member, did you mean \"mass_kg\"?"},
	    {"\"tension\": true", "\"colour\": true", "/scene/contact/colour", "unknown member"},
	    {"\"name\": \"a study\"", "\"a/b~c\": 1", "/a~1b~0c", "unknown member"},
	    {"\"gap_m\": 0.01", "\"gap_m\": 0.01, \"gap_m\": 0.02", "/scene/contact/gap_m", "duplicate member"},
	    {"\"gap_m\": 0.01", "\"gap_m\": 0.01, \"\\u0067ap_m\": 0.01", "/scene/contact/gap_m",
	     "duplicate member"},
	    {"\"seed\": 42", "\"seed\": 42, \"sead\": 1", "/design/sead",
	     "unknown member, did you mean \"seed\"?"},
	    {"\"max\": 6", "\"max\": 6, \"min\": 1", "/inputs/1/distribution/min",
	     "is not used by distribution \"reciprocal_uniform\""},
	    {"\"max\": 6", "\"max\": 6, \"max\": 7", "/inputs/1/distribution/max", "duplicate member"},
	    {", \"max\": 5", "", "/inputs/0/distribution/max", "is required: a number"},
	    {"\"max\": 5", "\"max\": \"5\"", "/inputs/0/distribution/max", "must be a number, got \"5\""},
	    {"\"max\": 5", "\"max\": 0.5", "/inputs/0/distribution", "min must be less than max"},
	    {"\"type\": \"uniform\", ", "", "/inputs/0/distribution/type",
	     "is required: one of \"uniform\", \"log_uniform\", \"reciprocal_uniform\", \"normal\", "
	     "\"truncated_normal\", "
	     "\"lognormal\", \"triangular\", \"beta\", \"discrete\""},
	    {"{\"type\": \"uniform\", \"min\": 0.5, \"max\": 5}", "[0.5, 5]", "/inputs/0/distribution",
	     "must be an object, got an array"},
	    {"\"path\": \"/contact/restitution\", ", "", "/sweep/0/path",
	     "is required: a text of 1 to 200 characters"},
	    {", \"values\": [0.2, 0.9]", "", "/sweep/0/values", "is required: an array of 1 to 10000 elements"},
	    {"[0.2, 0.9]", "[]", "/sweep/0/values", "must be an array of 1 to 10000 elements, got one of 0"},
	    {"[0.2, 0.9]", "[0.2, 0.20]", "/sweep/0/values/1", "is the same as value 0"},
	    {"[0.2, 0.9]", "0.2", "/sweep/0/values", "must be an array of 1 to 10000 elements, got 0.2"},
	    {"\"target_demand\": 2", "\"target_demand\": 2, \"yield_displacement_m\": 1",
	     "/scene/law/target_demand", "is not used when yield_displacement_m is given"},
	    {"\"rigid_wall\": false", "\"rigid_wall\": false, \"rigid_wal\": 1", "/scene/oscillators/0/rigid_wal",
	     "unknown member, did you mean \"rigid_wall\"?"},
	    {"\"impulse\"]", "\"demand_amplification\"]", "/outputs/1", "is asked twice"},
	    {"[\"demand_amplification\", \"impulse\"]", "[]", "/outputs",
	     "must be an array of 1 to 8 elements, got one of 0"},
	    {"[\"demand_amplification\", \"impulse\"]", "{}", "/outputs",
	     "must be an array of 1 to 8 elements, got an object"},
	};
	for (int i = 0; i < COUNT(cases); i++) {
		char *document = documents_with(documents_sensitivity, cases[i].from, cases[i].to);
		documents_problem(document, cases[i].pointer, cases[i].detail);
		free(document);
	}
}

static void a_solver_has_its_own_members_only(void **state)
{
	(void)state;
	static const struct {
		const char *solver, *pointer, *detail;
	} cases[] = {
	    {"{\"step_s\": 1e-3}", "/solver/step_s", "is not used by solver \"event\""},
	    {"{\"tolerance\": 1e-6, \"method\": \"newmark\"}", "/solver/tolerance",
	     "is not used by solver \"newmark\""},
	    {"{\"method\": \"central_difference\", \"step_s\": 1e-9}", "/solver/step_s",
	     "asks for 1e+07 steps in one sample interval, at most 1000000"},
	};
	for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
		char member[160];
		snprintf(member, sizeof member, "\"solver\": %s, \"scene\"", cases[i].solver);
		char *document = documents_with(documents_response, "\"scene\"", member);
		documents_problem(document, cases[i].pointer, cases[i].detail);
		free(document);
	}
}

static void what_is_missing_is_named(void **state)
{
	(void)state;
	struct problems problems;
	documents_refused("{}", &problems);
	assert_int_equal(problems.n, 2);
	assert_string_equal(problems.list[0].pointer, "/kind");
	assert_string_equal(
	    problems.list[0].detail,
	    "is required: one of \"response\", \"sensitivity\", \"convergence\", \"floor_spectrum\"");
	assert_string_equal(problems.list[1].pointer, "/scene");
	documents_problem("{\"kind\": \"response\", \"scene\": {}}", "/scene/oscillators",
	                  "is required: an array of 2 elements");
	documents_problem("{\"kind\": \"response\", \"scene\": {\"oscillators\": [{\"frequency_hz\": 1}]}}",
	                  "/scene/oscillators", "must be an array of 2 elements, got one of 1");
	documents_problem("{\"kind\": \"response\", \"scene\": {\"oscillators\": [{\"frequency_hz\": 1}, {}]}}",
	                  "/scene/oscillators/1/frequency_hz", "is required: a number greater than 0 Hz");
	documents_problem("[]", "", "must be an object, got an array");
	documents_problem("3", "", "must be an object, got 3");
	char *document = documents_with(documents_response, "response", "sensitivity");
	documents_problem(document, "/inputs", "is required: an array of 1 to 16 elements");
	free(document);
}

static void a_kind_has_its_own_members_only(void **state)
{
	(void)state;
	char *document = documents_with(documents_response, "\"scene\"", "\"design\": {\"seed\": 7}, \"scene\"");
	study_free(documents_study(document));
	free(document);
	document = documents_with(documents_response, "\"scene\"", "\"inputs\": [], \"scene\"");
	documents_problem(document, "/inputs", "is not used by kind \"response\"");
	free(document);
	document = documents_with(documents_response, "\"scene\"", "\"design\": {\"rows\": 7}, \"scene\"");
	documents_problem(document, "/design/rows", "is not used by kind \"response\"");
	free(document);
}

static void only_the_right_oscillator_is_a_wall_and_a_wall_has_nothing(void **state)
{
	(void)state;
	char *wall = documents_with(documents_response, "{\"frequency_hz\": 3.1}", "{\"rigid_wall\": true}");
	struct pound_study *study = documents_study(wall);
	assert_true(study->scene.oscillators[1].rigid_wall);
	check_near(study->scene.oscillators[1].frequency_hz, 0, 0);
	study_free(study);
	free(wall);
	wall = documents_with(documents_response, "{\"frequency_hz\": 2}", "{\"rigid_wall\": true}");
	documents_problem(wall, "/scene/oscillators/0/rigid_wall",
	                  "only the right oscillator, the second, may be a rigid wall");
	free(wall);
	wall = documents_with(documents_response, "{\"frequency_hz\": 3.1}",
	                      "{\"rigid_wall\": true, \"mass_kg\": 1}");
	documents_problem(wall, "/scene/oscillators/1/mass_kg", "is not used by a rigid wall");
	free(wall);
	wall = documents_with(documents_response, "{\"frequency_hz\": 3.1}",
	                      "{\"rigid_wall\": true, \"masss_kg\": 1}");
	documents_problem(wall, "/scene/oscillators/1/masss_kg", "unknown member, did you mean \"mass_kg\"?");
	free(wall);
}

static void no_contact_is_null(void **state)
{
	(void)state;
	char *document =
	    documents_with(documents_response, "\"oscillators\"", "\"contact\": null, \"oscillators\"");
	struct pound_study *study = documents_study(document);
	assert_false(study->scene.contact.present);
	assert_int_equal(study->n_outputs, 1);
	assert_string_equal(pound_output_name(study->outputs[0]), "force_amplification");
	study_free(study);
	free(document);
	document = documents_with(documents_response, "\"oscillators\"", "\"contact\": false, \"oscillators\"");
	documents_problem(document, "/scene/contact", "must be an object, got false");
	free(document);
}

static void all_mistakes_are_told_at_once(void **state)
{
	(void)state;
	struct problems problems;
	documents_refused(
	    "{\"kind\": \"response\", \"colour\": 1, \"scene\": {\"law\": {\"type\": \"lineer\"}, "
	    "\"oscillators\": "
	    "[{\"frequency_hz\": 0, \"mass\": 2}, {\"damping_ratio\": 1}], \"contact\": {\"restitution\": 1.4, "
	    "\"restitution\": 1}, \"excitation\": {\"signals\": 0.5}}}",
	    &problems);
	static const char *const pointers[] = {"/colour",
	                                       "/scene/law/type",
	                                       "/scene/oscillators/0/frequency_hz",
	                                       "/scene/oscillators/0/mass",
	                                       "/scene/oscillators/1/damping_ratio",
	                                       "/scene/oscillators/1/frequency_hz",
	                                       "/scene/contact/restitution",
	                                       "/scene/contact/restitution",
	                                       "/scene/excitation/signals"};
	assert_int_equal(problems.status, PROBLEMS_INVALID);
	assert_int_equal(problems.n, COUNT(pointers));
	for (int i = 0; i < COUNT(pointers); i++)
		assert_string_equal(problems.list[i].pointer, pointers[i]);
}

static void broken_json_is_told_by_line_and_column(void **state)
{
	(void)state;
	struct problems problems;
	documents_refused("{\"kind\": \"response\",\n \"scene\": {\"law\": {\"hardening_ratio\": 01}}}",
	                  &problems);
	assert_int_equal(problems.status, PROBLEMS_MALFORMED);
	assert_int_equal(problems.line, 2);
	assert_int_equal(problems.column, 39);
	assert_string_equal(problems.list[0].detail, "a number must not start with 0 and further digits");
}

static void the_text_need_not_end_with_a_zero(void **state)
{
	(void)state;
	struct problems problems;
	size_t length = strlen(documents_response);
	char *exact = malloc(length);
	assert_non_null(exact);
	memcpy(exact, documents_response, length);
	struct pound_study *study = study_from_json(exact, length, &problems);
	free(exact);
	assert_non_null(study);
	study_free(study);
}

static void a_stranger_s_text_is_shown_short_and_tame(void **state)
{
	(void)state;
	char *document = documents_with(
	    documents_response, "\"scene\"",
	    "\"solver\": {\"method\": \"\\u001b[31mred\\n0123456789012345678901234567890123456789\"}, \"scene\"");
	documents_problem(document, "/solver/method",
	                  "must be one of \"event\", \"newmark\", \"central_difference\", \"adaptive\", got "
	                  "\"?[31mred?0123456789012345678901234567890...\"");
	free(document);
}

CHECK_MAIN(cmocka_unit_test(a_right_value_of_every_member_is_taken),
           cmocka_unit_test(a_wrong_value_of_any_member_is_told_with_its_pointer),
           cmocka_unit_test(every_field_has_a_right_and_a_wrong_example_here),
           cmocka_unit_test(absent_settings_are_some_and_empty_ones_none),
           cmocka_unit_test(what_a_document_says_is_in_the_study),
           cmocka_unit_test(absent_members_have_the_defaults_of_the_contract),
           cmocka_unit_test(an_excitation_has_its_own_members_only),
           cmocka_unit_test(members_are_known_once_and_used),
           cmocka_unit_test(a_solver_has_its_own_members_only), cmocka_unit_test(what_is_missing_is_named),
           cmocka_unit_test(a_kind_has_its_own_members_only),
           cmocka_unit_test(only_the_right_oscillator_is_a_wall_and_a_wall_has_nothing),
           cmocka_unit_test(no_contact_is_null), cmocka_unit_test(all_mistakes_are_told_at_once),
           cmocka_unit_test(broken_json_is_told_by_line_and_column),
           cmocka_unit_test(the_text_need_not_end_with_a_zero),
           cmocka_unit_test(a_stranger_s_text_is_shown_short_and_tame))
