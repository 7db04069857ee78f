/* adaptive_guards.c - events that end a step of the adaptive solver: reversals of rates, ends of branches, and contacts that
 * begin or end. */
#include "engine/solver/adaptive.h"

#include <float.h>
#include <math.h>

struct rate pound_adaptive_rate(const struct adaptive_task *c, const struct guard *g, const double *y,
                                const double *dydt)
{
	const struct adaptive_scene *s = &c->scene;
	const int q = overlap_state(s, g->of) + 1;
	if (g->kind == TURN)
		return (struct rate){y[rate_state(g->of)], dydt[rate_state(g->of)]};
	if (g->kind == TURN_FLOOR)
		return (struct rate){pound_adaptive_velocity(s, g->of, y), pound_adaptive_velocity(s, g->of, dydt)};
	if (g->kind == TURN_OVERLAP)
		return (struct rate){y[q], dydt[q]};
	const double release = s->links[g->of].release;
	return (struct rate){y[q] + release * dydt[q],
	                     dydt[q] + release * pound_adaptive_jerk(s, g->of, y, dydt)};
}

/* Rate of a contact force over its stiffness [m/s]. */
static double force_rate(const struct adaptive_task *c, int k, double t, const double *y)
{
	double *dydt = c->scale + c->scene.n_states; // the spare row behind `scale`
	pound_adaptive_derivative(t, y, dydt, (void *)&c->scene);
	const int q = overlap_state(&c->scene, k) + 1;
	return y[q] + c->scene.links[k].release * dydt[q];
}

/* A value with the sign of a contact force; of a rigid contact the acceleration that presses its sides together. */
static double force_sign(const struct adaptive_task *c, int k, double t, const double *y)
{
	const struct adaptive_link *l = &c->scene.links[k];
	const double p = y[overlap_state(&c->scene, k)], q = y[overlap_state(&c->scene, k) + 1];
	if (l->held)
		return pound_adaptive_apart(&c->scene, k, t, y);
	if (l->law.stiffness > 0 && !l->law.tension && l->touch.on.form == POUND_TOUCH_ROOT)
		return pound_contact_force_on(&l->touch.on, p, q) / l->law.stiffness;
	return p + l->release * q; // per stiffness
}

/* Value of a guard: above 0 once its event has happened. */
double pound_adaptive_guard(const struct adaptive_task *c, const struct guard *g, double t, const double *y)
{
	const struct adaptive_scene *s = &c->scene;
	const struct adaptive_link *l = g->of < s->n_links ? &s->links[g->of] : NULL;
	const int p = overlap_state(s, g->of);
	switch (g->kind) {
	case TURN:
		return g->way == 0 ? -1 : -g->way * y[rate_state(g->of)];
	case TURN_OVERLAP:
		return g->way == 0 ? -1 : -g->way * y[p + 1];
	case TURN_FORCE:
		return g->way == 0 ? -1 : -g->way * force_rate(c, g->of, t, y);
	case TURN_FLOOR:
		return g->way == 0 ? -1 : -g->way * pound_adaptive_velocity(s, g->of, y);
	case LOW:
		return s->floors[g->of].at.branch.low - y[drift_state(g->of)];
	case HIGH:
		return y[drift_state(g->of)] - s->floors[g->of].at.branch.high;
	case CONTACT:
		return !l->meets     ? -1
		       : l->touching ? -force_sign(c, g->of, t, y)
		       : l->parted   ? force_sign(c, g->of, t, y)
		                     : y[p];
	case CLEARS:
		return l->parted ? -y[p] : -1;
	case TOUCH_LOW:
		return l->touching && l->touch.on.low > 0 ? l->touch.on.low - y[p] : -1;
	case TOUCH_HIGH:
		return l->touching && l->touch.on.high < DBL_MAX ? y[p] - l->touch.on.high : -1;
	case KINDS:
		break;
	}
	return -1;
}

static double sign(double x)
{
	return (x > 0) - (x < 0);
}

/* Sign of the rate before its reversal: the direction of the branch if it has one, else the present sign; 0: no event. */
static double way_of(const struct adaptive_task *c, const struct guard *g)
{
	const struct adaptive_scene *s = &c->scene;
	if (g->kind == TURN_FLOOR)
		return sign(pound_adaptive_velocity(s, g->of, c->y));
	if (g->kind == TURN) {
		const double direction = s->floors[g->of].at.branch.direction;
		return direction != 0 ? direction : sign(c->y[rate_state(g->of)]);
	}
	const struct adaptive_link *l = &s->links[g->of];
	if (g->kind == TURN_OVERLAP) {
		const double direction = l->touching ? l->touch.on.direction : 0;
		return !l->meets || l->held ? 0
		       : direction != 0     ? direction
		                            : sign(c->y[overlap_state(s, g->of) + 1]);
	}
	// TURN_FORCE: only a contact that ends at zero force needs it
	const bool forced = l->release > 0 && (l->touching || l->parted);
	return forced ? sign(force_rate(c, g->of, c->t, c->y)) : 0;
}

