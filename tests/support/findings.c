#include "tests/support/findings.h"

#include <assert.h>
#include <math.h>

const double findings_f1[FREQUENCIES] = {0.5, 1, 2, 3, 4, 5};

/* Thresholds for terms that the paper does not quantify: */
static const double GENERAL = 0.75;     /* "in general, with a few exceptions": share of the cases */
static const double ALL = 1.0;          /* "in all cases" */
static const double NARROW = 0.1;       /* "narrow": half-width of an interval */
static const double SIGNIFICANT = 0.05; /* "significant difference": between two indices */
static const double QUARTER = 0.25;     /* "important", "considerable": index of each of four equal inputs */
static const double ALIKE = 2.0;        /* "comparable": largest over smallest */
static const double MUCH = 2.0;         /* "considerable growth", "much less": a ratio */

/* ---- intervals; comparisons with missing values are false ---- */

static bool below(struct pound_estimate a, struct pound_estimate b)
{
	return a.high < b.low;
}

static struct pound_estimate times(double factor, struct pound_estimate e)
{
	assert(factor > 0.0);
	return (struct pound_estimate){factor * e.value, factor * e.low, factor * e.high};
}

static struct pound_estimate exactly(double value)
{
	return (struct pound_estimate){value, value, value};
}

/* Adds the bounds: valid for the sum with any dependence between the two errors. */
static struct pound_estimate sum(struct pound_estimate a, struct pound_estimate b)
{
	return (struct pound_estimate){a.value + b.value, a.low + b.low, a.high + b.high};
}

static struct pound_estimate difference(struct pound_estimate a, struct pound_estimate b)
{
	return (struct pound_estimate){a.value - b.value, a.low - b.high, a.high - b.low};
}

static struct pound_estimate magnitude(struct pound_estimate e)
{
	if (e.high < 0.0)
		return (struct pound_estimate){-e.value, -e.high, -e.low};
	if (e.low < 0.0)
		return (struct pound_estimate){fabs(e.value), 0.0, fmax(-e.low, e.high)};
	return e;
}

static enum outcome decided(bool holds, bool fails)
{
	return holds ? HOLDS : fails ? FAILS : UNDECIDED;
}

/* The statement that a is less than b. */
static enum outcome less(struct pound_estimate a, struct pound_estimate b)
{
	return decided(below(a, b), below(b, a));
}

/* The statement that a and b both hold. */
static enum outcome both(enum outcome a, enum outcome b)
{
	return decided(a == HOLDS && b == HOLDS, a == FAILS || b == FAILS);
}

/* ---- ranks ---- */

static const struct pound_estimate *indices(const struct evidence *e, const struct finding *x, int law, int f)
{
	return e->index[x->effect][law][f][x->order];
}

/* Counts the inputs whose intervals are entirely above, and entirely below, the interval of input j. */
static void rank(const struct pound_estimate *index, int j, int *above, int *under)
{
	*above = *under = 0;
	for (int k = 0; k < INPUTS; k++) {
		*above += below(index[j], index[k]);
		*under += below(index[k], index[j]);
	}
}

/* The statement that input j has this rank, 0 for the largest index. */
static enum outcome at_place(const struct pound_estimate *index, int j, int place)
{
	int above, under;
	rank(index, j, &above, &under);
	return decided(above == place && under == INPUTS - 1 - place,
	               above > place || under > INPUTS - 1 - place);
}

static enum outcome frequency_leads(const struct evidence *e, const struct finding *x, int law, int f)
{
	return at_place(indices(e, x, law, f), F_2, 0);
}

static enum outcome mass_second(const struct evidence *e, const struct finding *x, int law, int f)
{
	return at_place(indices(e, x, law, f), MASS, 1);
}

static enum outcome mass_leads(const struct evidence *e, const struct finding *x, int law, int f)
{
	return at_place(indices(e, x, law, f), MASS, 0);
}

static enum outcome eps_last(const struct evidence *e, const struct finding *x, int law, int f)
{
	return at_place(indices(e, x, law, f), EPS, INPUTS - 1);
}

