/* unit_findings.c - every finding of the paper is reported to hold, to fail and to be undecided for suitable evidence. */
#include "tests/support/check.h"
#include "tests/support/findings.h"

#include <math.h>
#include <stddef.h>
#include <string.h>

static struct pound_estimate near_to(double value)
{
	return (struct pound_estimate){value, value - 0.01, value + 0.01};
}

/* Indices and scatter plots as the paper describes them. */
static struct evidence as_published(void)
{
	static const double eps[FREQUENCIES] = {0.55, 0.5, 0.4, 0.3, 0.25, 0.2};
	static const double f_e[FREQUENCIES] = {0.2, 0.25, 0.3, 0.35, 0.4, 0.45};
	struct evidence e;
	for (int law = 0; law < LAWS; law++) {
		for (int f = 0; f < FREQUENCIES; f++) {
			const double totals[EFFECTS][INPUTS] = {{0.6, 0.8, 0.7, eps[f]}, {f_e[f], 0.6, 0.7, 0.1}};
			for (int j = 0; j < INPUTS; j++)
				for (int k = 0; k < EFFECTS; k++) {
					struct pound_estimate(*index)[INPUTS] = e.index[k][law][f];
					index[TOTAL][j] = near_to(totals[k][j]);
					index[FIRST][j] = near_to(k == IMPULSE ? totals[k][j] - 0.05 : totals[k][j] / 5);
				}
		}
		e.scatter[law] = (struct scatter){near_to(0.05), near_to(0.8), near_to(0.1),
		                                  near_to(law == 0 ? 0.6 : 0.9), near_to(law == 0 ? 0.4 : 0.1)};
	}
	return e;
}

enum { EVERY = -1, IN_SCATTER = -2 };

/* Changes of the evidence for which a finding fails, or is undecided: for its effect and order and for every law, the
 * index of an input at one frequency f_1 or at every one; or a member of one law's scatter plot. */
struct change {
	int input, frequency; /* input IN_SCATTER: the scatter plot */
	size_t part;
	int law;
	struct pound_estimate fails, undecided;
};

#define INDEX(j, f)            .input = (j), .frequency = (f)
#define SCATTER(law_, member)  .input = IN_SCATTER, .law = (law_), .part = offsetof(struct scatter, member)
#define FAILING(x)             .fails = {(x), (x)-0.01, (x) + 0.01}
#define OVERLAPPING(low, high) .undecided = {((low) + (high)) / 2, (low), (high)}

static const struct change changes[] = {
    {INDEX(F_2, EVERY), .fails = {0.8, 0.6, 1.0}, .undecided = {0.8, NAN, NAN}},
    {INDEX(EPS, EVERY), FAILING(0.06), OVERLAPPING(0.05, 0.4)},
    {INDEX(F_2, EVERY), FAILING(0.8), OVERLAPPING(0.0, 0.9)},
    {INDEX(F_2, EVERY), FAILING(0.65), OVERLAPPING(0.66, 0.78)},
    {INDEX(MASS, EVERY), FAILING(0.57), OVERLAPPING(0.58, 0.72)},
    {INDEX(EPS, 0), FAILING(0.2), OVERLAPPING(0.35, 0.55)},
    {INDEX(EPS, 1), FAILING(0.2), OVERLAPPING(0.35, 0.55)},
    {INDEX(EPS, EVERY), FAILING(0.65), OVERLAPPING(0.5, 0.7)},
    {INDEX(EPS, 1), FAILING(0.6), OVERLAPPING(0.45, 0.6)},
    {INDEX(F_E, EVERY), FAILING(0.65), OVERLAPPING(0.55, 0.65)},
    {INDEX(F_E, EVERY), FAILING(0.6), OVERLAPPING(0.5, 0.6)},
    {INDEX(F_2, 1), FAILING(0.8), OVERLAPPING(0.65, 0.75)},
    {INDEX(F_2, 1), FAILING(0.8), OVERLAPPING(0.6, 0.7)},
    {INDEX(F_E, 5), FAILING(0.23), OVERLAPPING(0.2, 0.4)},
    {INDEX(F_E, 0), FAILING(0.5), OVERLAPPING(0.3, 0.5)},
    {INDEX(EPS, EVERY), FAILING(3.0), OVERLAPPING(0.0, 4.0)},
    {INDEX(EPS, EVERY), FAILING(0.65), OVERLAPPING(0.35, 0.65)},
    {INDEX(EPS, AT_2_HZ), FAILING(0.6), OVERLAPPING(0.5, 0.6)},
    {SCATTER(0, equal), FAILING(0.5), OVERLAPPING(0.1, 0.4)},
    {SCATTER(1, beside), FAILING(0.06), OVERLAPPING(0.05, 0.3)},
    {SCATTER(1, deviation_beside), FAILING(0.05), OVERLAPPING(0.05, 0.2)},
    {SCATTER(1, deviation_beside), FAILING(0.3), OVERLAPPING(0.5, 0.7)},
    {SCATTER(0, by_eps), FAILING(-0.2), OVERLAPPING(-0.1, 0.1)},
    {SCATTER(3, by_eps), FAILING(-0.3), OVERLAPPING(-0.3, 0.05)},
};

