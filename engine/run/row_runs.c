/* row_runs.c - the runs that samples of a row of buildings need, without duplicates.
 *
 * 1. Every building alone: linear, then with the yield drifts of its stories found so far.
 * 2. The row with pounding, unless the responses without pounding never close a gap, or all neighbors move identically.
 * 3. Tasks are stored one after another in pools; a task that is bitwise equal to an earlier one is not run again. */
#include "engine/run/row_runs.h"
#include "engine/run/scene.h"

#include <assert.h>
#include <float.h>
#include <math.h>
#include <string.h>

#include "engine/ground/excitation.h"
#include "engine/numeric/hash.h"
#include "engine/scene/building.h"
#include "engine/scene/contact.h"
#include "engine/scene/modes.h"
#include "engine/solver/solver.h"

static const double PI = 3.14159265358979323846;

/* ---- sizes ---- */

/* Scratch of the marches of a scene: the largest over its contact models. */
static size_t march_scratch(const struct pound_scene *scene)
{
	size_t most = pound_chain_scratch(pound_contact_force(scene->contact.model));
	for (int k = 0; k < scene->n_contacts; k++) {
		const size_t own = pound_chain_scratch(pound_contact_force(scene->contacts[k].contact.model));
		most = own > most ? own : most;
	}
	return most;
}

/* Adds the upper bounds of a sample of a scene.
 *
 * Given    outputs_asked   of enum pound_output_ask
 */
void pound_row_size_add(struct pound_row_size *size, const struct pound_scene *scene, unsigned outputs_asked)
{
	const int rows = outputs_asked & POUND_ASKS_FREE_PAIR ? 2 : 1; // marches of all buildings
	const int floors = pound_row_floors(scene), links = pound_row_contacts(scene);
	int before = 0; // floors of all marches without pounding
	for (int b = 0; b < scene->n_buildings; b++) {
		const struct pound_law *law = pound_row_law(scene, b);
		const int marches = pound_law_linear(law->type) ? 1 : 2 + law->corrections,
		          storeys = pound_row_storeys(scene, b);
		before += marches * storeys;
		size->tasks += storeys ? marches : 0;
		size->modal += (marches + rows) * storeys * storeys;
	}
	size->tasks += rows;
	size->floors += before + rows * floors;
	size->links += rows * links;
	size->yields += floors;
	const size_t memory = pound_row_bytes(scene);
	size->memory = memory > size->memory ? memory : size->memory;
	const size_t scratch = march_scratch(scene);
	size->scratch = scratch > size->scratch ? scratch : size->scratch;
	size->storeys = floors > size->storeys ? floors : size->storeys;
	size->contacts = links > size->contacts ? links : size->contacts;
}

/* Adds the upper bounds of two oscillators, with and without contact. */
void pound_row_size_add_pair(struct pound_row_size *size)
{
	size->tasks += 2;
	size->floors += 2 * POUND_OSCILLATORS;
	size->links += 1;
}

void pound_row_clear(struct pound_row_asks *asks)
{
	asks->n = asks->done = asks->n_floors = asks->n_links = asks->n_yields = asks->n_modal = 0;
	memset(asks->modal_known, 0, sizeof asks->modal_known);
	memset(asks->slots, -1, sizeof(int) * (size_t)asks->n_slots);
}

/* ---- tasks ---- */

static bool same_task(const struct pound_row_asks *asks, int j, int motion,
                      const struct pound_chain_task *task)
{
	const struct pound_chain_task *other = &asks->tasks[j];
	return asks->motions[j] == motion && other->n_floors == task->n_floors &&
	       other->n_links == task->n_links && other->asked == task->asked &&
	       memcmp(other->floors, task->floors, sizeof *task->floors * (size_t)task->n_floors) == 0 &&
	       (task->n_links == 0 ||
	        memcmp(other->links, task->links, sizeof *task->links * (size_t)task->n_links) == 0);
}

static_assert(sizeof(struct pound_chain_floor) % sizeof(double) == 0 &&
                  sizeof(struct pound_link) % sizeof(double) == 0,
              "floors and links are read as doubles by the hash");

/* Registers a task stored at the end of the pools; equal tasks share one number.
 *
 * Test     unit_row_results: equal_buildings_never_touch_with_force
 */
