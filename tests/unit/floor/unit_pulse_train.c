/* unit_pulse_train.c - idealized impacts against exact values and limits. */
#include <math.h>

#include "engine/floor/pulse_train.h"
#include "tests/support/check.h"

static const double pi = 3.14159265358979323846;

// 15 pulses every half period of w0, oscillators of 2 n w0: PSA/(v1 2 w0), computed by another program to all printed digits
static const struct {
	double xi, n, exact;
} trains[] = {
    {0.02, 1, 6.962120396}, {0.02, 2, 8.521925099}, {0.02, 4, 9.808148215}, {0.02, 8, 12.229549038},
    {0.05, 1, 3.402154673}, {0.05, 2, 3.967773484}, {0.05, 4, 5.176797556}, {0.05, 8, 8.063219064},
};

enum { TRAINS = sizeof trains / sizeof trains[0] };

static void a_train_of_pulses_gives_the_exact_values(void **state)
{
	(void)state;
	for (int i = 0; i < TRAINS; i++) {
		double w0 = 2 * pi * 1.3, v1 = 0.7;
		struct pound_pulse_train dirac = {.speed = v1, .spacing = pi / w0, .pulses = 15};
		double psa = pound_pulse_train_train(&dirac, 2 * trains[i].n * w0, trains[i].xi);
		// half a unit of the ninth decimal, and rounding
		check_near(psa / (v1 * 2 * w0), trains[i].exact, 5.1e-10);
	}
}

static void the_peaks_of_the_paper_are_low_by_what_they_leave_out(void **state)
{
	(void)state;
	for (int i = 0; i < TRAINS; i++) {
		struct pound_pulse_train dirac = {.speed = 1, .spacing = 0.5, .pulses = 15};
		double ratio =
		    pound_pulse_train_peaks(&dirac, 4 * pi * trains[i].n, trains[i].xi) / (4 * pi * trains[i].exact);
		bool light = trains[i].xi == 0.02;
		check_near(1 - ratio, light ? 2.5e-4 : 1.5e-3, light ? 0.7e-4 : 0.45e-3);
	}
}

static void one_pulse_is_the_line_but_for_a_light_damping(void **state)
{
	(void)state;
	struct pound_pulse_train dirac = {.speed = 2, .spacing = 0.5, .pulses = 1};
	for (double w = 0.1; w < 1e4; w *= 3) {
		check_near(pound_pulse_train_train(&dirac, w, 0), 2 * w, 1e-14 * w);
		check_near(pound_pulse_train_line(&dirac, w, 0), 2 * w, 1e-14 * w);
		check_near(pound_pulse_train_peaks(&dirac, w, 0), 2 * w, 1e-14 * w);
		// exact: v1 w exp(-xi acos(xi)/s)
		double s = sqrt(1 - 0.3 * 0.3);
		check_near(pound_pulse_train_train(&dirac, w, 0.3), 2 * w * exp(-0.3 * acos(0.3) / s), 1e-14 * w);
		check_near(pound_pulse_train_line(&dirac, w, 0.3), 2 * w * exp(-0.15 * pi), 1e-14 * w);
	}
}

static void undamped_pulses_in_step_add_up(void **state)
{
	(void)state;
	struct pound_pulse_train dirac = {.speed = 1, .spacing = 0.5, .pulses = 40};
	check_near(pound_pulse_train_train(&dirac, 4 * pi, 0), 40 * 4 * pi, 1e-10);
	check_near(pound_pulse_train_peaks(&dirac, 4 * pi, 0), 40 * 4 * pi, 1e-10);
}

/* Far below the frequency of the pulses the floor's velocity is a step of N v1, as the oscillator hardly moves meanwhile. */
static void a_slow_oscillator_sees_all_pulses_as_one(void **state)
{
	(void)state;
	struct pound_pulse_train dirac = {.speed = 1, .spacing = 0.5, .pulses = 15};
	double w = 1e-5;
	// the pulses take w 7 s = 7e-5 rad of the oscillator
	check_near(pound_pulse_train_train(&dirac, w, 0), 15 * w, 15 * w * 7e-5 * 7e-5);
}

static void no_pulse_gives_nothing(void **state)
{
	(void)state;
	struct pound_pulse_train none = {.speed = 0, .spacing = 0.5, .pulses = 3},
	                         never = {.speed = 1, .spacing = 0.5};
	check_near(pound_pulse_train_train(&none, 5, 0.05), 0, 0);
	check_near(pound_pulse_train_train(&never, 5, 0.05), 0, 0);
	check_near(pound_pulse_train_peaks(&never, 5, 0), 0, 0);
}

/* Between and after pulses, against densely sampled motion: never below a sample, and little above the largest. */
static void no_sampled_displacement_is_larger(void **state)
{
	(void)state;
	for (double w = 0.7; w < 300; w *= 2.1)
		for (double xi = 0; xi < 0.9; xi += 0.3) {
			struct pound_pulse_train dirac = {.speed = 1, .spacing = 0.5, .pulses = 4};
			double top = 0, s = sqrt(1 - xi * xi), step = 2 * pi / w / 500;
			for (double t = 0; t < 1.5 + 4 * pi / w; t += step) {
				double z = 0;
				for (int k = 0; k < 4 && 0.5 * k <= t; k++)
					z += exp(-xi * w * (t - 0.5 * k)) * sin(w * s * (t - 0.5 * k)) / (w * s);
				top = fmax(top, w * w * fabs(z));
			}
			double psa = pound_pulse_train_train(&dirac, w, xi);
			assert_true(psa >= top * (1 - 1e-12));
			// a peak missed by half a sample step: (pi/500)^2/2 of each pulse's contribution
			check_near(psa, top, 4 * w * 2e-5 * 2);
		}
}

CHECK_MAIN(cmocka_unit_test(a_train_of_pulses_gives_the_exact_values),
           cmocka_unit_test(the_peaks_of_the_paper_are_low_by_what_they_leave_out),
           cmocka_unit_test(one_pulse_is_the_line_but_for_a_light_damping),
           cmocka_unit_test(undamped_pulses_in_step_add_up),
           cmocka_unit_test(a_slow_oscillator_sees_all_pulses_as_one),
           cmocka_unit_test(no_pulse_gives_nothing), cmocka_unit_test(no_sampled_displacement_is_larger))
