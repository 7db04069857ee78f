/* design.c - designs by name.  A design fills columns of A and B with probabilities u in (0, 1), which the quantile function
 * of the input's distribution turns into values.
 *
 * A number depends on (seed, row, matrix, input) only; in a Latin hypercube also on its number of rows.  A growing design has
 * looks (interim analyses) until its intervals are narrow.  Between looks it adds batches of rows, each an independent Latin
 * hypercube, or doubles several interleaved scrambled Sobol' sequences. */
#include "engine/design/design.h"

#include "engine/design/sobol_sequence.h"
#include "engine/numeric/random.h"

#include <assert.h>

enum {
	BATCH = 100,        /* rows of a batch */
	BATCH_LEAST = 10,   /* ... if max_runs does not allow more */
	BATCHES_FIRST = 10, /* batches at the first look: fewer give poor intervals */
	BATCHES_NEXT = 2,   /* batches added before each further look */
	POINTS_FIRST = 16,  /* points of each Sobol' sequence at the first look */
	RANDOMISATIONS = 8, /* Sobol' sequences, if the study does not set their number */
};

struct design {
	const char *name;
	void (*column)(const struct pound_study *study, int matrix, int input, int rows, const atomic_bool *stop,
	               double *u);
	bool nets; /* interleaved Sobol' sequences; grows by doubling */
};

static struct pound_stream stream_of(const struct pound_study *study, int row, int matrix, int input)
{
	return (struct pound_stream){.seed = study->design.seed,
	                             .what = POUND_STREAM_DESIGN,
	                             .row = (uint32_t)row,
	                             .sample = (uint32_t)input,
	                             .signal = 2 * (uint32_t)matrix};
}

static int stride_of(const struct pound_study *study)
{
	return 2 * study->n_inputs;
}

static void random_column(const struct pound_study *study, int matrix, int input, int rows,
                          const atomic_bool *stop, double *u)
{
	struct pound_stream stream = stream_of(study, 0, matrix, input);
	for (int i = 0; i < rows && !pound_stopped(stop); i++)
		u[(size_t)i * stride_of(study)] = pound_random_uniform(stream, i);
}

/* Latin hypercube column: one point in each of n equal strata of u, uniform within it, in random order.
 *
 * The position within a stratum has 32 bits and is at least 2^-33 from the edges: with up to 2^20 strata, neither adding the
 * number of the stratum nor dividing by n can round a point into the next stratum.
 *
 * Source   McKay, Beckman, Conover 1979, Technometrics 21(2), 239-245; Fisher-Yates for the order
 * Test     unit_design: a_latin_hypercube_has_one_point_in_every_stratum_of_every_column
 */
static void latin_fill(struct pound_stream stream, int rows, int stride, const atomic_bool *stop, double *u)
{
	assert(rows <= POUND_ROWS_MAX);
	struct pound_stream order = stream;
	order.signal++;
	for (int i = 0; i < rows && !pound_stopped(stop); i++) {
		double place = ((double)pound_random_words(stream, i).v[0] + 0.5) * 0x1p-32;
		double point = (i + place) / rows;
		// inside-out shuffle: the new point goes to a random index up to i, and the point there moves to i
		int k = (int)pound_random_below(order, i, i + 1);
		u[(size_t)i * stride] = u[(size_t)k * stride];
		u[(size_t)k * stride] = point;
	}
}

static bool grows(const struct pound_study *study)
{
	return study->design.until.half_width > 0;
}

/* One Latin hypercube of all rows; in a growing design one per batch. */
static void latin_column(const struct pound_study *study, int matrix, int input, int rows,
                         const atomic_bool *stop, double *u)
{
	const int batch = grows(study) ? pound_design_grouping(study).run : rows;
	for (int first = 0; first < rows; first += batch)
		latin_fill(stream_of(study, first / batch, matrix, input), batch, stride_of(study), stop,
		           u + (size_t)first * stride_of(study));
}

