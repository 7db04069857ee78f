/* Tables and CSV of `pound run`: complete, no wider than a terminal, the summary on one screen. */
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "tests/support/check.h"
#include "tests/support/program.h"
#include "tests/support/study_documents.h"

#define POUND(...) program_run((const char *const[]){"pound", __VA_ARGS__, NULL}, NULL)

// words that the tables of an example must contain; `was` and `is`: a replacement that makes a slow example quick
static const struct {
	const char *example, *holds, *was, *is;
} TABLES[] = {
    {"response", "impulse_n_s", NULL, NULL},
    {"sensitivity_small", "ST  0.329 +-0.374", NULL, NULL},
    {"until", "widest", NULL, NULL},
    {"convergence", "\n  central_difference  0.001 s  ", NULL, NULL},
    {"convergence", "adaptive: the history's error falls as tolerance^1.10\n", NULL, NULL},
    {"convergence_rows", "newmark: the history's error falls as step^1.13, the observed order\n", NULL, NULL},
    {"nonlinear", "contact_s", NULL, NULL},
    {"contact_force", "dirac_peaks", NULL, NULL},
    {"response_sweep", " = ", NULL, NULL},
    {"unequal_heights", "a_free", NULL, NULL},
    {"unequal_heights", "       0     1     0.5      2      0.8528     0.05\n", NULL, NULL},
    {"unequal_heights", "first_m_s over the signals with contact", NULL, NULL},
    {"separation", "P(pounding)", NULL, NULL},
    {"paper", NULL, "\"rows\": 1000", "\"rows\": 40"},
    {"paper_linear", NULL, "\"rows\": 1000", "\"rows\": 60"},
    {"extremes", NULL, "[1e2, 1e4, 1e6, 1e8]", "[1e8]"}};

/* Runs an example; fails if a line of its tables is longer than 80 bytes, or if its words are missing. */
static void check_tables(const char *example, const char *study, const char *table)
{
	struct program_outcome run = program_run((const char *const[]){"pound", "run", "--format", "table", "-",
	                                                               table ? "--table" : NULL, table, NULL},
	                                         study);
	program_expect(&run, 0);
	for (size_t i = 0; i < sizeof TABLES / sizeof TABLES[0] && !table; i++)
		if (strcmp(TABLES[i].example, example) == 0 && TABLES[i].holds && !strstr(run.out, TABLES[i].holds))
			fail_msg("%s: no '%s' in\n%s", example, TABLES[i].holds, run.out);
	for (char *rest, *line = strtok_r(run.out, "\n", &rest); line; line = strtok_r(NULL, "\n", &rest))
		if (strlen(line) > 80)
			fail_msg("%s, --table %s: %s", example, table ? table : "", line);
	program_free(&run);
}

/* Every example with a scene: rows of buildings, errors of solvers, spectra, gaps. */
static void every_table_fits_a_terminal_of_80_columns(void **state)
{
	struct program_outcome names = POUND("example", "--names");
	int n_run = 0;
	(void)state;
	for (char *rest, *name = strtok_r(names.out, "\n", &rest); name; name = strtok_r(NULL, "\n", &rest)) {
		struct program_outcome document = POUND("example", name);
		char *quick = NULL;
		for (size_t i = 0; i < sizeof TABLES / sizeof TABLES[0]; i++)
			if (strcmp(TABLES[i].example, name) == 0 && TABLES[i].was)
				quick = study_documents_with(document.out, TABLES[i].was, TABLES[i].is);
		if (strstr(document.out, "\"scene\"")) {
			check_tables(name, quick ? quick : document.out, NULL);
			check_tables(name, quick ? quick : document.out, "all");
			n_run++;
		}
		free(quick);
		program_free(&document);
	}
	assert_true(n_run >= 29);
	program_free(&names);
}

/* Four inputs, two of them in a ratio, few rows, and an estimator other than the default: a result with every table
 * except `stopping`, which only a growing design has. */
static char *with_every_table(void)
{
	struct program_outcome document = POUND("example", "paper_linear");
	char *study =
	    study_documents_with(document.out, "\"rows\": 1000", "\"rows\": 100, \"estimator\": \"janon\"");
	char *common = study_documents_with(study, "\"independent\"", "\"common\"");
	char *whole =
	    study_documents_with(common, "\"design\":",
	                         "\"ratios\": [{\"name\": \"f_e/f_2\", \"of\": [\"/excitation/frequency_hz\", "
	                         "\"/oscillators/1/frequency_hz\"]}], \"design\":");
	program_free(&document);
	free(study), free(common);
	return whole;
}

