/* client_packages.c - shell completion, a client without server libraries, the source tarball, Debian packages, the
 * container's Dockerfile. */
#include <string.h>
#include <unistd.h>

#include "engine/pound.h"
#include "schema/examples/examples.h"
#include "tests/support/check.h"
#include "tests/support/program.h"
#include "tests/support/service.h"

/* Runs a shell script with the built programs in its PATH and two arguments, $1 and $2. */
static struct program_outcome shell(const char *script, const char *first, const char *second)
{
	char *build = realpath(getenv("POUND_BUILD") ? getenv("POUND_BUILD") : "build/release", NULL),
	     *whole = NULL;
	assert_non_null(build);
	assert_true(
	    asprintf(&whole,
	             "unset MAKEFLAGS MAKELEVEL; PATH='%s':$PATH; no_proxy=127.0.0.1; export PATH no_proxy; %s",
	             build, script) > 0);
	struct program_outcome outcome =
	    program_run((const char *const[]){"sh", "-euc", whole, "sh", first, second, NULL}, NULL);
	free(whole);
	free(build);
	return outcome;
}

static bool have(const char *program)
{
	struct program_outcome outcome = shell("command -v \"$1\"", program, NULL);
	const bool has = outcome.status == 0;
	program_free(&outcome);
	return has;
}

static bool has_line(const char *text, const char *line)
{
	const size_t n = strlen(line);
	for (const char *at = text; at; at = strchr(at, '\n') ? strchr(at, '\n') + 1 : NULL)
		if (!strncmp(at, line, n) && (at[n] == '\n' || at[n] == '\t' || at[n] == '\0'))
			return true;
	return false;
}

static void every_shell_completes_commands_options_names_and_ids(void **state)
{
	static const struct {
		const char *name, *script; /* prints the completions of the last, incomplete word of "$1" */
	} shells[] = {
	    {"bash",
	     "bash --norc -c 'source client/pound.bash; read -ra COMP_WORDS <<<\"$1\"; [[ $1 == *\" \" ]] && "
	     "COMP_WORDS+=(\"\"); COMP_CWORD=$((${#COMP_WORDS[@]} - 1)); _pound pound "
	     "\"${COMP_WORDS[COMP_CWORD]}\"; printf \"%s\\n\" \"${COMPREPLY[@]}\"' bash \"$1\""},
	    {"zsh",
	     "zsh -f -c 'compadd() { print -l -- $found }; _files() { print files }; words=(\"${(@s: :)1}\"); "
	     "CURRENT=$#words; complete_it() { source client/_pound }; complete_it' zsh \"$1\""},
	    {"fish", "fish --no-config -c 'source client/pound.fish; complete -C $argv[1]' \"$1\""},
	};
	struct service *service = *state;
	char id[17], *study = service_study(4, 2, 1);
	service_submit(service, study, id);
	const struct {
		const char *typed, *offered;
	} cases[] = {
	    {"pound ex", "example"},      {"pound run --", "--threads"}, {"pound example pa", "paper_linear"},
	    {"pound plot in", "indices"}, {"pound status ", id},         {"pound plot indices ", id},
	    {"pound archive ", id},       {"pound list --ha", "--hash"},
	};
	int tried = 0;
	for (size_t s = 0; s < sizeof shells / sizeof shells[0]; s++) {
		if (!have(shells[s].name)) {
			check_report("there is no %s to complete words", shells[s].name);
			continue;
		}
		for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++, tried++) {
			struct program_outcome outcome = shell(shells[s].script, cases[i].typed, NULL);
			if (!has_line(outcome.out, cases[i].offered))
				fail_msg("%s: '%s' gives no '%s' but\n%s%s", shells[s].name, cases[i].typed, cases[i].offered,
				         outcome.out, outcome.err);
			program_free(&outcome);
		}
	}
	assert_true(tried > 0);
	free(study);
}