static int task_ask(struct pound_row_asks *asks, const struct pound_motion *motion,
                    struct pound_chain_task *task)
{
	const int number = motion->number;
	const int floor_doubles = (int)(sizeof *task->floors / sizeof(double)) * task->n_floors;
	const int link_doubles = (int)(sizeof *task->links / sizeof(double)) * task->n_links;
	int slot = pound_hash_slot((uint64_t)number, (const double *)(const void *)task->floors, floor_doubles,
	                           asks->n_slots);
	slot = pound_hash_slot((uint64_t)slot, (const double *)(const void *)task->links, link_doubles,
	                       asks->n_slots);
	for (; asks->slots[slot] >= 0; slot = (slot + 1) & (asks->n_slots - 1))
		if (same_task(asks, asks->slots[slot], number, task))
			return asks->slots[slot];
	const int j = asks->slots[slot] = asks->n++;
	task->ground = motion->ground;
	task->n_samples = motion->n_samples;
	task->time_step = motion->time_step;
	asks->tasks[j] = *task;
	asks->motions[j] = number;
	asks->results[j] =
	    (struct pound_chain_result){.floors = asks->floor_results + asks->n_floors * POUND_FLOOR_MEASURES,
	                                .links = asks->link_results + asks->n_links * POUND_LINK_MEASURES};
	asks->n_floors += task->n_floors;
	asks->n_links += task->n_links;
	return j;
}

/* Test     unit_losses */
int pound_row_ask_pair(struct pound_row_asks *asks, const struct pound_task *pair,
                       const struct pound_motion *motion, unsigned asked)
{
	struct pound_pair_chain chain;
	pound_pair_chain(pair, &chain);
	struct pound_chain_task task = {.n_floors = chain.task.n_floors,
	                                .n_links = pair->contact,
	                                .floors = asks->floors + asks->n_floors,
	                                .links = asks->links + asks->n_links,
	                                .asked = asked};
	memcpy(asks->floors + asks->n_floors, chain.floors, sizeof *chain.floors * (size_t)task.n_floors);
	if (task.n_links)
		asks->links[asks->n_links] = chain.link;
	return task_ask(asks, motion, &task);
}

/* Largest negligible length [m], in the scale of the ground motion. */
static double negligible(const struct pound_scene *scene)
{
	double most = DBL_MIN;
	for (int b = 0; b < scene->n_buildings; b++) {
		struct pound_storeys storeys;
		if (pound_row_storeys(scene, b) == 0)
			continue;
		pound_building_storeys(&scene->buildings[b], &storeys);
		for (int i = 0; i < storeys.n; i++)
			most = fmax(most, storeys.stiffness[i] / storeys.mass[i]);
	}
	return 0x1p-90 / most;
}

/* The yield drift used in a march, limited to a resolvable range; 1 (arbitrary) for a story that never moves. */
static double yield_marched(double least, double yield)
{
	return yield > 0 ? fmin(fmax(yield, least), 1 / DBL_EPSILON / DBL_EPSILON) : 1;
}

/* The modal damping matrix; reuses the matrix of the last building at this position if both are equal. */
static const double *modal_lay(struct pound_row_asks *asks, const struct pound_building *building, int b,
                               const struct pound_storeys *storeys)
{
	struct pound_modal_known *known = &asks->modal_known[b];
	const double xi = pound_each_of(&building->damping_ratio, 0);
	if (known->matrix && known->damping_ratio == xi && memcmp(&known->storeys, storeys, sizeof *storeys) == 0)
		return known->matrix;
	double *matrix = asks->modal + asks->n_modal;
	asks->n_modal += storeys->n * storeys->n;
	pound_modes_damping(storeys->n, storeys->mass, storeys->stiffness, xi, matrix);
	*known = (struct pound_modal_known){.storeys = *storeys, .damping_ratio = xi, .matrix = matrix};
	return matrix;
}

