/* unit_modes.c - modes of shear buildings against closed forms, orthogonality and the eigenvalue equation. */
#include "engine/scene/modes.h"
#include "tests/support/check.h"

#include <math.h>

static const double pi = 3.14159265358979323846;

static void equal_floors_have_known_frequencies(void **state)
{
	(void)state;
	for (int n = 1; n <= POUND_STORIES; n++) {
		double mass[POUND_STORIES], stiffness[POUND_STORIES], w[POUND_STORIES];
		for (int i = 0; i < n; i++)
			mass[i] = 3, stiffness[i] = 48;
		pound_modes_frequencies(n, mass, stiffness, w);
		for (int j = 1; j <= n; j++) {
			const double want = 2 * 4 * sin((2 * j - 1) * pi / (4 * n + 2));
			check_near(w[j - 1], want, 2e-13 * want);
		}
	}
}

/* A building with random floors; `stiff` stories are a million times stiffer. */
static void building_random(int number, int n, double *mass, double *stiffness, bool stiff)
{
	for (int i = 0; i < n; i++) {
		mass[i] = 1 + 0.9 * sin(7.0 * i + number);
		stiffness[i] = 100 * (1.5 + cos(3.0 * i + 2 * number)) * (stiff && i % 5 == 2 ? 1e6 : 1);
	}
}

static void shapes_satisfy_their_equation(void **state)
{
	(void)state;
	static struct pound_modes modes;
	for (int number = 0; number < 20; number++) {
		const int n = 1 + number * 49 / 19;
		double mass[POUND_STORIES], stiffness[POUND_STORIES];
		building_random(number, n, mass, stiffness, false);
		pound_modes_fill(n, mass, stiffness, &modes);
		for (int r = 0; r < n; r++) {
			assert_true(r == 0 || modes.w[r] > modes.w[r - 1]);
			for (int s = 0; s < n; s++) {
				double sum = 0;
				for (int i = 0; i < n; i++)
					sum += mass[i] * modes.shape[r][i] * modes.shape[s][i];
				check_near(sum, r == s, 1e-13);
			}
			const double *x = modes.shape[r], w2 = modes.w[r] * modes.w[r];
			for (int i = 0; i < n; i++) {
				const double below = stiffness[i] * (x[i] - (i > 0 ? x[i - 1] : 0));
				const double above = i + 1 < n ? stiffness[i + 1] * (x[i + 1] - x[i]) : 0;
				check_near(below - above, w2 * mass[i] * x[i], 1e-12 * modes.w[n - 1] * modes.w[n - 1]);
			}
		}
	}
}

static void stiff_stories_leave_the_first_frequency_its_digits(void **state)
{
	(void)state;
	// two floors with a nearly rigid story between them, on a soft story: w^2 = k/(m1 + m2) (1 - k m2^2/(K (m1 +
	// m2)^2) + ...)
	const double mass[2] = {1, 2}, stiffness[2] = {9, 9e9};
	double w[2];
	pound_modes_frequencies(2, mass, stiffness, w);
	check_near(w[0] * w[0], 3 * (1 - 4e-9 / 9), 1e-14);
}

static void modal_damping_damps_every_mode_alike(void **state)
{
	(void)state;
	enum { N = 7 };
	static struct pound_modes modes;
	double mass[N], stiffness[N], matrix[N * N];
	building_random(3, N, mass, stiffness, false);
	pound_modes_fill(N, mass, stiffness, &modes);
	pound_modes_damping(N, mass, stiffness, 0.05, matrix);
	for (int r = 0; r < N; r++)
		for (int i = 0; i < N; i++) {
			double force = 0;
			for (int j = 0; j < N; j++)
				force += matrix[i * N + j] * (modes.shape[r][j] - (j > 0 ? modes.shape[r][j - 1] : 0));
			check_near(force, 0.1 * modes.w[r] * mass[i] * modes.shape[r][i], 1e-12);
		}
}

CHECK_MAIN(cmocka_unit_test(equal_floors_have_known_frequencies),
           cmocka_unit_test(shapes_satisfy_their_equation),
           cmocka_unit_test(stiff_stories_leave_the_first_frequency_its_digits),
           cmocka_unit_test(modal_damping_damps_every_mode_alike))
