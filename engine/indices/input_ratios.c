/* input_ratios.c - indices of ratios of inputs, which are dependent if they share an input.
 *
 * 1. The output is modeled as a function of the ratios and of the inputs in no ratio, by a polynomial of these variables;
 *    a ratio is replaced by its probability.
 * 2. The closed variance of a set of variables, Var E[g | X_u], follows from the coefficients and from the means E[p(X) q(X')]
 *    of products of terms, where X' shares X_u and is redrawn given X_u.  These means depend on the inputs' distributions only.
 * 3. A jackknife over eight groups of rows removes the bias, mainly from fitting noise, and gives the interval.
 * 4. The variance explained by all variables is the cross-validated R2 of the fits without one group each.
 *
 * With dependent variables Shapley effects add up to 1 and first-order indices do not; one may exceed its total. */
#include "engine/design/design.h"
#include "engine/design/sobol_sequence.h"
#include "engine/indices/indices.h"
#include "engine/indices/legendre.h"
#include "engine/numeric/elementary.h"

#include <assert.h>
#include <math.h>
#include <string.h>

enum {
	GROUPS = 8,
	CHUNK = POUND_LEGENDRE_CHUNK,
	POINTS = 4096, // of a Sobol' sequence: means of products to 1e-4
	PLACES = 16,   // values of the denominator to integrate a ratio's probability over
	VARIABLES = POUND_FACTORIAL_INPUTS_MAX,
	SETS = 1 << VARIABLES,
};

/* ---- distributions ---- */

/* A density proportional to a power of x between two positive ends. */
struct power_law {
	double exponent, low, high;
};

static bool power_law_of(const struct pound_distribution *distribution, struct power_law *law)
{
	const char *name = pound_distribution_name(distribution->type);
	*law =
	    (struct power_law){strcmp(name, "uniform") == 0 ? 0.0 : -1.0, distribution->p[0], distribution->p[1]};
	return strcmp(name, "uniform") == 0 || strcmp(name, "log_uniform") == 0;
}

bool pound_ratio_takes(const struct pound_distribution *distribution)
{
	struct power_law law;
	return power_law_of(distribution, &law) && law.low > 0.0;
}

/* Root of integer order 1 to 4, of x > 0. */
static double root(double x, int order)
{
	return order == 1   ? x
	       : order == 2 ? sqrt(x)
	       : order == 3 ? pound_elementary_exp(pound_elementary_log(x) / 3.0)
	                    : sqrt(sqrt(x));
}

static double power(double x, int n)
{
	double y = 1.0;
	for (int k = 0; k < n; k++)
		y *= x;
	return y;
}

/* Quantile x of a power law at probability t.
 *
 *   x^c = low^c + t (high^c - low^c),  c = exponent + 1;  x = low (high / low)^t for c = 0
 */
static double power_law_quantile(const struct power_law *law, double t)
{
	const int c = (int)law->exponent + 1;
	if (c == 0)
		return law->low * pound_elementary_exp(t * pound_elementary_log(law->high / law->low));
	const double low = power(law->low, c), high = power(law->high, c);
	return root(low + t * (high - low), c);
}

static double power_law_probability(const struct power_law *law, double x)
{
	const double inside = fmin(fmax(x, law->low), law->high);
	return law->exponent == 0.0
	           ? (inside - law->low) / (law->high - law->low)
	           : pound_elementary_log(inside / law->low) / pound_elementary_log(law->high / law->low);
}

/* ---- the variables ---- */

/* First the inputs in no ratio, then the ratios. */
struct variables {
	int n, n_rest, n_ratios;
	int rest[VARIABLES];
	int above[POUND_RATIOS_MAX], below[POUND_RATIOS_MAX];
	int leader[POUND_RATIOS_MAX]; /* the first ratio with the same denominator */
	struct power_law upper[POUND_RATIOS_MAX], lower[POUND_RATIOS_MAX];
	double place[POUND_RATIOS_MAX][PLACES]; /* values of the denominator */
};

/* Whether a member of a ratio refers to an input: by its path, or without a scene by its name. */
static bool is_called(const struct pound_input *input, const char *of)
{
	const char *own = input->path ? input->path : input->name;
	return own && strcmp(own, of) == 0;
}