static enum outcome mass_and_frequency_lead(const struct evidence *e, const struct finding *x, int law, int f)
{
	const struct pound_estimate *index = indices(e, x, law, f);
	enum outcome of_f_e = both(less(index[F_E], index[F_2]), less(index[F_E], index[MASS]));
	return both(of_f_e, both(less(index[EPS], index[F_2]), less(index[EPS], index[MASS])));
}

/* "Not one of the predominant": neither the largest nor the second largest index. */
static enum outcome eps_not_among_first(const struct evidence *e, const struct finding *x, int law, int f)
{
	int above, under;
	rank(indices(e, x, law, f), EPS, &above, &under);
	return decided(above >= 2, under >= INPUTS - 2);
}

/* ---- sizes ---- */

static enum outcome narrow(const struct evidence *e, const struct finding *x, int law, int f)
{
	const struct pound_estimate *index = indices(e, x, law, f);
	enum outcome all = HOLDS;
	for (int j = 0; j < INPUTS; j++) {
		double half = (index[j].high - index[j].low) / 2;
		all = both(all, decided(half <= NARROW, half > NARROW));
	}
	return all;
}

static enum outcome alike(const struct evidence *e, const struct finding *x, int law, int f)
{
	const struct pound_estimate *index = indices(e, x, law, f);
	enum outcome all = HOLDS;
	for (int j = 0; j < INPUTS; j++)
		for (int k = 0; k < INPUTS; k++)
			if (j != k)
				all = both(all, less(index[j], times(ALIKE, index[k])));
	return all;
}

static enum outcome eps_falls(const struct evidence *e, const struct finding *x, int law, int f)
{
	return less(indices(e, x, law, f)[EPS], indices(e, x, law, f - 1)[EPS]);
}

static enum outcome excitation_grows(const struct evidence *e, const struct finding *x, int law, int f)
{
	struct pound_estimate here = indices(e, x, law, f)[F_E], softest = indices(e, x, law, 0)[F_E];
	return both(less(softest, here), less(exactly(QUARTER), here));
}

/* ---- interactions ---- */

static struct pound_estimate interaction(const struct evidence *e, enum effect effect, int law, int f, int j)
{
	const struct pound_estimate(*index)[INPUTS] = e->index[effect][law][f];
	return difference(index[TOTAL][j], index[FIRST][j]);
}

static enum outcome totals_differ(const struct evidence *e, const struct finding *x, int law, int f)
{
	enum outcome all = HOLDS;
	for (int j = 0; j < INPUTS; j++)
		all = both(all, less(exactly(SIGNIFICANT), interaction(e, x->effect, law, f, j)));
	return all;
}

static enum outcome interactions_important(const struct evidence *e, const struct finding *x, int law, int f)
{
	struct pound_estimate alone = exactly(0.0);
	for (int j = 0; j < INPUTS; j++)
		alone = sum(alone, e->index[x->effect][law][f][FIRST][j]);
	return less(alone, exactly(1.0 - QUARTER));
}

static enum outcome interactions_less(const struct evidence *e, const struct finding *x, int law, int f)
{
	struct pound_estimate apart[EFFECTS] = {exactly(0.0), exactly(0.0)};
	(void)x;
	for (int j = 0; j < INPUTS; j++)
		for (int k = 0; k < EFFECTS; k++)
			apart[k] = sum(apart[k], interaction(e, k, law, f, j));
	return less(apart[IMPULSE], apart[AMPLIFICATION]);
}

/* ---- scatterplots at f_1 = 2 Hz ---- */

static enum outcome vanishes(const struct evidence *e, const struct finding *x, int law, int f)
{
	(void)x, (void)f;
	return less(e->scatter[law].equal, exactly(QUARTER));
}

static enum outcome grows_beside(const struct evidence *e, const struct finding *x, int law, int f)
{
	(void)x, (void)f;
	return less(times(MUCH, e->scatter[law].equal), e->scatter[law].beside);
}

static enum outcome scatters_beside(const struct evidence *e, const struct finding *x, int law, int f)
{
	(void)x, (void)f;
	return less(e->scatter[law].deviation_equal, e->scatter[law].deviation_beside);
}

static enum outcome scatters_more(const struct evidence *e, const struct finding *x, int law, int f)
{
	(void)x, (void)f;
	return less(e->scatter[0].deviation_beside, e->scatter[law].deviation_beside);
}

