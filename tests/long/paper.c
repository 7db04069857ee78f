/* paper.c - the findings of the paper one by one, for several durations of the motions, with and without their noise.
 *
 *   paper [ROWS]     n of the campaigns with noise, 1000 as in the paper; those without noise have twice as many
 *
 * The paper keeps f_e T fixed without giving it, and its indices include the noise of five signals.  Prints Markdown. */
#include "tests/long/paper_campaign.h"

#include <stdio.h>
#include <stdlib.h>

enum { NOISES = 2, DURATIONS = 4 };

static const double cycles[DURATIONS] = {20, 50, 100, 200};
static const char *const noise_names[NOISES] = {"with", "without"};
static const char *const law_names[LAWS] = {"linear", "elastoplastic", "nonlinear elastic",
                                            "origin oriented"};
static const char *const effect_names[EFFECTS] = {"amplification", "impulse"};

static struct campaign campaigns[NOISES][DURATIONS];

/* The header of a table: the texts between bars, then a column for each campaign if requested. */
static void head(const char *texts, bool each_campaign)
{
	int columns = 1;
	for (const char *c = texts; *c; c++)
		columns += *c == '|';
	printf("\n| %s |", texts);
	for (int k = 0; each_campaign && k < NOISES * DURATIONS; k++, columns++)
		printf(" %s noise, f_e T = %g |", noise_names[k / DURATIONS], cycles[k % DURATIONS]);
	printf("\n|");
	for (int k = 0; k < columns; k++)
		printf(" --- |");
	printf("\n");
}

static void judged(void)
{
	printf("## Findings\n\nIn brackets the cases in which a finding holds, fails and is undecided.\n");
	head("section | finding", true);
	for (int j = 0; j < n_findings; j++) {
		printf("| %d, %s | %s |", findings[j].section, effect_names[findings[j].effect], findings[j].name);
		for (int k = 0; k < NOISES * DURATIONS; k++) {
			int cases[OUTCOMES];
			const struct campaign *c = &campaigns[k / DURATIONS][k % DURATIONS];
			enum outcome outcome = finding_judge(&findings[j], &c->evidence, cases);
			printf(" %s (%d, %d, %d) |", outcome_name(outcome), cases[HOLDS], cases[FAILS], cases[UNDECIDED]);
		}
		printf("\n");
	}
	printf("\nThe sentences of the paper:\n\n");
	for (int j = 0; j < n_findings; j++)
		if (j == 0 || findings[j].sentence != findings[j - 1].sentence)
			printf("- %s: \"%s\"\n", findings[j].name, findings[j].sentence);
}

/* Rank of input j by its index, 0 for the largest. */
static int place(const struct pound_estimate *index, int j)
{
	int larger = 0;
	for (int k = 0; k < INPUTS; k++)
		larger += index[k].value > index[j].value;
	return larger;
}

/* The number of the 24 cells in which an input's total has a rank, regardless of the intervals. */
static void places(void)
{
	static const struct {
		const char *name;
		int input, place;
	} rows[] = {{"f_2 first", F_2, 0}, {"m_2/m_1 second", MASS, 1}, {"eps last", EPS, INPUTS - 1}};
	printf("\n## Cells of 24 in which the value of a total of the amplification has its place\n");
	head("place", true);
	for (size_t r = 0; r < sizeof rows / sizeof rows[0]; r++) {
		printf("| %s |", rows[r].name);
		for (int k = 0; k < NOISES * DURATIONS; k++) {
			int count = 0;
			for (int law = 0; law < LAWS; law++)
				for (int f = 0; f < FREQUENCIES; f++)
					count += place(campaigns[k / DURATIONS][k % DURATIONS]
					                   .evidence.index[AMPLIFICATION][law][f][TOTAL],
					               rows[r].input) == rows[r].place;
			printf(" %d |", count);
		}
		printf("\n");
	}
}

static void softest(void)
{
	printf("\n## Totals of the amplification at f_1 = 0.5 Hz, linear\n");
	head("noise | f_e T | f_e | f_2 | m_2/m_1 | eps | share of the noise", false);
	for (int noise = 0; noise < NOISES; noise++)
		for (int t = 0; t < DURATIONS; t++) {
			const struct campaign *c = &campaigns[noise][t];
			const struct pound_estimate *total = c->evidence.index[AMPLIFICATION][0][0][TOTAL];
			printf("| %s | %g |", noise_names[noise], cycles[t]);
			for (int j = 0; j < INPUTS; j++)
				printf(" %.2f [%.2f, %.2f] |", total[j].value, total[j].low, total[j].high);
			printf(" %.2f |\n", c->noise_share[AMPLIFICATION][0][0]);
		}
}

static void scatterplots(void)
{
	printf("\n## Impulse at f_1 = 2 Hz over its mean, signals shared by a row\n");
	head("law | f_e T | mean at f_2 = f_1 +- 0.025 Hz | mean 0.2 to 0.4 Hz away | deviation at f_2 = f_1 | "
	     "deviation 0.2 to 0.4 Hz away | growth from eps = 0.2 to 0.9",
	     false);
	for (int law = 0; law < LAWS; law++)
		for (int t = 0; t < DURATIONS; t++) {
			const struct scatter *s = &campaigns[1][t].evidence.scatter[law];
			const struct pound_estimate columns[] = {s->equal, s->beside, s->deviation_equal,
			                                         s->deviation_beside, s->by_eps};
			printf("| %s | %g |", law_names[law], cycles[t]);
			for (size_t k = 0; k < sizeof columns / sizeof columns[0]; k++)
				printf(" %.2f [%.2f, %.2f] |", columns[k].value, columns[k].low, columns[k].high);
			printf("\n");
		}
}

static void totals(int t)
{
	printf("\n## Totals at f_e T = %g, with the noise / without it, and the share of the noise\n", cycles[t]);
	head("law | f_1 [Hz] | amplification: f_e | f_2 | m_2/m_1 | eps | noise | "
	     "impulse: f_e | f_2 | m_2/m_1 | eps | noise",
	     false);
	for (int law = 0; law < LAWS; law++)
		for (int f = 0; f < FREQUENCIES; f++) {
			printf("| %s | %g |", law_names[law], findings_f1[f]);
			for (int effect = 0; effect < EFFECTS; effect++) {
				for (int j = 0; j < INPUTS; j++)
					printf(" %.2f / %.2f |", campaigns[0][t].evidence.index[effect][law][f][TOTAL][j].value,
					       campaigns[1][t].evidence.index[effect][law][f][TOTAL][j].value);
				printf(" %.2f |", campaigns[0][t].noise_share[effect][law][f]);
			}
			printf("\n");
		}
}

int main(int argc, char **argv)
{
	int rows = argc > 1 ? atoi(argv[1]) : 1000;
	for (int noise = 0; noise < NOISES; noise++)
		for (int t = 0; t < DURATIONS; t++)
			campaign_run(&(struct campaign_plan){cycles[t], noise == 0, noise == 0 ? rows : 2 * rows},
			             &campaigns[noise][t]);
	printf("n = %d with the noise, %d without it\n\n", rows, 2 * rows);
	judged();
	places();
	softest();
	scatterplots();
	for (int t = 0; t < DURATIONS; t++)
		totals(t);
	return 0;
}