int pound_study_input(const struct pound_study *study, const char *of)
{
	for (int j = 0; j < study->n_inputs; j++)
		if (is_called(&study->inputs[j], of))
			return j;
	return -1;
}

static bool in_ratio(const struct pound_study *study, int input)
{
	for (int k = 0; k < study->n_ratios; k++)
		for (int side = 0; side < 2; side++)
			if (is_called(&study->inputs[input], study->ratios[k].of[side]))
				return true;
	return false;
}

/* The variables of the indices: ratios and the inputs in no ratio.
 *
 * Returns  rest     (n)    indices of the inputs in no ratio; NULL: not requested
 *          value    -      number of variables
 */
int pound_ratio_variables(const struct pound_study *study, int *rest)
{
	int n = 0;
	for (int j = 0; j < study->n_inputs; j++)
		if (!in_ratio(study, j)) {
			if (rest)
				rest[n] = j;
			n++;
		}
	return n + study->n_ratios;
}

static struct variables variables_of(const struct pound_study *study)
{
	struct variables v = {.n_ratios = study->n_ratios};
	v.n = pound_ratio_variables(study, v.rest);
	v.n_rest = v.n - v.n_ratios;
	for (int k = 0; k < v.n_ratios; k++) {
		v.above[k] = pound_study_input(study, study->ratios[k].of[0]);
		v.below[k] = pound_study_input(study, study->ratios[k].of[1]);
		power_law_of(&study->inputs[v.above[k]].distribution, &v.upper[k]);
		power_law_of(&study->inputs[v.below[k]].distribution, &v.lower[k]);
		v.leader[k] = k;
		for (int l = k - 1; l >= 0; l--)
			if (v.below[l] == v.below[k])
				v.leader[k] = l;
		for (int i = 0; i < PLACES; i++)
			v.place[k][i] = power_law_quantile(&v.lower[k], (i + 0.5) / PLACES);
	}
	return v;
}

/* The probability of a smaller ratio, in [0, 1], by a quadrature rule of PLACES points. */
static double ratio_place(const struct variables *v, int k, double ratio)
{
	double sum = 0.0;
	for (int i = 0; i < PLACES; i++)
		sum += power_law_probability(&v->upper[k], ratio * v->place[k][i]);
	return sum / PLACES;
}

/* ---- means of products of terms ---- */

/* Ratios from four uniform numbers each: numerator and denominator, here and in ratios_redraw. */
static void ratios_draw(const struct variables *v, const double *t, double *ratio)
{
	double below[POUND_RATIOS_MAX];
	for (int k = 0; k < v->n_ratios; k++) {
		below[k] = v->leader[k] == k ? power_law_quantile(&v->lower[k], t[4 * k + 1]) : below[v->leader[k]];
		ratio[k] = power_law_quantile(&v->upper[k], t[4 * k]) / below[k];
	}
}

/* Ratios redrawn given some of them.
 *
 * Given ratios a_k with the same denominator x, the density of x is proportional to its own times the product over k of the
 * numerator's density at a_k x times x: again a power law, on the x for which all given ratios are possible.
 */
static void ratios_redraw(const struct variables *v, unsigned given, const double *t, const double *ratio,
                          double *anew)
{
	double below[POUND_RATIOS_MAX];
	for (int k = 0; k < v->n_ratios; k++) {
		struct power_law law = v->lower[k];
		for (int l = 0; l < v->n_ratios; l++)
			if (v->leader[l] == v->leader[k] && given >> l & 1) {
				law.exponent += v->upper[l].exponent + 1.0;
				law.low = fmax(law.low, v->upper[l].low / ratio[l]);
				law.high = fmin(law.high, v->upper[l].high / ratio[l]);
			}
		below[k] = v->leader[k] == k ? power_law_quantile(&law, t[4 * k + 3]) : below[v->leader[k]];
		anew[k] = given >> k & 1 ? ratio[k] : power_law_quantile(&v->upper[k], t[4 * k + 2]) / below[k];
	}
}