/* n interleaved Sobol' sequences: row i is point i / n of sequence i % n.  Columns of A and B alternate in the dimensions of a
 * sequence, because the first dimensions are the most uniform.
 *
 * Test     unit_design: every_net_of_a_sobol_design_is_a_net_of_its_own
 */
static void net_column(const struct pound_study *study, int matrix, int input, int rows,
                       const atomic_bool *stop, double *u)
{
	const int n = pound_design_grouping(study).n;
	for (int k = 0; k < n; k++) {
		struct pound_sequence net;
		pound_sequence_init(&net, 2 * input + matrix);
		pound_sequence_scramble(&net, stream_of(study, k, matrix, input));
		for (int i = k; i < rows && !pound_stopped(stop); i += n)
			u[(size_t)i * stride_of(study)] = pound_sequence_point(&net, (uint32_t)(i / n));
	}
}

static const struct design designs[] = {
    {"lhs", latin_column, false},
    {"random", random_column, false},
    {"sobol", net_column, true},
};

static_assert(POUND_SEQUENCE_COLUMNS >= 2 * POUND_INPUTS_MAX, "every column of A and B has its own");

enum { DESIGNS = sizeof designs / sizeof designs[0] };

const char *pound_design_name(int row)
{
	return row >= 0 && row < DESIGNS ? designs[row].name : NULL;
}

/* The order of a study's design: the requested order, or the order that its estimator needs if that is higher. */
int pound_design_order(const struct pound_study *study)
{
	const int needed = pound_estimator_order(study->design.estimator);
	return study->design.order > needed ? study->design.order : needed;
}

/* Samples of a row: by the order of the design, plus one for each group of inputs. */
int pound_design_samples(const struct pound_study *study)
{
	return pound_order_samples(pound_design_order(study), study->n_inputs) + study->n_groups;
}

unsigned pound_design_mask(const struct pound_study *study, int sample)
{
	const int ungrouped = pound_design_samples(study) - study->n_groups;
	return sample < ungrouped ? pound_order_mask(study->n_inputs, sample)
	                          : study->groups[sample - ungrouped].inputs;
}

/* Whether a design is quasi-random: rows that are close in one input are related in the other inputs. */
bool pound_design_quasi_random(int row)
{
	return designs[row].nets;
}

/* Runs of one row of the design: samples x signals x cells; outputs computed elsewhere count one signal. */
int64_t pound_design_row_runs(const struct pound_study *study)
{
	int64_t runs =
	    (int64_t)pound_design_samples(study) * (study->elsewhere ? 1 : study->scene.excitation.signals);
	for (int s = 0; s < study->n_sweeps; s++)
		runs *= study->sweeps[s].n_values;
	return runs;
}

/* Rows that max_runs allows. */
static int rows_allowed(const struct pound_study *study)
{
	int64_t rows = study->design.until.max_runs / pound_design_row_runs(study);
	return rows < POUND_ROWS_MAX ? (int)rows : POUND_ROWS_MAX;
}

/* Rows of a batch: fewer than BATCH if max_runs does not allow BATCHES_FIRST batches of that size. */
static int batch_of(const struct pound_study *study)
{
	int most = rows_allowed(study) / BATCHES_FIRST;
	return most < BATCH_LEAST ? BATCH_LEAST : most < BATCH ? most : BATCH;
}

/* The independent groups of rows.
 *
 * Given    study     -         -       a sensitivity study
 * Returns  value     -         -       n = 0: a random design or a single Latin hypercube has no groups
 *
 * Test     unit_design: rows_of_a_group_are_a_design_of_their_own
 */
struct pound_grouping pound_design_grouping(const struct pound_study *study)
{
	const struct pound_design *design = &study->design;
	if (designs[design->method].nets)
		return (struct pound_grouping){design->randomisations ? design->randomisations : RANDOMISATIONS, 1};
	if (!grows(study) || designs[design->method].column != latin_column)
		return (struct pound_grouping){0, 1};
	int batch = batch_of(study);
	return (struct pound_grouping){(rows_allowed(study) + batch - 1) / batch, batch};
}