/* If the samples of a row share one signal, total indices are undefined: no column, and no bars (they would look like 0). */
static void a_table_has_no_column_for_an_index_that_is_null_throughout(void **state)
{
	(void)state;
	struct program_outcome document =
	    program_run((const char *const[]){"pound", "example", "sensitivity_small", NULL}, NULL);
	char *several = strstr(document.out, "\"signals\": ");
	assert_non_null(several);
	several[strlen("\"signals\": ")] = '1';
	assert_false(several[strlen("\"signals\": 1")] >= '0' && several[strlen("\"signals\": 1")] <= '9');
	struct program_outcome table =
	    program_run((const char *const[]){"pound", "run", "--format", "table", "--table", "all", "-", NULL},
	                document.out);
	program_expect(&table, 0);
	assert_non_null(strstr(table.out, "S1_raw"));
	assert_null(strstr(table.out, "ST ["));
	assert_null(strstr(table.out, "ST from 0 to 1"));
	program_free(&table);
	// the summary gives the reason
	table = program_run((const char *const[]){"pound", "run", "--format", "table", "-", NULL}, document.out);
	assert_non_null(strstr(table.out, "No index has a value.\nthe samples of a row share one signal"));
	assert_null(strstr(table.out, "ST"));
	program_free(&table), program_free(&document);
}

static void a_table_shows_every_estimate_of_a_result_and_its_notes(void **state)
{
	static const char *const words[] = {"S1 [95 % interval]",
	                                    "S1_pick_freeze",
	                                    "ST_raw",
	                                    "S1_janon_corrected",
	                                    "shapley",
	                                    "S2_excitation",
	                                    "\n  inputs",
	                                    "S2",
	                                    "S_closed",
	                                    "f_e/f_2",
	                                    "together these variables explain",
	                                    "bias of the ratio estimator",
	                                    "0 lowest",
	                                    "ST_one_signal",
	                                    "note: f_e: S1_"};
	char *study = with_every_table();
	struct program_outcome table = program_run(
	    (const char *const[]){"pound", "run", "--format", "table", "--table", "all", "-", NULL}, study);
	(void)state;
	program_expect(&table, 0);
	for (size_t k = 0; k < sizeof words / sizeof words[0]; k++)
		if (!strstr(table.out, words[k]))
			fail_msg("'%s' is not in\n%s", words[k], table.out);
	for (char *line = strtok(table.out, "\n"); line; line = strtok(NULL, "\n"))
		if (strlen(line) > 100)
			fail_msg("over 100 columns: %s", line);
	program_free(&table);
	free(study);
}

/* Fails unless a text, with its blank lines, fits on a screen of 24 lines of 80 columns. */
static void check_screen(const char *what, char *text)
{
	int n = 0;
	for (char *line = text, *end; *line; line = *end ? end + 1 : end, n++) {
		int width = 0;
		end = line + strcspn(line, "\n");
		for (const char *c = line; c < end; c++)
			width += ((unsigned char)*c & 0xc0) != 0x80;
		if (width > 80)
			fail_msg("%s: over 80 columns: %.*s", what, (int)(end - line), line);
	}
	if (n > 24)
		fail_msg("%s: %d lines:\n%s", what, n, text);
}

#define OF_TWO   "\"force_amplification\", \"impulse\"]"
#define OF_THREE "\"force_amplification\", \"impulse\", \"peak_displacement_m\"]"
#define OF_EIGHT                                                                        \
	"\"force_amplification\", \"impulse\", \"peak_displacement_m\", \"contact_count\"," \
	"\"contact_time_s\", \"peak_displacement_free_m\", \"peak_displacement_right_m\","  \
	"\"peak_displacement_free_right_m\"]"
#define OF_SIXTEEN                                                                            \
	"\"peak_acceleration_m_s2\", \"peak_acceleration_right_m_s2\", \"peak_contact_force_n\"," \
	"\"peak_acceleration_free_m_s2\", \"peak_acceleration_free_right_m_s2\","                 \
	"\"force_amplification_right\", \"acceleration_amplification\", \"peak_approach_speed_m_s\"," OF_EIGHT

