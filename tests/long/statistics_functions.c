/* statistics_functions.c - functions of four uniform variables for `make statistics`, besides those in functions.c,
 * with indices in closed form.
 *
 * Variances of terms without common variables add up; in a product of independent factors g_j with mean m_j and mean
 * square q_j, a set u of factors explains prod_u (q_j - m_j^2) prod_others m_j^2, so the products below follow from
 * two integrals each.  The exact values of each function are derived above it. */
#include "tests/long/statistics.h"

#include <math.h>

/* The larger of two variables, plus a product.
 *
 *   V(max) = 1/18;  E(max | u1) = (1 + u1^2) / 2, with variance (1/5 - 1/9) / 4 = 1/45;  interaction 1/18 - 2/45 = 1/90
 *   V(u3 u4) = 1/9 - 1/16 = 7/144;  E(u3 u4 | u3) = u3 / 2, with variance 1/48;  interaction 1/144
 *   total V = 15/144:  S = (16/75, 16/75, 1/5, 1/5),  T = (8/25, 8/25, 4/15, 4/15)
 */
static double maximum(const double *u)
{
	return fmax(u[0], u[1]) + u[2] * u[3];
}

/* A product of exponentials: skewed, so a few rows dominate the variance.
 *
 *   factors exp(c u), c = 3, 2, 1, 1/2:  m = (e^c - 1) / c,  q = (e^2c - 1) / (2c),  r = q / m^2
 *   S_j = (r_j - 1) / (prod r - 1),  T_j = (r_j - 1) prod_others r / (prod r - 1)
 */
static double exponential(const double *u)
{
	return exp(3.0 * u[0] + 2.0 * u[1] + u[2] + 0.5 * u[3]);
}

/* Waves too short for a polynomial of low degree or for a wide smoothing window.
 *
 *   a sine over whole periods has the mean 0 and the mean square 1/2:
 *   sin(8 pi u1): 1/2;  2 sin(2 pi u2) sin(6 pi u3): 4 / 4 = 1, only interaction;  sqrt(6) u4: 6 / 12 = 1/2
 *   V = 2:  S = (1/4, 0, 0, 1/4),  T = (1/4, 1/2, 1/2, 1/4)
 */
static double waves(const double *u)
{
	return sin(8.0 * M_PI * u[0]) + 2.0 * sin(2.0 * M_PI * u[1]) * sin(6.0 * M_PI * u[2]) + sqrt(6.0) * u[3];
}

/* A rare corner: one sample in a hundred is larger by ten times the scale of the others.
 *
 *   10 [u1 > 0.9][u2 > 0.9], p = 1/10 each:  V = 100 (p^2 - p^4) = 0.99;  u1 alone: 100 p^2 (p - p^2) = 0.09, hence
 *   T_1 V = 0.9
 *   2 u3 + u4: 1/3 + 1/12;  V = 0.99 + 5/12 = 1.40666...
 */
static double corner(const double *u)
{
	return (u[0] > 0.9 && u[1] > 0.9 ? 10.0 : 0.0) + 2.0 * u[2] + u[3];
}

/* Nearly additive, with very unequal inputs; the last two have only a small interaction.
 *
 *   4 u1: 16/12;  |2 u2 - 1|, which is uniform: 1/12;  (u3 - 1/2)(u4 - 1/2): 1/144, only interaction
 */
static double unequal(const double *u)
{
	return 4.0 * u[0] + fabs(2.0 * u[1] - 1.0) + (u[2] - 0.5) * (u[3] - 0.5);
}

/* A window: the output jumps twice in one input's range, and once by less in another's.
 *
 *   [1/4 < u1 < 3/4]: 1/4;  u2: 1/12;  0.3 [u4 > 1/2]: 0.09 / 4;  no interaction, u3 without effect
 */
static double window(const double *u)
{
	return (u[0] > 0.25 && u[0] < 0.75 ? 1.0 : 0.0) + u[1] + (u[3] > 0.5 ? 0.3 : 0.0);
}

/* A jump at an edge of the range, in one sample in twenty.
 *
 *   2 [u1 > 0.95] (1 + u2): m = 1/10, 3/2 and q - m^2 = 0.2 - 0.01, 1/12:
 *   u1 alone 0.19 9/4 = 0.4275, u2 alone 0.01 / 12, interaction 0.19 / 12;  u3: 1/12, u4 without effect
 */
