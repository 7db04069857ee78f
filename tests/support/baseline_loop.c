/* baseline_loop.c - central differences with a fixed step, one simulation at a time, in two versions:
 *
 * 1. plain: the force of every spring and dashpot computed at each step;
 * 2. tuned: all of it multiplied out before the loop into 2 x 2 products without contact and in contact, which is as fast
 *    as one simulation at a time gets. */
#include "tests/support/baseline_loop.h"

#include <assert.h>
#include <math.h>

/* Displacement one step before the start from rest, u - h v + h2/2 u", for a body without spring and contact force [m]. */
static double step_before(const struct pound_task *task, int i, double h)
{
	return -0.5 * h * h * task->bodies[i].drive * task->ground[0];
}

/* Response of one task with a fixed step: forces, then the next displacements.
 *
 * Given    task    linear laws, tension
 *          steps   time steps per sample interval
 * Returns  value   first-order accurate in the step: the contact dashpot uses the velocity half a step earlier
 *
 *   (1 + c h/2) u_next = 2 u - (1 - c h/2) u_before - h2 (k u + a +- F),   F = K p + C p' where p > 0
 *
 * Source   Chopra, Dynamics of Structures, 5.3
 */
struct baseline_result baseline_plain(const struct pound_task *task, int steps)
{
	assert(task->contact && task->tension);
	double h = task->time_step / steps, K = task->contact_stiffness, C = task->contact_damping;
	double k1 = task->bodies[0].backbone.stiffness, k2 = task->bodies[1].backbone.stiffness;
	double drive1 = task->bodies[0].drive, drive2 = task->bodies[1].drive;
	double half1 = 0.5 * h * task->bodies[0].damping, half2 = 0.5 * h * task->bodies[1].damping;
	double share1 = 1 / (1 + half1), share2 = 1 / (1 + half2);
	double u1 = 0, u2 = 0, impulse = 0, u_max = 0, impulse_max = 0;
	double before1 = step_before(task, 0, h), before2 = step_before(task, 1, h);
	int contacts = 0;
	bool touching = false;
	for (int i = 1; i < task->n_samples; i++) {
		double a0 = task->ground[i - 1], slope = (task->ground[i] - a0) / steps;
		for (int j = 0; j < steps; j++) {
			double a = a0 + slope * j, p = u1 - u2 - task->gap, force = 0;
			if (p > 0) {
				force = K * p + C * ((u1 - before1) - (u2 - before2)) / h;
				impulse = (touching ? impulse : 0) + force * h;
				contacts += !touching;
				touching = true;
			} else {
				// impulse of the whole contact: at its end the dashpot pulls, which reduces the impulse
				impulse_max = touching && impulse > impulse_max ? impulse : impulse_max;
				touching = false;
			}
			double pull1 = k1 * u1 + drive1 * a + force,
			       pull2 = k2 * u2 + drive2 * a - task->mass_ratio * force;
			double next1 = (2 * u1 - (1 - half1) * before1 - h * h * pull1) * share1;
			double next2 = (2 * u2 - (1 - half2) * before2 - h * h * pull2) * share2;
			before1 = u1, before2 = u2;
			u1 = next1, u2 = next2;
			u_max = fabs(u1) > u_max ? fabs(u1) : u_max;
		}
	}
	// a contact that has not ended counts with its impulse so far
	impulse_max = touching && impulse > impulse_max ? impulse : impulse_max;
	return (struct baseline_result){
	    .displacement_max = u_max, .impulse_max = impulse_max, .contacts = contacts};
}

/* u_next = now u + before u_before + ground a + rest; `rest` is the constant term due to the gap */
struct recurrence {
	double now[2][2], before[2][2], ground[2], rest[2];
};

/* The recurrence of central differences with the velocity (u_next - u_before)/2h.
 *
 * Given    task, h    h [s]
 *          K, C       K/m1 [1/s2] and C/m1 [1/s]; 0 while separated
 *
 *   (M/h2 + D/2h) u_next = (2M/h2 - S) u - (M/h2 - D/2h) u_before - drive a + K gap,    masses divided out
 *
 * Source   Chopra, Dynamics of Structures, 5.3 and 16.2
 */
