/* modes.h - modes of vibration of a shear building of initial stiffness. */
#ifndef MODES_H
#define MODES_H

enum { POUND_STORIES = 50 }; /* maximum of a building */

/* angular frequencies in ascending order, and shapes of floors with sum m phi^2 = 1 */
struct pound_modes {
	double w[POUND_STORIES];                    /* [rad/s] */
	double shape[POUND_STORIES][POUND_STORIES]; /* [mode][floor] [1/sqrt kg] */
};

void pound_modes_frequencies(int n, const double *mass, const double *stiffness, double *w);
void pound_modes_fill(int n, const double *mass, const double *stiffness, struct pound_modes *modes);
void pound_modes_damping(int n, const double *mass, const double *stiffness, double damping_ratio,
                         double *matrix);

#endif