static void the_client_needs_no_library_of_the_server_and_none_of_curl_if_so_built(void **state)
{
	static const char *const mode = "mode=${POUND_BUILD:-build/release}; mode=${mode##*/}; ";
	char script[1024];
	(void)state;
	snprintf(
	    script, sizeof script,
	    "%s folder=$1; set -- $(make -s client MODE=$mode CURL=0); client=$1 worker=$2; readelf -d $client "
	    "$worker | "
	    "grep NEEDED; "
	    "for d in build/$mode/client/*.d build/$mode/schema/*/*.d build/$mode/engine/*/*.d; do case $d in "
	    "*/wire.d) ;; *) cat $d ;; esac; done | grep -oE '(curl|microhttpd|sqlite3)\\.h' || true; "
	    "pound example response | $client run --launcher $worker - | grep -v '^  \"timing\"' >$folder/bare; "
	    "pound example response | pound run - | grep -v '^  \"timing\"' >$folder/whole; cmp $folder/bare "
	    "$folder/whole; "
	    "! $client list 2>&1",
	    mode);
	char folder[] = "/tmp/pound-test-XXXXXX";
	assert_non_null(mkdtemp(folder));
	struct program_outcome outcome = shell(script, folder, NULL);
	program_expect(&outcome, 0);
	assert_null(strstr(outcome.out, "sqlite"));
	assert_null(strstr(outcome.out, "microhttpd"));
	assert_null(strstr(outcome.out, "libcurl.so"));
	assert_null(strstr(outcome.out, "curl.h"));
	assert_non_null(strstr(outcome.out, "libgsl.so"));
	assert_non_null(strstr(outcome.out, "this build of pound has no libcurl"));
	program_free(&outcome);
	outcome = shell("rm -r $1", folder, NULL);
	program_expect(&outcome, 0);
	program_free(&outcome);
}

static void the_tarball_has_every_source_and_the_same_bytes_each_time(void **state)
{
	(void)state;
	struct program_outcome outcome = shell(
	    "tarball=$(make -s dist); sum=$(sha256sum <$tarball); tar -tzf $tarball; make -s dist >/dev/null; [ "
	    "\"$sum\" = \"$(sha256sum <$tarball)\" ]",
	    NULL, NULL);
	program_expect(&outcome, 0);
	int n = 0;
	for (const char *c = outcome.out; *c; c++)
		n += *c == '\n';
	assert_true(has_line(outcome.out, "pound-" POUND_VERSION "/Makefile"));
	assert_true(has_line(outcome.out, "pound-" POUND_VERSION "/client/debian"));
	assert_true(has_line(outcome.out, "pound-" POUND_VERSION "/tests/client/client_packages.c"));
	assert_null(strstr(outcome.out, "/build/"));
	check_report("%d files in the tarball", n);
	program_free(&outcome);
}

/* Checks the packages that `make deb` has left; `make soak` builds them first, which takes minutes. */
static void packages_are_clean_and_their_program_gives_the_same_bytes(void **state)
{
	(void)state;
	if (check_soaks() && have("dpkg-buildpackage")) {
		struct program_outcome built = shell("make -s deb", NULL, NULL);
		program_expect(&built, 0);
		program_free(&built);
	}
	struct program_outcome outcome = shell("ls build/dist/pound-study_" POUND_VERSION
	                                       "_amd64.deb build/dist/poundd_" POUND_VERSION "_amd64.deb",
	                                       NULL, NULL);
	const bool there = outcome.status == 0;
	program_free(&outcome);
	if (!there) {
		check_report("there are no packages to look at: make deb builds them");
		skip();
	}
	char folder[] = "/tmp/pound-test-XXXXXX";
	assert_non_null(mkdtemp(folder));
	outcome =
	    shell("for p in pound-study poundd; do dpkg -x build/dist/${p}_" POUND_VERSION "_amd64.deb $1; done; "
	          "$1/usr/bin/poundd --version; ls $1/usr/lib/python3/dist-packages/pound.py "
	          "$1/usr/lib/systemd/system/poundd.service $1/usr/share/man/man8/poundd.8.gz",
	          folder, NULL);
	program_expect(&outcome, 0);
	program_free(&outcome);
	int n = 0;
	for (int i = 0; examples[i].name; i++) {
		struct program_outcome outcomes[2];
		char path[96];
		snprintf(path, sizeof path, "%s/usr/bin/pound", folder);
		if (strstr("paper paper_linear convergence extremes nonlinear until", examples[i].name))
			continue; // these run for minutes, or their results contain times
		const char *const command = strcmp(examples[i].name, "design") ? "run" : "design";
		for (int k = 0; k < 2; k++) {
			outcomes[k] =
			    program_run((const char *const[]){k ? path : "pound", command, "-", NULL}, examples[i].text);
			program_expect(&outcomes[k], 0);
			if (*command == 'r')
				service_timeless(outcomes[k].out);
		}
		assert_string_equal(outcomes[0].out, outcomes[1].out);
		program_free(&outcomes[0]);
		program_free(&outcomes[1]);
		n++;
	}
	check_report("packaged pound: the same bytes for %d examples", n);
	if (have("lintian")) {
		outcome = shell("lintian --pedantic build/dist/pound-study_" POUND_VERSION
		                "_amd64.deb build/dist/poundd_" POUND_VERSION
		                "_amd64.deb 2>/dev/null | grep -v bogus-mail-host || true",
		                NULL, NULL);
		assert_string_equal(outcome.out, "");
		program_free(&outcome);
	}
	outcome = shell("rm -r $1", folder, NULL);
	program_expect(&outcome, 0);
	program_free(&outcome);
}

