/* plan.c - runs the items of a block, each needed thing once.
 *
 * 1. every sample of every cell asks for its ground motion, its responses without pounding and its run with pounding;
 * 2. what is asked is written down as a key of numbers, equal keys are one motion or one march;
 * 3. motions are filled, then marches run stage by stage: linear responses, nonlinear ones with the yield
 *    displacement found from the stages before, last the runs with pounding.
 *
 * The check of an item is all this once more on ground motions with a sample between every two: the same signal, as it
 * is linear between samples, in other steps with other maps, series and root searches. */
#include "engine/run/plan.h"

#include <assert.h>
#include <float.h>
#include <math.h>
#include <string.h>

#include "engine/ground/excitation.h"
#include "engine/numeric/hash.h"
#include "engine/numeric/random.h"
#include "engine/run/demand.h"
#include "engine/run/outputs.h"
#include "engine/run/scene.h"
#include "engine/solver/solver.h"

enum {
	KEY = 20,       /* doubles of a key, both of a motion and of a march */
	SEARCH_MIN = 2, /* corrections from which on they are those of a search */
};

/* equal keys have one number, in the order they were first asked */
struct register_ {
	int n, n_slots;
	double *keys; /* (capacity x KEY) */
	int *slots;   /* (n_slots), -1: empty */
};

struct motion {
	struct pound_excitation excitation;
	struct pound_stream noise;
	bool halved; /* a sample between every two */
	int n_samples;
	double time_step; /* [s] */
	int exponent;     /* samples are kept times 2^-exponent, so that the largest is in [1, 2) */
	double *ground;   /* (n_samples) */
};

/* what is known of one body without pounding */
struct body_ask {
	int march;                /* the last one asked, -1: none */
	double yield;             /* [m] scaled; 0: the law has none, or the body never moves */
	enum pound_status status; /* of the marches its yield displacement comes from */
	bool wanted;   /* its response without pounding is needed, beyond finding its yield displacement */
	bool finished; /* the last march is that response */
	bool found;    /* the search for the target demand is over */
	struct pound_demand demand;
};

struct ask {
	struct pound_scene scene;
	int motion;
	bool response; /* all of the response is wanted */
	struct body_ask bodies[POUND_OSCILLATORS];
	int march; /* with pounding; -1: the responses without pounding are the answer */
};

struct pound_plan {
	struct pound_plan_size size;
	struct register_ motion_keys, march_keys;
	struct motion *motions;             /* (motions) */
	double *ground;                     /* (samples) */
	struct ask *asks;                   /* (asks) */
	struct pound_march_task *tasks;     /* (tasks) */
	struct pound_march_result *results; /* (tasks) */
	void *scratch;                      /* of the march */
	int n_before;                       /* marches without pounding, they are the first */
	int n_asks, n_items;                /* of the last run; n_items without those of checks */
};

/* ---- work space ---- */

/* Carves a plan out of memory, or with memory NULL only counts the bytes. */
static size_t plan_carve(char *memory, struct pound_plan *plan, struct pound_plan_size size)
{
	const struct {
		void *into;
		size_t bytes;
	} parts[] = {
	    {&plan->motion_keys.keys, sizeof(double) * KEY * (size_t)size.motions},
	    {&plan->march_keys.keys, sizeof(double) * KEY * (size_t)size.tasks},
	    {&plan->motion_keys.slots, sizeof(int) * (size_t)pound_hash_slots(size.motions)},
	    {&plan->march_keys.slots, sizeof(int) * (size_t)pound_hash_slots(size.tasks)},
	    {&plan->motions, sizeof *plan->motions * (size_t)size.motions},
	    {&plan->ground, sizeof(double) * (size_t)size.samples},
	    {&plan->asks, sizeof *plan->asks * (size_t)size.asks},
	    {&plan->tasks, sizeof *plan->tasks * (size_t)size.tasks},
	    {&plan->results, sizeof *plan->results * (size_t)size.tasks},
	    {&plan->scratch, POUND_MARCH_SCRATCH},
	};
	size_t at = (sizeof *plan + 63) / 64 * 64;
	for (size_t j = 0; j < sizeof parts / sizeof parts[0]; j++) {
		if (memory)
			*(void **)parts[j].into = memory + at;
		at += (parts[j].bytes + 63) / 64 * 64;
	}
	return at;
}

