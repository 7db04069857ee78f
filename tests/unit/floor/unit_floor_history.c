/* unit_floor_history.c - rows of a history: the spectrum by linear interpolation of the rows, and the motion of both
 * bodies.
 *
 * The oracle is floor_task_lines(), a textbook method that shares no code with the floor's oscillators. */
#include <math.h>
#include <string.h>

#include "tests/support/check.h"
#include "tests/support/floor_tasks.h"

static const double pi = 3.14159265358979323846;

enum { FREQUENCIES = 31, ROWS = 1 << 20 };

static _Alignas(64) char scratch[POUND_EXACT_SCRATCH];
static struct pound_floor_instant rows[ROWS];
static int n_rows;

static void row_take(void *to, const struct pound_floor_instant *row)
{
	(void)to;
	assert_true(n_rows < ROWS);
	rows[n_rows++] = *row;
}

static void rows_take(const struct pound_task *task, const struct pound_spectrum *spectrum)
{
	static _Alignas(64) char memory[1 << 21];
	assert_true(pound_floor_bytes(spectrum->n) <= sizeof memory);
	struct pound_floor *floor = pound_floor_init(memory, spectrum);
	const struct pound_floor_ask ask = {.task = task, .scratch = scratch};
	n_rows = 0;
	assert_int_equal(pound_floor_history(floor, &ask, row_take, NULL), POUND_OK);
}

static double spectrum_of_rows(double w, double xi)
{
	static struct floor_line lines[ROWS];
	for (int i = 0; i < n_rows; i++)
		lines[i] = (struct floor_line){rows[i].time, rows[i].v[0], rows[i].acceleration[0]};
	return floor_task_lines(n_rows, lines, w, xi);
}

/* A long noisy motion of two oscillators of the paper, without a gap: tens of contacts, large and small. */
static void specimen_pounding(struct specimen *specimen, double stiffness_ratio, double restitution)
{
	specimen_init(specimen);
	struct pound_scene *scene = &specimen->study.scene;
	scene->oscillators[0].frequency_hz = 1;
	scene->oscillators[1].frequency_hz = 2.5;
	scene->contact.stiffness_ratio = stiffness_ratio;
	scene->contact.restitution = restitution;
	scene->contact.gap = 0;
	specimen_noise(specimen, 7, 1, 0.01, 1001);
}

static void straight_lines_between_rows_give_the_spectrum_within_half_a_percent(void **state)
{
	(void)state;
	static double psa[2][FREQUENCIES];
	static double *const into[] = {psa[0], psa[1]};
	for (int power = 2; power <= 8; power += 2)
		for (int elastic = 0; elastic < 2; elastic++)
			for (int damped = 0; damped < 2; damped++) {
				struct specimen specimen;
				const struct pound_spectrum spectrum = {
				    .n = FREQUENCIES, .min_hz = 0.1, .max_hz = 100, .damping_ratio = damped ? 0.05 : 0};
				specimen_pounding(&specimen, pow(10, power), elastic ? 1 : 0.6);
				const struct pound_task task = floor_task_task(&specimen, true);
				floor_task_spectra(&task, &spectrum, 2, 1.5, 0, (double **)into);
				rows_take(&task, &spectrum);
				double worst = 0, drift = 0;
				for (int k = 0; k < FREQUENCIES; k++) {
					const double of_rows = spectrum_of_rows(2 * pi * pound_spectrum_frequency(&spectrum, k),
					                                        spectrum.damping_ratio);
					worst = fmax(worst, fabs(of_rows / psa[0][k] - 1));
					drift = fmax(drift, psa[1][k] / psa[0][k]);
				}
				if (getenv("PRINT"))
					printf("K/k 1e%d restitution %g damping %g: %d rows of %d samples, impact_only at most "
					       "%.3g times, error %.3g %%\n",
					       power, elastic ? 1 : 0.6, spectrum.damping_ratio, n_rows, task.n_samples, drift,
					       100 * worst);
				assert_true(drift < 60);
				check_near(worst, 0, 0.005);
				specimen_free(&specimen);
			}
}

/* Every row satisfies the equations of motion, and rows lead to each other: the integral of a velocity v is (v +
 * v')h/2 + (a - a')h^2/12 up to h^5 |a'''|/720, for contacts of frequency W and speed v: (W h)^5 v/(720 W). */
static void every_row_is_the_motion_of_both_bodies(void **state)
{
	(void)state;
	const struct pound_spectrum spectrum = {.n = 1, .min_hz = 1, .max_hz = 1, .damping_ratio = 0.05};
	for (int power = 2; power <= 8; power += 2) {
		struct specimen specimen;
		specimen_pounding(&specimen, pow(10, power), 0.6);
		specimen.study.scene.contact.gap = 0.001;
		const struct pound_task task = floor_task_task(&specimen, true);
		rows_take(&task, &spectrum);
		double size[2] = {0, 0}, push = 0, overlap = 0;
		int inside = 0;
		for (int i = 0; i < n_rows; i++) {
			for (int b = 0; b < 2; b++)
				size[b] = fmax(size[b], fabs(rows[i].u[b]));
			push = fmax(push, -rows[i].push);
			overlap = fmax(overlap, -rows[i].gap);
		}
		assert_true(push > 0 && overlap > 0);
		for (int i = 0; i < n_rows; i++) {
			const struct pound_floor_instant *r = &rows[i], *q = &rows[i > 0 ? i - 1 : 0];
			const double h = r->time - q->time;
			assert_true(h >= 0);
			for (int b = 0; b < 2; b++) {
				const struct pound_task_body *body = &task.bodies[b];
				const double contact = b ? -task.mass_ratio * r->push : r->push;
				check_near(r->acceleration[b],
				           -(body->damping * r->v[b] + body->backbone.stiffness * r->u[b]) + contact,
				           1e-11 * (push + body->backbone.stiffness * size[b]));
				const double change =
				    h * (r->v[b] + q->v[b]) / 2 +
				    h * h / 12 * (q->acceleration[b] - q->ground - r->acceleration[b] + r->ground);
				check_near(r->u[b] - q->u[b], change, 1e-7 * size[b]);
			}
			check_near(r->gap, task.gap - (r->u[0] - r->u[1]), 1e-13 * (size[0] + size[1]));
			if (r->push != 0) {
				// in contact the force follows from the overlap, even if that is 1e-9 of the displacements
				inside++;
				check_near(-r->push, -task.contact_stiffness * r->gap - task.contact_damping * r->gap_rate,
				           1e-9 * push);
			}
			const double sample = r->time / task.time_step;
			const int k = (int)fmin(floor(sample), task.n_samples - 2);
			check_near(r->ground, task.ground[k] + (sample - k) * (task.ground[k + 1] - task.ground[k]),
			           1e-11);
		}
		assert_true(inside > 300);
		specimen_free(&specimen);
	}
}

CHECK_MAIN(cmocka_unit_test(straight_lines_between_rows_give_the_spectrum_within_half_a_percent),
           cmocka_unit_test(every_row_is_the_motion_of_both_bodies))
