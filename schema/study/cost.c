/* What a study will take, before any of it is run.
 *
 * Operations are counted as the engine shares them, and each has its seconds.  How often bodies touch, yield and stay together
 * is not known before: it is taken from their frequencies, masses, gap and the peak ground acceleration, as it is in the mean of
 * many scenes.  soak_valid says how near this is, and unit_cost for a part of its studies: rows of buildings and nonlinear
 * contacts scatter more than pairs in linear contact.  Two things are bounded, not predicted: a design that grows counts as grown
 * to its end, and a run that ends as chatter, or fails, as a whole one. */
#include "schema/study/cost.h"

#include <assert.h>
#include <math.h>
#include <stdint.h>

#include "engine/ground/excitation.h"
#include "engine/scene/building.h"
#include "engine/scene/contact.h"
#include "engine/solver/solver.h"
#include "schema/study/fields.h"
#include "schema/study/means.h"
#include "schema/study/study_buildings.h"
#include "schema/study/study_json.h"

enum {
	MIB = 1 << 20,
	HISTORIES = 32,    /* times at which a convergence study compares displacements */
	CHECK_EVERY = 100, /* items between two that are run again to check them, ... */
	CHECKS_LEAST = 8,  /* ... but at least so many runs */
};

static const double PI = 3.14159265358979323846;

/* What is counted.  Whatever may be shared is counted once: a ground motion, a response without pounding, a run. */
enum operation {
	STUDY,      /* the study itself */
	BEGIN,      /* ground motion, response without pounding, or run */
	GROUND,     /* sample of a ground motion */
	FREE,       /* sample of a response without pounding, */
	YIELD,      /* ... of a body that may yield, */
	FLOW,       /* ... and radian that this turns by, in which it yields and returns */
	MARCH,      /* sample of a run with pounding, */
	TOUCH,      /* ... radian in which the bodies are near each other, */
	SWING,      /* ... times the logarithm of the contact's own frequency, */
	POUNDED,    /* ... and radian that a body turns by which may yield */
	TURN,       /* radian of a sample beyond those that go by maps */
	SHAPE,      /* march of a row, by the cube of the storeys of a building, */
	CHAIN,      /* ... sample of a floor, */
	YIELD_STEP, /* ... step of one whose story may yield, */
	NEARBY,     /* ... or of all floors while two buildings are near each other, */
	MEET,       /* ... radian of that, by contact and floor, */
	JUMP,       /* ... if velocities jump there, */
	KEEP,       /* ... and times the logarithm of the contact's own frequency while they may stay together */
	ROOT,       /* the same of two oscillators, of a contact that is a power of its overlap, */
	STICK,      /* ... by the logarithm of the restitution coefficient, */
	DASH,       /* ... and radian of the contact's dashpot, */
	REST,       /* march that begins in contact, */
	BLUNT,      /* ... where the force is a power of the overlap */
	START,      /* sample of a march by another solver, */
	NEWMARK,    /* ... step of one, */
	CENTRAL,    /* ... of the other, */
	ADAPT,      /* ... radian of the adaptive one, by its tolerance, */
	FOLLOW,     /* ... and radian in which the bodies are near each other, by the contact's frequency */
	FLOOR,      /* step of a floor, */
	PART,       /* ... radian in which the bodies are near each other, */
	RIDE,       /* ... and of the contact while they may stay together */
	ORDINATE,   /* the same of an oscillator on it, */
	BOUNCE,
	SHAKE,
	PULSE, /* ... and pulse of an idealized train that it gets */
	DRAW,  /* drawn row of a resample, */
	TILE,  /* ... of a tile of its moments, */
	FIT,   /* and sample that polynomials are fitted to */
	CLOCK, /* trial of a convergence study, which is timed */
	OPERATIONS
};

enum { KINDS = 4 };

/* Seconds of one core for each, by the kind of study: a response study keeps the energy balances of its first signals; its other
 * runs take what those of a sensitivity study do.
 * Fitted to 2,500 valid studies (soak_valid has their distribution) with eight lanes; those of chains to 590. */
