/* paper.c - the paper's campaign, 24 cells of six frequencies f_1 by four laws, and its findings one by one.
 *
 *   paper [ROWS]     the example study `paper` with its noise new for every sample, and again with common noise
 *
 * Findings on indexes are checked with common noise: new noise for every sample adds its share to every total index,
 * which finding 5 is about.  The indexes are the raw ones, by the paper's protocol.  Prints markdown; the status is 0
 * when every finding comes out but those known not to.  ROWS other than 1000 is for trials. */
#include <assert.h>
#include <math.h>
#include <pthread.h>
#include <stdatomic.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "engine/pound.h"
#include "schema/examples/examples.h"
#include "schema/json/problems.h"
#include "schema/study/study_json.h"

enum { F_E, F_2, MASS, EPS, INPUTS }; /* inputs of the study, in its order */
enum { LAWS = 4, FREQUENCIES = 6, THREADS_MAX = 64 };
enum { BINS = 45 }; /* of f_2, 0.1 Hz wide */

static const char *const law_names[LAWS] = {"linear", "elastoplastic", "nonlinear elastic",
                                            "origin oriented"};
static const double f1[FREQUENCIES] = {0.5, 1, 2, 3, 4, 5}; /* [Hz] */

struct campaign {
	struct pound_study *study;
	struct pound_run *run;
	const struct pound_result *result;
	atomic_int next;
};

/* ---- running ---- */

struct worker {
	struct campaign *campaign;
	int number;
	bool reducing;
	pthread_t thread;
};

static void *work(void *argument)
{
	const struct worker *worker = argument;
	struct pound_run *run = worker->campaign->run;
	int n = worker->reducing ? pound_run_reductions(run) : pound_run_blocks(run);
	for (int j; (j = atomic_fetch_add(&worker->campaign->next, 1)) < n;) {
		enum pound_status status = worker->reducing ? pound_run_reduce(run, j, worker->number)
		                                            : pound_run_block(run, j, worker->number);
		if (status) {
			fprintf(stderr, "paper: %s\n", pound_status_text(status));
			exit(1);
		}
	}
	return NULL;
}

static void work_all(struct campaign *campaign, int n_workers, bool reducing)
{
	struct worker workers[THREADS_MAX];
	atomic_store(&campaign->next, 0);
	for (int j = 0; j < n_workers; j++) {
		workers[j] = (struct worker){.campaign = campaign, .number = j, .reducing = reducing};
		if (pthread_create(&workers[j].thread, NULL, work, &workers[j])) {
			fprintf(stderr, "paper: no thread\n");
			exit(1);
		}
	}
	for (int j = 0; j < n_workers; j++)
		pthread_join(workers[j].thread, NULL);
}

static void campaign_run(struct campaign *campaign, bool common, int rows)
{
	const char *text = example_text("paper");
	struct problems problems = {0};
	campaign->study = study_from_json(text, strlen(text), &problems);
	assert(campaign->study && campaign->study->n_inputs == INPUTS);
	campaign->study->design.common_signals = common;
	campaign->study->design.rows = rows;
	int cores = (int)sysconf(_SC_NPROCESSORS_ONLN);
	int n_workers = cores > THREADS_MAX ? THREADS_MAX : cores;
	campaign->run = pound_run_create(campaign->study, n_workers);
	if (!campaign->run) {
		fprintf(stderr, "paper: out of memory\n");
		exit(1);
	}
	work_all(campaign, n_workers, false);
	work_all(campaign, n_workers, true);
	campaign->result = pound_run_result(campaign->run);
	assert(campaign->result->n_cells == LAWS * FREQUENCIES);
}

/* ---- reading ---- */

enum output { AMPLIFICATION, IMPULSE, OUTPUTS };

// the study's output that stands for the amplification depends on the law
static int column(enum output output, int law)
{
	return output == IMPULSE ? 2 : law == 0 ? 0 : 1;
}

static const struct pound_indices *indices(const struct campaign *c, int law, int f, enum output output)
{
	return &c->result->cells[law * FREQUENCIES + f].indices[column(output, law)];
}

