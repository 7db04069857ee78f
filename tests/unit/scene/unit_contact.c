/* unit_contact.c - contact models: calibrations against tables computed by other programs and against their
 * equations; branches against isolated impacts of known restitution, duration and largest force.
 *
 * Isolated impacts are integrated here by Runge-Kutta steps that are short at first, because p^1.5 has no third
 * derivative at the start of a contact: the tests of the solvers have more digits. */
#include <float.h>
#include <math.h>
#include <string.h>

#include "engine/pound.h"
#include "engine/scene/contact.h"
#include "tests/support/check.h"

static void the_damping_ratio_is_the_one_of_the_known_answers(void **state)
{
	(void)state;
	// for e = 0, 0.1 .. 1, to nine decimals
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
	// subnormal numbers have few bits, but a logarithm
	for (double e = DBL_TRUE_MIN; e < 1; e *= 1.5 + DBL_TRUE_MIN / e) {
		double zeta = pound_contact_damping_ratio(0, e);
		assert_true(zeta > 0 && zeta <= before);
		before = zeta;
	}
	check_near(pound_contact_damping_ratio(0, DBL_TRUE_MIN), 1, 1e-5);
	assert_true(pound_contact_damping_ratio(0, 1) == 0);
}

/* ---- calibrations ---- */

#define COUNT(array) (int)(sizeof(array) / sizeof(array)[0])

static int row_of(const char *name)
{
	int row = 0;
	while (strcmp(pound_contact_name(row), name) != 0)
		row++;
	return row;
}

static struct pound_contact contact_of(const char *model, const char *calibration, double restitution,
                                       bool tension)
{
	struct pound_contact contact = {.present = true,
	                                .model = row_of(model),
	                                .stiffness_ratio = 1,
	                                .reference_speed = 1,
	                                .restitution = restitution,
	                                .calibration = strcmp(calibration, "exact") == 0,
	                                .tension = tension,
	                                .second_stiffness_ratio = 0.3,
	                                .yield_overlap = 2e-4,
	                                .speed_floor = 1e-3};
	assert_string_equal(pound_calibration_name(contact.calibration), calibration);
	return contact;
}

/* The dashpot z, x or D for K = m = 1. */
static double dashpot(const char *model, const char *calibration, double restitution, bool tension)
{
	static const struct pound_contact_place unit = {1, 1, 1};
	struct pound_contact contact = contact_of(model, calibration, restitution, tension);
	contact.hertz_stiffness = 1;
	const bool ratio = pound_contact_reads(contact.model, "speed_floor_m_s");
	return pound_contact_law(&contact, &unit).dashpot / (ratio ? 1 : 2);
}

/* ---- restitution by the closed forms, with the C library in extended precision ---- */

typedef long double real;

static real approach_only(real z)
{
	if (z == 1)
		return expl(-1);
	const real w = sqrtl(fabsl(1 - z * z));
	return expl(-z / w * (z < 1 ? acosl(z) : acoshl(z)));
}

static real released_at_no_force(real z)
{
	if (z == 1)
		return expl(-2);
	const real w = sqrtl(fabsl(1 - z * z));
	return expl(-z / w * (z < 1 ? 3.14159265358979323846L - 2 * asinl(z) : logl((z + w) / (z - w))));
}

/* e from D (1 + e) = ln((1 + D)/(1 - D e)), by bisection: between e = 0 and the root the right side minus the left
 * one is negative; beyond the root it is positive. */
static real by_ratio(real D)
{
	real low = 0, high = fminl(1, 1 / D);
	for (int k = 0; k < 200; k++) {
		const real e = (low + high) / 2;
		if (D * e < 1 && log1pl(D) - log1pl(-D * e) < D * (1 + e))
			low = e;
		else
			high = e;
	}
	return low;
}

static const double ROOT_5 = 2.23606797749978969641;

