/* statistics_tails.c - indices of functions whose variance is dominated by a few samples, and of many inputs: errors
 * of S1, ST and of the named estimators, and coverage of intervals. */
#include "tests/long/statistics.h"

#include <gsl/gsl_cdf.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { INPUTS = 16, LEVELS_MAX = 6, JOBS = 200, SIZES = 2 };

static const int sizes[SIZES] = {250, 1000};

/* A function of independent variables, uniform or discrete, and how its exact indices are computed. */
struct tail {
	const char *name;
	int n_inputs;
	int levels[INPUTS]; /* a discrete input has the values 0, 1, ... with equal probabilities; 0: uniform */
	double (*y)(const double *u);
	void (*exact)(const struct tail *tail, double *value); /* first-order, then total  (2 x n_inputs) */
	double factor[INPUTS]; /* product: mean square over squared mean of each factor (n_inputs) */
};

/* A product of independent factors with ratios r_j of mean square to squared mean:
 *
 *   S_j = (r_j - 1) / (prod r - 1)     T_j = (r_j - 1) prod_others r / (prod r - 1)
 */
static void product(const struct tail *tail, double *value)
{
	const int d = tail->n_inputs;
	double all = 1.0;
	for (int j = 0; j < d; j++)
		all *= tail->factor[j];
	for (int j = 0; j < d; j++) {
		value[j] = (tail->factor[j] - 1.0) / (all - 1.0);
		value[d + j] = (tail->factor[j] - 1.0) * all / tail->factor[j] / (all - 1.0);
	}
}

static const double sigma[8] = {1.0, 0.7, 0.5, 0.2};

/* exp(sigma z): mean square over squared mean is exp(sigma^2) */
static double lognormal(const double *u)
{
	double sum = 0.0;
	for (int j = 0; j < 4; j++)
		sum += sigma[j] * gsl_cdf_ugaussian_Pinv(u[j]);
	return exp(sum);
}

static double lognormal_8(const double *u)
{
	double sum = 0.0;
	for (int j = 0; j < 8; j++)
		sum += 0.45 * gsl_cdf_ugaussian_Pinv(u[j]);
	return exp(sum);
}

static const double alpha[4] = {2.5, 3.0, 4.0, 6.0};

/* u^(-1/alpha): mean alpha / (alpha - 1), mean square alpha / (alpha - 2), no fourth moment for alpha <= 4 */
static double pareto(const double *u)
{
	double y = 1.0;
	for (int j = 0; j < 4; j++)
		y *= pow(u[j], -1.0 / alpha[j]);
	return y;
}

static double pareto_sum(const double *u)
{
	double y = 0.0;
	for (int j = 0; j < 4; j++)
		y += pow(u[j], -1.0 / alpha[j]);
	return y;
}

static void pareto_sum_exact(const struct tail *tail, double *value)
{
	double v[4], all = 0.0;
	for (int j = 0; j < 4; j++) {
		const double a = alpha[j], mean = a / (a - 1.0);
		v[j] = a / (a - 2.0) - mean * mean;
		all += v[j];
	}
	for (int k = 0; k < 2 * tail->n_inputs; k++)
		value[k] = v[k % 4] / all;
}

/* An event of one sample in a hundred that needs three inputs; 1 or 0: each factor has mean square over squared mean 1/p. */
static double event(const double *u)
{
	return u[0] > 0.8 && u[1] > 0.8 && u[2] > 0.75 ? 1.0 : 0.0;
}

static const double reach = 0.35;

/* Zero in 94 % of the samples, as of buildings that hardly touch: h (1 + u3), h = max(0, u1 + u2 - (2 - s))^2, s =
 * 0.35.
 *
 *   E h = s^4 / 12, E h^2 = s^6 / 30, E[h | u1] = e^3 / 3 with e uniform up to s: mean square s^7 / 63;  E g = 3/2, E g^2 = 7/3
 */
static double touch(const double *u)
{
	const double h = fmax(0.0, u[0] + u[1] - (2.0 - reach));
	return h * h * (1.0 + u[2]);
}

static void touch_exact(const struct tail *tail, double *value)
{
	const double s = reach, m = pow(s, 4) / 12.0, q = pow(s, 6) / 30.0, one = pow(s, 7) / 63.0;
	const double all = q * 7.0 / 3.0 - m * m * 9.0 / 4.0;
	const double first = (one - m * m) * 9.0 / 4.0 / all, third = m * m / 12.0 / all;
	const double with_third = (one * 7.0 / 3.0 - m * m * 9.0 / 4.0) / all,
	             pair = (q - m * m) * 9.0 / 4.0 / all;
	(void)tail;
	memcpy(value, (double[]){first, first, third, 0.0, 1.0 - with_third, 1.0 - with_third, 1.0 - pair, 0.0},
	       8 * sizeof *value);
}

