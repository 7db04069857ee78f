/* simulation.c - what is done to one simulation at a time: its start, its next sample interval, its next piece. */
#include "engine/simulation.h"

#include <float.h>
#include <math.h>
#include <string.h>

/* Largest rate * time of a series step: the last term kept (series.h) is below 2^-54 of the first.
 * 0.4^14/14! = 3e-17, 1.4^22/22! = 1.5e-18 (touching has the larger factor before the power). */
static const double REACH_FREE = 0.4, REACH_TOUCH = 1.4;

/* The cubic through both ends of an interval misses the function by at most h^4/384 of the largest fourth derivative
 * (Hermite). */
static const double CUBIC_ERROR = 1.0 / 384;

static const double NEVER = -1e300; /* overlap of bodies that cannot meet */

/* Exact map of u'' + c u' + k u = -(a + d t/h) over one sample h, by its power series, and its error coefficients.
 *
 * Given    k, c, h   [1/s2], [1/s], [s]   h (c + k h) <= 1/2
 * Returns  map       columns for u, v, a, d
 *
 * With A2, A3, A4 the largest |u''|, |u'''|, |u''''| inside and h (c + k h) <= 1/2:
 *   A3 <= 2 (|u0'''| + h k |u0''|),  A2 <= |u0''| + h A3,  A4 <= c A3 + k A2,  error <= A4 h^4/384
 *   |u0''| <= c |v| + k |u| + |a|,  |u0'''| <= c |u0''| + k |v| + |d|/h
 */
static void map_fill(struct map *map, double k, double c, double h)
{
	double *column[4][2] = {
	    {&map->uu, &map->vu}, {&map->uv, &map->vv}, {&map->ua, &map->va}, {&map->ud, &map->vd}};
	double ch = c * h, kh = k * h * h;
	for (int j = 0; j < 4; j++) {
		double u = j == 0, w = j == 1 ? h : 0; // w: u' h
		double u_sum = 0, w_sum = 0;
		for (int n = 0; n < 20; n++) {
			double force = j == 2 && n == 0 ? h * h : j == 3 && n == 1 ? h * h : 0;
			double w_next = -(ch * w + kh * u + force) / (n + 1);
			u_sum += u;
			w_sum += w;
			u = w / (n + 1);
			w = w_next;
		}
		*column[j][0] = u_sum;
		*column[j][1] = w_sum / h;
	}
	map->stiffness = k;
	double a3_acc = 2 * (c + h * k), a4_acc = c * a3_acc + k * (1 + h * a3_acc); // per |u0''|
	double a4_jerk = (c + k * h) * 2; // per |u0'''| apart from c |u0''|
	double quartic = h * h * h * h * CUBIC_ERROR;
	map->eu = quartic * a4_acc * k;
	map->ev = quartic * (a4_acc * c + a4_jerk * k);
	map->ea = quartic * a4_acc;
	map->ed = quartic * a4_jerk / h;
}

/* Puts a body's current piece, and the map that belongs to it, into the columns. */
void pound_simulation_piece(struct simulation *sim, int i)
{
	const struct pound_piece *piece = &sim->at[i].piece;
	sim->x.stiffness[i] = piece->stiffness;
	sim->x.offset[i] = piece->offset;
	sim->x.low[i] = piece->low;
	sim->x.high[i] = piece->high;
	sim->x.direction[i] = piece->direction;
	if (sim->x.can_fly == 0)
		return;
	struct map *map = NULL;
	for (int m = 0; m < POUND_MAPS && !map; m++)
		if (sim->maps[i][m].stiffness == piece->stiffness)
			map = &sim->maps[i][m];
	if (!map) {
		map = &sim->maps[i][sim->map_next[i]];
		sim->map_next[i] = (sim->map_next[i] + 1) % POUND_MAPS;
		map_fill(map, piece->stiffness, sim->x.damping[i], sim->x.step);
	}
	struct column *x = &sim->x;
	x->uu[i] = map->uu, x->uv[i] = map->uv, x->ua[i] = map->ua, x->ud[i] = map->ud;
	x->vu[i] = map->vu, x->vv[i] = map->vv, x->va[i] = map->va, x->vd[i] = map->vd;
	x->eu[i] = map->eu, x->ev[i] = map->ev, x->ea[i] = map->ea, x->ed[i] = map->ed;
}

/* Enters the interval that ends at sim->next. */
void pound_simulation_interval(struct simulation *sim)
{
	const double *a = &sim->task->ground[sim->next];
	sim->x.ground = a[-1];
	sim->x.slope = (a[0] - a[-1]) / sim->x.step;
	sim->x.left = sim->x.step;
	sim->x.events = 0;
}

/* A simulation at the start of its task. */
void pound_simulation_start(struct simulation *sim, const struct pound_march_task *task,
                            struct pound_march_result *result)
{
	memset(sim, 0, sizeof *sim);
	memset(result, 0, sizeof *result);
	sim->task = task;
	sim->result = result;
	sim->next = 1;
	sim->last = task->n_samples - 1;
	struct column *x = &sim->x;
	double h = task->time_step;
	double rate = 0;
	bool can_fly = true;
	for (int i = 0; i < POUND_OSCILLATORS; i++) {
		const struct pound_march_body *body = &task->bodies[i];
		double k = body->skeleton.stiffness;
		double omega = sqrt(k);
		rate = fmax(rate, fmax(omega, body->damping));
		can_fly &= h * (body->damping + k * h) <= 0.5 && omega * h <= 1;
		x->u[i] = body->u, x->v[i] = body->v;
		x->top[i] = body->followed ? fabs(body->u) : DBL_MAX;
		x->damping[i] = body->damping;
		x->drive[i] = body->drive;
		for (int m = 0; m < POUND_MAPS; m++)
			sim->maps[i][m].stiffness = -1;
	}
	x->can_fly = can_fly;
	x->step = h;
	x->gap = task->contact ? task->gap : -NEVER;
	x->contact_stiffness = task->contact ? task->contact_stiffness : 0;
	x->contact_damping = task->contact ? task->contact_damping : 0;
	x->mass_ratio = task->mass_ratio;
	x->release = task->contact && !task->tension ? task->contact_damping / task->contact_stiffness : 0;
	double stiff = (1 + task->mass_ratio) * x->contact_stiffness;
	x->reach[0] = rate > 0 ? REACH_FREE / rate : DBL_MAX;
	x->reach[1] = REACH_TOUCH / sqrt(rate * rate + stiff);
	x->third = h / 3;
	x->error_turn = 384 * sqrt(3) / (216 * h);
	for (int i = 0; i < POUND_OSCILLATORS; i++) {
		pound_pieces_start(&task->bodies[i].skeleton, &sim->at[i]);
		pound_simulation_piece(sim, i);
	}
	pound_simulation_interval(sim);
}
