/* fixed_chain.c - Newmark's average acceleration and central differences for rows of buildings: fixed_step.c for n floors.
 *
 * 1. Steps, laws and contacts are treated as in fixed_step.c: contacts are checked at the end of each step.
 * 2. The matrix of a step is symmetric, and each story or contact couples few floors.  Floors are numbered story by story over
 *    all buildings, so that rows of the matrix are short (envelope.h).  The matrix is decomposed again if a branch or a contact
 *    changes.
 *
 * Two oscillators use fixed_step.c, which solves the pair in closed form in a quarter of the time.  Rows of one-story buildings
 * agree with it to rounding.
 */
#include <assert.h>
#include <float.h>
#include <math.h>
#include <stddef.h>
#include <string.h>

#include "engine/exact/counts.h"
#include "engine/numeric/envelope.h"
#include "engine/solver/fixed_step.h"
#include "engine/solver/solver.h"

enum { FLOORS = POUND_CHAIN_FLOORS, LINKS = POUND_CHAIN_LINKS, ENDS = 4 };

struct stepped_link {
	const struct pound_link *link;
	int n_ends;          /* number of floors that the contact acts on, without the ground */
	int floor[ENDS];     /* these floors */
	double weight[ENDS]; /* right side: < 0 */
	double inverse_mass; /* 1 over the effective mass [1/kg] */
	struct pound_touch touch, next;
	bool touching, touches; /* at the start and at the end of the step */
	double stiff;           /* coefficient of the contact in the matrix of the step; 0: none */
	double in_matrix;       /* ... in the matrix that is decomposed */
	double looked_at;       /* ... at the last check of stability (central_look) */
	double still, rate;     /* contact force at zero change and zero rate [N], and per rate [N s/m] */
	double p, q; /* overlap and its rate at the start of the step (central_solve: p at its end) [m], [m/s] */
	double change;  /* newmark: of the overlap in the step [m]; central difference: overlap rate at its end */
	double force;   /* [N] */
	double impulse; /* of the current contact [N s] */
	double time, counted_time; /* in contact; in contacts that count [s] */
	struct pound_counts_scale scale;
	double *measures; /* result  (POUND_LINK_MEASURES) */
};

/* Factors of the mass, damping and stiffness matrices in the matrix of a step; contacts enter by `stiff`. */
struct parts {
	double mass, dashpot, spring;
};

struct stepped_chain {
	const struct pound_chain_task *task;
	double step;   /* [s] */
	double time;   /* at the end of the step [s] */
	double ground; /* ground acceleration at the end of the step [m/s2] */
	int n, n_links;
	double u[FLOORS], v[FLOORS];
	double rate[FLOORS];         /* newmark: acceleration; central difference: velocity half a step later */
	double acceleration[FLOORS]; /* relative to the ground */
	double x[FLOORS], b[FLOORS]; /* solution and right-hand side of a step */
	double speed_max[FLOORS];    /* [m/s] */
	double spring[FLOORS];       /* story stiffnesses in the decomposed matrix [N/m] */
	struct pound_law_state at[FLOORS], next[FLOORS];
	struct stepped_link link[LINKS];
	double *measures;    /* result of floors  (n x POUND_FLOOR_MEASURES) */
	bool too_long;       /* step above the stability limit */
	int storeys[FLOORS]; /* [first floor of a building]: number of its floors */
	bool fresh;          /* the matrix must be decomposed before the next solve */
	int entries;
	struct pound_envelope matrix;
	int row[FLOORS]; /* row of each floor in the matrix */
	int first[FLOORS], begin[FLOORS];
	double solution[FLOORS]; /* in the order of the matrix rows */
	double values[FLOORS * (FLOORS + 1) / 2];
};

static_assert(sizeof(struct stepped_chain) <= POUND_CHAIN_SCRATCH_STRAIGHT,
              "a row fits into the work space of chains");

/* ---- the matrix ---- */

static int storeys_of(const struct pound_chain_task *task, int base)
{
	int n = 1;
	while (base + n < task->n_floors && !task->floors[base + n].base)
		n++;
	return n;
}

/* Numbers floors story by story over all buildings. */
static void rows_number(struct stepped_chain *c)
{
	int row = 0;
	for (int storey = 0; row < c->n; storey++)
		for (int base = 0, n; base < c->n; base += n) {
			n = c->storeys[base];
			if (storey < n)
				c->row[base + storey] = row++;
		}
}

