/* observer.inl - reports the instants of a simulation to its observer (task.h).
 *
 * Ends of steps, substeps and free motion at other times are not reported: between two instants the motion obeys one linear
 * system, which an observer can subdivide as needed.
 *
 * Included by exact.inl after step.inl, once per lane count. */

/* Whether a simulation is observed; rarely true. */
LANE_INLINE bool observed(const struct simulation *sim)
{
	return __builtin_expect(sim->traits & TRAIT_OBSERVED, 0);
}

/* Time since the last instant [s].  Substeps, all of one length in a task, are counted, not summed: the result must not depend on
 * how many are passed per batch. */
LANE_INLINE double time_unobserved(const struct simulation *sim)
{
	return sim->unobserved + sim->unobserved_substeps * sim->x.substep;
}

/* The instant at which a simulation is.
 *
 * Given    sample  the current sample; < 0: at an event, or where the simulation ended early
 */
LANE_INLINE void simulation_instant(struct simulation *sim, int64_t sample, struct pound_instant_of_task *now)
{
	const struct state_rows *x = &sim->x;
	const double left = x->remainder + x->substeps * x->substep, step = sim->task->time_step;
	// member by member: early reads of single members would stall on wider stores
	now->elapsed = time_unobserved(sim);
	now->sampled = sample >= 0;
	now->touching = sim->touching;
	now->overlap = x->p;
	now->overlap_rate = x->q;
	now->ground = x->ground;
	now->slope = x->slope;
	now->time = (double)(now->sampled ? sample : sim->next) * step - (now->sampled ? 0 : left);
	for (int i = 0; i < POUND_OSCILLATORS; i++) {
		now->u[i] = x->u[i];
		now->v[i] = x->v[i];
		now->stiffness[i] = x->body[i].stiffness;
		now->spring_offset[i] = x->body[i].offset;
	}
	if (now->sampled) {
		const double *a = &sim->ground[sample];
		now->ground = a[0];
		now->slope = sample < sim->last ? (a[1] - a[0]) * sim->per_step : 0;
	}
	sim->unobserved = sim->unobserved_substeps = 0;
}

/* Reports an instant. */
LANE_SHARED void simulation_observe(struct simulation *sim, int64_t sample)
{
	const struct pound_task_observer *observer = sim->task->observer;
	struct pound_instant_of_task now;
	simulation_instant(sim, sample, &now);
	observer->observe(observer->into, &now);
}

/* Reports that n samples were passed, the last one being `sample`. */
LANE_SHARED void simulation_pass(struct simulation *sim, int64_t sample, int n)
{
	const struct pound_task_observer *observer = sim->task->observer;
	struct pound_instant_of_task now;
	simulation_instant(sim, sample, &now);
	observer->pass(observer->into, &now, n);
}

/* ---- samples of free motion ---- */

/* Stores a lane's state at a sample of a stretch. */
LANE_INLINE void stretch_carry(struct simulation *sim, const struct stretch *s, int r, int l)
{
	for (int i = 0; i < (sim->paired ? 2 : 1); i++) {
		sim->x.u[i] = ((const double *)&s->at[i][r].u)[l];
		sim->x.v[i] = ((const double *)&s->at[i][r].v)[l];
	}
	sim->unobserved = sim->task->time_step;
}

/* Reports that n samples of a lane were passed, the last one being `sample`.
 *
 * Given    most  largest u_1 - u_2 and u_2 - u_1 of all lanes up to that sample  (2)
 */
LANE_INLINE void stretch_pass(struct simulation *sim, const vd most[2], int64_t sample, int l, int n)
{
	double *known = sim->task->observer->most;
	for (int k = 0; k < 2; k++) {
		const double now = ((const double *)&most[k])[l];
		known[k] = now > known[k] ? now : known[k];
	}
	simulation_pass(sim, sample, n);
}
