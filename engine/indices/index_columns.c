/* index_columns.c - all index columns of one output from the same runs: the estimator of each column, its preconditions, and the
 * substitute column if they are not met.
 *
 * 1. Raw and corrected pick-freeze indices and the excitation's indices come from one bootstrap (noise_correction.c).
 * 2. S1 is from chaos_expansion.c or local_regression.c, ST from chaos_expansion.c or pick-freeze, for each input the one
 *    with the narrower interval: polynomials are best for smooth outputs, the others for all other outputs.
 *    Local regression is biased if the output changes within its reach; it is rejected if it disagrees with the
 *    polynomial's estimate, which is unbiased.
 *    If few rows hold most of the variance, and an index has few effective rows, chaos_expansion.c is taken, whose
 *    denominator has the same large outputs as its numerator: the narrowest of several intervals would be too narrow.
 *    The upper end of ST allows for the skewness of squared differences (totals_fill).
 * 3. Interactions and conditional means are from chaos_expansion.c.
 * 4. A column that cannot be estimated is a copy of the next best, and a note reports it.  Nothing is clipped.
 * 5. If the samples of a row share noise of unknown covariance, products and differences of samples give indices conditional
 *    on the noise, which no column reports.  Raw indices remain, as defined by their protocol, and so does S1 by local
 *    regression, because neighbors are from different rows.  The other columns are undefined. */
#include "engine/indices/indices.h"

#include <assert.h>
#include <math.h>
#include <string.h>

/* Half widths from the first rows of the design alone. */
struct level {
	int kept; /* valid rows among them */
	struct {
		double first[POUND_INPUTS_MAX], total[POUND_INPUTS_MAX];
	} closed, pick_freeze; /* with the polynomials of all rows; with few resamples */
};

enum {
	RESAMPLES_FEW = 400, /* half widths to 5 % */
};

/* The data that the columns are estimated from. */
struct sources {
	const struct pound_rows *rows;
	const struct pound_sampling *sampling;
	struct pound_pick_freeze pick_freeze;
	struct pound_closed_results closed; /* of chaos_expansion.c, if there are enough rows */
	bool corrected;                     /* the covariances of a row's noise are known */
	bool variance_known;                /* at least the variances are */
	bool shared;                        /* samples of a row share noise of unknown covariance */
	double *scratch;
	double *behind; /* fewest effective rows of the intervals used, pound_jackknife_rows */
	struct level level[POUND_LEVELS];
	struct pound_accuracy *accuracy;
};

static bool always(const struct sources *s)
{
	(void)s;
	return true;
}

static bool signals_enough(const struct sources *s)
{
	return s->corrected;
}

static bool signals_shared(const struct sources *s)
{
	return s->corrected && !s->sampling->fresh_signals;
}

static bool rows_enough(const struct sources *s)
{
	return s->rows->n_rows >= POUND_ROWS_MIN;
}

static void copy(const struct sources *s, const struct pound_estimate *from, struct pound_estimate *into)
{
	memcpy(into, from, sizeof *into * (size_t)s->rows->n_inputs);
}

static void first_raw(const struct sources *s, struct pound_estimate *into)
{
	copy(s, s->pick_freeze.first_raw, into);
}

static void total_raw(const struct sources *s, struct pound_estimate *into)
{
	copy(s, s->pick_freeze.total_raw, into);
}

static void first_corrected(const struct sources *s, struct pound_estimate *into)
{
	copy(s, s->pick_freeze.first, into);
}

static void total_corrected(const struct sources *s, struct pound_estimate *into)
{
	copy(s, s->pick_freeze.total, into);
}

static void with_excitation(const struct sources *s, struct pound_estimate *into)
{
	copy(s, s->pick_freeze.with_signal, into);
}

static double half(struct pound_estimate estimate)
{
	return 0.5 * (estimate.high - estimate.low);
}

static enum pound_noise noise_of(const struct sources *s)
{
	return s->corrected ? POUND_NOISE_REMOVED : POUND_NOISE_KEPT;
}

