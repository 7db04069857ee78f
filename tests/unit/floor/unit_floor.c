/* unit_floor.c - floor spectra and histories of whole scenes: closed forms, a plain integrator, invariants and bits. */
#include <math.h>
#include <stdatomic.h>
#include <stdlib.h>
#include <string.h>

#include "engine/solver/solver.h"
#include "tests/support/check.h"
#include "tests/support/floor_tasks.h"

static const double pi = 3.14159265358979323846;

enum { MOST = 64 };

static _Alignas(64) char scratch[POUND_EXACT_SCRATCH];

static double psa[2][MOST], again[2][MOST];
static double *const into[] = {psa[0], psa[1]}, *const into_again[] = {again[0], again[1]};

static void a_range_of_frequencies_is_a_geometric_one(void **state)
{
	(void)state;
	const struct pound_spectrum range = {.n = 200, .min_hz = 0.1, .max_hz = 100};
	check_near(pound_spectrum_frequency(&range, 0), 0.1, 0);
	check_near(pound_spectrum_frequency(&range, 199), 100, 0);
	for (int k = 0; k < 200; k++)
		check_near(pound_spectrum_frequency(&range, k), 0.1 * pow(1000, k / 199.0),
		           1e-13 * pow(1000, k / 199.0));
	const double list[] = {5, 2};
	const struct pound_spectrum listed = {.n = 2, .frequencies_hz = list};
	check_near(pound_spectrum_frequency(&listed, 1), 2, 0);
}

/* Shock spectrum of a half sine, undamped: td/T and max |w^2 u|/A, computed by another program. */
static const double shocks[][2] = {
    {.1, .396273548}, {.25, .942809042}, {.5, 1.570796327}, {.75, 1.763355757}, {.80994, 1.768457654},
    {1, 1.732050808}, {1.5, 1.5},        {2, 1.268075355},  {3, 1.169913495},   {5, 1.099801602},
};

enum { SHOCKS = sizeof shocks / sizeof shocks[0] };

/* A floor of 5 kHz moves as the ground except for (f/5000)^2 = 1e-6 at 5 Hz, and 1e-8 at the pulse's own 0.5 Hz. */
static void a_floor_that_is_stiff_gives_the_shock_spectrum_of_the_ground(void **state)
{
	(void)state;
	double frequency[SHOCKS];
	for (int k = 0; k < SHOCKS; k++)
		frequency[k] = shocks[k][0];
	const struct pound_spectrum spectrum = {.n = SHOCKS, .frequencies_hz = frequency};
	struct specimen specimen;
	specimen_init(&specimen);
	specimen.study.scene.oscillators[0].frequency_hz = 5000;
	specimen.study.scene.contact.present = false;
	specimen_half_sine(&specimen, 1, 1, 6.2,
	                   0.005); // the slowest has its peak within half its period of 10 s after the pulse
	const struct pound_task task = floor_task_task(&specimen, false);
	floor_task_spectra(&task, &spectrum, 1, 1.5, 0, (double **)into);
	// the record approximates the half sine to (pi 0.005)^4/100 = 6e-10
	for (int k = 0; k < SHOCKS; k++)
		check_near(psa[0][k], shocks[k][1], 2.5e-9 + 2 * pow(fmax(frequency[k], 0.5) / 5000, 2));
	specimen_free(&specimen);
}

/* ---- a plain integrator ---- */

enum { CHASED = 6 };

/* Floor and oscillators as in case A together by classical Runge-Kutta steps; contact is checked in every stage. */
static void plain_rates(const struct pound_task *task, double ground, const double *w, double xi,
                        const double *y, double *dy)
{
	const struct pound_task_body *b = task->bodies;
	double p = y[0] - y[2] - task->gap;
	double force = p > 0 ? task->contact_stiffness * p + task->contact_damping * (y[1] - y[3]) : 0;
	double floor = -(b[0].damping * y[1] + b[0].backbone.stiffness * y[0]) - force;
	dy[0] = y[1];
	dy[1] = floor - ground;
	dy[2] = y[3];
	dy[3] = -(b[1].damping * y[3] + b[1].backbone.stiffness * y[2]) + task->mass_ratio * force - ground;
	for (int k = 0; k < CHASED; k++) {
		const double *z = y + 4 + 2 * k;
		dy[4 + 2 * k] = z[1];
		dy[5 + 2 * k] = -2 * xi * w[k] * z[1] - w[k] * w[k] * z[0] - floor;
	}
}

