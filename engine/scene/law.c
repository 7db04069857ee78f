/* law.c - the constitutive laws, one function and one row each.
 *
 * A law's function makes the next branch from the current branch, the edge that was reached and the displacement u there:
 *
 *   - Every law starts on the elastic branch of the first slope between -d_y and d_y; shared_start.inl relies on this.
 *   - A branch that begins at one of its edges has this edge equal to u to the last bit, or the solver would cross it at once.
 *   - Force is continuous across edges, to 4e-16 of its size (unit_law).  A branch may have zero width.
 *   - |force| is at most the backbone's at the largest |u| so far: pound_law_envelope() is the largest shear.
 *   - The next branch may depend on number, branch, memory, edge and u, and on nothing else of the run.
 *
 * Adding a law: the row 'a law' of the table of additions in engine/rooms.md. */
#include "engine/scene/law.h"

#include <float.h>
#include <math.h>
#include <stddef.h>

#include "engine/pound.h"

enum { CENTER, RIGHT, LEFT, RIGHT_SECANT, LEFT_SECANT };

enum { BRANCHES_BACK = 8 /* passed while unloading to force 0: more than any law has */ };

/* The branch of the backbone curve beyond the yield point on one side (+1 right, -1 left). */
static struct pound_branch hardened(const struct pound_backbone *s, double side)
{
	return (struct pound_branch){.stiffness = s->hardening * s->stiffness,
	                             .offset = side * (1 - s->hardening) * s->stiffness * s->yield,
	                             .low = -DBL_MAX,
	                             .high = DBL_MAX};
}

static void linear(const struct pound_backbone *s, struct pound_law_state *at, enum pound_edge edge, double u)
{
	(void)edge, (void)u;
	at->branch = (struct pound_branch){.stiffness = s->stiffness, .low = -DBL_MAX, .high = DBL_MAX};
}

/* Kinematic hardening: an elastic range of width 2 yield whose center, memory[0], plastic flow moves. */
static void elastoplastic(const struct pound_backbone *s, struct pound_law_state *at, enum pound_edge edge,
                          double u)
{
	if (at->number == CENTER && edge != POUND_EDGE_REVERSAL) {
		double side = edge == POUND_EDGE_HIGH ? 1 : -1;
		at->number = edge == POUND_EDGE_HIGH ? RIGHT : LEFT;
		at->branch = hardened(s, side);
		at->branch.direction = side;
		return;
	}
	if (at->number != CENTER)
		at->memory[0] = at->number == RIGHT ? u - s->yield : u + s->yield;
	double center = at->memory[0];
	// the edge where the branch starts is set to u itself: equal to the last bit
	double high = at->number == RIGHT ? u : center + s->yield;
	double low = at->number == LEFT ? u : center - s->yield;
	at->number = CENTER;
	at->branch = (struct pound_branch){.stiffness = s->stiffness,
	                                   .offset = -(1 - s->hardening) * s->stiffness * center,
	                                   .low = low,
	                                   .high = high};
}

/* (1 - r) c, c the center of the elastic range, r the hardening ratio; if r |c| > d_y: (1 - r) d_y/r with the sign of c.
 *
 * Source   the project's design pages, buildings.md 2
 * Test     unit_row_results: rows_have_their_known_answers
 */
static double elastoplastic_residual(const struct pound_backbone *s, const struct pound_law_state *at,
                                     double u)
{
	const double center = at->number == CENTER  ? at->memory[0]
	                      : at->number == RIGHT ? u - s->yield
	                                            : u + s->yield;
	if (s->hardening * fabs(center) > s->yield)
		return copysign((1 - s->hardening) * s->yield / s->hardening, center);
	return (1 - s->hardening) * center;
}

/* Loads and unloads on the backbone curve. */
static void nonlinear_elastic(const struct pound_backbone *s, struct pound_law_state *at,
                              enum pound_edge edge, double u)
{
	(void)u;
	if (at->number != CENTER || edge == POUND_EDGE_REVERSAL) {
		at->number = CENTER;
		at->branch = (struct pound_branch){.stiffness = s->stiffness, .low = -s->yield, .high = s->yield};
	} else if (edge == POUND_EDGE_HIGH) {
		at->number = RIGHT;
		at->branch = hardened(s, 1);
		at->branch.low = s->yield;
	} else {
		at->number = LEFT;
		at->branch = hardened(s, -1);
		at->branch.high = -s->yield;
	}
}

/* Linear between the origin and the farthest point on each side: memory[0] right, memory[1] left (both > 0). */
static void origin_oriented(const struct pound_backbone *s, struct pound_law_state *at, enum pound_edge edge,
                            double u)
{
	if (at->number == RIGHT ||
	    at->number == LEFT) { // velocity reversal on the backbone: the new farthest point
		int side = at->number == LEFT;
		at->memory[side] = fabs(u);
		at->number = side ? LEFT_SECANT : RIGHT_SECANT;
	} else if (at->number == RIGHT_SECANT && edge == POUND_EDGE_LOW) {
		at->number = LEFT_SECANT;
	} else if (at->number == LEFT_SECANT && edge == POUND_EDGE_HIGH) {
		at->number = RIGHT_SECANT;
	} else { // beyond the farthest point, or for the first time beyond the yield point
		double side = edge == POUND_EDGE_HIGH ? 1 : -1;
		at->number = edge == POUND_EDGE_HIGH ? RIGHT : LEFT;
		at->branch = hardened(s, side);
		at->branch.direction = side;
		return;
	}
	double far = at->memory[at->number == LEFT_SECANT];
	at->branch = (struct pound_branch){.stiffness = pound_law_envelope(s, far) / far,
	                                   .low = at->number == LEFT_SECANT ? -far : 0,
	                                   .high = at->number == LEFT_SECANT ? 0 : far};
}

