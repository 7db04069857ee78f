/* conditional_mean.c - conditional mean of the output given one input, as a curve with a 95 % band.
 *
 * 1. Every sample of every row is used; the abscissa is the input's probability u, which is uniform.
 * 2. Local-linear regression with the Epanechnikov kernel; the bandwidth minimizes the error of predicting a fifth of the
 *    rows from the others.  The regression is applied to the outputs less a trend, and the trend's curve is added.
 * 3. The band belongs to half the bandwidth, which has less bias: from the influence of each row on the curve (rows, not
 *    samples, are independent) and from the change by halving the bandwidth, which is large at a kink or a jump.
 *
 * Fan, Gijbels 1996, Local polynomial modelling and its applications. */
#include "engine/indices/indices.h"

#include <math.h>
#include <string.h>

enum {
	FOLDS = 5,
	BINS = 64,      /* of points, for choosing the bandwidth */
	BANDWIDTHS = 4, // up to 0.08, to resolve a trend's own error, which has waves of length 1/6
};

// smallest bandwidth in u (larger for few rows), ratio of successive bandwidths, least mean number of rows in a bandwidth
static const double BANDWIDTH_LEAST = 0.03, BANDWIDTH_STEP = 1.4, ROWS_LEAST = 5.0;

/* Data points of the regression: two per row, for the input's value in A and in B. */
struct points {
	int n;            /* two per row, first A, then B */
	double *u, *sum;  /* place, sum of the outputs  (n) each */
	double weight[2]; /* samples per point of A, of B */
};

/* Weighted sums over points of 1, u, u^2, y, u y, with u relative to some place. */
struct line_sums {
	double one, u, uu, y, uy;
};

/* The weighted least-squares line at a place. */
struct line {
	double level, slope;
};

static struct line line_of(const struct line_sums *s)
{
	const double spread = s->one * s->uu - s->u * s->u;
	// points at one place define a mean but no slope
	const bool flat = !(spread > 1e-9 * s->one * s->one);
	const double slope = flat ? 0.0 : (s->one * s->uy - s->u * s->y) / spread;
	return (struct line){(s->y - slope * s->u) / s->one, slope};
}

static double kernel(double distance, double bandwidth)
{
	const double t = distance / bandwidth;
	return t * t < 1.0 ? 1.0 - t * t : 0.0;
}

static void points_fill(struct points *points, const struct pound_conditional *given, int input)
{
	const struct pound_rows *rows = given->rows;
	const int d = rows->n_inputs, n_samples = rows->n_samples;
	bool from_b[POUND_SAMPLES_MAX];
	points->n = 2 * rows->n_rows;
	points->weight[0] = points->weight[1] = 0.0;
	for (int p = 0; p < n_samples; p++) {
		from_b[p] = pound_rows_mask(rows, p) >> input & 1;
		points->weight[from_b[p]]++;
	}
	for (int i = 0; i < rows->n_rows; i++) {
		double *sum = points->sum + 2 * (size_t)i;
		for (int matrix = 0; matrix < 2; matrix++) {
			points->u[2 * (size_t)i + matrix] = given->u[((size_t)rows->row[i] * 2 + matrix) * d + input];
			sum[matrix] = 0.0;
		}
		for (int p = 0; p < n_samples; p++)
			sum[from_b[p]] += given->y[(size_t)i * n_samples + p];
	}
}

/* ---- the bandwidth ---- */

struct bins {
	struct line_sums fold[FOLDS + 1][BINS]; /* u from the middle of the bin; the last one is the sum */
};

static void bins_fill(struct bins *bins, const struct points *points)
{
	memset(bins, 0, sizeof *bins);
	for (int k = 0; k < points->n; k++) {
		const int bin = (int)(points->u[k] * BINS), fold = k / 2 % FOLDS;
		const double u = points->u[k] - (bin + 0.5) / BINS, weight = points->weight[k % 2];
		for (int f = fold;; f = FOLDS) {
			struct line_sums *s = &bins->fold[f][bin];
			s->one += weight;
			s->u += weight * u;
			s->uu += weight * u * u;
			s->y += points->sum[k];
			s->uy += points->sum[k] * u;
			if (f == FOLDS)
				break;
		}
	}
}

/* Adds sums whose u is relative to a place at `shift`. */
static void sums_add(struct line_sums *into, const struct line_sums *s, double weight, double shift)
{
	into->one += weight * s->one;
	into->u += weight * (s->u + shift * s->one);
	into->uu += weight * (s->uu + 2.0 * shift * s->u + shift * shift * s->one);
	into->y += weight * s->y;
	into->uy += weight * (s->uy + shift * s->y);
}