/* The fit, and the layout of the scratch memory. */
struct fit {
	const struct pound_rows *rows;
	const double *u; /* (n x 2 x n_inputs) */
	const struct pound_study *study;
	struct variables variables;
	int degree, terms, squares;
	int block; /* number of terms in the ratios alone */
	struct pound_legendre chunk, ratios;
	double *sums; /* of terms up to twice the degree, of each group and of all  ((GROUPS + 1) x squares) */
	double *products;      /* sums of term times output, likewise  ((GROUPS + 1) x terms) */
	double square[GROUPS]; /* sum of squared outputs, of each group */
	double *gram;          /* (terms x terms) */
	double *means; /* of products of terms in the ratios, for each set of them  (2^ratios x block x block) */
	double *point, *anew;          /* terms at a point  (block) each */
	double *coefficients, *others; /* (terms), (squares) */
};

static size_t carve(struct fit *f, double *scratch, const struct pound_sample_values *shape,
                    const struct pound_study *study)
{
	const int n_samples = pound_values_samples(shape), n = f->variables.n;
	f->degree = pound_chaos_expansion_degree(shape->n_rows, n, n_samples);
	f->terms = pound_legendre_terms(n, f->degree);
	f->squares = pound_legendre_terms(n, 2 * f->degree);
	f->block = pound_legendre_terms(study->n_ratios, f->degree);
	pound_legendre_init(&f->chunk, n, 2 * f->degree);
	pound_legendre_init(&f->ratios, study->n_ratios, f->degree);
	const size_t columns = (size_t)(2 * f->degree + 1) * CHUNK;
	const struct {
		double **at;
		size_t n;
	} parts[] = {
	    {&f->chunk.column, (size_t)n * columns},
	    {&f->chunk.product, (size_t)n * CHUNK},
	    {&f->ratios.column, (size_t)study->n_ratios * columns},
	    {&f->ratios.product, (size_t)study->n_ratios * CHUNK},
	    {&f->sums, (size_t)(GROUPS + 1) * f->squares},
	    {&f->products, (size_t)(GROUPS + 1) * f->terms},
	    {&f->gram, (size_t)f->terms * f->terms},
	    {&f->means, ((size_t)f->block * f->block) << study->n_ratios},
	    {&f->point, f->block},
	    {&f->anew, f->block},
	    {&f->coefficients, f->terms},
	    {&f->others, f->squares},
	};
	size_t total = 0;
	for (size_t k = 0; k < sizeof parts / sizeof parts[0]; k++) {
		if (scratch)
			*parts[k].at = scratch + total;
		total += parts[k].n;
	}
	return total;
}

/* Terms in the ratios at one point, by projecting 1. */
static void terms_at(struct fit *f, const double *ratio, double *terms)
{
	const double one[CHUNK] = {1.0};
	memset(terms, 0, sizeof *terms * (size_t)f->block);
	f->ratios.n = 1;
	for (int k = 0; k < f->variables.n_ratios; k++)
		pound_legendre_point(&f->ratios, 0, k, ratio_place(&f->variables, k, ratio[k]));
	pound_legendre_project(&f->ratios, f->degree, one, terms);
}

/* E[p(X) q(X')] for X' that shares the ratios in `given`, by a Sobol' sequence; the product of the means if none is given. */
static void means_fill(struct fit *f, unsigned given)
{
	const int n = f->block, n_columns = 4 * f->variables.n_ratios;
	double *mean = f->means + (size_t)given * n * n;
	struct pound_sequence net[4 * POUND_RATIOS_MAX];
	for (int c = 0; c < n_columns; c++) {
		pound_sequence_init(&net[c], c);
		// the same for every study: the points are a quadrature rule, not a sample
		pound_sequence_scramble(&net[c],
		                        (struct pound_stream){.what = POUND_STREAM_DESIGN, .sample = (uint32_t)c});
	}
	memset(mean, 0, sizeof *mean * (size_t)n * n);
	for (uint32_t i = 0; i < POINTS && !pound_stopped(f->rows->stop); i++) {
		double t[4 * POUND_RATIOS_MAX], ratio[POUND_RATIOS_MAX], anew[POUND_RATIOS_MAX];
		for (int c = 0; c < n_columns; c++)
			t[c] = pound_sequence_point(&net[c], i);
		ratios_draw(&f->variables, t, ratio);
		ratios_redraw(&f->variables, given, t, ratio, anew);
		terms_at(f, ratio, f->point);
		terms_at(f, anew, f->anew);
		for (int p = 0; p < n; p++)
			for (int q = 0; q < (given ? n : 1); q++)
				mean[p * n + q] += f->point[p] * f->anew[q] / POINTS;
	}
	// term 0 is 1: the first column holds the means themselves and is replaced last
	for (int p = 0; p < n && !given; p++)
		for (int q = n - 1; q >= 0; q--)
			mean[p * n + q] = mean[p * n] * mean[q * n];
}