static const double seconds_of[OPERATIONS][KINDS] = {
    // response, sensitivity, convergence, floor_spectrum
    [STUDY] = {1e-3, 1e-3, 1e-3, 1e-3},
    [BEGIN] = {2.2e-6, 1.6e-6, 2.2e-5, 1.6e-5},
    [GROUND] = {2.0e-8, 9e-9, 9.8e-8, 2.5e-8},
    [FREE] = {4.2e-8, 9e-10, 2.8e-8, 3.4e-9},
    [YIELD] = {3.6e-8, 2.5e-9, 2.8e-9, 3.4e-10},
    [FLOW] = {1.02e-7, 9.6e-9, 4.2e-8, 1.7e-9},
    [MARCH] = {5.0e-8, 1.7e-9, 5.6e-8, 1.8e-7},
    [TOUCH] = {3.9e-7, 8.4e-8, 2.1e-6, 8e-8},
    [SWING] = {3.4e-8, 2.3e-8, 4.2e-8, 1.5e-7},
    [POUNDED] = {9.4e-8, 5e-9, 6.4e-7, 5.2e-9},
    [TURN] = {3e-7, 3e-7, 3e-7, 3e-7},
    [SHAPE] = {5e-8, 5e-8, 5e-8, 5e-8},
    [CHAIN] = {2.1e-7, 2.1e-7, 2.1e-7, 2.1e-7},
    [YIELD_STEP] = {1.4e-7, 1.4e-7, 1.4e-7, 1.4e-7},
    [NEARBY] = {1.2e-7, 1.2e-7, 1.2e-7, 1.2e-7},
    [MEET] = {9.3e-8, 9.3e-8, 9.3e-8, 9.3e-8},
    [KEEP] = {1.24e-6, 1.24e-6, 1.24e-6, 1.24e-6},
    [STICK] = {5.2e-7, 5.2e-7, 5.2e-7, 5.2e-7},
    [ROOT] = {2.8e-7, 2.8e-7, 2.8e-7, 2.8e-7},
    [JUMP] = {6.2e-7, 6.2e-7, 6.2e-7, 6.2e-7},
    [DASH] = {1.5e-9, 1.5e-9, 1.5e-9, 1.5e-9},
    [REST] = {2.7e-4, 2.7e-4, 2.7e-4, 2.7e-4},
    [BLUNT] = {5e-4, 5e-4, 5e-4, 5e-4},
    [START] = {8e-8, 8e-8, 1.4e-9, 0},
    [NEWMARK] = {2.3e-8, 2.3e-8, 6.3e-10, 0},
    [CENTRAL] = {1.5e-8, 1.5e-8, 6.3e-10, 0},
    [ADAPT] = {8.5e-7, 8.5e-7, 4.5e-8, 0},
    [FOLLOW] = {1.0e-6, 1.0e-6, 6e-7, 0},
    [FLOOR] = {0, 3.9e-8, 0, 3.9e-8},
    [PART] = {0, 1.8e-6, 0, 1.8e-6},
    [RIDE] = {0, 2.1e-8, 0, 2.1e-8},
    [ORDINATE] = {0, 5.6e-9, 0, 5.6e-9},
    [BOUNCE] = {0, 9e-8, 0, 9e-8},
    [SHAKE] = {0, 2.6e-10, 0, 2.6e-10},
    [PULSE] = {0, 0, 0, 6.2e-8},
    [DRAW] = {0, 5e-9, 0, 0},
    [TILE] = {0, 5e-9, 0, 0},
    [FIT] = {0, 1.5e-6, 0, 0},
    [CLOCK] = {0, 0, 0.029, 0},
};

// the step of a solver, in the order of the solvers: event, newmark, central_difference, adaptive
static const enum operation step_of[] = {MARCH, NEWMARK, CENTRAL, ADAPT};

static_assert(sizeof step_of / sizeof step_of[0] == POUND_SOLVERS, "a row for each solver");

struct counts {
	double of[OPERATIONS];
};

/* radians of a sample that go by maps, and with more than which a run ends as chatter */
static const double MAPPED = 2, TURNED_MOST = 5e5;

/* The logarithm of a contact's frequency counts from here: square of it over that of the stiffer body. */
static const double SWINGS = 0.003;

