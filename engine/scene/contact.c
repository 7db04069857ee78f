/* contact.c - the contact models, one row each: branches of the force, and the dashpot for a restitution coefficient.
 *
 * m is the effective mass of the two sides, v the approach speed at the start of the contact, e the restitution coefficient.
 *
 *   z of K p + C q, K p^1.5 + c p^0.25 q:   C = 2 z sqrt(K m),   c = 2 x sqrt(K m),  x = sqrt5/2 z
 *   D of K p^a (1 + D q/v)
 *
 * `classic`: the published formulas.  `exact`: an isolated impact separates with exactly e times the approach speed.  With
 * y = p^(5/4) and ds = (5/4) p^(1/4) dt, K p^1.5 + c p^0.25 q becomes y'' + (8/5) x y' + (4/5) y = 0, so the closed forms of
 * K p + C q apply.
 *
 * Adding a model: its row in models[], and its functions.  The row names the form of the force; a study whose solver cannot
 * integrate this form is refused when it is read, and the solver asserts it (solver.c). */
#include "engine/scene/contact.h"

#include <assert.h>
#include <float.h>
#include <math.h>
#include <stddef.h>
#include <string.h>

#include "engine/numeric/elementary.h"

static const double PI = 3.14159265358979323846, ROOT_5 = 2.2360679774997896964;

enum { CLASSIC, EXACT, CALIBRATIONS };

/* ---- calibrations ---- */

/* -ln e; the logarithm needs a normal number. */
static double loss(double e)
{
	return -pound_elementary_log(fmax(e, DBL_MIN));
}

/* Damping ratio of a Kelvin-Voigt contact for a given restitution coefficient.
 *
 * Given    e      -    [0, 1]
 * Returns  value  -    [0, 1]; e = 0 gives the limit 1, no log of zero
 *
 *   zeta = -ln e / sqrt(pi^2 + (ln e)^2)
 *
 * Valid    Exact if contact lasts until the overlap is zero (the dashpot may pull at the end).  With release at
 *          zero force the restitution becomes e^(1 - 2 asin(zeta)/pi): 0.900 -> 0.902, 0.600 -> 0.632.
 * Source   Anagnostopoulos 1988, Earthquake Eng. Struct. Dyn. 16, 443-456; the paper, Eq. (2)
 * Test     unit_contact
 */
static double kelvin_voigt(double e)
{
	if (e == 0)
		return 1;
	// for e below the smallest normal number zeta is within 1e-5 of 1 anyway
	double l = pound_elementary_log(fmax(e, DBL_MIN));
	return -l / sqrt(PI * PI + l * l);
}

/* Damping ratio of a dashpot that acts only during approach, as published.
 *
 * Source   Mahmoud and Jankowski 2011, Eng. Struct. 33, 1547-1556
 */
static double approach_classic(double e)
{
	e = fmax(e, DBL_MIN);
	return (1 - e * e) / (e * (e * (PI - 2) + 2));
}

/* x of the nonlinear viscoelastic model, as published.
 *
 * Source   Jankowski 2006, Earthquake Eng. Struct. Dyn. 35, 517-524
 */
static double viscoelastic_classic(double e)
{
	e = fmax(e, DBL_MIN);
	return 4.5 * ROOT_5 * ((1 - e * e) / (e * (e * (9 * PI - 16) + 16)));
}

/* D of Hertzdamp, to first order: energy loss along the motion of the spring without dashpot.
 *
 * Source   Muthukumar and DesRoches 2006, Earthquake Eng. Struct. Dyn. 35, 811-828
 */
static double ratio_classic(double e)
{
	return 0.75 * (1 - e * e);
}

/* atan(sqrt x)/sqrt x for x >= 0, artanh(sqrt -x)/sqrt -x below: one analytic function of x > -1.
 *
 *   x > 0   atan t = 2 atan(t/(1 + sqrt(1 + t^2))), applied twice: then t < 0.2
 *   |x| < 0.04   1 - x/3 + x^2/5 - ...
 */
static double arc_over(double x, double z)
{
	double factor = 1;
	if (x < -0.04) {
		const double t = sqrt(-x), w = sqrt(z - 1) * sqrt(z + 1);
		return 0.5 * pound_elementary_log(z + w) / t;
	}
	for (int half = 0; half < 2 && x > 0.04; half++) {
		const double root = 1 + sqrt(1 + x);
		x /= root * root;
		factor *= 2 / root;
	}
	double sum = 0;
	for (int n = 12; n >= 0; n--)
		sum = 1.0 / (2 * n + 1) - x * sum;
	return factor * sum;
}

