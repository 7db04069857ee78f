/* next_step.inl - operations on one simulation at a time: its start, the choice of its next step and branch, its end.
 *
 * Included by exact.inl alone, once per lane count.
 *
 * Included by exact.inl after observer.inl. */

#include <assert.h>
#include <float.h>
#include <math.h>
#include <string.h>

#include "engine/exact/counts.h"
#include "engine/exact/tolerances.h"

/* Largest rate * time of a series step: the first omitted term of a velocity is near 2^-52 of the first term or below: separated
 * 0.35^13/13! = 1.9e-16; in contact 0.945^17/17! = 1.1e-15, which also holds near critical damping: see
 * contact_reach. */
static const double REACH_FREE = 0.35, REACH_CONTACT = 0.945;

static const double NEVER = -1e300; /* overlap of bodies that cannot meet */

enum { FREE_SAMPLES = 4095 }; /* free motion is interrupted at every sample with all of these bits set */

static_assert(sizeof(struct state_rows) == ROWS_END * sizeof(double), "rows are eight doubles each");
static_assert(offsetof(struct simulation, task) - offsetof(struct simulation, ground) <= 128,
              "what every step reads fits into two cache lines");

static double most(double a, double b)
{
	return a < b ? b : a;
}

/* ---- maps ---- */

/* Copies a body's current branch and its free-motion map into the rows. */
static void branch_enter(struct simulation *sim, int i)
{
	const struct pound_branch *branch = &sim->at[i].branch;
	struct state_rows *x = &sim->x;
	x->body[i].stiffness = branch->stiffness;
	x->body[i].offset = branch->offset;
	x->body[i].low = branch->low;
	x->body[i].high = branch->high;
	x->body[i].direction = branch->direction;
	sim->contact_maps = NULL;
	if (!sim->has_free_maps)
		return;
	unsigned found = 0;
	for (int m = 0; m < POUND_MAPS; m++)
		found |= (unsigned)(sim->map_of[i][m] == branch->stiffness) << m;
	int m = sim->map_next[i];
	if (found)
		m = __builtin_ctz(found);
	else {
		sim->map_next[i] = (m + 1) % POUND_MAPS;
		sim->map_of[i][m] = branch->stiffness;
		map_fill(&sim->maps[i][m], branch->stiffness, x->body[i].damping, sim->task->time_step);
	}
	memcpy(&x->map[i], &sim->maps[i][m], sizeof sim->maps[i][m]);
}

/* ---- the next step ---- */

/* Sets the current interval to the one that ends at a sample. */
static void interval_set(struct simulation *sim, int64_t next)
{
	const double *a = &sim->ground[next];
	sim->next = next;
	sim->x.slope = (a[0] - a[-1]) * sim->per_step;
}

/* Enters the interval that ends at sim->next. */
static void simulation_interval(struct simulation *sim)
{
	struct state_rows *x = &sim->x;
	interval_set(sim, sim->next);
	sim->steps = 0;
	x->ground = sim->ground[sim->next - 1];
	x->remainder = sim->touching ? 0 : x->body[0].step_gap; // the sample step
	x->substeps = sim->touching ? x->substeps_per_sample : 0;
	if (observed(sim))
		simulation_observe(sim, sim->next - 1);
}

/* Chooses the length and kind of the next step by power series. */
static enum pound_stage simulation_step(struct simulation *sim)
{
	if (++sim->steps > POUND_STEPS_LIMIT)
		return STAGE_CHATTER;
	struct state_rows *x = &sim->x;
	if (sim->touching) {
		if (x->remainder == 0) {
			x->remainder = x->substep;
			x->substeps--;
		}
		x->dt = x->remainder * x->pace;
		return STAGE_STEP_CONTACT;
	}
	double reach = x->reach * x->pace;
	x->dt = x->remainder <= reach ? x->remainder : x->remainder > 2 * reach ? reach : 0.5 * x->remainder;
	if (!sim->paired)
		return STAGE_STEP_SINGLE;
	return x->p + x->dt * x->q < 0 ? STAGE_STEP_CLEAR : STAGE_STEP_PAIR;
}

