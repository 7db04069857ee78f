/* unit_extremes.c - the engine on stiff and extreme scenes: checks that hold for all scenes, and a table of the
 * results.
 *
 *   1. Every value is finite, or NAN if it is undefined in the scene.
 *   2. The energy balance closes to 1e-10 of the energy put in.
 *   3. The number of contacts is bounded; if an interval has more contacts than allowed, the run ends with a status.
 *   4. Over the first samples, before rounding errors are amplified, the difference from the adaptive solver is no larger
 *      than that solver's own error. */
#include "tests/support/check.h"
#include "tests/support/scenes.h"

#include <float.h>
#include <math.h>
#include <string.h>

enum { CHANGES = 7, SAMPLES = 301 };

static const double balanced = 1e-10;
static const double pi = 3.14159265358979323846;

enum law { LINEAR, ELASTOPLASTIC, NONLINEAR_ELASTIC, ORIGIN_ORIENTED };
enum ground { NOISE, ZEROS, SPIKE, STEP, RAMP, TO_AND_FRO };

// clang-format off
#define FIELD(kind, member) {.type = POUND_FIELD_##kind, .offset = offsetof(struct pound_scene, member)}
#define K_RATIO    FIELD(REAL, contact.stiffness_ratio)
#define EPS        FIELD(REAL, contact.restitution)
#define GAP        FIELD(REAL, contact.gap)
#define TENSION    FIELD(BOOL, contact.tension)
#define MASS       FIELD(REAL, oscillators[1].mass)
#define FREQUENCY  FIELD(REAL, oscillators[1].frequency_hz)
#define WALL       FIELD(BOOL, oscillators[1].rigid_wall)
#define DAMPING    FIELD(REAL, oscillators[0].damping_ratio)
#define DAMPING_2  FIELD(REAL, oscillators[1].damping_ratio)
#define LAW        FIELD(CHOICE, law.type)
#define HARDENING  FIELD(REAL, law.hardening_ratio)
#define YIELD      FIELD(REAL, law.yield_displacement)
#define ELASTIC_ON_HEAVY(gap) \
	{{MASS, 1e6}, {K_RATIO, 1e8}, {EPS, 1}, {DAMPING, 0}, {DAMPING_2, 0}, {FREQUENCY, 20}, {GAP, gap}}
#define LINEAR_2   FIELD(BOOL, oscillators[1].has_law) /* the body's own law is all zeros: linear */
// clang-format on

struct change {
	struct pound_field field;
	double value;
};

/* How a scene differs from the reference scene: 2 and 3.1 Hz, masses 1 and 1.7 kg, eps 0.6, K/k 100, no gap. */
struct extreme {
	const char *name;
	struct change changes[CHANGES]; /* the first empty element ends the list */
	enum ground ground;
	double amplitude; /* [m/s2]  0: 1 */
	int samples;      /* 0: SAMPLES */
	double step;      /* [s]  0: 0.01 */
	int compared;    /* samples over which the adaptive solver must agree; 0: it cannot integrate the scene */
	double contacts; /* upper bound */
	enum pound_status status; /* expected status of the run */
};

