/* oracle.c - two oscillators with a contact by classical Runge-Kutta in extended precision.
 *
 *   1. u1, v1, u2, v2 and the impulse of the contact are integrated with a fixed step; the state of the laws and of the contact
 *      is constant during a step and updated at its end.
 *   2. `located`: a step in which a law's branch, the sign of a velocity or the contact changes is bisected to end
 *      just past the first change, so every step is smooth and the error falls with the fourth power of the step.
 *      Otherwise no change is located, and the error falls with the first power.
 *   3. Forces come from the laws' definitions in oracle_law.c.
 *
 * Its error is about the difference between two step lengths, as long as the motion is not chaotic. */
#include "tests/support/oracle.h"

#include <assert.h>
#include <math.h>
#include <string.h>

typedef long double real;

enum { U1, V1, U2, V2, IMPULSE, STATES };

// most cuts of one step; more are due to rounding noise of a velocity near zero
enum { CUTS_MAX = 16 };

// tolerance of event location, relative to the step in contact; large enough to distinguish a grazing start from rounding
static const real near_event = 1e-12L;

static const real pi = 3.14159265358979323846264338327950288L;

/* The pair of bodies. */

struct pair {
	real m[2], c[2];
	struct oracle_law law[2];
	bool wall; // the right body is the ground
	bool present, tension;
	real gap, K, C;
	bool touching; // during the step
	real step_free, step_touching;
	bool located;
};

// one sample interval of the ground's acceleration
struct interval {
	real a, slope;
};

struct trajectory {
	real y[STATES];
	real time; // of the interval's start
	real s;    // since then
	real u_max[2], r_max[2];
	real impulse_max, contact_time, contact_start, approach;
	int contacts;
	struct oracle_trace *trace;
};

static real penetration(const struct pair *pair, const real y[STATES])
{
	return y[U1] - y[U2] - pair->gap;
}

static real contact_force(const struct pair *pair, const real y[STATES])
{
	return pair->K * penetration(pair, y) + pair->C * (y[V1] - y[V2]);
}

static bool touches(const struct pair *pair, const real y[STATES])
{
	return pair->present && penetration(pair, y) > 0 && (pair->tension || contact_force(pair, y) > 0);
}

static void derivative(const struct pair *pair, real a_g, const real y[STATES], real dy[STATES])
{
	real f = pair->touching ? contact_force(pair, y) : 0;
	real r1 = oracle_law_force(&pair->law[0], y[U1]);
	real r2 = oracle_law_force(&pair->law[1], y[U2]);
	dy[U1] = y[V1];
	dy[V1] = -a_g - (pair->c[0] * y[V1] + r1 + f) / pair->m[0];
	dy[U2] = pair->wall ? 0 : y[V2];
	dy[V2] = pair->wall ? 0 : -a_g - (pair->c[1] * y[V2] + r2 - f) / pair->m[1];
	dy[IMPULSE] = f;
}

static void runge_kutta(const struct pair *pair, const struct interval *in, real s, real h,
                        const real y[STATES], real end[STATES])
{
	static const real place[4] = {0, 0.5L, 0.5L, 1}, weight[4] = {1, 2, 2, 1};
	real slope[STATES] = {0}, stage[STATES];
	for (int i = 0; i < STATES; i++)
		end[i] = y[i];
	for (int k = 0; k < 4; k++) {
		for (int i = 0; i < STATES; i++)
			stage[i] = y[i] + place[k] * h * slope[i];
		derivative(pair, in->a + in->slope * (s + place[k] * h), stage, slope);
		for (int i = 0; i < STATES; i++)
			end[i] += h / 6 * weight[k] * slope[i];
	}
}

// a number that changes at every event where a step should end
static int label(const struct pair *pair, const real y[STATES])
{
	int l = touches(pair, y);
	for (int body = 0; body < 2; body++) {
		const struct oracle_law *law = &pair->law[body];
		int branch = oracle_law_branch(law, y[2 * body], y[2 * body + 1]);
		l = 16 * l + 2 * (branch + 2) + (y[2 * body + 1] > 0);
	}
	// ending a step at the closest approach avoids missing a short contact
	return 2 * l + (y[V1] > y[V2]);
}

// the shortest step after which the label differs from its value at y; `end` holds the state at h
static real bisected(const struct pair *pair, const struct interval *in, real s, real h, const real y[STATES],
                     real end[STATES])
{
	int before = label(pair, y);
	real low = 0, middle[STATES];
	while (h - low > near_event * pair->step_touching) {
		real half = low + (h - low) / 2;
		runge_kutta(pair, in, s, half, y, middle);
		if (label(pair, middle) == before) {
			low = half;
			continue;
		}
		h = half;
		memcpy(end, middle, sizeof middle);
	}
	return h;
}

static void contact_starts(struct trajectory *at)
{
	at->contact_start = at->time + at->s;
	at->approach = at->y[V1] - at->y[V2];
	at->y[IMPULSE] = 0;
	at->contacts++;
}

