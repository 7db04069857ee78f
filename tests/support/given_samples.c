#include "tests/support/given_samples.h"

#include <math.h>
#include <stdlib.h>

#include "tests/support/check.h"

static _Thread_local uint64_t state_of_draws;

/* Uniform draws in (0, 1): a linear congruential sequence of 64 bits, its 53 highest (Knuth, MMIX). */
double given_uniform(void)
{
	state_of_draws = state_of_draws * 6364136223846793005u + 1442695040888963407u;
	return ((double)(state_of_draws >> 11) + 0.5) * 0x1p-53;
}

/* Box and Muller. */
double given_normal(void)
{
	const double u = given_uniform(), v = given_uniform();
	return sqrt(-2.0 * log(u)) * cos(2.0 * M_PI * v);
}

void given_draw(struct given_samples *s, int n, int d, uint64_t seed)
{
	state_of_draws = seed;
	*s = (struct given_samples){.given = {.n_rows = n, .n_inputs = d}};
	s->x = calloc((size_t)n * (d + 2) + 2 * (size_t)n * d, sizeof *s->x);
	s->y = s->x + (size_t)n * d;
	s->noise = s->y + n;
	s->values = s->noise + n;
	s->order = calloc((size_t)n, sizeof *s->order);
	s->cell = calloc((size_t)n, sizeof *s->cell);
	s->scratch = calloc(pound_given_scratch(n, d), sizeof *s->scratch);
	for (int k = 0; k < 10 + n * d; k++)
		s->x[k < 10 ? 0 : k - 10] = given_uniform();
}

void given_check(struct given_samples *s)
{
	s->given.x = s->x;
	s->given.inputs = s->inputs;
	pound_given_inputs(&s->given, s->values, s->cell, s->order);
	pound_given_check(&s->given, s->scratch, &s->checks);
}

void given_estimate(struct given_samples *s, struct pound_given_indices *indices)
{
	const struct pound_given_output output = {s->y, s->given.noise_known ? s->noise : NULL};
	pound_given_estimate(&s->given, &s->checks, &output, s->scratch, indices);
}

void given_free(struct given_samples *s)
{
	free(s->x);
	free(s->order);
	free(s->cell);
	free(s->scratch);
}

bool given_says(unsigned notes, int note)
{
	return notes >> note & 1;
}

void given_check_holds(struct pound_estimate e, double value, const char *what, int *missed)
{
	if (!(e.low <= value && value <= e.high)) {
		check_report("%s: %.4f is not in [%.4f, %.4f]", what, value, e.low, e.high);
		++*missed;
	}
}