/* Bytes of a plan's work space, to be 64-byte aligned. */
size_t pound_plan_bytes(struct pound_plan_size size)
{
	struct pound_plan plan;
	return plan_carve(NULL, &plan, size);
}

struct pound_plan *pound_plan_init(void *memory, struct pound_plan_size size)
{
	struct pound_plan *plan = memory;
	memset(plan, 0, sizeof *plan);
	plan_carve(memory, plan, size);
	plan->size = size;
	plan->motion_keys.n_slots = pound_hash_slots(size.motions);
	plan->march_keys.n_slots = pound_hash_slots(size.tasks);
	return plan;
}

/* Upper bounds for the items of one row: whatever may differ between its samples counts as different. */
struct pound_plan_size pound_plan_size(const struct pound_campaign *campaign, int row)
{
	struct pound_plan_size size = {0};
	for (int cell = 0; cell < campaign->n_cells; cell++)
		for (int sample = 0; sample < campaign->n_samples; sample++) {
			struct pound_scene scene = pound_campaign_scene(campaign, cell, row, sample);
			int marches = 1;
			for (int i = 0; i < POUND_OSCILLATORS; i++)
				marches += 2 + pound_scene_law(&scene, i)->corrections;
			size.asks++;
			size.motions++;
			size.tasks += marches;
			size.samples += pound_excitation_samples(&scene.excitation);
		}
	return size;
}

/* ---- keys ---- */

static void register_clear(struct register_ *r)
{
	r->n = 0;
	memset(r->slots, -1, sizeof(int) * (size_t)r->n_slots);
}

/* Number of a key; a new one gets the next number. */
static int register_key(struct register_ *r, const double key[static KEY])
{
	int slot = pound_hash_slot(0, key, KEY, r->n_slots);
	for (; r->slots[slot] >= 0; slot = (slot + 1) & (r->n_slots - 1))
		if (memcmp(&r->keys[KEY * r->slots[slot]], key, sizeof(double) * KEY) == 0)
			return r->slots[slot];
	memcpy(&r->keys[KEY * r->n], key, sizeof(double) * KEY);
	return r->slots[slot] = r->n++;
}

/* The ground motion of a sample: its excitation, and the noise of its row and signal, if it has any. */
static int motion_ask(struct pound_plan *plan, const struct pound_excitation *e, struct pound_stream noise,
                      bool halved)
{
	if (!pound_excitation_random(e))
		noise = (struct pound_stream){0};
	const double key[KEY] = {
	    e->type, e->frequency_hz, e->damping_ratio, e->high_pass_ratio, e->cycles,    e->duration,  e->rise,
	    e->fall, e->time_step,    e->peak,          noise.row,          noise.sample, noise.signal, halved};
	int known = plan->motion_keys.n;
	int j = register_key(&plan->motion_keys, key);
	if (j == known)
		plan->motions[j] = (struct motion){.excitation = *e, .noise = noise, .halved = halved};
	return j;
}

/* A march; bodies and contact are set, the ground motion is added here. */
static int march_ask(struct pound_plan *plan, int motion, struct pound_march_task *task)
{
	const struct motion *m = &plan->motions[motion];
	double key[KEY] = {
	    motion,           task->contact, task->gap, task->contact_stiffness, task->contact_damping,
	    task->mass_ratio, task->tension};
	for (int i = 0; i < POUND_OSCILLATORS; i++) {
		const struct pound_march_body *b = &task->bodies[i];
		double *k = &key[7 + 6 * i];
		k[0] = b->skeleton.law, k[1] = b->skeleton.stiffness, k[2] = b->skeleton.hardening,
		k[3] = b->skeleton.yield;
		k[4] = b->damping, k[5] = b->drive;
	}
	int known = plan->march_keys.n;
	int j = register_key(&plan->march_keys, key);
	if (j == known) {
		plan->tasks[j] = *task;
		plan->tasks[j].ground = m->ground;
		plan->tasks[j].n_samples = m->n_samples;
		plan->tasks[j].time_step = m->time_step;
	}
	return j;
}

