/* operations.c - counts the operations of a study before it is run; work that the engine shares is counted once.
 *
 * How often bodies touch, yield and stay in contact is not known before a run: it is estimated from their frequencies, masses and
 * gap and the peak ground acceleration, fitted to the mean of many scenes.  Two counts are upper bounds: a growing design counts
 * as grown to its end, and a run that ends as chatter, or fails, as a complete one. */
#include "schema/study/operations.h"

#include <assert.h>
#include <math.h>
#include <stddef.h>

#include "engine/ground/excitation.h"
#include "engine/run/outputs.h"
#include "engine/scene/building.h"
#include "engine/scene/contact.h"
#include "engine/solver/solver.h"
#include "schema/study/means.h"
#include "schema/study/study_buildings.h"
#include "schema/study/study_json.h"

enum {
	HISTORIES = 32,    /* times at which a convergence study compares displacements */
	CHECK_EVERY = 100, /* one item in so many is run again as a check, ... */
	CHECKS_LEAST = 8,  /* ... but at least so many runs */
};

static const double PI = 3.14159265358979323846;

// the step of a solver, in the order of the solvers: event, newmark, central_difference, adaptive
static const enum operation step_of[] = {MARCH, NEWMARK, CENTRAL, ADAPT};

static_assert(sizeof step_of / sizeof step_of[0] == POUND_SOLVERS, "a row for each solver");

/* radians per sample: most with maps, most with maps of two linear bodies together without contact, most before a run is chatter */
static const double MAPPED = 2, PAIR_MAPPED = 1.5, TURNED_MOST = 5e5;

/* Scale of (contact frequency / frequency of the stiffer body)^2 in SWING and SUSTAINED: log(1 + SWINGS ratio). */
static const double SWINGS = 0.003;

/* runs to add for the time of lanes that are idle at the end */
static const double TAIL = 2.7;

/* cost of a check over the cost of the run that it checks */
static const double CHECKED = 2;

/* Gaps, times the squared frequency of the softer body over the peak ground acceleration, at which the bodies are near each other,
 * or in sustained contact, half as long as without a gap. */
static const double NEAR = 0.4, RIDING = 0.01;

/* radians per step of a row */
static const double CHAIN_RADIANS = 4;

/* cost of a step without its floors, in floors; and factor of the squared number of floors that modal damping couples */
static const double CHAIN_FLOORS = 8, MODAL_FLOORS = 0.12;

static const double RESTITUTION_LEAST = 1e-3, DASHPOT_MOST = 300;

/* radians per step of a floor */
static const double FLOOR_RADIANS = 1.5;

/* floors and spectra of a run: with and without pounding, and a spectrum of only the contact force */
static const struct {
	int floors, spectra;
} ridden[] = {[POUND_KIND_SENSITIVITY] = {1, 1}, [POUND_KIND_FLOOR_SPECTRUM] = {2, 3}};

enum { RESAMPLES = 2000, MOMENTS = 10, MOMENTS_INPUT = 7, TILE_COLUMNS = 16 };

/* Mean number of corrections of a search for a yield displacement. */
static const double SEARCH_MEAN = 6;

/* ---- what depends on a member of the scene: the ground motion, the response of a body, or a run ---- */
static bool of_motion(size_t offset)
{
	const size_t first = offsetof(struct pound_scene, excitation);
	return offset >= first && offset < first + sizeof(struct pound_excitation);
}

static size_t law_offset(const struct pound_study *study, int body)
{
	return (size_t)((const char *)pound_scene_law(&study->scene, body) - (const char *)&study->scene);
}

/* Whether a response without pounding depends on a member: on all members of its body except the mass. */
static bool of_body(const struct pound_study *study, int body, size_t offset)
{
	const size_t first = offsetof(struct pound_scene, oscillators) +
	                     (size_t)body * sizeof(struct pound_oscillator),
	             law = law_offset(study, body);
	return of_motion(offset) || (offset >= law && offset < law + sizeof(struct pound_law)) ||
	       (offset >= first && offset < first + sizeof(struct pound_oscillator) &&
	        offset != first + offsetof(struct pound_oscillator, mass));
}