static void calibrations_are_those_of_the_table_of_known_answers(void **state)
{
	(void)state;
	static const struct {
		double e, z_approach, e_modified, x, e_viscoelastic, z_released, e_released, D, e_ratio;
	} rows[] = {
	    {.1, 4.80694180178, .102491822474, 5.37432431633, .0933240655030, 1.24318785101, .252729379588,
	     9.99815939750, .665265406755},
	    {.3, 1.33602692560, .306983215468, 1.49372351270, .291746359258, .497239394699, .397140499886,
	     3.08708198113, .684224605749},
	    {.5, .597342252154, .506138747052, .667848940824, .494587797017, .255275637649, .550283169627,
	     1.43275053327, .725241114010},
	    {.65, .329293757849, .653787390425, .368161613559, .647029026873, .149938758895, .674751472505,
	     .793100908858, .774819081180},
	    {.8, .155847626475, .801448470363, .174242943465, .798943843407, .0743550970976, .808099335254,
	     .373146203365, .847102279788},
	    {.95, .0333441113601, .950101523758, .0372798498253, .949929346311, .0164982309202, .950506584880,
	     .0789266052874, .953506045142},
	};
	// twelve digits
	for (int i = 0; i < COUNT(rows); i++) {
		const double e = rows[i].e, digits = 0.51e-11;
		check_near(dashpot("modified_kelvin_voigt", "exact", e, true), rows[i].z_approach,
		           digits * rows[i].z_approach);
		check_near(dashpot("viscoelastic", "exact", e, true), rows[i].x, digits * rows[i].x);
		check_near(dashpot("kelvin_voigt", "exact", e, false), rows[i].z_released,
		           digits * rows[i].z_released);
		check_near(dashpot("damped_hertz", "exact", e, false), ROOT_5 / 2 * rows[i].z_released,
		           digits * rows[i].z_released);
		check_near(dashpot("hertz_damp", "exact", e, true), rows[i].D, digits * rows[i].D);
		check_near(dashpot("hunt_crossley", "exact", e, true), rows[i].D, digits * rows[i].D);
		check_near((double)approach_only(dashpot("modified_kelvin_voigt", "classic", e, true)),
		           rows[i].e_modified, digits * rows[i].e_modified);
		check_near((double)approach_only(2 / ROOT_5 * dashpot("viscoelastic", "classic", e, true)),
		           rows[i].e_viscoelastic, digits * rows[i].e_viscoelastic);
		check_near((double)released_at_no_force(dashpot("kelvin_voigt", "classic", e, false)),
		           rows[i].e_released, digits * rows[i].e_released);
		check_near((double)by_ratio(dashpot("hertz_damp", "classic", e, true)), rows[i].e_ratio,
		           digits * rows[i].e_ratio);
	}
	// a contact with tension ends at zero overlap: both calibrations agree
	check_near(dashpot("kelvin_voigt", "exact", 0.3, true), dashpot("kelvin_voigt", "classic", 0.3, true), 0);
	check_near(dashpot("damped_hertz", "classic", 0.3, true),
	           ROOT_5 / 2 * dashpot("kelvin_voigt", "classic", 0.3, true), DBL_EPSILON);
}

