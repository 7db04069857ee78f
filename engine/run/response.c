/* response.c - from the runs of a scene under one ground motion to its response, in the units of the study. */
#include "engine/run/response.h"

#include <math.h>

#include "engine/run/scene.h"
#include "engine/scene/law.h"

/* Quantities of two bodies as one-story buildings. */
static void floors_of(const struct pound_runs_known *known, struct pound_pair_floors *out)
{
	const struct pound_scene *scene = known->scene;
	const double *floor = known->chain->floors, *free = known->chain_free->floors,
	             *link = known->pounding ? known->chain->links : NULL, mass = scene->oscillators[0].mass;
	const int e = known->exponent;
	for (int i = 0; i < POUND_OSCILLATORS && !scene->oscillators[i].rigid_wall; i++) {
		const double *m = floor + i * POUND_FLOOR_MEASURES;
		out->acceleration[i] = ldexp(m[POUND_FLOOR_ACCELERATION_MAX], e);
		out->acceleration_free[i] = ldexp(free[i * POUND_FLOOR_MEASURES + POUND_FLOOR_ACCELERATION_MAX], e);
		out->residual[i] = ldexp(m[POUND_FLOOR_RESIDUAL], e);
		out->lost[i] = ldexp(mass * m[POUND_FLOOR_LOST], 2 * e);
	}
	out->work_in = ldexp(mass * known->chain->work_in, 2 * e);
	if (!link)
		return;
	out->lost_contact = ldexp(mass * link[POUND_LINK_LOST], 2 * e);
	out->force = ldexp(mass * link[POUND_LINK_FORCE_MAX], e);
	out->approach = ldexp(link[POUND_LINK_SPEED_MAX], e);
}

/* The response of a sample in the units of the study.
 *
 * Returns  response  NAN if the scene has no such value
 */
enum pound_status pound_response_of(const struct pound_runs_known *known, struct pound_response *out)
{
	const struct pound_scene *scene = known->scene;
	int e = known->exponent;
	struct pound_task_result none = {0};
	const struct pound_task_result *with = known->pounding ? known->pounding : &none;
	enum pound_status status = with->status;
	double residual = with->energy_residual;
	double max[2], max_free[2], force[2], yield[2], demand[2], demand_free[2], u[2], v[2];
	for (int i = 0; i < POUND_OSCILLATORS; i++) {
		const struct pound_body_known *body = &known->bodies[i];
		const struct pound_task_result *free = body->free;
		struct pound_backbone backbone = pound_scene_body(scene, i).backbone;
		bool yields = !pound_law_linear(backbone.law) && !scene->oscillators[i].rigid_wall;
		if (body->status || (free && free->status))
			status = body->status ? body->status : free->status;
		backbone.yield = body->yield;
		// without a run with pounding the response of the body alone is final; a wall does not move
		bool alone = !known->pounding;
		if (alone && free)
			residual = fmax(residual, free->energy_residual);
		bool wall = scene->oscillators[i].rigid_wall;
		double most = wall ? 0 : !alone ? with->displacement_max[i] : free ? free->displacement_max[0] : 0;
		max[i] = ldexp(most, e);
		const struct pound_task_result *pair = known->free_pair;
		max_free[i] = wall   ? 0
		              : free ? ldexp(free->displacement_max[0], e)
		              : pair ? ldexp(pair->displacement_max[i], e)
		                     : NAN;
		force[i] = ldexp(scene->oscillators[i].mass * pound_law_envelope(&backbone, most), e);
		double given = pound_scene_law(scene, i)->yield_displacement;
		yield[i] = !yields ? NAN : given > 0 ? given : ldexp(body->yield, e);
		// a given yield displacement may be too small to be represented in the scale of the motion
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
	    .impulse_max = ldexp(scene->oscillators[0].mass * with->impulse_max, e),
	    .contact_count = (double)with->contacts,
	    .contact_time = with->contact_time,
	    .end_u1 = u[0],
	    .end_v1 = v[0],
	    .end_u2 = u[1],
	    .end_v2 = v[1],
	    .energy_residual = residual,
	};
	if (known->free_pair && known->free_pair->status)
		status = known->free_pair->status;
	if (known->peaks_free) {
		out->gap_needed = ldexp(known->peaks_free[0], e);
		out->relative_free = fmax(out->gap_needed, ldexp(known->peaks_free[1], e));
	}
	if (known->chain) {
		status = status ? status : known->chain->status ? known->chain->status : known->chain_free->status;
		floors_of(known, &out->floors);
	}
	// the scaled motion is finite, but derived quantities may overflow
	bool beyond = isinf(out->relative_free);
	for (size_t k = 0; k < sizeof out->floors / sizeof(double); k++)
		beyond |= isinf(((const double *)(const void *)&out->floors)[k]) != 0;
#define X(member, name, oscillator) beyond |= isinf(out->member) != 0;
	POUND_MEASURES(X)
#undef X
	return beyond && status == POUND_OK ? POUND_OVERFLOW : status;
}
