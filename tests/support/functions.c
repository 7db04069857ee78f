/* functions.c - the functions of functions.h, with their exact values by Gauss quadrature or closed form.
 *
 * Origin of the numbers: statistics_golden.json, public_truth (tensor Gauss quadrature), and the table of measured
 * errors over 1500 designs beside it. */
#include "tests/support/functions.h"

#include "engine/design/design.h"
#include "engine/numeric/random.h"

#include <gsl/gsl_cdf.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

static double ishigami(const double *u)
{
	double x[3];
	for (int j = 0; j < 3; j++)
		x[j] = M_PI * (2.0 * u[j] - 1.0);
	return sin(x[0]) + 7.0 * sin(x[1]) * sin(x[1]) + 0.1 * pow(x[2], 4) * sin(x[0]);
}

static double sobol_g(const double *u, const double *a)
{
	double y = 1.0;
	for (int j = 0; j < FUNCTION_INPUTS; j++)
		y *= (fabs(4.0 * u[j] - 2.0) + a[j]) / (1.0 + a[j]);
	return y;
}

static double g_a(const double *u)
{
	return sobol_g(u, (const double[]){0.0, 1.0, 4.5, 9.0});
}

static double g_b(const double *u)
{
	return sobol_g(u, (const double[]){0.0, 0.0, 1.0, 2.0});
}

/* Smooth except for a cusp at equal frequencies, like an amplification; inputs f_e, f_2, mass ratio, restitution; f_1 = 2. */
static double cusp(const double *u)
{
	double fe = 0.5 + 4.5 * u[0], f2 = 0.5 + 4.5 * u[1], f1 = 2.0;
	double r = u[2] < 0.5 ? 1.0 / (6.0 - 10.0 * u[2]) : 1.0 + 10.0 * (u[2] - 0.5);
	double q = fabs(f2 - f1) / (f2 + f1), s = (fe - 1.5) / 1.2;
	return 1.0 + 2.0 * q * r / (1.0 + r) * (1.0 + u[3]) * (0.5 + exp(-s * s)) * (f2 > f1 ? 1.0 : 0.45);
}

static double steps(const double *u)
{
	return 2.0 * (u[0] + 0.5 * u[1] > 0.8) * (0.5 + u[2]) + 0.5 * (u[3] > 0.7) + 0.4 * u[1];
}

static double interactions(const double *u)
{
	return 2.0 * sin(2.0 * M_PI * u[0]) * sin(2.0 * M_PI * u[1]) +
	       6.0 * (u[2] - 0.5) * (u[3] - 0.5) * (1.0 + u[0]) + 0.6 * u[0] + 0.3 * u[2];
}

const struct function functions[] = {
    {"ishigami",
     ishigami,
     3.5,
     13.84458794071927,
     {0.3139051911478112, 0.4424111447900407, 0.0, 0.0, 0.5575888552099593, 0.44241114479004084,
      0.24368366406214825, 0.0},
     {0.0306, 0.0247, 0.0292, 0.0, 0.0379, 0.0187, 0.0121, 0.0},
     {0.0, 0.24368366406214792, 0.0, 0.0, 0.0, 0.0},
     {0.43574702317888525, 0.4424111447900407, 0.12184183203107404, 0.0}},
    {"g_a",
     g_a,
     1.0,
     0.4652290582593609,
     {0.7164929348576992, 0.17912323371442485, 0.023685716854799976, 0.007164929348576971, 0.7873697011432745,
      0.24226760035177675, 0.03432674446401218, 0.010463384732801173},
     {0.0318, 0.0206, 0.0, 0.0, 0.0339, 0.0123, 0.0, 0.0},
     {0.059707744571474895, 0.00789523895159992, 0.0023883097828592535, 0.0019738097378999204,
      0.0005970774457146941, 7.895238951602321e-05},
     {0.7517835564103857, 0.21055094512589612, 0.028890543477545758, 0.008774954986172442}},
    {"g_b",
     g_b,
     1.0,
     0.9972565157750335,
     {0.33425034387895447, 0.33425034387895447, 0.08356258596973863, 0.03713892709766163, 0.5006877579092159,
      0.5006877579092159, 0.15405777166437407, 0.07152682255845966},
     {0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0},
     {0.11141678129298489, 0.02785419532324625, 0.012379642365887329, 0.02785419532324625,
      0.012379642365887329, 0.00309491059147179},
     {0.4149759284731774, 0.4149759284731774, 0.11683287482806051, 0.05321526822558472}},
    {"cusp",
     cusp,
     1.2848172813370233,
     0.09297016535585015,
     {0.1506739368982181, 0.32711982106047227, 0.24737062380942546, 0.03231657343363735, 0.2757410036989042,
      0.510597726174971, 0.4136134921067156, 0.06687669581100752},
     {0.0223, 0.0291, 0.0259, 0.0118, 0.0206, 0.0377, 0.0301, 0.0062},
     {0.05648796455596928, 0.042716650384055546, 0.005580516181415402, 0.09273974860943708,
      0.012115548928165437, 0.009161874955904826},
     {0.20977772003451578, 0.4151202387967295, 0.3268385312492507, 0.04826350991950398}},
    {"steps",
     steps,
     1.25,
     1.2725,
     {0.516044531761624, 0.12835625409299298, 0.05304518664047152, 0.0412573673870334, 0.7718838681510585,
      0.3466492032307359, 0.11787819253438103, 0.04125736738703334},
     {0.0343, 0.0259, 0.0153, 0.0089, 0.0320, 0.0239, 0.0066, 0.0015},
     {0.19646365422396858, 0.043003710980135175, 0.0, 0.00545732372844364, 0.0, 0.0},
     {0.6412355380921195, 0.23477406679764268, 0.0827330277232045, 0.041257367387033395}},
    {"interactions",
     interactions,
     0.45,
     1.620833333333334,
     {0.018508997429305892, 0.0, 0.004627249357326473, 0.0, 0.6483290488431881, 0.6169665809768642,
      0.36452442159383014, 0.35989717223650375},
     {0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0},
     {0.6169665809768636, 0.0, 0.0, 0.0, 0.0, 0.34704370179948546},
     {0.3312767780634106, 0.30848329048843204, 0.18243359040274196, 0.1778063410454155}},
    {.name = NULL},
};