/* The same for a building of a row. */
static bool of_building(int building, struct pound_field field)
{
	const size_t at = means_offset(field), law = offsetof(struct pound_scene, law);
	return of_motion(at) || (at >= law && at < law + sizeof(struct pound_law)) ||
	       (field.part == POUND_PART_BUILDINGS &&
	        field.offset / sizeof(struct pound_building) == (size_t)building);
}

enum { ALL = -2, MOTION = -1 /* or a body, or a building of a row */ };

/* Whether the ground motion, a body's response or the run of an item (`what`) depends on a varied member. */
static bool depends(const struct pound_study *study, int what, struct pound_field field)
{
	return what == ALL                ? true
	       : what == MOTION           ? of_motion(means_offset(field))
	       : study->scene.n_buildings ? of_building(what, field)
	                                  : of_body(study, what, means_offset(field));
}

/* Number of different ground motions, responses of a body or runs of an item, over its samples in all cells. */
static double distinct(const struct pound_study *study, int what)
{
	const int samples = study->kind == POUND_KIND_SENSITIVITY ? pound_design_samples(study) : 1;
	int n_inputs = 0;
	double cells = 1;
	for (int j = 0; j < study->n_inputs; j++)
		n_inputs += depends(study, what, study->inputs[j].field);
	for (int s = 0; s < study->n_sweeps; s++)
		cells *= depends(study, what, study->sweeps[s].field) ? study->sweeps[s].n_values : 1;
	const bool common = study->design.common_signals || !pound_excitation_random(&study->scene.excitation);
	// A, B, and A with each column of B that matters (with one such column that is B); with interactions also B with columns of A
	// (with two such columns they are the same)
	const bool second = samples > 2 + study->n_inputs;
	const int columns = n_inputs < 2 ? 0 : second && n_inputs > 2 ? 2 * n_inputs : n_inputs;
	const int some = n_inputs ? (int)fmin(2 + columns, samples) : 1;
	return cells * (common ? some : samples);
}

static bool varies(const struct pound_study *study, size_t offset)
{
	for (int j = 0; j < study->n_inputs; j++)
		if (means_offset(study->inputs[j].field) == offset)
			return true;
	for (int s = 0; s < study->n_sweeps; s++)
		if (means_offset(study->sweeps[s].field) == offset)
			return true;
	return false;
}

/* A building of a row, with mean values; an oscillator counts as a building of one storey. */
struct storeys {
	int n;       /* 0: a wall */
	double mass; /* of a floor, in any unit */
	double low;  /* [rad/s] of the first mode */
	double high; /* ... of the last mode, dashpots included */
	double wide; /* cost of a step in floors: more than n if modal damping couples all floors */
};

/* Rate at which two neighbors may touch again: mean of the higher frequency and of the mean weighted toward the lighter body. */
static double touching(const struct storeys pair[static 2])
{
	const double ratio = pair[1].n ? pair[1].mass / pair[0].mass : 1;
	return pair[1].n ? 0.5 * fmax(pair[0].low, pair[1].low) +
	                       0.5 * (pair[0].low * ratio + pair[1].low) / (1 + ratio)
	                 : pair[0].low;
}

static double masses(const struct storeys pair[static 2])
{
	return pair[1].n ? fmax(pair[0].mass / pair[1].mass, pair[1].mass / pair[0].mass) : 1;
}

/* Mean values of two oscillators. */
struct bodies {
	double hz[POUND_OSCILLATORS];      /* 0: a wall */
	double marches[POUND_OSCILLATORS]; /* runs with yielding: corrections and the last; 0: linear */
	double near;                       /* fraction of the time in which they may touch */
	double riding;                     /* ... and in which contact may be sustained */
	double ratio;    /* squared contact frequency over the squared frequency of the faster body */
	double touching; /* [Hz] rate at which they may touch again */
};