static int largest(const struct pound_estimate *e)
{
	int best = 0;
	for (int j = 1; j < INPUTS; j++)
		if (e[j].value > e[best].value)
			best = j;
	return best;
}

static int smallest(const struct pound_estimate *e)
{
	int best = 0;
	for (int j = 1; j < INPUTS; j++)
		if (e[j].value < e[best].value)
			best = j;
	return best;
}

static bool overlap(const struct pound_estimate *a, const struct pound_estimate *b)
{
	return a->low <= b->high && b->low <= a->high;
}

/* ---- tables ---- */

static void table(const struct campaign *c, const char *title)
{
	printf("\n### %s\n\n", title);
	printf("| law | f_1 [Hz] | amplification: f_e | f_2 | m_2/m_1 | eps | noise | "
	       "impulse: f_e | f_2 | m_2/m_1 | eps | noise |\n");
	printf("| --- | --- | --- | --- | --- | --- | --- | --- | --- | --- | --- | --- |\n");
	for (int law = 0; law < LAWS; law++)
		for (int f = 0; f < FREQUENCIES; f++) {
			printf("| %s | %g |", law_names[law], f1[f]);
			for (int o = 0; o < OUTPUTS; o++) {
				const struct pound_indices *x = indices(c, law, f, o);
				int first = largest(x->index[POUND_ST_RAW]);
				for (int j = 0; j < INPUTS; j++)
					printf(j == first ? " **%.2f** |" : " %.2f |", x->index[POUND_ST_RAW][j].value);
				printf(" %.2f |", x->noise_share);
			}
			printf("\n");
		}
}

static bool verdict(bool holds, const char *claim)
{
	printf("- %s: %s\n", holds ? "PASS" : "FAIL", claim);
	return holds;
}

/* A claim that this model does not bear out, with what it shows instead. */
static void differs(bool holds, const char *claim, const char *instead)
{
	printf("- %s: %s%s%s\n", holds ? "PASS" : "DIFFERS", claim, holds ? "" : "; ", holds ? "" : instead);
}

/* ---- the findings of the paper ---- */

// 1: what leads the amplification
static bool amplification(const struct campaign *c)
{
	int led = 0, close = 0, last = 0;
	struct pound_estimate eps = {0};
	for (int f = 0; f < FREQUENCIES; f++)
		for (int law = 0; law < LAWS; law++) {
			const struct pound_estimate *t = indices(c, law, f, AMPLIFICATION)->index[POUND_ST_RAW];
			led += law == 0 && f1[f] >= 2 && largest(t) == F_2;
			close += law > 0 && f1[f] >= 2 && overlap(&t[F_2], &t[F_E]);
			last += f1[f] >= 1 && smallest(t) == EPS;
			if (f1[f] >= 3 && t[EPS].value > eps.value)
				eps = t[EPS];
		}
	printf(
	    "\n**1.** Linear, f_1 >= 2 Hz: f_2 has the largest total index of the amplification in %d of 4 "
	    "cells. "
	    "Nonlinear, f_1 >= 2 Hz: the intervals of f_2 and f_e overlap in %d of 12. f_1 >= 1 Hz: eps has the "
	    "smallest in %d of 20; at 3 Hz and beyond it is at most %.3f (%.3f to %.3f).\n\n",
	    led, close, last, eps.value, eps.low, eps.high);
	bool all =
	    verdict(led == 4, "the frequency ratio leads the amplification of linear oscillators from 2 Hz");
	all &= verdict(close == 12, "for nonlinear oscillators it and f_e are close");
	all &= verdict(last == 20, "eps is last from 1 Hz up");
	return verdict(eps.low < 0.05,
	               "no total index of eps is above 0.05 at 3 Hz and beyond, beyond its interval") &&
	       all;
}