// clang-format off
static const struct extreme extremes[] = {
	{"K/k 1e-18, eps 0.05, pressed", {{WALL, 1}, {K_RATIO, 1e-18}, {EPS, 0.05}}, RAMP, .compared = 61, .contacts = 60},
	{"K/k 1e2", {{K_RATIO, 1e2}}, .compared = 101, .contacts = 60},
	{"K/k 1e4", {{K_RATIO, 1e4}}, .compared = 101, .contacts = 60},
	{"K/k 1e6", {{K_RATIO, 1e6}}, .compared = 61, .contacts = 100},
	{"K/k 1e8", {{K_RATIO, 1e8}}, .compared = 31, .contacts = 200},
	{"K/k 1e8, eps 0", {{K_RATIO, 1e8}, {EPS, 0}}, .compared = 31, .contacts = 60},
	{"K/k 1e8, eps 0, no tension", {{K_RATIO, 1e8}, {EPS, 0}, {TENSION, 0}}, .compared = 31, .contacts = 200},
	{"K/k 1e8, eps 1", {{K_RATIO, 1e8}, {EPS, 1}}, .compared = 11, .contacts = 2000},
	{"eps 0", {{EPS, 0}}, .compared = 101, .contacts = 40},
	{"eps 0, no tension", {{EPS, 0}, {TENSION, 0}}, .compared = 101, .contacts = 60},
	{"eps 1e-6", {{EPS, 1e-6}}, .compared = 101, .contacts = 40},
	{"eps 1e-6, no tension", {{EPS, 1e-6}, {TENSION, 0}}, .compared = 101, .contacts = 60},
	{"eps 0.05", {{EPS, 0.05}}, .compared = 101, .contacts = 40},
	{"eps 1", {{EPS, 1}}, .compared = 61, .contacts = 80},
	{"mass ratio 1e-6", {{MASS, 1e-6}}, .compared = 61, .contacts = 200},
	{"mass ratio 1e-3", {{MASS, 1e-3}}, .compared = 61, .contacts = 100},
	{"mass ratio 1e3", {{MASS, 1e3}}, .compared = 61, .contacts = 60},
	{"mass ratio 1e6", {{MASS, 1e6}}, .compared = 61, .contacts = 60},
	// in contact at 2e7 Hz: short, as the adaptive solver needs a step for every radian
	{"mass ratio 1e-6, K/k 1e8, pressed", {{MASS, 1e-6}, {K_RATIO, 1e8}}, STEP, .samples = 6, .step = 1e-4,
	 .compared = 2, .contacts = 1},
	{"mass ratio 1e6, K/k 1e8", {{MASS, 1e6}, {K_RATIO, 1e8}}, .compared = 11, .contacts = 2000},
	{"frequency ratio 1e-3", {{FREQUENCY, 2e-3}}, .compared = 61, .contacts = 60},
	{"frequency ratio 1e3", {{FREQUENCY, 2e3}}, .compared = 11, .contacts = 300},
	{"gap 1e-300 m", {{GAP, 1e-300}}, .compared = 61, .contacts = 60},
	{"gap 1e-12 m", {{GAP, 1e-12}}, .compared = 61, .contacts = 60},
	{"gap never reached", {{GAP, 1e3}}, .compared = 61, .contacts = 0},
	{"one sample interval", {{EPS, 0.6}}, .samples = 2, .compared = 2, .contacts = 1},
	{"600 s", {{EPS, 0.6}}, .samples = 60001, .compared = 101, .contacts = 6000},
	{"zeros", {{EPS, 0.6}}, ZEROS, .compared = 61, .contacts = 0},
	{"one spike", {{EPS, 0.6}}, SPIKE, .compared = 61, .contacts = 60},
	{"one spike and minutes of silence, K/k 1e8, eps 0", {{K_RATIO, 1e8}, {EPS, 0}}, SPIKE, .samples = 33001, .compared = 31, .contacts = 1000},
	// in every sample the ground reverses the velocity that it gave the soft body in the sample before
	{"to and fro, frequency ratio 1e-3", {{FREQUENCY, 2e-3}, {GAP, 1e3}}, TO_AND_FRO, .samples = 21, .step = 1e-3,
	 .compared = 21, .contacts = 0},
	{"1e-300 m/s2", {{EPS, 0.6}}, .amplitude = 1e-300, .compared = 61, .contacts = 60},
	{"1e300 m/s2", {{EPS, 0.6}}, .amplitude = 1e300, .compared = 61, .contacts = 60},
	{"1e300 m/s2, gap 1 m", {{GAP, 1}, {TENSION, 0}, {EPS, 0}}, .amplitude = 1e300, .compared = 61, .contacts = 60},
	{"1e300 m/s2, yields at 1 mm", {{LAW, ORIGIN_ORIENTED}, {YIELD, 1e-3}}, .amplitude = 1e300, .compared = 31, .contacts = 100},
	{"1e300 m/s2, yields at 1e-12 m", {{LAW, ELASTOPLASTIC}, {YIELD, 1e-12}}, .amplitude = 1e300, .status = POUND_OVERFLOW},
	{"1e-300 m/s2, yields at 1 mm", {{LAW, ELASTOPLASTIC}, {YIELD, 1e-3}}, .amplitude = 1e-300, .compared = 61, .contacts = 60},
	{"elastoplastic, hardening 0", {{LAW, ELASTOPLASTIC}, {HARDENING, 0}}, .compared = 61, .contacts = 60},
	{"elastoplastic, hardening 1", {{LAW, ELASTOPLASTIC}, {HARDENING, 1}}, .compared = 61, .contacts = 60},
	{"nonlinear elastic, hardening 0", {{LAW, NONLINEAR_ELASTIC}, {HARDENING, 0}}, .compared = 61, .contacts = 60},
	{"nonlinear elastic, hardening 1", {{LAW, NONLINEAR_ELASTIC}, {HARDENING, 1}}, .compared = 61, .contacts = 60},
	{"origin oriented, hardening 0", {{LAW, ORIGIN_ORIENTED}, {HARDENING, 0}}, .compared = 61, .contacts = 60},
	{"origin oriented, hardening 1", {{LAW, ORIGIN_ORIENTED}, {HARDENING, 1}}, .compared = 61, .contacts = 60},
	{"elastoplastic, yields at 1e-12 m", {{LAW, ELASTOPLASTIC}, {YIELD, 1e-12}}, .compared = 31, .contacts = 60},
	{"nonlinear elastic, yields at 1e-12 m", {{LAW, NONLINEAR_ELASTIC}, {YIELD, 1e-12}}, .compared = 31, .contacts = 60},
	{"origin oriented, yields at 1e-12 m", {{LAW, ORIGIN_ORIENTED}, {YIELD, 1e-12}}, .compared = 31, .contacts = 60},
	{"damping 0", {{DAMPING, 0}, {DAMPING_2, 0}}, .compared = 61, .contacts = 60},
	{"damping 0, eps 1", {{DAMPING, 0}, {DAMPING_2, 0}, {EPS, 1}}, .compared = 61, .contacts = 80},
	// under a constant ground acceleration a body bounces on the wall, lower each time, within an interval of 1 s
	{"many contacts in one interval", {{WALL, 1}, {K_RATIO, 1e6}, {EPS, 0.9}, {GAP, 1e-3}}, STEP,
	 .samples = 4, .step = 1, .compared = 4, .contacts = 200},
	// the same without energy loss: 20 contacts per second for 1e5 s
	{"contacts without end in one interval", {{WALL, 1}, {EPS, 1}, {DAMPING, 0}, {GAP, 1e-4}}, STEP,
	 .samples = 2, .step = 1e5, .status = POUND_CHATTER},
	// a light body bounces without energy loss on a heavy one that approaches it with growing speed: in closed form
	// 23340 bounces in 0.2 ms until sustained contact; from a wider gap 307900 bounces in the interval, more than
	// allowed
	{"elastic, mass ratio 1e6, K/k 1e8, gap 1e-20 m", ELASTIC_ON_HEAVY(1e-20), STEP, .samples = 2, .contacts = 23400},
	{"elastic, mass ratio 1e6, K/k 1e8, gap 1e-15 m", ELASTIC_ON_HEAVY(1e-15), STEP, .samples = 2, .status = POUND_CHATTER},
	{"pressed, K/k 1e8", {{WALL, 1}, {K_RATIO, 1e8}}, STEP, .samples = 31, .compared = 11, .contacts = 200},
	{"pressed, K/k 1e8, eps 0", {{WALL, 1}, {K_RATIO, 1e8}, {EPS, 0}}, STEP, .samples = 31, .compared = 11, .contacts = 1},
	{"pressed, K/k 1e8, eps 1", {{WALL, 1}, {K_RATIO, 1e8}, {EPS, 1}}, STEP, .samples = 31, .compared = 3, .contacts = 1},
	// its velocity decays to zero, and no bound can prove that the velocity keeps its sign
	{"creeping where it yielded, K/k 1e12, eps 0",
	 {{WALL, 1}, {LAW, ELASTOPLASTIC}, {YIELD, 1e-15}, {K_RATIO, 1e12}, {EPS, 0}}, STEP, .samples = 20, .step = 0.05, .contacts = 1},
	// 9e15 contact substeps in a sample
	{"pressed ever more, K/k 2e33", {{WALL, 1}, {K_RATIO, 2e33}}, RAMP, .samples = 20, .contacts = 1},
	// the contact oscillates without end; no peak exceeds the first one
	{"pressed ever more, then swinging, K/k 1e10, damping 0, eps 1",
	 {{WALL, 1}, {DAMPING, 0}, {K_RATIO, 1e10}, {EPS, 1}}, RAMP, .samples = 60, .step = 0.1, .contacts = 1},
	// the velocity is zero once in every cycle, 2e6 times in a sample
	{"pressed ever more, swinging, K/k 1e14, damping 0, eps 1",
	 {{WALL, 1}, {DAMPING, 0}, {K_RATIO, 1e14}, {EPS, 1}}, RAMP, .samples = 20, .step = 0.1, .contacts = 1},
	{"pressed at rest, mass ratio 1e3, frequency ratio 1e3, K/k 1e4", {{K_RATIO, 1e4}, {MASS, 1e3}, {FREQUENCY, 2e3}, {DAMPING_2, 0.999}},
	 STEP, .samples = 5, .contacts = 1},
	{"contact at the yield point", {{WALL, 1}, {LAW, ELASTOPLASTIC}, {YIELD, 1e-3}, {GAP, 1e-3}},
	 .compared = 61, .contacts = 60},
	{"like bodies, hysteretic", {{FREQUENCY, 2}, {LAW, ELASTOPLASTIC}}, .compared = 61, .contacts = 0},
	{"bodies alike but for a rounding", {{FREQUENCY, 2 + 4 * DBL_EPSILON}, {LAW, ELASTOPLASTIC}}, .contacts = 2000},
	{"the same, no tension, eps 0",
	 {{FREQUENCY, 2 + 4 * DBL_EPSILON}, {LAW, ORIGIN_ORIENTED}, {TENSION, 0}, {EPS, 0}}, .contacts = 4000},
	{"alike until one yields", {{FREQUENCY, 2}, {LAW, NONLINEAR_ELASTIC}, {LINEAR_2, 1}}, .compared = 61, .contacts = 60},
	{"alike until one yields, K/k 1e8, eps 0",
	 {{FREQUENCY, 2}, {LAW, NONLINEAR_ELASTIC}, {LINEAR_2, 1}, {K_RATIO, 1e8}, {EPS, 0}}, .compared = 61, .contacts = 60},
};
// clang-format on

