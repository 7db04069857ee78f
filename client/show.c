/* show.c - one function per kind of study, all within 100 columns.
 *
 * A sensitivity result has one block for each cell and output:
 *
 *   /oscillators/0/frequency_hz = 2
 *   force_amplification: mean 1.071, variance 0.02893, noise share 0.113
 *     input    S1 [95 % interval]       ST [95 % interval]       ST from 0 to 1
 *     f_e       0.101 [ 0.021,  0.180]   0.412 [ 0.351,  0.472]  |########            |
 *     widest interval: +-0.22 of 125 rows, +-0.16 of 250, +-0.11 of 500, +-0.081 of 1000
 *     twice the rows leave 0.71 of it, 4000 rows half of it
 *     300 runs checked, apart by 1e-14 (median) to 2e-13: no index moves by over 3e-15
 */
#include "client/show.h"

#include "client/table.h"
#include "schema/reading.h"
#include "schema/result_json.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { PEAKS = 12 }; /* of a spectrum, the first ones; all are in the JSON */
enum { CHART = 20 }; /* columns of the chart of total indexes */

/* " 0.412 [ 0.351,  0.472]" of the three numbers, "-" where there is none. */
static void interval(char *text, size_t size, const struct reading *result, const char *input,
                     const char *index)
{
	static const char *const ends[] = {"", "_low", "_high"};
	char part[3][16];
	for (int i = 0; i < 3; i++) {
		double value = reading_number(result, "%s/%s%s", input, index, ends[i]);
		snprintf(part[i], sizeof part[i], isfinite(value) ? "%6.3f" : "     -", value);
	}
	snprintf(text, size, "%s [%s, %s]", part[0], part[1], part[2]);
}

static void chart(char text[CHART + 3], double share)
{
	long full = isfinite(share) ? lround(fmin(fmax(share, 0.0), 1.0) * CHART) : 0;
	text[0] = '|';
	memset(text + 1, ' ', CHART);
	memset(text + 1, '#', (size_t)full);
	strcpy(text + 1 + CHART, "|");
}

static void print_tame(const char *text)
{
	char tame[200];
	snprintf(tame, sizeof tame, "%s", text ? text : "");
	table_tame(tame);
	fputs(tame, stdout);
}

/* "name 0.1234" after a comma; nothing where there is no value. */
static void print_measure(const struct reading *result, const char *output, const char *member,
                          const char *name, const char *before)
{
	double value = reading_number(result, "%s/%s", output, member);
	if (isfinite(value))
		printf("%s%s %.4g", before, name, value);
}

/* A member's name as it stands in a JSON Pointer: ~ is ~0, / is ~1. */
static void pointer_token(char *token, size_t size, const char *name)
{
	size_t n = 0;
	for (; *name && n + 2 < size; name++) {
		if (*name == '/' || *name == '~')
			token[n++] = '~';
		token[n++] = *name == '/' ? '1' : *name == '~' ? '0' : *name;
	}
	token[n] = '\0';
}

static void print_sweep(const struct reading *result, int cell)
{
	const char *path;
	for (int i = 0; (path = reading_member(result, i, "/cells/%d/sweep", cell)); i++) {
		fputs(i ? ", " : "\n", stdout);
		print_tame(path);
		char token[400];
		pointer_token(token, sizeof token, path);
		const char *text = reading_text(result, "/cells/%d/sweep/%s", cell, token);
		fputs(" = ", stdout);
		if (text)
			print_tame(text);
		else
			printf("%.10g", reading_number(result, "/cells/%d/sweep/%s", cell, token));
	}
	if (reading_count(result, "/cells/%d/sweep", cell))
		putchar('\n');
}

/* Runs of a cell without a result; `at` is where it stands in the result. */
static void print_failed(const struct reading *result, const char *at)
{
	double failed = reading_number(result, "%s/runs_failed", at);
	double dropped = reading_number(result, "%s/rows_dropped", at);
	if (failed > 0.0)
		printf("\n%.0f of %.0f runs failed", failed, reading_number(result, "%s/runs", at));
	if (failed > 0.0 && dropped > 0.0)
		printf("; %.0f rows of the design are left out", dropped);
	if (failed > 0.0)
		putchar('\n');
}

static void print_indices(const struct reading *result, const char *output)
{
	static const char *const columns[] = {"input", " S1 [95 % interval]", " ST [95 % interval]",
	                                      "ST from 0 to 1", NULL};
	struct table *table = table_open(columns);
	char input[96], text[64];
	for (int j = 0; j < reading_count(result, "%s/inputs", output); j++) {
		snprintf(input, sizeof input, "%s/inputs/%d", output, j);
		const char *name = reading_text(result, "%s/name", input);
		table_text(table, name ? name : reading_text(result, "%s/path", input));
		interval(text, sizeof text, result, input, "S1");
		table_text(table, text);
		interval(text, sizeof text, result, input, "ST");
		table_text(table, text);
		chart(text, reading_number(result, "%s/ST", input));
		table_text(table, text);
	}
	table_print(table, 2);
	table_close(table);
}

