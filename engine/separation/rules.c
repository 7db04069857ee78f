/* rules.c - rules of codes and papers for the gap of two buildings, from the largest displacement of each without the other.
 *
 * To add a rule, add a row to rules[]. */
#include <assert.h>
#include <math.h>

#include "engine/separation/separation.h"

static const struct {
	const char *name, *text; /* the source, in a line */
	bool summed;             /* absolute sum; else the root of the sum of squares */
	bool correlated;         /* ... less the correlation term */
} rules[] = {
    {"absolute_sum", "sum of both displacements, the most that a run may need: IS 1893 part 1 (2016), 7.11.3",
     .summed = true},
    {"srss",
     "root of the sum of squares: Eurocode 8 part 1 (2004), 4.4.2.7 (2); ASCE 7-16, 12.12.3, Eq. (12.12-2)",
     .summed = false},
    {"double_difference", "double difference combination by the CQC coefficient: Jeng, Kasai and Maison 1992",
     .summed = false, .correlated = true},
};

static_assert(sizeof rules / sizeof rules[0] == POUND_RULES, "a row for each rule");

const char *pound_rule_name(int row)
{
	return row >= 0 && row < POUND_RULES ? rules[row].name : NULL;
}

const char *pound_rule_text(int row)
{
	return rules[row].text;
}

/* Correlation of the displacements of two linear oscillators under the same stationary white noise.
 *
 * Given    frequency   w     any unit   of both oscillators; 0: a wall, which does not move
 *          damping     xi    -          damping ratios, at least one > 0
 * Returns  value       rho   -          1: equal oscillators; 0: one is a wall
 *
 *   rho = 8 (xi_1 xi_2)^1/2 (r xi_1 + xi_2) r^3/2 / ((1 - r^2)^2 + 4 xi_1 xi_2 r (1 + r^2) + 4 (xi_1^2 + xi_2^2) r^2)
 *   r = w_1 / w_2
 *
 * Valid    exact for white noise; a good estimate for ground motions that are broadband around both frequencies
 * Source   Der Kiureghian 1981, Earthquake Eng. Struct. Dyn. 9, 419-435
 * Test     unit_separation: the_correlation_is_that_of_white_noise
 */
double pound_rule_correlation(const double frequency[POUND_OSCILLATORS],
                              const double damping[POUND_OSCILLATORS])
{
	if (!(frequency[0] > 0) || !(frequency[1] > 0))
		return 0;
	const double r = frequency[0] / frequency[1], a = damping[0], b = damping[1];
	if (r == 1 && a == b)
		return 1;
	const double below =
	    (1 - r * r) * (1 - r * r) + 4 * a * b * r * (1 + r * r) + 4 * (a * a + b * b) * r * r;
	return 8 * sqrt(a * b) * (r * a + b) * r * sqrt(r) / below;
}

/* The gap that a rule requires [m].
 *
 * Given    displacement  m   largest displacement of each body without the other body
 *          correlation   -   of the two displacements, pound_rule_correlation
 */
double pound_rule_gap(int rule, const double displacement[POUND_OSCILLATORS], double correlation)
{
	const double u = displacement[0], v = displacement[1];
	if (rules[rule].summed)
		return u + v;
	const double squared = u * u + v * v - (rules[rule].correlated ? 2 * correlation * u * v : 0);
	return sqrt(fmax(squared, 0));
}
