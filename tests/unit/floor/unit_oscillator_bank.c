/* unit_oscillator_bank.c - oscillators on given motions, against closed forms. */
#include <math.h>
#include <string.h>

#include "engine/floor/oscillator_bank.h"
#include "tests/support/check.h"

static const double pi = 3.14159265358979323846;

enum { OSCILLATORS = 16 };

static struct pound_floor_stretch stretch;
static _Alignas(64) double omega[OSCILLATORS], state_of[2][3][OSCILLATORS];
static _Alignas(64) char scratch[POUND_SPECTRUM_SCRATCH];
static struct pound_segment_powers powers;

/* A bank at rest; oscillators beyond n are copies of the last one. */
static struct pound_bank bank_of(const double *w, int n, double xi)
{
	pound_segment_powers_fill(&powers);
	struct pound_bank bank = {.n_groups = OSCILLATORS / POUND_SPECTRUM_GROUP,
	                          .powers = &powers,
	                          .n_drives = 1,
	                          .damping = xi,
	                          .radians = 1.5,
	                          .omega = omega};
	memset(state_of, 0, sizeof state_of);
	for (int k = 0; k < OSCILLATORS; k++)
		omega[k] = w[k < n ? k : n - 1];
	for (int d = 0; d < POUND_DRIVES; d++)
		bank.z[d] = state_of[d][0], bank.v[d] = state_of[d][1], bank.top[d] = state_of[d][2];
	return bank;
}

/* Moves the bank over the current stretch. */
static void move(const struct pound_bank *bank)
{
	const struct pound_bank_input move = {.stretch = &stretch, .time_step = 0.01};
	assert_true(pound_oscillator_bank_lanes(0, bank, &move, scratch));
}

/* Appends a piece to the stretch: a polynomial over the piece's own time. */
static struct pound_floor_piece *piece_next(double step, int order)
{
	struct pound_floor_piece *piece = &stretch.piece[stretch.n++];
	assert_true(stretch.n <= POUND_FLOOR_PIECES);
	*piece = (struct pound_floor_piece){.step = step, .map = -1, .order = order};
	return piece;
}

static void polynomial_bound(struct pound_polynomial *a, int order)
{
	for (int n = 0; n <= order; n++) {
		a->bound[0] += fabs(a->c[n]);
		a->bound[1] += n * fabs(a->c[n]);
		a->bound[2] += n * (n - 1) * fabs(a->c[n]);
	}
}

/* A pulse sin(pi t/td) in equal pieces of its Taylor series, then rest for the time `quiet`. */
static void half_sine(double td, int pieces, double quiet)
{
	stretch.n = 0;
	for (int i = 0; i < pieces; i++) {
		struct pound_floor_piece *piece = piece_next(td / pieces, POUND_FLOOR_ORDER);
		double turn = pi / pieces, term = 1;
		for (int n = 0; n <= POUND_FLOOR_ORDER; term *= turn / ++n)
			piece->floor.c[n] = term * sin(turn * i + 0.5 * pi * n);
		polynomial_bound(&piece->floor, POUND_FLOOR_ORDER);
	}
	piece_next(quiet, 0);
}

/* Shock spectrum of a half sine A sin(pi t/td), undamped: td/T and max |w^2 u|/A, computed by another program. */
static const double shocks[][2] = {
    {.1, .396273548}, {.25, .942809042}, {.5, 1.570796327}, {.75, 1.763355757}, {.80994, 1.768457654},
    {1, 1.732050808}, {1.5, 1.5},        {2, 1.268075355},  {3, 1.169913495},   {5, 1.099801602},
};

enum { SHOCKS = sizeof shocks / sizeof shocks[0] };

static void a_half_sine_gives_the_known_shock_spectrum(void **state)
{
	(void)state;
	static const int pieces[] = {4, 7, 100};
	for (size_t p = 0; p < sizeof pieces / sizeof pieces[0]; p++) {
		double w[SHOCKS], td = 0.7;
		for (int k = 0; k < SHOCKS; k++)
			w[k] = 2 * pi * shocks[k][0] / td;
		struct pound_bank bank = bank_of(w, SHOCKS, 0);
		half_sine(td, pieces[p], td / shocks[0][0]);
		move(&bank);
		for (int k = 0; k < SHOCKS; k++) // half a unit of the ninth decimal
			check_near(w[k] * w[k] * bank.top[0][k], shocks[k][1], 5.1e-10);
	}
}

