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

/* Damping ratio of a mode of equal stories, from the definition of each form in their frequencies. */
static double closed_damping(const char *form, int n, int mode)
{
	const double w = closed(n, mode), p = closed(n, 1), q = closed(n, n < 3 ? n : 3), xi = 0.05;
	if (strcmp(form, "rayleigh") == 0 && n > 1) // a0/(2 w) + a1 w/2
		return xi * (p * q / w + w) / (p + q);
	if (strcmp(form, "stiffness") == 0)
		return xi * w / p;
	if (strcmp(form, "storey") == 0) // C = c/k K, c = 2 xi sqrt(k m)
		return xi * w / sqrt(3e8 / 2e5);
	return xi;
}

static void modes_have_their_closed_forms(void **state)
{
	(void)state;
	for (int row = 0; pound_damping_name(row); row++)
		for (int n = 1; n <= POUND_STOREYS_MAX; n++) {
			struct pound_building building = equal_storeys(n, row);
			struct pound_building_mode modes[POUND_STOREYS_MAX];
			double sum = 0;
			pound_building_modes(&building, modes);
			for (int r = 0; r < n; r++) {
				// equal stories: effective mass of phi_i = sin(i a), a = (2 j - 1) pi/(2 N + 1), by sums of sines
				const double a = (2 * r + 1) * PI / (2 * n + 1);
				const double lever = 1 / tan(a / 2);
				const double want = lever * lever / (n * (2.0 * n + 1)); // (sum phi)^2 / (N sum phi^2)
				const double xi = closed_damping(pound_damping_name(row), n, r + 1);
				check_near(modes[r].frequency, closed(n, r + 1), 2e-13 * closed(n, r + 1));
				check_near(modes[r].mass_ratio, want, 1e-12);
				check_near(modes[r].damping_ratio, xi, 1e-11 * xi);
				sum += modes[r].mass_ratio;
			}
			check_near(sum, 1, 1e-12);
		}
}

/* Two stories, phi = (1, g) and (1, -1/g) with the golden ratio g. */
static void two_stories_have_modes_of_the_golden_ratio(void **state)
{
	(void)state;
	const double g = (1 + sqrt(5)) / 2, xi[2] = {0.02, 0.1}, shape[2] = {g, -1 / g};
	struct pound_building building = equal_storeys(2, damping_named("storey"));
	struct pound_building_mode modes[POUND_STOREYS_MAX];
	building.damping_ratio = (struct pound_each){2, {xi[0], xi[1]}};
	pound_building_modes(&building, modes);
	for (int r = 0; r < 2; r++) {
		const double top = shape[r], norm = 1 + top * top, w0 = sqrt(3e8 / 2e5), w = closed(2, r + 1);
		const double c = xi[0] + xi[1] * (top - 1) * (top - 1); // over 2 sqrt(k m)
		check_near(modes[r].mass_ratio, (1 + top) * (1 + top) / (2 * norm), 1e-14);
		check_near(modes[r].damping_ratio, c * w0 / (w * norm), 1e-14);
	}
	check_near(modes[0].mass_ratio, 0.947213595499958, 1e-14); // (5 + 2 sqrt(5))/10
	check_near(modes[1].mass_ratio, 0.052786404500042, 1e-14);
}

/* Unequal floors and stories, one of them nearly rigid. */
static void effective_masses_add_up_to_the_mass_of_the_building(void **state)
{
	(void)state;
	for (int n = 1; n <= POUND_STOREYS_MAX; n += 7) {
		struct pound_building building = equal_storeys(n, 0);
		struct pound_building_mode modes[POUND_STOREYS_MAX];
		double sum = 0;
		building.mass.n = building.stiffness.n = n;
		for (int i = 0; i < n; i++) {
			building.mass.values[i] = 1e5 * (1 + 0.9 * sin(7.0 * i));
			building.stiffness.values[i] = 1e8 * (1.5 + cos(3.0 * i)) * (i == n / 2 ? 1e6 : 1);
		}
		pound_building_modes(&building, modes);
		for (int r = 0; r < n; r++)
			sum += modes[r].mass_ratio;
		check_near(sum, 1, 1e-12);
	}
}

/* The given first frequency itself, not that of the rounded stiffness. */
static void a_given_frequency_is_that_of_the_first_mode(void **state)
{
	(void)state;
	struct pound_building building = equal_storeys(7, 0);
	struct pound_building_mode modes[POUND_STOREYS_MAX];
	building.stiffness = (struct pound_each){0};
	building.profile = (struct pound_each){1, {1}};
	building.frequency_hz = 2.3;
	pound_building_modes(&building, modes);
	check_near(modes[0].frequency, 2 * PI * 2.3, 0);
	check_near(modes[6].frequency / modes[0].frequency, closed(7, 7) / closed(7, 1), 1e-12);
}

CHECK_MAIN(cmocka_unit_test(equal_storeys_have_the_frequencies_of_the_closed_form),
           cmocka_unit_test(a_profile_is_scaled_to_the_first_frequency),
           cmocka_unit_test(damping_is_that_of_its_form), cmocka_unit_test(modes_have_their_closed_forms),
           cmocka_unit_test(two_stories_have_modes_of_the_golden_ratio),
           cmocka_unit_test(effective_masses_add_up_to_the_mass_of_the_building),
           cmocka_unit_test(a_given_frequency_is_that_of_the_first_mode))
