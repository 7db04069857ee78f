/* given_samples.h - samples without a design, with all that an estimate takes. */
#ifndef GIVEN_SAMPLES_H
#define GIVEN_SAMPLES_H

#include "engine/given.h"

struct given_samples {
	struct pound_given given;
	struct pound_input inputs[POUND_INPUTS_MAX];
	struct pound_given_checks checks;
	double *x, *y, *noise, *values, *scratch; /* noise is used if given.noise_known */
	int *cell;
	size_t *order;
};

double given_uniform(void); /* the next draw in (0, 1) */
double given_normal(void);

/* Draws uniform inputs; free them with given_free. */
void given_draw(struct given_samples *s, int n, int d, uint64_t seed);
void given_free(struct given_samples *s);
void given_check(struct given_samples *s);
void given_estimate(struct given_samples *s, struct pound_given_indices *indices);

bool given_says(unsigned notes, int note);
/* Counts and reports an interval that does not contain a value. */
void given_check_holds(struct pound_estimate e, double value, const char *what, int *missed);

#endif
