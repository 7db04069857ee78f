/* chain_state.inl - the state of a chain: floors and links in arrays that are loaded into lanes; its start and its end.
 *
 * Included by chain.inl alone, once per lane count, first. */

#include <assert.h>
#include <float.h>
#include <math.h>
#include <stdalign.h>
#include <stddef.h>
#include <string.h>

#include "engine/exact/chain.h"
#include "engine/exact/counts.h"
#include "engine/exact/tolerances.h"
#include "engine/numeric/elementary.h"
#include "engine/numeric/lanes.h"
#include "engine/scene/modes.h"

enum {
	LONG = POUND_CHAIN_FLOORS + ROW, /* floors with room for whole vectors */
	LINKS = POUND_CHAIN_LINKS + ROW,
	TERMS = ORDER_HIGH + 1,
	ENDS = 4, /* most floors of a link */
};

/* fmax and fmin without library calls, which are slow from code with wide vectors; a NAN operand is ignored. */
static inline double larger(double a, double b)
{
	return a < b || a != a ? b : a;
}
static inline double smaller(double a, double b)
{
	return b < a || a != a ? b : a;
}

/* one number per floor; processed in whole vectors, so entries after the last floor are 0 */
struct column {
	alignas(64) double at[LONG];
};

/* a quantity of every floor over a step: value and rate (times the step) at both ends, and a bound of its fourth derivative */
struct enclosures {
	struct column u0, v0, u1, v1, fourth_max;
};

/* one contact or possible contact */
struct link {
	const struct pound_link *link;
	int n_ends; /* number of floors that move */
	uint16_t floor[ENDS];
	double weight
	    [ENDS]; /* left side > 0, right side < 0: overlap = sum of weight u - gap, force on a floor = -weight F */
	double share[ENDS];         /* weight over the mass of the floor [1/kg] */
	double spring, dash, force; /* stiffness, damping and offset of its branch, scaled to the step */
	double inverse_mass;        /* 1 over the effective mass [1/kg] */
	struct pound_touch at;      /* branch of its force */
	bool touching;              /* the force acts */
	bool released;              /* the force fell to zero first: the sides still overlap */
	bool fresh;                 /* the force has just passed zero */
	bool own;            /* p and q are integrated as separate variables; else computed from the floors */
	bool held;           /* touching: rigid, and the sides stay together */
	bool level;          /* zero overlap, equal velocities to rounding, and equal derivatives so far */
	double p, q;         /* overlap [m] and its rate [m/s] */
	double impulse;      /* of this contact so far [N s] */
	double begin, speed; /* of this contact: its start and approach speed [s], [m/s] */
	double time;         /* total time in contact so far [s] */
	double counted_time; /* ... of the contacts that count [s] */
	struct pound_counts_scale scale;
	double *measures;
};

/* drifts, displacements and absolute accelerations at a sample, and their rates */
struct modal_place {
	struct column d, v, u, w, a, jerk;
};

enum {
	NOTES = 48,                        /* most noted samples, which may contain largest values */
	KEPT = 6 * 8 * POUND_CHAIN_FLOORS, /* numbers stored for these */
};

/* columns of a noted sample: drifts and their rates at its start, elastic centers, bounds inside it */
enum {
	NOTE_D,
	NOTE_V,
	NOTE_SHIFT,
	NOTE_REACH,
	NOTE_DISPLACEMENT_REACH,
	NOTE_ACCELERATION_REACH,
	NOTE_COLUMNS
};

enum {
	MODE_ROWS = 2900
}; /* rows of shapes of all vectors of floors: most are needed by 8 buildings of 50 stories */