/* Extends the envelope by the entry of two floors. */
static void couple(struct stepped_chain *c, int i, int j)
{
	const int upper = c->row[i] > c->row[j] ? c->row[i] : c->row[j], lower = c->row[i] + c->row[j] - upper;
	c->first[upper] = lower < c->first[upper] ? lower : c->first[upper];
}

/* Determines the envelope of all entries that any step may need. */
static void matrix_lay(struct stepped_chain *c)
{
	const struct pound_chain_task *task = c->task;
	rows_number(c);
	for (int i = 0; i < c->n; i++)
		c->first[i] = i;
	for (int base = 0, n; base < c->n; base += n) {
		n = c->storeys[base];
		for (int i = 1; i < n; i++)
			for (int j = task->floors[base].modal ? 0 : i - 1; j < i; j++)
				couple(c, base + i, base + j);
	}
	for (int k = 0; k < c->n_links; k++)
		for (int i = 0; i < c->link[k].n_ends; i++)
			for (int j = 0; j < i; j++)
				couple(c, c->link[k].floor[i], c->link[k].floor[j]);
	c->entries = pound_envelope_lay(&c->matrix);
}

static void matrix_add(struct stepped_chain *c, int i, int j, double value)
{
	pound_envelope_add(&c->matrix, c->row[i], c->row[j], value);
}

/* Modal damping coefficient of a floor for the velocity of floor j of its building [N s/m]. */
static double modal_entry(const struct pound_chain_floor *floor, int j, int storeys)
{
	return floor->modal[j] - (j + 1 < storeys ? floor->modal[j + 1] : 0);
}

static void matrix_fill(struct stepped_chain *c, const struct parts *parts)
{
	const struct pound_chain_task *task = c->task;
	memset(c->values, 0, sizeof(double) * (size_t)c->entries);
	for (int base = 0, n; base < c->n; base += n) {
		n = c->storeys[base];
		for (int i = base; i < base + n; i++) {
			const struct pound_chain_floor *floor = &task->floors[i];
			const double storey = parts->spring * c->spring[i] + parts->dashpot * floor->dashpot;
			matrix_add(c, i, i, (parts->mass + parts->dashpot * floor->mass_damping) * floor->mass + storey);
			if (!floor->base) {
				matrix_add(c, i - 1, i - 1, storey);
				matrix_add(c, i, i - 1, -storey);
			}
			for (int j = 0; floor->modal && j <= i - base; j++)
				matrix_add(c, i, base + j, parts->dashpot * modal_entry(floor, j, n));
		}
	}
	for (int k = 0; k < c->n_links; k++) {
		struct stepped_link *l = &c->link[k];
		l->in_matrix = l->stiff;
		for (int i = 0; i < l->n_ends && l->stiff != 0; i++)
			for (int j = 0; j <= i; j++)
				matrix_add(c, l->floor[i], l->floor[j], l->stiff * l->weight[i] * l->weight[j]);
	}
}

/* Solves the decomposed system with right-hand side b; solution in x, both in the order of floors. */
static void matrix_solve(struct stepped_chain *c)
{
	for (int i = 0; i < c->n; i++)
		c->solution[c->row[i]] = c->b[i];
	pound_envelope_solve(&c->matrix, c->solution);
	for (int i = 0; i < c->n; i++)
		c->x[i] = c->solution[c->row[i]];
}

/* Decomposes the matrix of a step, unless it is the same as before; false: it is not positive definite. */
static bool matrix_ready(struct stepped_chain *c, const struct parts *parts, const struct pound_law_state *at)
{
	bool same = !c->fresh;
	for (int i = 0; i < c->n && parts->spring != 0; i++) {
		same &= c->spring[i] == at[i].branch.stiffness;
		c->spring[i] = at[i].branch.stiffness;
	}
	for (int k = 0; k < c->n_links; k++)
		same &= c->link[k].stiff == c->link[k].in_matrix;
	if (same)
		return true;
	matrix_fill(c, parts);
	c->fresh = false;
	return pound_envelope_decompose(&c->matrix);
}

/* ---- forces ---- */

static double drift(const struct stepped_chain *c, const double *of, int i)
{
	return of[i] - (c->task->floors[i].base ? 0 : of[i - 1]);
}

/* The weighted sum over the floors of a contact: left side less right side. */
static double link_sum(const struct stepped_link *l, const double *of)
{
	double sum = 0;
	for (int k = 0; k < l->n_ends; k++)
		sum += l->weight[k] * of[l->floor[k]];
	return sum;
}

