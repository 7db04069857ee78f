/* Every command of the README and of the other pages works as printed; the pages agree with the program's tables, and
 * the files, tests and headings that they name exist.
 *
 * All ```sh blocks of a page form one script, run in an empty folder with `sh -eu -c`, with two changes: the server is a
 * poundd started by the test, and build/release is the build under test. */
#include <glob.h>
#include <math.h>
#include <string.h>
#include <unistd.h>

#include "schema/study/fields.h"
#include "tests/support/check.h"
#include "tests/support/program.h"
#include "tests/support/service.h"

// commands that are not run: the test has started its own server
static const char SERVER[] = "build/release/poundd ";

static const struct {
	const char *readme, *test; /* text of the page; environment variable with its replacement */
} REPLACED[] = {
    {"http://127.0.0.1:8437", "POUND_URL"},
    {"build/release", "POUND_BUILD"},
};

static void put_replaced(FILE *out, const char *line)
{
	while (*line) {
		size_t i = 0, n = sizeof REPLACED / sizeof REPLACED[0];
		while (i < n && strncmp(line, REPLACED[i].readme, strlen(REPLACED[i].readme)) != 0)
			i++;
		if (i < n) {
			fputs(getenv(REPLACED[i].test), out);
			line += strlen(REPLACED[i].readme);
		} else
			fputc(*line++, out);
	}
}

/* README.md and the pages in folders; the caller calls globfree. */
static glob_t pages_all(void)
{
	glob_t pages;
	assert_int_equal(glob("README.md", 0, NULL, &pages), 0);
	assert_int_equal(glob("*/*.md", GLOB_APPEND, NULL, &pages), 0);
	assert_int_equal(glob("*/*/*.md", GLOB_APPEND, NULL, &pages), 0);
	return pages;
}

/* The blocks of a page as one script, which prints the line of each block to stderr; `blocks` counts them. */
static char *script_of(const char *name, char *page, int *blocks)
{
	char *script = NULL;
	size_t n;
	FILE *out = open_memstream(&script, &n);
	bool inside = false;
	int number = 1;
	*blocks = 0;
	for (char *line = page, *next; line; line = next, number++) {
		next = strchr(line, '\n');
		if (next)
			*next++ = '\0';
		if (!inside && strcmp(line, "```sh") == 0) {
			inside = true;
			++*blocks;
			fprintf(out, "echo '%s line %d' >&2\n", name, number);
		} else if (inside && strcmp(line, "```") == 0)
			inside = false;
		else if (inside && strncmp(line, SERVER, strlen(SERVER)) != 0) {
			put_replaced(out, line);
			fputc('\n', out);
		}
	}
	fclose(out);
	assert_false(inside);
	return script;
}

/* Default of a member as the page writes it. */
static void default_of(const struct field *field, char *text, size_t size)
{
	bool found_otherwise = field->ends == FIELD_OPEN_MIN && field->absent == field->min;
	bool element = field->pattern[strlen(field->pattern) - 1] == '*';
	if (element)
		snprintf(text, size, "-");
	else if (isnan(field->absent))
		snprintf(text, size, "required");
	else if (field->choice)
		snprintf(text, size, "`%s`", field->choice((int)field->absent));
	else if (field->type == FIELD_BOOL)
		snprintf(text, size, "%s", field->absent != 0.0 ? "true" : "false");
	else if (field->type >= FIELD_TEXT || found_otherwise)
		snprintf(text, size, "-");
	else
		snprintf(text, size, "%.15g", field->absent);
}

/* Appends "; only a, b", with `word` for "only", from names between spaces. */
static void list_names(const char *word, const char *names, char *text, size_t size)
{
	size_t n = strlen(text);
	n += (size_t)snprintf(text + n, size - n, "; %s", word);
	for (const char *c = names; c[1] && n < size - 2; c++) {
		if (*c == ' ' && c > names)
			text[n++] = ',';
		text[n++] = *c;
	}
	text[n] = '\0';
}

static void only(const char *names, char *text, size_t size)
{
	if (names)
		list_names("only", names, text, size);
}

/* Names of the solvers that use a field, between spaces. */
static const char *solvers_of(const struct field *field, char *text, size_t size)
{
	size_t n = (size_t)snprintf(text, size, " ");
	for (int row = 0; field->solvers && pound_solver_name(row); row++)
		if (field->solvers(row))
			n += (size_t)snprintf(text + n, size - n, "%s ", pound_solver_name(row));
	return field->solvers ? text : NULL;
}

