/* show.c - one function per kind of study, all within 80 columns. */
#include "client/show.h"

#include "client/cell.h"
#include "client/command.h"
#include "client/indices_table.h"
#include "client/summary.h"
#include "client/table.h"
#include "schema/json/json_pointer.h"
#include "schema/result/result_json.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum {
	PEAKS = 12,       /* shown peaks of a spectrum; the JSON has all */
	MODES = 3,        /* shown modes of a building; the table "modes" has all */
	CSV_COLUMNS = 32, /* shown columns of a named table; the CSV has all */
	CSV_CELL = 256,
};

/* The outputs of a cell. */
static void print_outputs(const struct reading *result, const char *at)
{
	const char *name;
	putchar('\n');
	for (int i = 0; (name = reading_member(result, i, "%s/outputs", at)); i++) {
		double value = reading_number(result, "%s/outputs/%s", at, name);
		printf(isfinite(value) ? "%s %.6g\n" : "%s -\n", name, value);
	}
}

/* The signals and outputs of a cell of two oscillators; `at` is its JSON Pointer in the result. */
static void print_pairs(const struct reading *result, const char *at)
{
	static const char *const columns[] = {"signal",      "body",     "u_max_m",   "u_free_m",
	                                      "force_n",     "yield_m",  "demand",    "demand_free",
	                                      "impulse_n_s", "contacts", "contact_s", NULL};
	static const char *const own[] = {
	    "displacement_max_m", "displacement_max_free_m", "force_max_n", "yield_displacement_m", "demand",
	    "demand_free"};
	static const char *const both[] = {"impulse_max_n_s", "contact_count", "contact_time_s"};
	struct table *table = table_open(2, columns);
	char signal[64], body[96];
	cell_failed(result, at);
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
	print_outputs(result, at);
}

/* The first modes of each building. */
static void print_modes(const struct reading *result, const char *at)
{
	static const char *const columns[] = {"building", "mode", "T_s", "f_hz", "mass ratio", "damping", NULL};
	static const char *const members[] = {
	    "building", "mode", "period_s", "frequency_hz", "effective_mass_ratio", "damping_ratio"};
	if (reading_count(result, "%s/modes", at) == 0) // a result of version 0.22 or earlier
		return;
	struct table *table = table_open(2, columns);
	for (int k = 0; k < reading_count(result, "%s/modes", at); k++)
		for (size_t m = 0; m < sizeof members / sizeof members[0]; m++)
			if (reading_number(result, "%s/modes/%d/mode", at, k) <= MODES)
				table_number(table, reading_number(result, "%s/modes/%d/%s", at, k, members[m]));
	putchar('\n');
	table_prose(0, "first modes with the initial stiffness: period, frequency, effective modal mass over the "
	               "building's mass, damping ratio");
	table_print(table, 2);
	table_close(table);
}

/* Mean over the signals of the size of a member of a story or the floor above it; `place`: its JSON Pointer in a signal. */
static double mean_of(const struct reading *result, const char *at, const char *place, const char *name)
{
	const int n = reading_count(result, "%s/signals", at);
	double sum = 0;
	for (int s = 0; s < n; s++)
		sum += fabs(reading_number(result, "%s/signals/%d/%s/%s", at, s, place, name));
	return sum / n;
}

/* The storeys of a row and the floors above them, as means over the signals; the JSON has each signal.  Stories that never yield
 * have no demand, and no column of it if none does; likewise the residual drift if it is 0 everywhere. */