static struct bodies bodies_of(const struct pound_study *study)
{
	const bool wall = study->scene.oscillators[1].rigid_wall;
	struct bodies b = {.hz = {MEAN(study, oscillators[0].frequency_hz, 1),
	                          wall ? 0 : MEAN(study, oscillators[1].frequency_hz, 1)}};
	for (int i = 0; i < POUND_OSCILLATORS; i++) {
		const struct pound_law *law = pound_scene_law(&study->scene, i);
		const size_t at = law_offset(study, i), times = at + offsetof(struct pound_law, corrections);
		const double corrections = varies(study, times) ? means_power(study, times, 1) : law->corrections;
		const bool linear = law->type == 0 && !varies(study, at + offsetof(struct pound_law, type));
		if (b.hz[i] > 0 && !linear)
			b.marches[i] = 1 + (law->yield_displacement > 0 ? 0 : fmin(corrections, SEARCH_MEAN));
	}
	const double soft = 2 * PI * (wall ? b.hz[0] : fmin(b.hz[0], b.hz[1]));
	const struct storeys pair[] = {{1, MEAN(study, oscillators[0].mass, 1), b.hz[0], b.hz[0], 1},
	                               {!wall, MEAN(study, oscillators[1].mass, 1), b.hz[1], b.hz[1], 1}};
	const double asked = MEAN(study, excitation.peak, 1), peak = asked > 0 ? asked : 1;
	b.touching = touching(pair);
	const double gap = MEAN(study, contact.gap, 1) * soft * soft / peak;
	b.near = 1 / (1 + gap / NEAR);
	b.riding = 1 / (1 + gap / RIDING);
	b.ratio = MEAN(study, contact.stiffness_ratio, 1) * masses(pair);
	return b;
}

/* Radians per sample of the oscillators above the limit for maps. */
static double turned(const struct bodies *b, double time_step)
{
	double sum = 0;
	for (int i = 0; i < POUND_OSCILLATORS; i++)
		sum += fmax(0, 2 * PI * b->hz[i] * time_step - MAPPED);
	return fmin(sum, TURNED_MOST);
}

/* Adds ground motions and responses without pounding of so many items, by the event-driven solver. */
static void count_free(const struct pound_study *study, const struct bodies *b, double items,
                       struct counts *c)
{
	const double samples = means_samples(study), radians = 2 * PI * means_duration(study);
	c->of[BEGIN] += items * distinct(study, MOTION);
	c->of[GROUND] += items * distinct(study, MOTION) * samples;
	for (int i = 0; i < POUND_OSCILLATORS; i++) {
		if (b->hz[i] == 0)
			continue;
		const double free = items * distinct(study, i);
		c->of[BEGIN] += free * (1 + b->marches[i]);
		c->of[FREE] += free * samples;
		c->of[YIELD] += free * b->marches[i] * samples;
		c->of[FLOW] += free * b->marches[i] * radians * b->hz[i];
	}
}

/* Adds all work of so many items by the event-driven solver. */
static void count_event(const struct pound_study *study, double items, struct counts *c)
{
	const struct bodies b = bodies_of(study);
	const double samples = means_samples(study), radians = 2 * PI * means_duration(study);
	const double pounded = study->scene.contact.present ? items * distinct(study, ALL) : 0;
	count_free(study, &b, items, c);
	for (int i = 0; i < POUND_OSCILLATORS; i++)
		c->of[POUNDED] += b.marches[i] > 0 ? pounded * radians * b.hz[i] : 0;
	const double touches = pounded * b.near * radians * b.touching;
	c->of[BEGIN] += pounded;
	c->of[MARCH] += pounded * samples;
	c->of[TOUCH] += touches;
	c->of[SWING] += touches * log1p(SWINGS * b.ratio);
	c->of[TURN] +=
	    (pounded > 0 ? pounded : items) * samples * turned(&b, MEAN(study, excitation.time_step, 1));
}

/* The same by a fixed-step solver or the adaptive one, which run one motion at a time, without lanes. */
static void count_steps(const struct pound_study *study, const struct pound_solver *solver, double items,
                        struct counts *c)
{
	const struct bodies b = bodies_of(study);
	const double samples = means_samples(study), radians = 2 * PI * means_duration(study);
	const double pounded = study->scene.contact.present ? items * distinct(study, ALL) : 0;
	c->of[GROUND] += items * distinct(study, MOTION) * samples;
	double marches = pounded, turns = pounded * radians * fmax(b.hz[0], b.hz[1]);
	for (int i = 0; i < POUND_OSCILLATORS; i++) {
		const double free = b.hz[i] > 0 ? items * distinct(study, i) * (1 + b.marches[i]) : 0;
		marches += free;
		turns += free * radians * b.hz[i];
	}
	c->of[BEGIN] += marches + items * distinct(study, MOTION);
	if (pound_solver_takes_step(solver->method)) {
		c->of[START] += marches * samples;
		c->of[step_of[solver->method]] +=
		    marches * samples * fmax(1, MEAN(study, excitation.time_step, 1) / solver->step);
	} else {
		c->of[ADAPT_START] += marches * samples;
		c->of[ADAPT] += turns * pow(solver->tolerance, -1. / 12);
		c->of[FOLLOW] += pounded * b.near * radians * b.touching * pow(b.ratio, 0.25);
		c->of[TURN] += pounded * samples * turned(&b, MEAN(study, excitation.time_step, 1));
	}
}