/* Squared error of predicting every fold from the others, up to a constant; infinite if a bin has no neighbors to predict
 * from. */
static double prediction_error(const struct bins *bins, double bandwidth)
{
	const int reach = (int)(fmin(bandwidth, 1.0) * BINS);
	double error = 0.0;
	for (int bin = 0; bin < BINS; bin++) {
		struct line_sums near[FOLDS + 1];
		memset(near, 0, sizeof near);
		for (int other = bin - reach; other <= bin + reach; other++) {
			const double shift = (double)(other - bin) / BINS;
			for (int f = 0; f <= FOLDS && other >= 0 && other < BINS; f++)
				sums_add(&near[f], &bins->fold[f][other], kernel(shift, bandwidth), shift);
		}
		for (int f = 0; f < FOLDS; f++) {
			const struct line_sums *in = &bins->fold[f][bin];
			sums_add(&near[f], &near[FOLDS], -1.0, 0.0);
			if (in->one == 0.0)
				continue;
			if (!(near[f].one < 0.0))
				return INFINITY;
			// all sums have the opposite sign, which does not change the line
			const struct line line = line_of(&near[f]);
			error += line.level * line.level * in->one + 2.0 * line.level * line.slope * in->u +
			         line.slope * line.slope * in->uu - 2.0 * (line.level * in->y + line.slope * in->uy);
		}
	}
	return error;
}

static double bandwidth_of(struct bins *bins, const struct points *points)
{
	double least = INFINITY, best = 0.0;
	double bandwidth = fmax(BANDWIDTH_LEAST, ROWS_LEAST / (points->n / 2));
	bins_fill(bins, points);
	for (int k = 0; k < BANDWIDTHS; k++, bandwidth *= BANDWIDTH_STEP) {
		const double error = prediction_error(bins, bandwidth);
		if (k == 0 || error < least) {
			least = error;
			best = bandwidth;
		}
	}
	return best;
}

/* ---- the curve ---- */

double pound_conditional_place(int k)
{
	return (k + 0.5) / POUND_CURVE;
}

int pound_conditional_levels(const struct pound_distribution *distribution)
{
	const bool listed = pound_distribution_steps(distribution->type);
	return listed && distribution->n_values <= POUND_CURVE ? distribution->n_values : 0;
}

int pound_conditional_points(const struct pound_distribution *distribution)
{
	const int levels = pound_conditional_levels(distribution);
	return levels > 0 ? levels : POUND_CURVE;
}

double pound_conditional_x(const struct pound_distribution *distribution, int k)
{
	return pound_conditional_levels(distribution) > 0
	           ? distribution->values[k]
	           : pound_distribution_quantile(distribution, pound_conditional_place(k));
}

static struct line_sums sums_at(const struct points *points, double place, double bandwidth)
{
	struct line_sums s = {0};
	for (int k = 0; k < points->n; k++) {
		const double u = points->u[k] - place;
		if (!(fabs(u) < bandwidth))
			continue;
		const double weight = kernel(u, bandwidth);
		const double one = weight * points->weight[k % 2], y = weight * points->sum[k];
		s.one += one;
		s.u += one * u;
		s.uu += one * u * u;
		s.y += y;
		s.uy += y * u;
	}
	return s;
}

/* The curve between its places. */
static double level_at(const struct line *line, double u)
{
	int k = (int)(u * POUND_CURVE - 0.5);
	k = k > POUND_CURVE - 2 ? POUND_CURVE - 2 : k < 0 ? 0 : k;
	const double t = u * POUND_CURVE - 0.5 - k;
	return line[k].level + t * (line[k + 1].level - line[k].level);
}

/* Influence of each row on the curve at a place: regression weights of its points times their residuals. */
static void influence_fill(const struct points *points, const double *residual, double place,
                           double bandwidth, const struct line_sums *s, double *influence)
{
	const double spread = s->one * s->uu - s->u * s->u, n = points->n / 2;
	for (int i = 0; i < points->n / 2; i++) {
		influence[i] = 0.0;
		for (int k = 2 * i; k < 2 * i + 2; k++) {
			const double u = points->u[k] - place;
			if (!(fabs(u) < bandwidth))
				continue;
			influence[i] += n * kernel(u, bandwidth) * (s->uu - s->u * u) / spread * residual[k];
		}
	}
}

/* Layout of the scratch memory. */
struct mean_work {
	struct bins *bins;
	struct points points;
	double *residual;  /* of the points  (2 n_rows) */
	double *influence; /* (n_rows) */
	double *groups;    /* (groups, at most n_rows) */
};