/* Appends "; only a, b" with the contact models that read a member, or "; not c" if most of them read it. */
static void models_of(const struct field *field, char *text, size_t size)
{
	static const char contact[] = "/scene/contact/";
	char names[2][256] = {" ", " "};
	int n[2] = {0};
	if (strncmp(field->pattern, contact, strlen(contact)) != 0 || field->type == FIELD_OBJECT)
		return;
	for (int row = 0; pound_contact_name(row); row++) {
		const bool reads = pound_contact_reads(row, fields_name(field));
		const size_t length = strlen(names[reads]);
		snprintf(names[reads] + length, sizeof names[0] - length, "%s ", pound_contact_name(row));
		n[reads]++;
	}
	if (n[0] > 0)
		list_names(n[0] < n[1] ? "not" : "only", names[n[0] >= n[1]], text, size);
}

static const char STUDY[] = "schema/study.md";

/* Whether a member of /scene/contacts is also a member of /scene/contact: the page has one line for both. */
static bool of_contact(const struct field *field)
{
	static const char contacts[] = "/scene/contacts/*/";
	char pattern[128];
	snprintf(pattern, sizeof pattern, "/scene/contact/%s", fields_name(field));
	return strncmp(field->pattern, contacts, strlen(contacts)) == 0 && fields_find(pattern);
}

static void every_member_of_a_study_stands_in_the_docs_as_the_reader_takes_it(void **state)
{
	static const char same[] = "/scene/oscillators/*/law/"; // listed once, with the scene's law
	char *page = program_file(STUDY, NULL);
	int missing = 0, listed = 0, lines = 0;
	(void)state;
	assert_non_null(page);
	for (int i = 0; i < fields_count; i++) {
		const struct field *field = &fields[i];
		char absent[64], takes[FIELDS_EXPECTED_SIZE], meaning[600], line[3072], solvers[256];
		if (strncmp(field->pattern, same, strlen(same)) == 0 || of_contact(field))
			continue;
		default_of(field, absent, sizeof absent);
		fields_expected(field, takes, sizeof takes);
		snprintf(meaning, sizeof meaning, "%s", field->text);
		only(field->kinds, meaning, sizeof meaning);
		only(field->types, meaning, sizeof meaning);
		only(solvers_of(field, solvers, sizeof solvers), meaning, sizeof meaning);
		models_of(field, meaning, sizeof meaning);
		snprintf(line, sizeof line, "| `%s` | %s | %s | %s |\n", field->pattern, absent, takes, meaning);
		listed++;
		if (strstr(page, line))
			continue;
		fprintf(stderr, "%s has no line\n%s", STUDY, line); // print_error cuts long lines
		missing++;
	}
	assert_int_equal(missing, 0);
	for (const char *row = page; (row = strstr(row, "\n| `/")); row++)
		lines++;
	assert_int_equal(lines, listed); // one line per member, no other lines
	free(page);
}

static void every_distribution_stands_in_the_docs_with_its_parameters_and_rules(void **state)
{
	const char *name, *parameter;
	char *page = program_file(STUDY, NULL);
	(void)state;
	assert_non_null(page);
	for (int row = 0; (name = pound_distribution_name(row)); row++) {
		char line[512];
		int n = snprintf(line, sizeof line, "| `%s` | ", name);
		for (int k = 0; (parameter = pound_distribution_parameter(row, k)); k++)
			n += snprintf(line + n, sizeof line - (size_t)n, "%s`%s`", k ? ", " : "", parameter);
		n += snprintf(line + n, sizeof line - (size_t)n,
		              pound_distribution_lists_values(row) ? "`values`, `weights` | " : " | ");
		for (int k = 0; (parameter = pound_distribution_rule(row, k)); k++)
			n += snprintf(line + n, sizeof line - (size_t)n, "%s%s", k ? "; " : "", parameter);
		snprintf(line + n, sizeof line - (size_t)n, " |\n");
		if (!strstr(page, line))
			fail_msg("%s has no line\n%s", STUDY, line);
	}
	free(page);
}