/* -ln of the restitution of an isolated impact; its dashpot, of damping ratio z, acts only during approach.
 *
 *   z < 1   acos(z) z/sqrt(1 - z^2)       z > 1   acosh(z) z/sqrt(z^2 - 1)       z = 1   1
 *
 * both are 2 z/(1 + z) arc_over((1 - z)/(1 + z)).  A dashpot that always acts, with release at zero force, gives twice this.
 */
static double approach_loss(double z)
{
	return 2 * z / (1 + z) * arc_over((1 - z) / (1 + z), z);
}

/* z with approach_loss(z) = l, by bisection: the loss grows with z. */
static double approach_for(double l)
{
	double low = DBL_MIN, high = 0x1p1022;
	if (l <= 0)
		return 0;
	for (;;) {
		const double middle = high < 2 * low ? low + 0.5 * (high - low) : sqrt(low) * sqrt(high);
		if (!(middle > low && middle < high))
			return low;
		if (approach_loss(middle) < l)
			low = middle;
		else
			high = middle;
	}
}

static double kelvin_voigt_exact(double e, bool tension)
{
	return tension ? kelvin_voigt(e) : approach_for(0.5 * loss(e));
}

static double approach_exact(double e, bool tension)
{
	(void)tension;
	return approach_for(loss(e));
}

static double viscoelastic_exact(double e, bool tension)
{
	(void)tension;
	return 0.5 * ROOT_5 * approach_for(loss(e));
}

static double damped_hertz_classic(double e)
{
	return 0.5 * ROOT_5 * kelvin_voigt(e);
}

static double damped_hertz_exact(double e, bool tension)
{
	return 0.5 * ROOT_5 * kelvin_voigt_exact(e, tension);
}

/* (ln((1 + D)/(1 - D e)) - D (1 + e))/D^2, whose root is the exact D: for small D by its series, sum of
 * D^(n - 2) (e^n - (-1)^n)/n from n = 2. */
static double ratio_residual(double D, double e)
{
	enum { TERMS = 40 };
	if (D > 0.25)
		return (pound_elementary_log((1 + D) / (1 - D * e)) - D * (1 + e)) / (D * D);
	double power = e * e, sum = 0, D_n = 1;
	for (int n = 2; n < TERMS; n++, power *= e, D_n *= D)
		sum += D_n * (power - (n % 2 ? -1 : 1)) / n;
	return sum;
}

/* D of K p^a (1 + D q/v) for restitution e of an isolated impact, the same for all a > 0.
 *
 *   D (1 + e) = ln((1 + D)/(1 - D e)),  0 < D < 1/e
 */
static double ratio_exact(double e, bool tension)
{
	(void)tension;
	e = fmax(e, DBL_MIN);
	double low = 0, high = 1 / e;
	if (e >= 1)
		return 0;
	for (;;) {
		const double middle = low + 0.5 * (high - low);
		if (!(middle > low && middle < high))
			return low;
		if (1 - middle * e > 0 && ratio_residual(middle, e) < 0)
			low = middle;
		else
			high = middle;
	}
}

/* ---- branches ---- */

enum { FIRST, SECOND, THIRD };

static struct pound_touch_branch branch_of(enum pound_touch_form form, double stiffness, double damping)
{
	return (struct pound_touch_branch){
	    .form = form, .stiffness = stiffness, .damping = damping, .high = DBL_MAX};
}

static void straight_begin(const struct pound_contact_law *law, struct pound_touch *at, double rate)
{
	(void)rate;
	at->on = branch_of(POUND_TOUCH_STRAIGHT, law->stiffness, law->dashpot);
}

static void approach_begin(const struct pound_contact_law *law, struct pound_touch *at, double rate)
{
	straight_begin(law, at, rate);
	at->on.direction = 1;
}

/* The dashpot acts only during approach. */
static void approach_leave(const struct pound_contact_law *law, struct pound_touch *at, enum pound_edge edge,
                           double overlap)
{
	(void)edge, (void)overlap;
	const bool parts = at->branch == FIRST;
	at->branch = parts ? SECOND : FIRST;
	at->on.damping = parts ? 0 : law->dashpot;
	at->on.direction = parts ? -1 : 1;
}

static void product_begin(const struct pound_contact_law *law, struct pound_touch *at, double rate)
{
	at->on = branch_of(POUND_TOUCH_PRODUCT, law->stiffness, law->dashpot / fmax(rate, law->speed_floor));
}