/* runs more whose time the lanes take that are not all filled to the end */
static const double TAIL = 2.7;

/* how much finer checks are than the runs that they check */
static const double CHECKED = 2;

/* How far bodies come towards each other, over the peak ground acceleration and the square of the softer one's frequency; and
 * with what gap they do not stay together any more. */
static const double NEAR = 0.4, RIDING = 0.01;

/* radians of the adaptive solver that take as long as to start again at a sample */
static const double ADAPT_START = 0.55;

/* [rad] of a step of a chain */
static const double CHAIN_RADIANS = 4;

/* floors of a chain that take as long as its step without them, and a part of the square of those that modes damp together */
static const double CHAIN_FLOORS = 8, MODAL_FLOORS = 0.12;

static const double RESTITUTION_LEAST = 1e-3, DASHPOT_MOST = 300;

/* [rad] of a step of a floor */
static const double FLOOR_RADIANS = 1.5;

/* how many floors and spectra a run has: with pounding and without, and the contact's own part */
static const struct {
	int floors, spectra;
} ridden[] = {[POUND_KIND_SENSITIVITY] = {1, 1}, [POUND_KIND_FLOOR_SPECTRUM] = {2, 3}};

enum { RESAMPLES = 2000, MOMENTS = 10, MOMENTS_INPUT = 7, TILE_COLUMNS = 16 };

/* Corrections that a search takes where it may, in the mean. */
static const double SEARCH_MEAN = 6;

/* [bytes] in a result: of an index or of a signal, with its name and all members beside it */
static const double INDEX_BYTES = 2000, SIGNAL_BYTES = 900, NUMBER_BYTES = 20, MEASURE_BYTES = 45,
                    DOCUMENT_BYTES = 3000;

/* [bytes] of memory for a study, for a number of its document, and for a byte of its result, which is text that grows by doubling
 * and is then put into the database */
static const double STUDY_MEMORY = 1.5 * MIB, NUMBER_MEMORY = 100, RESULT_MEMORY = 2;

/* Memory of the records that a study has: those that its document holds pass through a tree of their numbers. */
static double record_memory(const struct pound_study *study)
{
	const struct pound_excitation *e = &study->scene.excitation;
	double bytes = NUMBER_MEMORY * e->n_record;
	for (int k = 0; k < e->n_records; k++)
		bytes += e->records[k].n * NUMBER_MEMORY;
	return bytes;
}

/* What a part of the scene's members may be part of. */
static bool of_motion(size_t offset)
{
	const size_t first = offsetof(struct pound_scene, excitation);
	return offset >= first && offset < first + sizeof(struct pound_excitation);
}

static size_t law_offset(const struct pound_study *study, int body)
{
	return (size_t)((const char *)pound_scene_law(&study->scene, body) - (const char *)&study->scene);
}

/* Whether a response without pounding depends on a member: all of its body but the mass. */
static bool of_body(const struct pound_study *study, int body, size_t offset)
{
	const size_t first = offsetof(struct pound_scene, oscillators) +
	                     (size_t)body * sizeof(struct pound_oscillator),
	             law = law_offset(study, body);
	return of_motion(offset) || (offset >= law && offset < law + sizeof(struct pound_law)) ||
	       (offset >= first && offset < first + sizeof(struct pound_oscillator) &&
	        offset != first + offsetof(struct pound_oscillator, mass));
}

/* Whether a response of a building of a row without pounding does. */
static bool of_building(int building, struct pound_field field)
{
	const size_t at = means_offset(field), law = offsetof(struct pound_scene, law);
	return of_motion(at) || (at >= law && at < law + sizeof(struct pound_law)) ||
	       (field.part == POUND_PART_BUILDINGS &&
	        field.offset / sizeof(struct pound_building) == (size_t)building);
}

enum { ALL = -2, MOTION = -1 /* or a body, or a building of a row */ };

/* Whether a part of what an item has depends on a member that varies. */
static bool depends(const struct pound_study *study, int what, struct pound_field field)
{
	return what == ALL                ? true
	       : what == MOTION           ? of_motion(means_offset(field))
	       : study->scene.n_buildings ? of_building(what, field)
	                                  : of_body(study, what, means_offset(field));
}