static void print_storeys(const struct reading *result, const char *at)
{
	static const char *const columns[] = {"building", "story",   "drift_m", "free_m", "drift/h", "demand",
	                                      "residual", "shear_n", "a_m_s2",  "a_free", NULL};
	static const struct {
		const char *list, *name;
	} members[] = {{"storeys", "drift_max_m"},          {"storeys", "drift_max_free_m"},
	               {"storeys", "drift_ratio_max"},      {"storeys", "demand"},
	               {"storeys", "residual_drift_m"},     {"storeys", "shear_max_n"},
	               {"floors", "acceleration_max_m_s2"}, {"floors", "acceleration_max_free_m_s2"}};
	enum { RESIDUAL = 4 };
	bool rests = false;
	char place[64];
	struct table *table = table_open(2, columns);
	for (int pass = 0; pass < 2; pass++)
		for (int b = 0; b < reading_count(result, "%s/signals/0/buildings", at); b++)
			for (int i = 0; i < reading_count(result, "%s/signals/0/buildings/%d/storeys", at, b); i++) {
				snprintf(place, sizeof place, "buildings/%d/%s/%d", b, members[RESIDUAL].list, i);
				rests |= mean_of(result, at, place, members[RESIDUAL].name) > 0;
				if (pass == 0)
					continue;
				table_number(table, b);
				table_number(table, i + 1);
				for (int m = 0; m < (int)(sizeof members / sizeof members[0]); m++) {
					snprintf(place, sizeof place, "buildings/%d/%s/%d", b, members[m].list, i);
					const double mean = mean_of(result, at, place, members[m].name);
					table_number(table, m == RESIDUAL && !rests ? NAN : mean);
				}
			}
	putchar('\n');
	table_prose(0, "stories, each with the floor above it: peak values, means over the signals");
	table_print(table, 2);
	table_close(table);
}

static void print_contacts(const struct reading *result, const char *at)
{
	static const char *const columns[] = {"left",     "levels",    "impulse_n_s", "force_n",
	                                      "contacts", "contact_s", "first_m_s",   NULL};
	static const char *const members[] = {"impulse_max_n_s", "force_max_n", "contact_count", "contact_time_s",
	                                      "first_speed_m_s"};
	const int n = reading_count(result, "%s/signals", at);
	struct table *table = table_open(2, columns);
	for (int k = 0; k < reading_count(result, "%s/signals/0/contacts", at); k++) {
		char contact[96], levels[64];
		snprintf(contact, sizeof contact, "%s/signals/0/contacts/%d", at, k);
		snprintf(levels, sizeof levels, "%.4g-%.4g", reading_number(result, "%s/levels/0", contact),
		         reading_number(result, "%s/levels/1", contact));
		table_number(table, reading_number(result, "%s/left_building", contact));
		table_text(table, levels);
		for (size_t m = 0; m < sizeof members / sizeof members[0]; m++) {
			const bool first = strncmp(members[m], "first_", 6) == 0; // no value in signals without contact
			double sum = 0;
			int of = 0;
			for (int s = 0; s < n; s++)
				if (!first ||
				    reading_number(result, "%s/signals/%d/contacts/%d/contact_count", at, s, k) > 0) {
					sum += reading_number(result, "%s/signals/%d/contacts/%d/%s", at, s, k, members[m]);
					of++;
				}
			table_number(table, sum / of);
		}
	}
	putchar('\n');
	table_prose(
	    0, "contacts, means over the signals, first_m_s over the signals with contact (left: index of the "
	       "left building; levels: on the left and on the right building)");
	table_print(table, 2);
	table_close(table);
}

/* The signals and outputs of a cell; `at` is its JSON Pointer in the result. */
static void print_responses(const struct reading *result, const char *at)
{
	if (!reading_has(result, "%s/signals/0/buildings", at)) {
		print_pairs(result, at);
		return;
	}
	cell_failed(result, at);
	print_modes(result, at);
	print_storeys(result, at);
	print_contacts(result, at);
	print_outputs(result, at);
}

/* A response without a sweep has no list of cells: the result itself is the cell. */
static void response(const struct reading *result)
{
	char at[32];
	int n_cells = reading_count(result, "/cells");
	if (n_cells == 0)
		print_responses(result, "");
	for (int cell = 0; cell < n_cells; cell++) {
		snprintf(at, sizeof at, "/cells/%d", cell);
		cell_sweep(result, cell);
		print_responses(result, at);
	}
}

/* Rounds to two significant digits. */
static double two_digits(double value)
{
	char text[32];
	snprintf(text, sizeof text, "%.1e", value);
	return isfinite(value) ? strtod(text, NULL) : NAN;
}

/* The time step or tolerance of a solver as text; NULL: it has neither. */
static const char *setting_of(const struct reading *result, int row, char text[32])
{
	const double step = reading_number(result, "/rows/%d/step_s", row);
	const double tolerance = reading_number(result, "/rows/%d/tolerance", row);
	if (isfinite(step))
		snprintf(text, 32, "%.4g s", step);
	else if (isfinite(tolerance))
		snprintf(text, 32, "%.4g", tolerance);
	else
		return NULL;
	return text;
}

