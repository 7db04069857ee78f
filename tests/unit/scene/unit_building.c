/* unit_building.c - shear buildings as masses, springs and dashpots, against closed forms. */
#include <math.h>
#include <string.h>

#include "engine/scene/building.h"
#include "engine/scene/modes.h"
#include "tests/support/check.h"

static const double PI = 3.14159265358979323846;

static struct pound_building equal_storeys(int n, int damping)
{
	return (struct pound_building){.storeys = n,
	                               .mass = {1, {2e5}},
	                               .stiffness = {1, {3e8}},
	                               .damping = damping,
	                               .damping_ratio = {1, {0.05}},
	                               .damping_modes = {1, 3}};
}

static int damping_named(const char *name)
{
	int row = 0;
	while (strcmp(pound_damping_name(row), name) != 0)
		row++;
	return row;
}

/* w_j = 2 sqrt(k/m) sin((2 j - 1) pi/(4 N + 2)) */
static double closed(int n, int j)
{
	return 2 * sqrt(3e8 / 2e5) * sin((2 * j - 1) * PI / (4 * n + 2));
}

static void equal_storeys_have_the_frequencies_of_the_closed_form(void **state)
{
	(void)state;
	for (int n = 1; n <= POUND_STOREYS_MAX; n++) {
		struct pound_building building = equal_storeys(n, 0);
		struct pound_storeys storeys;
		pound_building_storeys(&building, &storeys);
		check_near(storeys.frequency, closed(n, 1), 1e-13 * closed(n, n));
	}
}

static void a_profile_is_scaled_to_the_first_frequency(void **state)
{
	(void)state;
	struct pound_building building = equal_storeys(3, 0);
	struct pound_storeys storeys;
	double w[3];
	building.stiffness = (struct pound_each){0};
	building.profile = (struct pound_each){3, {1.5, 1.2, 1}};
	building.frequency_hz = 2.5;
	pound_building_storeys(&building, &storeys);
	pound_modes_frequencies(3, storeys.mass, storeys.stiffness, w);
	check_near(w[0], 2 * PI * 2.5, 1e-13 * w[2]);
	check_near(storeys.stiffness[0] / storeys.stiffness[2], 1.5, 1e-14);
	check_near(storeys.stiffness[1] / storeys.stiffness[2], 1.2, 1e-14);
}

/* With one story every form is 2 xi m w; with many, forms define the damping of modes 1 and 3: a0/(2 w) + a1 w/2 = xi. */
static void damping_is_that_of_its_form(void **state)
{
	(void)state;
	struct pound_storeys s;
	for (int row = 0; pound_damping_name(row); row++) {
		struct pound_building one = equal_storeys(1, row);
		pound_building_storeys(&one, &s);
		check_near(s.dashpot[0], 2 * 0.05 * 2e5 * sqrt(3e8 / 2e5), 1e-14 * s.dashpot[0]);
		check_near(s.mass_damping, 0, 0);
		assert_false(s.modal);
	}
	struct pound_building many = equal_storeys(8, damping_named("rayleigh"));
	pound_building_storeys(&many, &s);
	for (int mode = 1; mode <= 3; mode += 2) {
		const double w = closed(8, mode), a1 = s.dashpot[0] / s.stiffness[0];
		check_near(s.mass_damping / (2 * w) + a1 * w / 2, 0.05, 1e-13);
	}
	many = equal_storeys(8, damping_named("stiffness"));
	pound_building_storeys(&many, &s);
	check_near(s.dashpot[7] / s.stiffness[7] * closed(8, 1) / 2, 0.05, 1e-13);
	many = equal_storeys(2, damping_named("storey"));
	many.damping_ratio = (struct pound_each){2, {0.02, 0.1}};
	pound_building_storeys(&many, &s);
	check_near(s.dashpot[1], 2 * 0.1 * sqrt(2e5 * 3e8), 1e-14 * s.dashpot[1]);
	many = equal_storeys(3, damping_named("modal"));
	pound_building_storeys(&many, &s);
	assert_true(s.modal && s.dashpot[0] == 0);
	// the two modes of a building of two stories are its first and its last
	many = equal_storeys(2, damping_named("rayleigh"));
	pound_building_storeys(&many, &s);
	check_near(s.mass_damping / (2 * closed(2, 2)) + s.dashpot[0] / s.stiffness[0] * closed(2, 2) / 2, 0.05,
	           1e-13);
}

/* Every form except that of the stories has the document's ratio in the first mode. */
static void the_first_mode_has_the_damping_of_its_form(void **state)
{
	(void)state;
	for (int row = 0; pound_damping_name(row); row++)
		for (int n = 1; n <= 8; n += 7) {
			struct pound_building building = equal_storeys(n, row);
			double w, xi;
			pound_building_first_mode(&building, &w, &xi);
			check_near(w, closed(n, 1), 1e-13 * closed(n, n));
			if (strcmp(pound_damping_name(row), "storey") == 0) {
				// equal stories: C = c/k K, so that xi = w c/(2 k), c = 2 xi sqrt(k m)
				check_near(xi, w * 0.05 / sqrt(3e8 / 2e5), 1e-12);
				continue;
			}
			check_near(xi, 0.05, 1e-13);
		}
}

CHECK_MAIN(cmocka_unit_test(equal_storeys_have_the_frequencies_of_the_closed_form),
           cmocka_unit_test(a_profile_is_scaled_to_the_first_frequency),
           cmocka_unit_test(damping_is_that_of_its_form),
           cmocka_unit_test(the_first_mode_has_the_damping_of_its_form))