// 15 pulses every half period of w0, oscillators of 2 n w0: PSA/(v1 2 w0), computed by another program to all printed digits
static const double trains[][3] = {
    {0.02, 1, 6.962120396}, {0.02, 2, 8.521925099}, {0.02, 4, 9.808148215}, {0.02, 8, 12.229549038},
    {0.05, 1, 3.402154673}, {0.05, 2, 3.967773484}, {0.05, 4, 5.176797556}, {0.05, 8, 8.063219064},
};

static void a_train_of_velocity_steps_gives_the_exact_values(void **state)
{
	(void)state;
	for (size_t i = 0; i < sizeof trains / sizeof trains[0]; i++) {
		double w0 = 2 * pi, w = 2 * trains[i][1] * w0;
		struct pound_bank bank = bank_of(&w, 1, trains[i][0]);
		for (int pulse = 0; pulse < 15; pulse++) {
			bank.v[0][0] += 1;
			stretch.n = 0;
			for (int part = 0; part < 5; part++)
				piece_next(0.1, 0);
			move(&bank);
		}
		check_near(w * w * bank.top[0][0] / (2 * w0), trains[i][2], 5.1e-10);
	}
}

/* A constant acceleration from rest: peak of twice the static displacement undamped, 1 + exp(-xi pi/s) times it damped. */
// the fastest takes 5e5 steps, each with a rounding error of 2e-16
static void a_step_of_acceleration_overshoots_as_it_must(void **state)
{
	(void)state;
	double w[OSCILLATORS];
	for (int k = 0; k < OSCILLATORS; k++)
		w[k] = exp(0.7 * k);
	for (double xi = 0; xi < 1; xi += 0.31) {
		struct pound_bank bank = bank_of(w, OSCILLATORS, xi);
		stretch.n = 0;
		for (int i = 0; i < 9; i++) { // the slowest takes pi/s to its peak
			struct pound_floor_piece *piece = piece_next(1, 0);
			piece->floor.c[0] = -3;
			piece->floor.bound[0] = 3;
		}
		move(&bank);
		for (int k = 0; k < OSCILLATORS; k++)
			check_near(w[k] * w[k] * bank.top[0][k], 3 * (1 + exp(-xi * pi / sqrt(1 - xi * xi))), 2e-10);
	}
}

/* The impulse of a short polynomial pulse, as from a contact, drives only the second set of oscillators. */
static void the_contact_s_part_drives_its_own_oscillators(void **state)
{
	(void)state;
	double w = 10, step = 1e-6;
	struct pound_bank bank = bank_of(&w, 1, 0);
	bank.n_drives = 2;
	stretch.n = 0;
	struct pound_floor_piece *piece = piece_next(step, 2); // 6 t (1 - t)/step: 1 m/s
	piece->push.c[1] = 6 / step;
	piece->push.c[2] = -6 / step;
	polynomial_bound(&piece->push, 2);
	piece_next(1, 0);
	move(&bank);
	check_near(w * w * bank.top[POUND_DRIVE_PUSH][0], w, 1e-9); // (w step)^2 w = 1e-9
	check_near(bank.top[POUND_DRIVE_FLOOR][0], 0, 0);
}

/* The motion does not depend on how it is divided into pieces and steps. */
static void shorter_steps_change_nothing(void **state)
{
	(void)state;
	double w[OSCILLATORS], once[OSCILLATORS];
	for (int k = 0; k < OSCILLATORS; k++)
		w[k] = exp(0.45 * k);
	for (int fine = 0; fine < 3; fine++) {
		struct pound_bank bank = bank_of(w, OSCILLATORS, 0.05);
		bank.radians = fine ? 0.51 / fine : 1.5;
		half_sine(0.3, fine == 2 ? 37 : 10, 1);
		move(&bank);
		for (int k = 0; k < OSCILLATORS; k++)
			if (fine)
				check_near(w[k] * w[k] * bank.top[0][k], once[k], 1e-12);
			else
				once[k] = w[k] * w[k] * bank.top[0][k];
	}
}