static void put(struct evidence *e, const struct finding *x, const struct change *change,
                struct pound_estimate to)
{
	if (change->input == IN_SCATTER)
		memcpy((char *)&e->scatter[change->law] + change->part, &to, sizeof to);
	else
		for (int law = 0; law < LAWS; law++)
			for (int f = 0; f < FREQUENCIES; f++)
				if (change->frequency == EVERY || change->frequency == f)
					e->index[x->effect][law][f][x->order][change->input] = to;
}

static const struct finding *named(const char *name)
{
	int j = 0;
	while (j < n_findings && strcmp(findings[j].name, name) != 0)
		j++;
	assert_true(j < n_findings);
	return &findings[j];
}

static void check_outcome(const struct finding *x, const struct evidence *e, enum outcome expected)
{
	int cases[OUTCOMES];
	enum outcome outcome = finding_judge(x, e, cases);
	if (outcome != expected)
		fail_msg("%d, %s: %s (%d, %d, %d), not %s", x->section, x->name, outcome_name(outcome), cases[HOLDS],
		         cases[FAILS], cases[UNDECIDED], outcome_name(expected));
	assert_int_equal(cases[HOLDS] + cases[FAILS] + cases[UNDECIDED],
	                 (x->laws[1] - x->laws[0] + 1) * (x->frequencies[1] - x->frequencies[0] + 1));
}

static void each_finding(void **state)
{
	(void)state;
	assert_int_equal(sizeof changes / sizeof changes[0], n_findings);
	for (int j = 0; j < n_findings; j++) {
		struct evidence e = as_published();
		check_outcome(&findings[j], &e, HOLDS);
		put(&e, &findings[j], &changes[j], changes[j].fails);
		check_outcome(&findings[j], &e, FAILS);
		e = as_published();
		put(&e, &findings[j], &changes[j], changes[j].undecided);
		check_outcome(&findings[j], &e, UNDECIDED);
	}
}

static void without_intervals_nothing_is_decided(void **state)
{
	(void)state;
	struct evidence e;
	struct pound_estimate *all = (struct pound_estimate *)&e;
	for (size_t k = 0; k < sizeof e / sizeof *all; k++)
		all[k] = (struct pound_estimate){0.5, NAN, NAN};
	for (int j = 0; j < n_findings; j++)
		check_outcome(&findings[j], &e, UNDECIDED);
}

/* "In general, with a few exceptions": in 18 of 24 cells. */
static void exceptions_are_counted(void **state)
{
	(void)state;
	const struct finding *leads = named("the frequency ratio is first");
	struct evidence e = as_published();
	int cases[OUTCOMES];
	for (int law = 0; law < 3; law++)
		for (int f = 0; f < 2; f++)
			e.index[AMPLIFICATION][law][f][TOTAL][F_2] = near_to(0.3);
	assert_int_equal(finding_judge(leads, &e, cases), HOLDS);
	assert_int_equal(cases[HOLDS], 18);
	assert_int_equal(cases[FAILS], 6);
	e.index[AMPLIFICATION][3][0][TOTAL][F_2] = (struct pound_estimate){0.75, 0.65, 0.85};
	assert_int_equal(finding_judge(leads, &e, cases), UNDECIDED);
	assert_int_equal(cases[UNDECIDED], 1);
	e.index[AMPLIFICATION][3][0][TOTAL][F_2] = near_to(0.3);
	assert_int_equal(finding_judge(leads, &e, cases), FAILS);
}

/* An input above all others is not second. */
static void second_is_neither_first_nor_third(void **state)
{
	(void)state;
	const struct finding *second = named("the mass ratio is second");
	static const struct {
		double total;
		enum outcome outcome;
	} totals[] = {{0.9, FAILS}, {0.7, HOLDS}, {0.55, FAILS}, {0.1, FAILS}};
	for (size_t k = 0; k < sizeof totals / sizeof totals[0]; k++) {
		struct evidence e = as_published();
		const struct change mass = {INDEX(MASS, EVERY)};
		put(&e, second, &mass, near_to(totals[k].total));
		check_outcome(second, &e, totals[k].outcome);
	}
}

CHECK_MAIN(cmocka_unit_test(each_finding), cmocka_unit_test(without_intervals_nothing_is_decided),
           cmocka_unit_test(exceptions_are_counted), cmocka_unit_test(second_is_neither_first_nor_third))