static void exact_dashpots_give_the_restitution_that_was_asked_for(void **state)
{
	(void)state;
	for (double e = 1 - 0x1p-20; e > 1e-6; e *= 0.97) {
		// effect of a rounding of the dashpot and of the logarithm of e; D approaches 1/e, where 1 - D e cancels
		const double rounding = 16 * DBL_EPSILON * (1 + fabs(log(e)));
		check_near((double)approach_only(dashpot("modified_kelvin_voigt", "exact", e, true)), e,
		           rounding * e);
		check_near((double)approach_only(2 / ROOT_5 * dashpot("viscoelastic", "exact", e, true)), e,
		           rounding * e);
		check_near((double)released_at_no_force(dashpot("kelvin_voigt", "exact", e, false)), e, rounding * e);
		const double D = dashpot("hertz_damp", "exact", e, true), curvature = fmax(1, 1 / (e * D * D));
		check_near((double)by_ratio(D), e, 64 * DBL_EPSILON * curvature);
	}
	static const char *const models[] = {"kelvin_voigt", "modified_kelvin_voigt", "viscoelastic",
	                                     "damped_hertz", "hunt_crossley",         "hertz_damp"};
	for (int m = 0; m < COUNT(models); m++)
		for (int tension = 0; tension < 2; tension++) {
			assert_true(dashpot(models[m], "exact", 1, tension) == 0);
			assert_true(dashpot(models[m], "classic", 1, tension) == 0);
			for (double e = DBL_TRUE_MIN; e < 1; e *= 3) {
				assert_true(isfinite(dashpot(models[m], "exact", e, tension)));
				assert_true(isfinite(dashpot(models[m], "classic", e, tension)));
			}
		}
}

static void restitution_0_has_a_dashpot_where_the_table_says_so(void **state)
{
	(void)state;
	static const struct {
		const char *model;
		bool classic, exact, exact_released;
	} rows[] = {
	    {"kelvin_voigt", true, true, false},   {"modified_kelvin_voigt", false, false, false},
	    {"hunt_crossley", true, false, false}, {"hertz_damp", true, false, false},
	    {"viscoelastic", false, false, false}, {"damped_hertz", true, true, false},
	    {"linear", true, true, true},          {"rigid", true, true, true},
	};
	for (int i = 0; i < COUNT(rows); i++) {
		struct pound_contact contact = contact_of(rows[i].model, "classic", 0, true);
		assert_int_equal(pound_contact_takes_zero(&contact), rows[i].classic);
		contact.calibration = 1;
		assert_int_equal(pound_contact_takes_zero(&contact), rows[i].exact);
		contact.tension = false;
		assert_int_equal(pound_contact_takes_zero(&contact), rows[i].exact_released);
	}
}

static void the_largest_overlap_of_both_springs_is_one_at_the_reference_speed(void **state)
{
	(void)state;
	for (double s = 1e-3; s < 10; s *= 3) {
		const double k = 3e7, m = 4e4;
		struct pound_contact contact = contact_of("hertz", "classic", 1, true);
		contact.reference_speed = s;
		contact.stiffness_ratio = 100;
		struct pound_contact_place place = {.stiffness = k / 100, .inverse_mass = 1 / m, .mass = 1};
		const double K = pound_contact_law(&contact, &place).stiffness;
		const double linear = s * sqrt(m / k), power = pow(5 * m * s * s / (4 * K), 0.4);
		check_near(power, linear, 16 * DBL_EPSILON * linear);
		// per mass
		place =
		    (struct pound_contact_place){.stiffness = k / 100 / 1e5, .inverse_mass = 1e5 / m, .mass = 1e5};
		check_near(pound_contact_law(&contact, &place).stiffness, K / 1e5, 16 * DBL_EPSILON * K / 1e5);
		contact.hertz_stiffness = 5e8;
		check_near(pound_contact_law(&contact, &place).stiffness, 5e3, DBL_EPSILON * 5e3);
		contact.stiffness = 2e7, contact.hertz_stiffness = 0;
		place.mass = 1, place.inverse_mass = 1 / m;
		check_near(pound_contact_law(&contact, &place).stiffness, K * pow(2.0 / 3, 1.25),
		           32 * DBL_EPSILON * K);
	}
}

/* ---- isolated impacts ---- */

struct impact {
	double restitution, duration, force_max;
};

static void slope(const struct pound_touch *touch, double m, const double y[2], double dy[2])
{
	dy[0] = y[1];
	dy[1] = -pound_contact_force_on(&touch->on, y[0], y[1]) / m;
}