/* ---- the fit ---- */

static int group_of(const struct fit *f, int row)
{
	const struct pound_grouping *grouping = &f->rows->scatter.grouping;
	const int64_t number = f->rows->row[row];
	return (int)((grouping->n ? number / grouping->run % grouping->n : row) % GROUPS);
}

static void sample_enter(struct fit *f, int point, int row, int sample)
{
	const struct variables *v = &f->variables;
	const int d = f->rows->n_inputs;
	const unsigned from_b = pound_rows_mask(f->rows, sample);
	const double *a = f->u + (size_t)f->rows->row[row] * 2 * d;
	for (int j = 0; j < v->n_rest; j++) {
		const int input = v->rest[j];
		pound_legendre_point(&f->chunk, point, j, a[(from_b >> input & 1 ? d : 0) + input]);
	}
	for (int k = 0; k < v->n_ratios; k++) {
		const int up = v->above[k], down = v->below[k];
		const double ratio = power_law_quantile(&v->upper[k], a[(from_b >> up & 1 ? d : 0) + up]) /
		                     power_law_quantile(&v->lower[k], a[(from_b >> down & 1 ? d : 0) + down]);
		pound_legendre_point(&f->chunk, point, v->n_rest + k, ratio_place(v, k, ratio));
	}
}

/* Adds the rows of one group, in chunks of samples. */
static void group_fill(struct fit *f, int group)
{
	const int n_samples = f->rows->n_samples;
	double value[CHUNK], one[CHUNK];
	f->chunk.n = 0;
	for (int k = 0; k < CHUNK; k++)
		one[k] = 1.0;
	for (int row = 0; row <= f->rows->n_rows && !pound_stopped(f->rows->stop); row++) {
		const bool last = row == f->rows->n_rows;
		if (last || f->chunk.n + n_samples > CHUNK) {
			pound_legendre_project(&f->chunk, 2 * f->degree, one, f->sums + (size_t)group * f->squares);
			pound_legendre_project(&f->chunk, f->degree, value, f->products + (size_t)group * f->terms);
			f->chunk.n = 0;
		}
		for (int p = 0; p < n_samples && !last && group_of(f, row) == group; p++) {
			sample_enter(f, f->chunk.n, row, p);
			const double y = f->rows->y[(size_t)row * n_samples + p];
			f->square[group] += y * y;
			value[f->chunk.n++] = y;
		}
	}
}

static void sums_fill(struct fit *f)
{
	memset(f->sums, 0, sizeof *f->sums * (GROUPS + 1) * (size_t)f->squares);
	memset(f->products, 0, sizeof *f->products * (GROUPS + 1) * (size_t)f->terms);
	for (int g = 0; g < GROUPS; g++) {
		group_fill(f, g);
		for (int k = 0; k < f->squares; k++)
			f->sums[(size_t)GROUPS * f->squares + k] += f->sums[(size_t)g * f->squares + k];
		for (int k = 0; k < f->terms; k++)
			f->products[(size_t)GROUPS * f->terms + k] += f->products[(size_t)g * f->terms + k];
	}
}

/* Least squares over all groups but one; without == GROUPS: over all. */
static void coefficients_fill(struct fit *f, int without)
{
	for (int k = 0; k < f->squares; k++)
		f->others[k] = f->sums[(size_t)GROUPS * f->squares + k] -
		               (without < GROUPS ? f->sums[(size_t)without * f->squares + k] : 0.0);
	for (int k = 0; k < f->terms; k++)
		f->coefficients[k] = f->products[(size_t)GROUPS * f->terms + k] -
		                     (without < GROUPS ? f->products[(size_t)without * f->terms + k] : 0.0);
	pound_legendre_gram(f->variables.n, f->degree, f->others, f->gram);
	pound_legendre_factor(f->gram, f->terms);
	pound_legendre_solve(f->gram, f->terms, f->coefficients);
}

/* ---- indices ---- */