/* How many of an item's ground motions, or responses of a body, differ from each other: it has samples in all cells. */
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
	// A, B, and A with each column of B that matters, which is B where there is one alone; with interactions B with those of A, too,
	// which are the same where there are two
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

/* A building of a chain in the mean; one of two oscillators is of one storey. */
struct storeys {
	int n;       /* 0: a wall */
	double mass; /* of a floor, of whatever unit */
	double low;  /* [rad/s] of the first mode */
	double high; /* ... of the last one, with what dashpots add to it */
	double wide; /* floors that a step takes as long for: more than n where the rates of all damp every one */
};

/* How fast two neighbors may come back to each other: by the faster, and by the lighter one. */
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

/* What is known of the bodies in the mean. */
struct bodies {
	double hz[POUND_OSCILLATORS];      /* 0: a wall */
	double marches[POUND_OSCILLATORS]; /* of one that may yield, for its demand, 0: of one that does not */
	double near;                       /* part of the time in which they may touch */
	double riding;                     /* ... and in which they may stay together */
	double ratio;                      /* largest square of the contact's frequency over the faster one's */
	double
	    touching; /* [Hz] how fast they may come back to each other: by the faster, and by the lighter one */
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

/* Radians of a sample that oscillators turn by, beyond those that go by maps. */
static double turned(const struct bodies *b, double time_step)
{
	double sum = 0;
	for (int i = 0; i < POUND_OSCILLATORS; i++)
		sum += fmax(0, 2 * PI * b->hz[i] * time_step - MAPPED);
	return fmin(sum, TURNED_MOST);
}

/* Adds what so many items take by the event-driven solver before and without pounding. */
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

/* Adds what so many items take by the event-driven solver. */
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

/* The same by a solver of a fixed step, or the adaptive one, which run one thing at a time. */
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
		// a sample starts a step as half a radian does
		c->of[ADAPT] += turns * pow(solver->tolerance, -1. / 12) + ADAPT_START * marches * samples;
		c->of[FOLLOW] += pounded * b.near * radians * b.touching * pow(b.ratio, 0.25);
		c->of[TURN] += pounded * samples * turned(&b, MEAN(study, excitation.time_step, 1));
	}
}

/* [rad/s] at which a contact's dashpot acts, in the mean. */
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

/* of a chain with pounding */
struct marches {
	double n, steps; /* of each */
	double wide;     /* of the chain, in floors */
};

/* Adds what a building and its right neighbor take where they meet. */
static void count_meetings(const struct pound_study *study, int building, const struct storeys pair[static 2],
                           const struct marches *m, struct counts *c)
{
	const int links = links_of(study, building, pair);
	const double asked = MEAN(study, excitation.peak, 1), peak = asked > 0 ? asked : 1;
	const double restitution = fmax(MEAN(study, contact.restitution, 1), RESTITUTION_LEAST);
	const bool wall = pair[1].n == 0;
	const double soft = wall ? pair[0].low : fmin(pair[0].low, pair[1].low);
	const double reach = MEAN(study, contact.gap, 1) * soft * soft / peak;
	const double met = links ? m->n : 0, near = met / (1 + reach / NEAR), riding = met / (1 + reach / RIDING);
	const double radians = means_duration(study) * touching(pair) * links * (CHAIN_FLOORS + m->wide);
	const double own = log1p(SWINGS * MEAN(study, contact.stiffness_ratio, 1) * masses(pair));
	const enum pound_force force = pound_contact_force(study->scene.contact.model);
	c->of[NEARBY] += near * m->steps * m->wide;
	c->of[MEET] += near * radians;
	c->of[JUMP] += force == POUND_FORCE_IMPACT ? near * radians : 0;
	if (study->scene.n_buildings) {
		c->of[KEEP] += riding * radians * own;
		return;
	}
	c->of[ROOT] += force == POUND_FORCE_POWER ? near * radians : 0;
	c->of[DASH] += near * means_duration(study) * dashpot_rate(study, pair);
	c->of[REST] += riding;
	c->of[BLUNT] += force == POUND_FORCE_POWER ? riding : 0;
	c->of[STICK] += riding * radians * own * -log(restitution);
}