/* Adds a contact force to the forces on floors. */
static void link_push(const struct stepped_link *l, double force, double *pushed)
{
	for (int k = 0; k < l->n_ends; k++)
		pushed[l->floor[k]] -= l->weight[k] * force;
}

/* Adds a story force to the forces on the floors above and below the story. */
static void story_pull(const struct stepped_chain *c, int i, double force, double *pulled)
{
	pulled[i] -= force;
	if (!c->task->floors[i].base)
		pulled[i - 1] += force;
}

/* Adds the forces of springs at u on the given branches, and of dashpots at v times `dashpots`, to b. */
static void stories_pull(struct stepped_chain *c, const struct pound_law_state *at, double dashpots,
                         const double *v)
{
	const struct pound_chain_task *task = c->task;
	for (int base = 0, n; base < c->n; base += n) {
		n = c->storeys[base];
		for (int i = base; i < base + n; i++) {
			const struct pound_chain_floor *floor = &task->floors[i];
			const double rate = drift(c, v, i);
			story_pull(c, i,
			           pound_fixed_restoring(&at[i], drift(c, c->u, i)) + dashpots * floor->dashpot * rate,
			           c->b);
			c->b[i] -= dashpots * floor->mass_damping * floor->mass * v[i];
			for (int j = base; floor->modal && j < base + n; j++)
				c->b[i] -= dashpots * floor->modal[j - base] * drift(c, v, j);
		}
	}
}

/* ---- results ---- */

/* Magnitudes of the terms that accelerate a side of a contact, whose rounding errors are in its velocity. */
static struct pound_counts_body side_of(const struct stepped_chain *c, const struct stepped_link *l, int side)
{
	struct pound_counts_body b = {.ground = c->ground};
	double damping = DBL_MAX;
	for (int k = 0; k < l->n_ends; k++) {
		const int i = l->floor[k];
		const struct pound_chain_floor *floor = &c->task->floors[i];
		const double weight = fabs(l->weight[k]) / floor->mass;
		if ((l->weight[k] < 0) != side)
			continue;
		b.v += fabs(l->weight[k]) * c->v[i];
		b.offset += weight * fabs(pound_fixed_restoring(&c->at[i], drift(c, c->u, i)));
		if (i + 1 < c->n && !floor[1].base)
			b.offset += weight * fabs(pound_fixed_restoring(&c->at[i + 1], drift(c, c->u, i + 1)));
		damping = fmin(damping, floor->mass_damping + floor->dashpot / floor->mass);
	}
	b.damping = damping == DBL_MAX ? 0 : damping;
	return b;
}

/* Records a contact at its end or at the end of the signal; one that does not count (counts.h) adds no contact and no time. */
static void contact_over(const struct stepped_chain *c, struct stepped_link *l)
{
	double *m = l->measures, reach = l->link->gap;
	for (int k = 0; k < l->n_ends; k++)
		reach += fabs(l->weight[k] * c->u[l->floor[k]]);
	const bool power = pound_contact_force(l->link->law.model) == POUND_FORCE_POWER;
	const double stiff = l->inverse_mass * l->link->law.stiffness * (power ? 1.5 * sqrt(reach) : 1);
	const struct pound_counts counts = {.body = {side_of(c, l, 0), side_of(c, l, 1)},
	                                    .time = c->time,
	                                    .blur = sqrt(stiff) * reach,
	                                    .steps = (l->time - l->counted_time) / c->step,
	                                    .changed = l->inverse_mass * l->impulse + fabs(link_sum(l, c->v))};
	m[POUND_LINK_IMPULSE_MAX] = fmax(m[POUND_LINK_IMPULSE_MAX], l->impulse);
	if (pound_contact_counts(&counts, &l->scale)) {
		m[POUND_LINK_CONTACTS]++;
		l->counted_time = l->time;
	} else
		l->time = l->counted_time;
}

/* Updates the result of a contact at the end of a step; for impulses the force is linear within a step. */
static void link_note(const struct stepped_chain *c, struct stepped_link *l, double force)
{
	double *m = l->measures;
	if (l->touches && !l->touching) {
		if (m[POUND_LINK_CONTACTS] == 0)
			m[POUND_LINK_FIRST_TIME] = c->time, m[POUND_LINK_FIRST_SPEED] = l->q;
		l->impulse = 0;
	}
	l->impulse += 0.5 * (l->force + force) * c->step;
	if (l->touches)
		l->time += c->step;
	else if (l->touching)
		contact_over(c, l);
	l->touching = l->touches;
	l->force = force;
	m[POUND_LINK_FORCE_MAX] = fmax(m[POUND_LINK_FORCE_MAX], force);
}