/* The widest half of the intervals of one number of rows. */
static double widest(const struct reading *result, const char *accuracy, int level)
{
	static const char *const halves[] = {"S1_half_widths", "ST_half_widths"};
	double most = NAN;
	for (int j = 0; j < reading_count(result, "%s/inputs", accuracy); j++)
		for (int h = 0; h < 2; h++)
			most = fmax(most, reading_number(result, "%s/inputs/%d/%s/%d", accuracy, j, halves[h], level));
	return most;
}

/* How far the indexes of an output may be off. */
static void print_accuracy(const struct reading *result, const char *output)
{
	char accuracy[80];
	const char *before = "  widest interval: ", *of = " rows";
	snprintf(accuracy, sizeof accuracy, "%s/accuracy", output);
	for (int k = 0; k < reading_count(result, "%s/rows", accuracy); k++, before = ", ", of = "") {
		double half = widest(result, accuracy, k);
		if (!isfinite(half))
			return;
		printf("%s+-%.2g of %.0f%s", before, half, reading_number(result, "%s/rows/%d", accuracy, k), of);
	}
	double slope = reading_number(result, "%s/slope", accuracy);
	double rows = reading_number(result, "%s/rows_to_halve", accuracy);
	if (isfinite(rows))
		printf("\n  twice the rows leave %.2g of it, %.0f rows half of it", exp2(slope), rows);
	putchar('\n');
	double checked = reading_number(result, "%s/runs_checked", accuracy);
	double change = reading_number(result, "%s/errors/integration", accuracy);
	if (checked > 0.0)
		printf("  %.0f runs checked", checked);
	if (isfinite(change))
		printf(", apart by %.2g (median) to %.2g: no index moves by over %.2g",
		       reading_number(result, "%s/difference_median", accuracy),
		       reading_number(result, "%s/difference_largest", accuracy), change);
	if (checked > 0.0)
		putchar('\n');
	const char *note = reading_text(result, "%s/note", accuracy);
	if (note) {
		fputs("  ", stdout);
		print_tame(note);
		putchar('\n');
	}
}

/* What more and fewer rows cost. */
static void print_cost(const struct reading *result)
{
	const char *before = "\n  CPU time: ";
	if (!reading_has(result, "/timing"))
		return;
	for (int k = 0; k < reading_count(result, "/timing/rows"); k++, before = ", ")
		printf("%s%.2g s for %.0f rows", before, reading_number(result, "/timing/rows/%d/cpu_s", k),
		       reading_number(result, "/timing/rows/%d/rows", k));
	putchar('\n');
}

/* How an ordinate of a floor spectrum goes with the largest impulse. */
static void print_correlation(const struct reading *result, const char *output)
{
	double correlation = reading_number(result, "%s/impulse_correlation", output);
	if (isfinite(correlation))
		printf("  correlation with the largest impulse %.3f [%.3f, %.3f]\n", correlation,
		       reading_number(result, "%s/impulse_correlation_low", output),
		       reading_number(result, "%s/impulse_correlation_high", output));
}

/* The rows that a design grew to, or that there are so far. */
static void print_rows(const struct reading *result)
{
	static const char *const members[] = {"/stopping", "/partial"};
	for (int k = 0; k < 2; k++) {
		const char *note = reading_text(result, "%s/note", members[k]);
		if (!note)
			continue;
		printf("\n%.0f rows: ", reading_number(result, "%s/rows", members[k]));
		print_tame(note);
		putchar('\n');
	}
}

static void sensitivity(const struct reading *result)
{
	char output[64];
	print_rows(result);
	for (int cell = 0; cell < reading_count(result, "/cells"); cell++) {
		snprintf(output, sizeof output, "/cells/%d", cell);
		print_sweep(result, cell);
		print_failed(result, output);
		for (int o = 0; o < reading_count(result, "/cells/%d/outputs", cell); o++) {
			snprintf(output, sizeof output, "/cells/%d/outputs/%d", cell, o);
			putchar('\n');
			print_tame(reading_text(result, "%s/name", output));
			print_measure(result, output, "frequency_hz", "at", " ");
			if (isfinite(reading_number(result, "%s/frequency_hz", output)))
				fputs(" Hz", stdout);
			print_measure(result, output, "mean", "mean", ": ");
			print_measure(result, output, "variance", "variance", ", ");
			print_measure(result, output, "noise_share", "noise share", ", ");
			putchar('\n');
			print_correlation(result, output);
			print_indices(result, output);
			print_accuracy(result, output);
		}
	}
	print_cost(result);
}