/* Mean damping rate of a contact's dashpot [rad/s]. */
static double dashpot_rate(const struct pound_study *study, const struct storeys pair[static 2])
{
	const struct pound_contact_place place = {1, 1, 1};
	struct pound_contact contact = study->scene.contact;
	contact.restitution = fmax(MEAN(study, contact.restitution, 1), RESTITUTION_LEAST);
	contact.stiffness = contact.hertz_stiffness = 0;
	contact.stiffness_ratio = 1;
	return fmin(pound_contact_law(&contact, &place).dashpot, DASHPOT_MOST) *
	       fmax(pair[0].high, pair[1].high) * sqrt(MEAN(study, contact.stiffness_ratio, 1) * masses(pair));
}

/* Contacts between a building and its right neighbor. */
static int links_of(const struct pound_study *study, int building, const struct storeys pair[static 2])
{
	int links = 0;
	for (int k = 0; k < study->scene.n_contacts; k++)
		links += study->scene.contacts[k].left_building == building;
	return study->scene.n_contacts ? links : pair[1].n == 0 || pair[0].n < pair[1].n ? pair[0].n : pair[1].n;
}

/* runs of a row with pounding */
struct marches {
	double n, steps; /* number; steps of each */
	double wide;     /* cost of a step, in floors */
	double near;     /* radians of all runs in which neighbors are near each other */
};

/* Adds the work near and in contact of a building and its right neighbor. */
static void count_meetings(const struct pound_study *study, int building, const struct storeys pair[static 2],
                           struct marches *m, struct counts *c)
{
	const int links = links_of(study, building, pair);
	const double asked = MEAN(study, excitation.peak, 1), peak = asked > 0 ? asked : 1;
	const double restitution = fmax(MEAN(study, contact.restitution, 1), RESTITUTION_LEAST);
	const bool wall = pair[1].n == 0;
	const double soft = wall ? pair[0].low : fmin(pair[0].low, pair[1].low);
	const double shaken = 2 * PI * MEAN(study, excitation.frequency_hz, 1);
	const double reach = MEAN(study, contact.gap, 1) * soft * fmax(soft, shaken) / peak;
	const double met = links ? m->n : 0, near = met / (1 + reach / NEAR), riding = met / (1 + reach / RIDING);
	const double radians = means_duration(study) * touching(pair) * links * (CHAIN_FLOORS + m->wide);
	const double own = log1p(SWINGS * MEAN(study, contact.stiffness_ratio, 1) * masses(pair));
	const enum pound_force force = pound_contact_force(study->scene.contact.model);
	m->near += near * means_duration(study) * touching(pair) * links;
	c->of[NEARBY] += near * m->steps * m->wide;
	c->of[MEET] += near * radians;
	c->of[JUMP] += force == POUND_FORCE_IMPACT ? near * radians : 0;
	c->of[SUSTAINED] += riding * radians * own;
	c->of[ROOT] += force == POUND_FORCE_POWER ? near * radians : 0;
	c->of[DASH] += near * means_duration(study) * dashpot_rate(study, pair);
	c->of[REST] += riding;
	c->of[POWER_FORCE] += force == POUND_FORCE_POWER ? riding : 0;
	c->of[STICK] += riding * radians * own * -log(restitution);
}

/* Steps of a run whose highest frequency is `high` [rad/s]. */
static double chain_steps(const struct pound_study *study, double high)
{
	return means_samples(study) + means_duration(study) * high / CHAIN_RADIANS;
}

/* Adds the work near and in contact of all neighbors of a row. */
static struct marches count_chain(const struct pound_study *study, double pounded, const struct storeys *all,
                                  int n, struct counts *c)
{
	struct marches m = {.n = pounded};
	double high = 0;
	for (int b = 0; b < n; b++)
		m.wide += all[b].wide, high = fmax(high, all[b].high);
	m.steps = chain_steps(study, high);
	c->of[BALANCE] += pounded * m.steps * m.wide;
	for (int b = 0; b + 1 < n; b++)
		count_meetings(study, b, &all[b], &m, c);
	return m;
}