/* Whether a solver was run with time steps; otherwise with tolerances. */
static bool is_stepped(const struct reading *result, const char *method)
{
	bool stepped = false;
	for (int row = 0; row < reading_count(result, "/rows"); row++) {
		const char *of_row = reading_text(result, "/rows/%d/method", row);
		stepped |=
		    of_row && strcmp(of_row, method) == 0 && isfinite(reading_number(result, "/rows/%d/step_s", row));
	}
	return stepped;
}

/* Exponent of the error of each solver.  For a time step it is the observed order; for a tolerance it is not an order. */
static void print_orders(const struct reading *result)
{
	const char *method;
	putchar('\n');
	for (int i = 0; (method = reading_member(result, i, "/orders")); i++) {
		const double order = reading_number(result, "/orders/%s", method);
		if (!isfinite(order))
			continue;
		const bool stepped = is_stepped(result, method);
		// an exponent near 0: only rounding errors remain, which have no order
		const char *setting = stepped ? "step" : "tolerance", *end = stepped ? ", the observed order" : "";
		char *line =
		    fabs(order) < 0.005
		        ? command_text("%s: the history's error does not depend on the %s", method, setting)
		        : command_text("%s: the history's error falls as %s^%.2f%s", method, setting, order, end);
		table_prose(0, line);
		free(line);
	}
}

/* Mean errors of each setting; the JSON and CSV also have the largest errors and the order between rows. */
static void convergence(const struct reading *result)
{
	static const char *const columns[] = {"method",  "setting", "failed", "u_max",   "demand",
	                                      "impulse", "history", "cpu_s",  "x event", NULL};
	static const char *const members[] = {"displacement_error_mean", "demand_error_mean",
	                                      "impulse_error_mean", "history_error_mean"};
	struct table *table = table_open(2, columns);
	const double event = reading_number(result, "/timing/run_cpu_s/0");
	for (int row = 0; row < reading_count(result, "/rows"); row++) {
		char setting[32];
		const double failed = reading_number(result, "/rows/%d/runs_failed", row);
		const double cpu = reading_number(result, "/timing/run_cpu_s/%d", row);
		table_text(table, reading_text(result, "/rows/%d/method", row));
		table_text(table, setting_of(result, row, setting));
		table_number(table, failed > 0 ? failed : NAN);
		for (size_t m = 0; m < sizeof members / sizeof members[0]; m++)
			table_number(table, two_digits(reading_number(result, "/rows/%d/%s", row, members[m])));
		table_number(table, two_digits(cpu));
		table_number(table, two_digits(cpu / event));
	}
	putchar('\n');
	table_prose(0,
	            "Relative errors against the event solver, means over the signals: of the largest "
	            "displacement (u_max), ductility demand and impulse, and of the displacement's history "
	            "over the first seconds of the motion (history_s of the study). setting: time step, or "
	            "tolerance of the adaptive solver. cpu_s: CPU seconds of one run; x event: as a multiple of "
	            "the event solver.");
	table_print(table, 2);
	table_close(table);
	print_orders(result);
}

/* The mean spectra, and the peaks of the first spectrum with the values of Eq. (21) at their frequencies. */
static void floor_spectrum(const struct reading *result)
{
	static const char *const columns[] = {"f_hz", "pounding",   "p16",         "p84",         "impact_only",
	                                      "free", "dirac_line", "dirac_train", "dirac_peaks", NULL};
	static const char *const peaks[] = {"peak_hz", "over f_1", "pounding", "Eq. (21)", "ratio", NULL};
	static const char *const members[] = {"frequency_hz", "frequency_ratio", "mean_m_s2", "dirac_peaks_m_s2",
	                                      "ratio"};
	cell_failed(result, "");
	putchar('\n');
	table_prose(0, "pseudo-acceleration [m/s2]: means over the signals; p16, p84: percentiles of `pounding'");
	struct table *table = table_open(1, columns);
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
	table = table_open(1, peaks);
	for (int j = 0; j < reading_count(result, "/peaks") && j < PEAKS; j++)
		for (size_t m = 0; m < sizeof members / sizeof members[0]; m++)
			table_number(table, reading_number(result, "/peaks/%d/%s", j, members[m]));
	putchar('\n');
	table_prose(0, "peaks of the spectrum with pounding, beside Eq. (21) for ideal pulses every half period; "
	               "f_1: natural "
	               "frequency of the body");
	table_print(table, 2);
	table_close(table);
	putchar('\n');
	table_prose(0, "largest relative error over the frequencies, from runs with half the sample step");
	for (int row = 0; row < reading_count(result, "/accuracy/spectra"); row++)
		printf("  %s %.2g\n", reading_text(result, "/accuracy/spectra/%d/name", row),
		       reading_number(result, "/accuracy/spectra/%d/relative_error_max", row));
}