/* Computes the overlap of separated bodies from their displacements. */
static void overlap_start(struct state_rows *x)
{
	double p = x->u[0] - x->u[1] - x->gap;
	x->p = p < 0 ? p : 0; // rounding must not give a positive overlap
	x->q = x->v[0] - x->v[1];
}

/* Continues by power series after a free motion that ended at a sample. */
LANE_INLINE enum pound_stage simulation_meet(struct simulation *sim)
{
	struct state_rows *x = &sim->x;
	simulation_interval(sim);
	overlap_start(x);
	return simulation_step(sim);
}

/* Whether the contact that has ended counts (counts.h).
 *
 * Given    changed  its change of the relative velocity [m/s]
 */
static bool contact_counts(struct simulation *sim, double changed)
{
	const struct state_rows *x = &sim->x;
	const double lasted =
	    x->contact_time - sim->counted_time + x->substep * (x->substeps_done - sim->counted_substeps);
	struct pound_counts counts = {
	    .time = (double)sim->next * x->body[0].step_gap, .steps = lasted * sim->per_step, .changed = changed};
	for (int i = 0; i < POUND_OSCILLATORS; i++)
		counts.body[i] = (struct pound_counts_body){x->u[i],
		                                            x->v[i],
		                                            x->body[i].stiffness,
		                                            x->body[i].offset,
		                                            x->body[i].damping,
		                                            x->body[i].drive * x->ground};
	return pound_contact_counts(&counts, &sim->counts_scale);
}

/* Records a contact that has ended, or is still open at the end of the signal.
 *
 * Given    speed  closing speed now [m/s]
 */
static void contact_over(struct simulation *sim, double speed)
{
	struct state_rows *x = &sim->x;
	const double changed = x->both * x->impulse + fabs(speed);
	sim->impulse_max = most(sim->impulse_max, x->impulse);
	if (pound_contact_plain(changed, fabs(x->v[0]) + fabs(x->v[1]), &sim->counts_scale) ||
	    contact_counts(sim, changed)) {
		sim->contacts++;
		sim->counted_time = x->contact_time;
		sim->counted_substeps = x->substeps_done;
	} else {
		x->contact_time = sim->counted_time;
		x->substeps_done = sim->counted_substeps;
	}
}

/* Begins or ends a contact.
 *
 * Given    left   time left in the interval [s];  speed: approach speed [m/s]
 */
static void contact_transition(struct simulation *sim, double left, double speed)
{
	sim->touching = !sim->touching;
	sim->doubled_limit = sim->n_doubled - 1;
	if (!sim->touching) {
		contact_over(sim, speed);
	} else if (sim->contacts == 0) {
		sim->result->first_contact = (double)sim->next * sim->task->time_step - left;
		sim->result->first_speed = speed;
	}
}

/* Next stage of a simulation at a sample, with separated bodies. */
static enum pound_stage simulation_from(struct simulation *sim)
{
	if (sim->has_free_maps)
		return sim->paired ? STAGE_FREE_PAIR : STAGE_FREE_SINGLE;
	return simulation_meet(sim);
}

/* Sets negligible motion to rest, if the ground does not move in this interval.
 *
 * Separated bodies are set to rest independently: one may have stopped long before the other, which may still move or rest at
 * a residual displacement.
 *
 * Returns  value  both motions are negligible: simulation_rest must follow
 */
static bool simulation_comes_to_rest(struct simulation *sim)
{
	struct state_rows *x = &sim->x;
	if (x->ground != 0 || x->slope != 0)
		return false;
	bool over[POUND_OSCILLATORS];
	for (int i = 0; i < POUND_OSCILLATORS; i++)
		over[i] = fabs(x->u[i]) < POUND_AT_REST && fabs(x->v[i]) * sim->task->time_step < POUND_AT_REST &&
		          x->body[i].offset == 0 && x->body[i].low <= 0 && x->body[i].high >= 0;
	if (over[0] == over[1] || sim->touching || sim->released)
		return over[0] && over[1];
	x->u[over[1]] = x->v[over[1]] = 0;
	overlap_start(x);
	return false;
}