static void keep_largest(double *largest, double value)
{
	if (fabs(value) > *largest)
		*largest = fabs(value);
}

/* Updates the results of floors at the end of a step; false: a velocity exceeds its limit (chain_start). */
static bool floors_note(struct stepped_chain *c)
{
	bool slow = true;
	for (int i = 0; i < c->n; i++) {
		double *m = &c->measures[i * POUND_FLOOR_MEASURES];
		keep_largest(&m[POUND_FLOOR_DRIFT_MAX], drift(c, c->u, i));
		keep_largest(&m[POUND_FLOOR_DISPLACEMENT_MAX], c->u[i]);
		keep_largest(&m[POUND_FLOOR_ACCELERATION_MAX], c->acceleration[i] + c->ground);
		slow &= fabs(c->v[i]) <= c->speed_max[i]; // false for NAN
	}
	return slow;
}

/* ---- Newmark ---- */

/* Solves for the change of displacements on the assumed branches; false: the matrix is not positive definite. */
static bool newmark_solve(struct stepped_chain *c)
{
	const double h = c->step;
	const struct parts parts = {.mass = 4 / (h * h), .dashpot = 2 / h, .spring = 1};
	for (int k = 0; k < c->n_links; k++) {
		struct stepped_link *l = &c->link[k];
		struct pound_fixed_force force = {0};
		if (l->touches)
			force = pound_fixed_force_over(&l->next.on, l->p, l->p + l->change);
		l->stiff = force.slope + force.rate * (2 / h);
		l->still = force.still - force.rate * l->q;
	}
	if (!matrix_ready(c, &parts, c->next))
		return false;
	for (int i = 0; i < c->n; i++)
		c->b[i] = c->task->floors[i].mass * (4 / h * c->v[i] + c->rate[i] - c->ground);
	stories_pull(c, c->next, -1, c->v);
	for (int k = 0; k < c->n_links; k++)
		link_push(&c->link[k], c->link[k].still, c->b);
	matrix_solve(c);
	return true;
}

/* Updates the assumed branches and contacts from a solution; as_it_was: contacts stay as at the start of the step.
 *
 * Returns  value   whether nothing has changed
 */
static bool newmark_round(struct stepped_chain *c, bool as_it_was)
{
	bool converged = true;
	for (int i = 0; i < c->n; i++) {
		struct pound_law_state next = c->at[i];
		const double from = drift(c, c->u, i);
		pound_fixed_follow(&c->task->floors[i].story, &next, from, from + drift(c, c->x, i));
		converged &= pound_fixed_same_law(&next, &c->next[i]);
		c->next[i] = next;
	}
	for (int k = 0; k < c->n_links; k++) {
		struct stepped_link *l = &c->link[k];
		const struct pound_contact_law *law = &l->link->law;
		const double before = l->p + l->change, change = link_sum(l, c->x), p = l->p + change;
		const struct pound_touch next = pound_fixed_touch(law, &l->touch, l->touching, l->p, p, l->q);
		const bool touches =
		    as_it_was ? l->touching : pound_fixed_touches(law, &next, p, 2 / c->step * change - l->q);
		converged &= touches == l->touches && (!touches || pound_fixed_same_touch(&next, &l->next)) &&
		             (!touches || l->next.on.form == POUND_TOUCH_STRAIGHT ||
		              fabs(p - before) <= POUND_FIXED_SETTLED * fabs(p));
		l->touches = touches;
		l->next = next;
		l->change = change;
	}
	return converged;
}

/* One step of average acceleration, as for the pair (fixed_step.c); false: no solution, or the iteration has not converged.
 *
 *   (4/h^2 M + 2/h C + K) d = M (4/h v + a - a_g) + C v - r(u) - contacts,   v1 = 2 d/h - v,  a1 = 2 (v1 - v)/h - a
 */