/* A table of a separation result: an array, and the member of its elements that each column shows. */
struct list {
	const char *members; /* path of the array below the cell, contact or fragility */
	struct {
		const char *head, *member;
	} columns[9]; /* ends with NULL */
};

static const struct list NEEDS[] = {
    {"pounding", {{"gap_m", "gap_m"}, {"P(pounding)", "probability"}, {"95 % from", "low"}, {"to", "high"}}},
    {"gaps", {{"P(pounding)", "probability"}, {"gap_m", "gap_m"}, {"95 % from", "low_m"}, {"to", "high_m"}}},
    {"rules",
     {{"rule", "name"},
      {"gap_m", "gap_m"},
      {"gap/mean", "over_mean"},
      {"P(pounding)", "probability"},
      {"95 % from", "low"},
      {"to", "high"}}},
};
static const struct list FRAGILITY = {"curves",
                                      {{"gap_m", "gap_m"},
                                       {"median", "median"},
                                       {"95 % from", "median_low"},
                                       {"to", "median_high"},
                                       {"dispersion", "dispersion"},
                                       {"95 % from", "dispersion_low"},
                                       {"to", "dispersion_high"},
                                       {"per year", "annual_rate"}}};

static void print_list(const struct reading *result, const char *at, const struct list *list)
{
	const char *heads[sizeof list->columns / sizeof list->columns[0]], *text;
	int n = 0;
	for (; list->columns[n].head; n++)
		heads[n] = list->columns[n].head;
	heads[n] = NULL;
	struct table *table = table_open(1, heads);
	for (int k = 0; k < reading_count(result, "%s/%s", at, list->members); k++)
		for (int j = 0; j < n; j++) {
			const char *member = list->columns[j].member;
			if ((text = reading_text(result, "%s/%s/%d/%s", at, list->members, k, member)))
				table_text(table, text);
			else
				table_number(table, reading_number(result, "%s/%s/%d/%s", at, list->members, k, member));
		}
	table_print(table, 2);
	table_close(table);
}

/* The gap needed in a cell or at a contact, and the gaps that design rules require. */
static void print_needs(const struct reading *result, const char *at)
{
	char *line =
	    command_text("gap needed: mean %.4g m, standard deviation %.4g m, largest of %.0f runs %.4g m",
	                 reading_number(result, "%s/gap_needed/mean_m", at),
	                 reading_number(result, "%s/gap_needed/standard_deviation_m", at),
	                 reading_number(result, "%s/gap_needed/runs", at),
	                 reading_number(result, "%s/gap_needed/largest_m", at));
	putchar('\n');
	table_prose(0, line);
	free(line);
	for (size_t k = 0; k < sizeof NEEDS / sizeof NEEDS[0]; k++) {
		putchar('\n');
		print_list(result, at, &NEEDS[k]);
	}
}

/* The gap needed at a contact of a row of buildings. */
static void print_contact(const struct reading *result, const char *at)
{
	const double left = reading_number(result, "%s/left_building", at);
	printf("\ncontact %.0f: level %.4g of building %.0f and level %.4g of building %.0f\n",
	       reading_number(result, "%s/contact", at), reading_number(result, "%s/levels/0", at), left,
	       reading_number(result, "%s/levels/1", at), left + 1);
	print_needs(result, at);
}

static void print_fragility(const struct reading *result)
{
	char at[32];
	for (int k = 0; k < reading_count(result, "/fragility"); k++) {
		const char *path;
		snprintf(at, sizeof at, "/fragility/%d", k);
		printf("\nfragility over %s", reading_text(result, "%s/intensity", at));
		if (reading_has(result, "%s/contact", at))
			printf(", contact %.0f", reading_number(result, "%s/contact", at));
		for (int s = 0; (path = reading_member(result, s, "%s/sweep", at)); s++)
			printf(", %s", path);
		putchar('\n');
		print_list(result, at, &FRAGILITY);
		for (int p = 0; p < reading_count(result, "%s/return_periods", at); p++)
			printf("return period %.6g years: gap %.4g m (95 %%: %.4g to %.4g m)\n",
			       reading_number(result, "%s/return_periods/%d/return_period_years", at, p),
			       reading_number(result, "%s/return_periods/%d/gap_m", at, p),
			       reading_number(result, "%s/return_periods/%d/low_m", at, p),
			       reading_number(result, "%s/return_periods/%d/high_m", at, p));
	}
}