/* Sets a simulation with negligible motion to rest, and skips to the sample where the ground moves again. */
static enum pound_stage simulation_rest(struct simulation *sim)
{
	struct state_rows *x = &sim->x;
	if (sim->touching)
		contact_transition(sim, 0, 0);
	for (int i = 0; i < POUND_OSCILLATORS; i++)
		x->u[i] = x->v[i] = 0;
	sim->released = sim->fresh = false;
	x->pace = 1;
	double left =
	    x->remainder +
	    x->substeps *
	        x->substep; // time left in the interval: motion in contact may become negligible inside one
	if (observed(sim))
		simulation_observe(sim, time_unobserved(sim) > 0 ? -1 : sim->next - 1);
	while (sim->ground[sim->next] == 0) {
		if (observed(sim)) {
			sim->unobserved = left;
			simulation_observe(sim, sim->next);
			left = x->body[0].step_gap;
		}
		if (sim->next++ == sim->last)
			return STAGE_END;
	}
	return simulation_from(sim);
}

/* The sample at which a free motion is interrupted for a check of rest; independent of the other simulations. */
static int64_t free_end(const struct simulation *sim)
{
	int64_t end = sim->next | FREE_SAMPLES;
	return end < sim->last ? end : sim->last;
}

/* Next stage of a simulation whose free motion has reached free_end. */
static enum pound_stage simulation_after_free(struct simulation *sim, enum pound_stage stage)
{
	if (sim->next > sim->last)
		return STAGE_END;
	simulation_interval(sim);
	return simulation_comes_to_rest(sim) ? simulation_rest(sim) : stage;
}

/* Next stage of a simulation. */
static enum pound_stage simulation_next(struct simulation *sim)
{
	const struct state_rows *x = &sim->x;
	if (x->remainder + x->substeps == 0) {
		if (sim->next == sim->last)
			return STAGE_END;
		sim->next++;
		simulation_interval(sim);
		if (simulation_comes_to_rest(sim))
			return simulation_rest(sim);
		// separated, and not about to touch inside the next interval
		if (sim->has_free_maps && !sim->touching && !sim->released && x->p + x->remainder * x->q < 0)
			return simulation_from(sim);
	}
	if (sim->touching && x->remainder == 0 && sim->has_contact)
		return contact_ready(sim);
	return simulation_step(sim);
}

/* Next stage of a simulation after substeps of contact.
 *
 * Given    stage    its stage: STAGE_CONTACT or STAGE_SUSTAINED
 *          refused  the next substeps could not be proved free of events: shorter doubled maps are tried next
 *          gone     it has passed the length of the next longer doubled map: longer ones are tried again
 */
static enum pound_stage simulation_after_contact(struct simulation *sim, enum pound_stage stage, bool refused,
                                                 bool gone)
{
	if (simulation_comes_to_rest(sim))
		return simulation_rest(sim);
	if (refused)
		sim->doubled_limit = stage == STAGE_SUSTAINED ? sim->doubled - 1 : 0;
	else if (gone)
		sim->doubled_limit = sim->n_doubled - 1;
	return stage == STAGE_CONTACT && refused ? simulation_step(sim) : contact_ready(sim);
}

/* Moves a body's law to its next branch; the displacement is set exactly to the edge. */
static void body_transition(struct simulation *sim, int i, enum pound_edge edge)
{
	struct state_rows *x = &sim->x;
	if (edge != POUND_EDGE_REVERSAL)
		x->u[i] = edge == POUND_EDGE_HIGH ? x->body[i].high : x->body[i].low;
	if (edge == POUND_EDGE_REVERSAL && x->body[i].direction == 0)
		return; // a reversal that was searched only as a largest displacement
	pound_law_leave(&sim->task->bodies[i].backbone, &sim->at[i], edge, x->u[i]);
	branch_enter(sim, i);
}