/* Adds the variance explained by each set of ratios in one part of the polynomial, whose terms have the same factor in the
 * inputs in no ratio.  The other factors are the terms in the ratios up to the remaining degree, in the order of all terms. */
static int part_add(const struct fit *f, const double *coefficients, int degree_left, bool is_mean,
                    double *explained)
{
	const int n = f->block, n_ratios = f->variables.n_ratios;
	int degrees[POUND_INPUTS_MAX] = {0}, place[512], used = 0;
	for (int term = 0; term < n; term++, pound_legendre_next(n_ratios, f->degree, degrees)) {
		int total = 0;
		for (int k = 0; k < n_ratios; k++)
			total += degrees[k];
		if (total <= degree_left)
			place[used++] = term;
	}
	for (unsigned set = 0; set < 1u << n_ratios; set++) {
		const double *mean = f->means + (size_t)set * n * n;
		double sum = 0.0, about = 0.0;
		for (int p = 0; p < used; p++) {
			for (int q = 0; q < used; q++)
				sum += coefficients[p] * coefficients[q] * mean[place[p] * n + place[q]];
			about += coefficients[p] * f->means[place[p] * n];
		}
		explained[set << f->variables.n_rest] += sum - (is_mean ? about * about : 0.0);
	}
	return used;
}

/* Closed variance of each set of variables, bit v for variable v. */
static void explained_fill(const struct fit *f, double explained[SETS])
{
	const struct variables *v = &f->variables;
	double of[SETS] = {0.0};
	int degrees[POUND_INPUTS_MAX] = {0}, term = 0;
	bool more = true;
	while (more) {
		int total = 0;
		unsigned support = 0;
		for (int j = 0; j < v->n_rest; j++) {
			total += degrees[j];
			support |= (unsigned)(degrees[j] > 0) << j;
		}
		term += part_add(f, f->coefficients + term, f->degree - total, support == 0, of + support);
		more = v->n_rest > 0 && pound_legendre_next(v->n_rest, f->degree, degrees);
	}
	assert(term == f->terms);
	const unsigned rest = (1u << v->n_rest) - 1;
	for (unsigned set = 0; set < 1u << v->n; set++) {
		explained[set] = 0.0;
		for (unsigned support = 0; support <= rest; support++)
			if ((support & ~set) == 0)
				explained[set] += of[support | (set & ~rest)];
	}
}

/* The part of a group's sum of squares explained by the fit without the group: sum y^2 - (y - g)^2, from the sums of terms. */
static double predicted(struct fit *f, int group)
{
	const double *c = f->coefficients, *products = f->products + (size_t)group * f->terms;
	double sum = 0.0;
	pound_legendre_gram(f->variables.n, f->degree, f->sums + (size_t)group * f->squares, f->gram);
	for (int p = 0; p < f->terms; p++) {
		const double *row = f->gram + (size_t)p * f->terms;
		double fitted = 0.5 * c[p] * row[p];
		for (int q = p + 1; q < f->terms; q++)
			fitted += c[q] * row[q];
		sum += 2.0 * c[p] * (products[p] - fitted);
	}
	return sum;
}

enum { FIRST, TOTAL, SHAPLEY, KINDS };

/* The indices of every variable from the closed variances. */
static void values_fill(const struct fit *f, const double explained[SETS], double *value)
{
	const int n = f->variables.n;
	const unsigned all = (1u << n) - 1;
	for (int v = 0; v < n; v++) {
		double shapley = 0.0;
		for (unsigned set = 0; set <= all; set++) {
			if (set >> v & 1)
				continue;
			double orders = n; // n binom(n - 1, |set|)
			for (int k = 0; k < __builtin_popcount(set); k++)
				orders *= (n - 1.0 - k) / (k + 1.0);
			shapley += (explained[set | 1u << v] - explained[set]) / orders;
		}
		value[FIRST * n + v] = explained[1u << v] / explained[all];
		value[TOTAL * n + v] = 1.0 - explained[all ^ 1u << v] / explained[all];
		value[SHAPLEY * n + v] = shapley / explained[all];
	}
}

