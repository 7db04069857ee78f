/* unit_capabilities.c - if a solver or a check does not support a contact model, the reader of studies refuses the
 * study.
 *
 * The Makefile links pound_contact_force through this file, which gives a contact model another form of force. */
#include "engine/pound.h"
#include "schema/study/study_json.h"
#include "tests/support/check.h"
#include "tests/support/study_documents.h"

#include <string.h>

enum pound_force __real_pound_contact_force(int row);
enum pound_force __wrap_pound_contact_force(int row);

static bool pretends;
static enum pound_force pretended;

enum pound_force __wrap_pound_contact_force(int row)
{
	return pretends ? pretended : __real_pound_contact_force(row);
}

static void every_solver_takes_the_form_of_force_of_the_default_model(void **state)
{
	(void)state;
	for (int row = 0; row < POUND_SOLVERS; row++)
		assert_true(pound_solver_takes_force(row, __real_pound_contact_force(0)));
}

static const char PAIR[] = "{\"kind\": \"response\", \"scene\": {\"oscillators\": [{\"frequency_hz\": 2}, "
                           "{\"frequency_hz\": 3.1}]}, \"solver\": {\"method\": \"%s\"}}";

static void a_contact_model_that_the_solver_cannot_integrate_is_refused_with_both_names(void **state)
{
	(void)state;
	for (pretended = 0; pretended < POUND_FORCES; pretended++)
		for (int row = 0; row < POUND_SOLVERS; row++) {
			char document[512], detail[200];
			snprintf(document, sizeof document, PAIR, pound_solver_name(row));
			snprintf(detail, sizeof detail,
			         "the solver \"%s\" cannot integrate the contact model \"kelvin_voigt\"",
			         pound_solver_name(row));
			pretends = true;
			if (pound_solver_takes_force(row, pretended))
				study_free(study_documents_study(document));
			else
				study_documents_problem(document, "/scene/contact/model", detail);
			pretends = false;
		}
}

static void a_study_without_contact_does_not_need_it(void **state)
{
	(void)state;
	pretends = true;
	pretended = POUND_FORCE_POWER;
	char *document = study_documents_with(study_documents_response, "{\"oscillators\"",
	                                      "{\"contact\": null, \"oscillators\"");
	study_free(study_documents_study(document));
	pretends = false;
	free(document);
}

static void every_solver_of_a_convergence_study_must_take_it(void **state)
{
	(void)state;
	static struct problems problems;
	pretends = true;
	pretended = POUND_FORCE_IMPACT; // no fixed step supports it
	study_documents_refused(study_documents_convergence, &problems);
	int n_expected = 0;
	for (int row = 0; row < POUND_SOLVERS; row++)
		n_expected += !pound_solver_takes_force(row, pretended);
	assert_true(n_expected > 0);
	assert_int_equal(problems.n, n_expected);
	pretends = false;
}

CHECK_MAIN(cmocka_unit_test(every_solver_takes_the_form_of_force_of_the_default_model),
           cmocka_unit_test(a_contact_model_that_the_solver_cannot_integrate_is_refused_with_both_names),
           cmocka_unit_test(a_study_without_contact_does_not_need_it),
           cmocka_unit_test(every_solver_of_a_convergence_study_must_take_it))