/* ---- stages ---- */

/* Puts the mean of every two samples between them. */
static void motion_halve(struct motion *m)
{
	double *g = m->ground;
	for (int t = m->n_samples - 1; t > 0; t--) {
		double middle = 0.5 * (g[t - 1] + g[t]);
		g[2 * t] = g[t];
		g[2 * t - 1] = middle;
	}
	m->n_samples = 2 * m->n_samples - 1;
	m->time_step *= 0.5;
}

/* Whether every force of the asked scenes scales with the motion: then scaling a ground motion by a power of two changes no digit
 * of any response. */
static bool forces_scale(const struct pound_plan *plan)
{
	bool scale = true;
	for (int a = 0; a < plan->n_asks && scale; a++) {
		const struct pound_contact *contact = &plan->asks[a].scene.contact;
		scale = !contact->present || pound_force_scales(pound_contact_force(contact->model));
	}
	return scale;
}

/* Fills the ground motions and, if `scaled`, scales each by a power of two. */
static void motions_fill(struct pound_plan *plan, bool scaled)
{
	double *ground = plan->ground;
	struct pound_signal signals[POUND_SIGNALS_MAX];
	for (int j = 0, waiting = 0; j < plan->motion_keys.n; j++) {
		struct motion *m = &plan->motions[j];
		m->n_samples = pound_excitation_samples(&m->excitation);
		m->time_step = m->excitation.time_step;
		m->ground = ground;
		ground += m->halved ? 2 * m->n_samples - 1 : m->n_samples;
		assert(ground - plan->ground <= plan->size.samples);
		signals[waiting++] = (struct pound_signal){&m->excitation, m->noise, m->ground};
		if (waiting == POUND_SIGNALS_MAX || j == plan->motion_keys.n - 1) {
			pound_signals_fill(signals, waiting);
			waiting = 0;
		}
	}
	for (int j = 0; j < plan->motion_keys.n; j++) {
		struct motion *m = &plan->motions[j];
		if (m->halved)
			motion_halve(m);
		const double peak = pound_excitation_largest(m->n_samples, m->ground);
		m->exponent = scaled && peak > 0 ? ilogb(peak) : 0;
		// in two factors, as that of a peak below the normal numbers is beyond the largest one
		const int first = -m->exponent < DBL_MAX_EXP ? -m->exponent : DBL_MAX_EXP - 1;
		const double factor = ldexp(1, first), rest = ldexp(1, -m->exponent - first);
		for (int t = 0; t < m->n_samples && m->exponent != 0; t++)
			m->ground[t] = m->ground[t] * factor * rest;
	}
}

/* Whether the exact solver can check tasks [from, end): else the study's own solver does, on half the sample step. */
static bool exact_takes(const struct pound_plan *plan, int from, int end)
{
	bool takes = true;
	for (int j = from; j < end && takes; j++)
		takes = !plan->tasks[j].contact || pound_solver_takes_force(POUND_SOLVER_EVENT, plan->tasks[j].force);
	return takes;
}

/* Runs the marches asked since the stage before.  The first ones are those of the checks, which the exact solver runs where
 * it can, whatever the study's solver. */