enum { EXTREMES = sizeof extremes / sizeof extremes[0] };

static void ground_fill(struct specimen *specimen, const struct extreme *row)
{
	int samples = row->samples > 0 ? row->samples : SAMPLES;
	double step = row->step > 0 ? row->step : 0.01, amplitude = row->amplitude != 0 ? row->amplitude : 1;
	if (row->ground == NOISE)
		specimen_noise(specimen, 11, 1, step, samples);
	else
		specimen_record(specimen, step, samples);
	if (row->ground == SPIKE)
		specimen->record[10] = -1;
	for (int t = 0; t < samples; t++)
		specimen->record[t] = amplitude * (row->ground == STEP         ? -1
		                                   : row->ground == RAMP       ? -fmin(0.1 * t, 1)
		                                   : row->ground == TO_AND_FRO ? (t % 2 ? 1 : -1)
		                                                               : specimen->record[t]);
}

static bool nothing(struct pound_field field)
{
	return field.type == POUND_FIELD_REAL && field.offset == 0;
}

static void extreme_make(struct specimen *specimen, const struct extreme *row)
{
	specimen_init(specimen);
	struct pound_scene *scene = &specimen->study.scene;
	scene->oscillators[0].frequency_hz = 2;
	scene->oscillators[1].frequency_hz = 3.1;
	scene->oscillators[1].mass = 1.7;
	for (int c = 0; c < CHANGES && !nothing(row->changes[c].field); c++)
		pound_scene_assign(scene, row->changes[c].field, row->changes[c].value);
	ground_fill(specimen, row);
}