static void a_table_without_a_name_is_a_summary_of_one_screen(void **state)
{
	static const struct {
		const char *example, *was, *is, *words;
	} cases[] = {
	    // a sweep: from the lowest to the highest of 24 cells, both indices of each output
	    {"paper", "\"rows\": 1000", "\"rows\": 40", "lowest to highest over the 24 cells"},
	    {"paper", "\"rows\": 1000", "\"rows\": 40",
	     "\n force_amplification  S1  -0.08..0.35   0.00..0.61  -0.17..0.60  -0.01..0.17\n"
	     "                      ST  -0.03..0.54   0.20..0.43   0.36..0.85  -0.14..0.44\n"},
	    {"spectrum_sensitivity", "\"seed\"", "\"seed\"", "floor_spectrum (8)"},
	    {"spectrum_sensitivity", "\"seed\"", "\"seed\"", "lowest to highest over frequencies (number"},
	    {"two_storeys", "\"seed\"", "\"seed\"", " of 19 inputs, those with the smallest indices;"},
	    // three outputs: both indices; eight outputs: one index, and a line that names the other
	    {"paper_linear", OF_TWO, OF_THREE, "\n force_amplification S1  0.36 +-0.05  0.0"},
	    {"paper_linear", OF_TWO, OF_THREE, "\n                     ST  0.83 +-0.05  0.4"},
	    {"paper_linear", OF_TWO, OF_EIGHT, "\n not shown: S1; --table inputs shows all\n"},
	    {"paper_linear", OF_TWO, OF_SIXTEEN, " of 16 outputs; S1; --table inputs shows all\n"},
	    {"auto_signals", "\"seed\"", "\"seed\"", "\nwith 3 signals the widest interval is predicted"},
	    // groups and notes
	    {"groups", "\"seed\"", "\"seed\"",
	     "S1/ST of the groups right building, contact, ground motion; force_amplification:\n0.41/0.95, "
	     "0.06/0.09, "},
	    {"sensitivity_small", "\"max\": 1}", "\"max\": 1}", "\nNote on "},
	    {"until", "\"seed\"", "\"seed\"", "every interval of S1 and ST has a half-width of at most 0.15"},
	    {"sensitivity_small", "\"name\": \"f_2\"",
	     "\"name\": \"frequency of the right building, fixed base\"", "    frequ...d base  S1"},
	};
	(void)state;
	for (size_t k = 0; k < sizeof cases / sizeof cases[0]; k++) {
		struct program_outcome example = POUND("example", cases[k].example);
		char *study = study_documents_with(example.out, cases[k].was, cases[k].is);
		struct program_outcome table =
		    program_run((const char *const[]){"pound", "run", "--format", "table", "-", NULL}, study);
		program_expect(&table, 0);
		assert_non_null(strstr(table.out, "\nMore tables (--table NAME): all, inputs"));
		if (!strstr(table.out, cases[k].words))
			fail_msg("no '%s' in\n%s", cases[k].words, table.out);
		check_screen(cases[k].example, table.out);
		program_free(&table);
		program_free(&example);
		free(study);
	}
}

