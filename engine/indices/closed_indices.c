/* closed_indices.c - closed indices of sets of inputs, and from these first-order, total and second-order indices and Shapley
 * effects.
 *
 * 1. Two samples of a row whose inputs agree exactly in the set u give an estimate of the closed variance C_u, the variance
 *    of the conditional mean of the output given the inputs in u.  All such pairs of a row are averaged.
 * 2. Each set is a column of row estimates; every index is a ratio of two linear combinations of the columns' means.
 * 3. Intervals follow from the influence of each row, or group of rows, on an index (delta method). */
#include "engine/indices/indices.h"

#include <assert.h>
#include <float.h>
#include <math.h>

static unsigned all_of(const struct pound_closed *closed)
{
	return pound_inputs_all(closed->n_inputs);
}

static int column_of(const struct pound_closed *closed, unsigned set)
{
	for (int k = 0; k < closed->n_columns; k++)
		if (closed->set[k] == set)
			return k;
	return -1;
}

/* Inserts a set in ascending order, unless it is already there. */
static void set_add(struct pound_closed *closed, unsigned set)
{
	int at = closed->n_columns;
	if (column_of(closed, set) >= 0)
		return;
	assert(at < POUND_CLOSED_COLUMNS_MAX);
	for (; at > 0 && closed->set[at - 1] > set; at--)
		closed->set[at] = closed->set[at - 1];
	closed->set[at] = set;
	closed->n_columns++;
}

/* All sets if there are few inputs; else the sets of 0, 1, 2, all but 1 and all inputs, and the groups and their complements. */
static void sets_lay(struct pound_closed *closed)
{
	const unsigned all = all_of(closed);
	const int n = closed->n_inputs;
	for (unsigned set = 0; set <= all && n <= POUND_FACTORIAL_INPUTS_MAX; set++)
		set_add(closed, set);
	set_add(closed, 0);
	for (int j = 0; j < n; j++)
		for (int k = 0; k <= j; k++)
			set_add(closed, 1u << j | 1u << k);
	for (int j = 0; j < n; j++)
		set_add(closed, all ^ 1u << j);
	for (int g = 0; g < closed->n_groups; g++) {
		set_add(closed, closed->group[g]);
		set_add(closed, all ^ closed->group[g]);
	}
	set_add(closed, all);
}

static bool by_difference(const struct pound_closed *closed, unsigned set)
{
	bool is = __builtin_popcount(set) == closed->n_inputs - 1;
	for (int g = 0; g < closed->n_groups; g++)
		is |= set == (all_of(closed) ^ closed->group[g]);
	return is;
}

static unsigned mask_of(const struct pound_closed *closed, int sample)
{
	const int ungrouped = closed->n_samples - closed->n_groups;
	return sample < ungrouped ? pound_order_mask(closed->n_inputs, sample)
	                          : closed->group[sample - ungrouped];
}

static void pairs_fill(struct pound_closed *closed)
{
	int count[POUND_CLOSED_COLUMNS_MAX] = {0};
	for (int p = 0; p < closed->n_samples; p++)
		for (int q = p + 1; q < closed->n_samples; q++) {
			unsigned set = all_of(closed) & ~(mask_of(closed, p) ^ mask_of(closed, q));
			int column = column_of(closed, set);
			if (set == all_of(closed) || column < 0)
				continue;
			assert(closed->n_pairs < POUND_CLOSED_PAIRS_MAX);
			closed->pair[closed->n_pairs++] = (struct pound_closed_pair){p, q, column, 0.0};
			count[column]++;
		}
	for (int k = 0; k < closed->n_pairs; k++)
		closed->pair[k].weight = 1.0 / count[closed->pair[k].column];
	for (int k = 0; k < closed->n_columns; k++)
		closed->known[k] = closed->set[k] == all_of(closed) || count[k] > 0;
}

/* The sets of inputs and the pairs of samples of a design.
 *
 * Test     unit_closed_indices: four_inputs_have_every_set_in_the_plain_design
 */
void pound_closed_init(struct pound_closed *closed, const struct pound_sample_values *shape)
{
	*closed = (struct pound_closed){
	    .n_inputs = shape->n_inputs, .n_samples = pound_values_samples(shape), .n_groups = shape->n_groups};
	for (int g = 0; g < shape->n_groups; g++)
		closed->group[g] = shape->groups[g].inputs;
	sets_lay(closed);
	for (int k = 0; k < closed->n_columns; k++)
		closed->difference[k] = by_difference(closed, closed->set[k]);
	pairs_fill(closed);
}