struct run {
	enum pound_status status;
	struct pound_response response;
	double seconds;
};

static struct run run(const struct specimen *specimen)
{
	double from = specimen_seconds(CLOCK_THREAD_CPUTIME_ID);
	struct run r = {0};
	struct pound_run *run = pound_run_create(&specimen->study, 1);
	r.status = specimen_compute(run);
	r.response = pound_run_result(run)->cells[0].signals[0];
	pound_run_free(run);
	r.seconds = specimen_seconds(CLOCK_THREAD_CPUTIME_ID) - from;
	return r;
}

/* ---- finite values ---- */

static bool at_rest(const struct specimen *specimen)
{
	bool rest = true;
	for (int t = 0; t < specimen->study.scene.excitation.n_record; t++)
		rest &= specimen->record[t] == 0;
	return rest;
}

/* Whether a measure is defined in a scene: a linear law or a wall has no yield displacement, and a body that never
 * moves has no demand unless its yield displacement is given. */
static bool defined(int measure, const struct specimen *specimen)
{
	const struct pound_scene *scene = &specimen->study.scene;
	const char *name = oracle_measure_name(measure);
	bool demand = strstr(name, "demand") != NULL, yields = scene->law.type != LINEAR;
	if (strstr(name, "_2") && (scene->oscillators[1].rigid_wall || scene->oscillators[1].has_law))
		yields = false;
	if (demand && scene->law.yield_displacement == 0 && at_rest(specimen))
		return false;
	return yields || !(demand || strstr(name, "yield"));
}