/* Places, groups, and a first output that is constant. */
static void groups_are_in_the_summary_over_cells_and_places(void **state)
{
	static const char study[] =
	    "{\"kind\": \"sensitivity\", \"scene\": {\"buildings\": [{\"storeys\": 3, \"frequency_hz\": 2, "
	    "\"mass_kg\": 1e5}, {\"storeys\": 6, \"frequency_hz\": 1.4, \"mass_kg\": 1e5, \"law\": {\"type\": "
	    "\"elastoplastic\", \"yield_displacement_m\": 0.01}}], \"excitation\": {\"signals\": 2, "
	    "\"peak_m_s2\": 3}}, \"inputs\": [{\"path\": \"/contact/gap_m\", \"name\": \"gap\", "
	    "\"distribution\": "
	    "{\"type\": \"uniform\", \"min\": 0, \"max\": 0.05}}, {\"path\": \"/buildings/0/mass_kg\", \"name\": "
	    "\"m0\", \"distribution\": {\"type\": \"uniform\", \"min\": 5e4, \"max\": 2e5}}, {\"path\": "
	    "\"/buildings/0/frequency_hz\", \"name\": \"f0\", \"distribution\": {\"type\": \"uniform\", \"min\": "
	    "1, "
	    "\"max\": 3}}], \"groups\": [{\"name\": \"left\", \"of\": [\"/buildings/0/mass_kg\", "
	    "\"/buildings/0/frequency_hz\"]}], \"outputs\": [\"residual_drift_m\", \"peak_drift_ratio\", "
	    "\"largest_drift_ratio\", \"peak_shear_n\", \"drift_amplification\"], \"design\": {\"rows\": 40}}";
	static const struct {
		const char *was, *is, *words[6];
	} cases[] = {
	    {"\"design\"",
	     "\"design\"",
	     {"lowest to highest over stories (number in",
	      "\nS1/ST of the groups left, lowest to highest over stories; ", "peak_drift_ratio:\n",
	      "; 1 more output:"}},
	    {"\"design\"",
	     "\"sweep\": [{\"path\": \"/excitation/frequency_hz\", \"values\": [1, 2]}], \"design\"",
	     {"\nS1/ST of the groups left, lowest to highest over the 2 cells of the sweep and\nstories; "}},
	    {"\"residual_drift_m\", \"peak_drift_ratio\", \"largest_drift_ratio\", \"peak_shear_n\", "
	     "\"drift_amplification\"",
	     "\"largest_drift_ratio\"",
	     {"\nS1/ST of the groups left; largest_drift_ratio: "}},
	};
	(void)state;
	for (size_t k = 0; k < sizeof cases / sizeof cases[0]; k++) {
		char *changed = study_documents_with(study, cases[k].was, cases[k].is);
		struct program_outcome table =
		    program_run((const char *const[]){"pound", "run", "--format", "table", "-", NULL}, changed);
		program_expect(&table, 0);
		for (int i = 0; i < 6 && cases[k].words[i]; i++)
			if (!strstr(table.out, cases[k].words[i]))
				fail_msg("no '%s' in\n%s", cases[k].words[i], table.out);
		assert_non_null(
		    strstr(table.out, "\nMore tables (--table NAME): all, inputs, second_order, closed, groups,"));
		check_screen("groups", table.out);
		program_free(&table);
		free(changed);
	}
}

static void a_misspelt_name_is_answered_with_the_nearest(void **state)
{
	static const char *const calls[][7] = {{"pound", "run", "--format", "tabel", "-"},
	                                       {"pound", "run", "--format", "csv", "--table", "storey", "-"},
	                                       {"pound", "example", "papre"},
	                                       {"pound", "run", "--format", "nonsense", "-"}};
	static const char *const words[] = {
	    "no format 'tabel' here, did you mean 'table'? see --help",
	    "no table 'storey' here, did you mean 'storeys'? there are: inputs ",
	    "no example 'papre', did you mean 'paper'? there are:", "no format 'nonsense' here; see --help"};
	(void)state;
	for (size_t k = 0; k < sizeof words / sizeof words[0]; k++) {
		const char *arguments[8] = {NULL};
		memcpy(arguments, calls[k], sizeof calls[k]);
		struct program_outcome outcome = program_run(arguments, "");
		program_expect(&outcome, 2);
		if (!strstr(outcome.err, words[k]))
			fail_msg("no '%s' in\n%s", words[k], outcome.err);
		program_free(&outcome);
	}
}

/* `make run`: the widest interval of 1000 rows is wider than that of 500 rows, because a few rows dominate the variance. */
static void the_papers_study_ends_in_one_screen_and_a_report(void **state)
{
	static const char *const lines[] = {
	    "server listens on http://",
	    "The widest 95 % interval is +-0.23, of ST of input f_e, output impulse.\n",
	    "\nWith 500 rows it was +-0.074, narrower but not better: a few rare rows hold much\n",
	    "Quote the interval of\n1000 rows.\n", "\nReport with figures and tables, for a browser: "};
	(void)state;
#if defined __SANITIZE_ADDRESS__ || defined __SANITIZE_THREAD__
	skip(); // 30,000 runs are too slow
#endif
	struct program_outcome run = program_run(
	    (const char *const[]){"sh", "-c", "exec tests/run-paper \"$POUND_BUILD\" 2>&1", NULL}, NULL);
	program_expect(&run, 0);
	for (size_t k = 0; k < sizeof lines / sizeof lines[0]; k++)
		if (!strstr(run.out, lines[k]))
			fail_msg("no '%s' in\n%s", lines[k], run.out);
	check_screen("make run", run.out);
	char *path = strstr(run.out, lines[4]) + strlen(lines[4]);
	path[strcspn(path, "\n")] = '\0';
	char *report = program_file(path, NULL);
	assert_non_null(report);
	assert_non_null(strstr(report, "<svg"));
	assert_non_null(strstr(report, "+-0.074, narrower but not better"));
	free(report);
	program_free(&run);
}