// 2: what leads the impulse
static bool impulse(const struct campaign *c)
{
	int led = 0;
	for (int law = 0; law < LAWS; law++)
		for (int f = 0; f1[f] < 2; f++)
			led += largest(indices(c, law, f, IMPULSE)->index[POUND_ST_RAW]) == MASS;
	printf("\n**2.** f_1 < 2 Hz: the mass ratio has the largest total index of the impulse in %d of 8 cells. "
	       "Elastoplastic, total of f_e:",
	       led);
	bool low = true, high = true;
	for (int f = 0; f < FREQUENCIES; f++) {
		struct pound_estimate t = indices(c, 1, f, IMPULSE)->index[POUND_ST_RAW][F_E];
		printf(" %.2f (%.2f to %.2f) at %g Hz%s", t.value, t.low, t.high, f1[f],
		       f + 1 < FREQUENCIES ? "," : ".\n\n");
		low &= f1[f] > 1 || (t.low < 0.15 && t.high > 0.05);
		high &= f1[f] < 4 || (t.low < 0.5 && t.high > 0.4);
	}
	bool all = verdict(led == 8, "the mass ratio leads the impulse below 2 Hz for every law");
	all &= verdict(low, "f_e for elastoplastic oscillators is about 0.1 at 0.5 and 1 Hz");
	return verdict(high, "and 0.4 to 0.5, within its interval, at 4 and 5 Hz") && all;
}

// 3: interactions
static bool interactions(const struct campaign *c)
{
	double apart[OUTPUTS] = {0};
	int more = 0;
	for (int law = 0; law < LAWS; law++)
		for (int f = 0; f < FREQUENCIES; f++) {
			double here[OUTPUTS] = {0};
			for (int o = 0; o < OUTPUTS; o++)
				for (int j = 0; j < INPUTS; j++) {
					const struct pound_indices *x = indices(c, law, f, o);
					here[o] += (x->index[POUND_ST_RAW][j].value - x->index[POUND_S1_RAW][j].value) / INPUTS;
				}
			for (int o = 0; o < OUTPUTS; o++)
				apart[o] += here[o] / (LAWS * FREQUENCIES);
			more += here[AMPLIFICATION] > here[IMPULSE];
		}
	printf("\n**3.** Total less first-order index, mean over the inputs and cells: %.3f for the "
	       "amplification, %.3f "
	       "for the impulse; larger for the amplification in %d of 24 cells.\n\n",
	       apart[AMPLIFICATION], apart[IMPULSE], more);
	return verdict(
	    apart[AMPLIFICATION] > apart[IMPULSE] && more >= 20,
	    "total and first-order indexes lie further apart for the amplification than for the impulse");
}

/* Conditional means of the impulse: over all samples whose input lies in a bin.
 *
 * Given    low, width       of the first bin
 *          n                bins
 * Returns  mean      (n)    NAN: no sample
 */
static void conditional(const struct campaign *c, int law, int f, int input, double low, double width, int n,
                        double *mean)
{
	int count[BINS] = {0};
	for (int bin = 0; bin < n; bin++)
		mean[bin] = 0;
	for (int row = 0; row < c->study->design.rows; row++)
		for (int sample = 0; sample < pound_run_samples(c->run); sample++) {
			double x[INPUTS], value, variance;
			pound_run_sample_inputs(c->run, row, sample, x);
			pound_run_sample_output(c->run, law * FREQUENCIES + f, row, sample, column(IMPULSE, law), &value,
			                        &variance);
			int bin = (int)floor((x[input] - low) / width);
			if (bin >= 0 && bin < n) {
				mean[bin] += value;
				count[bin]++;
			}
		}
	for (int bin = 0; bin < n; bin++)
		mean[bin] = count[bin] ? mean[bin] / count[bin] : NAN;
}

// a row of a table of conditional means, those of n of its bins
static void means_row(const char *head, const double *value, const int *bins, int n)
{
	printf("| %s |", head);
	for (int k = 0; k < n; k++)
		printf(" %.2f |", value[bins[k]]);
	printf("\n");
}