static void contact_ends(struct trajectory *at)
{
	real duration = at->time + at->s - at->contact_start;
	at->contact_time += duration;
	at->impulse_max = fmaxl(at->impulse_max, at->y[IMPULSE]);
	if (!at->trace || at->contacts > ORACLE_CONTACTS_MAX)
		return;
	at->trace->n_contacts = at->contacts;
	at->trace->contacts[at->contacts - 1] = (struct oracle_contact){
	    .start = (double)at->contact_start,
	    .duration = (double)duration,
	    .speed = (double)at->approach,
	    .departure = (double)(at->y[V2] - at->y[V1]),
	    .impulse = (double)at->y[IMPULSE],
	};
}

// updates memories, contact and maxima at the end of a step
static void settle(struct pair *pair, struct trajectory *at)
{
	for (int body = 0; body < 2; body++) {
		real u = at->y[2 * body];
		oracle_law_settle(&pair->law[body], u);
		at->u_max[body] = fmaxl(at->u_max[body], fabsl(u));
		at->r_max[body] = fmaxl(at->r_max[body], fabsl(oracle_law_force(&pair->law[body], u)));
	}
	bool touching = touches(pair, at->y);
	if (touching && !pair->touching)
		contact_starts(at);
	if (!touching && pair->touching)
		contact_ends(at);
	pair->touching = touching;
}

// one nominal step, cut at branch changes; ends early when the contact opens or closes
static void step(struct pair *pair, const struct interval *in, real end_of_interval, struct trajectory *at)
{
	real h_whole = pair->touching ? pair->step_touching : pair->step_free;
	// from rest, displacements start as powers of time, which one long step does not resolve
	real h_start = (at->time + at->s) / 32 + h_whole / 1000;
	real goal = fminl(at->s + fminl(h_whole, h_start), end_of_interval);
	bool touching = pair->touching;
	for (int cuts = 0; at->s < goal && pair->touching == touching; cuts++) {
		real h = goal - at->s, end[STATES];
		runge_kutta(pair, in, at->s, h, at->y, end);
		if (pair->located && cuts < CUTS_MAX && label(pair, end) != label(pair, at->y))
			h = bisected(pair, in, at->s, h, at->y, end);
		at->s = h < goal - at->s ? at->s + h : goal;
		memcpy(at->y, end, sizeof end);
		settle(pair, at);
	}
}

static void march(struct pair *pair, const struct oracle_motion *motion, struct trajectory *at)
{
	real dt = motion->time_step;
	settle(pair, at);
	for (int t = 0; t + 1 < motion->n; t++) {
		real a = motion->acceleration[t];
		struct interval in = {a, (motion->acceleration[t + 1] - a) / dt};
		at->time = t * dt;
		at->s = 0;
		while (at->s < dt)
			step(pair, &in, dt, at);
	}
	if (pair->touching)
		contact_ends(at);
}

/* The scene. */

static const struct pound_law *law_of(const struct pound_scene *scene, int body)
{
	const struct pound_oscillator *o = &scene->oscillators[body];
	return o->has_law ? &o->law : &scene->law;
}

static real damping_ratio_of_contact(real restitution)
{
	if (restitution == 0)
		return 1;
	real l = logl(restitution);
	return -l / sqrtl(pi * pi + l * l);
}

// yield: yield displacement of each body, 0: linear law
static struct pair pair_of(const struct pound_scene *scene, const double yield[2],
                           const struct oracle_method *method)
{
	const struct pound_contact *contact = &scene->contact;
	struct pair pair = {.wall = scene->oscillators[1].rigid_wall,
	                    .present = contact->present,
	                    .tension = contact->tension,
	                    .gap = contact->gap,
	                    .located = method->located};
	real k_max = 0, w_max = 0;
	for (int body = 0; body < (pair.wall ? 1 : 2); body++) {
		const struct pound_oscillator *o = &scene->oscillators[body];
		const struct pound_law *law = law_of(scene, body);
		real w = 2 * pi * o->frequency_hz, k = o->mass * w * w;
		pair.m[body] = o->mass;
		pair.c[body] = 2 * (real)o->damping_ratio * o->mass * w;
		pair.law[body] = oracle_law(yield[body] > 0 ? pound_law_name(law->type) : "linear", k,
		                            law->hardening_ratio, yield[body]);
		k_max = fmaxl(k_max, k);
		w_max = fmaxl(w_max, w);
	}
	real m = pair.wall ? pair.m[0] : pair.m[0] * pair.m[1] / (pair.m[0] + pair.m[1]);
	pair.K = contact->stiffness_ratio * k_max;
	pair.C = 2 * damping_ratio_of_contact(contact->restitution) * sqrtl(pair.K * m);
	pair.step_touching = method->radians / sqrtl(pair.K / m + w_max * w_max);
	pair.step_free = method->located || !contact->present ? method->radians / w_max : pair.step_touching;
	return pair;
}

static struct trajectory trajectory_of(const struct pound_scene *scene, const double yield[2],
                                       const struct oracle_motion *motion, const struct oracle_method *method,
                                       const struct oracle_start *start, struct oracle_trace *trace)
{
	struct pair pair = pair_of(scene, yield, method);
	struct trajectory at = {.trace = trace};
	if (start) {
		at.y[U1] = start->u1;
		at.y[V1] = start->v1;
		at.y[U2] = start->u2;
		at.y[V2] = start->v2;
	}
	march(&pair, motion, &at);
	return at;
}