static enum pound_status marches_run(struct pound_plan *plan, const struct pound_solver *solver,
                                     int checks_end, int *done, const atomic_bool *stop)
{
	static const struct pound_solver exact = {.method = POUND_SOLVER_EVENT};
	int from = *done, n = plan->march_keys.n;
	assert(n <= plan->size.tasks);
	const struct pound_solver *checks = exact_takes(plan, from, checks_end) ? &exact : solver;
	// one call for both where it can be, as it fills the lanes better
	int cut = solver->method == checks->method ? n : checks_end;
	*done = n;
	enum pound_status status =
	    pound_solver_run(checks, &plan->tasks[from], &plan->results[from], cut - from, plan->scratch, stop);
	return status ? status
	              : pound_solver_run(solver, &plan->tasks[cut], &plan->results[cut], n - cut, plan->scratch,
	                                 stop);
}

/* Longest length that is nothing beside the motion [m], scaled as the ground motion is.
 *
 * 2^-90 of what a ground acceleration of one moves a body in a sample: it is crossed in 2^-45 of a step or more, which
 * a search for events still resolves; a shorter one would be crossed within a step's rounding.
 */
static double negligible(const struct pound_plan *plan, const struct ask *ask)
{
	double h = plan->motions[ask->motion].excitation.time_step, least = h * h;
	for (int i = 0; i < POUND_OSCILLATORS; i++)
		least = fmin(least, 1 / fmax(pound_scene_body(&ask->scene, i).skeleton.stiffness, DBL_MIN));
	return 0x1p-90 * least;
}

/* The yield displacement a march follows; any will do for a body that never moves. */
static double yield_marched(const struct pound_plan *plan, const struct ask *ask, double yield)
{
	return yield > 0 ? fmin(fmax(yield, negligible(plan, ask)), 1 / DBL_EPSILON / DBL_EPSILON) : 1;
}

static int body_march(struct pound_plan *plan, const struct ask *ask, int i, int law, double yield)
{
	struct pound_march_task task = {.bodies = {pound_scene_body(&ask->scene, i)}};
	task.bodies[0].followed = true;
	task.accounted = ask->response;
	task.bodies[0].skeleton.law = law;
	task.bodies[0].skeleton.yield = yield;
	if (pound_pieces_linear(law))
		task.bodies[0].skeleton.hardening = 0;
	return march_ask(plan, ask->motion, &task);
}

/* Reduction of the elastic displacement that gives the wanted demand, by the ratio of excitation to own frequency.
 *
 *   q_y = mu_d where f_e/f >= 1/6, else 1 + (mu_d - 1) 6 f_e/f
 *
 * Source   model.md 3; the paper, Figure 3
 */
static double reduction(const struct pound_scene *scene, int i, double demand)
{
	double f_e = pound_excitation_frequency(&scene->excitation);
	double rise = f_e > 0 ? 6 * f_e / scene->oscillators[i].frequency_hz : 1;
	return 1 + (demand - 1) * fmin(rise, 1);
}

static bool searched(const struct pound_law *law)
{
	return !pound_pieces_linear(law->type) && !(law->yield_displacement > 0) &&
	       law->corrections >= SEARCH_MIN;
}

/* Asks for the next march of a search for the target demand, behind the one with the reduced elastic displacement.
 *
 * Returns  value   false: none is needed; the march that came nearest to it is the response
 *          work    how the search ended
 */
static bool search_stage(struct pound_plan *plan, const struct ask *ask, struct body_ask *body, int i,
                         int stage, struct pound_work *work)
{
	const struct pound_law *law = pound_scene_law(&ask->scene, i);
	const struct pound_march_result *before = &plan->results[body->march];
	if (body->found)
		return false;
	body->status = body->status ? body->status : before->status;
	body->found = true;
	body->finished = body->wanted;
	if (body->status || !(body->yield > 0))
		return false; // there is no demand
	const double share = before->displacement_max[0] / body->yield / law->target_demand;
	double next;
	bool more = pound_demand_next(&body->demand, body->march, body->yield, share, &next);
	if (more && stage <= 1 + law->corrections) {
		body->found = body->finished = false;
		body->yield = next;
		body->march = body_march(plan, ask, i, law->type, yield_marched(plan, ask, next));
		return true;
	}
	body->march = body->demand.response;
	body->yield = body->demand.yield;
	bool reached = pound_demand_reached(&body->demand);
	work->yield_searches++;
	work->yield_jumps += !reached && !more;
	work->yield_missed += !reached && more;
	return false;
}