/* modes of all buildings (as many as floors, in the same lanes), and their motion at samples */
struct modal_motion {
	bool can;          /* the chain has uncoupled modes, and they give all requested results */
	bool moved;        /* a sample was passed since modal_enter */
	int wait, refused; /* samples until the next try; backoff after failed tries */
	int now;           /* index in at[] of the current sample */
	int from[LONG / ROW], upto[LONG / ROW],
	    row[LONG / ROW]; /* per vector of floors: range of modes, and first row of shapes */
	// maps over a sample: columns for q, v, the ground acceleration and its growth
	struct column uu, uv, ua, ud, vu, vv, va, vd;
	struct column per_w2, quasi_static, quasi_static_lag, drift_speed, fourth_max,
	    fourth_max_rate; /* mode_fill */
	struct column q, v, q_next, v_next, bound;
	struct column w2, damping, gain, force, force_rate, force_bound; /* of modes; force: -(c q' + w^2 q) */
	struct column shift, elastic[2], fourth_drift, fourth_force, top, top_displacement, top_acceleration;
	struct column reach, displacement_reach,
	    acceleration_reach; /* bounds inside the sample where they exceed the largest values so far; else 0 */
	struct modal_place at[2];
	int notes, room;      /* noted samples, and their most */
	int64_t noted[NOTES]; /* sample at the end of each */
	double kept[KEPT];    /* NOTE_COLUMNS columns of each */
	struct pound_modes modes;
	double overlap[LINKS], rate[LINKS], overlap_next[LINKS],
	    rate_next[LINKS];         /* of links, at both ends of a sample */
	double shape[MODE_ROWS][ROW]; /* drifts of mode shapes */
};

/* series of a link over a step of nonlinear_contact.inl: overlap p, rate q, p^1.5 and p^0.25; if the contact begins together
 * with the master's, also P = p over the master's overlap, P^1.5 and P^0.25 */
struct curve {
	bool beside; /* the contact begins together with the master's */
	double overlap[TERMS], rate[TERMS], power[TERMS], quarter[TERMS];
	double ratio[TERMS], ratio_power[TERMS], ratio_quarter[TERMS];
};

/* the series of a step while some contact force is nonlinear (nonlinear_contact.inl) */
struct curved_step {
	bool on;       /* the current step is one */
	bool still;    /* a contact begins with zero speed: its force is neglected in this short step */
	bool sampled;  /* the step ends at the end of the interval */
	int power;     /* dt = w^power ds times the length; 0: s is time */
	int master;    /* link whose overlap is w^2 or w^4; -1: none */
	double length; /* [s], [s m^(-1/2)] or [s m^(-3/4)] */
	// allocated only for chains with nonlinear contacts: from here on
	double clock[TERMS], gauge[TERMS], w[TERMS], w2[TERMS], w3[TERMS]; /* time, g and powers of w */
	struct column rates[TERMS], accelerations[TERMS];                  /* of drifts */
	struct curve links[POUND_CHAIN_LINKS];
};

/* the ends of links, in arrays for vectors of links; padded at the end with links that never close */
struct link_ends {
	int n[LINKS / ROW];                     /* most ends of the ROW links of a row */
	bool follows[ENDS][LINKS / ROW];        /* their floors are consecutive: one load instead of a gather */
	uint16_t floor[ENDS][LINKS];            /* arbitrary if a link has fewer ends */
	double weight[ENDS][LINKS], gap[LINKS]; /* 0 if a link has fewer ends; [m] */
};

/* some of the links, ascending */
struct link_list {
	int n;
	uint16_t link[POUND_CHAIN_LINKS];
};