static bool newmark_advance(struct stepped_chain *c)
{
	const double h = c->step;
	bool converged = false;
	memcpy(c->next, c->at, sizeof *c->at * (size_t)c->n);
	for (int k = 0; k < c->n_links; k++) {
		c->link[k].next = c->link[k].touch;
		c->link[k].touches = c->link[k].touching;
		c->link[k].change = 0;
	}
	for (int round = 0; round < 2 * POUND_FIXED_ROUNDS && !converged; round++) {
		if (!newmark_solve(c))
			return false;
		converged = newmark_round(c, round >= POUND_FIXED_ROUNDS);
	}
	for (int i = 0; i < c->n; i++) {
		const double v = 2 / h * c->x[i] - c->v[i];
		c->rate[i] = c->acceleration[i] = 2 / h * (v - c->v[i]) - c->rate[i];
		c->v[i] = v;
		c->u[i] += c->x[i];
		c->at[i] = c->next[i];
	}
	for (int k = 0; k < c->n_links; k++) {
		struct stepped_link *l = &c->link[k];
		const double p = link_sum(l, c->u) - l->link->gap, q = link_sum(l, c->v);
		l->touch = l->next;
		link_note(c, l, l->touches ? pound_contact_force_on(&l->touch.on, p, q) : 0);
	}
	return converged;
}

/* ---- central differences ---- */

/* Whether the step is below 2/w, w: highest angular frequency of the floors with the contacts that touch.
 *
 * The condition is that 4/h^2 M - K is positive definite, with the initial stiffnesses of the stories, which are the largest.
 */
static bool central_stable(struct stepped_chain *c)
{
	const struct parts parts = {.mass = 4 / (c->step * c->step), .spring = -1};
	for (int i = 0; i < c->n; i++)
		c->spring[i] = c->task->floors[i].story.stiffness;
	matrix_fill(c, &parts);
	c->fresh = true;
	return pound_envelope_decompose(&c->matrix);
}

/* Checks the stability of the step if a contact is stiffer than at the last check. */
static void central_look(struct stepped_chain *c)
{
	bool stiffer = false;
	for (int k = 0; k < c->n_links; k++) {
		struct stepped_link *l = &c->link[k];
		l->stiff = l->touches ? -pound_contact_line(&l->next.on, l->p).slope : 0;
		stiffer |= l->stiff < l->looked_at;
	}
	if (!stiffer)
		return;
	for (int k = 0; k < c->n_links; k++)
		c->link[k].looked_at = c->link[k].stiff;
	c->too_long |= !central_stable(c);
}

/* Solves for the velocities half a step later, with all contacts that touch.
 *
 * Returns  value   false: a force without tension would pull; that contact is released, and must be solved without it
 */
static bool central_solve(struct stepped_chain *c)
{
	const struct parts parts = {.mass = 1 / c->step, .dashpot = 0.5};
	bool pushes = true;
	for (int k = 0; k < c->n_links; k++)
		c->link[k].stiff = c->link[k].touches ? c->link[k].rate / 2 : 0;
	// masses and dashpots are positive and contacts add to them, so the matrix is positive definite but for overflow
	if (!matrix_ready(c, &parts, c->at))
		c->too_long = true;
	for (int i = 0; i < c->n; i++)
		c->b[i] = c->task->floors[i].mass * (c->rate[i] / c->step - c->ground);
	stories_pull(c, c->at, 0.5, c->rate);
	for (int k = 0; k < c->n_links; k++) {
		const struct stepped_link *l = &c->link[k];
		if (l->touches)
			link_push(l, l->still + l->rate * (link_sum(l, c->rate) / 2), c->b);
	}
	matrix_solve(c);
	for (int k = 0; k < c->n_links; k++) {
		struct stepped_link *l = &c->link[k];
		if (!l->touches)
			continue;
		const double q = (link_sum(l, c->rate) + link_sum(l, c->x)) / 2;
		l->touches = pound_fixed_touches(&l->link->law, &l->next, l->p, q);
		l->change = q;
		pushes &= l->touches;
	}
	return pushes;
}

/* One step of central differences with velocities w half a step before and after, as for the pair (fixed_step.c):
 *
 *   M (w1 - w)/h + C (w1 + w)/2 + r(u) + contacts = -M a_g,   v = (w1 + w)/2
 */
