/* Every command of the README works as it stands there.
 *
 * All ```sh blocks of README.md are one script, run in an empty folder with `sh -eu -c`, with two things changed:
 * a poundd of the test's own stands for the one that is started there, and the build under test for build/release. */
#include <math.h>
#include <string.h>
#include <unistd.h>

#include "schema/fields.h"
#include "tests/check.h"
#include "tests/program.h"
#include "tests/service.h"

// the one command that is not run: the test has started its own server
static const char SERVER[] = "build/release/poundd ";

static const struct {
	const char *readme, *test; /* what the README says; the variable that holds what stands for it here */
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

/* The blocks as one script, which says on stderr where it is; `blocks` counts them. */
static char *script_of(char *readme, int *blocks)
{
	char *script = NULL;
	size_t n;
	FILE *out = open_memstream(&script, &n);
	bool inside = false;
	int number = 1;
	*blocks = 0;
	for (char *line = readme, *next; line; line = next, number++) {
		next = strchr(line, '\n');
		if (next)
			*next++ = '\0';
		if (!inside && strcmp(line, "```sh") == 0) {
			inside = true;
			++*blocks;
			fprintf(out, "echo 'README.md line %d' >&2\n", number);
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

/* What stands for an absent member. */
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

/* " (only a, b)" of names between spaces. */
static void only(const char *names, char *text, size_t size)
{
	size_t n = strlen(text);
	if (!names)
		return;
	n += (size_t)snprintf(text + n, size - n, "; only");
	for (const char *c = names; c[1] && n < size - 2; c++) {
		if (*c == ' ' && c > names)
			text[n++] = ',';
		text[n++] = *c;
	}
	text[n] = '\0';
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

static void every_member_of_a_study_stands_in_the_readme_as_the_reader_takes_it(void **state)
{
	static const char same[] = "/scene/oscillators/*/law/"; // told once, for the scene's law
	char *readme = program_file("README.md", NULL);
	int missing = 0;
	(void)state;
	assert_non_null(readme);
	for (int i = 0; i < fields_count; i++) {
		const struct field *field = &fields[i];
		char absent[64], takes[256], meaning[600], line[1200], solvers[256];
		if (strncmp(field->pattern, same, strlen(same)) == 0)
			continue;
		default_of(field, absent, sizeof absent);
		fields_expected(field, takes, sizeof takes);
		snprintf(meaning, sizeof meaning, "%s", field->text);
		only(field->kinds, meaning, sizeof meaning);
		only(field->types, meaning, sizeof meaning);
		only(solvers_of(field, solvers, sizeof solvers), meaning, sizeof meaning);
		snprintf(line, sizeof line, "| `%s` | %s | %s | %s |\n", field->pattern, absent, takes, meaning);
		if (strstr(readme, line))
			continue;
		print_error("README.md has no line\n%s", line);
		missing++;
	}
	assert_int_equal(missing, 0);
	free(readme);
}

static void every_distribution_stands_in_the_readme_with_its_parameters_and_rules(void **state)
{
	const char *name, *parameter;
	char *readme = program_file("README.md", NULL);
	(void)state;
	assert_non_null(readme);
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
		if (!strstr(readme, line))
			fail_msg("README.md has no line\n%s", line);
	}
	free(readme);
}

static void every_file_the_readme_names_is_there(void **state)
{
	static const char *const folders[] = {"engine/", "schema/", "server/", "client/", "tests/"};
	char *readme = program_file("README.md", NULL);
	int n = 0;
	(void)state;
	assert_non_null(readme);
	for (char *name = strtok(readme, "` \n|,;()"); name; name = strtok(NULL, "` \n|,;()"))
		for (int i = 0; i < 5; i++)
			// a folder alone, and forms such as unit_<file>.c, name no file
			if (strncmp(name, folders[i], strlen(folders[i])) == 0 && !strchr(name, '<')) {
				if (access(name, R_OK) != 0)
					fail_msg("README.md names %s", name);
				n++;
			}
	assert_true(n > 20);
	free(readme);
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

static void every_command_of_the_readme_works(void **state)
{
	(void)state;
	int blocks;
	char *readme = program_file("README.md", NULL);
	assert_non_null(readme);
	char *build = realpath(getenv("POUND_BUILD") ? getenv("POUND_BUILD") : "build/release", NULL);
	assert_non_null(build);
	setenv("POUND_BUILD", build, 1);
	char *script = script_of(readme, &blocks);
	assert_true(blocks >= 5);
	char folder[] = "/tmp/pound-test-XXXXXX", removal[64];
	assert_non_null(mkdtemp(folder));
	snprintf(removal, sizeof removal, "rm -r %s", folder);
	setenv("no_proxy", "127.0.0.1", 1);
	struct program_outcome outcome = program_run(
	    (const char *const[]){"sh", "-euc", "cd \"$1\"; eval \"$2\"", "README.md", folder, script, NULL},
	    NULL);
	program_expect(&outcome, 0);
	program_free(&outcome);
	assert_int_equal(system(removal), 0);
	free(build);
	free(script);
	free(readme);
}

CHECK_MAIN(cmocka_unit_test(every_file_the_readme_names_is_there),
           cmocka_unit_test(every_member_of_a_study_stands_in_the_readme_as_the_reader_takes_it),
           cmocka_unit_test(every_distribution_stands_in_the_readme_with_its_parameters_and_rules),
           cmocka_unit_test(the_usage_stands_in_the_readme_as_it_is_printed),
           cmocka_unit_test_setup_teardown(every_command_of_the_readme_works, program_setup,
                                           service_teardown))