/* Half widths from the first n/8, n/4 and n/2 rows by chaos_expansion.c, with its scratch as left, and by pick-freeze; the half
 * widths of all rows are the half widths of the indices. */
static void levels_fill(struct sources *s, uint64_t seed)
{
	const int d = s->rows->n_inputs;
	for (int k = 0; k < POUND_LEVELS - 1; k++) {
		struct level *level = &s->level[k];
		struct pound_closed_results closed;
		if (level->kept < POUND_ROWS_MIN || pound_stopped(s->rows->stop))
			continue;
		pound_chaos_expansion_first_rows(s->rows, level->kept, s->scratch, &closed);
		for (int j = 0; j < d; j++) {
			level->closed.first[j] = half(closed.first[j]);
			level->closed.total[j] = half(closed.total[j]);
		}
	}
	for (int k = 0; k < POUND_LEVELS - 1; k++) {
		struct level *level = &s->level[k];
		struct pound_estimate estimates[2 * POUND_INPUTS_MAX];
		struct pound_rows part = *s->rows;
		part.n_rows = level->kept;
		if (level->kept < POUND_ROWS_MIN)
			continue;
		pound_plain_estimates(&part, pound_estimator_row(0), noise_of(s),
		                      (struct pound_resampling){seed, RESAMPLES_FEW}, s->scratch, estimates);
		for (int j = 0; j < d; j++) {
			level->pick_freeze.first[j] = half(estimates[j]);
			level->pick_freeze.total[j] = half(estimates[d + j]);
		}
	}
}

/* For every input the estimate with the narrower interval.  Widths from a few groups of rows scatter by 25 %, so that the
 * narrower of two would be too narrow: q must be narrower by a factor of 1.5.  p is the estimate without a polynomial, so that
 * with Sobol' sequences no index is worse than pick-freeze if polynomials do not fit. */
static void narrower(const struct sources *s, const struct pound_estimate *p, const struct pound_estimate *q,
                     struct pound_estimate *into)
{
	const double factor = s->rows->scatter.grouping.n ? 1.5 : 1.0;
	for (int j = 0; j < s->rows->n_inputs; j++)
		into[j] = factor * (q[j].high - q[j].low) < p[j].high - p[j].low ? q[j] : p[j];
}

static bool same(struct pound_estimate p, struct pound_estimate q)
{
	return p.value == q.value && p.high == q.high;
}

/* Replaces possibly biased estimates by unbiased ones if their difference exceeds the combined half widths. */
static void refuse(const struct sources *s, const struct pound_estimate *unbiased,
                   struct pound_estimate *biased)
{
	for (int j = 0; j < s->rows->n_inputs; j++) {
		const double apart = biased[j].value - unbiased[j].value, p = half(biased[j]), q = half(unbiased[j]);
		if (apart * apart > p * p + q * q)
			biased[j] = unbiased[j];
	}
}

static void undefined(struct pound_estimate *estimates, int n)
{
	for (int k = 0; k < n; k++)
		estimates[k] = (struct pound_estimate){NAN, NAN, NAN};
}

/* Whether the variance has fewer effective rows than a quarter of the rows; normal outputs have more. */
static bool few_hold_most(const struct pound_rows *rows)
{
	return pound_rows_behind(rows) < 0.25 * rows->n_rows;
}

/* Updates the fewest effective rows with the rows of a used interval, unless the interval is too narrow to matter. */
static void behind_take(const struct sources *s, struct pound_estimate estimate, double rows)
{
	const double narrow = 0.005;
	if (half(estimate) > narrow && rows < *s->behind)
		*s->behind = rows;
}

/* Total indices by pick-freeze and by polynomials, and what their upper ends widen their intervals by. */
struct totals {
	struct pound_estimate plain[POUND_INPUTS_MAX], closed[POUND_INPUTS_MAX];
	double plain_widening[POUND_INPUTS_MAX], closed_widening[POUND_INPUTS_MAX];
};

