/* The dashpot beside the contact spring against the table of known answers and its limits. */
#include <float.h>
#include <math.h>

#include "engine/pound.h"
#include "engine/scene/contact.h"
#include "tests/support/check.h"

static void the_damping_ratio_is_the_one_of_the_known_answers(void **state)
{
	(void)state;
	// of e = 0, 0.1 .. 1 to nine decimals
	static const double zeta[] = {1,          .591155034, .455949811, .357857131, .279997993, .215453762,
	                              .160493047, .112808451, .070850300, .033518449, 0};
	for (int tenth = 0; tenth <= 10; tenth++)
		check_near(pound_contact_damping_ratio(0, tenth / 10.0), zeta[tenth], 0.5001e-9);
}

static void the_damping_ratio_is_the_equation_to_rounding(void **state)
{
	(void)state;
	const long double pi = 3.14159265358979323846L;
	// a logarithm to two units of the last place, a square root and a quotient
	for (double e = 1; e > 1e-300; e *= 0.9371) {
		long double l = logl(e), want = -l / sqrtl(pi * pi + l * l);
		check_near(pound_contact_damping_ratio(0, e), (double)want, 4 * DBL_EPSILON * (double)want);
	}
}

static void the_damping_ratio_falls_from_one_to_zero_without_a_step(void **state)
{
	(void)state;
	double before = pound_contact_damping_ratio(0, 0);
	assert_true(before == 1);
	// the smallest numbers have few bits and a logarithm all the same
	for (double e = DBL_TRUE_MIN; e < 1; e *= 1.5 + DBL_TRUE_MIN / e) {
		double zeta = pound_contact_damping_ratio(0, e);
		assert_true(zeta > 0 && zeta <= before);
		before = zeta;
	}
	check_near(pound_contact_damping_ratio(0, DBL_TRUE_MIN), 1, 1e-5);
	assert_true(pound_contact_damping_ratio(0, 1) == 0);
}

CHECK_MAIN(cmocka_unit_test(the_damping_ratio_is_the_one_of_the_known_answers),
           cmocka_unit_test(the_damping_ratio_is_the_equation_to_rounding),
           cmocka_unit_test(the_damping_ratio_falls_from_one_to_zero_without_a_step))
