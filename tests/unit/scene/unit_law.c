/* unit_law.c - the branches of the laws: continuous force, correct loops and periods, by driving the laws without an
 * integrator. */
#include "tests/support/check.h"

#include <math.h>
#include <string.h>

#include "engine/exact/task.h"
#include "engine/scene/law.h"
#include "tests/support/scenes.h"

static const double PI = 3.14159265358979323846;

/* A displacement-driven test: follows a list of reversals and returns the work done, exactly for each branch. */
struct push {
	struct pound_backbone backbone;
	struct pound_law_state at;
	double u, force, force_max, work;
	int pieces;
};

static double force_at(const struct push *push, double u)
{
	return push->at.branch.stiffness * u + push->at.branch.offset;
}

static void push_start(struct push *push, int law, double yield, double hardening)
{
	memset(push, 0, sizeof *push);
	push->backbone =
	    (struct pound_backbone){.law = law, .stiffness = 1, .hardening = hardening, .yield = yield};
	pound_law_start(&push->backbone, &push->at);
}

static void push_along(struct push *push, double to)
{
	double force = force_at(push, to);
	push->work += 0.5 * (push->force + force) * (to - push->u);
	push->u = to;
	push->force = force;
	push->force_max = fmax(push->force_max, fabs(force));
}

static void push_edge(struct push *push, enum pound_edge edge)
{
	double before = push->force;
	pound_law_leave(&push->backbone, &push->at, edge, push->u);
	push->pieces++;
	check_near(force_at(push, push->u), before, 4e-16 * (1 + fabs(before)));
}

static void push_to(struct push *push, double to)
{
	double way = to > push->u ? 1 : -1;
	if (push->at.branch.direction * way < 0)
		push_edge(push, POUND_EDGE_REVERSAL);
	for (int piece = 0; piece < 5; piece++) {
		double edge = way > 0 ? push->at.branch.high : push->at.branch.low;
		if ((to - edge) * way <= 0)
			break;
		push_along(push, edge);
		push_edge(push, way > 0 ? POUND_EDGE_HIGH : POUND_EDGE_LOW);
	}
	push_along(push, to);
}

static int law_row(const char *name)
{
	for (int row = 0;; row++)
		if (strcmp(pound_law_name(row), name) == 0)
			return row;
}

static void the_kinematic_loop_encloses_the_known_area(void **state)
{
	(void)state;
	// known_answers 5.8: 4 (1 - r)(mu - 1) k d_y^2
	for (double mu = 1.5; mu <= 6; mu += 0.5) {
		struct push push;
		push_start(&push, law_row("elastoplastic"), 1, 0.05);
		push_to(&push, mu);
		for (int cycle = 0; cycle < 3; cycle++) {
			double before = push.work;
			push_to(&push, -mu);
			push_to(&push, mu);
			check_near(push.work - before, 4 * 0.95 * (mu - 1), 1e-13 * mu);
		}
		check_near(push.force_max, pound_law_envelope(&push.backbone, mu), 1e-14);
	}
}

static void the_origin_oriented_law_loses_work_on_the_first_push_only(void **state)
{
	(void)state;
	// known_answers 5.8: 0.475 k d_y^2 for mu = 2, r = 0.05
	struct push push;
	push_start(&push, law_row("origin_oriented"), 1, 0.05);
	push_to(&push, 2);
	push_to(&push, 0);
	check_near(push.work, 0.475, 1e-15);
	double before = push.work;
	push_to(&push, 2);
	push_to(&push, 0);
	check_near(push.work, before, 1e-15);
	push_to(&push, -2);
	push_to(&push, 0);
	check_near(push.work, 2 * 0.475, 1e-15);
	before = push.work;
	push_to(&push, -2);
	push_to(&push, 2);
	push_to(&push, 0);
	check_near(push.work, before, 1e-15);
}

static void each_side_of_the_origin_oriented_law_remembers_its_own_farthest_point(void **state)
{
	(void)state;
	struct push push;
	push_start(&push, law_row("origin_oriented"), 1, 0.05);
	push_to(&push, 3);
	push_to(&push, -0.5);
	check_near(push.force, -0.5, 1e-16); // the other side has not yielded
	push_to(&push, 1.5);
	check_near(push.force, 1.5 * (0.05 * 3 + 0.95) / 3, 1e-15);
	push_to(&push, 4);
	check_near(push.force, 0.05 * 4 + 0.95, 1e-15);
}

static void the_nonlinear_elastic_law_encloses_nothing(void **state)
{
	(void)state;
	struct push push;
	push_start(&push, law_row("nonlinear_elastic"), 1, 0.05);
	const double turns[] = {3, -2, 5, 0.3, 1.7, -6, 0};
	for (size_t j = 0; j < sizeof turns / sizeof turns[0]; j++)
		push_to(&push, turns[j]);
	check_near(push.work, 0, 1e-14);
}