/* Asks for a body's march of a stage: stage 0 is linear, stage k >= 1 has the yield displacement found by then.
 *
 * Returns  value   false: none is needed
 *          work    what was left out is counted
 */
static bool body_stage(struct pound_plan *plan, const struct ask *ask, struct body_ask *body, int i,
                       int stage, struct pound_work *work)
{
	const struct pound_law *law = pound_scene_law(&ask->scene, i);
	bool linear = pound_pieces_linear(law->type);
	bool given = law->yield_displacement > 0;
	int last_stage = linear ? 0 : given ? 1 : 1 + law->corrections;
	if (stage > 1 && searched(law))
		return search_stage(plan, ask, body, i, stage, work);
	if (stage > last_stage)
		return false;
	if (stage == 0 && !linear && given) {
		work->yield_given++;
		return false;
	}
	if (stage == 0 && linear && !body->wanted) {
		work->linear_unasked++;
		return false;
	}
	if (stage == 0)
		body->march = body_march(plan, ask, i, 0, 0);
	else {
		const struct pound_march_result *before = given ? NULL : &plan->results[body->march];
		if (given) {
			body->yield = fmax(ldexp(law->yield_displacement, -plan->motions[ask->motion].exponent), DBL_MIN);
		} else {
			body->status = body->status ? body->status : before->status;
			body->yield = before->displacement_max[0] /
			              (stage == 1 ? reduction(&ask->scene, i, law->target_demand) : law->target_demand);
		}
		if (stage == last_stage && !body->wanted) {
			work->nonlinear_unasked++;
			return false;
		}
		body->march = body_march(plan, ask, i, law->type, yield_marched(plan, ask, body->yield));
	}
	body->finished = stage == last_stage;
	return true;
}

/* What the sample needs without pounding. */
static void ask_free(const struct pound_campaign *campaign, struct ask *ask)
{
	const struct pound_scene *scene = &ask->scene;
	bool response = ask->response = campaign->study->kind == POUND_KIND_RESPONSE;
	bool may_miss = !scene->contact.present || scene->contact.gap > 0;
	for (int i = 0; i < POUND_OSCILLATORS; i++) {
		bool moves = !scene->oscillators[i].rigid_wall;
		ask->bodies[i] = (struct body_ask){.march = -1, .wanted = moves && (i == 0 || response || may_miss)};
	}
}

static int stages_of(const struct ask *ask)
{
	int stages = 1;
	for (int i = 0; i < POUND_OSCILLATORS; i++) {
		const struct pound_law *law = pound_scene_law(&ask->scene, i);
		stages = (int)fmax(stages,
		                   2 + law->corrections + (searched(law) ? 1 : 0)); // one to look at the last march
	}
	return stages;
}

static double free_max(const struct pound_plan *plan, const struct body_ask *body)
{
	return body->finished ? plan->results[body->march].displacement_max[0] : 0;
}