/* Motions whose squares underflow have the spectrum of larger ones: the proofs then do without squares. */
static void tiny_motions_have_the_spectrum_of_large_ones(void **state)
{
	(void)state;
	double w[OSCILLATORS], once[OSCILLATORS];
	for (int k = 0; k < OSCILLATORS; k++)
		w[k] = exp(0.45 * k);
	for (int power = 0; power >= -800; power -= 100) {
		struct pound_bank bank = bank_of(w, OSCILLATORS, 0.05);
		half_sine(0.3, 10, 1);
		for (int i = 0; i < stretch.n; i++) {
			struct pound_polynomial *a = &stretch.piece[i].floor;
			for (int n = 0; n <= POUND_FLOOR_ORDER; n++)
				a->c[n] = ldexp(a->c[n], power);
			for (int d = 0; d < 3; d++)
				a->bound[d] = ldexp(a->bound[d], power);
		}
		move(&bank);
		for (int k = 0; k < OSCILLATORS; k++) {
			const double top = ldexp(bank.top[0][k], -power);
			if (power)
				check_near(top / once[k], 1, 1e-13);
			else
				once[k] = top;
		}
	}
}

/* Nearly critical damping: a step of acceleration overshoots at pi/(w s), s = sqrt(1 - xi^2). */
static void strongly_damped_oscillators_are_exact(void **state)
{
	(void)state;
	for (double xi = 0.1; xi < 0.97; xi += 0.06) {
		double w[OSCILLATORS];
		for (int k = 0; k < OSCILLATORS; k++)
			w[k] = exp(0.4 * k);
		struct pound_bank bank = bank_of(w, OSCILLATORS, xi);
		stretch.n = 0;
		for (int i = 0; i < 60; i++) {
			struct pound_floor_piece *piece = piece_next(0.3, 0);
			piece->floor.c[0] = -1;
			piece->floor.bound[0] = 1;
		}
		move(&bank);
		for (int k = 0; k < OSCILLATORS; k++)
			check_near(w[k] * w[k] * bank.top[0][k], 1 + exp(-xi * pi / sqrt(1 - xi * xi)), 2e-13);
	}
}

/* A slow oscillator takes the steps of the fastest of its group, without larger rounding errors. */
static void a_slow_oscillator_does_not_depend_on_the_fast_ones_of_its_group(void **state)
{
	(void)state;
	double top[2];
	for (int fast = 0; fast < 2; fast++) {
		double w[OSCILLATORS];
		for (int k = 0; k < OSCILLATORS; k++)
			w[k] = k && fast ? 1200 : 3;
		struct pound_bank bank = bank_of(w, OSCILLATORS, 0.05);
		for (int beat = 0; beat < 10; beat++) {
			half_sine(0.6, 60, 0.4);
			move(&bank);
		}
		top[fast] = bank.top[0][0];
	}
	check_near(top[1] / top[0], 1, 2e-14);
}

/* A constant plus a power of time with a coefficient that is not negligible: the oscillator's series continues beyond it. */
static void a_piece_whose_last_coefficient_is_no_rounding_is_followed_to_rounding(void **state)
{
	(void)state;
	const double w = 1.4, last = 1e-6;
	struct pound_bank bank = bank_of(&w, 1, 0);
	stretch.n = 0;
	struct pound_floor_piece *piece = piece_next(1, 15);
	piece->floor.c[0] = 1;
	piece->floor.c[15] = last;
	polynomial_bound(&piece->floor, 15);
	move(&bank);
	double z = -(1 - cos(w)) / (w * w), term = -last; // - sum (-w^2)^k 15!/(17 + 2 k)!
	for (int n = 16; n < 60; n++) {
		term /= n;
		if (n % 2) {
			z += term;
			term *= -w * w;
		}
	}
	check_near(bank.z[0][0] / z, 1, 1e-15);
}

CHECK_MAIN(cmocka_unit_test(a_half_sine_gives_the_known_shock_spectrum),
           cmocka_unit_test(a_train_of_velocity_steps_gives_the_exact_values),
           cmocka_unit_test(a_step_of_acceleration_overshoots_as_it_must),
           cmocka_unit_test(the_contact_s_part_drives_its_own_oscillators),
           cmocka_unit_test(shorter_steps_change_nothing),
           cmocka_unit_test(tiny_motions_have_the_spectrum_of_large_ones),
           cmocka_unit_test(strongly_damped_oscillators_are_exact),
           cmocka_unit_test(a_slow_oscillator_does_not_depend_on_the_fast_ones_of_its_group),
           cmocka_unit_test(a_piece_whose_last_coefficient_is_no_rounding_is_followed_to_rounding))