static struct storeys storeys_of(const struct pound_building *of, int n)
{
	struct pound_building building = *of;
	struct pound_storeys laid;
	building.storeys = n;
	pound_building_storeys(&building, &laid);
	struct storeys one = {.n = n, .mass = laid.mass[0], .low = laid.frequency};
	one.wide = n + (laid.modal ? MODAL_FLOORS * n * n : 0);
	for (int i = 0; i < n; i++)
		one.high =
		    fmax(one.high, 2 * sqrt(laid.stiffness[i] / laid.mass[i]) + 4 * laid.dashpot[i] / laid.mass[i]);
	return one;
}

static void buildings_of(const struct pound_study *study, struct storeys all[POUND_BUILDINGS_MAX])
{
	for (int b = 0; b < study->scene.n_buildings; b++) {
		const struct pound_building *building = &study->scene.buildings[b];
		const int storeys = building->rigid_wall ? 0 : study_storeys_most(study, b);
		all[b] = storeys ? storeys_of(building, storeys) : (struct storeys){.n = 0};
	}
}

/* A row of buildings by a fixed-step solver or the adaptive one. */
static void count_row_steps(const struct pound_study *study, const struct pound_solver *solver, double items,
                            struct counts *c)
{
	struct storeys all[POUND_BUILDINGS_MAX] = {{0}};
	const double samples = means_samples(study);
	const double pounded = study->scene.contact.present ? items * distinct(study, ALL) : 0;
	double high = 1;
	buildings_of(study, all);
	for (int b = 0; b < study->scene.n_buildings; b++)
		high = fmax(high, all[b].high);
	c->of[GROUND] += items * distinct(study, MOTION) * samples;
	for (int b = 0; b < study->scene.n_buildings; b++) {
		const struct pound_law *law = pound_row_law(&study->scene, b);
		const double yields = law->type == 0 ? 0 : 1 + fmin(law->corrections, SEARCH_MEAN);
		const double alone = items * distinct(study, b) * (1 + yields);
		if (pound_solver_takes_step(solver->method))
			c->of[ROW_STEP] += (alone + pounded) * all[b].wide * samples *
			                   fmax(1, MEAN(study, excitation.time_step, 1) / solver->step);
		else
			c->of[ROW_ADAPT] +=
			    all[b].n * means_duration(study) * (alone * fmax(all[b].high, 1) + pounded * high);
	}
}

/* A row of buildings by the event solver. */
static struct marches count_row(const struct pound_study *study, double items, struct counts *c)
{
	struct storeys all[POUND_BUILDINGS_MAX] = {{0}};
	const int n = study->scene.n_buildings;
	const double samples = means_samples(study);
	const double together = items * distinct(study, ALL),
	             watched = pound_outputs_asked(study) & POUND_ASKS_FREE_PAIR ? together : 0,
	             acting = study->scene.contact.present ? together : 0, pounded = acting + watched;
	buildings_of(study, all);
	const struct marches m = count_chain(study, acting, all, n, c);
	c->of[NEARBY] += watched * m.steps * m.wide;
	c->of[BEGIN] += items * distinct(study, MOTION);
	c->of[GROUND] += items * distinct(study, MOTION) * samples;
	for (int b = 0; b < n; b++) {
		const struct pound_law *law = pound_row_law(&study->scene, b);
		const bool linear = law->type == 0 && !varies(study, offsetof(struct pound_scene, law.type));
		const double yields = linear ? 0 : 1 + fmin(law->corrections, SEARCH_MEAN),
		             alone = items * distinct(study, b);
		const double marches = alone * (1 + yields) + pounded, storeys = all[b].n;
		c->of[BEGIN] += storeys > 0 ? marches : 0;
		c->of[SHAPE] += marches * pow(storeys, 3);
		c->of[CHAIN] += marches * samples * storeys;
		const double steps = alone * chain_steps(study, all[b].high);
		c->of[YIELD_STEP] += (steps * yields + (yields > 0 ? pounded * m.steps : 0)) * all[b].wide;
		c->of[BALANCE] += steps * (1 + yields) * all[b].wide;
	}
	return m;
}