static void one_table_of_a_result_is_shown_by_its_name(void **state)
{
	static const struct {
		const char *table, *shown, *csv; /* a word in it; the start of its CSV behind the swept field */
	} tables[] = {
	    {"inputs", "ST from 0 to 1", "output.name,output.mean,"},
	    {"second_order", " S2\n", "output.name,input_1,input_2,S2,S2_low,S2_high\r\n"},
	    {"closed", " S_closed\n", "output.name,input_1,input_2,input_3,"},
	    {"ratios", "together these variables explain ",
	     "output.name,explained,explained_low,explained_high,name,shapley,"},
	    {"conditional_means", "0 lowest ... 9 highest", "output.name,name,path,x,mean,low,high\r\n"}};
	char *study = with_every_table();
	(void)state;
	for (int i = 0; i < 5; i++) {
		struct program_outcome shown = program_run(
		    (const char *const[]){"pound", "run", "--format", "table", "--table", tables[i].table, "-", NULL},
		    study);
		struct program_outcome csv = program_run(
		    (const char *const[]){"pound", "run", "--format", "csv", "--table", tables[i].table, "-", NULL},
		    study);
		program_expect(&shown, 0);
		program_expect(&csv, 0);
		for (int k = 0; k < 5; k++)
			if (!strstr(shown.out, tables[k].shown) != (k != i))
				fail_msg("%s shows\n%s", tables[i].table, shown.out);
		assert_non_null(strstr(csv.out, tables[i].csv));
		program_free(&shown);
		program_free(&csv);
	}
	struct program_outcome other =
	    POUND("run", "--format", "table", "--table", "inputs", "schema/examples/gap.json");
	program_expect(&other, 1);
	assert_string_equal(other.out, "");
	program_free(&other);
	static const char *const refused[][8] = {
	    {"pound", "run", "--format", "table", "--table", "stopping", "-"},
	    {"pound", "run", "--format", "csv", "--table", "stopping", "-"},
	    {"pound", "run", "--format", "csv", "--table", "nonsense", "-"},
	    {"pound", "run", "--format", "csv", "--table", "closed ratios", "-"},
	    {"pound", "run", "--table", "closed", "-"}};
	for (int i = 0; i < 5; i++) {
		struct program_outcome outcome = program_run(refused[i], study);
		program_expect(&outcome, i < 2 ? 1 : 2);
		assert_string_equal(outcome.out, "");
		assert_non_null(strstr(outcome.err, "table"));
		program_free(&outcome);
	}
	free(study);
}

static void every_table_of_a_separation_is_shown_by_its_name(void **state)
{
	static const struct {
		const char *table, *shown, *csv;
	} tables[] = {{"pounding", "probability", ",gap_m,probability,low,high\r\n"},
	              {"gaps", "low_m", ",probability,gap_m,low_m,high_m\r\n"},
	              {"rules", "double_difference", ",name,what,gap_m,over_mean,probability,low,high\r\n"},
	              {"gap_needed", "gap_needed.largest_m", ",runs,runs_failed,displacement_left_m,"},
	              {"fragility", "dispersion_high", "intensity,annual_rate_beyond,gap_m,median,"},
	              {"return_periods", "2475", "intensity,annual_rate_beyond,return_period_years,gap_m,"},
	              {"signals", "gap_needed_m", ",index,gap_needed_m\r\n"},
	              {"outputs", "peak_displacement_free_m", ",output.name,output.mean\r\n"},
	              {"records", "made 20", "name,index,samples,time_step_s,"}};
	(void)state;
	for (size_t k = 0; k < sizeof tables / sizeof tables[0]; k++) {
		struct program_outcome shown =
		    POUND("run", "--format", "table", "--table", tables[k].table, "schema/examples/separation.json");
		struct program_outcome csv =
		    POUND("run", "--format", "csv", "--table", tables[k].table, "schema/examples/separation.json");
		program_expect(&shown, 0);
		program_expect(&csv, 0);
		if (!strstr(shown.out, tables[k].shown) || !strstr(csv.out, tables[k].csv))
			fail_msg("%s shows\n%s\n%s", tables[k].table, shown.out, csv.out);
		for (const char *line = shown.out, *end; (end = strchr(line, '\n')); line = end + 1)
			assert_true(end - line <= 80);
		program_free(&shown);
		program_free(&csv);
	}
	struct program_outcome other =
	    POUND("run", "--format", "table", "--table", "inputs", "schema/examples/separation.json");
	program_expect(&other, 1);
	assert_string_equal(other.out, "");
	program_free(&other);
}