static double reduction_factor(const struct pound_scene *scene, int body)
{
	double mu = law_of(scene, body)->target_demand;
	const struct pound_excitation *e = &scene->excitation;
	if (strcmp(pound_excitation_name(e->type), "kanai_tajimi") != 0)
		return mu;
	double ratio = e->frequency_hz / scene->oscillators[body].frequency_hz;
	return ratio >= 1.0 / 6.0 ? mu : 1 + (mu - 1) * 6 * ratio;
}

// yield displacement of each body, 0: linear law or wall
static void yield_displacements(const struct pound_scene *scene, const struct oracle_motion *motion,
                                const struct oracle_method *method, double yield[2])
{
	struct pound_scene apart = *scene;
	apart.contact.present = false;
	const double none[2] = {0};
	struct trajectory elastic = trajectory_of(&apart, none, motion, method, NULL, NULL);
	bool searched[2], corrected = false;
	for (int body = 0; body < 2; body++) {
		const struct pound_law *law = law_of(scene, body);
		bool has_yield =
		    strcmp(pound_law_name(law->type), "linear") != 0 && !scene->oscillators[body].rigid_wall;
		searched[body] = has_yield && law->yield_displacement == 0;
		yield[body] = !has_yield        ? 0
		              : !searched[body] ? law->yield_displacement
		                                : (double)elastic.u_max[body] / reduction_factor(scene, body);
		assert(!searched[body] || law->corrections <= 1); // the oracle has no iterative search
		corrected |= searched[body] && law->corrections == 1;
	}
	if (!corrected)
		return;
	struct trajectory run = trajectory_of(&apart, yield, motion, method, NULL, NULL);
	for (int body = 0; body < 2; body++)
		if (searched[body] && law_of(scene, body)->corrections == 1)
			yield[body] = (double)run.u_max[body] / law_of(scene, body)->target_demand;
}

/* Response of a scene to one ground motion, for comparison with the engine.
 *
 * Given    scene     -   excitation: only its type and frequency, for the reduction factor of the yield displacement
 *          motion    -   the ground's acceleration
 *          start     -   state at time 0, NULL: at rest
 * Returns  trace     -   all contacts; NULL: not requested
 *          value     -   NAN for measures that the scene does not have
 *
 * Valid    The difference of two values of method->radians bounds the error while the motion is not chaotic.
 * Test     unit_oracle
 */
struct pound_response oracle_response(const struct pound_scene *scene, const struct oracle_motion *motion,
                                      const struct oracle_method *method, const struct oracle_start *start,
                                      struct oracle_trace *trace)
{
	struct pound_scene apart = *scene;
	apart.contact.present = false;
	double yield[2];
	yield_displacements(scene, motion, method, yield);
	struct trajectory free = trajectory_of(&apart, yield, motion, method, start, NULL);
	if (trace)
		trace->n_contacts = 0;
	struct trajectory at = trajectory_of(scene, yield, motion, method, start, trace);

	bool yields[2] = {yield[0] > 0, yield[1] > 0}, wall = scene->oscillators[1].rigid_wall;
	return (struct pound_response){
	    .displacement_max_1 = (double)at.u_max[0],
	    .displacement_max_free_1 = (double)free.u_max[0],
	    .force_max_1 = (double)at.r_max[0],
	    .yield_displacement_1 = yields[0] ? yield[0] : NAN,
	    .demand_1 = yields[0] ? (double)at.u_max[0] / yield[0] : NAN,
	    .demand_free_1 = yields[0] ? (double)free.u_max[0] / yield[0] : NAN,
	    .displacement_max_2 = (double)at.u_max[1],
	    .displacement_max_free_2 = wall ? 0 : (double)free.u_max[1],
	    .force_max_2 = (double)at.r_max[1],
	    .yield_displacement_2 = yields[1] ? yield[1] : NAN,
	    .demand_2 = yields[1] ? (double)at.u_max[1] / yield[1] : NAN,
	    .demand_free_2 = yields[1] ? (double)free.u_max[1] / yield[1] : NAN,
	    .impulse_max = (double)at.impulse_max,
	    .contact_count = at.contacts,
	    .contact_time = (double)at.contact_time,
	    .end_u1 = (double)at.y[U1],
	    .end_v1 = (double)at.y[V1],
	    .end_u2 = (double)at.y[U2],
	    .end_v2 = (double)at.y[V2],
	};
}

/* Name of a measure in a result, NULL past the last. */
const char *oracle_measure_name(int measure)
{
	static const char *const names[] = {
#define X(member, name, oscillator) #member,
	    POUND_MEASURES(X)
#undef X
	};
	return measure < ORACLE_MEASURES ? names[measure] : NULL;
}

/* Value of a measure by its number. */
double oracle_measure(const struct pound_response *response, int measure)
{
	double values[ORACLE_MEASURES];
	memcpy(values, response, sizeof values);
	return values[measure];
}
