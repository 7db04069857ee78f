/* scenes.h - response studies built in C, for tests of the engine without documents.
 *
 * SI units.  A specimen owns its record; the study inside points to it, so a specimen must not be moved. */
#ifndef SCENES_H
#define SCENES_H

#include <pthread.h>
#include <time.h>

#include "engine/exact/task.h"
#include "engine/pound.h"
#include "tests/support/oracle.h"

struct specimen {
	struct pound_study study;
	double *record; /* (study.scene.excitation.n_record), owned */
};

/* Two linear oscillators of 1 kg, 1 and 2.5 Hz and 5 % damping that touch at rest, the paper's contact with
 * restitution 0.6, and no ground motion yet. */
void specimen_init(struct specimen *specimen);
void specimen_free(struct specimen *specimen);

/* What a clock shows [s]. */
double specimen_seconds(clockid_t clock);

/* Calls act(of) in another thread when this one has computed for a twentieth of a second more.  For pthread_join. */
pthread_t specimen_later(void act(void *), void *of);

enum { SPECIMEN_LAWS = 4 };
extern const char *const specimen_laws[SPECIMEN_LAWS]; /* their names: the linear one and the others */

/* The same law for both; yield 0: found from the target demand. */
void specimen_law(struct specimen *specimen, const char *name, double yield);

/* A record of n samples, all 0 at first. */
double *specimen_record(struct specimen *specimen, double time_step, int n);

/* A record that is peak sin(pi t / pulse) until `pulse` and 0 from there to `duration`, both whole numbers of steps.
 * Its response is that of the smooth half sine to about (pi step / pulse)^4 / 100. */
void specimen_half_sine(struct specimen *specimen, double peak, double pulse, double duration,
                        double time_step);

/* A record of smooth noise, |a| up to about `peak`. */
void specimen_noise(struct specimen *specimen, uint64_t seed, double peak, double time_step, int n);

/* Uniform in [low, high): the next of a stream. */
double specimen_uniform(uint64_t *stream, double low, double high);

/* A different specimen for every number: any law on either side, both contact rules, gap or none, wall, damping 0 to
 * 0.1, restitution 0 to 1 with both ends, contact 10 to 10^4 times stiffer, yield displacement given or found, noise
 * that jumps to its first value or rises from 0. */
void specimen_random(struct specimen *specimen, int number, double time_step, int n);

/* A different specimen for every number: a yielding body is in sustained contact with a wall or another body, creeps after
 * yielding, reverses there and oscillates by anything from a rounding to a thirtieth, and separates at the end.
 *
 * Given    parts  samples that each of the record's linear segments is split into
 */
void specimen_creeping(struct specimen *specimen, int number, int parts);

/* A different specimen for every number: bodies that touch at rest and are alike but for 1 to 20 roundings of a frequency.
 *
 * Given    law  of both: a row of specimen_laws
 */
void specimen_alike(struct specimen *specimen, int number, int law);

/* A single oscillator under a half sine of force, in samples 0.1 s apart of which there are t behind the first, and its displacement
 * at the last of them, to four digits: Chopra, Dynamics of Structures, example 5.1. */
enum { SPECIMEN_TEXTBOOK = 10 };
void specimen_textbook(struct specimen *specimen, int t);
extern const double specimen_textbook_u[SPECIMEN_TEXTBOOK];

/* A body pressed to a wall that bounces on it without losses, a thousand times in each of two million samples: to follow it
 * takes hours. */
void specimen_bouncing(struct specimen *specimen);

/* Two free masses, m1 = 1 kg and m2 = 2 kg, that meet at 1.5 m/s after 10 cm, above a ground that rests for that many samples,
 * 0.01 s apart and 1000 at most. */
struct pound_task specimen_impact(double restitution, bool tension, int n_samples);

/* Two oscillators under a half sine of 0.5 s, 3 s in all, computed elsewhere: a 128-bit Taylor solution. */
struct specimen_reference {
	const char *name;
	double f1, f2, m2, restitution, stiffness_ratio, gap;
	bool tension;
	double contacts, first_start, first_speed, u1_max, u2_max, impulse_max, end_u1, end_u2;
};

enum { SPECIMEN_REFERENCES = 7 };
extern const struct specimen_reference specimen_references[SPECIMEN_REFERENCES];

void specimen_reference(struct specimen *specimen, const struct specimen_reference *reference,
                        double time_step);

/* All blocks of a run, and then all that is made of them, by one thread: the first status that is not POUND_OK. */
enum pound_status specimen_compute(struct pound_run *run);

/* A run of a study, computed whole; that must succeed.  For pound_run_free. */
struct pound_run *specimen_run(const struct pound_study *study);

struct pound_response specimen_engine(const struct specimen *specimen);
struct pound_response specimen_oracle(const struct specimen *specimen, double radians);

/* A body damped as may be, pressed from rest on a wall without a gap by an acceleration of 1, for about three steps. */
struct pound_task specimen_pressed(uint64_t *seed);

#endif
