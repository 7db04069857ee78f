/* contact.c - contact models: what a coefficient of restitution asks of the dashpot beside the contact spring.
 *
 * Adding a model: its function and its row in models[].  The row says what form its force has; a solver that cannot integrate
 * that form is refused where studies are read, and asserts it (solver.c). */
#include <assert.h>
#include <float.h>
#include <math.h>
#include <stddef.h>

#include "engine/numeric/elementary.h"
#include "engine/pound.h"
#include "engine/scene/contact.h"

/* Damping ratio of a Kelvin-Voigt contact that gives a wanted coefficient of restitution.
 *
 * Given    e      -    [0, 1]
 * Returns  value  -    [0, 1]; e = 0 gives the limit 1, no log of zero
 *
 *   zeta = -ln e / sqrt(pi^2 + (ln e)^2)
 *
 * Valid    Exact when contact lasts until the overlap is zero (the dashpot may pull at the end).  With release at
 *          zero force the realised restitution is e^(1 - 2 asin(zeta)/pi): 0.900 -> 0.902, 0.600 -> 0.632.
 * Source   Anagnostopoulos 1988, Earthquake Eng. Struct. Dyn. 16, 443-456; the paper, Eq. (2)
 * Test     unit_contact
 */
static double kelvin_voigt(double e)
{
	static const double PI = 3.14159265358979323846;
	if (e == 0)
		return 1;
	// the logarithm wants a normal number, and below the least of them zeta is 1 to 1e-5 all the same
	double l = pound_elementary_log(fmax(e, DBL_MIN));
	return -l / sqrt(PI * PI + l * l);
}

static const struct model {
	const char *name;
	const char *text;       /* one line of documentation */
	enum pound_force force; /* what a solver has to be able to do */
	double (*damping_ratio)(double restitution);
} models[] = {
    {"kelvin_voigt", "spring and dashpot in parallel, F = K p + C p' while the bodies touch",
     POUND_FORCE_LINEAR, kelvin_voigt},
};

const char *pound_contact_name(int row)
{
	return row >= 0 && row < (int)(sizeof models / sizeof models[0]) ? models[row].name : NULL;
}

const char *pound_contact_text(int row)
{
	return models[row].text;
}

enum pound_force pound_contact_force(int row)
{
	return models[row].force;
}

bool pound_force_scales(enum pound_force force)
{
	return force != POUND_FORCE_POWER;
}

double pound_contact_damping_ratio(int model, double restitution)
{
	assert(restitution >= 0 && restitution <= 1);
	return models[model].damping_ratio(restitution);
}