struct chain {
	const struct pound_chain_task *task;
	struct pound_chain_result *result;
	int n, wide; /* number of floors, and that rounded up to whole vectors */
	int n_links, wide_links;
	int n_watched; /* number of links that are only recorded and exert no force; n_links is 0 then */
	int buildings;
	uint16_t first[POUND_CHAIN_FLOORS + 1];   /* lowest floor of each building, then n */
	bool edged;                               /* a law has more than one branch */
	bool held;                                /* a rigid contact stays closed in the current step */
	bool level;                               /* a link is level in the current step (struct link) */
	bool modal;                               /* a building has a damping matrix */
	bool moving;                              /* displacements are needed */
	bool curved;                              /* a contact force may be nonlinear */
	double rate_separated, damping_separated; /* bounds of frequency and damping without contact [1/s] */
	// constants: 1/m; 1/m, but 0 for the top floor; inner, base: 1 or 0 with or without a floor below;
	// pliancy: 1 over the initial stiffness
	struct column inverse_mass, inverse_above, inner, base, mass_damping, dashpot, initial, pliancy;
	// branches
	struct column stiffness, offset, low, high, direction;
	struct pound_law_state laws[LONG];
	// state
	struct column d, v; /* drifts and their rates */
	struct column top_drift, top_displacement, top_acceleration;
	struct link link[POUND_CHAIN_LINKS];
	struct link_list touching, own; /* of the current step */
	uint8_t own_bits[LINKS / ROW];  /* the links of `own` as bits, ROW per entry */
	struct link_ends ends;
	// interval and step
	int64_t next;         /* sample at the end of the interval */
	double ground, slope; /* [m/s2], [m/s3] */
	double remainder;     /* left of the interval [s] */
	double pace;          /* step factor <= 1, below 1 after an unsure search */
	double dt;            /* length of the step [s] */
	int order;            /* of its series */
	int steps;            /* number of steps in this interval */
	// the step: springs, dashpots, offsets and mass damping, scaled to the step; external forces over masses
	struct column spring, dash, force, mass_damping_step, push;
	struct column u, w; /* displacements and velocities at the start of the step */
	struct enclosures drift, displacement, overlap;
	struct column drifts[TERMS], displacements[TERMS];
	double overlaps[TERMS][LINKS];
	double reach; /* longest step with the links in contact now; 0: to be computed [s] */
	struct modal_motion modal_motion;
	// since the last piece that was reported (chain_observer.inl)
	bool after_event;
	double jump; /* of the observed floor */
	// energy
	double work_in, work_gap, work_low, work_top;
	struct column work_story; /* on the springs of stories */
	double work_link[LINKS];
	struct curved_step curved_step; /* last member: its series are not allocated without nonlinear contacts */
};

/* ---- links ---- */

static void link_start(struct link *l, const struct pound_chain_task *task, int j)
{
	const struct pound_link *link = &task->links[j];
	memset(l, 0, sizeof *l);
	l->link = link;
	for (int side = 0; side < 2; side++)
		for (int k = 0; k < 2; k++) {
			const int floor = link->floor[side][k];
			const double weight = link->weight[side][k];
			if (floor == POUND_CHAIN_GROUND || weight == 0)
				continue;
			assert(floor >= 0 && floor < task->n_floors && weight > 0);
			l->floor[l->n_ends] = (uint16_t)floor;
			l->share[l->n_ends] = (side ? -weight : weight) * (1 / task->floors[floor].mass);
			l->weight[l->n_ends++] = side ? -weight : weight;
			l->inverse_mass += weight * weight / task->floors[floor].mass;
		}
	l->own = true;
	l->p = -link->gap;
}

/* Fills the arrays of link ends. */
static void link_ends_start(struct chain *c)
{
	struct link_ends *x = &c->ends;
	for (int j = 0; j < c->wide_links; j++) {
		const struct link *l = &c->link[j];
		const int n_ends = j < c->n_links ? l->n_ends : 0, row = j / ROW, first = row * ROW;
		if (j == first) {
			x->n[row] = 0;
			for (int k = 0; k < ENDS; k++)
				x->follows[k][row] = true;
		}
		x->n[row] = n_ends > x->n[row] ? n_ends : x->n[row];
		x->gap[j] = j < c->n_links ? l->link->gap : DBL_MAX;
		for (int k = 0; k < ENDS; k++) {
			const int next = j == first ? 0 : x->floor[k][first] + j - first;
			const int floor = k < n_ends ? l->floor[k] : next < c->wide ? next : 0;
			x->weight[k][j] = k < n_ends ? l->weight[k] : 0;
			x->floor[k][j] = (uint16_t)floor;
			x->follows[k][row] &= j == first || floor == next;
		}
	}
}

