/* findings.h - the findings of the paper on its sensitivity study, and whether indices confirm them.
 *
 * A finding is judged case by case, a case being an oscillator law and a frequency f_1.  A case is decided by 95 %
 * intervals: the finding holds if the intervals are disjoint in the stated order, fails if they are disjoint in another
 * order, and is undecided if they overlap or there is no interval. */
#ifndef FINDINGS_H
#define FINDINGS_H

#include "engine/pound.h"

enum { F_E, F_2, MASS, EPS, INPUTS }; /* inputs of the study, in its order */
enum { LAWS = 4, FREQUENCIES = 6, AT_2_HZ = 2 };
enum effect { AMPLIFICATION, IMPULSE, EFFECTS };
enum order { FIRST, TOTAL, ORDERS };

extern const double findings_f1[FREQUENCIES]; /* [Hz] */

/* The impulse at f_1 = 2 Hz over the inputs' ranges, in terms of its mean. */
struct scatter {
	struct pound_estimate equal, beside; /* mean given f_2 = f_1 +- 0.025 Hz, and 0.2 to 0.4 Hz away */
	struct pound_estimate deviation_equal, deviation_beside; /* deviations given the same */
	struct pound_estimate by_eps;                            /* mean at eps = 0.9 less that at 0.2 */
};

struct evidence {
	struct pound_estimate index[EFFECTS][LAWS][FREQUENCIES][ORDERS][INPUTS];
	struct scatter scatter[LAWS];
};

enum outcome { HOLDS, FAILS, UNDECIDED, OUTCOMES };

struct finding {
	const char *name;     /* what is judged, with its measure */
	const char *sentence; /* of the paper */
	int section;
	enum effect effect;
	enum order order;
	enum outcome (*judge)(const struct evidence *evidence, const struct finding *finding, int law, int f);
	int laws[2], frequencies[2]; /* the cases: first and last */
	double share;                /* fraction of the cases in which it must hold: 1 if the paper says "all" */
};

extern const struct finding findings[];
extern const int n_findings;

const char *outcome_name(enum outcome outcome);

/* Whether a finding holds as a whole; `cases` of each outcome. */
enum outcome finding_judge(const struct finding *finding, const struct evidence *evidence,
                           int cases[OUTCOMES]);

#endif