/* The gaps needed; in a study with inputs also the sensitivity indices. */
static void separation(const struct reading *result)
{
	char at[32];
	for (int cell = 0; cell < reading_count(result, "/cells"); cell++) {
		snprintf(at, sizeof at, "/cells/%d", cell);
		if (reading_has(result, "/cells/1"))
			cell_sweep(result, cell);
		cell_failed(result, at);
		if (!reading_has(result, "%s/contacts", at))
			print_needs(result, at);
		for (int k = 0; k < reading_count(result, "%s/contacts", at); k++) {
			char contact[64];
			snprintf(contact, sizeof contact, "%s/contacts/%d", at, k);
			print_contact(result, contact);
		}
		if (!reading_has(result, "%s/outputs/0", at))
			print_outputs(result, at);
	}
	print_fragility(result);
	if (reading_has(result, "/cells/0/outputs/0")) {
		putchar('\n');
		summary_print(result);
	}
}

/* Requested and executed work, failures, and work left out with the reason. */
static void print_work(const struct reading *result)
{
	static const char *const columns[] = {"work", "requested", "computed", NULL};
	struct table *table = table_open(1, columns);
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
		const double runs = reading_number(result, "/work/failures/%d/runs", i);
		printf("  %.0f run%s failed: ", runs, runs == 1 ? "" : "s");
		table_say(what);
		putchar('\n');
	}
	for (int i = 0; (what = reading_text(result, "/work/left_out/%d", i)); i++) {
		char *line = command_text("left out: %s", what);
		table_prose(2, line);
		free(line);
	}
}

/* Warnings about settings that are valid but probably not intended. */
static void print_warnings(const struct reading *result)
{
	const char *what;
	for (int i = 0; (what = reading_text(result, "/warnings/%d/detail", i)); i++) {
		char *line = command_text("warning: %s: %s", reading_text(result, "/warnings/%d/pointer", i), what);
		if (i == 0)
			putchar('\n');
		table_prose(0, line);
		free(line);
	}
}

/* Name, kind and seed of the study, and its computing time. */
static void print_head(const struct reading *result, const char *kind)
{
	const char *name = reading_text(result, "/name"), *seed = reading_text(result, "/seed");
	if (name)
		table_prose(0, name);
	// a seed of 2^53 or more is a string, because a JSON number would round it
	printf("%s study, seed ", kind);
	if (seed)
		table_say(seed);
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
	bool alone; /* print without print_head and print_work */
} KINDS[] = {
	{"sensitivity",    summary_print,    true},
	{"given_data",     given_data_print, true},
	{"response",       response,         false},
	{"convergence",    convergence,      false},
	{"floor_spectrum", floor_spectrum,   false},
	{"separation",     separation,       false},
};
// clang-format on

/* Prints a result with the function of its kind; false: unknown kind. */
static bool print_kind(const struct reading *result, const char *kind)
{
	for (size_t i = 0; i < sizeof KINDS / sizeof KINDS[0]; i++)
		if (strcmp(kind, KINDS[i].kind) == 0) {
			if (!KINDS[i].alone)
				print_head(result, kind);
			KINDS[i].print(result);
			if (!KINDS[i].alone)
				print_work(result);
			print_warnings(result);
			return true;
		}
	return false;
}

/* Whether a column of a named table identifies its line. */
static bool is_key(const char *head)
{
	static const char *const keys[] = {"contact", "signal", "building", "storey", "mode"};
	for (size_t k = 0; k < sizeof keys / sizeof keys[0]; k++)
		if (strcmp(head, keys[k]) == 0)
			return true;
	return head[0] == '/';
}