static void power_begin(const struct pound_contact_law *law, struct pound_touch *at, double rate)
{
	const double damping = law->dashpot > 0 ? law->dashpot / fmax(rate, law->speed_floor) : 0;
	at->on = branch_of(POUND_TOUCH_POWER, law->stiffness, damping);
}

static void root_begin(const struct pound_contact_law *law, struct pound_touch *at, double rate)
{
	(void)rate;
	at->on = branch_of(POUND_TOUCH_ROOT, law->stiffness, law->dashpot);
}

static void viscoelastic_begin(const struct pound_contact_law *law, struct pound_touch *at, double rate)
{
	root_begin(law, at, rate);
	at->on.direction = 1;
}

static void viscoelastic_leave(const struct pound_contact_law *law, struct pound_touch *at,
                               enum pound_edge edge, double overlap)
{
	approach_leave(law, at, edge, overlap);
	at->on.form = at->branch == FIRST ? POUND_TOUCH_ROOT : POUND_TOUCH_POWER;
}

/* The elastic branch from `low`, on the line K2 p, to the line K2 (p - p_y) + K p_y. */
static void bilinear_elastic(const struct pound_contact_law *law, struct pound_touch *at, double low,
                             double high)
{
	at->branch = FIRST;
	at->memory = low;
	at->on = branch_of(POUND_TOUCH_STRAIGHT, law->stiffness, 0);
	at->on.offset = -(law->stiffness - law->second_stiffness) * low;
	at->on.low = low;
	at->on.high = high;
}

static void bilinear_begin(const struct pound_contact_law *law, struct pound_touch *at, double rate)
{
	(void)rate;
	bilinear_elastic(law, at, 0, law->yield_overlap);
}

static void bilinear_leave(const struct pound_contact_law *law, struct pound_touch *at, enum pound_edge edge,
                           double overlap)
{
	if (at->branch != FIRST) {
		// the edge where the branch starts is set to the overlap itself: equal to the last bit
		const bool upper = at->branch == SECOND;
		const double low = upper ? fmax(overlap - law->yield_overlap, 0) : overlap;
		bilinear_elastic(law, at, low, upper ? overlap : overlap + law->yield_overlap);
		return;
	}
	const bool upper = edge == POUND_EDGE_HIGH;
	at->branch = upper ? SECOND : THIRD;
	at->on = branch_of(POUND_TOUCH_STRAIGHT, law->second_stiffness, 0);
	at->on.offset = upper ? (law->stiffness - law->second_stiffness) * law->yield_overlap : 0;
	at->on.direction = upper ? 1 : -1;
}

/* ---- the table ---- */