static double raise(struct pound_estimate *estimate, double distance)
{
	const double before = half(*estimate);
	estimate->high = fmax(estimate->high, estimate->value + distance);
	return before > 0.0 ? half(*estimate) / before : 1.0;
}

/* A total index is the mean of squared differences.  If few rows decide, their distribution is skewed, and rows that matter may be
 * missing: the estimate and its standard error are then too low together.  The upper ends therefore follow from Hall's
 * transformation (pound_jackknife_skewed).  A polynomial reduces the differences, but is worst where outputs are extreme: what it
 * leaves has at least the skewness of the differences themselves, even if the rows that would show it are missing. */
static void totals_fill(const struct sources *s, struct totals *totals)
{
	const struct pound_pick_freeze *p = &s->pick_freeze;
	const struct pound_upper *upper = s->corrected ? p->total_upper : p->total_raw_upper;
	copy(s, s->corrected ? p->total : p->total_raw, totals->plain);
	copy(s, s->closed.total, totals->closed);
	for (int j = 0; j < s->rows->n_inputs; j++) {
		totals->plain_widening[j] = raise(&totals->plain[j], half(totals->plain[j]) * upper[j].widening);
		totals->closed_widening[j] = raise(&totals->closed[j], s->closed.total_error[j] * upper[j].errors);
	}
}

/* A first-order index cannot exceed the total index.  If its interval lies above the interval of the total, the noise of few rows passes
 * for an effect of the input: the pick-freeze estimate is taken, which is exactly 0 for an input without effect.  Not with few
 * effective rows, where the total may have missed the rows that matter. */
static void first_bound(const struct sources *s, bool heavy, struct pound_estimate *into,
                        bool replaced[POUND_INPUTS_MAX])
{
	const struct pound_pick_freeze *p = &s->pick_freeze;
	struct pound_estimate total[POUND_INPUTS_MAX];
	struct totals totals;
	totals_fill(s, &totals);
	narrower(s, totals.plain, totals.closed, total);
	for (int j = 0; j < s->rows->n_inputs; j++) {
		replaced[j] = !s->shared && !heavy && into[j].low > total[j].high;
		if (replaced[j])
			into[j] = (s->corrected ? p->first : p->first_raw)[j];
	}
}

static void first_sharpest(const struct sources *s, struct pound_estimate *into)
{
	const int d = s->rows->n_inputs;
	bool replaced[POUND_INPUTS_MAX];
	struct pound_estimate local[POUND_INPUTS_MAX];
	// neighbors in one input cannot be used if they are arranged in the others
	const bool neighbours = !s->sampling->quasi_random;
	if (s->shared && !neighbours) {
		undefined(into, d);
		return;
	}
	if (neighbours)
		pound_local_regression_first(s->rows, s->sampling->u,
		                             s->variance_known ? POUND_NOISE_REMOVED : POUND_NOISE_KEPT, s->scratch,
		                             local);
	if (neighbours && !s->shared)
		refuse(s, s->closed.first, local);
	if (s->shared)
		copy(s, local, into);
	else
		narrower(s,
		         neighbours     ? local
		         : s->corrected ? s->pick_freeze.first
		                        : s->pick_freeze.first_raw,
		         s->closed.first, into);
	const bool heavy = few_hold_most(s->rows);
	double behind[POUND_INPUTS_MAX];
	if (neighbours)
		pound_local_regression_behind(s->rows, s->scratch, behind);
	for (int j = 0; j < d && !s->shared; j++) {
		// with few effective rows the mean of ten neighbors is not yet the conditional mean
		if (heavy && s->closed.first_rows[j] < POUND_ROWS_BEHIND)
			into[j] = s->closed.first[j];
		behind_take(s, into[j],
		            neighbours && !same(into[j], s->closed.first[j]) ? behind[j] : s->closed.first_rows[j]);
	}
	first_bound(s, heavy, into, replaced);
	for (int j = 0; j < d; j++)
		if (!replaced[j] && same(into[j], s->closed.first[j]))
			s->accuracy->inputs[j].first_noise = s->closed.noise.first[j];
	for (int k = 0; k < POUND_LEVELS - 1; k++) {
		const struct level *level = &s->level[k];
		double other[POUND_INPUTS_MAX];
		if (level->kept < POUND_ROWS_MIN)
			continue;
		if (neighbours)
			pound_local_regression_first_rows(s->rows, level->kept, s->scratch, other);
		else
			memcpy(other, level->pick_freeze.first, sizeof other);
		for (int j = 0; j < d; j++)
			s->accuracy->inputs[j].first_half[k] = replaced[j] ? level->pick_freeze.first[j]
			                                       : same(into[j], s->closed.first[j])
			                                           ? level->closed.first[j]
			                                           : other[j];
	}
}

