/* `pound run`: same bytes for any number of threads and by a server, same error messages, tables, a clean stop. */
#include <dirent.h>
#include <fcntl.h>
#include <signal.h>
#include <string.h>
#include <time.h>
#include <unistd.h>

#include "tests/support/check.h"
#include "tests/support/program.h"
#include "tests/support/service.h"
#include "tests/support/study_documents.h"

#define POUND(...) program_run((const char *const[]){"pound", __VA_ARGS__, NULL}, NULL)

static struct program_outcome run_threads(const char *document, const char *threads)
{
	struct program_outcome outcome =
	    program_run((const char *const[]){"pound", "run", "--threads", threads, "-", NULL}, document);
	program_expect(&outcome, 0);
	assert_string_equal(outcome.err, "");
	service_timeless(outcome.out);
	return outcome;
}

static struct program_outcome run_on_server(const char *document)
{
	struct program_outcome id =
	    program_run((const char *const[]){"pound", "submit", "--wait", "-", NULL}, document);
	program_expect(&id, 0);
	assert_string_equal(id.err, "");
	id.out[strcspn(id.out, "\n")] = '\0';
	struct program_outcome result = POUND("results", id.out);
	program_expect(&result, 0);
	service_timeless(result.out);
	program_free(&id);
	return result;
}

/* Writes an example to a new file; the caller deletes the file. */
static void example_file(const char *name, char path[32])
{
	strcpy(path, "/tmp/pound-test-XXXXXX");
	struct program_outcome document = POUND("example", name);
	FILE *file = fdopen(mkstemp(path), "w");
	assert_non_null(file);
	fputs(document.out, file);
	fclose(file);
	program_free(&document);
}

/* Whether an example takes too long for this test; such an example is only validated. */
static bool is_long(const char *name)
{
	return strncmp(name, "paper", 5) == 0;
}

static void every_quick_example_gives_the_same_bytes_by_1_2_and_4_threads_and_by_the_server(void **state)
{
	static const char *const threads[] = {"2", "4"};
	struct program_outcome names = POUND("example", "--names");
	int n_run = 0;
	(void)state;
	for (char *name = strtok(names.out, "\n"); name; name = strtok(NULL, "\n")) {
		if (is_long(name))
			continue;
		struct program_outcome document = POUND("example", name);
		if (!strstr(document.out, "\"scene\"")) { // a study of an external model
			program_free(&document);
			continue;
		}
		struct program_outcome one = run_threads(document.out, "1");
		for (int i = 0; i < 2; i++) {
			struct program_outcome other = run_threads(document.out, threads[i]);
			assert_string_equal(other.out, one.out);
			program_free(&other);
		}
		struct program_outcome served = run_on_server(document.out);
		assert_string_equal(served.out, one.out);
		program_free(&served);
		program_free(&one);
		program_free(&document);
		n_run++;
	}
	assert_true(n_run >= 2);
	program_free(&names);
}

// invalid documents, and words that the list of their problems must contain
static const struct {
	const char *text;
	const char *words[4];
} BAD[] = {
    {"{\"kind\": \"response\",\n  \"scene\" {}}", {"line 2, column 11"}},
    {"", {"line 1, column 1"}},
    {"[]", {"object"}},
    {"{\"kind\": \"response\", \"scene\": {\"oscillators\": [{\"frequency_hz\": -1}, {\"frequency_hz\": 2}],"
     " \"contact\": {\"restitution\": 1.4, \"gap\": 0}}}",
     {"/scene/oscillators/0/frequency_hz: ", "/scene/contact/restitution: must be in [0, 1], got 1.4",
      "gap_m"}},
    {"{\"kind\": \"sensitivty\"}", {"sensitivity", "/scene"}},
};

static void a_bad_study_gets_the_same_list_from_run_and_from_the_server(void **state)
{
	(void)state;
	for (size_t i = 0; i < sizeof BAD / sizeof BAD[0]; i++) {
		struct program_outcome run =
		    program_run((const char *const[]){"pound", "run", "-", NULL}, BAD[i].text);
		struct program_outcome submit =
		    program_run((const char *const[]){"pound", "submit", "-", NULL}, BAD[i].text);
		program_expect(&run, 2);
		program_expect(&submit, 2);
		assert_string_equal(run.out, "");
		assert_string_equal(submit.out, "");
		assert_string_equal(run.err, submit.err);
		for (int w = 0; w < 4 && BAD[i].words[w]; w++)
			if (!strstr(run.err, BAD[i].words[w])) {
				print_error("'%s' is not in\n%s", BAD[i].words[w], run.err);
				fail();
			}
		program_free(&run);
		program_free(&submit);
	}
}