/* Sum of weight times column entry over the floors of a link. */
LANE_INLINE double link_sum(const struct link *l, const double *column)
{
	double sum = fma(l->weight[0], column[l->floor[0]], 0.0);
	sum = fma(l->weight[1], column[l->floor[1]], sum);
	for (int k = 2; k < l->n_ends; k++)
		sum = fma(l->weight[k], column[l->floor[k]], sum);
	return sum;
}

/* ---- the start ---- */

/* Bound of the rates of a chain whose highest frequency is w and whose largest damping is c.
 *
 * A rate r has r^2 + c' r + k' = 0 with c' <= c and k' <= w^2: it oscillates with at most w, or decays with at most c.  Near critical
 * damping, derivative n of a free motion is up to n times as large: steps are shorter by the 16th root of that factor, as
 * for pairs (next_step.inl: contact_reach).
 */
static double rate_of(double w, double c)
{
	const double zeta = w > 0 ? 0.5 * c / w : 0;
	double share = larger(1 - zeta * zeta, 1.0 / (ORDER_HIGH * ORDER_HIGH));
	for (int halving = 0; halving < 5; halving++)
		share = sqrt(share);
	return larger(w / share, c);
}

/* Bound of a floor's modal damping coefficient over its mass: row sum of the damping matrix [1/s]. */
static double modal_bound(const struct pound_chain_floor *floor, int stories)
{
	double sum = 0;
	for (int j = 0; j < stories; j++)
		sum += fabs(floor->modal[j] - (j + 1 < stories ? floor->modal[j + 1] : 0));
	return sum / floor->mass;
}

/* Number of floors of the building that begins with a floor. */
static int building_stories(const struct pound_chain_task *task, int first)
{
	int n = 1;
	while (first + n < task->n_floors && !task->floors[first + n].base)
		n++;
	return n;
}

/* Bound of the largest eigenvalue of springs, or of dashpots, over masses: the largest sum of a row of M^(-1/2) K M^(-1/2).
 *
 * Given    column  stiffness or dashpot of each story
 * Source   Gershgorin 1931
 */
static double building_bound(const struct chain *c, const struct column *column, int first, int stories)
{
	double bound = 0;
	for (int i = first; i < first + stories; i++) {
		const double own = column->at[i], above = i + 1 < first + stories ? column->at[i + 1] : 0;
		double row = (own + above) * c->inverse_mass.at[i];
		if (i > first)
			row += own * sqrt(c->inverse_mass.at[i] * c->inverse_mass.at[i - 1]);
		if (above > 0)
			row += above * sqrt(c->inverse_mass.at[i] * c->inverse_mass.at[i + 1]);
		bound = larger(bound, row);
	}
	return bound;
}

/* Bounds the rates of a chain without contact: all laws are stiffest on their first branch. */
static void chain_rates(struct chain *c)
{
	const struct pound_chain_task *task = c->task;
	for (int first = 0, n; first < task->n_floors; first += n) {
		const struct pound_chain_floor *floor = &task->floors[first];
		double modal = 0;
		n = building_stories(task, first);
		for (int i = 0; i < n; i++)
			if (floor[i].modal)
				modal = larger(modal, modal_bound(&floor[i], n));
		c->rate_separated = larger(c->rate_separated, sqrt(building_bound(c, &c->initial, first, n)));
		c->damping_separated = larger(c->damping_separated,
		                              building_bound(c, &c->dashpot, first, n) + floor->mass_damping + modal);
	}
}

/* Puts a story's branch into the columns. */
static void story_branch_enter(struct chain *c, int i)
{
	const struct pound_branch *branch = &c->laws[i].branch;
	c->stiffness.at[i] = branch->stiffness;
	c->offset.at[i] = branch->offset;
	c->low.at[i] = branch->low;
	c->high.at[i] = branch->high;
	c->direction.at[i] = branch->direction;
}

