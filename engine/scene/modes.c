/* modes.c - modes of vibration of a shear building with its initial stiffness.
 *
 *   K phi = w^2 M phi,   K tridiagonal: k_i + k_(i+1) on the diagonal, -k_i beside it
 *
 * as a symmetric tridiagonal matrix M^(-1/2) K M^(-1/2), by implicit QL steps with Wilkinson's shift.  Each frequency is then
 * recomputed from its shape, w^2 = sum k d^2 with the drifts d of the shape: an error of the shape enters squared, so the lowest
 * frequencies stay accurate if some stories are stiff. */
#include "engine/scene/modes.h"

#include <assert.h>
#include <float.h>
#include <math.h>
#include <stddef.h>

/* One QL step on rows l to m of a tridiagonal matrix; z[i]: its i-th eigenvector so far. */
static void ql_step(int n, double *d, double *e, int l, int m, double (*z)[POUND_STORIES])
{
	double g = (d[l + 1] - d[l]) / (2 * e[l]), r = sqrt(g * g + 1);
	g = d[m] - d[l] + e[l] / (g + copysign(r, g));
	double s = 1, c = 1, p = 0;
	for (int i = m - 1; i >= l; i--) {
		const double f = s * e[i], b = c * e[i];
		r = sqrt(f * f + g * g);
		e[i + 1] = r;
		if (r == 0) { // the matrix splits here
			d[i + 1] -= p;
			e[m] = 0;
			return;
		}
		s = f / r;
		c = g / r;
		g = d[i + 1] - p;
		r = (d[i] - g) * s + 2 * c * b;
		p = s * r;
		d[i + 1] = g + p;
		g = c * r - b;
		for (int k = 0; k < n; k++) {
			const double upper = z[i + 1][k], lower = z[i][k];
			z[i + 1][k] = s * lower + c * upper;
			z[i][k] = c * lower - s * upper;
		}
	}
	d[l] -= p;
	e[l] = g;
	e[m] = 0;
}

/* Eigenvectors of a symmetric tridiagonal matrix, one row each.
 *
 * Given    d, e  diagonal and off-diagonal (n - 1 values, space for n); overwritten
 * Returns  z     (n x n)
 * Source   Bowdler, Martin, Reinsch and Wilkinson 1968, Numer. Math. 11, 293-306
 */
static void tridiagonal_vectors(int n, double *d, double *e, double (*z)[POUND_STORIES])
{
	enum { STEPS = 60 }; // limit per eigenvalue; two are usual
	for (int i = 0; i < n; i++)
		for (int k = 0; k < n; k++)
			z[i][k] = i == k;
	e[n - 1] = 0;
	for (int l = 0; l < n; l++)
		for (int step = 0; step < STEPS; step++) {
			int m = l;
			while (m < n - 1 && fabs(e[m]) > DBL_EPSILON * sqrt(fabs(d[m])) * sqrt(fabs(d[m + 1])))
				m++;
			if (m == l)
				break;
			ql_step(n, d, e, l, m, z);
		}
}

/* Modes of a building fixed to the ground.
 *
 * Given    mass, stiffness  of floors and the stories below them, from the ground up [kg], [N/m]  (n)
 * Returns  modes            frequencies in ascending order, shapes with sum m phi^2 = 1
 *
 * Valid    Relative error of frequencies: a few roundings; of shapes: roundings times largest frequency / distance to the next.
 * Source   Chopra, Dynamics of Structures, 10.2 and 10.4
 * Test     unit_modes
 */
void pound_modes_fill(int n, const double *mass, const double *stiffness, struct pound_modes *modes)
{
	assert(n >= 1 && n <= POUND_STORIES);
	double d[POUND_STORIES], e[POUND_STORIES];
	for (int i = 0; i < n; i++) {
		d[i] = (stiffness[i] + (i + 1 < n ? stiffness[i + 1] : 0)) / mass[i];
		e[i] = i + 1 < n ? -stiffness[i + 1] / (sqrt(mass[i]) * sqrt(mass[i + 1])) : 0;
	}
	tridiagonal_vectors(n, d, e, modes->shape);
	for (int r = 0; r < n; r++) {
		double *shape = modes->shape[r], below = 0, strain = 0, norm = 0;
		for (int i = 0; i < n; i++) {
			norm += shape[i] * shape[i];
			shape[i] /= sqrt(mass[i]);
		}
		for (int i = 0; i < n; i++) {
			shape[i] /= sqrt(norm);
			strain += stiffness[i] * (shape[i] - below) * (shape[i] - below);
			below = shape[i];
		}
		modes->w[r] = sqrt(strain);
	}
	for (int r = 1; r < n; r++)
		for (int s = r; s > 0 && modes->w[s] < modes->w[s - 1]; s--) {
			const double w = modes->w[s];
			modes->w[s] = modes->w[s - 1];
			modes->w[s - 1] = w;
			for (int i = 0; i < n; i++) {
				const double shape = modes->shape[s][i];
				modes->shape[s][i] = modes->shape[s - 1][i];
				modes->shape[s - 1][i] = shape;
			}
		}
}

/* Angular frequencies of a building, ascending [rad/s]  (n). */
void pound_modes_frequencies(int n, const double *mass, const double *stiffness, double *w)
{
	struct pound_modes modes;
	pound_modes_fill(n, mass, stiffness, &modes);
	for (int r = 0; r < n; r++)
		w[r] = modes.w[r];
}

/* Damping with the same ratio in every mode: force on floor i [N] per drift rate of story j [m/s].
 *
 *   C = sum over modes of 2 xi w (M phi)(M phi)^T for floor velocities; each of these is the sum of the drift rates below
 *
 * Given    damping_ratio  xi
 * Returns  matrix         [N s/m]  (n x n)
 * Source   Chopra, Dynamics of Structures, 11.4.2
 */
void pound_modes_damping(int n, const double *mass, const double *stiffness, double damping_ratio,
                         double *matrix)
{
	struct pound_modes modes;
	pound_modes_fill(n, mass, stiffness, &modes);
	for (int i = 0; i < n; i++)
		for (int j = n - 1; j >= 0; j--) {
			double sum = j + 1 < n ? matrix[i * n + j + 1] : 0;
			for (int r = 0; r < n; r++)
				sum += 2 * damping_ratio * modes.w[r] * (mass[i] * modes.shape[r][i]) *
				       (mass[j] * modes.shape[r][j]);
			matrix[i * n + j] = sum;
		}
}
