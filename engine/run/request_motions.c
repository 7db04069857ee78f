/* request_motions.c - the ground motions that a block of a study needs. */
#include "engine/run/request_motions.h"

#include <assert.h>
#include <float.h>
#include <math.h>

/* Inserts the mean of every two samples between them. */
static void motion_halve(struct pound_motion *m)
{
	double *g = m->ground;
	for (int t = m->n_samples - 1; t > 0; t--) {
		double middle = 0.5 * (g[t - 1] + g[t]);
		g[2 * t] = g[t];
		g[2 * t - 1] = middle;
	}
	m->n_samples = 2 * m->n_samples - 1;
	m->time_step *= 0.5;
}

/* Fills the ground motions and, if `scaled`, scales each by a power of two.
 *
 * Returns  motions  their samples, allocated from ground one after another  (n)
 *          ground   (n_ground)
 */
void pound_motions_fill(struct pound_motion *motions, int n, bool scaled, double *ground, int64_t n_ground)
{
	const double *end = ground + n_ground;
	struct pound_signal signals[POUND_SIGNALS_MAX];
	for (int j = 0, waiting = 0; j < n; j++) {
		struct pound_motion *m = &motions[j];
		m->n_samples = pound_excitation_samples(&m->excitation);
		m->time_step = m->excitation.time_step;
		m->ground = ground;
		ground += m->halved ? 2 * m->n_samples - 1 : m->n_samples;
		assert(ground <= end);
		signals[waiting++] = (struct pound_signal){&m->excitation, m->noise, m->ground};
		if (waiting == POUND_SIGNALS_MAX || j == n - 1) {
			pound_signals_fill(signals, waiting);
			waiting = 0;
		}
	}
	for (int j = 0; j < n; j++) {
		struct pound_motion *m = &motions[j];
		if (m->halved)
			motion_halve(m);
		const double peak = pound_excitation_largest(m->n_samples, m->ground);
		m->exponent = scaled && peak > 0 ? ilogb(peak) : 0;
		// in two factors, as the scale factor of a subnormal peak exceeds the largest double
		const int first = -m->exponent < DBL_MAX_EXP ? -m->exponent : DBL_MAX_EXP - 1;
		const double factor = ldexp(1, first), rest = ldexp(1, -m->exponent - first);
		for (int t = 0; t < m->n_samples && m->exponent != 0; t++)
			m->ground[t] = m->ground[t] * factor * rest;
	}
}