/* Asks for the run with pounding, unless the responses without it are the answer. */
static void ask_pounding(struct pound_plan *plan, struct ask *ask, struct pound_work *work)
{
	struct pound_march_task task = {0};
	ask->march = -1;
	if (!ask->scene.contact.present)
		return;
	if (pound_scene_alike(&ask->scene)) {
		work->moving_alike++;
		return;
	}
	for (int i = 0; i < POUND_OSCILLATORS; i++) {
		task.bodies[i] = pound_scene_body(&ask->scene, i);
		task.bodies[i].followed = ask->bodies[i].wanted;
		double yield = ask->bodies[i].yield;
		bool linear = pound_pieces_linear(task.bodies[i].skeleton.law);
		task.bodies[i].skeleton.yield = linear ? 0 : yield_marched(plan, ask, yield);
		if (linear)
			task.bodies[i].skeleton.hardening = 0;
	}
	pound_scene_contact(&ask->scene, &task);
	task.accounted = ask->response;
	task.gap = ldexp(task.gap, -plan->motions[ask->motion].exponent);
	if (task.gap < negligible(plan, ask))
		task.gap = 0;
	if (task.gap > 0 && free_max(plan, &ask->bodies[0]) + free_max(plan, &ask->bodies[1]) < task.gap) {
		work->never_touching++;
		return;
	}
	ask->march = march_ask(plan, ask->motion, &task);
}

/* ---- from marches to a response ---- */

/* The response of a sample in the units of the study.
 *
 * Returns  response  NAN where the scene has no such value
 */
static enum pound_status ask_response(const struct pound_plan *plan, const struct ask *ask,
                                      struct pound_response *out)
{
	int e = plan->motions[ask->motion].exponent;
	struct pound_march_result none = {0};
	const struct pound_march_result *with = ask->march < 0 ? &none : &plan->results[ask->march];
	enum pound_status status = with->status;
	double residual = with->energy_residual;
	double max[2], max_free[2], force[2], yield[2], demand[2], demand_free[2], u[2], v[2];
	for (int i = 0; i < POUND_OSCILLATORS; i++) {
		const struct body_ask *body = &ask->bodies[i];
		const struct pound_march_result *free = body->finished ? &plan->results[body->march] : NULL;
		struct pound_skeleton skeleton = pound_scene_body(&ask->scene, i).skeleton;
		bool yields = !pound_pieces_linear(skeleton.law) && !ask->scene.oscillators[i].rigid_wall;
		if (body->status || (free && free->status))
			status = body->status ? body->status : free->status;
		skeleton.yield = body->yield;
		// without a run with pounding the body moves as it does alone; the wall does not
		bool alone = ask->march < 0;
		if (alone && free)
			residual = fmax(residual, free->energy_residual);
		bool wall = ask->scene.oscillators[i].rigid_wall;
		double most = wall ? 0 : !alone ? with->displacement_max[i] : free ? free->displacement_max[0] : 0;
		max[i] = ldexp(most, e);
		max_free[i] = wall ? 0 : free ? ldexp(free->displacement_max[0], e) : NAN;
		force[i] = ldexp(ask->scene.oscillators[i].mass * pound_pieces_envelope(&skeleton, most), e);
		double given = pound_scene_law(&ask->scene, i)->yield_displacement;
		yield[i] = !yields ? NAN : given > 0 ? given : ldexp(body->yield, e);
		// a yield displacement that is given may be too small beside the motion to be told in its scale
		double per_yield = !yields || body->yield == 0 ? NAN : given > 0 ? given : body->yield;
		demand[i] = ldexp(most / per_yield, given > 0 ? e : 0);
		demand_free[i] = free ? ldexp(free->displacement_max[0] / per_yield, given > 0 ? e : 0) : NAN;
		u[i] = ldexp(!alone ? with->u[i] : free ? free->u[0] : 0, e);
		v[i] = ldexp(!alone ? with->v[i] : free ? free->v[0] : 0, e);
	}
	*out = (struct pound_response){
	    .displacement_max_1 = max[0],
	    .displacement_max_2 = max[1],
	    .displacement_max_free_1 = max_free[0],
	    .displacement_max_free_2 = max_free[1],
	    .force_max_1 = force[0],
	    .force_max_2 = force[1],
	    .yield_displacement_1 = yield[0],
	    .yield_displacement_2 = yield[1],
	    .demand_1 = demand[0],
	    .demand_2 = demand[1],
	    .demand_free_1 = demand_free[0],
	    .demand_free_2 = demand_free[1],
	    .impulse_max = ldexp(ask->scene.oscillators[0].mass * with->impulse_max, e),
	    .contact_count = (double)with->contacts,
	    .contact_time = with->contact_time,
	    .end_u1 = u[0],
	    .end_v1 = v[0],
	    .end_u2 = u[1],
	    .end_v2 = v[1],
	    .energy_residual = residual,
	};
	bool beyond = false; // the motion in its own scale is finite, but not all that is made of it need be
#define X(member, name, oscillator) beyond |= isinf(out->member) != 0;
	POUND_MEASURES(X)
#undef X
	return beyond && status == POUND_OK ? POUND_OVERFLOW : status;
}

