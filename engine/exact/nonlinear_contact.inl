/* nonlinear_contact.inl - steps of a chain while a contact force is nonlinear: products p q and powers of p.
 *
 * 1. p^1.5 has a branch point where a contact begins and ends, so a series in time fails there.  Such a step is a series in s with
 *    dt = g ds, g = w = p^(1/2), or g = w^3, w = p^(1/4), where a dashpot has p^(1/4):
 *
 *       w' = q/2,  p^1.5 = w^3             w' = q/4,  p^1.5 = w^6,  p^0.25 = w
 *       t' = g    d' = g v    v' = g a    q' = g a
 *
 *    All right sides are polynomials: coefficients by products, also at w = 0.  The contact ends at the simple root of w,
 *    and a sample is a root of t(s).
 * 2. One contact, the master, defines w: the touching one with the least p/|q|.  Far from its branch points, and for
 *    products, g = 1.  Powers of the other overlaps are by n p_0 P_n = sum_(k=1..n) (a k - n + k) p_k P_(n-k), P_0 = p_0^a.
 *    Another power contact that begins at the same instant has p = g w P = w^2 P or w^4 P, and p' = g q gives, with derivatives by
 *    the fraction of the step of length L,  L q_master P + w P' = L q.
 * 3. The step is as long as its last coefficients allow: a series of another length has coefficients times powers of the ratio.
 *
 * Included by chain.inl alone, once per lane count, before chain_events.inl. */

static bool link_curved(const struct link *l)
{
	return (l->touching || l->released) && l->at.on.form != POUND_TOUCH_STRAIGHT;
}

static bool link_power(const struct link *l)
{
	return link_curved(l) && l->at.on.form != POUND_TOUCH_PRODUCT;
}

/* Whether a contact of the form with p^0.25 ends at zero force, before its overlap does. */
static bool link_curve_forced(const struct link *l)
{
	return link_curved(l) && l->at.on.form == POUND_TOUCH_ROOT && !l->link->law.tension;
}

/* x^(1/n), x > 0 */
static double root_of(double x, int n)
{
	return pound_elementary_exp(pound_elementary_log(fmax(x, DBL_MIN)) / n);
}

/* ---- products of series ---- */

/* Coefficient n of the product of two series, in two partial sums to shorten the dependency chain. */
LANE_INLINE double product_at(const double *a, const double *b, int n)
{
	double even = 0, odd = 0;
	for (int k = 0; k < n; k += 2) {
		even = fma(a[k], b[n - k], even);
		odd = fma(a[k + 1], b[n - k - 1], odd);
	}
	return n % 2 ? even + odd : fma(a[n], b[0], even) + odd;
}

/* Coefficient n >= 1 of p^a, by the recurrence of the head comment. */
LANE_INLINE double power_next(double a, const double *p, const double *power, int n)
{
	double even = 0, odd = 0, weight = a + 1 - n;
	for (int k = 1; k < n; k += 2) {
		even = fma(weight * p[k], power[n - k], even);
		odd = fma((weight + (a + 1)) * p[k + 1], power[n - k - 1], odd);
		weight += 2 * (a + 1);
	}
	return (n % 2 ? fma(weight * p[n], power[0], even) + odd : even + odd) / (n * p[0]);
}

/* ---- the series of a step ---- */

/* Rate of a contact: frequency of its tangent stiffness plus tangent damping, over the effective mass [1/s]. */
static double curve_rate(const struct link *l)
{
	const struct pound_touch_line line = pound_contact_line(&l->at.on, fmax(l->p, 0));
	const double spring =
	    line.slope * (1 + fabs(l->q) * (l->at.on.form == POUND_TOUCH_ROOT ? 0 : l->at.on.damping));
	return sqrt(spring * l->inverse_mass) + line.rate * l->inverse_mass;
}