/* A row's estimates of the closed variances: the exact value of a control variate g plus the estimate of the output y from
 * pairs of samples less the same estimate of g:
 *
 *   all inputs     C = G + mean over samples of y^2 - g^2
 *   all but one, all but a group    C_u = C - (G - G_u) - mean over pairs of ((y_p - y_q)^2 - (g_p - g_q)^2) / 2
 *   other sets     C_u = G_u + mean over pairs of y_p y_q - g_p g_q
 *
 * Given    y          (n_samples)               outputs of the row
 *          control    -                         g, the mean, and as `part` the closed variances G_u
 *          noise      (n_samples x n_samples)   covariances of the outputs' noise, to subtract; NULL: none
 * Returns  estimate   (2 x n_columns)           C_u of each set, then for each set C from the samples of its pairs alone
 *
 * With all mixtures of A and B (a factorial design) sums and differences of these are the contrasts of the factorial
 * design: the interaction variance of a set u is the sum over its subsets v of (-1)^(|u| - |v|) C_v.
 *
 * Source   Sobol' 2001, Math. Comput. Simul. 55, 271-280; Jansen 1999, Comput. Phys. Commun. 117, 35-43
 * Test     unit_closed_indices: contrasts_of_the_factorial_design_have_their_golden_values
 */
void pound_closed_row(const struct pound_closed *closed, const double *y,
                      const struct pound_control_variate *control, const double *noise, double *estimate)
{
	const double *g = control->g, *part = control->part, mean = control->mean;
	const int n_samples = closed->n_samples, last = closed->n_columns - 1;
	double squares = 0.0, square[POUND_SAMPLES_MAX], *own = estimate + closed->n_columns;
	for (int p = 0; p < n_samples; p++) {
		square[p] = g ? (y[p] - g[p]) * (y[p] + g[p] - 2.0 * mean) : (y[p] - mean) * (y[p] - mean);
		square[p] -= noise ? noise[p * n_samples + p] : 0.0;
		squares += square[p];
	}
	for (int k = 0; k <= last; k++) {
		estimate[k] = part[k];
		own[k] = part[last] + (k < last && closed->known[k] ? 0.0 : squares / n_samples);
	}
	estimate[last] += squares / n_samples;
	for (int k = 0; k < closed->n_pairs; k++) {
		const struct pound_closed_pair *pair = &closed->pair[k];
		const int p = pair->p, q = pair->q, n = n_samples;
		double *into = &estimate[pair->column];
		own[pair->column] += 0.5 * pair->weight * (square[p] + square[q]);
		if (closed->difference[pair->column]) {
			double change = y[p] - y[q], g_change = g ? g[p] - g[q] : 0.0;
			double difference = change * change - g_change * g_change;
			difference -= noise ? noise[p * n + p] + noise[q * n + q] - 2.0 * noise[p * n + q] : 0.0;
			*into -= 0.5 * pair->weight * difference;
		} else {
			double product = (y[p] - mean) * (y[q] - mean) - (g ? (g[p] - mean) * (g[q] - mean) : 0.0);
			*into += pair->weight * (product - (noise ? noise[p * n + q] : 0.0));
		}
	}
	const double missed = estimate[last] - part[last];
	for (int k = 0; k < last; k++)
		if (closed->difference[k])
			estimate[k] += missed;
}

/* ---- indices ---- */

/* The rows' estimates and their means. */
struct columns {
	const struct pound_closed *closed;
	const struct pound_rows *rows;
	const double *estimate; /* (n_rows x 2 x n_columns) */
	double *mean;           /* (2 x n_columns) */
	double *influence;      /* of the rows on an index  (n_rows) */
	double *groups;         /* (groups, at most n_rows) */
	bool few;               /* effective rows in the variance, see ratio_weigh */
};

static void means_fill(const struct columns *columns)
{
	const int n = 2 * columns->closed->n_columns, n_rows = columns->rows->n_rows;
	for (int k = 0; k < n; k++)
		columns->mean[k] = 0.0;
	for (int i = 0; i < n_rows && !pound_stopped(columns->rows->stop); i++)
		for (int k = 0; k < n; k++)
			columns->mean[k] += columns->estimate[(size_t)i * n + k] / n_rows;
}

/* The numerator of an index: a linear combination of the columns. */
struct combination {
	const struct pound_closed *closed;
	unsigned constant; /* inputs with a single value */
	bool known;        /* the design provides every column used */
	double weight[POUND_CLOSED_COLUMNS_MAX];
};