static int count(const char *text, const char *part)
{
	int n = 0;
	for (; (text = strstr(text, part)); text += strlen(part))
		n++;
	return n;
}

static void a_table_of_responses_has_each_value_of_a_sweep(void **state)
{
	(void)state;
	struct program_outcome document = POUND("example", "gap");
	struct program_outcome table =
	    program_run((const char *const[]){"pound", "run", "--format", "table", "-", NULL}, document.out);
	program_expect(&table, 0);
	assert_int_equal(count(document.out, "[0, 0.001, 0.002, 0.004, 0.008]"), 1);
	assert_int_equal(count(table.out, "/contact/gap_m = "), 5);
	assert_int_equal(count(table.out, " left  "), 5);
	assert_int_equal(count(table.out, "\nimpulse "), 5);
	assert_non_null(strstr(table.out, "/contact/gap_m = 0.008"));
	program_free(&table);
	program_free(&document);
}

// a step of one period of a 1 Hz oscillator is unstable
#define UNSTABLE(values)                                                                                 \
	"{\"kind\": \"response\", \"solver\": {\"method\": \"central_difference\", \"step_s\": 1},"          \
	" \"sweep\": [{\"path\": \"/oscillators/0/frequency_hz\", \"values\": " values "}],"                 \
	" \"scene\": {\"oscillators\": [{\"frequency_hz\": 1}, {\"frequency_hz\": 0.1}], \"contact\": null," \
	" \"excitation\": {\"type\": \"record\", \"time_step_s\": 1,"                                        \
	" \"acceleration_m_s2\": [0, 1, 0, 1, 0, 1, 0, 1, 0, 1, 0, 1, 0, 1, 0, 1, 0, 1, 0, 1]}}}"

static void a_table_says_how_many_responses_failed_and_why(void **state)
{
	(void)state;
	struct program_outcome table = program_run(
	    (const char *const[]){"pound", "run", "--format", "table", "-", NULL}, UNSTABLE("[0.1, 1]"));
	program_expect(&table, 0);
	assert_non_null(strstr(table.out, "\n1 of 1 runs failed\n"));
	assert_non_null(strstr(table.out, "1 run failed: the steps of the solver are too long for this scene\n"));
	program_free(&table);
}

static void a_study_without_any_result_ends_with_3_and_says_why(void **state)
{
	(void)state;
	struct program_outcome run =
	    program_run((const char *const[]){"pound", "run", "-", NULL}, UNSTABLE("[1, 2]"));
	program_expect(&run, 3);
	assert_string_equal(run.out, "");
	assert_string_equal(run.err, "pound: the study failed: all runs failed: "
	                             "the steps of the solver are too long for this scene\n");
	program_free(&run);
	struct program_outcome submit =
	    program_run((const char *const[]){"pound", "submit", "--wait", "-", NULL}, UNSTABLE("[1, 2]"));
	program_expect(&submit, 3);
	submit.out[strcspn(submit.out, "\n")] = '\0';
	struct program_outcome ended = POUND("status", submit.out);
	program_expect(&ended, 0);
	assert_non_null(strstr(ended.out, "\"status\": \"failed\""));
	assert_non_null(strstr(ended.out, "all runs failed: the steps of the solver are too long"));
	program_free(&ended);
	program_free(&submit);
}

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
	    {"two_storeys", "\"seed\"", "\"seed\"", " of 19 inputs, those with the smallest indices;"},
	    // three outputs: both indices; eight outputs: one index, and a line that names the other
	    {"paper_linear", OF_TWO, OF_THREE, "\n force_amplification S1  0.36 +-0.05  0.0"},
	    {"paper_linear", OF_TWO, OF_THREE, "\n                     ST  0.83 +-0.05  0.4"},
	    {"paper_linear", OF_TWO, OF_EIGHT, "\n not shown: S1; --table inputs shows all\n"},
	    {"paper_linear", OF_TWO, OF_SIXTEEN, " of 16 outputs; S1; --table inputs shows all\n"},
	    {"auto_signals", "\"seed\"", "\"seed\"", "\nwith 3 signals the widest interval is predicted"},
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