/* Adds where the neighbors of a chain meet; returns the steps of a march. */
static double count_chain(const struct pound_study *study, double pounded, const struct storeys *all, int n,
                          struct counts *c)
{
	struct marches m = {.n = pounded};
	double high = 0;
	for (int b = 0; b < n; b++)
		m.wide += all[b].wide, high = fmax(high, all[b].high);
	m.steps = means_samples(study) + means_duration(study) * high / CHAIN_RADIANS;
	for (int b = 0; b + 1 < n; b++)
		count_meetings(study, b, &all[b], &m, c);
	return m.steps;
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

/* The same of a row of buildings. */
static void count_row(const struct pound_study *study, double items, struct counts *c)
{
	struct storeys all[POUND_BUILDINGS_MAX] = {{0}};
	const int n = study->scene.n_buildings;
	const double samples = means_samples(study);
	const double pounded = study->scene.contact.present ? items * distinct(study, ALL) : 0;
	for (int b = 0; b < n; b++) {
		const struct pound_building *building = &study->scene.buildings[b];
		const int storeys = building->rigid_wall ? 0 : study_storeys_most(study, b);
		all[b] = storeys ? storeys_of(building, storeys) : (struct storeys){.n = 0};
	}
	const double steps = count_chain(study, pounded, all, n, c);
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
		const double flows =
		    alone * yields * (samples + means_duration(study) * all[b].high / CHAIN_RADIANS) +
		    (yields > 0 ? pounded * steps : 0);
		c->of[YIELD_STEP] += flows * all[b].wide;
	}
}

/* The same of two oscillators whose contact the march of pairs does not have. */
static void count_pair_chain(const struct pound_study *study, double items, struct counts *c)
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
	count_chain(study, pounded, all, POUND_OSCILLATORS, c);
}

static void count_runs(const struct pound_study *study, const struct pound_solver *solver, double items,
                       struct counts *c)
{
	if (study->scene.n_buildings)
		count_row(study, items, c);
	else if (solver->method == POUND_SOLVER_EVENT && study->scene.contact.present &&
	         pound_contact_force(study->scene.contact.model) != POUND_FORCE_LINEAR)
		count_pair_chain(study, items, c);
	else if (solver->method == POUND_SOLVER_EVENT)
		count_event(study, items, c);
	else
		count_steps(study, solver, items, c);
}

/* Adds what spectra of floors take. */
static void count_floors(const struct pound_study *study, double runs, struct counts *c)
{
	const struct bodies b = study->scene.n_buildings ? (struct bodies){.near = 0} : bodies_of(study);
	const double radians = 2 * PI * means_duration(study), fast = fmax(b.hz[0], b.hz[1]);
	const double steps = means_samples(study) + radians * fast / FLOOR_RADIANS;
	const double touches = study->scene.contact.present ? runs * radians * b.touching * b.near : 0,
	             rides = study->scene.contact.present
	                         ? runs * radians * fast * b.riding * sqrt(b.ratio) / FLOOR_RADIANS
	                         : 0;
	const int floors = ridden[study->kind].floors, spectra = ridden[study->kind].spectra,
	          n = study->spectrum.n;
	c->of[FLOOR] += runs * floors * steps;
	c->of[PART] += touches;
	c->of[RIDE] += rides;
	c->of[ORDINATE] += runs * n * spectra * steps;
	c->of[BOUNCE] += n * touches;
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
	// where rows come in groups, these are left out one by one instead
	const bool grouped =
	    study->design.until.half_width > 0 || pound_design_quasi_random(study->design.method);
	const double draws =
	    grouped ? 0 : outputs * rows * RESAMPLES * (study->design.estimator ? 3 : 1); // the one named twice
	c->of[DRAW] += draws;
	c->of[TILE] += draws * tiles;
	c->of[FIT] += outputs * rows * pound_design_samples(study);
}