static const struct model {
	const char *name;
	const char *text;                      /* one line of documentation */
	enum pound_force force;                /* what a solver must be able to integrate */
	const char *reads;                     /* members of a study beside `model` and `gap_m`, between spaces */
	double (*classic)(double restitution); /* z, x or D; NULL: no dashpot */
	double (*exact)(double restitution, bool tension);
	bool zero[CALIBRATIONS]; /* restitution 0 has a finite dashpot; exact: if the force may pull */
	void (*begin)(const struct pound_contact_law *, struct pound_touch *,
	              double rate); /* NULL: velocities jump */
	void (*leave)(const struct pound_contact_law *, struct pound_touch *, enum pound_edge, double overlap);
} models[] = {
#define LINEAR_K " stiffness_ratio stiffness_n_m "
#define POWER_K  LINEAR_K "hertz_stiffness_n_m1_5 reference_speed_m_s "
#define DASHPOT  "restitution calibration "
    {"kelvin_voigt",
     "spring and dashpot in parallel, F = K p + C p' while the bodies touch",
     POUND_FORCE_LINEAR,
     LINEAR_K DASHPOT "tension ",
     kelvin_voigt,
     kelvin_voigt_exact,
     {true, true},
     straight_begin,
     NULL},
    {"linear",
     "spring, F = K p: no loss",
     POUND_FORCE_LINEAR,
     LINEAR_K,
     NULL,
     NULL,
     {true, true},
     straight_begin,
     NULL},
    {"modified_kelvin_voigt",
     "F = K p + C p' on approach, F = K p on separation",
     POUND_FORCE_STRAIGHT,
     LINEAR_K DASHPOT,
     approach_classic,
     approach_exact,
     {false, false},
     approach_begin,
     approach_leave},
    {"hunt_crossley",
     "F = K p (1 + D p'/v), v the approach speed of the contact",
     POUND_FORCE_PRODUCT,
     LINEAR_K DASHPOT "speed_floor_m_s ",
     ratio_classic,
     ratio_exact,
     {true, false},
     product_begin,
     NULL},
    {"hertz",
     "F = K p^1.5: no loss",
     POUND_FORCE_POWER,
     POWER_K,
     NULL,
     NULL,
     {true, true},
     power_begin,
     NULL},
    {"hertz_damp",
     "F = K p^1.5 (1 + D p'/v), v the approach speed of the contact",
     POUND_FORCE_POWER,
     POWER_K DASHPOT "speed_floor_m_s ",
     ratio_classic,
     ratio_exact,
     {true, false},
     power_begin,
     NULL},
    {"viscoelastic",
     "F = K p^1.5 + c p^0.25 p' on approach, F = K p^1.5 on separation",
     POUND_FORCE_POWER,
     POWER_K DASHPOT,
     viscoelastic_classic,
     viscoelastic_exact,
     {false, false},
     viscoelastic_begin,
     viscoelastic_leave},
    {"damped_hertz",
     "F = K p^1.5 + c p^0.25 p' while the bodies touch",
     POUND_FORCE_POWER,
     POWER_K DASHPOT "tension ",
     damped_hertz_classic,
     damped_hertz_exact,
     {true, true},
     root_begin,
     NULL},
    {"bilinear",
     "F = K p up to p_y, then slope K2; back with K to the line K2 p and along it to 0; loses energy by "
     "yield",
     POUND_FORCE_STRAIGHT,
     LINEAR_K "second_stiffness_ratio yield_overlap_m ",
     NULL,
     NULL,
     {true, true},
     bilinear_begin,
     bilinear_leave},
    {"rigid",
     "no overlap: velocities jump, the relative one to -eps times itself, momentum is kept",
     POUND_FORCE_IMPACT,
     " restitution speed_floor_m_s ",
     NULL,
     NULL,
     {true, true},
     NULL,
     NULL},
};

static_assert(sizeof models / sizeof models[0] == POUND_CONTACT_MODELS, "a row for each model");

const char *pound_contact_name(int row)
{
	return row >= 0 && row < POUND_CONTACT_MODELS ? models[row].name : NULL;
}

const char *pound_contact_text(int row)
{
	return models[row].text;
}

enum pound_force pound_contact_force(int row)
{
	return models[row].force;
}

bool pound_force_scales(enum pound_force force)
{
	return force == POUND_FORCE_LINEAR;
}

/* Whether a model reads a member of /scene/contact. */
bool pound_contact_reads(int row, const char *member)
{
	const size_t n = strlen(member);
	if (strcmp(member, "model") == 0 || strcmp(member, "gap_m") == 0)
		return true;
	for (const char *at = strstr(models[row].reads, member); at; at = strstr(at + 1, member))
		if (at[-1] == ' ' && at[n] == ' ')
			return true;
	return false;
}

const char *pound_calibration_name(int row)
{
	static const char *const names[] = {[CLASSIC] = "classic", [EXACT] = "exact"};
	return row >= 0 && row < CALIBRATIONS ? names[row] : NULL;
}

/* Whether a model has a dashpot for restitution 0. */
bool pound_contact_takes_zero(const struct pound_contact *contact)
{
	const struct model *model = &models[contact->model];
	return model->zero[contact->calibration] && (contact->calibration == CLASSIC || contact->tension ||
	                                             !pound_contact_reads(contact->model, "tension"));
}

double pound_contact_damping_ratio(int model, double restitution)
{
	assert(restitution >= 0 && restitution <= 1);
	return models[model].classic(restitution);
}

/* Dimensionless dashpot of a study's contact: z, x or D; 0: no dashpot. */
static double dashpot_of(const struct pound_contact *contact)
{
	const struct model *model = &models[contact->model];
	assert(contact->restitution >= 0 && contact->restitution <= 1);
	if (!model->classic)
		return 0;
	if (contact->calibration == CLASSIC)
		return model->classic(contact->restitution);
	return model->exact(contact->restitution, contact->tension);
}

/* Parameters of a study's contact at one place.
 *
 * Given    contact   -
 *          place     adjacent stiffness, effective mass, divisor of forces
 * Returns  value     K, dashpot, ...; forces over place->mass
 *
 *   K = stiffness_n_m, or the ratio times the adjacent stiffness
 *   p^1.5: K = hertz_stiffness, or 5/4 K^(5/4) m^(-1/4) s^(-1/2) with the linear K: equal largest overlap at reference speed s
 *   C = 2 z sqrt(K m),   c = 2 x sqrt(K m),   D unchanged
 *
 * Test     unit_contact: the_largest_overlap_of_both_springs_is_one_at_the_reference_speed
 */
