/* paper_campaign.h - the paper's campaign: 24 cells of six frequencies f_1 and four laws, its runs and its evidence. */
#ifndef PAPER_CAMPAIGN_H
#define PAPER_CAMPAIGN_H

#include "tests/support/findings.h"

/* With the noise of five signals: the paper's protocol, new signals for every sample and raw indices.  Without it:
 * a row's samples share their signals, and the indices are those of the mean over infinitely many. */
struct campaign_plan {
	double cycles; /* f_e T */
	bool noise;
	int rows;
};

struct campaign {
	struct campaign_plan plan;
	struct evidence evidence;
	double noise_share[EFFECTS][LAWS][FREQUENCIES];
};

/* Runs the example study `paper` with the settings of a plan, on all cores; progress goes to stderr.  Exits on failure. */
void campaign_run(const struct campaign_plan *plan, struct campaign *campaign);

#endif