static const struct law {
	const char *name;
	const char *text; /* one line of documentation */
	bool linear;      /* has one branch */
	bool peaks;       /* remembers the largest displacement on each side, initially the yield displacement */
	void (*leave)(const struct pound_backbone *, struct pound_law_state *, enum pound_edge, double u);
	/* displacement at which the force is 0 after unloading from u; NULL: the origin */
	double (*residual)(const struct pound_backbone *, const struct pound_law_state *, double u);
} laws[] = {
    {"linear", "a spring", true, false, linear, NULL},
    {"elastoplastic",
     "bilinear with kinematic hardening: unloads with the first slope, yields again after 2 d_y", false,
     false, elastoplastic, elastoplastic_residual},
    {"nonlinear_elastic", "bilinear, loads and unloads on the same curve", false, false, nonlinear_elastic,
     NULL},
    {"origin_oriented",
     "bilinear, unloads toward the origin and reloads to the farthest point reached on that side", false,
     true, origin_oriented, NULL},
};

const char *pound_law_text(int row)
{
	return laws[row].text;
}

const char *pound_law_name(int row)
{
	return row >= 0 && row < (int)(sizeof laws / sizeof laws[0]) ? laws[row].name : NULL;
}

/* Whether a law has only one branch, so that no yield displacement is needed. */
bool pound_law_linear(int law)
{
	return laws[law].linear;
}

/* Puts an oscillator at rest on the first branch of its law.
 *
 * Given    backbone  the law and its numbers
 * Returns  at        branch at u = 0, nothing remembered: elastic up to the yield displacement on either side
 * Source   model.md 2 of the project's design pages; the paper, Figure 2
 * Test     unit_law
 */
void pound_law_start(const struct pound_backbone *backbone, struct pound_law_state *at)
{
	*at = (struct pound_law_state){.number = CENTER};
	if (laws[backbone->law].linear) {
		linear(backbone, at, POUND_EDGE_REVERSAL, 0);
		return;
	}
	at->memory[0] = at->memory[1] = 0;
	at->branch = (struct pound_branch){
	    .stiffness = backbone->stiffness, .low = -backbone->yield, .high = backbone->yield};
	if (laws[backbone->law].peaks)
		at->memory[0] = at->memory[1] = backbone->yield;
}

/* Changes to the branch beyond an edge.
 *
 * Given    backbone  the law and its numbers
 *          edge      which end of the branch was reached
 *          u         displacement there [m]
 * Returns  at        the next branch; the force is continuous
 */
void pound_law_leave(const struct pound_backbone *backbone, struct pound_law_state *at, enum pound_edge edge,
                     double u)
{
	laws[backbone->law].leave(backbone, at, edge, u);
}

/* Force per mass on the backbone curve [m/s2]: the largest force of a motion whose largest displacement is u >= 0. */
double pound_law_envelope(const struct pound_backbone *s, double u)
{
	if (laws[s->law].linear || u <= s->yield)
		return s->stiffness * u;
	return s->stiffness * (s->hardening * u + (1 - s->hardening) * s->yield);
}

/* Residual displacement [m]: where the force is 0 if the oscillator unloads from u; 0 for laws that always unload to the
 * origin. */
double pound_law_residual(const struct pound_backbone *s, const struct pound_law_state *at, double u)
{
	return laws[s->law].residual ? laws[s->law].residual(s, at, u) : 0;
}

/* Recoverable work of the spring while unloading from u to force 0, per mass [m2/s2]: the area under its branches.
 *
 * Elastoplastic, force r, first slope k: r^2/(2 k) if |r| <= 2 k d_y (Uang and Bertero 1990); origin-oriented: r u/2.
 *
 * Test     unit_law: a_law_gives_back_what_it_does_on_the_way_to_no_force
 */
double pound_law_given_back(const struct pound_backbone *s, const struct pound_law_state *from, double u)
{
	struct pound_law_state at = *from;
	double work = 0, r = at.branch.stiffness * u + at.branch.offset;
	const double way = r > 0 ? -1 : 1;
	if (at.branch.direction * way < 0)
		pound_law_leave(s, &at, POUND_EDGE_REVERSAL, u);
	for (int branch = 0; branch < BRANCHES_BACK && r != 0; branch++) {
		const double edge = way > 0 ? at.branch.high : at.branch.low,
		             zero = at.branch.stiffness > 0 ? -at.branch.offset / at.branch.stiffness : way * DBL_MAX;
		const bool ends = (zero - edge) * way <= 0;
		const double to = ends ? zero : edge, force = ends ? 0 : at.branch.stiffness * to + at.branch.offset;
		work += 0.5 * (r + force) * (u - to);
		u = to, r = force;
		if (!ends)
			pound_law_leave(s, &at, way > 0 ? POUND_EDGE_HIGH : POUND_EDGE_LOW, u);
	}
	return work;
}
