/* The files of `make install`; the manual pages and the systemd unit agree with the programs. */
#include <string.h>
#include <unistd.h>

#include "server/options.h"
#include "tests/support/check.h"
#include "tests/support/program.h"

static char folder[64], prefix[80];

static int installed(void **state)
{
	const char *build = getenv("POUND_BUILD"), *mode = strrchr(build ? build : "build/release", '/');
	char mode_is[64], prefix_is[96];
	(void)state;
	strcpy(folder, "/tmp/pound-test-XXXXXX");
	assert_non_null(mkdtemp(folder));
	snprintf(prefix, sizeof prefix, "%s/usr", folder);
	snprintf(mode_is, sizeof mode_is, "MODE=%s", mode + 1);
	snprintf(prefix_is, sizeof prefix_is, "PREFIX=%s", prefix);
	struct program_outcome outcome =
	    program_run((const char *const[]){"env", "-u", "MAKEFLAGS", "-u", "MAKELEVEL", "make", "-s",
	                                      "install", mode_is, prefix_is, NULL},
	                NULL);
	program_expect(&outcome, 0);
	program_free(&outcome);
	return 0;
}

static int removed(void **state)
{
	char removal[96];
	(void)state;
	snprintf(removal, sizeof removal, "rm -r %s", folder);
	return system(removal);
}

static char *installed_file(const char *name)
{
	char path[160];
	snprintf(path, sizeof path, "%s/%s", prefix, name);
	char *text = program_file(path, NULL);
	if (!text)
		fail_msg("%s is not installed", name);
	return text;
}

static void the_programs_the_manual_and_the_unit_are_installed(void **state)
{
	static const char ranks[] = "bin/pound-worker-mpi\n", /* only built with MPI=1 */
	    want[] =
	        "bin/pound\nbin/pound-worker\nbin/poundd\nlib/python3/dist-packages/pound.py\nlib/systemd/system/"
	        "poundd.service\n"
	        "share/bash-completion/completions/pound\nshare/fish/vendor_completions.d/pound.fish\n"
	        "share/man/man1/pound-worker.1\nshare/man/man1/pound.1\nshare/man/man8/poundd.8\nshare/zsh/"
	        "site-functions/_pound\n";
	(void)state;
	struct program_outcome files = program_run(
	    (const char *const[]){"sh", "-c", "cd \"$1\" && find . -type f | sed 's|^./||' | LC_ALL=C sort", "sh",
	                          prefix, NULL},
	    NULL);
	program_expect(&files, 0);
	char *with_ranks = strstr(files.out, ranks);
	if (with_ranks)
		memmove(with_ranks, with_ranks + strlen(ranks), strlen(with_ranks + strlen(ranks)) + 1);
	assert_string_equal(files.out, want);
	program_free(&files);
	char path[96];
	snprintf(path, sizeof path, "%s/bin/poundd", prefix);
	struct program_outcome version = program_run((const char *const[]){path, "--version", NULL}, NULL);
	program_expect(&version, 0);
	program_free(&version);
}

/* Whether a manual page contains a text, escaped as in roff. */
static bool has(const char *page, const char *text)
{
	char roff[1024], *out = roff;
	for (const char *c = text; *c && out < roff + sizeof roff - 2; c++) {
		if (*c == '-')
			*out++ = '\\';
		*out++ = *c;
	}
	*out = '\0';
	return strstr(page, roff) != NULL;
}

static void every_option_of_the_server_is_in_its_manual(void **state)
{
	char *page = installed_file("share/man/man8/poundd.8");
	(void)state;
	for (int i = 0; i < options_count; i++) {
		char flag[64];
		snprintf(flag, sizeof flag, "--%s%s", options_table[i].name, options_table[i].argument ? "=" : "");
		if (!has(page, flag) || !has(page, options_table[i].text))
			fail_msg("the manual has no %s: %s", flag, options_table[i].text);
	}
	assert_null(strchr(page, '@'));
	free(page);
}