struct pound_contact_law pound_contact_law(const struct pound_contact *contact,
                                           const struct pound_contact_place *place)
{
	const struct model *model = &models[contact->model];
	struct pound_contact_law law = {.model = contact->model,
	                                .restitution = contact->restitution,
	                                .speed_floor = contact->speed_floor,
	                                .tension =
	                                    contact->tension || !pound_contact_reads(contact->model, "tension")};
	if (model->force == POUND_FORCE_IMPACT)
		return law;
	double K = contact->stiffness > 0 ? contact->stiffness / place->mass
	                                  : contact->stiffness_ratio * place->stiffness;
	if (model->force == POUND_FORCE_POWER)
		K = contact->hertz_stiffness > 0
		        ? contact->hertz_stiffness / place->mass
		        : 1.25 * K * sqrt(sqrt(K * place->inverse_mass)) / sqrt(contact->reference_speed);
	const double dashpot = dashpot_of(contact);
	const bool ratio = pound_contact_reads(contact->model, "speed_floor_m_s"); // D q/v: v is read
	law.stiffness = K;
	law.dashpot = ratio ? dashpot : 2 * dashpot * sqrt(K / place->inverse_mass);
	if (pound_contact_reads(contact->model, "yield_overlap_m")) {
		law.second_stiffness = contact->second_stiffness_ratio * K;
		law.yield_overlap = contact->yield_overlap;
	}
	return law;
}

/* Sets a contact that begins to the first branch of its model.
 *
 * Given    law
 *          rate   q > 0 at overlap 0 [m/s]; 0: it begins at rest
 * Returns  at
 * Test     unit_contact
 */
void pound_contact_begin(const struct pound_contact_law *law, struct pound_touch *at, double rate)
{
	*at = (struct pound_touch){.branch = FIRST};
	models[law->model].begin(law, at, rate);
}

/* Changes to the branch beyond an edge that does not end the contact.
 *
 * Given    law, edge
 *          overlap   at the edge [m]
 * Returns  at        the next branch; the force is continuous
 * Test     unit_contact
 */
void pound_contact_leave(const struct pound_contact_law *law, struct pound_touch *at, enum pound_edge edge,
                         double overlap)
{
	assert(models[law->model].leave);
	models[law->model].leave(law, at, edge, overlap);
}

/* The force of a branch at one overlap: linear in the rate for every form.
 *
 * Given    on, overlap
 * Returns  value     force at rate 0, slope over the rate, slope of the former over the overlap; powers of overlaps < 0 are 0
 */
struct pound_touch_line pound_contact_line(const struct pound_touch_branch *on, double overlap)
{
	const double p = fmax(overlap, 0), root = sqrt(p), k = on->stiffness, c = on->damping;
	switch (on->form) {
	case POUND_TOUCH_STRAIGHT:
		return (struct pound_touch_line){k * overlap + on->offset, c, k};
	case POUND_TOUCH_PRODUCT:
		return (struct pound_touch_line){k * overlap, k * overlap * c, k};
	case POUND_TOUCH_POWER:
		return (struct pound_touch_line){k * p * root, k * p * root * c, 1.5 * k * root};
	case POUND_TOUCH_ROOT:
		return (struct pound_touch_line){k * p * root, c * sqrt(root), 1.5 * k * root};
	}
	assert(false);
	return (struct pound_touch_line){0};
}

double pound_contact_force_on(const struct pound_touch_branch *on, double overlap, double rate)
{
	const struct pound_touch_line line = pound_contact_line(on, overlap);
	return line.still + line.rate * rate;
}

/* Updates the branch of a contact whose overlap changes monotonically, through every edge on the way. */
void pound_contact_follow(const struct pound_contact_law *law, struct pound_touch *at, double from, double to)
{
	if (at->on.direction * (to - from) < 0)
		pound_contact_leave(law, at, POUND_EDGE_REVERSAL, from);
	for (;;)
		if (to > at->on.high)
			pound_contact_leave(law, at, POUND_EDGE_HIGH, at->on.high);
		else if (to < at->on.low)
			pound_contact_leave(law, at, POUND_EDGE_LOW, at->on.low);
		else
			return;
}
