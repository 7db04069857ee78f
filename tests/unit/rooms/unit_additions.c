/* unit_additions.c - the table of additions in engine/rooms.md is complete: source files and pages on documents and
 * results that name the newest member of a kind are named in its row. */
#include <stdlib.h>
#include <string.h>

#include "tests/support/check.h"
#include "tests/support/program.h"

static const struct addition {
	const char *kind;   /* first cell of the row */
	const char *newest; /* as grep -w finds it in sources */
} additions[] = {
    {"a law", "\"origin_oriented\""},
    {"a law", "`origin_oriented`"},
    {"a contact model", "\"rigid\""},
    {"an excitation", "\"white_noise\""},
    {"an output", "\"hysteresis_energy_ratio_right\""},
    {"a damping form", "\"modal\""},
    {"a floor spectrum", "\"dirac_peaks\""},
    {"an estimator, a distribution, a design", "\"azzini_rosati\""},
    {"an estimator, a distribution, a design", "\"discrete\""},
    {"an estimator, a distribution, a design", "\"sobol\""},
    {"a solver", "\"adaptive\""},
    {"a figure", "\"widths\""},
    {"an option of poundd", "\"restore\""},
    {"a subcommand", "\"report\""},
};

/* The row of a kind; fails the test if there is none. */
static char *row_of(const char *kind)
{
	char *page = program_file("engine/rooms.md", NULL), head[128];
	assert_non_null(page);
	snprintf(head, sizeof head, "\n| %s | ", kind);
	const char *row = strstr(page, head);
	char *copy = row ? strndup(row, 1 + strcspn(row + 1, "\n")) : NULL;
	if (!copy)
		fail_msg("engine/rooms.md has no row of %s", kind);
	free(page);
	return copy;
}

static void the_newest_member_of_every_kind_is_named_where_its_row_says_and_nowhere_else(void **state)
{
	(void)state;
	int missing = 0;
	for (size_t i = 0; i < sizeof additions / sizeof additions[0]; i++) {
		char command[400], file[200], *row = row_of(additions[i].kind);
		snprintf(command, sizeof command,
		         "grep -rlF --include='*.[ch]' --include='*.inl' --include='*.sql' -e '%s' engine schema "
		         "server client tests/support/oracle* tests/support/scenes*; "
		         "grep -lF -e '%s' schema/*.md || :",
		         additions[i].newest, additions[i].newest);
		int n = 0;
		FILE *found = popen(command, "r");
		assert_non_null(found);
		while (fgets(file, sizeof file, found)) {
			file[strcspn(file, "\n")] = '\0';
			n++;
			if (strstr(row, file) || (strstr(row, "its file") && strncmp(file, "engine/", 7) == 0))
				continue;
			print_error("%s: %s is named in %s\n", additions[i].kind, additions[i].newest, file);
			missing++;
		}
		assert_int_equal(pclose(found), 0);
		assert_true(n > 0);
		free(row);
	}
	assert_int_equal(missing, 0);
}

CHECK_MAIN(cmocka_unit_test(the_newest_member_of_every_kind_is_named_where_its_row_says_and_nowhere_else))