/* ---- the block ---- */

/* Writes down the samples of one item from ask `a` on; returns the one after them. */
static int item_write(struct pound_plan *plan, const struct pound_campaign *campaign, int a, int item,
                      bool halved)
{
	int row = item / campaign->n_signals, signal = item % campaign->n_signals;
	for (int cell = 0; cell < campaign->n_cells; cell++)
		for (int sample = 0; sample < campaign->n_samples; sample++) {
			struct ask *ask = &plan->asks[a++];
			ask->scene = pound_campaign_scene(campaign, cell, row, sample);
			// samples of a row share their noise, or have their own
			struct pound_stream noise = {.seed = campaign->study->design.seed,
			                             .what = POUND_STREAM_NOISE,
			                             .row = campaign->trials ? 0 : (uint32_t)row,
			                             .sample =
			                                 campaign->study->design.common_signals ? 0 : (uint32_t)sample,
			                             .signal = (uint32_t)signal};
			ask->motion = motion_ask(plan, &ask->scene.excitation, noise, halved);
			ask_free(campaign, ask);
		}
	return a;
}

/* Asks for what asks [first, end) need of a stage without pounding; false: nothing, nor of a later one. */
static bool stage_ask(struct pound_plan *plan, int first, int end, int stage,
                      struct pound_stage_work *counted, struct pound_work *work)
{
	int before = plan->march_keys.n;
	int64_t asked = 0;
	for (int a = first; a < end; a++)
		for (int i = 0; i < POUND_OSCILLATORS; i++)
			if (!plan->asks[a].scene.oscillators[i].rigid_wall)
				asked += body_stage(plan, &plan->asks[a], &plan->asks[a].bodies[i], i, stage, work);
	counted->asked += asked;
	counted->run += plan->march_keys.n - before;
	return asked > 0 || stage == 0; // of a yield displacement that is given, the first is left out
}

/* Asks for the runs with pounding of asks [first, end). */
static void pounding_ask(struct pound_plan *plan, int first, int end, struct pound_stage_work *counted,
                         struct pound_work *work)
{
	int before = plan->march_keys.n;
	for (int a = first; a < end; a++)
		ask_pounding(plan, &plan->asks[a], work);
	counted->asked += end - first;
	counted->run += plan->march_keys.n - before;
}

/* Runs items [first, first + n) of a campaign, and the checks among them.
 *
 * Given    first, n  items, item = row n_signals + signal
 *          stop      looked at throughout
 * Returns  take      called for every item, cell and sample in this order, then for those of the checks
 *          work      what was asked and run is added
 * Status   POUND_STOPPED  stop was set; nothing was handed to take
 *          POUND_NOMEM    there was no memory for a run, so too
 */