/* Highest rate in s near the beginning or end of a contact: there w = |q| s/2 or |q| s/4. */
static double branch_rate(const struct link *l, int power)
{
	const double m = l->inverse_mass, q = fabs(l->q), K = l->at.on.stiffness;
	if (power == 1)
		return root_of(K * q * q * q * m / 16, 5);
	const double q4 = q * q * q * q, c = l->at.on.form == POUND_TOUCH_ROOT ? l->at.on.damping : 0;
	return fmax(root_of(c * q4 * m / 256, 5), root_of(K * q4 * q4 * m / 262144, 10));
}

/* Whether a contact begins with negligible speed: w cannot be the variable then, and the force is negligible at first. */
static bool link_still(const struct link *l)
{
	return link_power(l) && l->p <= 0 && fabs(l->q) < 0x1p-500;
}

/* Chooses the power of w near the branch point of the master, and finds the contacts that begin together with it.
 *
 * Returns  value  the highest rate in s of these contacts
 */
static double curved_begin(struct chain *c)
{
	struct curved_step *x = &c->curved_step;
	const struct link *master = &c->link[x->master];
	bool root = master->at.on.form == POUND_TOUCH_ROOT;
	for (int j = 0; j < c->n_links; j++) {
		const struct link *l = &c->link[j];
		x->links[j].beside =
		    j != x->master && master->p <= 0 && l->touching && link_power(l) && l->p <= 0 && l->q > 0;
		root |= x->links[j].beside && l->at.on.form == POUND_TOUCH_ROOT;
	}
	x->power = root ? 3 : 1;
	double rate = branch_rate(master, x->power);
	for (int j = 0; j < c->n_links; j++)
		if (x->links[j].beside)
			rate = fmax(rate, branch_rate(&c->link[j], x->power));
	return rate;
}

/* Chooses the variable of the step and its first length. */
static void curved_choose(struct chain *c)
{
	struct curved_step *x = &c->curved_step;
	double least = INFINITY, rate = c->rate_separated + c->damping_separated;
	bool still = false;
	x->master = -1;
	for (int j = 0; j < c->n_links; j++) {
		const struct link *l = &c->link[j];
		x->links[j].beside = false;
		if (!l->touching && !link_curved(l))
			continue;
		rate = fmax(rate, curve_rate(l));
		still |= link_still(l);
		if (!link_power(l) || l->q == 0)
			continue;
		const double near = fmax(l->p, 0) / fabs(l->q);
		// of several that begin now, the fastest: the overlaps of the others are smaller
		if (near < least || (near == 0 && least == 0 && l->q > c->link[x->master].q)) {
			least = near;
			x->master = j;
		}
	}
	const struct link *l = x->master >= 0 ? &c->link[x->master] : NULL;
	x->power = 0;
	x->still = still;
	x->length = c->remainder * rate <= 1 ? c->remainder : 1 / rate;
	if (still)
		x->length = 0x1p-40 * x->length; // its force is below rounding: (2^-80)^1.5, 2^-60 of a dashpot's
	else if (l && least * curve_rate(l) < 0.3) {
		const double fastest = curved_begin(c), root = sqrt(fmax(l->p, 0));
		x->w[0] = x->power == 1 ? root : sqrt(root);
		const double gauge = x->power == 1 ? root : root * x->w[0];
		x->length = 1 / fmax(fastest, fmax(rate * gauge, 0x1p-200));
	}
	if (x->power == 0)
		x->master = -1;
}

/* Order n of a power of a series. */
LANE_INLINE void power_fill(double a, const double *p, double *power, int n)
{
	power[n] = n > 0 ? power_next(a, p, power, n) : a == 0.25 ? sqrt(sqrt(*p)) : *p * sqrt(*p);
}