/* Next stage of a simulation after a step by power series.
 *
 * Given    event  the event that ended the step;  left, speed: see contact_transition
 */
static enum pound_stage simulation_stepped(struct simulation *sim, int event, double left, double speed)
{
	if (event == EVENT_CONTACT)
		contact_transition(sim, left, speed);
	if (event >= EVENT_BODY)
		body_transition(sim, (event - EVENT_BODY) / EVENT_EDGES,
		                (enum pound_edge)((event - EVENT_BODY) % EVENT_EDGES));
	if (observed(sim) && event > EVENT_CUT)
		simulation_observe(sim, -1);
	if (event >= EVENT_CLEARS && sim->has_free_maps && !sim->touching && sim->x.remainder > 0)
		return sim->paired ? STAGE_FINISH_PAIR : STAGE_FINISH_SINGLE;
	return simulation_next(sim);
}

/* ---- largest displacements ---- */

/* Notes a sample that may contain a body's largest displacement; drops notes that have been exceeded.
 *
 * Given    noted   the sample, of body i;  top: the largest displacement so far
 * Returns  value   false: there is no room
 */
static bool peak_note(struct simulation *sim, int i, const struct pound_peak *noted, double top)
{
	struct pound_peak *peak = sim->peak[i];
	int kept = 0;
	for (int n = 0; n < sim->peaks[i]; n++)
		if (peak[n].bound > top)
			peak[kept++] = peak[n];
	sim->peaks[i] = kept;
	if (kept == POUND_PEAKS)
		return false;
	peak[kept] = *noted;
	sim->peaks[i]++;
	return true;
}

/* At the end of a simulation, integrates each noted sample again, with one body only, for its largest displacement.
 *
 * Given    sim    its result written except for larger displacements found here
 * Returns  value  its next step; STAGE_END: no noted sample is left
 */
static enum pound_stage peaks_look(struct simulation *sim)
{
	struct state_rows *x = &sim->x;
	double *largest = sim->result->displacement_max;
	if (sim->looked < POUND_OSCILLATORS)
		largest[sim->looked] = x->top[0];
	sim->touching = sim->released = sim->fresh = sim->paired = sim->has_free_maps = false;
	x->pace = 1;
	for (int i = 0; i < POUND_OSCILLATORS; i++)
		while (sim->peaks[i] > 0) {
			const struct pound_peak *peak = &sim->peak[i][--sim->peaks[i]];
			if (!(peak->bound > largest[i]))
				continue;
			x->u[0] = peak->u, x->v[0] = peak->v, x->top[0] = largest[i];
			x->body[0].damping = x->body[i].damping;
			x->body[0].drive = x->body[i].drive;
			x->body[0].stiffness = peak->stiffness;
			x->body[0].offset = peak->offset;
			x->body[0].low = -DBL_MAX, x->body[0].high = DBL_MAX, x->body[0].direction = 0;
			sim->looked = i;
			sim->next = sim->last = peak->next;
			simulation_interval(sim);
			return simulation_step(sim);
		}
	return STAGE_END;
}

/* ---- the start ---- */

/* Whether a law of a task has more than one branch. */
static bool simulation_edged(const struct pound_task *task)
{
	return !pound_law_linear(task->bodies[0].backbone.law) || !pound_law_linear(task->bodies[1].backbone.law);
}

/* Longest step in contact.
 *
 * The highest rate of two bodies in contact is at most that of the faster body with the contact spring and dashpot added, scaled by
 * 1 + m1/m2.  Derivative n of exp(-zeta t) sin((1 - zeta^2)^1/2 t) is at most 1 over (1 - zeta^2)^1/2, and at most n: the step is
 * shortened by the 16th root of that factor, which the 17th power in the error more than compensates.  Above zeta = 1 the faster root counts.
 *
 * Given    omega, damping  the larger ones of both bodies [1/s]
 */