/* sum over i of (-1)^(i + 1) u_1 ... u_i, i up to 8 */
static double bratley(const double *u)
{
	double sum = 0.0, term = 1.0;
	for (int j = 0; j < 8; j++) {
		term *= u[j];
		sum += j % 2 ? -term : term;
	}
	return sum;
}

/* Variance explained by a set of inputs, plus the squared mean: mean product of the function at two points that share
 * the inputs of the set, from E[u^2] = 1/3 of an input in the set and E[u]^2 = 1/4 of another. */
static double bratley_closed(unsigned set)
{
	double sum = 0.0;
	for (int i = 1; i <= 8; i++)
		for (int k = 1; k <= 8; k++) {
			double term = (i + k) % 2 ? -1.0 : 1.0;
			for (int j = 0; j < 8; j++) {
				const int of = (j < i) + (j < k);
				term *= of == 2 ? set >> j & 1 ? 1.0 / 3.0 : 0.25 : of == 1 ? 0.5 : 1.0;
			}
			sum += term;
		}
	return sum;
}

static void bratley_exact(const struct tail *tail, double *value)
{
	const double none = bratley_closed(0), all = bratley_closed(255) - none;
	for (int j = 0; j < tail->n_inputs; j++) {
		value[j] = (bratley_closed(1u << j) - none) / all;
		value[8 + j] = 1.0 - (bratley_closed(255u ^ 1u << j) - none) / all;
	}
}

/* Only the interaction of all inputs. */
static double parity(const double *u)
{
	double y = 1.0;
	for (int j = 0; j < 4; j++)
		y *= u[j] > 0.5 ? 1.0 : -1.0;
	return y;
}

static void parity_exact(const struct tail *tail, double *value)
{
	for (int k = 0; k < 2 * tail->n_inputs; k++)
		value[k] = k < tail->n_inputs ? 0.0 : 1.0;
}

static double g_weight(int j)
{
	return j < 4 ? 0.5 * j : 5.0 + j;
}

/* Sobol's g: factors (|4 u - 2| + a) / (1 + a), mean square 1 + 1 / (3 (1 + a)^2) */
static double g_15(const double *u)
{
	double y = 1.0;
	for (int j = 0; j < 15; j++)
		y *= (fabs(4.0 * u[j] - 2.0) + g_weight(j)) / (1.0 + g_weight(j));
	return y;
}

/* Whether any of 16 inputs is beyond its limit: 1 or 0; 1 in 5 % of the samples.  1 minus it is a product. */
static double any_of_16(const double *u)
{
	for (int j = 0; j < 16; j++)
		if (u[j] > 1.0 - 0.0008 * (j < 4 ? 10.0 : 2.0))
			return 1.0;
	return 0.0;
}

/* Two inputs, and a third that makes one sample in two hundred an outlier. */
static double outlier(const double *u)
{
	return u[0] + u[1] + (u[2] > 0.995 ? 20.0 : 0.0);
}

static void outlier_exact(const struct tail *tail, double *value)
{
	const double rare = 400.0 * 0.005 * 0.995, all = rare + 1.0 / 6.0;
	const double part[4] = {1.0 / 12.0 / all, 1.0 / 12.0 / all, rare / all, 0.0};
	for (int k = 0; k < 2 * tail->n_inputs; k++)
		value[k] = part[k % 4];
}

/* Smooth, of 16 inputs: sum of c_j v_j and of v_j v_(j + 1) / 4, v = sqrt(12) (u - 1/2). */
static double smooth_16(const double *u)
{
	double sum = 0.0;
	for (int j = 0; j < 16; j++) {
		const double v = sqrt(12.0) * (u[j] - 0.5);
		sum += v / (1.0 + j);
		if (j % 2 == 0)
			sum += 0.25 * v * sqrt(12.0) * (u[j + 1] - 0.5);
	}
	return sum;
}

static void smooth_16_exact(const struct tail *tail, double *value)
{
	const int d = tail->n_inputs;
	double all = 8.0 / 16.0;
	for (int j = 0; j < d; j++)
		all += 1.0 / ((1.0 + j) * (1.0 + j));
	for (int j = 0; j < d; j++) {
		value[j] = 1.0 / ((1.0 + j) * (1.0 + j)) / all;
		value[d + j] = value[j] + 1.0 / 16.0 / all;
	}
}