static void plain_spectra(const struct pound_task *task, const double *w, double xi, int steps, double *out)
{
	enum { STATES = 4 + 2 * CHASED };
	double y[STATES] = {0}, h = task->time_step / steps;
	memset(out, 0, sizeof *out * CHASED);
	for (int t = 1; t < task->n_samples; t++)
		for (int i = 0; i < steps; i++) {
			double d[4][STATES], at[STATES], a0 = task->ground[t - 1], rise = task->ground[t] - a0;
			for (int stage = 0; stage < 4; stage++) {
				double share = stage == 0 ? 0 : stage == 3 ? 1 : 0.5;
				for (int j = 0; j < STATES; j++)
					at[j] = y[j] + (stage ? share * h * d[stage - 1][j] : 0);
				plain_rates(task, a0 + rise * (i + share) / steps, w, xi, at, d[stage]);
			}
			for (int j = 0; j < STATES; j++)
				y[j] += h / 6 * (d[0][j] + 2 * d[1][j] + 2 * d[2][j] + d[3][j]);
			for (int k = 0; k < CHASED; k++)
				out[k] = fmax(out[k], w[k] * w[k] * fabs(y[4 + 2 * k]));
		}
}

static void a_plain_integrator_finds_the_same_spectrum(void **state)
{
	(void)state;
	static const double frequency[CHASED] = {0.5, 1, 3, 10, 30, 90};
	const struct pound_spectrum spectrum = {.n = CHASED, .frequencies_hz = frequency, .damping_ratio = 0.05};
	for (int elastic = 0; elastic < 2; elastic++) {
		struct specimen specimen;
		double w[CHASED], plain[CHASED];
		specimen_init(&specimen);
		specimen_reference(&specimen, &specimen_references[0], 0.005);
		if (elastic)
			specimen.study.scene.contact.restitution = 1;
		const struct pound_task task = floor_task_task(&specimen, true);
		for (int k = 0; k < CHASED; k++)
			w[k] = 2 * pi * frequency[k];
		plain_spectra(&task, w, 0.05, 100, plain);
		floor_task_spectra(&task, &spectrum, 2, 1.5, 0, (double **)into);
		// steps of 5e-5 s: if the dashpot makes the force jump, a contact of 12 ms begins up to one step late;
		// otherwise only the slope of the force jumps, with an error of (contact frequency times step)^2/10 = 2e-5 of
		// the force
		for (int k = 0; k < CHASED; k++)
			check_near(psa[0][k] / plain[k], 1, elastic ? 2e-5 : 3e-3);
		specimen_free(&specimen);
	}
}

/* ---- invariants of any scene ---- */

static void half_the_steps_give_the_same_spectra(void **state)
{
	(void)state;
	const struct pound_spectrum spectrum = {.n = 24, .min_hz = 0.2, .max_hz = 120, .damping_ratio = 0.02};
	for (int number = 0; number < 24; number++) {
		struct specimen specimen;
		specimen_random(&specimen, number, 0.01, 401);
		struct pound_task task = floor_task_task(&specimen, true);
		floor_task_spectra(&task, &spectrum, 2, 1.5, 0, (double **)into);
		double twice[801];
		for (int t = 0; t < 801; t++)
			twice[t] = 0.5 * (task.ground[t / 2] + task.ground[(t + 1) / 2]);
		task.ground = twice;
		task.n_samples = 801;
		task.time_step = 0.005;
		floor_task_spectra(&task, &spectrum, 2, 0.4, 0, (double **)into_again);
		for (int d = 0; d < 2; d++)
			for (int k = 0; k < spectrum.n; k++) // after 4 s of impacts
				check_near(again[d][k], psa[d][k], 1e-9 * fmax(psa[d][k], 1));
		specimen_free(&specimen);
	}
}