static void check_defined(const struct pound_response *r, const struct specimen *specimen, const char *name)
{
	for (int m = 0; m < ORACLE_MEASURES; m++) {
		double value = oracle_measure(r, m);
		bool as_defined = defined(m, specimen) ? isfinite(value) : isnan(value);
		if (!as_defined)
			fail_msg("%s: %s is %g", name, oracle_measure_name(m), value);
	}
}

/* ---- agreement with the adaptive solver ---- */

// reference value for the relative error of a measure; the state at the end may be near 0
static double scale(const struct pound_response *r, const struct pound_scene *scene, int measure)
{
	const char *name = oracle_measure_name(measure);
	double w = 2 * pi * fmax(scene->oscillators[0].frequency_hz, scene->oscillators[1].frequency_hz);
	double most = fmax(r->displacement_max_1, r->displacement_max_2);
	if (!strncmp(name, "end_u", 5))
		return most;
	return !strncmp(name, "end_v", 5) ? w * most : fabs(oracle_measure(r, measure));
}

static double difference(const struct pound_response *a, const struct pound_response *b,
                         const struct pound_scene *scene)
{
	double largest = 0;
	for (int m = 0; m < ORACLE_MEASURES; m++) {
		double apart = fabs(oracle_measure(a, m) - oracle_measure(b, m));
		if (apart > 0)
			largest = fmax(largest, apart / scale(b, scene, m));
	}
	return largest;
}

static int solver_of(const char *name)
{
	int row = 0;
	while (strcmp(pound_solver_name(row), name) != 0)
		row++;
	return row;
}

/* Largest relative difference of any measure from the adaptive solver over the first samples.
 *
 * Returns  own   difference between two tolerances of the adaptive solver
 */
static double disagreement(const struct specimen *specimen, int samples, double *own)
{
	struct specimen first = *specimen;
	first.study.scene.excitation.n_record = samples;
	struct run event = run(&first);
	first.study.solver.method = solver_of("adaptive");
	first.study.solver.tolerance = 1e-12;
	struct run fine = run(&first);
	first.study.solver.tolerance = 1e-10;
	struct run coarse = run(&first);
	assert_true(event.status == POUND_OK && fine.status == POUND_OK && coarse.status == POUND_OK);
	*own = difference(&coarse.response, &fine.response, &first.study.scene);
	return difference(&event.response, &fine.response, &first.study.scene);
}

/* ---- the table ---- */

static void print_number(double value)
{
	if (isfinite(value))
		print_message(" %.1e |", value);
	else
		print_message("  |");
}

/* A row of the table in engine/exact/extremes.md. */
static void print_row(const char *name, const struct run *r, double apart, double own)
{
	print_message("| %s |", name);
	if (isfinite(r->response.contact_count))
		print_message(" %.0f |", r->response.contact_count);
	else
		print_message("  |");
	print_number(r->response.energy_residual);
	print_number(apart);
	print_number(own);
	print_message(" %.3g | %s |\n", 1e3 * r->seconds, pound_status_text(r->status));
}

/* Runs a specimen and checks the conditions that hold for all scenes. */
static struct run check_extreme(const struct extreme *row, const struct specimen *specimen)
{
	struct run r = run(specimen);
	double own = NAN, apart = row->compared > 0 ? disagreement(specimen, row->compared, &own) : NAN;
	print_row(row->name, &r, apart, own);
	if (row->compared > 0)
		check_near(apart, 0, 10 * own + 1e-9);
	assert_int_equal(r.status, row->status);
	if (r.status)
		return r;
	check_defined(&r.response, specimen, row->name);
	check_near(r.response.energy_residual, 0, balanced);
	assert_true(r.response.contact_count <= row->contacts);
	return r;
}