/* The container has every library of the programs, its first stage every package that the Makefile needs to build them,
 * and its health check distinguishes a running server from a missing one. */
static void the_recipe_of_the_container_names_what_is_needed(void **state)
{
	struct service *service = *state;
	char *recipe = program_file("server/Dockerfile", NULL), port[16];
	assert_non_null(recipe);
	struct program_outcome needed = shell("for p in pound poundd; do ldd $(command -v $p); done | sed -n "
	                                      "'s|.*=> \\(/[^ ]*\\) .*|\\1|p' | sort -u | "
	                                      "while read -r f; do readelf -d $(command -v pound) $(command -v "
	                                      "poundd) | grep -oE '\\[lib[^]]*' | tr -d "
	                                      "'[' | sort -u | grep -qx \"${f##*/}\" && dpkg -S \"$(readlink -f "
	                                      "$f)\" | sed 's/:.*//'; done | sort -u | "
	                                      "grep -vE '^(libc6|libgcc-s1)$'",
	                                      NULL, NULL);
	program_expect(&needed, 0);
	int n = 0;
	for (char *name = strtok(needed.out, "\n"); name; name = strtok(NULL, "\n"), n++)
		if (!strstr(recipe, name))
			fail_msg("server/Dockerfile does not install %s", name);
	assert_true(n >= 6);
	program_free(&needed);
	needed = shell(
	    "sed -n '/^PACKAGES/,/[^\\\\]$/p' Makefile | tr ' ' '\\n' | grep -E '^lib.*-dev$' | grep -v cmocka",
	    NULL, NULL);
	program_expect(&needed, 0);
	for (char *name = strtok(needed.out, "\n"); name; name = strtok(NULL, "\n"))
		if (!strstr(recipe, name))
			fail_msg("server/Dockerfile does not install %s", name);
	program_free(&needed);
	free(recipe);
	snprintf(port, sizeof port, "%d", service->port);
	static const char check[] =
	    "health=$(sed -n 's/^HEALTHCHECK CMD //p' server/Dockerfile | sed s/8437/$1/); eval "
	    "\"$health\"";
	struct program_outcome outcome = shell(check, port, NULL);
	program_expect(&outcome, 0);
	program_free(&outcome);
	outcome = shell(check, "1", NULL);
	assert_int_not_equal(outcome.status, 0);
	program_free(&outcome);
	check_report("the image itself was not built");
}

#define TEST(name) cmocka_unit_test_setup_teardown(name, program_setup, service_teardown)
CHECK_MAIN(TEST(every_shell_completes_commands_options_names_and_ids),
           cmocka_unit_test(the_client_needs_no_library_of_the_server_and_none_of_curl_if_so_built),
           cmocka_unit_test(the_tarball_has_every_source_and_the_same_bytes_each_time),
           cmocka_unit_test(packages_are_clean_and_their_program_gives_the_same_bytes),
           TEST(the_recipe_of_the_container_names_what_is_needed))