static size_t carve(struct mean_work *work, double *scratch, int n_rows)
{
	const size_t n = n_rows;
	if (scratch) {
		work->points.u = scratch;
		work->points.sum = scratch + 2 * n;
		work->residual = scratch + 4 * n;
		work->influence = scratch + 6 * n;
		work->groups = scratch + 7 * n;
		work->bins = (struct bins *)(scratch + 8 * n);
	}
	return 8 * n + sizeof(struct bins) / sizeof(double);
}

static void curve_fill(const struct pound_conditional *given, const struct mean_work *work, double bandwidth,
                       struct pound_curve *curve)
{
	const struct pound_rows *rows = given->rows;
	const struct points *points = &work->points;
	struct line line[POUND_CURVE];
	struct line_sums sums[POUND_CURVE];
	for (int k = 0; k < POUND_CURVE && !pound_stopped(rows->stop); k++) {
		const struct line_sums wide = sums_at(points, pound_conditional_place(k), bandwidth);
		curve->mean[k].value = rows->mean + given->trend[k] + line_of(&wide).level;
		sums[k] = sums_at(points, pound_conditional_place(k), 0.5 * bandwidth);
		line[k] = line_of(&sums[k]);
	}
	for (int k = 0; k < points->n; k++)
		work->residual[k] = points->sum[k] - points->weight[k % 2] * level_at(line, points->u[k]);
	for (int k = 0; k < POUND_CURVE && !pound_stopped(rows->stop); k++) {
		influence_fill(points, work->residual, pound_conditional_place(k), 0.5 * bandwidth, &sums[k],
		               work->influence);
		const double sampling =
		    pound_jackknife_half_width(work->influence, rows->n_rows, &rows->scatter, work->groups);
		const double middle = rows->mean + given->trend[k] + line[k].level;
		const double step = curve->mean[k].value - middle, half = sqrt(sampling * sampling + step * step);
		curve->mean[k].low = middle - half;
		curve->mean[k].high = middle + half;
	}
}

/* The means of the rows at each value of a discrete input. */
static void levels_fill(const struct pound_conditional *given, int input, const struct mean_work *work,
                        struct pound_curve *curve)
{
	const struct pound_rows *rows = given->rows;
	const struct points *points = &work->points;
	const int n = rows->n_rows, levels = pound_rows_levels(rows, input);
	for (int k = 0; k < points->n; k++)
		points->u[k] = pound_distribution_level(&rows->inputs[input].distribution, points->u[k]);
	for (int level = levels; level < POUND_CURVE; level++)
		curve->mean[level] = (struct pound_estimate){NAN, NAN, NAN};
	for (int level = 0; level < levels && !pound_stopped(rows->stop); level++) {
		double weight = 0.0, sum = 0.0;
		int behind = 0; // rows
		for (int i = 0; i < n; i++) {
			const bool at[2] = {points->u[2 * i] == level, points->u[2 * i + 1] == level};
			behind += at[0] || at[1];
			for (int k = 0; k < 2; k++) {
				weight += at[k] ? points->weight[k] : 0.0;
				sum += at[k] ? points->sum[2 * i + k] : 0.0;
			}
		}
		for (int i = 0; i < n; i++) {
			work->influence[i] = 0.0;
			for (int k = 0; k < 2; k++)
				if (points->u[2 * i + k] == level)
					work->influence[i] +=
					    n / weight * (points->sum[2 * i + k] - points->weight[k] * sum / weight);
		}
		const double mean = behind > 0 ? rows->mean + given->trend[level] + sum / weight : NAN;
		const double half =
		    behind > 1 ? pound_jackknife_half_width(work->influence, n, &rows->scatter, work->groups) : NAN;
		curve->mean[level] = (struct pound_estimate){mean, mean - half, mean + half};
	}
}

size_t pound_conditional_scratch(int n_rows)
{
	return carve(NULL, NULL, n_rows);
}

/* The conditional mean of the output given an input, at POUND_CURVE places.
 *
 * Given    given     -                     POUND_ROWS_MIN rows or more
 *          input     -
 * Returns  curve     -                     at u = (k + 1/2) / POUND_CURVE, with a pointwise 95 % band; for a discrete input
 *                                          the means at each value, and NAN after the last
 * Memory   scratch   (pound_conditional_scratch)
 *
 * Valid    Any design.  A kink that is not in the trend is rounded within the bandwidth.
 * Test     unit_conditional_mean
 */
void pound_conditional_mean(const struct pound_conditional *given, int input, double *scratch,
                            struct pound_curve *curve)
{
	struct mean_work work = {0};
	carve(&work, scratch, given->rows->n_rows);
	points_fill(&work.points, given, input);
	if (pound_rows_levels(given->rows, input) > 0)
		levels_fill(given, input, &work, curve);
	else
		curve_fill(given, &work, bandwidth_of(work.bins, &work.points), curve);
}