/* Order n of the powers of an overlap that begins together with the master's: powers of P times powers of w. */
static void beside_powers(struct curved_step *x, int j, bool root, int n)
{
	const struct curve *by = &x->links[x->master];
	struct curve *v = &x->links[j];
	double sum = v->rate[n], later = 0;
	for (int k = 1; k <= n; k++)
		sum = fma(-by->rate[k], v->ratio[n - k], sum);
	for (int k = 2; k <= n; k++)
		later = fma((n - k + 1) * x->w[k], v->ratio[n - k + 1], later);
	v->ratio[n] = (sum - later / x->length) / (by->rate[0] * (1 + n / (x->power + 1.0)));
	power_fill(1.5, v->ratio, v->ratio_power, n);
	v->power[n] = product_at(by->power, v->ratio_power, n);
	if (!root)
		return;
	power_fill(0.25, v->ratio, v->ratio_quarter, n);
	v->quarter[n] = product_at(x->w, v->ratio_quarter, n);
}

/* Order n of the powers of a link's overlap. */
static void link_powers(struct chain *c, int j, int n)
{
	struct curved_step *x = &c->curved_step;
	const struct link *l = &c->link[j];
	const bool root = l->at.on.form == POUND_TOUCH_ROOT;
	struct curve *v = &x->links[j];
	double *power = &v->power[n], *quarter = &v->quarter[n];
	if (j == x->master) {
		*power = x->power == 3 ? product_at(x->w3, x->w3, n) : x->w3[n];
		*quarter = x->w[n];
		return;
	}
	if (v->beside) {
		beside_powers(x, j, root, n);
		return;
	}
	if (v->overlap[0] <= 0 || x->still) { // its force is negligible in this step
		*power = *quarter = 0;
		return;
	}
	power_fill(1.5, v->overlap, v->power, n);
	if (root)
		power_fill(0.25, v->overlap, v->quarter, n);
}

/* Order n of a contact's force, from its overlap, rate and powers up to that order. */
static double curve_force(const struct chain *c, int j, int n)
{
	const struct curved_step *x = &c->curved_step;
	const struct pound_touch_branch *on = &c->link[j].at.on;
	const struct curve *v = &x->links[j];
	switch (on->form) {
	case POUND_TOUCH_STRAIGHT:
		return fma(on->stiffness, v->overlap[n], fma(on->damping, v->rate[n], n == 0 ? on->offset : 0));
	case POUND_TOUCH_PRODUCT:
		return on->stiffness * fma(on->damping, product_at(v->overlap, v->rate, n), v->overlap[n]);
	case POUND_TOUCH_POWER: {
		const double moving = on->damping != 0 ? on->damping * product_at(v->power, v->rate, n) : 0;
		return on->stiffness * (v->power[n] + moving);
	}
	case POUND_TOUCH_ROOT:
		return fma(on->stiffness, v->power[n], on->damping * product_at(v->quarter, v->rate, n));
	}
	return 0;
}

/* Adds the forces of modal damping of order n, over masses. */
static void curved_modal(struct chain *c, int n)
{
	const struct pound_chain_task *task = c->task;
	for (int first = 0, stories; first < c->n; first += stories) {
		stories = building_stories(task, first);
		for (int i = first; i < first + stories && task->floors[i].modal; i++) {
			double sum = 0;
			for (int j = 0; j < stories; j++)
				sum = fma(task->floors[i].modal[j], c->curved_step.rates[n].at[first + j], sum);
			c->push.at[i] = fma(c->inverse_mass.at[i], sum, c->push.at[i]);
		}
	}
}

/* Sets order n of the external forces on floors (contacts, modal damping), over masses. */
static void curved_pushes(struct chain *c, int n)
{
	for (int i = 0; i < c->wide; i += W)
		column_store(&c->push, i, vsplat(0));
	if (c->curved_step.master >= 0)
		link_powers(c, c->curved_step.master, n);
	for (int j = 0; j < c->n_links; j++) {
		const struct link *l = &c->link[j];
		if (link_power(l) && j != c->curved_step.master)
			link_powers(c, j, n);
		if (l->touching)
			push_add(c, l, curve_force(c, j, n));
	}
	if (c->modal)
		curved_modal(c, n);
}

