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
 * With A2, A3, A4 the largest second, third and fourth derivatives inside and h (c + k h) <= 1/2:
 *   A3 <= 2 (J0 + h k A0),  A2 <= A0 + h A3,  A4 <= c A3 + k A2,  error <= A4 h^4/384
 *   A0 = c |v| + k |u| + |a|,  J0 = c A0 + k |v| + |d|/h
 */
static void map_fill(struct map *map, double k, double c, double h)
{
	double *column[4] = {&map->uu, &map->uv, &map->ua, &map->ud};
	double ch = c * h, kh = k * h * h;
	for (int j = 0; j < 4; j++) {
		double u = j == 0, w = j == 1 ? h : 0; // w: u' h
		double sum = 0;
		for (int n = 0; n < 20; n++) {
			double force = j == 2 && n == 0 ? h * h : j == 3 && n == 1 ? h * h : 0;
			double next = -(ch * w + kh * u + force) / (n + 1);
			sum += u;
			u = w / (n + 1);
			w = next;
		}
		*column[j] = sum;
	}
	double quartic = h * h * h * h * CUBIC_ERROR, rate = c + k * h;
	map->stiffness = k;
	map->ej = quartic * 2 * rate;
	map->ea = quartic * (k + 2 * rate * rate);
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
	x->ea[i] = map->ea, x->ej[i] = map->ej;
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
	bool can_fly = !task->accounted; // the work in a step is that of its series
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
	sim->accounted = task->accounted;
	x->right_mass = task->mass_ratio > 0 ? 1 / task->mass_ratio : 0;
	sim->paired = task->contact || task->bodies[1].drive != 0;
	sim->edged = !pound_pieces_linear(task->bodies[0].skeleton.law) ||
	             !pound_pieces_linear(task->bodies[1].skeleton.law);
	x->step = h;
	x->pace = 1;
	x->gap = task->contact ? task->gap : -NEVER;
	x->contact_stiffness = task->contact ? task->contact_stiffness : 0;
	x->contact_damping = task->contact ? task->contact_damping : 0;
	x->mass_ratio = task->mass_ratio;
	x->release = task->contact && !task->tension ? task->contact_damping / task->contact_stiffness : 0;
	double stiff = (1 + task->mass_ratio) * x->contact_stiffness;
	x->reach[0] = rate > 0 ? REACH_FREE / rate : DBL_MAX;
	x->reach[1] = REACH_TOUCH / sqrt(rate * rate + stiff);
	x->third = h / 3;
	x->per_step = 1 / h;
	for (int i = 0; i < POUND_OSCILLATORS; i++) {
		pound_pieces_start(&task->bodies[i].skeleton, &sim->at[i]);
		pound_simulation_piece(sim, i);
	}
	pound_simulation_interval(sim);
}

/* What is missing of the energy put in, by the ground and by the motion at the start. */
double pound_simulation_residual(const struct simulation *sim)
{
	const struct column *x = &sim->x;
	double start = 0, end = 0;
	for (int i = 0; i < POUND_OSCILLATORS; i++) {
		double mass = i ? x->right_mass : 1, v0 = sim->task->bodies[i].v;
		start += 0.5 * mass * v0 * v0;
		end += 0.5 * mass * x->v[i] * x->v[i];
	}
	double put_in = start + x->work_in, found = end + x->work_out;
	double most = fmax(fabs(put_in), fmax(start, end));
	return most > 0 ? fabs(found - put_in) / most : 0;
}