/* Three discrete factors of mean 1 and few values beside a factor that nearly decides alone: smooth, or of waves that polynomials
 * cannot follow.  Values are not in the order of their effects. */
static const double discrete_factor[4][LEVELS_MAX] = {
    {0}, {0.88, 1.12}, {1.02, 0.92, 1.06}, {0.99, 1.05, 0.97, 1.01, 0.95, 1.03}};

static double discrete(const double *u)
{
	double y = 1.5 - 1.2 * fabs(u[0] - 0.7);
	for (int j = 1; j < 4; j++)
		y *= discrete_factor[j][(int)u[j]];
	return y;
}

static double discrete_waves(const double *u)
{
	double y = 1.0 + 0.8 * sin(16.0 * M_PI * u[0]);
	for (int j = 1; j < 4; j++)
		y *= discrete_factor[j][(int)u[j]];
	return y;
}

static struct tail tails[] = {
    {.name = "lognormal", .n_inputs = 4, .y = lognormal, .exact = product},
    {.name = "lognormal_8", .n_inputs = 8, .y = lognormal_8, .exact = product},
    {.name = "pareto", .n_inputs = 4, .y = pareto, .exact = product},
    {.name = "pareto_sum", .n_inputs = 4, .y = pareto_sum, .exact = pareto_sum_exact},
    {.name = "event", .n_inputs = 4, .y = event, .exact = product, .factor = {5.0, 5.0, 4.0, 1.0}},
    {.name = "touch", .n_inputs = 4, .y = touch, .exact = touch_exact},
    {.name = "outlier", .n_inputs = 4, .y = outlier, .exact = outlier_exact},
    {.name = "parity", .n_inputs = 4, .y = parity, .exact = parity_exact},
    {.name = "bratley", .n_inputs = 8, .y = bratley, .exact = bratley_exact},
    {.name = "g_15", .n_inputs = 15, .y = g_15, .exact = product},
    {.name = "any_of_16", .n_inputs = 16, .y = any_of_16, .exact = product},
    {.name = "smooth_16", .n_inputs = 16, .y = smooth_16, .exact = smooth_16_exact},
    {.name = "discrete", .n_inputs = 4, .levels = {0, 2, 3, 6}, .y = discrete, .exact = product},
    {.name = "discrete_waves", .n_inputs = 4, .levels = {0, 2, 3, 6}, .y = discrete_waves, .exact = product},
};

enum { TAILS = sizeof tails / sizeof tails[0] };

/* Mean square over squared mean of a discrete factor. */
static double discrete_ratio(const double *factor, int levels)
{
	double sum = 0.0, squares = 0.0;
	for (int k = 0; k < levels; k++) {
		sum += factor[k];
		squares += factor[k] * factor[k];
	}
	return squares * levels / (sum * sum);
}

static void factors_fill(void)
{
	for (struct tail *tail = tails; tail < tails + TAILS; tail++)
		for (int j = 0; j < tail->n_inputs; j++) {
			double *r = &tail->factor[j];
			if (tail->y == lognormal)
				*r = exp(sigma[j] * sigma[j]);
			else if (tail->y == lognormal_8)
				*r = exp(0.45 * 0.45);
			else if (tail->y == pareto)
				*r = (alpha[j] - 1.0) * (alpha[j] - 1.0) / (alpha[j] * (alpha[j] - 2.0));
			else if (tail->y == g_15)
				*r = 1.0 + 1.0 / (3.0 * (1.0 + g_weight(j)) * (1.0 + g_weight(j)));
			else if (tail->y == any_of_16)
				*r = 1.0 / (1.0 - 0.0008 * (j < 4 ? 10.0 : 2.0));
			else if (tail->levels[j] > 0)
				*r = discrete_ratio(discrete_factor[j], tail->levels[j]);
			else if (tail->y ==
			         discrete) // |u - 0.7|: mean (0.7^2 + 0.3^2) / 2, mean square (0.7^3 + 0.3^3) / 3
				*r = (2.25 - 3.6 * 0.29 + 1.44 * 0.37 / 3.0) / pow(1.5 - 1.2 * 0.29, 2);
			else if (tail->y == discrete_waves)
				*r = 1.32;
		}
}

/* ---- runs ---- */

// columns: S1 and ST, then the named estimators for designs of order total, then the packages
enum { BEST, NAMED, NAMED_MAX = 8, PACKAGES = NAMED + NAMED_MAX, ESTIMATORS = PACKAGES + 2 };