/* Fills the floors of a building; yields NULL: linear. */
static void building_lay(struct pound_row_asks *asks, const struct pound_scene *scene, int b,
                         const double *yields, struct pound_chain_floor *floors)
{
	const struct pound_law *law = pound_row_law(scene, b);
	const double least = yields ? negligible(scene) : 0;
	struct pound_storeys storeys;
	pound_building_storeys(&scene->buildings[b], &storeys);
	const double *modal = storeys.modal ? modal_lay(asks, &scene->buildings[b], b, &storeys) : NULL;
	memset(floors, 0, sizeof *floors * (size_t)storeys.n); // compared bitwise
	for (int i = 0; i < storeys.n; i++) {
		floors[i].mass = storeys.mass[i];
		floors[i].dashpot = storeys.dashpot[i];
		floors[i].mass_damping = storeys.mass_damping;
		floors[i].base = i == 0;
		floors[i].modal = modal ? modal + i * storeys.n : NULL;
		floors[i].story.law = yields ? law->type : 0;
		floors[i].story.stiffness = storeys.stiffness[i];
		floors[i].story.hardening = yields ? law->hardening_ratio : 0;
		floors[i].story.yield = yields ? yield_marched(least, yields[i]) : 0;
	}
}

static int building_march(struct pound_row_asks *asks, const struct pound_scene *scene, int b,
                          const struct pound_row_ask *ask, const struct pound_motion *motion, bool linear)
{
	struct pound_chain_task task = {.n_floors = pound_row_storeys(scene, b),
	                                .floors = asks->floors + asks->n_floors,
	                                .links = asks->links + asks->n_links,
	                                .asked = ask->asked};
	building_lay(asks, scene, b, linear ? NULL : ask->yields + pound_row_first(scene, b),
	             asks->floors + asks->n_floors);
	return task_ask(asks, motion, &task);
}

/* ---- without pounding ---- */

bool pound_row_takes_solver(const struct pound_study *study, int solver)
{
	return pound_solver_gives_of_rows(solver, pound_row_asked(study));
}

unsigned pound_row_asked(const struct pound_study *study)
{
	const unsigned outputs = pound_outputs_asked(study),
	               asks = study->kind == POUND_KIND_RESPONSE ? ~0U : outputs;
	unsigned asked = POUND_CHAIN_DRIFTS | POUND_CHAIN_DISPLACEMENTS;
	asked |= outputs & POUND_ASKS_ENERGIES ? POUND_CHAIN_ENERGY : 0;
	asked |= asks & POUND_ASKS_ACCELERATIONS ? POUND_CHAIN_ACCELERATIONS : 0;
	return asked | (asks & POUND_ASKS_FORCES ? POUND_CHAIN_FORCES : 0);
}

double pound_row_yield_given(const struct pound_scene *scene, int b, int i)
{
	const struct pound_building *building = &scene->buildings[b];
	if (pound_law_linear(pound_row_law(scene, b)->type))
		return 0;
	if (building->has_law)
		return building->yield_drift.n ? pound_each_of(&building->yield_drift, i) : 0;
	return scene->law.yield_displacement;
}

static bool yields_given(const struct pound_scene *scene, int b)
{
	return pound_row_yield_given(scene, b, 0) > 0;
}

static bool has_place(const struct pound_scene *scene, int b)
{
	int k = 0;
	while (k < scene->n_places && scene->places[k].building != b)
		k++;
	return k < scene->n_places;
}

static bool may_miss(const struct pound_scene *scene)
{
	bool gaps = true;
	for (int k = 0; k < pound_row_contacts(scene) && gaps; k++) {
		struct pound_row_contact contact;
		pound_row_contact_of(scene, k, &contact);
		gaps = contact.contact.gap > 0;
	}
	return gaps;
}

/* Initializes the runs of a sample without pounding. */
void pound_row_ask_free(struct pound_row_asks *asks, const struct pound_scene *scene,
                        struct pound_row_ask *ask, bool response, unsigned asked)
{
	const bool all = response || may_miss(scene);
	struct pound_storeys left;
	pound_building_storeys(&scene->buildings[0], &left);
	*ask = (struct pound_row_ask){
	    .march = -1, .closing = -1, .yields = asks->yields + asks->n_yields, .asked = asked};
	asks->n_yields += pound_row_floors(scene);
	for (int i = 0; i < left.n; i++)
		ask->impulse_scale += left.mass[i];
	ask->impulse_scale *= left.frequency;
	for (int i = 0; i < pound_row_floors(scene); i++)
		ask->yields[i] = 0;
	for (int b = 0; b < scene->n_buildings; b++)
		ask->buildings[b] = (struct pound_building_ask){
		    .march = -1, .wanted = pound_row_storeys(scene, b) > 0 && (all || b == 0 || has_place(scene, b))};
}