/* The same for two oscillators with a contact that the solver for pairs lacks: they run as a row of two buildings. */
static struct marches count_pair_chain(const struct pound_study *study, double items, struct counts *c)
{
	struct storeys all[POUND_OSCILLATORS];
	const struct bodies bodies = bodies_of(study);
	const double mass[] = {MEAN(study, oscillators[0].mass, 1), MEAN(study, oscillators[1].mass, 1)};
	const double pounded = items * distinct(study, ALL);
	for (int b = 0; b < POUND_OSCILLATORS; b++) {
		const double w = 2 * PI * bodies.hz[b];
		all[b] = (struct storeys){.n = w > 0, .mass = mass[b], .low = w, .high = w, .wide = w > 0};
	}
	c->of[BEGIN] += pounded;
	count_free(study, &bodies, items, c);
	return count_chain(study, pounded, all, POUND_OSCILLATORS, c);
}

bool operations_chained(const struct pound_study *study, const struct pound_solver *solver)
{
	return study->scene.n_buildings > 0 ||
	       (solver->method == POUND_SOLVER_EVENT && study->scene.contact.present &&
	        pound_contact_force(study->scene.contact.model) != POUND_FORCE_LINEAR);
}

/* Adds runs of both oscillators together without contact, if an output needs them. */
static void count_free_pairs(const struct pound_study *study, double items, struct counts *c)
{
	const struct bodies b = bodies_of(study);
	const double pairs = items * distinct(study, ALL), samples = pairs * means_samples(study);
	if (study->scene.n_buildings || !(pound_outputs_asked(study) & POUND_ASKS_FREE_PAIR))
		return;
	const double fastest = 2 * PI * fmax(b.hz[0], b.hz[1]);
	if (b.marches[0] + b.marches[1] > 0 || fastest * MEAN(study, excitation.time_step, 1) > PAIR_MAPPED) {
		c->of[PAIR] += samples;
		c->of[PAIR_TURN] += pairs * means_duration(study) * fastest;
	} else
		c->of[PAIR_MAPS] += samples;
}

/* Adds second runs of two oscillators, as a row, for outputs that only the solver for rows computes. */
static struct marches count_again(const struct pound_study *study, double items, struct counts *c)
{
	const unsigned asked = pound_outputs_asked(study);
	if (study->scene.n_buildings || !(asked & POUND_ASKS_CHAIN))
		return (struct marches){.n = 0};
	return count_pair_chain(study, items * (asked & POUND_ASKS_FREE_FLOORS ? 2 : 1), c);
}

/* Adds all runs; returns those by the solver for rows, if any. */
static struct marches count_runs(const struct pound_study *study, const struct pound_solver *solver,
                                 double items, struct counts *c)
{
	if (study->scene.n_buildings && solver->method == POUND_SOLVER_EVENT)
		return count_row(study, items, c);
	if (study->scene.n_buildings)
		count_row_steps(study, solver, items, c);
	else if (operations_chained(study, solver))
		return count_pair_chain(study, items, c);
	else if (solver->method == POUND_SOLVER_EVENT)
		count_event(study, items, c);
	else
		count_steps(study, solver, items, c);
	return (struct marches){.n = 0};
}

/* Adds floor spectra; m: runs by the solver for rows, none if m->steps is 0. */
static void count_floors(const struct pound_study *study, double runs, const struct marches *m,
                         struct counts *c)
{
	const struct bodies b = m->steps > 0 ? (struct bodies){.near = 0} : bodies_of(study);
	const double radians = 2 * PI * means_duration(study), fast = fmax(b.hz[0], b.hz[1]);
	const double steps = m->steps > 0 ? m->steps : means_samples(study) + radians * fast / FLOOR_RADIANS;
	const double touches = study->scene.contact.present ? runs * radians * b.touching * b.near : 0,
	             rides = study->scene.contact.present
	                         ? runs * radians * fast * b.riding * sqrt(b.ratio) / FLOOR_RADIANS
	                         : 0;
	const int floors = ridden[study->kind].floors, spectra = ridden[study->kind].spectra,
	          n = study->spectrum.n;
	const double near = m->n > 0 ? runs * m->near / m->n : 0;
	c->of[m->steps > 0 ? FOLLOWED : FLOOR] += runs * floors * steps;
	c->of[FOLLOWED_NEAR] += near;
	c->of[PART] += touches;
	c->of[FLOOR_DRIVEN] += rides;
	c->of[ORDINATE] += runs * n * spectra * steps;
	c->of[BOUNCE] += n * (touches + near);
	c->of[SHAKE] += n * rides;
	if (study->kind == POUND_KIND_FLOOR_SPECTRUM)
		c->of[PULSE] += runs * n * study->spectrum.pulses;
}