static double beyond(double share)
{
	return fmax(0.0, fmax(-share, share - 1.0));
}

/* Of two estimates from few effective rows p, unless p is outside [0, 1] by more than typical sampling errors and q by less: then
 * the value of q with the union of both intervals, as neither is wide enough.  One large output that the polynomial misses
 * gives a total far below 0 or above 1. */
static struct pound_estimate nearer_a_share(struct pound_estimate p, struct pound_estimate q)
{
	const double most = 0.05;
	if (!(beyond(p.value) > most && beyond(q.value) < beyond(p.value)))
		return p;
	return (struct pound_estimate){q.value, fmin(p.low, q.low), fmax(p.high, q.high)};
}

/* A part of a half width that is widened as a whole. */
static struct pound_range widened(struct pound_range part, double widening)
{
	return (struct pound_range){part.low * widening, part.high * widening};
}

/* Totals by the polynomial or by pick-freeze.  If few rows decide, pick-freeze intervals may be too narrow by chance: then by
 * the polynomial, if its value is near [0, 1]. */
static void total_sharpest(const struct sources *s, struct pound_estimate *into)
{
	const int d = s->rows->n_inputs;
	const bool heavy = few_hold_most(s->rows);
	struct totals totals;
	totals_fill(s, &totals);
	const struct pound_estimate *plain = totals.plain, *closed = totals.closed;
	narrower(s, plain, closed, into);
	for (int j = 0; j < d; j++) {
		if (heavy && plain[j].high > plain[j].low && s->closed.total_rows[j] < POUND_ROWS_BEHIND)
			into[j] = nearer_a_share(closed[j], plain[j]);
		if (plain[j].high > plain[j].low)
			behind_take(s, into[j], s->closed.total_rows[j]);
		if (same(into[j], closed[j]))
			s->accuracy->inputs[j].total_noise = widened(s->closed.noise.total[j], totals.closed_widening[j]);
		else if (same(into[j], plain[j]))
			s->accuracy->inputs[j].total_noise = widened(s->closed.noise.plain[j], totals.plain_widening[j]);
	}
	for (int k = 0; k < POUND_LEVELS - 1; k++) {
		const struct level *level = &s->level[k];
		for (int j = 0; j < d && level->kept >= POUND_ROWS_MIN; j++)
			s->accuracy->inputs[j].total_half[k] =
			    same(into[j], closed[j]) ? level->closed.total[j] * totals.closed_widening[j]
			                             : level->pick_freeze.total[j] * totals.plain_widening[j];
	}
}

static void shapley(const struct sources *s, struct pound_estimate *into)
{
	copy(s, s->closed.shapley, into);
}