int pound_row_stages(const struct pound_scene *scene)
{
	int stages = 1;
	for (int b = 0; b < scene->n_buildings; b++)
		stages = (int)fmax(stages, 2 + pound_row_law(scene, b)->corrections);
	return stages;
}

/* Sets the yield drifts of a building: given, or found from the previous march. */
static void yields_find(const struct pound_row_asks *asks, const struct pound_scene *scene, int b,
                        struct pound_row_ask *ask, int exponent, int stage)
{
	double *yields = ask->yields + pound_row_first(scene, b);
	struct pound_building_ask *building = &ask->buildings[b];
	struct pound_storeys storeys;
	if (yields_given(scene, b)) {
		for (int i = 0; i < pound_row_storeys(scene, b); i++)
			yields[i] = fmax(ldexp(pound_row_yield_given(scene, b, i), -exponent), DBL_MIN);
		return;
	}
	pound_building_storeys(&scene->buildings[b], &storeys);
	const struct pound_chain_result *before = &asks->results[building->march];
	const double over = stage == 1
	                        ? pound_scene_reduction(scene, storeys.frequency / (2 * 3.14159265358979323846),
	                                                pound_row_law(scene, b)->target_demand)
	                        : pound_row_law(scene, b)->target_demand;
	building->status = building->status ? building->status : before->status;
	for (int i = 0; i < storeys.n; i++)
		yields[i] = before->floors[i * POUND_FLOOR_MEASURES + POUND_FLOOR_DRIFT_MAX] / over;
}

/* a stage of a sample's runs */
struct row_stage {
	const struct pound_scene *scene;
	struct pound_row_ask *ask;
	const struct pound_motion *motion;
	int stage;
};

/* Requests a building's march of a stage.
 *
 * Returns  value   false: none is needed
 *          work    counts skipped marches
 */
static bool building_stage(struct pound_row_asks *asks, const struct row_stage *of, int b,
                           struct pound_work *work)
{
	const struct pound_scene *scene = of->scene;
	struct pound_row_ask *ask = of->ask;
	const int stage = of->stage;
	const struct pound_law *law = pound_row_law(scene, b);
	struct pound_building_ask *building = &ask->buildings[b];
	const bool linear = pound_law_linear(law->type), given = yields_given(scene, b);
	const int last = linear ? 0 : given ? 1 : 1 + law->corrections;
	if (stage > last)
		return false;
	if (stage == 0 && !linear && given) {
		work->yield_given++;
		return false;
	}
	if (stage == 0 && linear && !building->wanted) {
		work->linear_unasked++;
		return false;
	}
	if (stage > 0)
		yields_find(asks, scene, b, ask, of->motion->exponent, stage);
	if (stage > 0 && stage == last && !building->wanted) {
		work->nonlinear_unasked++;
		return false;
	}
	building->march = building_march(asks, scene, b, ask, of->motion, stage == 0);
	building->finished = stage == last;
	return true;
}

int pound_row_stage(struct pound_row_asks *asks, const struct pound_scene *scene, struct pound_row_ask *ask,
                    const struct pound_motion *motion, int stage, struct pound_work *work)
{
	int asked = 0;
	for (int b = 0; b < scene->n_buildings; b++)
		if (pound_row_storeys(scene, b) > 0)
			asked += building_stage(asks, &(struct row_stage){scene, ask, motion, stage}, b, work);
	return asked;
}

/* ---- with pounding ---- */

/* The floors below and above a level, as indices in the row, and their weights.
 *
 * Source   the project's design pages, buildings.md 1: the column between two floors is straight and has no mass
 */
static void level_place(const struct pound_scene *scene, int b, double level, int floor[2], double weight[2])
{
	const int upper = (int)ceil(level), first = pound_row_first(scene, b);
	floor[0] = floor[1] = POUND_CHAIN_GROUND;
	weight[1] = pound_row_storeys(scene, b) ? level - (upper - 1) : 1;
	weight[0] = 1 - weight[1];
	if (pound_row_storeys(scene, b) == 0)
		return;
	floor[1] = first + upper - 1;
	floor[0] = upper > 1 ? floor[1] - 1 : POUND_CHAIN_GROUND;
}