static void every_extreme_is_finite_balanced_bounded_and_agreed_on(void **state)
{
	(void)state;
	print_message(
	    "| scene | contacts | energy residual | from adaptive | adaptive from itself | CPU ms | status |\n"
	    "| --- | --- | --- | --- | --- | --- | --- |\n");
	for (int k = 0; k < EXTREMES; k++) {
		struct specimen specimen;
		extreme_make(&specimen, &extremes[k]);
		check_extreme(&extremes[k], &specimen);
		specimen_free(&specimen);
	}
}

/* ---- grazing, and simultaneous events ---- */

/* A body that moves towards a wall and touches it only if the gap is below its largest displacement, which is returned. */
static double wall_make(struct specimen *specimen, const struct extreme *row)
{
	extreme_make(specimen, row);
	struct pound_scene *scene = &specimen->study.scene;
	scene->oscillators[1].rigid_wall = true;
	scene->contact.gap = 1e3;
	double most = run(specimen).response.displacement_max_1;
	scene->contact.gap = 0.999 * most;
	if (run(specimen).response.contact_count == 0)
		for (int t = 0; t < scene->excitation.n_record; t++)
			specimen->record[t] *= -1;
	return most;
}

/* A body whose largest displacement u exceeds the gap by the fraction d stays in contact for 2 v/a, where v is its
 * speed at impact and a its deceleration, v^2 = 2 a d u.  The contact spring (there is no dashpot) changes the
 * velocity little by then:
 *
 *   impulse = K integral (v t - a t^2/2) = 2/3 K v^3/a^2, proportional to d^(3/2)
 */
static void grazing_contacts_fade_with_the_power_three_halves_of_their_depth(void **state)
{
	(void)state;
	static const double depths[] = {1e-7, 1e-9, 1e-11, 1e-15, 0, -1e-15};
	struct specimen specimen;
	struct extreme row = {"grazing", {{EPS, 1}}, .contacts = 1};
	double most = wall_make(&specimen, &row), before = NAN;
	for (int k = 0; k < 6; k++) {
		char name[64];
		snprintf(name, sizeof name, "grazing, deep by %g of the way", depths[k]);
		row.name = name;
		specimen.study.scene.contact.gap = most * (1 - depths[k]);
		const struct pound_response response = check_extreme(&row, &specimen).response;
		double impulse = response.impulse_max;
		if (k < 3)
			assert_true(response.contact_count == 1); // however weak the contact
		if (k == 1 || k == 2)
			// the spring changes the velocity by (K/m) (2 v/a)^2, 3e-4 at the deepest; d has an error of some
			// roundings over d
			check_near(before / impulse, 1000, 1.5);
		if (k > 2)
			assert_true(impulse < 1e-3 * before);
		before = k < 3 ? impulse : before;
	}
	specimen_free(&specimen);
}

/* The bodies move together, in contact without a force, until one yields; from there on their accelerations differ,
 * at first only by rounding errors. */
static void bodies_alike_until_one_yields_meet_a_bounded_number_of_times(void **state)
{
	(void)state;
	static const struct {
		double stiffness_ratio, restitution;
	} contacts[] = {{1e2, 0.6}, {1e2, 0}, {1e4, 0}, {1e8, 0}};
	for (int seed = 1; seed <= 40; seed++)
		for (int law = ELASTOPLASTIC; law <= ORIGIN_ORIENTED; law++)
			for (int k = 0; k < 8; k++) {
				const struct extreme row = {.changes = {{FREQUENCY, 2},
				                                        {LAW, law},
				                                        {LINEAR_2, 1},
				                                        {TENSION, k % 2},
				                                        {K_RATIO, contacts[k / 2].stiffness_ratio},
				                                        {EPS, contacts[k / 2].restitution}}};
				struct specimen specimen;
				extreme_make(&specimen, &row);
				specimen_noise(&specimen, (uint64_t)seed, 1, 0.01, 801);
				struct run r = run(&specimen);
				assert_int_equal(r.status, POUND_OK);
				check_near(r.response.energy_residual, 0, balanced);
				// each takes half a period of the contact, at most 40 ms; a few at branch boundaries are shorter
				const double faster = sqrt(contacts[k / 2].stiffness_ratio / 1e2);
				assert_true(r.response.contact_count <= faster * (8 / 0.02));
				specimen_free(&specimen);
			}
}

/* A creeping body moves less in a step than the rounding error of its displacement.  The result must not depend on
 * the number of samples: the same ground motion with half the sample interval uses other maps and other steps. */