static struct combination combination(const struct columns *columns)
{
	struct combination c = {.closed = columns->closed, .known = true};
	for (int j = 0; j < columns->closed->n_inputs; j++)
		c.constant |= (unsigned)(pound_rows_levels(columns->rows, j) == 1) << j;
	return c;
}

/* The column of a set, or of a set that differs only in constant inputs, so that these explain exactly 0. */
static int column_for(const struct combination *c, unsigned set)
{
	const unsigned all = all_of(c->closed);
	const unsigned others = (set | c->constant) == all ? all : set & ~c->constant;
	const int column = column_of(c->closed, others);
	return column >= 0 && c->closed->known[column] ? column : column_of(c->closed, set);
}

/* Adds the closed variance of a set, from its column. */
static void add(struct combination *c, double weight, unsigned set)
{
	const int column = column_for(c, set);
	assert(column >= 0);
	c->weight[column] += weight;
	c->known &= c->closed->known[column];
}

/* Adds the closed variance of a set less the one of the empty set, which is 0 but whose estimate has correlated errors. */
static void add_closed(struct combination *c, double weight, unsigned set)
{
	add(c, weight, set);
	add(c, -weight, 0);
}

/* The ratio of a combination N to the whole variance C,
 *
 *   (N - v C_0) / (C + w (C_own - C))
 *
 * C_0 is the closed variance of the empty set: 0 except for errors that are correlated with those of N, C.  C_own is C from the
 * samples of N's pairs only: it contains the same large outputs as N, which reduces the ratio's error if few outputs are large.
 * Without an own column w is 0, and C_0 is subtracted from C and from each set of N, v being the sum of N's weights. */
struct ratio {
	const struct columns *columns;
	const struct combination *combination;
	int own;     /* column whose pairs the numerator uses; -1: several columns */
	double v, w; /* weights */
};

/* A row's contributions to N, C and the two control variates. */
struct row_terms {
	double above, below, none, change;
};

static struct row_terms row_terms(const struct ratio *r, const double *estimate)
{
	const int n = r->columns->closed->n_columns;
	struct row_terms t = {.below = estimate[n - 1], .none = estimate[0]};
	for (int k = 0; k < n; k++)
		t.above += r->combination->weight[k] != 0.0 ? r->combination->weight[k] * estimate[k] : 0.0;
	if (r->own >= 0)
		t.change = estimate[n + r->own] - estimate[n - 1];
	else
		t.below -= t.none;
	return t;
}

/* Chooses the weights from the regression of N - ratio C on C_0 and ratio (C_own - C) over the rows: v is its coefficient clipped
 * to [-1, 1]; w is the mean of 1 and its coefficient clipped to [0, 1], because a few large outputs mislead the regression.  If the
 * variance has fewer than five effective rows, the coefficient of a total is as good as unknown: its mean over [0, 1] replaces it.
 *
 * Source   w = 1: Janon et al. 2014, ESAIM: Probab. Stat. 18, 342-364; w = 0: Jansen 1999; the regression: control variates
 *          with estimated coefficients, Glasserman 2003, Monte Carlo methods in financial engineering, section 4.1
 */
static void ratio_weigh(struct ratio *r, const struct row_terms *mean)
{
	const struct columns *columns = r->columns;
	const int n_rows = columns->rows->n_rows;
	const double ratio = mean->above / mean->below;
	double nn = 0.0, nc = 0.0, cc = 0.0, zn = 0.0, zc = 0.0, squares = 0.0;
	for (int i = 0; i < n_rows; i++) {
		const struct row_terms t =
		    row_terms(r, columns->estimate + (size_t)i * 2 * columns->closed->n_columns);
		const double none = t.none - mean->none, change = ratio * (t.change - mean->change);
		const double z = t.above - ratio * t.below;
		nn += none * none;
		nc += none * change;
		cc += change * change;
		zn += z * none;
		zc += z * change;
		squares += ratio * ratio * t.below * t.below;
	}
	// with two inputs the pairs of a set use all samples, and the difference is rounding error
	const bool changes = cc > DBL_EPSILON * squares;
	const double both = nn * cc - nc * nc;
	double v = nn > 0.0 ? zn / nn : 0.0, w = changes ? zc / cc : 0.0;
	if (changes && both > DBL_EPSILON * nn * cc) {
		v = (zn * cc - zc * nc) / both;
		w = (zc * nn - zn * nc) / both;
	}
	r->v = v < -1.0 ? -1.0 : v > 1.0 ? 1.0 : v;
	const bool total = r->combination->weight[columns->closed->n_columns - 1] != 0.0;
	const double known = w > 0.0 ? fmin(w, 1.0) : 0.0, unknown = 0.5;
	r->w = 0.5 + 0.5 * (total && columns->few ? unknown : known);
	if (!(mean->below + r->w * mean->change > columns->rows->variance_floor))
		r->w = 0.0;
}