static void floor_start(struct chain *c, int i)
{
	const struct pound_chain_task *task = c->task;
	const struct pound_chain_floor *floor = &task->floors[i];
	assert(floor->base || (i > 0 && floor->mass_damping == floor[-1].mass_damping));
	const bool above = i + 1 < task->n_floors && !floor[1].base;
	c->inverse_mass.at[i] = 1 / floor->mass;
	c->inverse_above.at[i] = above ? 1 / floor->mass : 0;
	c->inner.at[i] = floor->base ? 0 : 1;
	c->base.at[i] = floor->base ? 1 : 0;
	c->mass_damping.at[i] = floor->mass_damping;
	c->dashpot.at[i] = floor->dashpot;
	c->initial.at[i] = floor->story.stiffness;
	c->pliancy.at[i] = 1 / floor->story.stiffness;
	c->edged |= !pound_law_linear(floor->story.law);
	c->modal |= floor->modal != NULL;
	pound_law_start(&floor->story, &c->laws[i]);
	story_branch_enter(c, i);
}

static int whole_vectors(int n)
{
	return (n + ROW - 1) / ROW * ROW;
}

/* A chain at rest at the start of its task. */
static void chain_start(struct chain *c, const struct pound_chain_task *task,
                        struct pound_chain_result *result)
{
	assert(task->n_floors >= 1 && task->n_floors <= POUND_CHAIN_FLOORS);
	assert(task->n_links >= 0 && task->n_links <= POUND_CHAIN_LINKS);
	memset(c, 0, offsetof(struct chain, modal_motion));
	c->work_in = c->work_gap = c->work_low = c->work_top = c->jump = 0;
	c->after_event = c->curved_step.on = false;
	memset(&c->work_story, 0, sizeof c->work_story);
	memset(c->work_link, 0, sizeof c->work_link);
	c->task = task;
	c->result = result;
	c->n = task->n_floors;
	c->wide = whole_vectors(c->n);
	c->n_watched = task->asked & POUND_CHAIN_CLOSING ? task->n_links : 0;
	c->n_links = task->n_links - c->n_watched;
	c->wide_links = whole_vectors(c->n_links);
	c->pace = 1;
	c->next = 1;
	for (int i = c->n; i < c->wide; i++) {
		c->low.at[i] = -DBL_MAX;
		c->high.at[i] = DBL_MAX;
	}
	for (int i = 0; i < c->n; i++) {
		floor_start(c, i);
		if (task->floors[i].base)
			c->first[c->buildings++] = (uint16_t)i;
	}
	c->first[c->buildings] = (uint16_t)c->n;
	chain_rates(c);
	for (int j = 0; j < task->n_links; j++) {
		const int force = pound_contact_force(task->links[j].law.model);
		c->curved |= c->n_links > 0 && (force == POUND_FORCE_PRODUCT || force == POUND_FORCE_POWER);
		link_start(&c->link[j], task, j);
		c->link[j].measures = &result->links[j * POUND_LINK_MEASURES];
		memset(c->link[j].measures, 0, sizeof(double) * POUND_LINK_MEASURES);
	}
	link_ends_start(c);
	c->moving = c->n_links > 0 || task->observer ||
	            (task->asked & (POUND_CHAIN_DISPLACEMENTS | POUND_CHAIN_ACCELERATIONS | POUND_CHAIN_ENERGY));
}

/* a column of drifts, and the column of its sums over the stories below */
struct summed {
	const double *drift;
	double *floor;
};

/* Sums drifts over the stories below into floor values; two buildings at once, as each sum is one long dependency chain. */
LANE_INLINE void floors_sum(const struct chain *c, const int n, const struct summed *x)
{
	for (int b = 0; b < c->buildings; b += 2) {
		int i = c->first[b], k = c->first[b + 1];
		const int end = k, last = b + 1 < c->buildings ? c->first[b + 2] : k;
		double left[3] = {0, 0, 0}, right[3] = {0, 0, 0};
		for (; i < end && k < last; i++, k++)
			for (int s = 0; s < n; s++) {
				x[s].floor[i] = left[s] += x[s].drift[i];
				x[s].floor[k] = right[s] += x[s].drift[k];
			}
		for (; i < end; i++)
			for (int s = 0; s < n; s++)
				x[s].floor[i] = left[s] += x[s].drift[i];
		for (; k < last; k++)
			for (int s = 0; s < n; s++)
				x[s].floor[k] = right[s] += x[s].drift[k];
	}
}