static void every_row_of_the_engine_s_tables_stands_in_the_docs_with_its_line(void **state)
{
	static const struct {
		const char *(*name)(int row), *(*text)(int row);
	} tables[] = {{pound_law_name, pound_law_text},         {pound_contact_name, pound_contact_text},
	              {pound_damping_name, pound_damping_text}, {pound_excitation_name, pound_excitation_text},
	              {pound_solver_name, pound_solver_text},   {pound_output_name, pound_output_text}};
	char *page = program_file(STUDY, NULL);
	int missing = 0;
	(void)state;
	assert_non_null(page);
	for (size_t t = 0; t < sizeof tables / sizeof tables[0]; t++)
		for (int row = 0; tables[t].name(row); row++) {
			char line[512];
			snprintf(line, sizeof line, "| `%s` | %s |\n", tables[t].name(row), tables[t].text(row));
			if (strstr(page, line))
				continue;
			print_error("%s has no line\n%s", STUDY, line);
			missing++;
		}
	assert_int_equal(missing, 0);
	free(page);
}

/* Number of files that a page names; fails if one does not exist. */
static int files_named(const char *page)
{
	static const char *const folders[] = {"engine/", "schema/", "server/", "client/", "tests/"};
	char *text = program_file(page, NULL), *rest;
	int n = 0;
	assert_non_null(text);
	for (char *name = strtok_r(text, "` \n|,;()[]#", &rest); name;
	     name = strtok_r(NULL, "` \n|,;()[]#", &rest))
		for (int i = 0; i < 5; i++)
			// forms such as unit_<file>.c name no file
			if (strncmp(name, folders[i], strlen(folders[i])) == 0 && !strchr(name, '<')) {
				name[strlen(name) - (name[strlen(name) - 1] == '.')] = '\0';
				if (access(name, R_OK) != 0)
					fail_msg("%s names %s", page, name);
				n++;
			}
	free(text);
	return n;
}

static void every_file_that_a_page_names_is_there(void **state)
{
	glob_t pages = pages_all();
	int n = 0;
	(void)state;
	for (size_t i = 0; i < pages.gl_pathc; i++)
		n += files_named(pages.gl_pathv[i]);
	assert_true(n > 60);
	globfree(&pages);
}

/* Whether a test program's name, or the name of one of its tests, contains `name`. */
static bool test_there(const glob_t *programs, const char *name)
{
	bool there = false;
	for (size_t i = 0; i < programs->gl_pathc && !there; i++) {
		char *text = program_file(programs->gl_pathv[i], &(size_t){0});
		there = strstr(strrchr(programs->gl_pathv[i], '/'), name);
		for (const char *at = text; !there && (at = strstr(at, "\nstatic void ")); at++) {
			const char *found = strstr(at, name);
			there = found && found < at + strcspn(at, "(");
		}
		free(text);
	}
	return there;
}

static void every_test_that_a_page_names_is_there(void **state)
{
	glob_t pages = pages_all(), programs;
	int n = 0, missing = 0;
	(void)state;
	assert_int_equal(glob("tests/unit/*/unit_*.c", 0, NULL, &programs), 0);
	assert_int_equal(glob("tests/service/service_*.c", GLOB_APPEND, NULL, &programs), 0);
	assert_int_equal(glob("tests/client/client_*.c", GLOB_APPEND, NULL, &programs), 0);
	assert_int_equal(glob("tests/long/soak_*.c", GLOB_APPEND, NULL, &programs), 0);
	for (size_t i = 0; i < pages.gl_pathc; i++) {
		char *text = program_file(pages.gl_pathv[i], &(size_t){0}), name[80];
		for (const char *at = text; (at = strstr(at, "T=")); at++) {
			if (at == text || !strchr(" `", at[-1]) || sscanf(at, "T=%79[a-z0-9_]", name) != 1)
				continue;
			n++;
			if (!test_there(&programs, name)) {
				check_report("%s: no test or program has %s in its name", pages.gl_pathv[i], name);
				missing++;
			}
		}
		free(text);
	}
	check_report("%d tests named", n);
	assert_int_equal(missing, 0);
	assert_true(n > 50);
	globfree(&pages);
	globfree(&programs);
}