// in the order of computation: a substitute comes before the column that it replaces
// clang-format off
static const struct index_column {
	enum pound_index index;
	bool (*possible)(const struct sources *s);
	void (*make)(const struct sources *s, struct pound_estimate *into);
	enum pound_index instead; /* the substitute column, POUND_N_INDICES: none, undefined */
	bool shared; /* valid even if the samples of a row share noise of unknown covariance */
} columns[] = {
	{POUND_S1_RAW,         always,         first_raw,       POUND_N_INDICES,      true},
	{POUND_ST_RAW,         always,         total_raw,       POUND_N_INDICES,      true},
	{POUND_S1_PICK_FREEZE, signals_enough, first_corrected, POUND_S1_RAW,         false},
	{POUND_ST_PICK_FREEZE, signals_enough, total_corrected, POUND_ST_RAW,         false},
	{POUND_S2_EXCITATION,  signals_shared, with_excitation, POUND_N_INDICES,      false},
	{POUND_S1,             rows_enough,    first_sharpest,  POUND_S1_PICK_FREEZE, true},
	{POUND_ST,             rows_enough,    total_sharpest,  POUND_ST_PICK_FREEZE, false},
	{POUND_SHAPLEY,        rows_enough,    shapley,         POUND_N_INDICES,      false},
};
// clang-format on

static_assert(sizeof columns / sizeof columns[0] == POUND_N_INDICES, "every index has its row");

/* The columns of the study's named estimator, if any. */
static void named_fill(const struct sources *s, uint64_t seed, struct pound_indices *indices)
{
	const struct pound_estimator *estimator = pound_estimator_row(s->sampling->estimator);
	struct pound_estimate estimates[2 * POUND_INPUTS_MAX];
	for (int corrected = 0; corrected < 2 && s->sampling->estimator; corrected++) {
		struct pound_estimate *const *into = indices->named + (corrected ? POUND_NAMED_S1_CORRECTED : 0);
		for (int k = 0; k < 2 * POUND_INPUTS_MAX; k++)
			undefined(&estimates[k], 1);
		if (s->corrected || !corrected)
			pound_plain_estimates(s->rows, estimator, corrected ? POUND_NOISE_REMOVED : POUND_NOISE_KEPT,
			                      (struct pound_resampling){seed, POUND_RESAMPLES}, s->scratch, estimates);
		copy(s, estimates, into[POUND_NAMED_S1]);
		copy(s, estimates + s->rows->n_inputs, into[POUND_NAMED_ST]);
	}
}

/* An index of an input that changes no output of any row is 0, with an interval of zero width.  With few effective rows m, the
 * fraction t of outputs that depend on the input may be as large as all m rows miss with probability 1/40: (1 - t)^m = 1/40,
 * t <= ln 40 / m. */
static void unseen_widen(const struct sources *s, struct pound_indices *indices)
{
	static const enum pound_index headline[] = {POUND_S1, POUND_ST};
	const double missed = 3.6888794541139363;
	for (size_t k = 0; k < sizeof headline / sizeof headline[0]; k++)
		for (int j = 0; j < s->rows->n_inputs; j++) {
			struct pound_estimate *e = &indices->index[headline[k]][j];
			if (e->value == 0.0 && e->high == 0.0 && pound_rows_levels(s->rows, j) != 1)
				e->high = fmin(1.0, missed / pound_rows_behind(s->rows));
		}
}