static void every_lane_count_gives_the_same_bits(void **state)
{
	(void)state;
	static const int lanes[] = {8, 4, 1};
	const struct pound_spectrum spectrum = {.n = 21, .min_hz = 0.2, .max_hz = 300, .damping_ratio = 0.05};
	for (int number = 0; number < 4; number++) {
		struct specimen specimen;
		specimen_random(&specimen, number, 0.01, 401);
		struct pound_task task = floor_task_task(&specimen, true);
		floor_task_spectra(&task, &spectrum, 2, 1.5, 0, (double **)into);
		for (int i = 0; i < 3; i++) {
			if ((lanes[i] == 8 && !__builtin_cpu_supports("avx512dq")) ||
			    (lanes[i] == 4 && !__builtin_cpu_supports("avx2")))
				continue;
			floor_task_spectra(&task, &spectrum, 2, 1.5, lanes[i], (double **)into_again);
			for (int d = 0; d < 2; d++)
				assert_memory_equal(psa[d], again[d], sizeof(double) * (size_t)spectrum.n);
		}
		specimen_free(&specimen);
	}
}

/* Floors followed together (pairs of any laws, a chain, and a pair that cannot be followed) have the same bits and
 * status as each floor alone. */
static void floors_at_once_are_those_alone(void **state)
{
	(void)state;
	enum { FREQUENCIES = 21, CHAIN = 8, CHATTER = 11 };
	// a stiff contact without energy loss that stays closed: unit_floor_pieces
	static const double ground[] = {-0.01, -0.31, -0.61, -0.91};
	const struct pound_task chatter = {
	    .ground = ground,
	    .n_samples = 4,
	    .time_step = 0.1,
	    .bodies = {{.backbone = {.stiffness = 40}, .damping = 0.6, .drive = 1}},
	    .contact = true,
	    .contact_stiffness = 40e14,
	    .tension = true};
	const struct pound_spectrum spectrum = {
	    .n = FREQUENCIES, .min_hz = 0.2, .max_hz = 300, .damping_ratio = 0.05};
	static struct specimen specimens[POUND_FLOORS];
	static double numbers[POUND_FLOORS][POUND_DRIVES][FREQUENCIES];
	struct pound_task tasks[POUND_FLOORS];
	struct pound_floor_ask asks[POUND_FLOORS];
	struct pound_floor_answer answers[POUND_FLOORS];
	for (int k = 0; k < POUND_FLOORS; k++) {
		specimen_random(&specimens[k], k, 0.01, 401 + 40 * k);
		tasks[k] = floor_task_task(&specimens[k], k % 5 != 2);
		if (k == CHATTER)
			tasks[k] = chatter;
		if (k == CHAIN) {
			tasks[k].law = pound_task_law(&tasks[k]);
			tasks[k].force = POUND_FORCE_STRAIGHT;
			assert_true(pound_runs_as_chain(&tasks[k]));
		}
		asks[k] = (struct pound_floor_ask){
		    .task = &tasks[k], .n_drives = 1 + k % 2, .radians = k % 3 ? 1.5 : 0.75, .scratch = scratch};
		answers[k] = (struct pound_floor_answer){.psa = {numbers[k][0], numbers[k][1]}};
	}
	void *memory = aligned_alloc(64, (pound_floor_bytes(FREQUENCIES) / 64 + 1) * 64);
	assert_non_null(memory);
	struct pound_floor *floor = pound_floor_init(memory, &spectrum);
	assert_int_equal(pound_floor_spectra(floor, asks, answers, POUND_FLOORS), POUND_CHATTER);
	for (int k = 0; k < POUND_FLOORS; k++) {
		struct pound_floor_answer alone = {.psa = {psa[0], psa[1]}};
		assert_int_equal(pound_floor_spectra(floor, &asks[k], &alone, 1), answers[k].status);
		assert_int_equal(answers[k].status, k == CHATTER ? POUND_CHATTER : POUND_OK);
		for (int d = 0; d < asks[k].n_drives; d++)
			assert_memory_equal(numbers[k][d], psa[d], sizeof numbers[k][d]);
		assert_true(alone.contacts == answers[k].contacts && alone.impulse_max == answers[k].impulse_max);
		specimen_free(&specimens[k]);
	}
	free(memory);
}