/* Reads the header of CSV.  n_keys: number of leading columns that identify a line (sweep paths, signal, place). */
static int heads_of(const char *csv, const char *end, char heads[CSV_COLUMNS + 1][CSV_CELL],
                    const char *names[CSV_COLUMNS + 1], int *n_keys)
{
	int n = 0;
	char sign = ',';
	for (*n_keys = 0; sign == ',' && n < CSV_COLUMNS; n++) {
		csv += result_csv_cell(csv, end, heads[n], CSV_CELL, &sign);
		names[n] = heads[n];
		*n_keys += is_key(heads[n]) && *n_keys == n;
	}
	names[n] = NULL;
	return n;
}

/* Prints CSV as a table, with numbers rounded for reading. */
static void print_csv(const char *csv, const char *end)
{
	char heads[CSV_COLUMNS + 1][CSV_CELL], cell[CSV_CELL], sign, *rest;
	const char *names[CSV_COLUMNS + 1];
	int n_keys, n = heads_of(csv, end, heads, names, &n_keys);
	struct table *table = table_open(n_keys > 0 ? n_keys : 1, names);
	bool head = true;
	while (csv < end) {
		int column = 0;
		do {
			csv += result_csv_cell(csv, end, cell, sizeof cell, &sign);
			const double number = *cell ? strtod(cell, &rest) : NAN;
			if (head || column++ >= n)
				continue;
			if (!*cell || !*rest)
				table_number(table, number);
			else
				table_text(table, cell);
		} while (sign == ',');
		head = false;
	}
	table_print(table, 2);
	table_close(table);
}

/* Prints the named table of a result; false: the result does not have it. */
static bool print_named(const struct reading *result, const char *json, size_t length, const char *name)
{
	size_t n;
	if (indices_print_table(result, name))
		return true;
	// a line of a signal has a column for each number of each story and contact, too many for a screen
	const char *first = reading_has(result, "/cells") ? "/cells/0" : "";
	if (strcmp(name, "signals") == 0 && reading_has(result, "%s/signals/0/buildings", first)) {
		table_prose(0, "stories and the floors above them, of each signal");
		print_named(result, json, length, "storeys");
		puts("\ncontacts, of each signal");
		return print_named(result, json, length, "contacts");
	}
	char *csv = command_sure(result_to_csv(json, length, name, &n));
	if (n > 0)
		print_csv(csv, csv + n);
	free(csv);
	return n > 0;
}

/* Prints everything in a result. */
static bool print_all(const struct reading *result, const char *kind)
{
	if (strcmp(kind, "sensitivity") != 0) {
		const bool shown = print_kind(result, kind);
		if (reading_has(result, "/design"))
			indices_print(result);
		return shown;
	}
	print_head(result, kind);
	indices_print(result);
	print_work(result);
	print_warnings(result);
	return true;
}

/* Prints a result, or one table of it.
 *
 * Test     client_tables: one_table_of_a_result_is_shown_by_its_name
 */
static enum outcome show_table(const char *json, size_t length, const char *table)
{
	struct reading *result = reading_open(json, length);
	const char *kind = result ? reading_text(result, "/kind") : NULL;
	bool shown = kind && (!table                      ? print_kind(result, kind)
	                      : strcmp(table, "all") == 0 ? print_all(result, kind)
	                                                  : print_named(result, json, length, table));
	if (!shown && table && kind)
		command_complain("this result has no table '%s'", table);
	else if (!shown)
		command_complain("no table for a result of kind '%s'", kind ? kind : "?");
	reading_close(result);
	return shown ? OUTCOME_OK : OUTCOME_FAILED;
}

static enum outcome show_csv(const char *json, size_t length, const char *table)
{
	size_t n;
	char *csv = result_to_csv(json, length, table, &n);
	bool shown = csv && (n > 0 || !table);
	if (shown)
		fwrite(csv, 1, n, stdout);
	else if (csv)
		command_complain("this result has no table '%s'", table);
	else
		command_complain("out of memory");
	free(csv);
	return shown ? OUTCOME_OK : OUTCOME_FAILED;
}

/* Prints a result, or its table named by --table, in the format of --format. */
enum outcome show_result(const char *json, size_t n, const struct options *options)
{
	if (strcmp(options->format, "table") == 0)
		return show_table(json, n, options->table);
	if (strcmp(options->format, "csv") == 0)
		return show_csv(json, n, options->table);
	fwrite(json, 1, n, stdout);
	return OUTCOME_OK;
}