struct tail_cell {
	const struct tail *tail;
	int design, size, n;
	double square[ESTIMATORS][2 * INPUTS], covered[2 * INPUTS], holds[2 * INPUTS], points[2 * INPUTS];
	double noted, needed;
};

struct campaign {
	int n_seeds, n_cells;
	struct tail_cell cells[JOBS];
};

static void score(struct tail_cell *cell, int estimator, const double *value, const double *exact)
{
	for (int k = 0; k < 2 * cell->tail->n_inputs; k++)
		cell->square[estimator][k] += (value[k] - exact[k]) * (value[k] - exact[k]);
}

static void named_values(int row, const double *y, int n, int d, double *value)
{
	const struct pound_estimator *e = pound_estimator_row(row);
	double mean[POUND_MOMENTS_MAX] = {0}, centre = 0.0,
	       *centred = statistics_sure(malloc(sizeof *y * (size_t)n * (size_t)(d + 2)));
	for (int k = 0; k < n * (d + 2); k++)
		centre += y[k] / (n * (d + 2));
	for (int k = 0; k < n * (d + 2); k++)
		centred[k] = y[k] - centre;
	for (int i = 0; i < n; i++) {
		double m[POUND_MOMENTS_MAX];
		e->moments(&(struct pound_outputs){d, d + 2, centred + (size_t)i * (size_t)(d + 2), NULL}, m);
		for (int t = 0; t < e->n_moments(d); t++)
			mean[t] += m[t] / n;
	}
	e->indices(mean, d, 0.0, value);
	free(centred);
}

static void seed_run(struct tail_cell *cell, uint64_t seed)
{
	static char name[] = "y";
	static char *names[] = {name};
	const int d = cell->tail->n_inputs;
	struct pound_input inputs[INPUTS] = {0};
	static const double values[LEVELS_MAX] = {0, 1, 2, 3, 4, 5};
	int steps = 0;
	while (!pound_distribution_steps(steps))
		steps++;
	for (int j = 0; j < d; j++)
		inputs[j].distribution = cell->tail->levels[j] > 0
		                             ? (struct pound_distribution){.type = steps,
		                                                           .n_values = cell->tail->levels[j],
		                                                           .values = values}
		                             : (struct pound_distribution){.type = 0, .p = {0.0, 1.0}};
	const struct pound_study study = {.kind = POUND_KIND_SENSITIVITY,
	                                  .elsewhere = true,
	                                  .n_inputs = d,
	                                  .inputs = inputs,
	                                  .design = statistics_design(cell->design, sizes[cell->size], seed),
	                                  .n_outputs = 1,
	                                  .output_names = names};
	struct pound_run *run = statistics_sure(pound_run_create(&study, 1));
	const int n = study.design.rows, n_samples = pound_run_samples(run);
	double *y = statistics_sure(malloc(sizeof *y * (size_t)n * (size_t)n_samples));
	double exact[2 * INPUTS], value[2 * INPUTS];
	bool varies = false;
	for (int i = 0; i < n; i++)
		for (int p = 0; p < n_samples; p++) {
			double u[INPUTS], *at = &y[(size_t)i * (size_t)n_samples + (size_t)p];
			pound_run_sample_inputs(run, i, p, u);
			*at = cell->tail->y(u);
			varies |= *at != y[0];
			pound_run_sample_assign(run, i, p, 0, *at, NAN);
		}
	pound_run_reduce(run, 0, 0);
	const struct pound_indices *indices = &pound_run_result(run)->cells[0].indices[0];
	cell->tail->exact(cell->tail, exact);
	const bool noted = indices->notes & (1u << POUND_NOTE_FEW_DECIDE | 1u << POUND_NOTE_NO_INTERVAL);
	for (int k = 0; k < 2 * d && varies; k++) {
		const struct pound_estimate *e = &indices->index[k < d ? POUND_S1 : POUND_ST][k % d];
		const bool holds = e->low - 1e-12 <= exact[k] && exact[k] <= e->high + 1e-12;
		value[k] = e->value;
		cell->holds[k] += holds;
		cell->covered[k] += noted || holds;
		cell->points[k] += e->high == e->low && fabs(e->value - exact[k]) > 1e-12;
	}
	if (varies) {
		cell->n++;
		cell->noted += noted;
		cell->needed += noted ? indices->rows_needed : 0.0;
		score(cell, BEST, value, exact);
		for (int k = 0; pound_estimator_row(k) && k < NAMED_MAX; k++)
			if (pound_estimator_row(k)->order == POUND_ORDER_TOTAL) {
				named_values(k, y, n, d, value);
				score(cell, NAMED + k, value, exact);
			}
		for (int k = 0; statistics_packages[k].name; k++) {
			statistics_packages[k].indices(y, n, d, n_samples, value);
			score(cell, PACKAGES + k, value, exact);
		}
	}
	free(y);
	pound_run_free(run);
}

