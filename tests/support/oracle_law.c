/* oracle_law.c - the laws from their definitions, for the oracle.
 *
 * Forces come from a slider's position, a curve and the extreme points, not from branches and edges. */
#include "tests/support/oracle.h"

#include <assert.h>
#include <math.h>
#include <string.h>

typedef long double real;

// relative tolerance within which a law counts as on its yield surface; thousands of long double roundings
static const real near_one = 1 - 1e-15L;

struct definition {
	const char *name;
	void (*start)(struct oracle_law *law);
	real (*force)(const struct oracle_law *law, real u);
	void (*settle)(struct oracle_law *law, real u);
	int (*branch)(const struct oracle_law *law, real u, real v);
};

static real clipped(real x, real bound)
{
	return x > bound ? bound : x < -bound ? -bound : x;
}

static int sign_of(real x)
{
	return (x > 0) - (x < 0);
}

static real backbone(const struct oracle_law *law, real u)
{
	return law->k2 * u + (law->k - law->k2) * clipped(u, law->yield);
}

static void nothing_remembered(struct oracle_law *law)
{
	law->memory[0] = law->memory[1] = 0;
}

static void nothing_settled(struct oracle_law *law, real u)
{
	(void)law;
	(void)u;
}

static real linear_force(const struct oracle_law *law, real u)
{
	return law->k * u;
}

static int linear_branch(const struct oracle_law *law, real u, real v)
{
	(void)law;
	(void)u;
	(void)v;
	return 0;
}

// a spring k2 beside a spring k - k2 with a slider of strength (k - k2) yield; memory[0]: position of the slider
static real elastoplastic_force(const struct oracle_law *law, real u)
{
	return law->k2 * u + (law->k - law->k2) * clipped(u - law->memory[0], law->yield);
}

static void elastoplastic_settle(struct oracle_law *law, real u)
{
	real stretch = u - law->memory[0];
	if (fabsl(stretch) > law->yield)
		law->memory[0] = u - clipped(stretch, law->yield);
}

static int elastoplastic_branch(const struct oracle_law *law, real u, real v)
{
	real stretch = u - law->memory[0];
	bool sliding = fabsl(stretch) >= law->yield * near_one && stretch * v > 0;
	return sliding ? sign_of(stretch) : 0;
}

static int nonlinear_elastic_branch(const struct oracle_law *law, real u, real v)
{
	(void)v;
	return fabsl(u) > law->yield ? sign_of(u) : 0;
}

// memory[side]: largest displacement reached on that side, initially the yield displacement
static void origin_oriented_start(struct oracle_law *law)
{
	law->memory[0] = law->memory[1] = law->yield;
}

static real origin_oriented_force(const struct oracle_law *law, real u)
{
	real farthest = law->memory[u < 0];
	return fabsl(u) >= farthest ? backbone(law, u) : u * (backbone(law, farthest) / farthest);
}

static void origin_oriented_settle(struct oracle_law *law, real u)
{
	law->memory[u < 0] = fmaxl(law->memory[u < 0], fabsl(u));
}

static int origin_oriented_branch(const struct oracle_law *law, real u, real v)
{
	bool going_on = fabsl(u) >= law->memory[u < 0] * near_one && u * v > 0;
	return (going_on ? 2 : 1) * (u < 0 ? -1 : 1);
}

static const struct definition definitions[] = {
    {"linear", nothing_remembered, linear_force, nothing_settled, linear_branch},
    {"elastoplastic", nothing_remembered, elastoplastic_force, elastoplastic_settle, elastoplastic_branch},
    {"nonlinear_elastic", nothing_remembered, backbone, nothing_settled, nonlinear_elastic_branch},
    {"origin_oriented", origin_oriented_start, origin_oriented_force, origin_oriented_settle,
     origin_oriented_branch},
};

enum { N_DEFINITIONS = sizeof definitions / sizeof definitions[0] };

/* A law in its initial state.
 *
 * Given    name             -    as in a study document
 *          k                N/m  initial stiffness, > 0
 *          hardening_ratio  -    second slope over first
 *          yield            m    end of the first slope, > 0; not used by `linear`
 * Test     unit_oracle: an_elastoplastic_loop_has_the_area_of_its_parallelogram
 */
struct oracle_law oracle_law(const char *name, long double k, double hardening_ratio, double yield)
{
	struct oracle_law law = {.k = k, .k2 = hardening_ratio * k, .yield = yield};
	while (strcmp(definitions[law.row].name, name) != 0) {
		law.row++;
		assert(law.row < N_DEFINITIONS);
	}
	definitions[law.row].start(&law);
	return law;
}

/* Force at u; since the last oracle_law_settle, no displacement was beyond u. */
long double oracle_law_force(const struct oracle_law *law, long double u)
{
	return definitions[law->row].force(law, u);
}

/* Updates the memory of the law with displacement u. */
void oracle_law_settle(struct oracle_law *law, long double u)
{
	definitions[law->row].settle(law, u);
}

/* Number of the branch at displacement u and velocity v; the force has a kink where the number changes. */
int oracle_law_branch(const struct oracle_law *law, long double u, long double v)
{
	return definitions[law->row].branch(law, u, v);
}