/* Whether a link's anchor names a heading: lower case, - for a space, other characters dropped. */
static bool is_anchor(const char *heading, const char *anchor)
{
	for (; *heading && *heading != '\n'; heading++) {
		char c = *heading == ' '                      ? '-'
		         : *heading >= 'A' && *heading <= 'Z' ? (char)(*heading + 32)
		                                              : *heading;
		if ((c < 'a' || c > 'z') && (c < '0' || c > '9') && c != '-' && c != '_')
			continue;
		if (*anchor++ != c)
			return false;
	}
	return *anchor == ')';
}

/* Every link to a heading, of the same or of another page, has a target. */
static void every_link_between_the_pages_leads_to_a_heading(void **state)
{
	glob_t pages = pages_all();
	int n = 0;
	(void)state;
	for (size_t i = 0; i < pages.gl_pathc; i++) {
		char *text = program_file(pages.gl_pathv[i], NULL), path[128];
		for (char *link = text; (link = strstr(link, "](")); link += 2) {
			size_t length = strcspn(link + 2, "#)");
			if (link[2 + length] != '#' || strncmp(link + 2, "http", 4) == 0)
				continue;
			const char *slash = strrchr(pages.gl_pathv[i], '/');
			int folder = slash ? (int)(slash + 1 - pages.gl_pathv[i]) : 0;
			snprintf(path, sizeof path, "%.*s%.*s", folder, pages.gl_pathv[i], (int)length, link + 2);
			char *target = program_file(length ? path : pages.gl_pathv[i], NULL), *at = target;
			assert_non_null(target);
			while (at && !is_anchor(at + strspn(at, "\n# "), link + 3 + length))
				at = strstr(at + 1, "\n#");
			if (!at)
				fail_msg("%s: %.60s leads nowhere", pages.gl_pathv[i], link + 2);
			free(target);
			n++;
		}
		free(text);
	}
	assert_true(n >= 4);
	globfree(&pages);
}

static void the_usage_stands_in_the_readme_as_it_is_printed(void **state)
{
	struct program_outcome help = program_run((const char *const[]){"pound", "--help", NULL}, NULL);
	char *readme = program_file("README.md", NULL);
	(void)state;
	assert_non_null(readme);
	assert_non_null(strstr(readme, help.out));
	free(readme);
	program_free(&help);
}

/* Runs the commands of a page in a temporary folder; returns the number of blocks. */
static int commands_run(const char *name)
{
	int blocks;
	char *page = program_file(name, NULL);
	assert_non_null(page);
	char *script = script_of(name, page, &blocks), folder[] = "/tmp/pound-test-XXXXXX", removal[64];
	assert_non_null(mkdtemp(folder));
	snprintf(removal, sizeof removal, "rm -r %s", folder);
	struct program_outcome outcome = program_run(
	    (const char *const[]){"sh", "-euc", "cd \"$1\"; eval \"$2\"", name, folder, script, NULL}, NULL);
	program_expect(&outcome, 0);
	program_free(&outcome);
	assert_int_equal(system(removal), 0);
	free(script);
	free(page);
	return blocks;
}

static void every_command_of_the_readme_and_the_docs_works(void **state)
{
	(void)state;
	int blocks = 0;
	char *build = realpath(getenv("POUND_BUILD") ? getenv("POUND_BUILD") : "build/release", NULL);
	assert_non_null(build);
	setenv("POUND_BUILD", build, 1);
	setenv("no_proxy", "127.0.0.1", 1);
	glob_t pages = pages_all();
	for (size_t i = 0; i < pages.gl_pathc; i++)
		blocks += commands_run(pages.gl_pathv[i]);
	assert_true(blocks >= 10);
	globfree(&pages);
	free(build);
}

CHECK_MAIN(cmocka_unit_test(every_file_that_a_page_names_is_there),
           cmocka_unit_test(every_test_that_a_page_names_is_there),
           cmocka_unit_test(every_link_between_the_pages_leads_to_a_heading),
           cmocka_unit_test(every_member_of_a_study_stands_in_the_docs_as_the_reader_takes_it),
           cmocka_unit_test(every_distribution_stands_in_the_docs_with_its_parameters_and_rules),
           cmocka_unit_test(every_row_of_the_engine_s_tables_stands_in_the_docs_with_its_line),
           cmocka_unit_test(the_usage_stands_in_the_readme_as_it_is_printed),
           cmocka_unit_test_setup_teardown(every_command_of_the_readme_and_the_docs_works, program_setup,
                                           service_teardown))