struct largest_drive {
	const struct pound_task *task;
	struct pound_floor_stretch stretch;
	double value;
};

static void drive_take(void *of)
{
	struct largest_drive *largest = of;
	for (int i = 0; i < largest->stretch.n; i++)
		for (int part = 0; part <= 100; part++) {
			double a = 0, room[POUND_FLOOR_ROOM];
			const double *c, damping = largest->task->bodies[0].damping;
			for (int n = pound_floor_drive(&largest->stretch, &largest->stretch.piece[i], POUND_DRIVE_FLOOR,
			                               damping, room, &c);
			     n >= 0; n--)
				a = a * (part / 100.0) + c[n];
			largest->value = fmax(largest->value, fabs(a));
		}
}

/* An oscillator of high frequency follows the floor: its pseudo-acceleration is the floor's largest acceleration. */
static void a_stiff_oscillator_shows_the_largest_acceleration(void **state)
{
	(void)state;
	static const double frequency[] = {20000};
	const struct pound_spectrum spectrum = {.n = 1, .frequencies_hz = frequency, .damping_ratio = 0.05};
	struct specimen specimen;
	specimen_init(&specimen);
	specimen.study.scene.contact.restitution = 1; // the force does not jump
	specimen_half_sine(&specimen, 1, 0.5, 2, 0.01);
	const struct pound_task task = floor_task_task(&specimen, true);
	floor_task_spectra(&task, &spectrum, 1, 1.5, 0, (double **)into);
	static struct largest_drive largest;
	largest.task = &task;
	struct pound_floor_motion motion = {
	    .task = &task, .stretch = &largest.stretch, .taker = {drive_take, &largest}};
	const struct pound_task_observer observer = {.observe = pound_floor_observe, .into = &motion};
	struct pound_task observed = task;
	observed.observer = &observer;
	struct pound_task_result result;
	pound_floor_start(&motion);
	assert_true(pound_exact_lanes(0, &observed, &result, 1, scratch, NULL));
	drive_take(&largest);
	// a jump of the slope at the start of a contact leaves a relative error of contact frequency / own, 25 Hz to 20 kHz
	check_near(psa[0][0] / largest.value, 1, 2e-3);
	specimen_free(&specimen);
}

static void without_contact_there_is_no_push(void **state)
{
	(void)state;
	const struct pound_spectrum spectrum = {.n = 9, .min_hz = 0.2, .max_hz = 30, .damping_ratio = 0.05};
	struct specimen specimen;
	specimen_init(&specimen);
	specimen_noise(&specimen, 7, 1, 0.01, 401);
	const struct pound_task task = floor_task_task(&specimen, false);
	const struct pound_floor_answer answer = floor_task_spectra(&task, &spectrum, 2, 1.5, 0, (double **)into);
	check_near(answer.impulse_max, 0, 0);
	for (int k = 0; k < spectrum.n; k++) {
		check_near(psa[POUND_DRIVE_PUSH][k], 0, 0);
		assert_true(psa[POUND_DRIVE_FLOOR][k] > 0);
	}
	specimen_free(&specimen);
}

/* ---- history ---- */

struct rows {
	int n, doubled, sampled;
	double step, time, u_end, v_end,
	    work; /* time of the last row; integral of the push by the trapezium rule */
	double last_push;
};

static void row_take(void *to, const struct pound_floor_instant *instant)
{
	struct rows *rows = to;
	assert_true(instant->time >= rows->time - 1e-15);
	rows->doubled += rows->n > 0 && instant->time == rows->time;
	rows->sampled += instant->time == rows->sampled * rows->step;
	rows->work += 0.5 * (instant->time - rows->time) * (instant->push + rows->last_push);
	rows->last_push = instant->push;
	rows->time = instant->time;
	rows->u_end = instant->u[0];
	rows->v_end = instant->v[0];
	rows->n++;
}