static void every_command_is_in_the_manual_with_its_options(void **state)
{
	char *page = installed_file("share/man/man1/pound.1");
	struct program_outcome help = program_run((const char *const[]){"pound", "--help", NULL}, NULL);
	int commands = 0, options = 0;
	(void)state;
	for (char *line = strtok(help.out, "\n"); line; line = strtok(NULL, "\n")) {
		char command[32], usage[64];
		if (strncmp(line, "  ", 2) != 0 || sscanf(line, " %31[a-z]", command) != 1)
			continue;
		commands++;
		snprintf(usage, sizeof usage, ".SS pound %s ", command);
		if (!strstr(page, usage))
			fail_msg("the manual has no %s", command);
		struct program_outcome own =
		    program_run((const char *const[]){"pound", command, "--help", NULL}, NULL);
		for (const char *at = strstr(own.out, "--"); at; at = strstr(at + 2, "--")) {
			char option[64];
			if (sscanf(at, "%63[a-zA-Z=-]", option) == 1 && !has(strstr(page, usage), option))
				fail_msg("the manual has no %s of %s", option, command);
			options++;
		}
		program_free(&own);
	}
	assert_true(commands >= 10 && options > 2 * commands);
	assert_null(strchr(page, '@'));
	program_free(&help);
	free(page);
}

static bool have(const char *program)
{
	char question[96];
	snprintf(question, sizeof question, "command -v %s >/dev/null", program);
	return system(question) == 0;
}

static void the_manual_is_sound_roff(void **state)
{
	static const char *const pages[] = {"share/man/man1/pound.1", "share/man/man1/pound-worker.1",
	                                    "share/man/man8/poundd.8"};
	(void)state;
	if (!have("groff")) {
		check_report("there is no groff to read the manual");
		skip();
	}
	for (int i = 0; i < 3; i++) {
		char path[160];
		snprintf(path, sizeof path, "%s/%s", prefix, pages[i]);
		struct program_outcome outcome =
		    program_run((const char *const[]){"groff", "-man", "-Tutf8", "-ww", "-z", path, NULL}, NULL);
		program_expect(&outcome, 0);
		assert_string_equal(outcome.err, "");
		program_free(&outcome);
	}
}

static void the_unit_leaves_the_server_little_to_harm(void **state)
{
	static const char level[] = "exposure level for poundd.service: ";
	char path[160];
	(void)state;
	if (!have("systemd-analyze")) {
		check_report("there is no systemd-analyze to judge the unit");
		skip();
	}
	snprintf(path, sizeof path, "%s/lib/systemd/system/poundd.service", prefix);
	struct program_outcome verdict = program_run(
	    (const char *const[]){"systemd-analyze", "security", "--offline=true", "--no-pager", path, NULL},
	    NULL);
	program_expect(&verdict, 0);
	const char *at = strstr(verdict.out, level);
	assert_non_null(at);
	double exposure = strtod(at + strlen(level), NULL);
	check_report("systemd-analyze security --offline=true: %.1f", exposure);
	assert_true(exposure > 0 && exposure <= 2.0);
	program_free(&verdict);
	// systemd accepts every line of the unit
	verdict = program_run((const char *const[]){"systemd-analyze", "verify", "--man=no", path, NULL}, NULL);
	program_expect(&verdict, 0);
	assert_null(strstr(verdict.err, "poundd.service"));
	program_free(&verdict);
}

/* Release builds only: sanitizer builds are linked differently. */
static void the_server_is_hardened_by_its_linker(void **state)
{
	char path[96];
	(void)state;
	if (!strstr(getenv("POUND_BUILD") ? getenv("POUND_BUILD") : "build/release", "release"))
		skip();
	snprintf(path, sizeof path, "%s/bin/poundd", prefix);
	struct program_outcome parts = program_run((const char *const[]){"readelf", "-hldW", path, NULL}, NULL);
	program_expect(&parts, 0);
	assert_non_null(strstr(parts.out, "DYN (Position-Independent Executable"));
	assert_non_null(strstr(parts.out, "GNU_RELRO"));
	assert_non_null(strstr(parts.out, "BIND_NOW"));
	const char *stack = strstr(parts.out, "GNU_STACK");
	assert_non_null(stack);
	assert_null(memchr(stack + strlen("GNU_STACK"), 'E', strcspn(stack, "\n") - strlen("GNU_STACK")));
	program_free(&parts);
}

CHECK_MAIN(cmocka_unit_test_setup(the_programs_the_manual_and_the_unit_are_installed, installed),
           cmocka_unit_test(every_option_of_the_server_is_in_its_manual),
           cmocka_unit_test(every_command_is_in_the_manual_with_its_options),
           cmocka_unit_test(the_manual_is_sound_roff),
           cmocka_unit_test(the_unit_leaves_the_server_little_to_harm),
           cmocka_unit_test_teardown(the_server_is_hardened_by_its_linker, removed))