/* The signals and outputs of a cell; `at` is where it stands in the result. */
static void print_responses(const struct reading *result, const char *at)
{
	static const char *const columns[] = {"signal",      "oscillator", "u_max_m",   "u_free_m",
	                                      "force_n",     "yield_m",    "demand",    "demand_free",
	                                      "impulse_n_s", "contacts",   "contact_s", NULL};
	static const char *const own[] = {
	    "displacement_max_m", "displacement_max_free_m", "force_max_n", "yield_displacement_m", "demand",
	    "demand_free"};
	static const char *const both[] = {"impulse_max_n_s", "contact_count", "contact_time_s"};
	struct table *table = table_open(columns);
	char signal[64], body[96];
	print_failed(result, at);
	for (int s = 0; s < reading_count(result, "%s/signals", at); s++) {
		snprintf(signal, sizeof signal, "%s/signals/%d", at, s);
		for (int o = 0; o < reading_count(result, "%s/oscillators", signal); o++) {
			snprintf(body, sizeof body, "%s/oscillators/%d", signal, o);
			table_number(table, reading_number(result, "%s/index", signal));
			table_text(table, o ? "right" : "left");
			for (size_t m = 0; m < sizeof own / sizeof own[0]; m++)
				table_number(table, reading_number(result, "%s/%s", body, own[m]));
			for (size_t m = 0; m < sizeof both / sizeof both[0]; m++)
				table_number(table, o ? NAN : reading_number(result, "%s/%s", signal, both[m]));
		}
	}
	putchar('\n');
	table_print(table, 2);
	table_close(table);
	const char *name;
	putchar('\n');
	for (int i = 0; (name = reading_member(result, i, "%s/outputs", at)); i++) {
		double value = reading_number(result, "%s/outputs/%s", at, name);
		printf(isfinite(value) ? "%s %.6g\n" : "%s -\n", name, value);
	}
}

/* A response without a sweep is its one cell itself. */
static void response(const struct reading *result)
{
	char at[32];
	int n_cells = reading_count(result, "/cells");
	if (n_cells == 0)
		print_responses(result, "");
	for (int cell = 0; cell < n_cells; cell++) {
		snprintf(at, sizeof at, "/cells/%d", cell);
		print_sweep(result, cell);
		print_responses(result, at);
	}
}

/* The mean errors of each setting; the largest ones are in the JSON and the CSV. */
static void convergence(const struct reading *result)
{
	static const char *const columns[] = {"method",  "step_s",  "tol",   "failed", "u_max",   "demand",
	                                      "impulse", "history", "order", "cpu_s",  "x event", NULL};
	static const char *const members[] = {"displacement_error_mean", "demand_error_mean",
	                                      "impulse_error_mean", "history_error_mean", "order"};
	struct table *table = table_open(columns);
	double event = reading_number(result, "/timing/run_cpu_s/0");
	for (int row = 0; row < reading_count(result, "/rows"); row++) {
		double failed = reading_number(result, "/rows/%d/runs_failed", row);
		double cpu = reading_number(result, "/timing/run_cpu_s/%d", row);
		table_text(table, reading_text(result, "/rows/%d/method", row));
		table_number(table, reading_number(result, "/rows/%d/step_s", row));
		table_number(table, reading_number(result, "/rows/%d/tolerance", row));
		table_number(table, failed > 0 ? failed : NAN);
		for (size_t m = 0; m < sizeof members / sizeof members[0]; m++)
			table_number(table, reading_number(result, "/rows/%d/%s", row, members[m]));
		table_number(table, cpu);
		table_number(table, cpu / event);
	}
	puts("\nrelative errors against the first row, means over the signals; cpu_s of one run");
	table_print(table, 2);
	table_close(table);
	const char *method, *before = "\norder over all settings: ";
	for (int i = 0; (method = reading_member(result, i, "/orders")); i++) {
		double order = reading_number(result, "/orders/%s", method);
		if (!isfinite(order))
			continue;
		printf("%s%s %.2f", before, method, order);
		before = ", ";
	}
	putchar('\n');
}