static void columns_fill(const struct sources *s, uint64_t seed, struct pound_indices *indices)
{
	const int d = s->rows->n_inputs;
	for (int k = 0; k < POUND_N_INDICES && !pound_stopped(s->rows->stop); k++) {
		const struct index_column *column = &columns[k];
		struct pound_estimate *into = indices->index[column->index];
		const bool valid = column->shared || !s->shared;
		if (valid && column->possible(s))
			column->make(s, into);
		else if (!valid || column->instead == POUND_N_INDICES)
			undefined(into, d);
		else
			copy(s, indices->index[column->instead], into);
	}
	named_fill(s, seed, indices);
	for (int k = 0; k < indices->sets.n_second && s->shared; k++)
		undefined(&indices->sets.second[k].estimate, 1);
	for (int k = 0; k < indices->sets.n_closed && s->shared; k++)
		undefined(&indices->sets.closed[k].estimate, 1);
	for (int g = 0; g < indices->groups.n && s->shared; g++) {
		undefined(&indices->groups.first[g], 1);
		undefined(&indices->groups.total[g], 1);
	}
	for (int j = 0; j < d; j++)
		for (int k = 0; k < POUND_N_INDICES && pound_rows_levels(s->rows, j) == 1; k++)
			if (k != POUND_S1_RAW && k != POUND_ST_RAW && !isnan(indices->index[k][j].value))
				indices->index[k][j] = (struct pound_estimate){0.0, 0.0, 0.0};
	indices->share[POUND_SHARE_FIRST_ONE] = s->pick_freeze.signal_first;
	indices->share[POUND_SHARE_TOTAL_ONE] = s->pick_freeze.signal_total_one;
	indices->share[POUND_SHARE_TOTAL] = s->pick_freeze.signal_total;
	if (!signals_shared(s))
		undefined(&indices->share[POUND_SHARE_FIRST_ONE], 1);
}

/* The number of valid rows among the first n/8, n/4, n/2 and n of the design; half widths are set to NAN. */
static void levels_init(struct sources *s, int n_rows)
{
	for (int k = 0; k < POUND_LEVELS; k++) {
		int *kept = &s->level[k].kept;
		while (*kept < s->rows->n_rows && s->rows->row[*kept] < n_rows >> (POUND_LEVELS - 1 - k))
			++*kept;
		for (int j = 0; j < s->rows->n_inputs; j++)
			s->accuracy->inputs[j].first_half[k] = s->accuracy->inputs[j].total_half[k] = NAN;
	}
	for (int j = 0; j < s->rows->n_inputs; j++)
		s->accuracy->inputs[j].first_noise = s->accuracy->inputs[j].total_noise =
		    (struct pound_range){NAN, NAN};
}

/* The indices of ratios.  If the noise of few signals is known, `explained` is a fraction of the variance without it: the noise
 * share is converted to the variance of the bias-corrected outputs. */
static void ratios_fill(const struct sources *s, struct pound_indices *indices)
{
	indices->ratios.n = 0;
	if (!s->sampling->ratios || !rows_enough(s))
		return;
	double noise = 0.0;
	if (s->variance_known)
		noise = indices->noise_share * pound_rows_variance(s->rows, s->rows->plain) /
		        pound_rows_variance(s->rows, s->rows->y);
	pound_ratio_indices(s->rows, s->sampling->u, s->sampling->ratios, noise, s->scratch, &indices->ratios);
}

/* Whether the variance after noise correction, the denominator of the indices, may be 0: it is not positive, or the interval of
 * the noise share reaches 1. */
static bool lost_in_noise(const struct sources *s, const struct pound_indices *indices)
{
	static const enum pound_index corrected[] = {POUND_S1_PICK_FREEZE, POUND_ST_PICK_FREEZE, POUND_S1,
	                                             POUND_ST};
	for (size_t k = 0; k < sizeof corrected / sizeof corrected[0] && s->corrected; k++)
		for (int j = 0; j < s->rows->n_inputs; j++)
			if (isnan(indices->index[corrected[k]][j].value))
				return true;
	const struct pound_estimate *share = &indices->share[POUND_SHARE_TOTAL];
	return s->variance_known && share->high >= 1.0;
}

/* Whether an index has a value but no interval: without some group of rows no variance is left for it. */
static bool lacks_interval(const struct pound_indices *indices, int n_inputs)
{
	static const enum pound_index headline[] = {POUND_S1, POUND_ST};
	for (size_t k = 0; k < sizeof headline / sizeof headline[0]; k++)
		for (int j = 0; j < n_inputs; j++) {
			const struct pound_estimate *e = &indices->index[headline[k]][j];
			if (!isnan(e->value) && isnan(e->high - e->low))
				return true;
		}
	return false;
}

/* Whether too few rows hold the variance for their scatter to give valid intervals: fewer than POUND_ROWS_BEHIND effective rows in the
 * variance, or in an interval while few rows hold most of the variance. */
