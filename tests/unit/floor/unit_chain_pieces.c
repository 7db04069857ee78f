/* unit_chain_pieces.c - floors of chains, by two ways each.
 *
 * 1. A pair by the solver of pairs and as a chain of two one-story buildings.
 * 2. An oscillator on a floor is an additional story of negligible mass, whose largest drift times w^2 is the ordinate:
 *    for every contact model. */
#include <math.h>
#include <string.h>

#include "engine/floor/floor.h"
#include "engine/solver/solver.h"
#include "tests/support/chain_scenes.h"
#include "tests/support/check.h"
#include "tests/support/floor_tasks.h"

static const double PI = 3.14159265358979323846;

enum { FREQUENCIES = 9, SAMPLES = 301 };

static const double frequencies[FREQUENCIES] = {0.4, 1, 2.1, 3.3, 7, 15, 40, 90, 300};
static _Alignas(64) char scratch[POUND_EXACT_SCRATCH];
static _Alignas(64) char memory[1 << 21];

static struct pound_floor *floor_of(double damping)
{
	const struct pound_spectrum spectrum = {
	    .n = FREQUENCIES, .frequencies_hz = frequencies, .damping_ratio = damping};
	assert_true(pound_floor_bytes(FREQUENCIES) <= sizeof memory);
	return pound_floor_init(memory, &spectrum);
}

static struct pound_floor_answer spectra_of(struct pound_floor_ask ask, double damping,
                                            double psa[POUND_DRIVES][FREQUENCIES])
{
	struct pound_floor_answer answer = {.psa = {psa[0], psa[1]}};
	ask.n_drives = POUND_DRIVES;
	ask.radians = 1.5;
	ask.scratch = scratch;
	assert_int_equal(pound_floor_spectra(floor_of(damping), &ask, &answer, 1), POUND_OK);
	return answer;
}

/* ---- a pair ---- */

/* Rows at samples, the last row of each. */
struct rows {
	double step;
	int samples, rows;
	struct pound_floor_instant at[SAMPLES];
};

static void row_take(void *of, const struct pound_floor_instant *instant)
{
	struct rows *rows = of;
	const double sample = round(instant->time / rows->step);
	rows->rows++;
	if (fabs(instant->time - sample * rows->step) > 1e-12)
		return;
	rows->samples = (int)sample + 1;
	rows->at[(int)sample] = *instant;
}

static void history_of(struct pound_task *task, struct rows *rows)
{
	const struct pound_floor_ask ask = {.task = task, .scratch = scratch};
	*rows = (struct rows){.step = task->time_step};
	assert_int_equal(pound_floor_history(floor_of(0.05), &ask, row_take, rows), POUND_OK);
}

static void instants_near(const struct pound_floor_instant *a, const struct pound_floor_instant *b,
                          double allowed)
{
	for (int i = 0; i < POUND_OSCILLATORS; i++) {
		check_near(a->u[i], b->u[i], allowed);
		check_near(a->v[i], b->v[i], 30 * allowed);
		check_near(a->acceleration[i], b->acceleration[i], 1e5 * allowed);
	}
	check_near(a->gap, b->gap, allowed);
	check_near(a->gap_rate, b->gap_rate, 30 * allowed);
	check_near(a->push, b->push, 1e5 * allowed);
	check_near(a->ground, b->ground, 0);
}

/* A pair of any of the laws with a gap, possibly with a wall. */
static void pair_make(struct specimen *specimen, int number)
{
	specimen_init(specimen);
	specimen_noise(specimen, (uint64_t)number, 3.7, 0.01, SAMPLES);
	specimen_law(specimen, specimen_laws[number % SPECIMEN_LAWS], 0.02);
	specimen->study.scene.contact.gap = number % 3 ? 0.004 : 0;
	specimen->study.scene.contact.tension = number % 2;
	specimen->study.scene.oscillators[1].rigid_wall = number >= SPECIMEN_LAWS;
}

/* The same contact, in a form that the solver of pairs does not support. */
static void as_chain(struct pound_task *task)
{
	task->law = pound_task_law(task);
	task->force = POUND_FORCE_STRAIGHT;
	assert_true(pound_runs_as_chain(task));
}

static void a_pair_is_a_chain_of_one_story_buildings(void **state)
{
	(void)state;
	double worst = 0, worst_push = 0;
	for (int number = 0; number < 2 * SPECIMEN_LAWS; number++) {
		static struct rows rows[2];
		double psa[2][POUND_DRIVES][FREQUENCIES];
		struct specimen specimen;
		pair_make(&specimen, number);
		struct pound_task task = floor_task_task(&specimen, true);
		const struct pound_floor_answer pair =
		    spectra_of((struct pound_floor_ask){.task = &task}, 0.02, psa[0]);
		history_of(&task, &rows[0]);
		as_chain(&task);
		const struct pound_floor_answer chain =
		    spectra_of((struct pound_floor_ask){.task = &task}, 0.02, psa[1]);
		history_of(&task, &rows[1]);
		assert_true(pair.contacts > 0 && pair.contacts == chain.contacts);
		check_near(chain.impulse_max, pair.impulse_max, 1e-11 * pair.impulse_max);
		for (int k = 0; k < FREQUENCIES; k++) {
			worst = fmax(worst, fabs(psa[1][0][k] / psa[0][0][k] - 1));
			worst_push = fmax(worst_push, fabs(psa[1][1][k] / psa[0][1][k] - 1));
		}
		assert_int_equal(rows[0].samples, SAMPLES);
		assert_int_equal(rows[1].samples, SAMPLES);
		for (int i = 0; i < SAMPLES; i++)
			instants_near(&rows[1].at[i], &rows[0].at[i], 1e-11 * 0.1);
		specimen_free(&specimen);
	}
	check_report("spectra of pairs as chains: %.1e of the ordinate, of the push alone %.1e", worst,
	             worst_push);
	assert_true(worst < 1e-12 && worst_push < 1e-12);
}