static void influence_add(struct pound_influence *influence, int column, double weight)
{
	if (weight == 0.0)
		return;
	assert(influence->n < POUND_INFLUENCE_MAX);
	influence->column[influence->n] = column;
	influence->weight[influence->n++] = weight;
}

/* The influence of a row on a ratio, as weights of the row's estimates. */
static struct pound_influence influence_of(const struct ratio *r, double ratio, double below)
{
	const int n = r->columns->closed->n_columns;
	struct pound_influence influence = {0};
	for (int k = 0; k < n; k++)
		influence_add(&influence, k, r->combination->weight[k] / below);
	influence_add(&influence, 0, -(r->v - (r->own < 0 ? ratio : 0.0)) / below);
	influence_add(&influence, n - 1, -ratio * (1.0 - (r->own < 0 ? 0.0 : r->w)) / below);
	if (r->own >= 0)
		influence_add(&influence, n + r->own, -ratio * r->w / below);
	return influence;
}

/* What an interval is computed from: effective rows, the standard error, and the influence of a row. */
struct basis {
	double rows, error;
	struct pound_influence influence;
};

/* The ratio of a combination to the whole variance, with the interval of its linearization.
 *
 * Given    own       column whose pairs the combination uses; -1: several columns
 * Returns  basis     of the interval; NULL: not requested
 */
static struct pound_estimate ratio_interval(const struct combination *c, const struct columns *columns,
                                            int own, struct basis *basis)
{
	const int n = columns->closed->n_columns, n_rows = columns->rows->n_rows;
	// few rows do not determine weights, and the columns of the empty and the full set are the control variates themselves
	const bool weighed = n_rows >= POUND_ROWS_MIN && own > 0 && own < n - 1;
	struct ratio r = {.columns = columns, .combination = c, .own = weighed ? own : -1};
	for (int k = 0; k < n; k++)
		r.v += c->weight[k];
	const struct row_terms mean = row_terms(&r, columns->mean);
	if (!(mean.below > columns->rows->variance_floor) || !c->known || pound_stopped(columns->rows->stop))
		return (struct pound_estimate){NAN, NAN, NAN};
	if (weighed)
		ratio_weigh(&r, &mean);
	const double below = mean.below + r.w * mean.change, ratio = (mean.above - r.v * mean.none) / below;
	for (int i = 0; i < n_rows; i++) {
		const struct row_terms t = row_terms(&r, columns->estimate + (size_t)i * 2 * n);
		columns->influence[i] = (t.above - r.v * t.none - ratio * (t.below + r.w * t.change)) / below;
	}
	double quantile;
	const double error = pound_jackknife_error(columns->influence, n_rows, &columns->rows->scatter,
	                                           columns->groups, &quantile),
	             half_width = quantile * error;
	if (basis)
		*basis = (struct basis){pound_jackknife_rows(columns->influence, n_rows), error,
		                        influence_of(&r, ratio, below)};
	return (struct pound_estimate){ratio, ratio - half_width, ratio + half_width};
}

/* Shapley effect: increase of the closed variance by adding input j to a set, averaged over the sets of each size and the sizes.
 *
 *   phi_j = sum over sets u without j of (C_(u + j) - C_u) / (d binom(d - 1, |u|))
 *
 * Source   Owen 2014, SIAM/ASA J. Uncertain. Quantif. 2, 245-251
 * Test     unit_closed_indices: shapley_effects_add_up_to_one
 */
static struct combination shapley(const struct columns *columns, int j)
{
	const struct pound_closed *closed = columns->closed;
	const int d = closed->n_inputs;
	struct combination c = combination(columns);
	for (unsigned set = 0; set < all_of(closed); set++) {
		if (set >> j & 1)
			continue;
		double binomial = 1.0;
		for (int k = 0; k < __builtin_popcount(set); k++)
			binomial *= (d - 1.0 - k) / (k + 1.0);
		add(&c, 1.0 / (d * binomial), set | 1u << j);
		add(&c, -1.0 / (d * binomial), set);
	}
	return c;
}