static bool central_advance(struct stepped_chain *c)
{
	const double h = c->step;
	for (int i = 0; i < c->n; i++)
		c->b[i] = drift(c, c->u, i);
	for (int i = 0; i < c->n; i++)
		c->u[i] += h * c->rate[i];
	for (int i = 0; i < c->n; i++)
		pound_fixed_follow(&c->task->floors[i].story, &c->at[i], c->b[i], drift(c, c->u, i));
	for (int k = 0; k < c->n_links; k++) {
		struct stepped_link *l = &c->link[k];
		const double p = link_sum(l, c->u) - l->link->gap;
		l->touches = p > 0;
		if (l->touches) {
			l->next = pound_fixed_touch(&l->link->law, &l->touch, l->touching, l->p, p, l->q);
			const struct pound_touch_line line = pound_contact_line(&l->next.on, p);
			l->still = line.still, l->rate = line.rate;
		}
		l->p = p;
	}
	for (int left = c->n_links; !central_solve(c) && left > 0;)
		left--; // each round releases at least one contact
	for (int i = 0; i < c->n; i++) {
		c->v[i] = (c->rate[i] + c->x[i]) / 2;
		c->acceleration[i] = (c->x[i] - c->rate[i]) / h;
		c->rate[i] = c->x[i];
	}
	for (int k = 0; k < c->n_links; k++) {
		struct stepped_link *l = &c->link[k];
		l->touch = l->touches ? l->next : l->touch;
		link_note(c, l, l->touches ? l->still + l->rate * l->change : 0);
	}
	central_look(c);
	return true;
}

/* ---- from the start of a task to its end ---- */

static void link_start(const struct pound_chain_task *task, int k, double *measures, struct stepped_link *l)
{
	*l = (struct stepped_link){.link = &task->links[k], .measures = measures, .p = -task->links[k].gap};
	for (int side = 0; side < 2; side++)
		for (int end = 0; end < 2; end++) {
			const int i = l->link->floor[side][end];
			const double weight = l->link->weight[side][end];
			if (i == POUND_CHAIN_GROUND || weight == 0)
				continue;
			l->floor[l->n_ends] = i;
			l->weight[l->n_ends++] = side ? -weight : weight;
			l->inverse_mass += weight * weight / task->floors[i].mass;
		}
	for (int j = 0; j < POUND_LINK_MEASURES; j++)
		measures[j] = 0;
}

/* Fills the state of a row at rest, with the initial accelerations in `rate`.
 *
 * Velocities are limited by the work of the ground motion: speed_limits in fixed_step.c has the formula. */
static void chain_start(struct stepped_chain *c, const struct pound_chain_task *task,
                        struct pound_chain_result *result, int n_steps)
{
	memset(c, 0, offsetof(struct stepped_chain, values));
	c->task = task;
	c->step = task->time_step / n_steps;
	c->n = task->n_floors;
	c->n_links = task->n_links;
	c->measures = result->floors;
	c->fresh = true;
	c->matrix = (struct pound_envelope){c->n, c->first, c->begin, c->values};
	double push = 0, mass = 0;
	for (int t = 0; t < task->n_samples; t++)
		push += fabs(task->ground[t]) * task->time_step;
	for (int i = 0; i < c->n; i++)
		mass += task->floors[i].mass;
	for (int base = 0; base < c->n; base += c->storeys[base])
		c->storeys[base] = storeys_of(task, base);
	for (int i = 0; i < c->n; i++) {
		pound_law_start(&task->floors[i].story, &c->at[i]);
		c->rate[i] = -task->ground[0];
		c->speed_max[i] = POUND_FIXED_UNSTABLE * sqrt(mass / task->floors[i].mass) * push;
		for (int j = 0; j < POUND_FLOOR_MEASURES; j++)
			c->measures[i * POUND_FLOOR_MEASURES + j] = 0;
	}
	for (int k = 0; k < c->n_links; k++)
		link_start(task, k, result->links + k * POUND_LINK_MEASURES, &c->link[k]);
	matrix_lay(c);
}