static double edge(const double *u)
{
	return (u[0] > 0.95 ? 2.0 * (1.0 + u[1]) : 0.0) + u[2];
}

/* Twelve waves in one input's range, 21 rows each at n = 250.
 *
 *   sin(24 pi u1): 1/2;  u2: 1/12;  2 (u3 - 1/2)(u4 - 1/2): 4 / 144, only interaction
 */
static double sine(const double *u)
{
	return sin(24.0 * M_PI * u[0]) + u[1] + 2.0 * (u[2] - 0.5) * (u[3] - 0.5);
}

#define CORNER  (0.99 + 5.0 / 12.0)
#define UNEQUAL (4.0 / 3.0 + 1.0 / 12.0 + 1.0 / 144.0)
#define WINDOW  (1.0 / 4.0 + 1.0 / 12.0 + 0.09 / 4.0)
#define EDGE    (0.4275 + 0.01 / 12.0 + 0.19 / 12.0 + 1.0 / 12.0)
#define SINE    (1.0 / 2.0 + 1.0 / 12.0 + 1.0 / 36.0)

const struct function statistics_functions[] = {
    {.name = "maximum",
     .y = maximum,
     .mean = 2.0 / 3.0 + 0.25,
     .variance = 15.0 / 144.0,
     .index = {16.0 / 75.0, 16.0 / 75.0, 0.2, 0.2, 0.32, 0.32, 4.0 / 15.0, 4.0 / 15.0}},
    {.name = "exponential",
     .y = exponential,
     .mean = 45.30773631851903,
     .variance = 2880.4088617135735,
     .index = {0.4683598016263815, 0.2230919422594297, 0.05842262391071275, 0.014785865834008547,
               0.6791912019164726, 0.40831136350983765, 0.12976187924255916, 0.03481068831534764}},
    {.name = "waves",
     .y = waves,
     .mean = 1.224744871391589,
     .variance = 2.0,
     .index = {0.25, 0.0, 0.0, 0.25, 0.25, 0.5, 0.5, 0.25}},
    {.name = "corner",
     .y = corner,
     .mean = 1.6,
     .variance = CORNER,
     .index = {0.09 / CORNER, 0.09 / CORNER, 1.0 / 3.0 / CORNER, 1.0 / 12.0 / CORNER, 0.9 / CORNER,
               0.9 / CORNER, 1.0 / 3.0 / CORNER, 1.0 / 12.0 / CORNER}},
    {.name = "unequal",
     .y = unequal,
     .mean = 2.5,
     .variance = UNEQUAL,
     .index = {4.0 / 3.0 / UNEQUAL, 1.0 / 12.0 / UNEQUAL, 0.0, 0.0, 4.0 / 3.0 / UNEQUAL, 1.0 / 12.0 / UNEQUAL,
               1.0 / 144.0 / UNEQUAL, 1.0 / 144.0 / UNEQUAL}},
    {.name = "window",
     .y = window,
     .mean = 1.15,
     .variance = WINDOW,
     .index = {0.25 / WINDOW, 1.0 / 12.0 / WINDOW, 0.0, 0.0225 / WINDOW, 0.25 / WINDOW, 1.0 / 12.0 / WINDOW,
               0.0, 0.0225 / WINDOW}},
    {.name = "edge",
     .y = edge,
     .mean = 0.65,
     .variance = EDGE,
     .index = {0.4275 / EDGE, 0.01 / 12.0 / EDGE, 1.0 / 12.0 / EDGE, 0.0, (0.4275 + 0.19 / 12.0) / EDGE,
               0.2 / 12.0 / EDGE, 1.0 / 12.0 / EDGE, 0.0}},
    {.name = "sine",
     .y = sine,
     .mean = 0.5,
     .variance = SINE,
     .index = {0.5 / SINE, 1.0 / 12.0 / SINE, 0.0, 0.0, 0.5 / SINE, 1.0 / 12.0 / SINE, 1.0 / 36.0 / SINE,
               1.0 / 36.0 / SINE}},
    {.name = NULL},
};