static void runge_kutta(const struct pound_touch *touch, double m, double h, const double y[2], double end[2])
{
	static const double place[4] = {0, 0.5, 0.5, 1}, weight[4] = {1, 2, 2, 1};
	double dy[2] = {0}, stage[2];
	memcpy(end, y, sizeof(double) * 2);
	for (int k = 0; k < 4; k++) {
		for (int i = 0; i < 2; i++)
			stage[i] = y[i] + place[k] * h * dy[i];
		slope(touch, m, stage, dy);
		for (int i = 0; i < 2; i++)
			end[i] += h / 6 * weight[k] * dy[i];
	}
}

/* How far a state is beyond the first edge of its branch; 0: at the edge. */
static double beyond(const struct pound_contact_law *law, const struct pound_touch *touch, const double y[2])
{
	double most = touch->on.low - y[0];
	most = fmax(most, touch->on.high < DBL_MAX ? y[0] - touch->on.high : -1);
	if (touch->on.direction != 0)
		most = fmax(most, -touch->on.direction * y[1]);
	if (!law->tension)
		most = fmax(most, -pound_contact_force_on(&touch->on, y[0], y[1]));
	return most;
}

/* Passes to the next branch if the state is at an edge between branches; whether it was. */
static bool passed(const struct pound_contact_law *law, struct pound_touch *touch, const double y[2])
{
	if (y[0] >= touch->on.high)
		pound_contact_leave(law, touch, POUND_EDGE_HIGH, y[0]);
	else if (touch->on.low > 0 && y[0] <= touch->on.low)
		pound_contact_leave(law, touch, POUND_EDGE_LOW, y[0]);
	else if (touch->on.direction * y[1] < 0)
		pound_contact_leave(law, touch, POUND_EDGE_REVERSAL, y[0]);
	else
		return false;
	return true;
}

/* Two free bodies of effective mass m that collide with speed v. */
static struct impact impact(const struct pound_contact_law *law, double m, double v, double h)
{
	double y[2] = {0, v}, end[2], time = 0;
	struct impact result = {0};
	struct pound_touch touch;
	pound_contact_begin(law, &touch, v);
	for (;;) {
		// near zero overlap a power law needs steps that are short relative to the time since contact began
		double step = fmin(h, 1e-2 * y[0] / fabs(y[1]) + 1e-5 * h);
		runge_kutta(&touch, m, step, y, end);
		if (beyond(law, &touch, end) > 0) {
			double low = 0;
			for (int k = 0; k < 60; k++) {
				const double middle = (low + step) / 2;
				runge_kutta(&touch, m, middle, y, end);
				if (beyond(law, &touch, end) > 0)
					step = middle;
				else
					low = middle;
			}
			runge_kutta(&touch, m, step, y, end);
		}
		time += step;
		memcpy(y, end, sizeof y);
		result.force_max = fmax(result.force_max, pound_contact_force_on(&touch.on, y[0], y[1]));
		if (beyond(law, &touch, y) > 0 && !passed(law, &touch, y))
			break;
	}
	result.restitution = -y[1] / v;
	result.duration = time;
	return result;
}