static void chain_end(struct stepped_chain *c, struct pound_chain_result *result, enum pound_status status)
{
	const unsigned asked = c->task->asked;
	*result = (struct pound_chain_result){
	    .status = status, .floors = result->floors, .links = result->links, .energy_residual = NAN};
	for (int k = 0; k < c->n_links; k++) {
		struct stepped_link *l = &c->link[k];
		double *m = l->measures;
		if (l->touching)
			contact_over(c, l);
		m[POUND_LINK_TIME] = l->time;
		m[POUND_LINK_FORCE_MAX] = asked & POUND_CHAIN_FORCES ? m[POUND_LINK_FORCE_MAX] : NAN;
		if (m[POUND_LINK_CONTACTS] == 0)
			m[POUND_LINK_FIRST_TIME] = m[POUND_LINK_FIRST_SPEED] = 0;
	}
	for (int i = 0; i < c->n; i++) {
		double *m = &c->measures[i * POUND_FLOOR_MEASURES];
		const struct pound_backbone *story = &c->task->floors[i].story;
		m[POUND_FLOOR_SHEAR_MAX] = pound_law_envelope(story, m[POUND_FLOOR_DRIFT_MAX]);
		m[POUND_FLOOR_RESIDUAL] = pound_law_residual(story, &c->at[i], drift(c, c->u, i));
		m[POUND_FLOOR_END_U] = c->u[i];
		m[POUND_FLOOR_END_V] = c->v[i];
		if (!(asked & POUND_CHAIN_DRIFTS))
			m[POUND_FLOOR_DRIFT_MAX] = m[POUND_FLOOR_SHEAR_MAX] = NAN;
		if (!(asked & POUND_CHAIN_DISPLACEMENTS))
			m[POUND_FLOOR_DISPLACEMENT_MAX] = NAN;
		if (!(asked & POUND_CHAIN_ACCELERATIONS))
			m[POUND_FLOOR_ACCELERATION_MAX] = NAN;
	}
}

typedef bool advance(struct stepped_chain *c);

static enum pound_status chain_run(struct stepped_chain *c, int n_steps, advance *step,
                                   const atomic_bool *stop)
{
	const struct pound_chain_task *task = c->task;
	for (int t = 1; t < task->n_samples; t++) {
		const double from = task->ground[t - 1], rise = (task->ground[t] - from) / n_steps;
		for (int k = 1; k <= n_steps; k++) {
			c->time = (t - 1) * task->time_step + k * c->step;
			c->ground = from + rise * k;
			for (int j = 0; j < c->n_links; j++) {
				c->link[j].p = link_sum(&c->link[j], c->u) - c->link[j].link->gap;
				c->link[j].q = link_sum(&c->link[j], c->v);
			}
			const bool converged = step(c), slow = floors_note(c);
			if (!converged || !slow || c->too_long)
				return POUND_UNSTABLE;
		}
		if (pound_stopped(stop))
			return POUND_STOPPED;
	}
	return POUND_OK;
}

/* The response of a row of buildings by Newmark's average acceleration.
 *
 * Given    solver    step      s       longest step
 *          task      -         -       see chain.h
 *          stop      -         -       checked between samples; NULL: never
 * Returns  result    -         -       as from the exact solver; energy_residual NAN
 * Status   POUND_UNSTABLE  a step had no solution or did not converge, or a velocity exceeded its limit (chain_start)
 *          POUND_STOPPED   stop was set
 * Memory   scratch: POUND_CHAIN_SCRATCH_STRAIGHT bytes, 64-byte aligned
 *
 * Test     unit_solver_rows
 */
void pound_fixed_newmark_row(const struct pound_solver *solver, const struct pound_chain_task *task,
                             struct pound_chain_result *result, void *scratch, const atomic_bool *stop)
{
	struct stepped_chain *c = scratch;
	const int n_steps = pound_fixed_steps(task->time_step, solver->step);
	chain_start(c, task, result, n_steps);
	chain_end(c, result, chain_run(c, n_steps, newmark_advance, stop));
}

/* The response of a row of buildings by central differences; explicit in springs, implicit in dashpots.
 *
 * Given    as pound_fixed_newmark_row
 * Returns  as pound_fixed_newmark_row
 * Status   POUND_UNSTABLE  the step exceeds 2/w, w: highest angular frequency of the floors with the contacts that touch; or
 *                          a velocity exceeded its limit (chain_start)
 *          POUND_STOPPED   stop was set
 * Memory   as pound_fixed_newmark_row
 *
 * Test     unit_solver_rows
 */
void pound_fixed_central_row(const struct pound_solver *solver, const struct pound_chain_task *task,
                             struct pound_chain_result *result, void *scratch, const atomic_bool *stop)
{
	struct stepped_chain *c = scratch;
	const int n_steps = pound_fixed_steps(task->time_step, solver->step);
	chain_start(c, task, result, n_steps);
	for (int i = 0; i < c->n; i++)
		c->rate[i] *= c->step / 2;
	c->too_long = !central_stable(c);
	chain_end(c, result, chain_run(c, n_steps, central_advance, stop));
}