static double contact_reach(const struct state_rows *x, double omega, double damping)
{
	const double own = sqrt(omega * omega + x->both * x->contact_stiffness);
	const double zeta = own > 0 ? 0.5 * (damping + x->both * x->contact_damping) / own : 0;
	double share = most(1 - zeta * zeta, 1.0 / (ORDER_HIGH * ORDER_HIGH));
	for (int halving = 0; halving < 5; halving++)
		share = sqrt(share);
	return REACH_CONTACT * share / (own * (zeta > 1 ? zeta + sqrt(zeta * zeta - 1) : 1));
}

/* Initializes a simulation for its task.
 *
 * Returns  value  its first stage
 */
static enum pound_stage simulation_start(struct simulation *sim, const struct pound_task *task,
                                         struct pound_task_result *result)
{
	memset(sim, 0, offsetof(struct simulation, peak));
	memset(result, 0, sizeof *result);
	sim->task = task;
	sim->ground = task->ground;
	sim->result = result;
	sim->next = 1;
	sim->last = task->n_samples - 1;
	struct state_rows *x = &sim->x;
	x->pace = 1;
	x->rounds = -1; // never reaches 0: no other map is chosen unless there are doubled maps
	sim->looked = POUND_OSCILLATORS;
	double h = task->time_step;
	double rate = 0, fastest = 0, damping = 0;
	bool has_free_maps = !task->accounted; // the energy balance needs the series of each step
	for (int i = 0; i < POUND_OSCILLATORS; i++) {
		const struct pound_task_body *body = &task->bodies[i];
		double k = body->backbone.stiffness;
		double omega = sqrt(k);
		rate = most(rate, most(omega, body->damping));
		fastest = most(fastest, omega);
		damping = most(damping, body->damping);
		has_free_maps &= h * (body->damping + omega) <= REACH_MAP;
		x->u[i] = body->u, x->v[i] = body->v;
		x->top[i] = body->followed ? fabs(body->u) : DBL_MAX;
		x->body[i].damping = body->damping;
		x->body[i].drive = body->drive;
		for (int m = 0; m < POUND_MAPS; m++)
			sim->map_of[i][m] = -1;
	}
	for (int m = 0; m < POUND_CONTACT_MAPS; m++)
		sim->contact_map_of[0][m] = -1;
	sim->has_free_maps = has_free_maps;
	sim->traits = TRAIT_OWN;
	sim->paired = task->contact || task->bodies[1].drive != 0;
	if (simulation_edged(task))
		sim->traits |= TRAIT_EDGED;
	if (task->bodies[1].followed)
		sim->traits |= TRAIT_RIGHT;
	if (task->accounted)
		sim->traits |= TRAIT_ACCOUNTED;
	if (task->observer)
		sim->traits |= TRAIT_OBSERVED;
	sim->per_step = 1 / h;
	x->right_mass = task->mass_ratio > 0 ? 1 / task->mass_ratio : 0;
	x->gap = task->contact ? task->gap : -NEVER;
	x->contact_stiffness = task->contact ? task->contact_stiffness : 0;
	x->contact_damping = task->contact ? task->contact_damping : 0;
	x->mass_ratio = task->mass_ratio;
	x->both = 1 + task->mass_ratio;
	x->release = task->contact && !task->tension ? task->contact_damping / task->contact_stiffness : 0;
	if (x->release > 0)
		sim->traits |= TRAIT_FORCED;
	x->body[0].step_gap = h;
	x->body[1].step_gap = x->gap;
	x->reach = rate > 0 ? REACH_FREE / rate : DBL_MAX;
	sim->has_contact = task->contact;
	double reach = contact_reach(x, fastest, damping);
	// the fewest substeps; above 8 a power of two, as doubled maps need
	x->substeps_per_sample = 1;
	while (h > reach * x->substeps_per_sample)
		x->substeps_per_sample += x->substeps_per_sample < DOUBLED_RATIO ? 1 : x->substeps_per_sample;
	x->substep = h / x->substeps_per_sample;
	if (sim->has_contact)
		doubled_choose(sim);
	sim->base = task->mass_ratio < 1;
	x->side = sim->base ? -1 : 1;
	x->base_drive = task->bodies[sim->base].drive;
	x->gap_drive = task->bodies[1].drive - task->bodies[0].drive;
	for (int i = 0; i < POUND_OSCILLATORS; i++) {
		pound_law_start(&task->bodies[i].backbone, &sim->at[i]);
		branch_enter(sim, i);
	}
	if (task->observer)
		simulation_observe(sim, 0);
	return simulation_from(sim);
}