/* Displacements and velocities of floors, from the drifts of their stories. */
static void chain_displacements(struct chain *c)
{
	floors_sum(c, 2, (const struct summed[]){{c->d.at, c->u.at}, {c->v.at, c->w.at}});
}

static double chain_time(const struct chain *c)
{
	return (double)c->next * c->task->time_step - c->remainder;
}

/* ---- the end ---- */

static double chain_kinetic(const struct chain *c)
{
	double sum = 0;
	for (int i = 0; i < c->n; i++)
		sum += 0.5 * c->task->floors[i].mass * c->w.at[i] * c->w.at[i];
	return sum;
}

/* Drift at which a story unloads to zero force. */
static double story_residual(const struct chain *c, int i)
{
	return pound_law_residual(&c->task->floors[i].story, &c->laws[i], c->d.at[i]);
}

/* Energy dissipated by a story's law. */
static double story_lost(const struct chain *c, int i)
{
	return c->work_story.at[i] - pound_law_given_back(&c->task->floors[i].story, &c->laws[i], c->d.at[i]);
}

static void chain_write(struct chain *c, enum pound_status status)
{
	struct pound_chain_result *r = c->result;
	const unsigned asked = c->task->asked;
	bool finite = true;
	chain_displacements(c);
	for (int i = 0; i < c->n; i++) {
		double *m = &r->floors[i * POUND_FLOOR_MEASURES];
		m[POUND_FLOOR_DRIFT_MAX] = asked & POUND_CHAIN_DRIFTS ? c->top_drift.at[i] : NAN;
		m[POUND_FLOOR_DISPLACEMENT_MAX] = asked & POUND_CHAIN_DISPLACEMENTS ? c->top_displacement.at[i] : NAN;
		m[POUND_FLOOR_ACCELERATION_MAX] = asked & POUND_CHAIN_ACCELERATIONS ? c->top_acceleration.at[i] : NAN;
		m[POUND_FLOOR_SHEAR_MAX] = asked & POUND_CHAIN_DRIFTS
		                               ? pound_law_envelope(&c->task->floors[i].story, c->top_drift.at[i])
		                               : NAN;
		m[POUND_FLOOR_RESIDUAL] = story_residual(c, i);
		m[POUND_FLOOR_END_U] = c->u.at[i];
		m[POUND_FLOOR_END_V] = c->w.at[i];
		m[POUND_FLOOR_LOST] = asked & POUND_CHAIN_ENERGY ? story_lost(c, i) : NAN;
		finite &= isfinite(c->d.at[i]) && isfinite(c->v.at[i]);
	}
	for (int j = 0; j < c->n_links; j++) {
		double *m = c->link[j].measures;
		m[POUND_LINK_TIME] = c->link[j].time;
		m[POUND_LINK_CLOSING_MAX] = m[POUND_LINK_LEFT_MAX] = m[POUND_LINK_RIGHT_MAX] = NAN;
		if (!(asked & POUND_CHAIN_FORCES))
			m[POUND_LINK_FORCE_MAX] = NAN;
		if (m[POUND_LINK_CONTACTS] == 0)
			m[POUND_LINK_FIRST_TIME] = m[POUND_LINK_FIRST_SPEED] = m[POUND_LINK_SPEED_MAX] = 0;
		m[POUND_LINK_LOST] = asked & POUND_CHAIN_ENERGY ? c->work_link[j] : NAN;
	}
	r->energy_residual = r->work_in = NAN;
	if (asked & POUND_CHAIN_ENERGY) {
		const double missing = fabs(chain_kinetic(c) + (c->work_gap + c->work_low));
		r->energy_residual = c->work_top > 0 ? missing / c->work_top : 0;
		r->work_in = c->work_in;
	}
	r->status = finite ? status : POUND_OVERFLOW;
}
