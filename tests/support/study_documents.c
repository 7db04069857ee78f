/* study_documents.c - study documents for tests. */
#include "tests/support/study_documents.h"

#include <string.h>

#include "schema/study/study_json.h"
#include "tests/support/check.h"

const char study_documents_sensitivity[] =
    "{\"kind\": \"sensitivity\", \"name\": \"a study\",\n"
    " \"scene\": {\n"
    "  \"law\": {\"type\": \"elastoplastic\", \"hardening_ratio\": 0.05, \"target_demand\": 2, "
    "\"corrections\": 1},\n"
    "  \"oscillators\": [\n"
    "   {\"mass_kg\": 1, \"frequency_hz\": 2, \"damping_ratio\": 0.05, \"rigid_wall\": false},\n"
    "   {\"mass_kg\": 3, \"frequency_hz\": 3.1, \"damping_ratio\": 0.02,\n"
    "    \"law\": {\"type\": \"linear\", \"hardening_ratio\": 0.1, \"yield_displacement_m\": 0.25, "
    "\"corrections\": 2}}],\n"
    "  \"contact\": {\"model\": \"kelvin_voigt\", \"stiffness_ratio\": 100, \"restitution\": 0.6, \"gap_m\": "
    "0.01,\n"
    "   \"tension\": true},\n"
    "  \"excitation\": {\"type\": \"kanai_tajimi\", \"frequency_hz\": 2.5, \"damping_ratio\": 0.6,\n"
    "   \"high_pass_ratio\": 0.1, \"cycles\": 20, \"rise\": 0.15, \"fall\": 0.25, \"time_step_s\": 0.01,\n"
    "   \"peak_m_s2\": 1, \"signals\": 5}},\n"
    " \"inputs\": [\n"
    "  {\"path\": \"/excitation/frequency_hz\", \"name\": \"f_e\",\n"
    "   \"distribution\": {\"type\": \"uniform\", \"min\": 0.5, \"max\": 5}},\n"
    "  {\"path\": \"/oscillators/1/mass_kg\", \"distribution\": {\"type\": \"reciprocal_uniform\", \"max\": "
    "6}}],\n"
    " \"sweep\": [{\"path\": \"/contact/restitution\", \"values\": [0.2, 0.9]}],\n"
    " \"design\": {\"method\": \"lhs\", \"rows\": 10, \"seed\": 42, \"signals\": \"common\"},\n"
    " \"outputs\": [\"demand_amplification\", \"impulse\"],\n"
    " \"solver\": {\"method\": \"event\", \"tolerance\": 1e-9}}\n";

const char study_documents_row[] =
    "{\"kind\": \"sensitivity\", \"scene\": {\n"
    "  \"buildings\": [\n"
    "   {\"storeys\": 2, \"mass_kg\": [1e5, 9e4], \"stiffness_n_m\": [4e7, 3e7], \"damping\": \"rayleigh\",\n"
    "    \"damping_modes\": [1, 2]},\n"
    "   {\"storeys\": 3, \"mass_kg\": 2e5, \"frequency_hz\": 3, \"stiffness_profile\": [1.5, 1.2, 1], "
    "\"height_m\": 3.5,\n"
    "    \"damping\": \"storey\", \"damping_ratio\": 0.02,\n"
    "    \"law\": {\"type\": \"elastoplastic\", \"hardening_ratio\": 0.1, \"target_demand\": 2, "
    "\"corrections\": 1}},\n"
    "   {\"rigid_wall\": true}],\n"
    "  \"contact\": {\"restitution\": 0.5, \"gap_m\": 0.01},\n"
    "  \"contacts\": [{\"left_building\": 0, \"levels\": [2, 2.4], \"gap_m\": 0.02}, {\"levels\": [1, 1]},\n"
    "   {\"left_building\": 1, \"levels\": [3, 1], \"model\": \"kelvin_voigt\", \"stiffness_ratio\": 50,\n"
    "    \"restitution\": 0.9, \"tension\": false}],\n"
    "  \"excitation\": {\"signals\": 2}},\n"
    " \"places\": [{\"building\": 0, \"storey\": 1}, {\"building\": 1, \"storey\": 3}],\n"
    " \"inputs\": [{\"path\": \"/buildings/0/mass_kg/1\", \"distribution\": {\"type\": \"uniform\", \"min\": "
    "5e4, \"max\": 2e5}}],\n"
    " \"outputs\": [\"drift_amplification\", \"impulse\"], \"design\": {\"rows\": 10}}\n";

