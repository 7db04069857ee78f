/* specimen.h - response studies built in C, for tests of the engine without documents.
 *
 * SI units.  A specimen owns its record; the study inside points at it, so a specimen stays where it is. */
#ifndef SPECIMEN_H
#define SPECIMEN_H

#include "engine/pound.h"
#include "tests/oracle.h"

struct specimen {
	struct pound_study study;
	double *record; /* (study.scene.excitation.n_record), owned */
};

/* Two linear oscillators of 1 kg, 1 and 2.5 Hz and 5 % damping that touch at rest, the paper's contact with
 * restitution 0.6, and no ground motion yet. */
void specimen_init(struct specimen *specimen);
void specimen_free(struct specimen *specimen);

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

/* A specimen of its own for every number: any law on either side, both contact rules, gap or none, wall, damping 0 to
 * 0.1, restitution 0 to 1 with both ends, contact 10 to 10^4 times stiffer, yield displacement given or found, noise
 * that jumps to its first value or rises from 0. */
void specimen_random(struct specimen *specimen, int number, double time_step, int n);

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

struct pound_response specimen_engine(const struct specimen *specimen);
struct pound_response specimen_oracle(const struct specimen *specimen, double radians);

#endif