const struct function *function_named(const char *name)
{
	const struct function *f = functions;
	while (strcmp(f->name, name))
		f++;
	return f;
}

struct pound_study function_study(const struct pound_design *design)
{
	static struct pound_input inputs[FUNCTION_INPUTS];
	for (int j = 0; j < FUNCTION_INPUTS; j++)
		inputs[j].distribution = (struct pound_distribution){.type = 0, .p = {0.0, 1.0}};
	return (struct pound_study){.kind = POUND_KIND_SENSITIVITY,
	                            .scene.excitation.signals = 1,
	                            .n_inputs = FUNCTION_INPUTS,
	                            .inputs = inputs,
	                            .design = *design};
}

double *function_design_of(const struct pound_design *design)
{
	const struct pound_study study = function_study(design);
	double *x = malloc(sizeof *x * 2 * FUNCTION_INPUTS * (size_t)pound_design_rows_most(&study));
	pound_design_probabilities(&study, NULL, x);
	pound_design_values(&study, x, NULL, x);
	return x;
}

double *function_design(int n_rows, uint64_t seed)
{
	return function_design_of(&(struct pound_design){.rows = n_rows, .seed = seed});
}

struct pound_sample_values function_values_of(const struct function *f, const struct pound_design *design,
                                              struct function_noise noise)
{
	enum { D = FUNCTION_INPUTS };
	const struct pound_study study = function_study(design);
	const int n_rows = pound_design_rows_most(&study), n_samples = pound_design_samples(&study);
	double *x = function_design_of(design);
	size_t n = (size_t)n_rows * n_samples * noise.n_signals;
	double *numerator = malloc(2 * sizeof *numerator * n), *denominator = numerator + n;
	double deviation = sqrt(noise.share * f->variance);
	for (int i = 0; i < n_rows; i++)
		for (int p = 0; p < n_samples; p++) {
			double u[D];
			for (int j = 0; j < D; j++)
				u[j] = pound_design_input(x, D, i, pound_order_mask(D, p), j);
			double y = f->y(u);
			for (int r = 0; r < noise.n_signals; r++) {
				size_t k = ((size_t)i * n_samples + p) * noise.n_signals + r;
				struct pound_stream stream = {.seed = design->seed,
				                              .what = POUND_STREAM_NOISE,
				                              .row = i,
				                              .sample = noise.common ? 0 : p,
				                              .signal = r};
				numerator[k] = y;
				if (deviation > 0.0)
					numerator[k] += deviation * gsl_cdf_ugaussian_Pinv(pound_random_uniform(stream, 0));
				denominator[k] = 1.0;
			}
		}
	free(x);
	return (struct pound_sample_values){.n_rows = n_rows,
	                                    .n_inputs = D,
	                                    .n_signals = noise.n_signals,
	                                    .numerator = numerator,
	                                    .denominator = denominator,
	                                    .grouping = pound_design_grouping(&study),
	                                    .order = design->order};
}

struct pound_sample_values function_values(const struct function *f, int n_rows, uint64_t seed,
                                           struct function_noise noise)
{
	return function_values_of(f, &(struct pound_design){.rows = n_rows, .seed = seed}, noise);
}

void function_values_free(struct pound_sample_values *values)
{
	free((double *)values->numerator);
}