static struct recurrence recurrence(const struct pound_task *task, double h, double K, double C)
{
	const struct pound_task_body *b = task->bodies;
	double r = task->mass_ratio, k1 = b[0].backbone.stiffness, k2 = b[1].backbone.stiffness;
	const double stiffness[2][2] = {{k1 + K, -K}, {-r * K, k2 + r * K}};
	const double damping[2][2] = {{b[0].damping + C, -C}, {-r * C, b[1].damping + r * C}};
	const double load[2] = {K * task->gap, -r * K * task->gap};
	double next[2][2], now[2][2], before[2][2];
	for (int i = 0; i < 2; i++)
		for (int j = 0; j < 2; j++) {
			double mass = (i == j) / (h * h), half = damping[i][j] / (2 * h);
			next[i][j] = mass + half;
			now[i][j] = 2 * mass - stiffness[i][j];
			before[i][j] = half - mass;
		}
	double det = next[0][0] * next[1][1] - next[0][1] * next[1][0];
	const double inverse[2][2] = {{next[1][1] / det, -next[0][1] / det},
	                              {-next[1][0] / det, next[0][0] / det}};
	struct recurrence x = {0};
	for (int i = 0; i < 2; i++)
		for (int j = 0; j < 2; j++) {
			for (int k = 0; k < 2; k++) {
				x.now[i][k] += inverse[i][j] * now[j][k];
				x.before[i][k] += inverse[i][j] * before[j][k];
			}
			x.ground[i] -= inverse[i][j] * b[j].drive;
			x.rest[i] += inverse[i][j] * load[j];
		}
	return x;
}

/* The same response, with all products computed before the loop.
 *
 * Returns  value   first-order accurate in the step where a contact begins or ends, second-order between
 *
 * Test     bench: within the errors of the plain loop
 */
struct baseline_result baseline_tuned(const struct pound_task *task, int steps)
{
	assert(task->contact && task->tension);
	double h = task->time_step / steps, K = task->contact_stiffness, C = task->contact_damping;
	const struct recurrence free = recurrence(task, h, 0, 0), touch = recurrence(task, h, K, C);
	double u1 = 0, u2 = 0, impulse = 0, u_max = 0, impulse_max = 0;
	double before1 = step_before(task, 0, h), before2 = step_before(task, 1, h);
	int contacts = 0;
	bool touching = false;
	for (int i = 1; i < task->n_samples; i++) {
		double a0 = task->ground[i - 1], slope = (task->ground[i] - a0) / steps;
		for (int j = 0; j < steps; j++) {
			double next1, next2, a = a0 + slope * j, p = u1 - u2 - task->gap;
			if (p > 0) {
				next1 = touch.now[0][0] * u1 + touch.now[0][1] * u2 + touch.before[0][0] * before1 +
				        touch.before[0][1] * before2 + touch.ground[0] * a + touch.rest[0];
				next2 = touch.now[1][0] * u1 + touch.now[1][1] * u2 + touch.before[1][0] * before1 +
				        touch.before[1][1] * before2 + touch.ground[1] * a + touch.rest[1];
				impulse = touching ? impulse : 0;
				impulse += K * h * p + 0.5 * C * (next1 - next2 - before1 + before2);
				contacts += !touching;
				touching = true;
			} else {
				next1 = free.now[0][0] * u1 + free.before[0][0] * before1 + free.ground[0] * a;
				next2 = free.now[1][1] * u2 + free.before[1][1] * before2 + free.ground[1] * a;
				// impulse of the whole contact: at its end the dashpot pulls, which reduces the impulse
				impulse_max = touching && impulse > impulse_max ? impulse : impulse_max;
				touching = false;
			}
			before1 = u1, before2 = u2;
			u1 = next1, u2 = next2;
			u_max = fabs(u1) > u_max ? fabs(u1) : u_max;
		}
	}
	// a contact that has not ended counts with its impulse so far
	impulse_max = touching && impulse > impulse_max ? impulse : impulse_max;
	return (struct baseline_result){
	    .displacement_max = u_max, .impulse_max = impulse_max, .contacts = contacts};
}