LANE_INLINE vd curved_story_force(const struct chain *c, int i, int n)
{
	const vd elastic = column_load(&c->stiffness, i) * column_load(&c->drifts[n], i);
	const vd s = vfma(column_load(&c->dashpot, i), column_load(&c->curved_step.rates[n], i), elastic);
	return n == 0 ? s + column_load(&c->offset, i) : s;
}

/* Accelerations of drifts of order n (chain_series.inl: floors_next). */
LANE_INLINE void curved_accelerate(struct chain *c, int n, double ground)
{
	const vd zero = vsplat(0);
	vd s = curved_story_force(c, 0, n), below = zero;
	for (int i = 0; i < c->wide; i += W) {
		const vd next = i + W < c->wide ? curved_story_force(c, i + W, n) : zero;
		const vd a = vfma(vabove(s, next), column_load(&c->inverse_above, i),
		                  -(s * column_load(&c->inverse_mass, i))) -
		             column_load(&c->push, i);
		const vd under =
		    vfma(vbelow(below, a), column_load(&c->inner, i), column_load(&c->base, i) * vsplat(ground));
		column_store(
		    &c->curved_step.accelerations[n], i,
		    a - vfma(column_load(&c->mass_damping, i), column_load(&c->curved_step.rates[n], i), under));
		below = a;
		s = next;
	}
}

/* Order n + 1 of drifts and their rates, whose derivatives by s are g times the rates and the accelerations; in two partial sums
 * each, to shorten the dependency chain. */
LANE_INLINE void curved_integrate(struct chain *c, int n, int i)
{
	struct curved_step *x = &c->curved_step;
	vd drift[2] = {vsplat(0), vsplat(0)}, rate[2] = {vsplat(0), vsplat(0)};
	if (x->power == 0) {
		drift[0] = column_load(&x->rates[n], i);
		rate[0] = column_load(&x->accelerations[n], i);
	} else {
		for (int k = 0; k < n; k += 2) {
			const vd even = vsplat(x->gauge[k]), odd = vsplat(x->gauge[k + 1]);
			drift[0] = vfma(even, column_load(&x->rates[n - k], i), drift[0]);
			drift[1] = vfma(odd, column_load(&x->rates[n - k - 1], i), drift[1]);
			rate[0] = vfma(even, column_load(&x->accelerations[n - k], i), rate[0]);
			rate[1] = vfma(odd, column_load(&x->accelerations[n - k - 1], i), rate[1]);
		}
		if (n % 2 == 0) {
			const vd even = vsplat(x->gauge[n]);
			drift[0] = vfma(even, column_load(&x->rates[0], i), drift[0]);
			rate[0] = vfma(even, column_load(&x->accelerations[0], i), rate[0]);
		}
	}
	const vd share = vsplat(x->length * POUND_SHARE[n]);
	column_store(&c->drifts[n + 1], i, share * (drift[0] + drift[1]));
	column_store(&x->rates[n + 1], i, share * (rate[0] + rate[1]));
}

/* Order n of g and order n + 1 of the time, from w. */
static void curved_gauge(struct curved_step *x, int n)
{
	if (x->power > 0) {
		x->w2[n] = product_at(x->w, x->w, n);
		x->w3[n] = product_at(x->w2, x->w, n);
	}
	x->gauge[n] = x->power == 0 ? n == 0 : x->power == 1 ? x->w[n] : x->w3[n];
	if (n < ORDER_HIGH)
		x->clock[n + 1] = x->length * POUND_SHARE[n] * x->gauge[n];
}