/* Initial stiffness of the story of a building at a level; 0 for a wall. */
static double stiffness_at(const struct pound_scene *scene, const struct pound_chain_floor *floors, int b,
                           double level)
{
	if (pound_row_storeys(scene, b) == 0)
		return 0;
	return floors[pound_row_first(scene, b) + (int)ceil(level) - 1].story.stiffness;
}

/* Fills contact k of a row whose floors are filled; its gap is scaled. */
static void link_lay(const struct pound_scene *scene, int k, const struct pound_chain_floor *floors,
                     int exponent, struct pound_link *link)
{
	struct pound_row_contact contact;
	double stiffness = 0, compliance = 0; // larger adjacent stiffness, 1 over the effective mass
	pound_row_contact_of(scene, k, &contact);
	memset(link, 0, sizeof *link);
	for (int side = 0; side < 2; side++) {
		const int b = contact.left_building + side;
		level_place(scene, b, contact.levels[side], link->floor[side], link->weight[side]);
		stiffness = fmax(stiffness, stiffness_at(scene, floors, b, contact.levels[side]));
		for (int w = 0; w < 2; w++)
			if (link->floor[side][w] >= 0)
				compliance +=
				    link->weight[side][w] * link->weight[side][w] / floors[link->floor[side][w]].mass;
	}
	link->law = pound_contact_law(&contact.contact, &(struct pound_contact_place){stiffness, compliance, 1});
	link->gap = ldexp(contact.contact.gap, -exponent);
}

/* Whether the responses without pounding leave a gap open. */
static bool misses(const struct pound_row_asks *asks, const struct pound_scene *scene,
                   const struct pound_row_ask *ask, const struct pound_link *link)
{
	double reach = 0;
	for (int side = 0; side < 2; side++)
		for (int w = 0; w < 2; w++)
			for (int b = 0; b < scene->n_buildings && link->floor[side][w] >= 0; b++) {
				const int i = link->floor[side][w] - pound_row_first(scene, b);
				if (i < 0 || i >= pound_row_storeys(scene, b))
					continue;
				if (!ask->buildings[b].finished)
					return false;
				reach += link->weight[side][w] *
				         asks->results[ask->buildings[b].march]
				             .floors[i * POUND_FLOOR_MEASURES + POUND_FLOOR_DISPLACEMENT_MAX];
			}
	return link->gap > 0 && reach < link->gap;
}

/* Whether two buildings move identically under any ground motion: equal floors, including yield drifts. */
static bool buildings_alike(const struct pound_scene *scene, const struct pound_chain_floor *floors, int a,
                            int b)
{
	const int n = pound_row_storeys(scene, a);
	return n > 0 && n == pound_row_storeys(scene, b) &&
	       memcmp(&floors[pound_row_first(scene, a)], &floors[pound_row_first(scene, b)],
	              sizeof *floors * (size_t)n) == 0;
}

static bool row_alike(const struct pound_scene *scene, const struct pound_chain_floor *floors)
{
	bool alike = true;
	for (int k = 0; k < pound_row_contacts(scene) && alike; k++) {
		struct pound_row_contact contact;
		pound_row_contact_of(scene, k, &contact);
		alike = contact.levels[0] == contact.levels[1] &&
		        buildings_alike(scene, floors, contact.left_building, contact.left_building + 1);
	}
	return alike;
}

/* Fills the floors of all buildings, with the known yield drifts. */
static void row_lay(struct pound_row_asks *asks, const struct pound_scene *scene,
                    const struct pound_row_ask *ask, struct pound_chain_floor *floors)
{
	for (int b = 0; b < scene->n_buildings; b++) {
		const bool linear = pound_law_linear(pound_row_law(scene, b)->type);
		if (pound_row_storeys(scene, b) > 0)
			building_lay(asks, scene, b, linear ? NULL : ask->yields + pound_row_first(scene, b),
			             floors + pound_row_first(scene, b));
	}
}

/* Requests the run of all buildings together without contact.
 *
 * Test     unit_outputs: the_gap_needed_decides_which_signals_pound_in_rows
 */
