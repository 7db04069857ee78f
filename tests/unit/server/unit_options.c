/* Every option of poundd, as a flag and from the environment, and as documented in server/server.md. */
#include "server/options.h"

#include <string.h>

#include "tests/support/check.h"
#include "tests/support/program.h"

/* The message of poundd for a value, by flag or environment. */
static void refused(const struct option_row *row, const char *value, bool flag)
{
	char name[64], word[128];
	options_variable(row, name, sizeof name);
	snprintf(word, sizeof word, "--%s=%s", row->name, value);
	if (!flag)
		setenv(name, value, 1);
	struct program_outcome outcome =
	    program_run((const char *const[]){"poundd", flag ? word : NULL, NULL}, NULL);
	unsetenv(name);
	assert_int_not_equal(outcome.status, 0);
	snprintf(word, sizeof word, "poundd: %s%s must", flag ? "--" : "", flag ? row->name : name);
	if (!strstr(outcome.err, word) || (*value && !strstr(outcome.err, value)))
		fail_msg("%s=%s: %s", name, value, outcome.err);
	program_free(&outcome);
}

static void every_option_is_taken_as_a_flag_and_from_the_environment(void **state)
{
	char program[] = "poundd", word[128], name[64];
	(void)state;
	for (const struct option_row *row = options_table; row < options_table + options_count; row++) {
		struct options by_flag, by_variable, both;
		const char *value = row->max == 0 ? "text" : row->max > 1 ? "2" : "1";
		options_variable(row, name, sizeof name);
		snprintf(word, sizeof word, row->argument ? "--%s=%s" : "--%s", row->name, value);
		options_read(&by_flag, 2, (char *[]){program, word, NULL});
		setenv(name, value, 1);
		options_read(&by_variable, 1, (char *[]){program, NULL});
		setenv(name, row->max == 0 ? "other" : "1", 1);
		options_read(&both, 2, (char *[]){program, word, NULL});
		unsetenv(name);
		const struct options *all[] = {&by_flag, &by_variable, &both};
		for (int i = 0; i < 3; i++) {
			const char *at = (const char *)all[i] + row->offset;
			if (row->max == 0)
				assert_string_equal(*(const char *const *)(const void *)at, value);
			else
				assert_int_equal(*(const int *)(const void *)at, atoi(value));
		}
	}
}

static void what_an_option_does_not_take_is_refused_by_name(void **state)
{
	(void)state;
	for (const struct option_row *row = options_table; row < options_table + options_count; row++) {
		char most[16];
		snprintf(most, sizeof most, "%lld", (long long)row->max + 1);
		for (int flag = 0; flag < 2; flag++) {
			if (flag && !row->argument)
				continue;
			// an empty variable is ignored
			if (row->max > 0 || flag)
				refused(row, row->max == 0 ? "" : "x", flag);
			if (row->max > 0) {
				refused(row, most, flag);
				refused(row, "-1", flag);
				refused(row, "1x", flag);
			}
		}
	}
}

/* Sets every variable to a value; NULL: removes them. */
static void set_variables(const char *value)
{
	for (const struct option_row *row = options_table; row < options_table + options_count; row++) {
		char name[64];
		options_variable(row, name, sizeof name);
		if (value)
			setenv(name, value, 1);
		else
			unsetenv(name);
	}
}

static void what_a_flag_overrides_is_not_judged(void **state)
{
	char program[] = "poundd", word[128], name[64];
	(void)state;
	for (const struct option_row *row = options_table; row < options_table + options_count; row++) {
		const char *value = row->max == 0 ? "text" : "1";
		struct options options;
		options_variable(row, name, sizeof name);
		snprintf(word, sizeof word, row->argument ? "--%s=%s" : "--%s", row->name, value);
		setenv(name, "x", 1);
		options_read(&options, 2, (char *[]){program, word, NULL});
		unsetenv(name);
		const char *at = (const char *)&options + row->offset;
		if (row->max == 0)
			assert_string_equal(*(const char *const *)(const void *)at, value);
		else
			assert_int_equal(*(const int *)(const void *)at, 1);
	}
}

static void an_empty_variable_is_none(void **state)
{
	char program[] = "poundd";
	struct options without, with;
	(void)state;
	options_read(&without, 1, (char *[]){program, NULL});
	set_variables("");
	options_read(&with, 1, (char *[]){program, NULL});
	set_variables(NULL);
	assert_memory_equal(&with, &without, sizeof with);
}

static void help_and_the_version_are_had_with_any_environment(void **state)
{
	static const char *const flags[] = {"--help", "--version"};
	(void)state;
	for (int i = 0; i < 2; i++) {
		set_variables("x");
		struct program_outcome outcome = program_run((const char *const[]){"poundd", flags[i], NULL}, NULL);
		set_variables(NULL);
		program_expect(&outcome, 0);
		assert_true(outcome.n_out > 0);
		program_free(&outcome);
	}
}

static void every_option_stands_in_the_docs(void **state)
{
	char *page = program_file("server/server.md", NULL);
	int missing = 0;
	(void)state;
	assert_non_null(page);
	for (const struct option_row *row = options_table; row < options_table + options_count; row++) {
		char name[64], line[400];
		options_variable(row, name, sizeof name);
		snprintf(line, sizeof line, "| `--%s%s%s` | `%s` | %s | %s |\n", row->name, row->argument ? " " : "",
		         row->argument ? row->argument : "", name, row->absent && row->argument ? row->absent : "-",
		         row->text);
		if (!strstr(page, line)) {
			print_error("server/server.md has no line\n%s", line);
			missing++;
		}
	}
	free(page);
	assert_int_equal(missing, 0);
}

CHECK_MAIN(cmocka_unit_test(every_option_is_taken_as_a_flag_and_from_the_environment),
           cmocka_unit_test(what_an_option_does_not_take_is_refused_by_name),
           cmocka_unit_test(what_a_flag_overrides_is_not_judged), cmocka_unit_test(an_empty_variable_is_none),
           cmocka_unit_test(help_and_the_version_are_had_with_any_environment),
           cmocka_unit_test(every_option_stands_in_the_docs))