static void a_history_has_every_sample_and_both_sides_of_every_event(void **state)
{
	(void)state;
	const struct pound_spectrum spectrum = {.n = 1, .min_hz = 1, .max_hz = 1};
	struct specimen specimen;
	specimen_init(&specimen);
	specimen_reference(&specimen, &specimen_references[0], 0.0025);
	const struct pound_task task = floor_task_task(&specimen, true);
	_Alignas(64) static char memory[1 << 21];
	assert_true(pound_floor_bytes(1) <= sizeof memory);
	struct pound_floor *floor = pound_floor_init(memory, &spectrum);
	struct rows rows = {.step = task.time_step};
	const struct pound_floor_ask ask = {.task = &task, .scratch = scratch};
	assert_int_equal(pound_floor_history(floor, &ask, row_take, &rows), POUND_OK);
	// 1201 samples, seven contacts that begin and end
	assert_int_equal(rows.sampled, 1201);
	assert_int_equal(rows.doubled, 14);
	check_near(rows.time, 3, 1e-12);
	check_near(rows.u_end, specimen_references[0].end_u1, 1e-8);
	// the impulses of all contacts by linear interpolation: smaller by theta^2/12 (floor.c)
	check_near(-rows.work,
	           .236645435 + .080375034 + .078971148 + .057062727 + .029576627 + .028330364 + .024251585,
	           1e-3 / 12 * 0.54);
	specimen_free(&specimen);
}

static void stop_set(void *stop)
{
	atomic_store((atomic_bool *)stop, true);
}

static void nothing_take(void *to, const struct pound_floor_instant *instant)
{
	(void)to, (void)instant;
}

static void a_floor_that_takes_hours_is_stopped(void **state)
{
	(void)state;
	const struct pound_spectrum spectrum = {.n = 1, .min_hz = 1, .max_hz = 1};
	struct specimen specimen;
	specimen_bouncing(&specimen);
	const double stiffness = 4 * pi * pi;
	const struct pound_task task = {
	    .ground = specimen.record,
	    .n_samples = specimen.study.scene.excitation.n_record,
	    .time_step = 0.01,
	    .bodies = {{.backbone.stiffness = stiffness, .drive = 1, .followed = true}},
	    .contact = true,
	    .contact_stiffness = specimen.study.scene.contact.stiffness_ratio * stiffness,
	    .tension = true};
	_Alignas(64) static char memory[1 << 21];
	struct pound_floor *floor = pound_floor_init(memory, &spectrum);
	struct pound_floor_answer answer = {.psa = {psa[0], psa[1]}};
	for (int history = 0; history < 2; history++) {
		atomic_bool stop = false;
		const struct pound_floor_ask ask = {
		    .task = &task, .n_drives = 1, .radians = 1.5, .stop = &stop, .scratch = scratch};
		pthread_t thread = specimen_later(stop_set, &stop);
		assert_int_equal(history ? pound_floor_history(floor, &ask, nothing_take, NULL)
		                         : pound_floor_spectra(floor, &ask, &answer, 1),
		                 POUND_STOPPED);
		pthread_join(thread, NULL);
	}
	specimen_free(&specimen);
}

CHECK_MAIN(cmocka_unit_test(a_range_of_frequencies_is_a_geometric_one),
           cmocka_unit_test(a_floor_that_is_stiff_gives_the_shock_spectrum_of_the_ground),
           cmocka_unit_test(a_plain_integrator_finds_the_same_spectrum),
           cmocka_unit_test(half_the_steps_give_the_same_spectra),
           cmocka_unit_test(every_lane_count_gives_the_same_bits),
           cmocka_unit_test(floors_at_once_are_those_alone),
           cmocka_unit_test(a_stiff_oscillator_shows_the_largest_acceleration),
           cmocka_unit_test(without_contact_there_is_no_push),
           cmocka_unit_test(a_history_has_every_sample_and_both_sides_of_every_event),
           cmocka_unit_test(a_floor_that_takes_hours_is_stopped))