/* Adds the reductions of a sensitivity study. */
static void count_reductions(const struct pound_study *study, struct counts *c)
{
	const double outputs = (double)study_cells(study) * study->n_outputs,
	             rows = pound_design_rows_most(study);
	const int tiles = (MOMENTS + MOMENTS_INPUT * study->n_inputs + TILE_COLUMNS - 1) / TILE_COLUMNS;
	// no bootstrap for rows in groups: a jackknife leaves out one group at a time; a named estimator is estimated twice, with and
	// without noise correction
	const bool grouped =
	    study->design.until.half_width > 0 || pound_design_quasi_random(study->design.method);
	const double draws = grouped ? 0 : outputs * rows * RESAMPLES * (study->design.estimator ? 3 : 1);
	c->of[DRAW] += draws;
	c->of[TILE] += draws * tiles;
	c->of[FIT] += outputs * rows * pound_design_samples(study);
}

/* Items, with checks and idle lanes counted as further items. */
static double items_of(const struct pound_study *study, bool chained)
{
	const bool sampled = study->kind == POUND_KIND_SENSITIVITY;
	const double items =
	                 (sampled ? pound_design_rows_most(study) : 1) * (double)study->scene.excitation.signals,
	             asks = distinct(study, ALL);
	double checks = 0;
	if (sampled || study->kind == POUND_KIND_FLOOR_SPECTRUM)
		checks = fmax(items / CHECK_EVERY, fmin(items, ceil(CHECKS_LEAST / asks)));
	return items + CHECKED * checks + (chained ? 0 : TAIL / asks);
}

/* Counts the operations of a study.
 *
 * Test     unit_cost: what_is_asked_twice_costs_twice
 */
void operations_count(const struct pound_study *study, struct counts *c)
{
	const double items = items_of(study, operations_chained(study, &study->solver)),
	             alone = items_of(study, true);
	struct marches m = {.n = 0};
	c->of[STUDY] = 1;
	count_free_pairs(study, alone, c);
	// runs repeated for histories: half of their number for pairs (fitted), for rows in proportion to the time compared
	const double seconds = means_duration(study), history = fmin(study->convergence.history, seconds);
	const double repeated = HISTORIES / 2 * (study->scene.n_buildings ? history / seconds : 1);
	// floors of rows with contact are followed by a second run
	const bool followed =
	    study->spectrum.n && study->scene.contact.present && operations_chained(study, &study->solver);
	if (study->kind != POUND_KIND_CONVERGENCE)
		m = count_runs(study, &study->solver, items * (followed ? 2 : 1), c);
	else
		for (int j = 0; j < pound_convergence_trials(study); j++) {
			const struct pound_solver solver = pound_convergence_solver(study, j);
			// twice, for the timing, and once more for each point of a history, up to that point
			count_runs(study, &solver, items * (2 + repeated), c);
			c->of[CLOCK]++;
		}
	const struct marches again = count_again(study, alone, c), *lost = study->scene.n_buildings ? &m : &again;
	// energies need every step: no whole sample interval is passed at once
	if (pound_outputs_asked(study) & POUND_ASKS_ENERGIES)
		c->of[YIELD_STEP] += lost->n * lost->steps * lost->wide;
	if (study->spectrum.n)
		count_floors(study, (double)study_runs(study), &m, c);
	if (study->kind == POUND_KIND_SENSITIVITY)
		count_reductions(study, c);
}

struct pound_run_shared operations_shared(const struct pound_study *study)
{
	const struct bodies b = bodies_of(study);
	struct pound_run_shared shared = {.samples = means_samples(study),
	                                  .motions = distinct(study, MOTION),
	                                  .marches = study->scene.contact.present ? distinct(study, ALL) : 0};
	for (int i = 0; i < POUND_OSCILLATORS; i++)
		shared.marches += b.hz[i] > 0 ? distinct(study, i) * (1 + b.marches[i]) : 0;
	return shared;
}