/* Order n + 1 of overlaps, their rates and w. */
static void curved_links(struct chain *c, int n)
{
	struct curved_step *x = &c->curved_step;
	struct column floors;
	floors_sum(c, 1, &(const struct summed){x->rates[n + 1].at, floors.at});
	for (int j = 0; j < c->n_links; j++) {
		const struct link *l = &c->link[j];
		if (!l->own)
			continue;
		struct curve *v = &x->links[j];
		v->rate[n + 1] = l->held ? 0 : link_sum(l, floors.at);
		v->overlap[n + 1] =
		    x->length * POUND_SHARE[n] * (x->power == 0 ? v->rate[n] : product_at(x->gauge, v->rate, n));
		if (j == x->master)
			x->w[n + 1] = x->length * POUND_SHARE[n] * v->rate[n] / (x->power == 1 ? 2 : 4);
	}
}

/* Order 0. */
static void curved_start(struct chain *c)
{
	struct curved_step *x = &c->curved_step;
	c->dt = 1;
	c->held = false;
	for (int j = 0; j < c->n_links; j++)
		c->held |= c->link[j].held;
	series_start(c);
	for (int i = 0; i < c->wide; i += W)
		column_store(&x->rates[0], i, column_load(&c->v, i));
	for (int j = 0; j < c->n_links; j++)
		x->links[j].overlap[0] = c->link[j].p, x->links[j].rate[0] = c->link[j].q;
	x->clock[0] = 0;
}

/* A story at rest on a branch boundary (chain_series.inl: story_zero_rounding). */
static void curved_story_zero_rounding(struct chain *c, int i)
{
	c->drifts[2].at[i] = 0.5 * c->curved_step.accelerations[0].at[i];
	story_zero_rounding(c, i, c->ground);
	c->curved_step.accelerations[0].at[i] = 2 * c->drifts[2].at[i];
}

/* Makes the series of a step, of the current length. */
static void curved_series(struct chain *c)
{
	struct curved_step *x = &c->curved_step;
	curved_start(c);
	for (int n = 0; n <= ORDER_HIGH; n++) {
		curved_gauge(x, n);
		const double ground = fma(c->slope, x->clock[n], n == 0 ? c->ground : 0);
		curved_pushes(c, n);
		if (c->held)
			held_push(c, n, ground);
		curved_accelerate(c, n, ground);
		if (n == 0 && c->edged)
			for (int i = 0; i < c->n; i++)
				curved_story_zero_rounding(c, i);
		if (n == ORDER_HIGH)
			break;
		for (int i = 0; i < c->wide; i += W)
			curved_integrate(c, n, i);
		curved_links(c, n);
	}
}

/* ---- the length of a step ---- */

enum { LAST = 3 }; /* last terms to check: in some series every other term vanishes */

static const double TAIL = 1e-16; /* largest last terms over the first ones */

/* Raises the largest ratios of the last terms of a series, with a stride, to its first terms. */
static void tail_keep(double most[LAST], const double *series, size_t stride, double least)
{
	const double first = fmax(fabs(series[0]) + fabs(series[stride]), least);
	for (int k = 0; k < LAST && first > 0; k++)
		most[k] = fmax(most[k], fabs(series[(size_t)(ORDER_HIGH - k) * stride]) / first);
}

/* Ratio of step lengths at which the last terms of all rates and of w fall below the rounding of the first ones. */
static double curved_ratio(const struct chain *c)
{
	const struct curved_step *x = &c->curved_step;
	double fastest = 0, most[LAST] = {0}, ratio = INFINITY;
	for (int i = 0; i < c->n; i++)
		fastest = fmax(fastest, fabs(x->rates[0].at[i]));
	for (int i = 0; i < c->n; i++)
		tail_keep(most, &x->rates[0].at[i], LONG, 0x1p-10 * fastest);
	for (int j = 0; j < c->n_links; j++)
		if (link_curved(&c->link[j]))
			tail_keep(most, x->links[j].rate, 1, 0x1p-10 * fastest);
	// the sign of a force decides when its contact ends, however small it is beside others
	for (int j = 0; j < c->n_links; j++)
		if (x->links[j].beside)
			tail_keep(most, x->links[j].ratio, 1, 0);
		else if (j != x->master && link_curve_forced(&c->link[j]) && x->links[j].overlap[0] > 0)
			tail_keep(most, x->links[j].quarter, 1, 0);
	if (x->power > 0)
		tail_keep(most, x->w, 1, 0);
	for (int k = 0; k < LAST; k++)
		if (most[k] > 0)
			ratio = fmin(ratio, root_of(TAIL / most[k], ORDER_HIGH - k));
	return ratio;
}