static enum outcome grows_with_eps(const struct evidence *e, const struct finding *x, int law, int f)
{
	(void)x, (void)f;
	return less(exactly(0.0), e->scatter[law].by_eps);
}

static enum outcome grows_much_less(const struct evidence *e, const struct finding *x, int law, int f)
{
	(void)x, (void)f;
	return less(times(MUCH, magnitude(e->scatter[law].by_eps)), e->scatter[0].by_eps);
}

/* ---- the table ---- */

static const char INTERACTIONS[] = "significant difference is noticed between first order sensitivity "
                                   "indices and total sensitivity indices of all "
                                   "input variables. Interactions between variables have an important "
                                   "contribution to the output variability";
static const char LEADERS[] =
    "In general, with a few exceptions, the frequency ratio of the two oscillators is the variable with the "
    "highest "
    "total sensitivity index for all constitutive laws, the mass ratio coming in second position";
static const char COMPARABLE[] =
    "In the case oscillator 1 has a low frequency (in particular when f_1 = 0.5 Hz) all input variables have "
    "comparable total sensitivity indices";
static const char MOST_INFLUENTIAL[] =
    "the mass and frequency ratios are, in general, the most influential parameters";
static const char PREDOMINANT[] =
    "In all cases, when the frequency of the oscillator of interest is less than "
    "2 Hz the influence of the mass ratio is predominant";
static const char CONSIDERABLE[] = "in the case of elastoplastic oscillators the influence of the "
                                   "dimensionless excitation frequency ratio becomes "
                                   "considerable with increasing frequency of the oscillator of interest";
static const char NEAR_ONE[] =
    "The mean maximum impact impulse remains small in the vicinity of omega_2/omega_1 = 1 "
    "but it exhibits considerable growth rate while scattering increases, especially in "
    "the case of nonlinear constitutive law";

#define EVERY_LAW   \
	{               \
		0, LAWS - 1 \
	}
#define EVERY_F1           \
	{                      \
		0, FREQUENCIES - 1 \
	}
#define ONLY_2_HZ        \
	{                    \
		AT_2_HZ, AT_2_HZ \
	}