void pound_row_ask_closing(struct pound_row_asks *asks, const struct pound_scene *scene,
                           struct pound_row_ask *ask, const struct pound_motion *motion)
{
	struct pound_chain_floor *floors = asks->floors + asks->n_floors;
	struct pound_link *links = asks->links + asks->n_links;
	const int n_links = pound_row_contacts(scene);
	if (n_links == 0)
		return;
	row_lay(asks, scene, ask, floors);
	for (int k = 0; k < n_links; k++) {
		link_lay(scene, k, floors, motion->exponent, &links[k]);
		links[k].gap = 0;
	}
	struct pound_chain_task task = {.n_floors = pound_row_floors(scene),
	                                .n_links = n_links,
	                                .floors = floors,
	                                .links = links,
	                                .asked = POUND_CHAIN_DISPLACEMENTS | POUND_CHAIN_CLOSING};
	ask->closing = task_ask(asks, motion, &task);
}

/* Requests the run with pounding, unless the responses without pounding are final. */
void pound_row_ask_pounding(struct pound_row_asks *asks, const struct pound_scene *scene,
                            struct pound_row_ask *ask, const struct pound_motion *motion,
                            struct pound_work *work)
{
	const int n_links = pound_row_contacts(scene);
	struct pound_chain_floor *floors = asks->floors + asks->n_floors;
	struct pound_link *links = asks->links + asks->n_links;
	const double least = negligible(scene);
	bool open = true, all_free = true;
	ask->march = -1;
	if (n_links == 0)
		return;
	row_lay(asks, scene, ask, floors);
	for (int b = 0; b < scene->n_buildings; b++)
		all_free &= pound_row_storeys(scene, b) == 0 || ask->buildings[b].finished;
	if (all_free && row_alike(scene, floors)) {
		work->moving_alike++;
		return;
	}
	for (int k = 0; k < n_links; k++) {
		link_lay(scene, k, floors, motion->exponent, &links[k]);
		links[k].gap = links[k].gap < least ? 0 : links[k].gap;
		open &= misses(asks, scene, ask, &links[k]);
	}
	if (open) {
		work->never_touching++;
		return;
	}
	struct pound_chain_task task = {.n_floors = pound_row_floors(scene),
	                                .n_links = n_links,
	                                .floors = floors,
	                                .links = links,
	                                .asked = ask->asked};
	ask->march = task_ask(asks, motion, &task);
}

enum pound_status pound_row_repeat(struct pound_row_asks *asks, const struct pound_solver *solver, int from,
                                   const atomic_bool *stop)
{
	return pound_solver_rows(solver, &asks->tasks[from], &asks->results[from], asks->n - from, asks->scratch,
	                         stop);
}

enum pound_status pound_row_run(struct pound_row_asks *asks, const struct pound_solver *solver,
                                int checks_end, const atomic_bool *stop)
{
	static const struct pound_solver exact = {.method = POUND_SOLVER_EVENT};
	const int from = asks->done;
	asks->done = asks->n;
	const enum pound_status status = pound_solver_rows(&exact, &asks->tasks[from], &asks->results[from],
	                                                   checks_end - from, asks->scratch, stop);
	return status ? status : pound_row_repeat(asks, solver, checks_end, stop);
}

int64_t pound_row_contacts_run(const struct pound_row_asks *asks, int from)
{
	int64_t n = 0;
	for (int j = from; j < asks->n; j++)
		for (int k = 0; k < asks->tasks[j].n_links; k++)
			n += asks->results[j].status
			         ? 0
			         : (int64_t)asks->results[j].links[k * POUND_LINK_MEASURES + POUND_LINK_CONTACTS];
	return n;
}

/* ---- floors ---- */

static struct pound_floor_of_chain floor_of(const struct pound_row_asks *asks, int march, int floor)
{
	return (struct pound_floor_of_chain){&asks->tasks[march], floor, &asks->results[march]};
}

/* The floor at a place.
 *
 * Test     unit_row_floors
 */
struct pound_row_floor pound_row_floor(const struct pound_row_asks *asks, const struct pound_scene *scene,
                                       const struct pound_row_ask *ask,
                                       const struct pound_storey_place *place)
{
	struct pound_storeys storeys;
	pound_building_storeys(&scene->buildings[place->building], &storeys);
	assert(ask->buildings[place->building].finished);
	struct pound_row_floor floor = {
	    .frequency_hz = storeys.frequency / (2 * PI),
	    .free = floor_of(asks, ask->buildings[place->building].march, place->storey - 1)};
	if (ask->march >= 0)
		floor.pounding =
		    floor_of(asks, ask->march, pound_row_first(scene, place->building) + place->storey - 1);
	return floor;
}