static void hardening_one_is_linear_whatever_the_law(void **state)
{
	(void)state;
	for (int law = 0; pound_law_name(law); law++) {
		struct push push;
		push_start(&push, law, 1, 1);
		const double turns[] = {3, -2, 5, 0.3, 1.7, -6, 2.5};
		for (size_t j = 0; j < sizeof turns / sizeof turns[0]; j++) {
			push_to(&push, turns[j]);
			check_near(push.force, turns[j], 1e-14);
		}
	}
}

/* Period of a free vibration of amplitude mu, in linear periods; `about` is an estimate within 30 %. */
static double period(int law, double mu, double about)
{
	static _Alignas(64) char scratch[POUND_EXACT_SCRATCH];
	enum { SAMPLES = 1001 };
	static const double still[SAMPLES];
	// bisection of the duration: from the middle, the displacement rises through 0 after one period
	double low = 0.7 * about, high = 1.3 * about;
	while (high - low > 1e-13) {
		double middle = 0.5 * (low + high);
		struct pound_task task = {
		    .ground = still,
		    .n_samples = SAMPLES,
		    .time_step = middle / (SAMPLES - 1),
		    .bodies = {{.backbone = {.law = law, .stiffness = 4 * PI * PI, .hardening = 0.05, .yield = 1},
		                .followed = true}}};
		// start in the middle of the elastic range with the energy of the amplitude mu
		double energy = 2 * PI * sqrt(1 + 2 * (mu - 1) + 0.05 * (mu - 1) * (mu - 1));
		task.bodies[0].v = mu <= 1 ? 2 * PI * mu : energy;
		struct pound_task_result r;
		pound_exact_lanes(0, &task, &r, 1, scratch, NULL);
		check_near(r.displacement_max[0], mu, 1e-12);
		*(r.u[0] < 0 ? &low : &high) = middle;
	}
	return 0.5 * (low + high);
}

static void the_nonlinear_elastic_period_is_the_known_one(void **state)
{
	(void)state;
	// known_answers 5.8, r = 0.05
	const double known[][2] = {
	    {1.5, 1.128116229}, {2, 1.270272291}, {3, 1.512377218}, {5, 1.874464551}, {10, 2.439072811}};
	for (size_t j = 0; j < sizeof known / sizeof known[0]; j++)
		check_near(period(law_row("nonlinear_elastic"), known[j][0], known[j][1]), known[j][1], 1e-9);
	check_near(period(law_row("linear"), 1, 1), 1, 1e-12);
}

static void every_law_is_known_to_the_oracle_and_to_the_random_scenes_of_the_tests(void **state)
{
	(void)state;
	for (int row = 0; pound_law_name(row); row++) {
		oracle_law(pound_law_name(row), 1, 0.05, 1); // asserts that it has the law
		assert_true(row < SPECIMEN_LAWS);
		assert_string_equal(specimen_laws[row], pound_law_name(row));
	}
	assert_null(pound_law_name(SPECIMEN_LAWS));
}

/* The energy that a law gives back is the work from the current state to zero force. */
static void a_law_gives_back_what_it_does_on_the_way_to_no_force(void **state)
{
	static const struct {
		const char *law;
		double hardening, to, back; /* displacements; `back` has zero force */
	} cases[] = {{"linear", 0, 3, 0},
	             {"elastoplastic", 0, 3, 2},
	             {"elastoplastic", 0.2, -3, -1.6},
	             {"elastoplastic", 0.5, 9, 1}, // r = 5 is 3 above 2 k d_y: it yields during unloading
	             {"nonlinear_elastic", 0.2, 3, 0},
	             {"origin_oriented", 0.2, -4, 0}};
	(void)state;
	for (size_t k = 0; k < sizeof cases / sizeof cases[0]; k++) {
		struct push push;
		push_start(&push, law_row(cases[k].law), 1, cases[k].hardening);
		push_to(&push, cases[k].to);
		const double gives = pound_law_given_back(&push.backbone, &push.at, push.u), before = push.work;
		check_near(pound_law_residual(&push.backbone, &push.at, push.u), cases[k].back, 1e-15);
		push_to(&push, cases[k].back);
		check_near(push.force, 0, 1e-15);
		check_near(before - push.work, gives, 1e-14);
	}
}

CHECK_MAIN(cmocka_unit_test(a_law_gives_back_what_it_does_on_the_way_to_no_force),
           cmocka_unit_test(every_law_is_known_to_the_oracle_and_to_the_random_scenes_of_the_tests),
           cmocka_unit_test(the_kinematic_loop_encloses_the_known_area),
           cmocka_unit_test(the_origin_oriented_law_loses_work_on_the_first_push_only),
           cmocka_unit_test(each_side_of_the_origin_oriented_law_remembers_its_own_farthest_point),
           cmocka_unit_test(the_nonlinear_elastic_law_encloses_nothing),
           cmocka_unit_test(hardening_one_is_linear_whatever_the_law),
           cmocka_unit_test(the_nonlinear_elastic_period_is_the_known_one))