enum pound_status pound_plan_run(struct pound_plan *plan, const struct pound_campaign *campaign, int first,
                                 int n, const atomic_bool *stop, struct pound_work *work,
                                 pound_plan_take *take, void *into)
{
	int n_items = n * campaign->n_cells * campaign->n_samples, n_asks = 0;
	const struct pound_solver solver = pound_campaign_solver(campaign, first / campaign->n_signals);
	register_clear(&plan->motion_keys);
	register_clear(&plan->march_keys);
	for (int item = first; item < first + n; item++)
		n_asks = item_write(plan, campaign, n_asks, item, false);
	work->signals.asked += n_asks;
	work->signals.run += plan->motion_keys.n;
	for (int k = pound_campaign_checks(campaign, first); k < pound_campaign_checks(campaign, first + n); k++)
		n_asks = item_write(plan, campaign, n_asks, k * campaign->check_every, true);
	assert(n_asks <= plan->size.asks);
	plan->n_asks = n_asks;
	plan->n_items = n_items;
	motions_fill(plan, forces_scale(plan));

	struct pound_work of_checks = {0}; // what they leave out is not told
	int done = 0, stages = 1;
	for (int a = 0; a < n_asks; a++)
		stages = (int)fmax(stages, stages_of(&plan->asks[a]));
	enum pound_status status = POUND_OK;
	bool more = true;
	for (int stage = 0; stage < stages && more && !status; stage++) {
		// the checks, which take longer, start first, so that no lane waits for them at the end
		more = stage_ask(plan, n_items, n_asks, stage, &work->checks, &of_checks);
		int checks_end = plan->march_keys.n;
		more |= stage_ask(plan, 0, n_items, stage, stage == 0 ? &work->free_runs : &work->yield_runs, work);
		status = marches_run(plan, &solver, checks_end, &done, stop);
	}
	if (status)
		return status;
	pounding_ask(plan, n_items, n_asks, &work->checks, &of_checks);
	int before = plan->n_before = plan->march_keys.n;
	pounding_ask(plan, 0, n_items, &work->pounding_runs, work);
	status = marches_run(plan, &solver, before, &done, stop);
	if (status)
		return status;
	for (int j = before; j < done; j++)
		work->contacts += plan->results[j].contacts;
	for (int a = 0; a < n_asks; a++) {
		struct pound_response response;
		const struct ask *ask = &plan->asks[a];
		enum pound_status failure = ask_response(plan, ask, &response);
		assert(!failure || failure <= POUND_CHATTER);
		if (failure && a < n_items)
			work->failed[POUND_CHATTER - failure]++;
		take(into, &ask->scene, &response, failure);
	}
	return POUND_OK;
}

enum pound_status pound_plan_displacement(struct pound_plan *plan, const struct pound_solver *solver,
                                          int item, int sample, const atomic_bool *stop, double *u)
{
	const struct ask *ask = &plan->asks[item];
	struct pound_march_task task = plan->tasks[ask->march < 0 ? ask->bodies[0].march : ask->march];
	struct pound_march_result result;
	assert(sample >= 1 && sample < task.n_samples);
	task.n_samples = sample + 1;
	enum pound_status status = pound_solver_run(solver, &task, &result, 1, plan->scratch, stop);
	if (status)
		return status;
	*u = result.status ? NAN : ldexp(result.u[0], plan->motions[ask->motion].exponent);
	return POUND_OK;
}

enum pound_status pound_plan_repeat(struct pound_plan *plan, const struct pound_solver *solver,
                                    const atomic_bool *stop, int *n)
{
	int from = plan->n_before < plan->march_keys.n ? plan->n_before : 0;
	*n = plan->march_keys.n - from;
	return pound_solver_run(solver, &plan->tasks[from], &plan->results[from], *n, plan->scratch, stop);
}

int pound_plan_asks(const struct pound_plan *plan, int *n_items)
{
	*n_items = plan->n_items;
	return plan->n_asks;
}

struct pound_plan_floor pound_plan_floor(const struct pound_plan *plan, int ask)
{
	const struct ask *a = &plan->asks[ask];
	int march = a->march < 0 ? a->bodies[0].march : a->march;
	return (struct pound_plan_floor){.scene = &a->scene,
	                                 .pounding = a->march < 0 ? NULL : &plan->tasks[a->march],
	                                 .free = &plan->tasks[a->bodies[0].march],
	                                 .march = march,
	                                 .exponent = plan->motions[a->motion].exponent,
	                                 .scratch = plan->scratch};
}