/* Items and, counted as such, those that are run again to check them and what lanes leave unfilled. */
static double items_of(const struct pound_study *study)
{
	const bool sampled = study->kind == POUND_KIND_SENSITIVITY;
	const double items =
	                 (sampled ? pound_design_rows_most(study) : 1) * (double)study->scene.excitation.signals,
	             asks = distinct(study, ALL);
	double checks = 0;
	if (sampled || study->kind == POUND_KIND_FLOOR_SPECTRUM)
		checks = fmax(items / CHECK_EVERY, fmin(items, ceil(CHECKS_LEAST / asks)));
	return items + CHECKED * checks + TAIL / asks;
}

static void count(const struct pound_study *study, struct counts *c)
{
	const double items = items_of(study);
	c->of[STUDY] = 1;
	if (study->kind != POUND_KIND_CONVERGENCE)
		count_runs(study, &study->solver, items * (study->spectrum.n && study->scene.n_buildings ? 2 : 1), c);
	else
		for (int j = 0; j < pound_convergence_trials(study); j++) {
			const struct pound_solver solver = pound_convergence_solver(study, j);
			// twice, to be timed, and for each point of a history up to that
			count_runs(study, &solver, items * (2 + HISTORIES / 2), c);
			c->of[CLOCK]++;
		}
	if (study->spectrum.n)
		count_floors(study, (double)study_runs(study), c);
	if (study->kind == POUND_KIND_SENSITIVITY)
		count_reductions(study, c);
}

/* What an item has of which nothing is run twice, as it is counted above. */
static struct pound_run_shared shared_of(const struct pound_study *study)
{
	const struct bodies b = bodies_of(study);
	struct pound_run_shared shared = {.samples = means_samples(study),
	                                  .motions = distinct(study, MOTION),
	                                  .marches = study->scene.contact.present ? distinct(study, ALL) : 0};
	for (int i = 0; i < POUND_OSCILLATORS; i++)
		shared.marches += b.hz[i] > 0 ? distinct(study, i) * (1 + b.marches[i]) : 0;
	return shared;
}

/* What a study will take.
 *
 * Given    asked       valid
 *          n_workers   that run its blocks, each in work space of its own
 * Returns  value       runs exactly; time, bytes and memory as above
 * Test     unit_cost: what_is_asked_twice_costs_twice; soak_cost: an_estimate_is_near_what_a_study_takes
 */
struct cost cost_of(const struct pound_study *asked, int n_workers)
{
	const struct pound_study like = study_separation_like(asked), *study = &like;
	struct cost cost = {.runs = study_runs(study), .bytes = DOCUMENT_BYTES + study_separation_bytes(asked)};
	struct counts counts = {0};
	double cells = study_cells(study), runs = (double)cost.runs, numbers; // doubles that are stored of a run
	count(study, &counts);
	const bool response = study->kind == POUND_KIND_RESPONSE;
	const double signals = fmax(study->scene.excitation.signals, 1),
	             balanced = !response           ? 1
	                        : study->unbalanced ? 0
	                                            : fmin(POUND_BALANCED_SIGNALS / signals, 1);
	const enum pound_kind other = response ? POUND_KIND_SENSITIVITY : study->kind;
	for (int k = 0; k < OPERATIONS; k++)
		cost.cpu_s +=
		    counts.of[k] * (balanced * seconds_of[k][study->kind] + (1 - balanced) * seconds_of[k][other]);
	if (study->kind == POUND_KIND_SENSITIVITY) {
		numbers = 2 * study->n_outputs;
		cost.bytes += cells * study->n_outputs * (study->n_inputs + 1) * INDEX_BYTES;
	} else {
		const double of_row = study->scene.n_buildings ? pound_row_measures(study) : 0;
		numbers =
		    of_row > 0 ? of_row : sizeof(struct pound_response) / sizeof(double) + 6 * study->spectrum.n;
		cost.bytes +=
		    runs * (SIGNAL_BYTES + of_row * MEASURE_BYTES) + cells * 20 * study->spectrum.n * NUMBER_BYTES;
	}
	const struct pound_run_shared shared = shared_of(study);
	cost.memory = STUDY_MEMORY + record_memory(study) + RESULT_MEMORY * cost.bytes +
	              pound_run_bytes(asked, n_workers, &shared);
	cost.bytes += runs * numbers * sizeof(double);
	return cost;
}