/* `make run`: the widest interval of 1000 rows is wider than that of 500 rows, because a few rows dominate the variance. */
static void the_papers_study_ends_in_one_screen_and_a_report(void **state)
{
	static const char *const lines[] = {
	    "server listens on http://",
	    "The widest 95 % interval is +-0.13, of ST of input f_e, output impulse.\n",
	    "\nWith 500 rows it was +-0.062, narrower but not better: a few rare rows hold much\n",
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
	assert_non_null(strstr(report, "+-0.062, narrower but not better"));
	free(report);
	program_free(&run);
}

static void one_table_of_a_result_is_shown_by_its_name(void **state)
{
	static const struct {
		const char *table, *shown, *csv; /* text of the table; columns of its CSV after the swept field */
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

/* Waits until a process has a handler for a signal; false: not within 10 s. */
static bool catches(pid_t pid, int number)
{
	char path[48], line[256];
	snprintf(path, sizeof path, "/proc/%d/status", (int)pid);
	for (int tries = 0; tries < 10000; tries++) {
		unsigned long long caught = 0;
		FILE *file = fopen(path, "r");
		while (file && fgets(line, sizeof line, file))
			sscanf(line, "SigCgt: %llx", &caught);
		if (file)
			fclose(file);
		if (caught >> (number - 1) & 1)
			return true;
		nanosleep(&(struct timespec){.tv_nsec = 1000000}, NULL);
	}
	return false;
}

static void ctrl_c_stops_a_run_without_a_result(void **state)
{
	static const int signals[] = {SIGINT, SIGTERM};
	char study[32], out[48], err[48];
	(void)state;
	example_file("paper", study);
	snprintf(out, sizeof out, "%s.out", study);
	snprintf(err, sizeof err, "%s.err", study);
	for (int i = 0; i < 2; i++) {
		size_t n;
		pid_t pid = program_start((const char *const[]){"pound", "run", study, NULL}, out, err);
		assert_true(catches(pid, signals[i]));
		kill(pid, signals[i]);
		assert_int_equal(program_end(pid), 1);
		free(program_file(out, &n));
		assert_int_equal(n, 0);
		char *said = program_file(err, &n);
		assert_string_equal(said, "pound: stopped by the caller\n");
		free(said);
		unlink(out);
		unlink(err);
	}
	unlink(study);
}

/* Number of threads of a process; 0: the process has ended. */
static int threads_of(pid_t pid)
{
	char path[48];
	snprintf(path, sizeof path, "/proc/%d/task", (int)pid);
	DIR *tasks = opendir(path);
	int n = 0;
	for (struct dirent *task; tasks && (task = readdir(tasks));)
		n += task->d_name[0] != '.';
	if (tasks)
		closedir(tasks);
	return n;
}

static void a_file_that_cannot_be_written_is_reported_before_the_study_runs(void **state)
{
	(void)state;
	static const char *const files[][2] = {{"/nonexistent/x.csv", "No such file or directory"},
	                                       {"/tmp", "Is a directory"}};
	for (int i = 0; i < 2; i++) {
		struct program_outcome refused =
		    program_run((const char *const[]){"pound", "run", "--samples", files[i][0],
		                                      "schema/examples/sensitivity_small.json", NULL},
		                "");
		program_expect(&refused, 1);
		assert_string_equal(refused.out, "");
		assert_non_null(strstr(refused.err, files[i][1]));
		program_free(&refused);
	}
}

static void ctrl_c_stops_histories_that_are_being_written(void **state)
{
	char study[32], err[48], histories[48];
	(void)state;
	int file = mkstemp(strcpy(study, "/tmp/pound.XXXXXX"));
	// spectra of 300 signals at one frequency are quick, their histories take seconds
	dprintf(file, "{\"kind\": \"floor_spectrum\", \"histories\": true, \"spectrum\": {\"frequencies_hz\": "
	              "[3]}, \"scene\": {"
	              "\"oscillators\": [{\"frequency_hz\": 2}, {\"frequency_hz\": 3.1}],"
	              "\"excitation\": {\"signals\": 300}}}");
	close(file);
	snprintf(err, sizeof err, "%s.err", study);
	snprintf(histories, sizeof histories, "%s.csv", study);
	pid_t pid = program_start(
	    (const char *const[]){"pound", "run", "--threads", "2", "--samples", histories, study, NULL},
	    "/dev/null", err);
	// wait until both worker threads have started and ended; a sanitizer adds a thread
	const struct timespec moment = {.tv_nsec = 1000000};
	for (int now = 1, most = 1; most < 3 || now > most - 2; nanosleep(&moment, NULL)) {
		now = threads_of(pid);
		most = now > most ? now : most;
	}
	nanosleep(&(struct timespec){.tv_nsec = 100000000}, NULL);
	kill(pid, SIGINT);
	assert_int_equal(program_end(pid), 1);
	size_t n;
	char *said = program_file(err, &n);
	assert_non_null(strstr(said, "stopped by the caller"));
	assert_null(program_file(histories, &n));
	free(said);
	unlink(err);
	unlink(study);
}

static void the_bar_keeps_within_its_terminal_and_clears_its_line(void **state)
{
	static const int widths[] = {120, 60, 20};
	char study[32];
	(void)state;
	example_file("sensitivity_small", study);
	for (int i = 0; i < 3; i++) {
		char *bar = program_drawn((const char *const[]){"pound", "run", study, NULL}, widths[i]);
		size_t n = strlen(bar);
		assert_non_null(strstr(bar, "100 %"));
		assert_true(n > 4 && strcmp(bar + n - 4, "\r\033[K") == 0);
		for (char *line = strtok(bar, "\r"); line; line = strtok(NULL, "\r"))
			// the escape sequence has three bytes and no width
			assert_true(strncmp(line, "\033[K", 3) == 0 && strlen(line) - 3 < (size_t)widths[i]);
		free(bar);
	}
	unlink(study);
}

static void a_paper_study_is_valid_and_its_cost_is_reported(void **state)
{
	struct program_outcome names = POUND("example", "--names");
	int n = 0;
	for (char *name = strtok(names.out, "\n"); name; name = strtok(NULL, "\n")) {
		if (!is_long(name))
			continue;
		struct program_outcome document = POUND("example", name);
		struct answer estimate =
		    service_ask(*state, &(struct ask){.method = "POST",
		                                      .path = "/v1/studies?validate_only=true",
		                                      .headers = {"Content-Type: application/json"},
		                                      .body = document.out,
		                                      .length = document.n_out});
		assert_int_equal(estimate.status, 200);
		assert_non_null(strstr(estimate.body, "\"estimated_cpu_s\": "));
		answer_free(&estimate);
		program_free(&document);
		n++;
	}
	assert_true(n >= 2);
	program_free(&names);
}

#define SERVED(name) cmocka_unit_test_setup_teardown(name, program_setup, service_teardown)

CHECK_MAIN(SERVED(every_quick_example_gives_the_same_bytes_by_1_2_and_4_threads_and_by_the_server),
           SERVED(a_bad_study_gets_the_same_list_from_run_and_from_the_server),
           cmocka_unit_test(a_table_of_responses_has_each_value_of_a_sweep),
           cmocka_unit_test(a_table_says_how_many_responses_failed_and_why),
           SERVED(a_study_without_any_result_ends_with_3_and_says_why),
           cmocka_unit_test(every_table_fits_a_terminal_of_80_columns),
           cmocka_unit_test(a_table_has_no_column_for_an_index_that_is_null_throughout),
           cmocka_unit_test(a_table_shows_every_estimate_of_a_result_and_its_notes),
           cmocka_unit_test(a_table_without_a_name_is_a_summary_of_one_screen),
           cmocka_unit_test(the_papers_study_ends_in_one_screen_and_a_report),
           cmocka_unit_test(one_table_of_a_result_is_shown_by_its_name),
           cmocka_unit_test(every_table_of_a_separation_is_shown_by_its_name),
           cmocka_unit_test(csv_has_as_many_cells_in_every_row),
           cmocka_unit_test(ctrl_c_stops_a_run_without_a_result),
           cmocka_unit_test(a_file_that_cannot_be_written_is_reported_before_the_study_runs),
           cmocka_unit_test(ctrl_c_stops_histories_that_are_being_written),
           cmocka_unit_test(the_bar_keeps_within_its_terminal_and_clears_its_line),
           SERVED(a_paper_study_is_valid_and_its_cost_is_reported))