/* ---- constants shared by simulations of one scene ---- */

/* Joins the shared constants at the start of a simulation if they equal its own, until its end: with laws of one branch they
 * never change.  When all members have left, the next simulation to start defines them. */
static void common_join(struct pound_common *common, struct simulation *sim)
{
	if (sim->traits & (TRAIT_EDGED | TRAIT_ACCOUNTED))
		return;
	double *shared = (double *)&common->x + ROWS_CONSTANT, *own = (double *)&sim->x + ROWS_CONSTANT;
	const size_t size = sizeof(double) * (ROWS_CONSTANT_END - ROWS_CONSTANT);
	if (common->members > 0 && memcmp(shared, own, size) != 0)
		return;
	if (common->members++ == 0) {
		memcpy(shared, own, size);
		common->maps.made = false;
	}
	sim->common = common;
	sim->traits &= ~(unsigned)TRAIT_OWN;
}

/* Leaves the shared constants at the end: peaks_look changes the rows. */
static void common_leave(struct simulation *sim)
{
	if (sim->common)
		sim->common->members--;
	sim->common = NULL;
	sim->traits |= TRAIT_OWN;
}

/* ---- the end ---- */

/* Residual of the energy balance, with the initial kinetic energy as input, over the largest energy of the motion. */
static double residual(const struct simulation *sim)
{
	const struct state_rows *x = &sim->x;
	double start = 0, end = 0;
	for (int i = 0; i < POUND_OSCILLATORS; i++) {
		double mass = i ? x->right_mass : 1, v0 = sim->task->bodies[i].v;
		start += 0.5 * mass * v0 * v0;
		end += 0.5 * mass * x->v[i] * x->v[i];
	}
	double missing = fabs(end - start + (x->work_gap + x->work_low)), largest = most(x->work_top, start);
	return largest > 0 ? missing / largest : 0;
}

/* Writes a simulation's result. */
static void result_write(struct simulation *sim, enum pound_status status)
{
	struct pound_task_result *r = sim->result;
	const struct state_rows *x = &sim->x;
	// a contact still open at the end counts with its impulse so far
	if (sim->touching)
		contact_over(sim, x->q);
	if (observed(sim))
		simulation_observe(sim, status == POUND_OK ? sim->last : -1);
	sim->traits &= ~(unsigned)TRAIT_OBSERVED; // peaks_look goes back in time: not to be reported
	bool finite = isfinite(x->u[0]) && isfinite(x->v[0]) && isfinite(x->u[1]) && isfinite(x->v[1]);
	r->status = finite ? status : POUND_OVERFLOW;
	r->contacts = (int64_t)sim->contacts;
	r->impulse_max = sim->impulse_max;
	if (r->contacts == 0)
		r->first_contact = r->first_speed = 0;
	r->contact_time = x->contact_time + x->substep * x->substeps_done;
	r->energy_residual = sim->task->accounted ? residual(sim) : NAN;
	for (int i = 0; i < POUND_OSCILLATORS; i++) {
		r->displacement_max[i] = sim->task->bodies[i].followed ? x->top[i] : NAN;
		r->u[i] = x->u[i];
		r->v[i] = x->v[i];
	}
}

/* Next stage of a simulation at the end of its signal, or where it ends early. */
static enum pound_stage simulation_end(struct simulation *sim, enum pound_status status)
{
	if (sim->looked == POUND_OSCILLATORS)
		result_write(sim, status);
	else
		sim->result->status = status;
	return sim->result->status == POUND_OK ? peaks_look(sim) : STAGE_END;
}