// a table of conditional means of the impulse for linear and elastoplastic oscillators
static void means_table(const char *input, double low, double width, double mean[2][BINS], const int *bins,
                        int n)
{
	double middle[BINS];
	for (int k = 0; k < BINS; k++)
		middle[k] = low + (k + 0.5) * width;
	printf("\n");
	means_row(input, middle, bins, n);
	for (int k = 0; k <= n; k++)
		printf("| --- ");
	printf("|\n");
	for (int law = 0; law < 2; law++)
		means_row(law_names[law], mean[law], bins, n);
}

// 4: scatterplots at 2 Hz, Figure 10
static bool scatter(const struct campaign *c)
{
	enum { AT_2_HZ = 2, TENTHS = 10, WIDTHS = 3 };
	static const double widths[WIDTHS] = {0.2, 0.1, 0.05}; /* of bins about f_2 = f_1 [Hz] */
	static const int shown[] = {0, 5, 10, 12, 14, 15, 16, 18, 20, 25, 35, 44}; /* of the bins of f_2 */
	static const int tenths[TENTHS] = {0, 1, 2, 3, 4, 5, 6, 7, 8, 9};
	double growth[2], near[2][WIDTHS], f[2][BINS], e[2][BINS];
	bool vanishes = true;
	for (int law = 0; law < 2; law++) {
		double all;
		conditional(c, law, AT_2_HZ, EPS, 0, 1.0001, 1, &all);
		conditional(c, law, AT_2_HZ, EPS, 0, 0.1, TENTHS, e[law]);
		conditional(c, law, AT_2_HZ, F_2, 0.45, 0.1, BINS, f[law]);
		for (int w = 0; w < WIDTHS; w++) {
			conditional(c, law, AT_2_HZ, F_2, f1[AT_2_HZ] - widths[w] / 2, widths[w], 1, &near[law][w]);
			near[law][w] /= all;
			vanishes &= w == 0 || near[law][w] < near[law][w - 1];
		}
		growth[law] = (e[law][8] + e[law][9] - e[law][1] - e[law][2]) / 2;
	}
	printf("\n**4.** f_1 = 2 Hz, conditional mean of the impulse:\n");
	means_table("f_2 [Hz]", 0.45, 0.1, f, shown, sizeof shown / sizeof shown[0]);
	means_table("eps", 0, 0.1, e, tenths, TENTHS);
	printf(
	    "\nOver its mean, within 0.1, 0.05 and 0.025 Hz of f_2 = f_1: %.2f, %.2f, %.2f (linear), %.2f, %.2f, "
	    "%.2f "
	    "(elastoplastic). From eps = 0.1-0.3 to 0.8-1 it grows by %.2f and %.2f. (Below 0.1 plastic contacts "
	    "last long, and their impulse holds the bodies' pushing on each other.)\n\n",
	    near[0][0], near[0][1], near[0][2], near[1][0], near[1][1], near[1][2], growth[0], growth[1]);
	vanishes &= near[0][WIDTHS - 1] < 0.2 && near[1][WIDTHS - 1] < 0.2;
	bool all = verdict(vanishes, "the conditional mean impulse vanishes at f_2 = f_1");
	all &= verdict(growth[0] > 0, "it grows with eps for linear oscillators");
	all &= verdict(growth[1] < growth[0], "and less for elastoplastic ones");
	differs(growth[1] < 0.5 * growth[0], "much less, under half",
	        "both grow by a fifth to a third of themselves");
	return all;
}