void pound_adaptive_ways(struct adaptive_task *c)
{
	for (int j = 0; j < c->n_turns; j++)
		c->guards[j].way = way_of(c, &c->guards[j]);
}

/* Whether a reversal ends a branch of a law or of a contact force. */
bool pound_adaptive_turn_ends(const struct adaptive_task *c, const struct guard *g)
{
	if (g->kind == TURN)
		return c->scene.floors[g->of].at.branch.direction != 0;
	if (g->kind != TURN_OVERLAP)
		return false;
	const struct adaptive_link *l = &c->scene.links[g->of];
	return l->touching && l->touch.on.direction != 0;
}

/* The interior maximum of the cubic Hermite interpolant of a guard over a step.
 *
 * Given    g, d   guard, and its rate times the step, at both ends; g <= 0
 * Returns  value  fraction of the step; 0: there is no interior maximum, or its estimate plus a margin is not above 0
 */
double pound_adaptive_hump(const double g[2], const double d[2])
{
	if (!(d[0] > 0 && d[1] < 0))
		return 0;
	const double rise = g[1] - g[0], b = 3 * rise - 2 * d[0] - d[1], a = d[0] + d[1] - 2 * rise;
	// the root in (0, 1) of the cubic's derivative d0 + 2 b s + 3 a s^2
	const double s = d[0] / (sqrt(b * b - 3 * a * d[0]) - b);
	const double top = g[0] + s * (d[0] + s * (b + s * a)), height = top - fmax(g[0], g[1]);
	// margin for the interpolation error: a quarter of the height
	return top + 0.25 * height > 0 ? s : 0;
}

/* Estimated bound of |x| over a step of h, from values and rates at both ends. */
static double reach(double x0, double x1, double v0, double v1, double h)
{
	return fmax(fabs(x0), fabs(x1)) + h * fmax(fabs(v0), fabs(v1));
}

/* Displacement of a floor relative to the ground [m]. */
static double displacement(const struct adaptive_task *c, int i, const double *y)
{
	double u = 0;
	for (int j = c->scene.floors[i].base; j <= i; j++)
		u += y[drift_state(j)];
	return u;
}

/* Whether a reversal in a step of h that ends at y may be a new largest value, or may hide the end of a branch or a contact. */
bool pound_adaptive_turn_matters(const struct adaptive_task *c, const struct guard *g, double h,
                                 const double *y)
{
	const struct adaptive_scene *s = &c->scene;
	const double *m = &c->floor_measures[g->of * POUND_FLOOR_MEASURES];
	if (!c->many || g->kind >= TURNS || pound_adaptive_turn_ends(c, g) || g->kind == TURN_FORCE)
		return true;
	if (g->kind == TURN_FLOOR)
		return reach(displacement(c, g->of, c->y), displacement(c, g->of, y),
		             pound_adaptive_velocity(s, g->of, c->y), pound_adaptive_velocity(s, g->of, y),
		             h) > m[POUND_FLOOR_DISPLACEMENT_MAX];
	const int x = g->kind == TURN ? drift_state(g->of) : overlap_state(s, g->of);
	if (g->kind == TURN) {
		const struct pound_branch *on = &s->floors[g->of].at.branch;
		const double most = reach(c->y[x], y[x], c->y[x + 1], y[x + 1], h);
		return most > fmin(m[POUND_FLOOR_DRIFT_MAX], fmin(fabs(on->low), fabs(on->high)));
	}
	const struct adaptive_link *l = &s->links[g->of];
	return l->touching || l->parted || reach(0, 0, c->y[x + 1], y[x + 1], h) > -fmax(c->y[x], y[x]);
}

void pound_adaptive_guards_lay(struct adaptive_task *c, unsigned asked)
{
	const struct adaptive_scene *s = &c->scene;
	for (enum kind kind = TURN; kind < KINDS; kind++) {
		const bool of_links = kind == TURN_OVERLAP || kind == TURN_FORCE || kind == CONTACT || kind >= CLEARS;
		for (int i = 0; i < (of_links ? s->n_links : s->n); i++)
			// the drift of a first story is the displacement of its floor
			if (kind != TURN_FLOOR || (asked & POUND_CHAIN_DISPLACEMENTS && s->floors[i].inner))
				c->guards[c->n_guards++] = (struct guard){.kind = kind, .of = i};
		if (kind == TURNS - 1)
			c->n_turns = c->n_guards;
	}
}