static bool few_decide(const struct sources *s)
{
	return pound_rows_behind(s->rows) < POUND_ROWS_BEHIND ||
	       (*s->behind < POUND_ROWS_BEHIND && few_hold_most(s->rows));
}

/* Rows needed for valid intervals: effective rows grow at most in proportion to rows.  Rounded up to two digits. */
static double rows_needed(double n, double behind)
{
	double needed = n * POUND_ROWS_BEHIND / fmax(behind, 1.0), digits = 1.0;
	while (needed / digits > 100.0)
		digits *= 10.0;
	return ceil(needed / digits) * digits;
}

/* Whether the interval of some first-order index lies above the interval of its total index, by more than typical sampling errors. */
static bool above_total(const struct pound_indices *indices, int n_inputs)
{
	const double most = 0.05;
	for (int j = 0; j < n_inputs; j++)
		if (indices->index[POUND_S1][j].low > indices->index[POUND_ST][j].high + most)
			return true;
	return false;
}

static unsigned notes_of(const bool said[POUND_N_NOTES])
{
	unsigned notes = 0;
	for (int k = 0; k < POUND_N_NOTES; k++)
		notes |= said[k] ? 1u << k : 0u;
	return notes;
}

size_t pound_index_columns_scratch(const struct pound_sample_values *shape,
                                   const struct pound_sampling *sampling)
{
	const size_t sizes[] = {
	    pound_plain_estimates_scratch(shape, pound_estimator_row(sampling ? sampling->estimator : 0)),
	    sampling && sampling->ratios ? pound_ratio_scratch(shape, sampling->ratios) : 0,
	    pound_plain_estimates_scratch(shape, pound_estimator_row(0)),
	    pound_noise_correction_scratch(shape),
	    pound_local_regression_scratch(shape),
	    pound_chaos_expansion_scratch(shape)};
	size_t largest = 0;
	for (size_t k = 0; k < sizeof sizes / sizeof sizes[0]; k++)
		largest = sizes[k] > largest ? sizes[k] : largest;
	return pound_rows_scratch(shape) + largest;
}

/* All sensitivity indices of one output, with 95 % intervals and notes.
 *
 * Given    values    (n_rows x n_samples x n_signals)         of each run; n_rows <= 2^20
 *          sampling  -                                       the design, and whether the noise is known
 *          seed      -                                       of the resamples
 * Returns  value     number of failed rows: a run has no output
 *          indices   all members, and of the accuracy the half widths from the first rows; indices (n_inputs) each, NAN with a
 *                    note if undefined
 * Memory   scratch   (pound_index_columns_scratch)
 *
 * Valid    Any design.  With fewer than 30 rows S1 and ST are from pick-freeze: for six test functions
 *          with noise, n = 16, its totals err by 0.20, totals with the polynomial by 0.27; n = 30: 0.14, 0.12.
 * Source   plain_indices.c, noise_correction.c, local_regression.c, chaos_expansion.c
 * Test     unit_index_columns, unit_shared_noise
 */