/* Rows at a look of a design that doubles its Sobol' sequences. */
static int net_rows(const struct pound_study *study, int allowed, int look)
{
	int rows = pound_design_rows_least(study);
	while (rows < study->design.rows && rows <= allowed / 2)
		rows *= 2;
	for (int k = 0; k < look && rows <= allowed / 2; k++)
		rows *= 2;
	return rows;
}

/* Rows at a look of a design that adds batches. */
static int batch_rows(const struct pound_study *study, int allowed, int look)
{
	const int batch = batch_of(study), most = allowed / batch;
	int first = (study->design.rows + batch - 1) / batch;
	first = first < BATCHES_FIRST ? BATCHES_FIRST : first;
	int64_t batches = first + (int64_t)BATCHES_NEXT * look;
	return (int)(batches < most ? batches : most) * batch;
}

/* Rows of the design at a look.
 *
 * Given    study     -         -       a sensitivity study
 *          look      -         -       0, 1, ...
 * Returns  value     -         rows    constant from the look on where max_runs allows no more; 0: max_runs does not
 *                                      allow the first look; a design that does not grow: all rows
 *
 * Latin hypercubes: BATCHES_FIRST batches, or enough for the rows of the study, then BATCHES_NEXT more at each look.  Sobol'
 * sequences: POINTS_FIRST points of each, doubled until the rows of the study are reached, then doubled at each look.
 *
 * Test     unit_growth: a_design_grows_by_whole_batches_and_by_doubling
 */
int pound_design_rows(const struct pound_study *study, int look)
{
	const struct pound_design *design = &study->design;
	if (!grows(study))
		return design->rows;
	const int allowed = rows_allowed(study);
	if (pound_design_rows_least(study) > allowed)
		return 0;
	return designs[design->method].nets ? net_rows(study, allowed, look) : batch_rows(study, allowed, look);
}

/* Fewest rows that a growing design has at its first look. */
int pound_design_rows_least(const struct pound_study *study)
{
	bool nets = designs[study->design.method].nets;
	return nets ? POINTS_FIRST * pound_design_grouping(study).n : BATCHES_FIRST * BATCH_LEAST;
}

/* Rows of the design at its last look, if it is not stopped before. */
int pound_design_rows_most(const struct pound_study *study)
{
	return pound_design_rows(study, POUND_ROWS_MAX);
}

/* The probabilities of a study's two matrices.
 *
 * Given    study         -                        inputs and design
 *          stop          -                        checked throughout: if set, u must not be used; NULL: never
 * Returns  u             (rows x 2 x n_inputs)    in (0, 1); row i of A, then row i of B
 *
 * Test     unit_design
 */
void pound_design_probabilities(const struct pound_study *study, const atomic_bool *stop, double *u)
{
	const int d = study->n_inputs, rows = pound_design_rows_most(study);
	for (int matrix = 0; matrix < 2; matrix++)
		for (int j = 0; j < d; j++)
			designs[study->design.method].column(study, matrix, j, rows, stop, u + matrix * d + j);
}

/* The input values of a study's two matrices.
 *
 * Given    study         -                        -            inputs and design
 *          u             (rows x 2 x n_inputs)    -            probabilities
 *          stop          -                        -            checked throughout: if set, x must not be used; NULL: never
 * Returns  x             (rows x 2 x n_inputs)    the inputs'  row i of A, then row i of B
 *
 * Test     unit_design: values_are_quantiles_of_the_inputs_distributions
 */
void pound_design_values(const struct pound_study *study, const double *u, const atomic_bool *stop, double *x)
{
	const int d = study->n_inputs;
	const size_t n = (size_t)pound_design_rows_most(study) * 2 * (size_t)d;
	for (size_t k = 0; k < n && !pound_stopped(stop); k++)
		x[k] = pound_distribution_quantile(&study->inputs[k % (size_t)d].distribution, u[k]);
}

double pound_design_input(const double *x, int n_inputs, int row, unsigned from_b, int j)
{
	return x[((size_t)row * 2 + (from_b >> j & 1)) * n_inputs + j];
}