static void bodies_that_creep_where_they_yielded_turn_there(void **state)
{
	(void)state;
	for (int number = 0; number < 600; number++) {
		struct pound_response response[2];
		for (int k = 0; k < 2; k++) {
			struct specimen specimen;
			specimen_creeping(&specimen, number, 1 + k);
			struct run r = run(&specimen);
			if (r.status != POUND_OK)
				fail_msg("creeping %d in %d parts ends with: %s", number, 1 + k, pound_status_text(r.status));
			check_near(r.response.energy_residual, 0, balanced);
			response[k] = r.response;
			specimen_free(&specimen);
		}
		// later impacts amplify a rounding error by orders of magnitude, but not these quantities
		const struct pound_response *r = response;
		check_near(r[1].impulse_max, r[0].impulse_max, 1e-10 * r[0].impulse_max);
		check_near(r[1].displacement_max_1, r[0].displacement_max_1, 1e-10 * r[0].displacement_max_1);
	}
}

/* The accelerations that separate such bodies are below the rounding error of their terms, in contact and separated. */
static void bodies_alike_but_for_roundings_part_or_press_and_do_not_chatter(void **state)
{
	(void)state;
	for (int number = 0; number < 400; number++) {
		struct specimen specimen;
		specimen_alike(&specimen, number, number % SPECIMEN_LAWS);
		struct run r = run(&specimen);
		if (r.status != POUND_OK)
			fail_msg("alike %d ends with: %s", number, pound_status_text(r.status));
		check_near(r.response.energy_residual, 0, balanced);
		specimen_free(&specimen);
	}
}

static void events_at_one_instant_are_all_seen(void **state)
{
	(void)state;
	enum { AT = 40 };
	struct specimen specimen;
	const struct extreme row = {"contact at a sample", .compared = 61, .contacts = 60};
	const struct extreme yields = {"contact and yield at a sample", .compared = 61, .contacts = 60};
	extreme_make(&specimen, &row);
	struct pound_scene *scene = &specimen.study.scene;
	scene->oscillators[1].rigid_wall = true;
	scene->contact.gap = 1e3;
	scene->excitation.n_record = AT + 1;
	double there = run(&specimen).response.end_u1;
	for (int t = 0; t < SAMPLES && there < 0; t++)
		specimen.record[t] *= -1;
	scene->contact.gap = fabs(there);
	scene->excitation.n_record = SAMPLES;
	assert_true(check_extreme(&row, &specimen).response.contact_count > 0);
	specimen_law(&specimen, "elastoplastic", fabs(there));
	assert_true(check_extreme(&yields, &specimen).response.contact_count > 0);
	specimen_free(&specimen);
}

/* ---- ground at rest ---- */

/* Bodies in almost plastic contact lose half of their motion in a second: after minutes the motion is zero, and a
 * second spike gives the same response as the first. */
static void a_motion_that_dies_away_in_silence_is_over(void **state)
{
	(void)state;
	enum { SILENT = 33001, AFTER = 61 };
	for (int law = LINEAR; law <= NONLINEAR_ELASTIC; law += NONLINEAR_ELASTIC)
		for (int tension = 0; tension < 2; tension++) {
			struct extreme row = {
			    .changes = {{K_RATIO, 1e8}, {EPS, 0}, {LAW, law}, {YIELD, 1e-4}, {TENSION, tension}},
			    .ground = SPIKE,
			    .samples = SILENT};
			struct specimen once, twice;
			extreme_make(&once, &row);
			const struct pound_response over = run(&once).response;
			assert_true(over.end_u1 == 0 && over.end_v1 == 0 && over.end_u2 == 0 && over.end_v2 == 0);
			row.samples = SILENT + AFTER;
			extreme_make(&twice, &row);
			memcpy(&twice.record[SILENT], once.record, AFTER * sizeof(double));
			const struct pound_response again = run(&twice).response;
			once.study.scene.excitation.n_record = AFTER;
			const struct pound_response first = run(&once).response;
			assert_true(first.end_u1 != 0 && again.end_u1 == first.end_u1 && again.end_v1 == first.end_v1);
			assert_true(again.end_u2 == first.end_u2 && again.end_v2 == first.end_v2);
			assert_true(again.contact_count == over.contact_count + first.contact_count);
			specimen_free(&once);
			specimen_free(&twice);
		}
}