static void cell_run(void *of, int k)
{
	struct campaign *campaign = of;
	for (int seed = 0; seed < campaign->n_seeds; seed++)
		seed_run(&campaign->cells[k], (uint64_t)seed);
}

/* ---- tables ---- */

static double error_of(const struct tail_cell *cell, int estimator, int total)
{
	const int d = cell->tail->n_inputs;
	double sum = 0.0;
	for (int j = 0; j < d; j++)
		sum += cell->square[estimator][total * d + j] / cell->n;
	return sqrt(sum / d);
}

static double least(const struct tail_cell *cell, const double *held, int total)
{
	const int d = cell->tail->n_inputs;
	double share = 1.0;
	for (int j = 0; j < d; j++)
		share = fmin(share, held[total * d + j] / cell->n);
	return share;
}

/* Estimators that S1 and ST must not be worse than; the first is the plain one. */
static const char *const rivals[] = {"saltelli_2010", "martinez", "janon"};

enum { RIVALS = sizeof rivals / sizeof rivals[0] };

static int named(const char *name)
{
	int k = 0;
	while (strcmp(pound_estimator_row(k)->name, name) != 0)
		k++;
	return NAMED + k;
}

static void print_cell(const struct tail_cell *cell)
{
	printf("| %s | %s %d |", cell->tail->name, pound_design_name(cell->design),
	       statistics_design(cell->design, sizes[cell->size], 0).rows);
	for (int total = 0; total < 2; total++) {
		double best = INFINITY;
		printf(" %.0f |", 1e3 * error_of(cell, BEST, total));
		for (int k = 0; k < RIVALS; k++) {
			const double error = error_of(cell, named(rivals[k]), total);
			best = fmin(best, isnan(error) ? INFINITY : error);
			printf(" %.0f |", 1e3 * error);
		}
		for (int k = 0; statistics_packages[k].name; k++)
			printf(" %.0f |", 1e3 * error_of(cell, PACKAGES + k, total));
		printf(" %.2f |", error_of(cell, BEST, total) / best);
	}
	double points = 0.0;
	for (int k = 0; k < 2 * cell->tail->n_inputs; k++)
		points += cell->points[k];
	printf(" %.2f %.2f | %.2f | %.2f %.2f | %.0f | %.0f |\n", least(cell, cell->holds, 0),
	       least(cell, cell->holds, 1), cell->noted / cell->n, least(cell, cell->covered, 0),
	       least(cell, cell->covered, 1), cell->noted > 0 ? cell->needed / cell->noted : 0.0, points);
}

/* Prints, for every function, design and number of rows: root mean square errors over the inputs in thousandths, of
 * S1 and of the other estimators, and the ratio to the best of plain, Martinez and Janon; the same for ST; the least
 * coverage of an interval; the fraction of results with a note that intervals may be too narrow; the least fraction
 * that is covered or noted; the rows that the notes ask for; intervals of zero width that do not contain the exact
 * value. */
void statistics_tails(int n_seeds)
{
	static struct campaign c;
	factors_fill();
	c.n_seeds = n_seeds;
	for (int size = SIZES - 1; size >= 0; size--)
		for (int design = 0; pound_design_name(design); design++)
			for (int k = 0; k < TAILS; k++)
				if (strcmp(pound_design_name(design), "random") != 0)
					c.cells[c.n_cells++] =
					    (struct tail_cell){.tail = &tails[k], .design = design, .size = size};
	statistics_jobs(c.n_cells, cell_run, &c);
	printf("| function | rows |");
	for (int total = 0; total < 2; total++) {
		printf(" %s | plain | Martinez | Janon |", total ? "ST" : "S1");
		for (int k = 0; statistics_packages[k].name; k++)
			printf(" %s |", statistics_packages[k].name);
		printf(" over best |");
	}
	printf(" hold S1 ST | noted | hold or noted | rows needed | points |\n| --- | --- |");
	for (int k = 0; k < 19; k++)
		printf(" --- |");
	printf("\n");
	for (int k = 0; k < c.n_cells; k++)
		print_cell(&c.cells[k]);
}