/* Rescales all series to a step length times a ratio. */
static void curved_scale(struct chain *c, double ratio)
{
	struct curved_step *x = &c->curved_step;
	double factor = 1;
	x->length *= ratio;
	for (int n = 1; n <= ORDER_HIGH; n++) {
		factor *= ratio;
		for (int i = 0; i < c->wide; i += W) {
			const vd f = vsplat(factor);
			column_store(&c->drifts[n], i, f * column_load(&c->drifts[n], i));
			column_store(&x->rates[n], i, f * column_load(&x->rates[n], i));
			column_store(&x->accelerations[n], i, f * column_load(&x->accelerations[n], i));
		}
		for (int j = 0; j < c->n_links; j++) {
			struct curve *v = &x->links[j];
			if (c->link[j].held)
				c->overlaps[n][j] *= factor;
			v->overlap[n] *= factor;
			v->rate[n] *= factor;
			v->power[n] *= factor;
			v->quarter[n] *= factor;
			v->ratio[n] *= factor;
		}
		x->clock[n] *= factor;
		x->gauge[n] *= factor;
		x->w[n] *= factor;
		x->w2[n] *= factor;
		x->w3[n] *= factor;
	}
}

/* Computes the series of the longest accurate step. */
static void nonlinear_series(struct chain *c)
{
	enum { TRIES = 8 };
	struct curved_step *x = &c->curved_step;
	c->order = ORDER_HIGH;
	curved_choose(c);
	x->length *= c->pace;
	for (int try = 0; try < TRIES; try++) {
		curved_series(c);
		double ratio = x->still ? 1 : curved_ratio(c);
		if (x->power == 0)
			ratio = fmin(ratio, c->remainder / x->length);
		if (ratio >= 0x1p-4 || try == TRIES - 1) {
			ratio = fmin(ratio, c->pace < 1 ? 1 : 4);
			if (ratio != 1)
				curved_scale(c, ratio);
			break;
		}
		x->length *= ratio;
	}
	for (int n = 0; n <= ORDER_HIGH; n++)
		floors_sum(c, 1, &(const struct summed){c->drifts[n].at, c->displacements[n].at});
	for (int j = 0; j < c->n_links; j++)
		for (int n = 0; c->link[j].own && !c->link[j].held && n <= ORDER_HIGH; n++)
			c->overlaps[n][j] = x->links[j].overlap[n];
	enclosures_make(c, c->drifts, &c->drift);
	enclosures_make(c, c->displacements, &c->displacement);
}

/* Whether some acting contact has a nonlinear force. */
static bool chain_curved(const struct chain *c)
{
	for (int j = 0; c->curved && j < c->n_links; j++)
		if (link_curved(&c->link[j]))
			return true;
	return false;
}

/* Turns the accelerations of drifts into absolute accelerations of floors, in place: the former are no longer needed. */
static void curved_floor_accelerations(struct chain *c)
{
	struct curved_step *x = &c->curved_step;
	for (int n = 0; n <= ORDER_HIGH; n++) {
		struct column floors;
		floors_sum(c, 1, &(const struct summed){x->accelerations[n].at, floors.at});
		const double ground = fma(c->slope, x->clock[n], n == 0 ? c->ground : 0);
		for (int i = 0; i < c->n; i++)
			x->accelerations[n].at[i] = floors.at[i] + ground;
	}
}