// clang-format off
const struct finding findings[] = {
    {"intervals of the totals are narrow (at most 0.1 to either side)",
     "these bounds are quite narrow and thus it is concluded that the accuracy of the results is quite satisfactory",
     5, AMPLIFICATION, TOTAL, narrow, EVERY_LAW, EVERY_F1, ALL},
    {"the total of every input is above its first-order index, by 0.05 or more", INTERACTIONS,
     5, AMPLIFICATION, TOTAL, totals_differ, EVERY_LAW, EVERY_F1, GENERAL},
    {"interactions are important: the first-order indices add up to less than 0.75", INTERACTIONS,
     5, AMPLIFICATION, FIRST, interactions_important, EVERY_LAW, EVERY_F1, GENERAL},
    {"the frequency ratio is first", LEADERS,
     5, AMPLIFICATION, TOTAL, frequency_leads, EVERY_LAW, EVERY_F1, GENERAL},
    {"the mass ratio is second", LEADERS,
     5, AMPLIFICATION, TOTAL, mass_second, EVERY_LAW, EVERY_F1, GENERAL},
    {"all four are comparable at 0.5 Hz (within a factor of 2)", COMPARABLE,
     5, AMPLIFICATION, TOTAL, alike, EVERY_LAW, {0, 0}, ALL},
    {"all four are comparable at 1 Hz", COMPARABLE,
     5, AMPLIFICATION, TOTAL, alike, EVERY_LAW, {1, 1}, ALL},
    {"the restitution is last", "the restitution coefficient is the less influential parameter in all cases",
     5, AMPLIFICATION, TOTAL, eps_last, EVERY_LAW, EVERY_F1, ALL},
    {"the total of the restitution falls from each f_1 to the next, up to 3 Hz",
     "its influence diminishes with increasing frequency of oscillator 1 up to 3 Hz",
     5, AMPLIFICATION, TOTAL, eps_falls, EVERY_LAW, {1, 3}, ALL},

    {"mass and frequency ratio are the first two", MOST_INFLUENTIAL,
     6, IMPULSE, TOTAL, mass_and_frequency_lead, EVERY_LAW, EVERY_F1, GENERAL},
    {"the same by first-order indices",
     "The above trends hold for both first order and total sensitivity indices",
     6, IMPULSE, FIRST, mass_and_frequency_lead, EVERY_LAW, EVERY_F1, GENERAL},
    {"the mass ratio is first below 2 Hz", PREDOMINANT,
     6, IMPULSE, TOTAL, mass_leads, EVERY_LAW, {0, 1}, ALL},
    {"the same by first-order indices", PREDOMINANT,
     6, IMPULSE, FIRST, mass_leads, EVERY_LAW, {0, 1}, ALL},
    {"elastoplastic, 4 and 5 Hz: the excitation frequency is above its total at 0.5 Hz, and above 0.25", CONSIDERABLE,
     6, IMPULSE, TOTAL, excitation_grows, {1, 1}, {4, 5}, ALL},
    {"the same by first-order indices", CONSIDERABLE,
     6, IMPULSE, FIRST, excitation_grows, {1, 1}, {4, 5}, ALL},
    {"interactions are less than for the amplification",
     "their differences are smaller than that in the previous section. This implies that the interaction effects are "
     "less considerable",
     6, IMPULSE, TOTAL, interactions_less, EVERY_LAW, EVERY_F1, GENERAL},
    {"the restitution is neither first nor second",
     "the coefficient of restitution seems not to be one of the predominant parameters",
     6, IMPULSE, TOTAL, eps_not_among_first, EVERY_LAW, EVERY_F1, ALL},

    {"2 Hz, linear and elastoplastic: the mean varies more with mass and frequency ratio than with the others",
     "the mean maximum impact impulse exhibits higher variability when it is conditioned on m_2/m_1 and on "
     "omega_2/omega_1",
     6, IMPULSE, FIRST, mass_and_frequency_lead, {0, 1}, ONLY_2_HZ, ALL},
    {"2 Hz, linear and elastoplastic: the mean is less than a quarter of its average at f_2 = f_1",
     "the maximum impact impulse is zero for omega_2/omega_1 = 1",
     6, IMPULSE, FIRST, vanishes, {0, 1}, ONLY_2_HZ, ALL},
    {"2 Hz, linear and elastoplastic: it is more than twice that 0.2 to 0.4 Hz away", NEAR_ONE,
     6, IMPULSE, FIRST, grows_beside, {0, 1}, ONLY_2_HZ, ALL},
    {"2 Hz, linear and elastoplastic: it scatters more there", NEAR_ONE,
     6, IMPULSE, FIRST, scatters_beside, {0, 1}, ONLY_2_HZ, ALL},
    {"2 Hz, elastoplastic: it scatters more there than the linear one's", NEAR_ONE,
     6, IMPULSE, FIRST, scatters_more, {1, 1}, ONLY_2_HZ, ALL},
    {"2 Hz, linear: the mean grows with the restitution",
     "in the case of elastic impacting structures, the mean maximum impact impulse increases with increasing eps",
     6, IMPULSE, FIRST, grows_with_eps, {0, 0}, ONLY_2_HZ, ALL},
    {"2 Hz, nonlinear: it changes much less (under half)",
     "in the case of elastoplastic oscillators (and nonlinear oscillators, in general, though not shown in Figure 10) "
     "the mean maximum impact impulse is much less sensitive to the value of eps",
     6, IMPULSE, FIRST, grows_much_less, {1, LAWS - 1}, ONLY_2_HZ, ALL},
};
// clang-format on
const int n_findings = sizeof findings / sizeof findings[0];

const char *outcome_name(enum outcome outcome)
{
	static const char *const names[OUTCOMES] = {"holds", "fails", "undecided"};
	return names[outcome];
}

enum outcome finding_judge(const struct finding *x, const struct evidence *e, int cases[OUTCOMES])
{
	for (int k = 0; k < OUTCOMES; k++)
		cases[k] = 0;
	for (int law = x->laws[0]; law <= x->laws[1]; law++)
		for (int f = x->frequencies[0]; f <= x->frequencies[1]; f++)
			cases[x->judge(e, x, law, f)]++;
	int n = cases[HOLDS] + cases[FAILS] + cases[UNDECIDED];
	return decided(cases[HOLDS] >= x->share * n, cases[HOLDS] + cases[UNDECIDED] < x->share * n);
}