/* Jackknife: the bias-corrected value of all rows, with the interval from the pseudo-values. */
static struct pound_estimate jackknife(const double value[GROUPS + 1][KINDS * VARIABLES], int k)
{
	double mean = 0.0, squares = 0.0;
	for (int g = 0; g < GROUPS; g++)
		mean += value[g][k] / GROUPS;
	for (int g = 0; g < GROUPS; g++)
		squares += (value[g][k] - mean) * (value[g][k] - mean);
	const double middle = GROUPS * value[GROUPS][k] - (GROUPS - 1) * mean;
	const double half = pound_jackknife_student(GROUPS - 1) * sqrt(squares * (GROUPS - 1.0) / GROUPS);
	return (struct pound_estimate){middle, middle - half, middle + half};
}

/* Cross-validated R2: the fraction of the outputs' squares, less their noise, that is predicted by fits without these outputs;
 * NAN if the interval is too wide.  It is biased low, by the squared error of the fits, and stays below 1. */
static struct pound_estimate explained_of(const struct fit *f, const double of_group[GROUPS], double noise)
{
	const double widest = 0.25; // half width that still distinguishes 0.5 from 1
	double share[GROUPS + 1][KINDS * VARIABLES] = {{0.0}}, above = 0.0, below = 0.0;
	for (int g = 0; g < GROUPS; g++) {
		above += of_group[g];
		below += f->square[g] * (1.0 - noise);
	}
	for (int g = 0; g < GROUPS; g++)
		share[g][0] = (above - of_group[g]) / (below - f->square[g] * (1.0 - noise));
	share[GROUPS][0] = above / below;
	const struct pound_estimate e = jackknife(share, 0);
	return e.high - e.low <= 2.0 * widest && e.high > 0.0 ? e : (struct pound_estimate){NAN, NAN, NAN};
}

size_t pound_ratio_scratch(const struct pound_sample_values *shape, const struct pound_study *study)
{
	struct fit fit = {.variables.n = pound_ratio_variables(study, NULL)};
	return study->n_ratios ? carve(&fit, NULL, shape, study) : 0;
}

/* Indices of ratios of inputs and of the inputs in no ratio, with the output as a function of these variables.
 *
 * Given    rows       -                          outputs
 *          u          (n x 2 x n_inputs)         the design as probabilities in (0, 1), rows of A and B
 *          study      -                          inputs and ratios
 *          noise      -                          fraction of the outputs' variance that is noise
 * Returns  results    -                          ratios first, in the order of the study, then the inputs
 * Memory   scratch    (pound_ratio_scratch)
 *
 * Valid    Any design of POUND_ROWS_MIN rows or more; ratios of uniform or log-uniform inputs above 0.  Missing are the
 *          part of the output that no polynomial of the degree fits, and its dependence on inputs other than through ratios.
 * Source   Song, Nelson, Staum 2016, SIAM/ASA J. Uncertain. Quantif. 4, 1060-1083, for Shapley effects of dependent inputs
 * Test     unit_input_ratios
 */
void pound_ratio_indices(const struct pound_rows *rows, const double *u, const struct pound_study *study,
                         double noise, double *scratch, struct pound_ratio_indices *results)
{
	struct fit f = {.rows = rows, .u = u, .study = study, .variables = variables_of(study)};
	const struct pound_sample_values shape = {
	    .n_rows = rows->n_rows, .n_inputs = rows->n_inputs, .order = rows->order};
	const int n = f.variables.n;
	double explained[SETS], value[GROUPS + 1][KINDS * VARIABLES], of_group[GROUPS];
	carve(&f, scratch, &shape, study);
	for (unsigned set = 0; set < 1u << study->n_ratios; set++)
		means_fill(&f, set);
	sums_fill(&f);
	for (int g = 0; g <= GROUPS && !pound_stopped(rows->stop); g++) {
		coefficients_fill(&f, g);
		explained_fill(&f, explained);
		values_fill(&f, explained, value[g]);
		if (g < GROUPS)
			of_group[g] = predicted(&f, g);
	}
	results->n = n;
	for (int k = 0; k < n; k++) {
		const int v = k < study->n_ratios ? f.variables.n_rest + k : k - study->n_ratios;
		results->first[k] = jackknife(value, FIRST * n + v);
		results->total[k] = jackknife(value, TOTAL * n + v);
		results->shapley[k] = jackknife(value, SHAPLEY * n + v);
	}
	results->explained = explained_of(&f, of_group, noise);
}