/* Closed index of a set; below, its total index. */
static struct pound_estimate closed_of(const struct columns *columns, unsigned set, struct basis *basis)
{
	struct combination c = combination(columns);
	add(&c, 1.0, set);
	return ratio_interval(&c, columns, column_for(&c, set), basis);
}

static struct pound_estimate total_of(const struct columns *columns, unsigned set, struct basis *basis)
{
	const unsigned all = all_of(columns->closed);
	struct combination c = combination(columns);
	add(&c, 1.0, all);
	add(&c, -1.0, all ^ set);
	return ratio_interval(&c, columns, column_for(&c, all ^ set), basis);
}

/* Closed indices of the proper sets, and second-order indices of the pairs: all over one denominator, so that they add
 * up. */
static void sets_fill(const struct columns *columns, struct pound_set_indices *sets)
{
	const struct pound_closed *closed = columns->closed;
	sets->n_second = sets->n_closed = 0;
	for (int k = 1; k < closed->n_columns; k++) {
		const unsigned set = closed->set[k];
		struct combination c = combination(columns);
		add_closed(&c, 1.0, set);
		if (c.known && set != all_of(closed) && closed->n_inputs <= POUND_FACTORIAL_INPUTS_MAX)
			sets->closed[sets->n_closed++] =
			    (struct pound_set_index){set, ratio_interval(&c, columns, -1, NULL)};
		if (__builtin_popcount(set) != 2)
			continue;
		add_closed(&c, -1.0, set & (set - 1));
		add_closed(&c, -1.0, set & -set);
		if (c.known)
			sets->second[sets->n_second++] =
			    (struct pound_set_index){set, ratio_interval(&c, columns, -1, NULL)};
	}
}

size_t pound_closed_scratch(const struct pound_closed *closed, int n_rows)
{
	return 2 * (size_t)closed->n_columns + 2 * (size_t)n_rows;
}

/* All indices from the rows' estimates of closed variances, with 95 % intervals.
 *
 * Given    estimates  (n_rows x 2 x n_columns)   of pound_closed_row
 *          rows       -                          their number, groups and variance_floor
 * Returns  first, total, shapley   (n_inputs)    NAN if the design lacks a set of inputs
 *          sets       -                          second-order and closed indices of the sets that the design has
 *          groups     -                          of each group as one input
 * Memory   scratch    (pound_closed_scratch)
 *
 *   first S_j = C_j / C     total T_j = 1 - C_(all but j) / C     second order S_jk = (C_jk - C_j - C_k) / C
 *
 * C_0, the mean over pairs that share no input, is subtracted from every closed variance of S_jk.
 *
 * Test     unit_closed_indices
 */
void pound_closed_indices(const struct pound_closed *closed, const double *estimates,
                          const struct pound_rows *rows, double *scratch,
                          struct pound_closed_results *results)
{
	struct columns columns = {.closed = closed,
	                          .rows = rows,
	                          .estimate = estimates,
	                          .mean = scratch,
	                          .influence = scratch + 2 * closed->n_columns,
	                          .groups = scratch + 2 * closed->n_columns + rows->n_rows};
	columns.few = pound_rows_behind(rows) < POUND_ROWS_BEHIND;
	means_fill(&columns);
	*results = (struct pound_closed_results){.variance = columns.mean[closed->n_columns - 1]};
	for (int j = 0; j < closed->n_inputs; j++) {
		struct combination effect = combination(&columns);
		effect.known = closed->n_inputs <= POUND_FACTORIAL_INPUTS_MAX;
		if (effect.known)
			effect = shapley(&columns, j);
		struct basis first = {0}, total = {0};
		results->first[j] = closed_of(&columns, 1u << j, &first);
		results->total[j] = total_of(&columns, 1u << j, &total);
		results->first_rows[j] = first.rows;
		results->total_rows[j] = total.rows;
		results->total_error[j] = total.error;
		results->first_influence[j] = first.influence;
		results->total_influence[j] = total.influence;
		results->shapley[j] = ratio_interval(&effect, &columns, -1, NULL);
	}
	results->groups.n = closed->n_groups;
	for (int g = 0; g < closed->n_groups; g++) {
		results->groups.first[g] = closed_of(&columns, closed->group[g], NULL);
		results->groups.total[g] = total_of(&columns, closed->group[g], NULL);
	}
	sets_fill(&columns, &results->sets);
}