// 5: the case with its noise and without it, side by side; whether both kinds of signals then tell the same
static bool noise_apart(const struct pound_indices *independent, const struct pound_indices *common)
{
	static const char *const names[INPUTS] = {"f_e", "f_2", "m_2/m_1", "eps"};
	static const enum pound_index shown[] = {POUND_S1_RAW, POUND_S1_PICK_FREEZE, POUND_S1,
	                                         POUND_ST_RAW, POUND_ST_PICK_FREEZE, POUND_ST};
	const struct pound_indices *both[] = {independent, common};
	printf("\nf_1 = 0.5 Hz, linear oscillators, amplification:\n\n| signals | input | S1_raw | "
	       "S1_pick_freeze | S1 | "
	       "ST_raw | ST_pick_freeze | ST |\n| --- | --- | --- | --- | --- | --- | --- | --- |\n");
	for (int k = 0; k < 2; k++)
		for (int j = 0; j < INPUTS; j++) {
			printf("| %s | %s |", k ? "common" : "independent", names[j]);
			for (size_t c = 0; c < sizeof shown / sizeof shown[0]; c++) {
				const struct pound_estimate *e = &both[k]->index[shown[c]][j];
				printf(" %.2f [%.2f, %.2f] |", e->value, e->low, e->high);
			}
			printf("\n");
		}
	bool agree = true, below = true;
	for (int j = 0; j < INPUTS; j++) {
		const struct pound_estimate *total[] = {independent->index[POUND_ST], common->index[POUND_ST]};
		agree &= overlap(&total[0][j], &total[1][j]);
		agree &= overlap(&independent->index[POUND_S1][j], &common->index[POUND_S1][j]);
		for (int k = 0; k < 2; k++)
			below &= (j != F_2 && j != EPS) || total[k][j].value < total[k][F_E].low;
	}
	printf("\n");
	bool all = verdict(
	    agree, "without the noise S1 and ST are the same for both kinds of signals, within their intervals");
	return verdict(below,
	               "the totals are then not comparable: those of f_2 and eps lie below f_e's interval") &&
	       all;
}

// 5: the softest oscillator and the noise of five-signal means
static bool softest(const struct campaign *independent, const struct campaign *common)
{
	printf("\n**5.** f_1 = 0.5 Hz, amplification, total indexes (f_e, f_2, m_2/m_1, eps) and the noise's "
	       "share:\n\n");
	bool close = true, leads = true;
	for (int law = 0; law < LAWS; law++) {
		const struct pound_indices *i = indices(independent, law, 0, AMPLIFICATION);
		const struct pound_indices *j = indices(common, law, 0, AMPLIFICATION);
		printf("- %s: independent %.2f %.2f %.2f %.2f, noise %.2f; common %.2f %.2f %.2f %.2f, noise %.2f\n",
		       law_names[law], i->index[POUND_ST_RAW][F_E].value, i->index[POUND_ST_RAW][F_2].value,
		       i->index[POUND_ST_RAW][MASS].value, i->index[POUND_ST_RAW][EPS].value, i->noise_share,
		       j->index[POUND_ST_RAW][F_E].value, j->index[POUND_ST_RAW][F_2].value,
		       j->index[POUND_ST_RAW][MASS].value, j->index[POUND_ST_RAW][EPS].value, j->noise_share);
		close &= i->index[POUND_ST_RAW][largest(i->index[POUND_ST_RAW])].value <
		         2 * i->index[POUND_ST_RAW][smallest(i->index[POUND_ST_RAW])].value;
		bool ahead = largest(j->index[POUND_ST_RAW]) == F_E;
		for (int k = 0; k < INPUTS; k++)
			ahead &= k == F_E || j->index[POUND_ST_RAW][k].value < 0.8 * j->index[POUND_ST_RAW][F_E].value;
		leads &= ahead;
	}
	printf("\n");
	bool all = verdict(close, "with independent signals all four total indexes lie within a factor of two");
	all &= verdict(leads, "with common signals f_e leads by more than a fifth");
	return noise_apart(indices(independent, 0, 0, AMPLIFICATION), indices(common, 0, 0, AMPLIFICATION)) &&
	       all;
}

int main(int argc, char **argv)
{
	int rows = argc > 1 ? atoi(argv[1]) : 1000;
	struct campaign independent, common;
	campaign_run(&independent, false, rows);
	campaign_run(&common, true, rows);
	table(&independent, "Total indexes, new noise for every sample (the paper)");
	table(&common, "Total indexes, a row's samples share their noise");
	printf("\n### Findings\n");
	bool all = amplification(&common);
	all &= impulse(&common);
	all &= interactions(&common);
	all &= scatter(&common);
	all &= softest(&independent, &common);
	for (int k = 0; k < 2; k++) {
		struct campaign *c = k ? &common : &independent;
		pound_run_free(c->run);
		study_free(c->study);
	}
	return all ? 0 : 1;
}