const char study_documents_response[] =
    "{\"kind\": \"response\", \"scene\": {\"oscillators\": [{\"frequency_hz\": "
    "2}, {\"frequency_hz\": 3.1}]}}";

const char study_documents_convergence[] = "{\"kind\": \"convergence\", \"scene\": {\"oscillators\": "
                                           "[{\"frequency_hz\": 2}, {\"frequency_hz\": 3.1}],\n"
                                           "  \"excitation\": {\"signals\": 2}},\n"
                                           " \"convergence\": {\"newmark\": {\"steps_s\": [0.01, 0.001]}, "
                                           "\"central_difference\": {\"steps_s\": [0.005]},\n"
                                           "  \"adaptive\": {\"tolerances\": [1e-4]}, \"history_s\": 2}}\n";

const char study_documents_floor[] =
    "{\"kind\": \"floor_spectrum\", \"scene\": {\"oscillators\": [{\"frequency_hz\": 2}, {\"frequency_hz\": "
    "3.1}],\n"
    "  \"excitation\": {\"cycles\": 5, \"signals\": 3}},\n"
    " \"spectrum\": {\"frequencies_hz\": {\"min\": 0.5, \"max\": 50, \"count\": 9}, \"damping_ratio\": 0.02, "
    "\"pulses\": 15},\n"
    " \"histories\": false, \"design\": {\"seed\": 7}}\n";

const char study_documents_separation[] =
    "{\"kind\": \"separation\", \"scene\": {\"oscillators\": [{\"frequency_hz\": 2}, {\"frequency_hz\": 3}], "
    "\"excitation\": {\"signals\": 4}}, \"sweep\": [{\"path\": \"/excitation/peak_m_s2\", \"values\": [1, "
    "2]}], "
    "\"separation\": {\"gaps_m\": [0, 0.01], \"probabilities\": [0.5, 0.1], \"intensity\": "
    "\"/excitation/peak_m_s2\", \"hazard\": {\"intensities\": [0.1, 5], \"annual_rates\": [0.1, 0.001]}, "
    "\"return_periods_years\": [475]}, \"design\": {\"seed\": 7}}";

const char *documents_named(const char *name)
{
	static const struct {
		const char *name, *document;
	} all[] = {{"sensitivity", study_documents_sensitivity},
	           {"response", study_documents_response},
	           {"row", study_documents_row},
	           {"convergence", study_documents_convergence},
	           {"floor", study_documents_floor},
	           {"separation", study_documents_separation}};
	for (size_t i = 0; i < sizeof all / sizeof all[0]; i++)
		if (strcmp(all[i].name, name) == 0)
			return all[i].document;
	fail_msg("no document has the name %s", name);
	return NULL;
}

char *study_documents_with(const char *document, const char *from, const char *to)
{
	const char *at = strstr(document, from);
	if (!at)
		fail_msg("the document has no %s", from);
	char *copy = malloc(strlen(document) + strlen(to) + 1);
	assert_non_null(copy);
	memcpy(copy, document, (size_t)(at - document));
	strcpy(stpcpy(copy + (at - document), to), at + strlen(from));
	return copy;
}

struct pound_study *study_documents_study(const char *document)
{
	static struct problems problems;
	struct pound_study *study = study_from_json(document, strlen(document), &problems);
	for (int i = 0; i < problems.n; i++)
		print_error("%s: %s\n", problems.list[i].pointer, problems.list[i].detail);
	if (!study)
		fail_msg("refused: %s", document);
	assert_int_equal(problems.status, PROBLEMS_NONE);
	return study;
}

void study_documents_refused(const char *document, struct problems *problems)
{
	struct pound_study *study = study_from_json(document, strlen(document), problems);
	if (study)
		fail_msg("accepted: %s", document);
	assert_int_not_equal(problems->status, PROBLEMS_NONE);
	assert_true(problems->n > 0);
}

void study_documents_problem(const char *document, const char *pointer, const char *detail)
{
	static struct problems problems;
	study_documents_refused(document, &problems);
	if (problems.n != 1 || strcmp(problems.list[0].pointer, pointer) ||
	    strcmp(problems.list[0].detail, detail)) {
		for (int i = 0; i < problems.n; i++)
			print_error("got    %s: %s\n", problems.list[i].pointer, problems.list[i].detail);
		fail_msg("wanted %s: %s", pointer, detail);
	}
}