static void a_row_shows_the_demands_of_its_stories_and_each_signal_by_its_places(void **state)
{
	(void)state;
	struct program_outcome document = POUND("example", "row_of_three");
	static const char law[] = "\"scene\": {\"law\": {\"type\": \"elastoplastic\"},";
	const char *scene = strstr(document.out, "\"scene\": {");
	char *nonlinear = NULL;
	assert_non_null(scene);
	assert_true(asprintf(&nonlinear, "%.*s%s%s", (int)(scene - document.out), document.out, law,
	                     scene + strlen("\"scene\": {")) > 0);
	static const char *const summary[] = {"pound", "run", "--format", "table", "-", NULL};
	static const char *const signals[] = {"pound",   "run",     "--format", "table",
	                                      "--table", "signals", "-",        NULL};
	struct program_outcome elastic = program_run(summary, document.out),
	                       plastic = program_run(summary, nonlinear);
	program_expect(&elastic, 0);
	program_expect(&plastic, 0);
	assert_non_null(strstr(plastic.out, "drift/h  demand   residual    shear_n\n"));
	// no column without a value, and so all in one block
	assert_non_null(strstr(elastic.out, "drift_m    free_m   drift/h    shear_n  a_m_s2  a_free\n"));
	struct program_outcome places = program_run(signals, nonlinear);
	program_expect(&places, 0);
	// every block has the keys of its lines
	const char *first = strstr(places.out, "signal  building  storey  drift_max_m");
	assert_non_null(first);
	assert_non_null(strstr(first + 1, "signal  building  storey  "));
	assert_non_null(strstr(places.out, "signal  contact  left_level"));
	assert_null(strstr(places.out, "building_0.storey_1"));
	for (const char *line = places.out, *end; (end = strchr(line, '\n')); line = end + 1)
		assert_true(end - line <= 80);
	program_free(&elastic), program_free(&plastic), program_free(&places), program_free(&document);
	free(nonlinear);
}

static void csv_has_as_many_cells_in_every_row(void **state)
{
	(void)state;
	static const char *const examples[] = {"sensitivity_small", "convergence"};
	for (int i = 0; i < 2; i++) {
		struct program_outcome document = POUND("example", examples[i]);
		struct program_outcome csv =
		    program_run((const char *const[]){"pound", "run", "--format", "csv", "-", NULL}, document.out);
		program_expect(&csv, 0);
		int commas = -1, rows = 0;
		for (char *line = strtok(csv.out, "\r\n"); line; line = strtok(NULL, "\r\n"), rows++) {
			int n = 0;
			for (char *c = line; *c; c++)
				n += *c == ',';
			assert_true(commas < 0 || n == commas);
			commas = n;
		}
		assert_true(rows > 1 && commas > 5);
		program_free(&csv);
		program_free(&document);
	}
}
CHECK_MAIN(cmocka_unit_test(groups_are_in_the_summary_over_cells_and_places),
           cmocka_unit_test(a_misspelt_name_is_answered_with_the_nearest),
           cmocka_unit_test(every_table_fits_a_terminal_of_80_columns),
           cmocka_unit_test(a_row_shows_the_demands_of_its_stories_and_each_signal_by_its_places),
           cmocka_unit_test(a_table_has_no_column_for_an_index_that_is_null_throughout),
           cmocka_unit_test(a_table_shows_every_estimate_of_a_result_and_its_notes),
           cmocka_unit_test(a_table_without_a_name_is_a_summary_of_one_screen),
           cmocka_unit_test(the_papers_study_ends_in_one_screen_and_a_report),
           cmocka_unit_test(one_table_of_a_result_is_shown_by_its_name),
           cmocka_unit_test(every_table_of_a_separation_is_shown_by_its_name),
           cmocka_unit_test(csv_has_as_many_cells_in_every_row))