int pound_index_columns_indices(const struct pound_sample_values *values,
                                const struct pound_sampling *sampling, uint64_t seed, double *scratch,
                                struct pound_indices *indices)
{
	const int d = values->n_inputs;
	struct pound_rows rows;
	double behind = INFINITY;
	pound_rows_init(&rows, values, scratch);
	struct sources s = {.rows = &rows,
	                    .sampling = sampling,
	                    .corrected = values->n_signals > 1 && sampling->random,
	                    .scratch = scratch + pound_rows_scratch(values),
	                    .accuracy = &indices->accuracy,
	                    .behind = &behind};
	// outputs computed elsewhere come with noise variances, which suffice if samples do not share noise; whether the
	// outputs have noise at all is not known
	const bool elsewhere = values->variance, fresh = sampling->fresh_signals;
	s.variance_known = elsewhere ? sampling->random : s.corrected;
	s.corrected = s.variance_known && (!elsewhere || fresh);
	s.shared = !fresh && !s.corrected && (elsewhere || sampling->random);
	const bool varies = pound_plain_summary(&rows, indices);
	if (pound_stopped(rows.stop))
		return 0;
	for (int j = 0; j < d && indices->curves; j++)
		undefined(indices->curves[j].mean, POUND_CURVE);
	levels_init(&s, values->n_rows);
	if (varies) {
		const struct pound_resampling resampling = {seed, sampling->n_resamples ? sampling->n_resamples
		                                                                        : POUND_RESAMPLES};
		pound_noise_correction_estimates(&rows, resampling, s.scratch, &s.pick_freeze);
		if (rows_enough(&s) && !pound_stopped(rows.stop)) {
			pound_chaos_expansion_indices(&rows, sampling, noise_of(&s), s.scratch, &s.closed,
			                              indices->curves);
			levels_fill(&s, seed);
		}
		indices->sets = s.closed.sets;
		indices->groups = s.closed.groups;
		ratios_fill(&s, indices);
		columns_fill(&s, seed, indices);
		if (elsewhere) // the number of replicates is not known
			undefined(&indices->share[POUND_SHARE_TOTAL_ONE], 1);
	} else {
		indices->sets = (struct pound_set_indices){0};
		indices->groups.n = 0;
		indices->ratios.n = 0;
		for (int k = 0; k < POUND_N_INDICES; k++)
			undefined(indices->index[k], d);
		for (int k = 0; k < POUND_N_NAMED && sampling->estimator; k++)
			undefined(indices->named[k], d);
		undefined(indices->share, POUND_N_SHARES);
	}
	const bool few = !rows_enough(&s), decided = varies && !few && few_decide(&s);
	indices->rows_needed =
	    decided ? rows_needed(values->n_rows, fmin(behind, pound_rows_behind(&rows))) : NAN;
	if (decided)
		unseen_widen(&s, indices);
	indices->notes = notes_of((const bool[POUND_N_NOTES]){
	    [POUND_NOTE_NO_ROWS] = rows.n_rows == 0,
	    [POUND_NOTE_ONE_ROW] = rows.n_rows == 1,
	    [POUND_NOTE_CONSTANT] = rows.n_rows > 1 && !varies,
	    [POUND_NOTE_NOT_RANDOM] = varies && !elsewhere && !sampling->random,
	    [POUND_NOTE_ONE_SIGNAL] = varies && !elsewhere && !s.corrected && sampling->random && fresh,
	    [POUND_NOTE_SHARED_SIGNAL] = varies && !elsewhere && s.shared,
	    [POUND_NOTE_NO_VARIANCE] = varies && elsewhere && !sampling->random && fresh,
	    [POUND_NOTE_SHARED_NOISE] = varies && elsewhere && s.shared,
	    [POUND_NOTE_NOISE_INSIDE] = varies && s.shared && !s.variance_known,
	    [POUND_NOTE_NO_NEIGHBORS] = varies && s.shared && (few || sampling->quasi_random),
	    [POUND_NOTE_FRESH_SIGNALS] = varies && !elsewhere && s.corrected && fresh,
	    [POUND_NOTE_FEW_ROWS] = varies && few && !s.shared,
	    [POUND_NOTE_NOISE] = varies && lost_in_noise(&s, indices),
	    [POUND_NOTE_NO_INTERVAL] = varies && lacks_interval(indices, d),
	    [POUND_NOTE_ABOVE_TOTAL] = varies && !few && above_total(indices, d),
	    [POUND_NOTE_FEW_DECIDE] = decided,
	});
	const int dropped = values->n_rows - rows.n_rows;
	pound_failed_rows_changes(&rows, dropped, &indices->accuracy);
	for (int j = 0; j < d && s.shared; j++)
		indices->accuracy.inputs[j].total_dropped = NAN;
	return dropped;
}