static void isolated_impacts_are_those_of_the_known_answers(void **state)
{
	(void)state;
	static const struct {
		const char *model;
		struct pound_contact_law law; // its dashpot is z, x or D
		struct impact known;          // 0: unknown
	} cases[] = {
	    {"linear", {.stiffness = 1e5, .tension = true}, {1, .00811155735194722, 77.4596669241483}},
	    {"modified_kelvin_voigt",
	     {.stiffness = 1e5, .dashpot = 0.2, .tension = true},
	     {.756134926838310, .00766456574121097, 0}},
	    {"hertz", {.stiffness = 1e6, .tension = true}, {1, .0138590709920071, 53.0929379397467}},
	    {"hertz_damp", {.stiffness = 1e6, .dashpot = 0.5, .tension = true}, {.748434931597434, 0, 0}},
	    {"hunt_crossley", {.stiffness = 1e5, .dashpot = 0.5, .tension = true}, {.748434931597434, 0, 0}},
	    {"viscoelastic", {.stiffness = 1e6, .dashpot = 0.3, .tension = true}, {.696375578094729, 0, 0}},
	    {"damped_hertz", {.stiffness = 1e6, .dashpot = 0.3, .tension = true}, {.416833396691265, 0, 0}},
	    {"damped_hertz", {.stiffness = 1e6, .dashpot = 0.3, .tension = false}, {.484938945766768, 0, 0}},
	    {"bilinear",
	     {.stiffness = 1e5, .second_stiffness = 3e4, .yield_overlap = 2e-4, .tension = true},
	     {.775673013829125, 0, 45.6070170039655}},
	};
	const double m = 2.0 / 3, v = 0.3;
	for (int i = 0; i < COUNT(cases); i++) {
		struct pound_contact_law law = cases[i].law;
		law.model = row_of(cases[i].model);
		if (!pound_contact_reads(law.model, "speed_floor_m_s"))
			law.dashpot *= 2 * sqrt(law.stiffness * m);
		const struct impact coarse = impact(&law, m, v, 4e-6), fine = impact(&law, m, v, 2e-6);
		// the coarse steps have at least twice the error of the fine ones; rounding errors of 1e4 steps
		const double rounding = 1e-12;
		check_near(fine.restitution, cases[i].known.restitution,
		           2 * fabs(fine.restitution - coarse.restitution) + rounding);
		if (cases[i].known.duration > 0)
			check_near(fine.duration, cases[i].known.duration,
			           2 * fabs(fine.duration - coarse.duration) + rounding);
		// the largest force is taken at the end of a step, at most half a step from the peak of a parabola
		if (cases[i].known.force_max > 0)
			check_near(fine.force_max, cases[i].known.force_max, 1e-6 * cases[i].known.force_max);
		assert_true(fabs(fine.restitution - coarse.restitution) < 1e-7);
	}
}

/* F over p, loading, unloading and loading again: the path of the overlap, and the force at each point. */
static void the_bilinear_branches_follow_its_two_lines(void **state)
{
	(void)state;
	const struct pound_contact_law law = {.model = row_of("bilinear"),
	                                      .stiffness = 10,
	                                      .second_stiffness = 4,
	                                      .yield_overlap = 1,
	                                      .tension = true};
	static const struct {
		double p, force;
	} path[] = {
	    {0.5, 5},    {1, 10},     {2, 14},   {1.5, 9}, {1, 4},    {0.5, 2},
	    {0.75, 4.5}, {1.25, 9.5}, {1.5, 12}, {3, 18},  {2.5, 13}, {2.75, 15.5},
	};
	struct pound_touch touch;
	pound_contact_begin(&law, &touch, 1);
	double from = 0;
	for (int i = 0; i < COUNT(path); from = path[i++].p) {
		pound_contact_follow(&law, &touch, from, path[i].p);
		check_near(pound_contact_force_on(&touch.on, path[i].p, 0), path[i].force,
		           32 * DBL_EPSILON * path[i].force);
	}
}

CHECK_MAIN(cmocka_unit_test(the_damping_ratio_is_the_one_of_the_known_answers),
           cmocka_unit_test(the_damping_ratio_is_the_equation_to_rounding),
           cmocka_unit_test(the_damping_ratio_falls_from_one_to_zero_without_a_step),
           cmocka_unit_test(calibrations_are_those_of_the_table_of_known_answers),
           cmocka_unit_test(exact_dashpots_give_the_restitution_that_was_asked_for),
           cmocka_unit_test(restitution_0_has_a_dashpot_where_the_table_says_so),
           cmocka_unit_test(the_largest_overlap_of_both_springs_is_one_at_the_reference_speed),
           cmocka_unit_test(isolated_impacts_are_those_of_the_known_answers),
           cmocka_unit_test(the_bilinear_branches_follow_its_two_lines))