/* The mean spectra, and the peaks of the first beside what Eq. (21) has there. */
static void floor_spectrum(const struct reading *result)
{
	static const char *const columns[] = {"f_hz", "pounding",   "p16",         "p84",         "impact_only",
	                                      "free", "dirac_line", "dirac_train", "dirac_peaks", NULL};
	static const char *const peaks[] = {"peak_hz", "over f_1", "pounding", "Eq. (21)", "ratio", NULL};
	static const char *const members[] = {"frequency_hz", "frequency_ratio", "mean_m_s2", "dirac_peaks_m_s2",
	                                      "ratio"};
	print_failed(result, "");
	puts("\npseudo-acceleration [m/s2], means over the signals, of the first 16 and 84 % too");
	struct table *table = table_open(columns);
	for (int k = 0; k < reading_count(result, "/frequencies_hz"); k++) {
		table_number(table, reading_number(result, "/frequencies_hz/%d", k));
		for (int row = 0; row < reading_count(result, "/spectra"); row++) {
			table_number(table, reading_number(result, "/spectra/%d/mean_m_s2/%d", row, k));
			if (row > 0)
				continue;
			table_number(table, reading_number(result, "/spectra/%d/p16_m_s2/%d", row, k));
			table_number(table, reading_number(result, "/spectra/%d/p84_m_s2/%d", row, k));
		}
	}
	table_print(table, 2);
	table_close(table);
	table = table_open(peaks);
	for (int j = 0; j < reading_count(result, "/peaks") && j < PEAKS; j++)
		for (size_t m = 0; m < sizeof members / sizeof members[0]; m++)
			table_number(table, reading_number(result, "/peaks/%d/%s", j, members[m]));
	puts("\npeaks of the spectrum with pounding, beside those of pulses every half period");
	table_print(table, 2);
	table_close(table);
	puts("\nlargest relative error over the frequencies, from the same on half the sample step");
	for (int row = 0; row < reading_count(result, "/accuracy/spectra"); row++)
		printf("  %s %.2g\n", reading_text(result, "/accuracy/spectra/%d/name", row),
		       reading_number(result, "/accuracy/spectra/%d/relative_error_max", row));
}

/* What was asked and what was run, and why not all of it. */
static void print_work(const struct reading *result)
{
	static const char *const columns[] = {"work", "asked", "run", NULL};
	struct table *table = table_open(columns);
	const char *stage, *what;
	if (!reading_has(result, "/work")) {
		table_close(table);
		return;
	}
	for (int i = 0; (stage = reading_member(result, i, "/work")); i++) {
		if (!(what = reading_text(result, "/work/%s/what", stage)))
			continue;
		table_text(table, what);
		table_number(table, reading_number(result, "/work/%s/asked", stage));
		table_number(table, reading_number(result, "/work/%s/run", stage));
	}
	putchar('\n');
	table_print(table, 2);
	table_close(table);
	for (int i = 0; (what = reading_text(result, "/work/failures/%d/reason", i)); i++) {
		printf("  failed: %.0f of the runs: ", reading_number(result, "/work/failures/%d/runs", i));
		print_tame(what);
		putchar('\n');
	}
	for (int i = 0; (what = reading_text(result, "/work/left_out/%d", i)); i++) {
		fputs("  left out: ", stdout);
		print_tame(what);
		putchar('\n');
	}
}

/* What study it is, and what it took. */
static void print_head(const struct reading *result, const char *kind)
{
	const char *name = reading_text(result, "/name"), *seed = reading_text(result, "/seed");
	if (name) {
		print_tame(name);
		putchar('\n');
	}
	// a seed from 2^53 on is a text
	printf("%s study, seed ", kind);
	if (seed)
		print_tame(seed);
	else
		printf("%.0f", reading_number(result, "/seed"));
	if (reading_has(result, "/timing"))
		printf(", %.3g s with %.0f threads, %.3g s of CPU time", reading_number(result, "/timing/wall_s"),
		       reading_number(result, "/timing/threads"), reading_number(result, "/timing/cpu_s"));
	putchar('\n');
}

// clang-format off
static const struct {
	const char *kind;
	void (*print)(const struct reading *);
} KINDS[] = {
	{"sensitivity", sensitivity},
	{"response",    response},
	{"convergence", convergence},
	{"floor_spectrum", floor_spectrum},
};
// clang-format on

/* Prints a result by its kind. */
enum outcome show_result(const char *json, size_t length)
{
	struct reading *result = reading_open(json, length);
	const char *kind = result ? reading_text(result, "/kind") : NULL;
	enum outcome outcome = OUTCOME_FAILED;
	for (size_t i = 0; kind && i < sizeof KINDS / sizeof KINDS[0]; i++)
		if (strcmp(kind, KINDS[i].kind) == 0) {
			print_head(result, kind);
			KINDS[i].print(result);
			print_work(result);
			outcome = OUTCOME_OK;
		}
	if (outcome != OUTCOME_OK)
		command_complain("no table for a result of kind '%s'", kind ? kind : "?");
	reading_close(result);
	return outcome;
}

/* Prints a result as json, table or csv. */
enum outcome show_as(const char *json, size_t n, const char *format)
{
	if (strcmp(format, "table") == 0)
		return show_result(json, n);
	if (strcmp(format, "json") == 0) {
		fwrite(json, 1, n, stdout);
		return OUTCOME_OK;
	}
	char *csv = result_to_csv(json, n, &n);
	if (!csv) {
		command_complain("out of memory");
		return OUTCOME_FAILED;
	}
	fwrite(csv, 1, n, stdout);
	free(csv);
	return OUTCOME_OK;
}