static void a_body_that_is_at_rest_in_silence_does_not_wait_for_the_other(void **state)
{
	(void)state;
	const struct extreme row = {
	    .changes = {{FREQUENCY, 20}, {DAMPING_2, 0.5}, {GAP, 1e-4}}, .ground = SPIKE, .samples = 33001};
	struct specimen specimen;
	extreme_make(&specimen, &row);
	const struct pound_response r = run(&specimen).response;
	assert_true(r.contact_count > 0 && r.end_u1 != 0 && r.end_u2 == 0 && r.end_v2 == 0);
	specimen_free(&specimen);
}

/* ---- corners ---- */

enum { CORNERS = 100, CORNER_VALUES = 5, CORNER_SAMPLES = 5 };

// all extremes at once: each field takes one of its values at random, over a few samples of noise
static const struct {
	struct pound_field field;
	int n;
	double values[CORNER_VALUES];
} sides[] = {
    {K_RATIO, 4, {1e2, 1e4, 1e6, 1e8}},
    {EPS, 5, {0, 1e-6, 0.05, 0.6, 1}},
    {GAP, 4, {0, 0, 1e-12, 1e-3}},
    {TENSION, 2, {0, 1}},
    {MASS, 5, {1e-6, 1e-3, 1, 1e3, 1e6}},
    {FREQUENCY, 5, {2e-3, 2e-1, 2, 2e2, 2e3}},
    {WALL, 5, {0, 0, 0, 0, 1}},
    {DAMPING, 2, {0, 0.05}},
    {DAMPING_2, 2, {0, 0.999}},
    {LAW, 4, {LINEAR, ELASTOPLASTIC, NONLINEAR_ELASTIC, ORIGIN_ORIENTED}},
    {HARDENING, 3, {0, 0.05, 1}},
    {YIELD, 3, {0, 1e-12, 1e-3}},
};

enum { SIDES = sizeof sides / sizeof sides[0] };

/* Angular frequency of the two bodies on the contact spring. */
static double contact_frequency(const struct pound_scene *scene)
{
	double k[2], yield = 0;
	for (int i = 0; i < 2; i++) {
		const struct pound_oscillator *o = &scene->oscillators[i];
		k[i] = o->rigid_wall ? 0 : o->mass * pow(2 * pi * o->frequency_hz, 2);
		yield += o->rigid_wall ? 0 : 1 / o->mass;
	}
	return sqrt(scene->contact.stiffness_ratio * fmax(k[0], k[1]) * yield);
}

static void corner_make(struct specimen *specimen, uint64_t *stream)
{
	// the sample interval is limited by the contact, which needs a step for each radian while it lasts
	const double radians = 2e4;
	struct extreme row = {.samples = CORNER_SAMPLES};
	struct pound_scene *scene = &specimen->study.scene;
	extreme_make(specimen, &row);
	for (int k = 0; k < SIDES; k++) {
		double value = sides[k].values[(int)specimen_uniform(stream, 0, sides[k].n)];
		pound_scene_assign(scene, sides[k].field, value);
	}
	row.step = fmin(0.01, radians / contact_frequency(scene));
	ground_fill(specimen, &row);
}

static void corners_of_all_extremes_are_finite_and_balanced(void **state)
{
	(void)state;
	uint64_t stream = 1;
	for (int k = 0; k < CORNERS; k++) {
		struct specimen specimen;
		char name[32];
		corner_make(&specimen, &stream);
		snprintf(name, sizeof name, "corner %d", k);
		struct run r = run(&specimen);
		assert_int_equal(r.status, POUND_OK);
		check_defined(&r.response, &specimen, name);
		check_near(r.response.energy_residual, 0, balanced);
		specimen_free(&specimen);
	}
}

CHECK_MAIN(cmocka_unit_test(every_extreme_is_finite_balanced_bounded_and_agreed_on),
           cmocka_unit_test(grazing_contacts_fade_with_the_power_three_halves_of_their_depth),
           cmocka_unit_test(bodies_that_creep_where_they_yielded_turn_there),
           cmocka_unit_test(bodies_alike_but_for_roundings_part_or_press_and_do_not_chatter),
           cmocka_unit_test(events_at_one_instant_are_all_seen),
           cmocka_unit_test(bodies_alike_until_one_yields_meet_a_bounded_number_of_times),
           cmocka_unit_test(a_motion_that_dies_away_in_silence_is_over),
           cmocka_unit_test(a_body_that_is_at_rest_in_silence_does_not_wait_for_the_other),
           cmocka_unit_test(corners_of_all_extremes_are_finite_and_balanced))