/* ---- an oscillator is a story ---- */

/* Three stories beside three, with contacts at floors 1 and 3; f > 0: an oscillator of that frequency is on the third floor. */
static void row_make(struct row *row, const char *model, int law, double f)
{
	const double light = 1e-13;
	row_init(row);
	row->n_buildings = 2;
	row->buildings[0] = row_building(3, 1e5, 6e7);
	row->buildings[1] = row_building(3, 1.3e5, 1.4e8);
	for (int b = 0; b < 2; b++) {
		row->buildings[b].damping = ROW_STORY;
		row->buildings[b].law.law = law;
		row->buildings[b].law.yield = 0.01;
	}
	while (strcmp(pound_contact_name(row->contact.model), model) != 0)
		row->contact.model = (row->contact.model + 1) % POUND_CONTACT_MODELS;
	row->contact.gap = 0.004;
	row->contact.second_stiffness_ratio = 0.3;
	row->contact.yield_overlap = 2e-4;
	row->contact.reference_speed = 0.1;
	row->contact.speed_floor = 0.001;
	row->n_contacts = 2;
	row->contacts[0] = (struct row_contact){0, {3, 3}};
	row->contacts[1] = (struct row_contact){0, {1, 1}};
	if (f == 0)
		return;
	struct row_building *left = &row->buildings[0];
	left->stories = 4;
	left->mass[3] = light * left->mass[2];
	left->stiffness[3] = left->mass[3] * pow(2 * PI * f, 2);
}

/* The oscillator has its own damping and law. */
static void oscillator_set(struct row *row, double f, double damping)
{
	struct pound_chain_floor *floor = &row->floors[3];
	floor->dashpot = 2 * damping * floor->mass * 2 * PI * f;
	floor->story.law = 0;
	floor->story.yield = floor->story.hardening = 0;
}

static void an_oscillator_on_a_floor_is_one_more_story_of_no_mass(void **state)
{
	(void)state;
	static const char *const models[] = {
	    "kelvin_voigt", "linear",       "modified_kelvin_voigt", "hunt_crossley", "hertz",
	    "hertz_damp",   "viscoelastic", "damped_hertz",          "bilinear",      "rigid"};
	static struct row row;
	for (size_t m = 0; m < sizeof models / sizeof models[0]; m++)
		for (int law = 0; law < 2; law++) {
			double psa[POUND_DRIVES][FREQUENCIES], worst = 0;
			row_make(&row, models[m], law, 0);
			const int n = row_harmonic(&row, 1.7, 2, 4);
			struct pound_chain_task task = row_task(&row, n, 0.01, 0);
			struct pound_chain_result result = {.floors = row.floor_measures[0],
			                                    .links = row.link_measures[0]};
			const struct pound_floor_ask ask = {.chain = {&task, 2, &result}};
			const struct pound_floor_answer answer = spectra_of(ask, 0.03, psa);
			assert_true(answer.contacts > 0);
			for (int k = 0; k < FREQUENCIES; k++) {
				const double w = 2 * PI * frequencies[k];
				row_make(&row, models[m], law, frequencies[k]);
				row_harmonic(&row, 1.7, 2, 4);
				task = row_task(&row, n, 0.01, POUND_CHAIN_DRIFTS);
				oscillator_set(&row, frequencies[k], 0.03);
				assert_int_equal(row_run(&row, &task, 0).status, POUND_OK);
				const double story = w * w * row.floor_measures[3][POUND_FLOOR_DRIFT_MAX];
				worst = fmax(worst, fabs(psa[0][k] / story - 1));
			}
			check_report("%s, %s: spectrum %.1e off that of stories", models[m], pound_law_name(law), worst);
			assert_true(worst < 1e-11);
		}
}

static void without_contact_nothing_pushes_a_floor(void **state)
{
	(void)state;
	static struct row row;
	double psa[POUND_DRIVES][FREQUENCIES];
	row_make(&row, "kelvin_voigt", 0, 0);
	row.contact.present = false;
	const int n = row_harmonic(&row, 1.7, 1, 4);
	struct pound_chain_task task = row_task(&row, n, 0.01, 0);
	struct pound_chain_result result = {.floors = row.floor_measures[0], .links = row.link_measures[0]};
	const struct pound_floor_answer answer =
	    spectra_of((struct pound_floor_ask){.chain = {&task, 1, &result}}, 0.05, psa);
	check_near(answer.impulse_max, 0, 0);
	for (int k = 0; k < FREQUENCIES; k++) {
		check_near(psa[POUND_DRIVE_PUSH][k], 0, 0);
		assert_true(psa[POUND_DRIVE_FLOOR][k] > 0);
	}
}

CHECK_MAIN(cmocka_unit_test(a_pair_is_a_chain_of_one_story_buildings),
           cmocka_unit_test(an_oscillator_on_a_floor_is_one_more_story_of_no_mass),
           cmocka_unit_test(without_contact_nothing_pushes_a_floor))
