/* The rules of `make lint`: each of them reports a small tree that violates it. */
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include "tests/support/check.h"
#include "tests/support/program.h"

struct violation {
	const char *file;
	const char *text;
	const char *rule;     /* words of the sentence that lint must print */
	const char *offender; /* words of the lines under it */
};

static const struct violation VIOLATIONS[] = {
    {"engine/run/a.c", "#include \"schema/json/json_pointer.h\"\n", "engine includes nothing",
     "engine/run/a.c:1:"},
    {"schema/b.h", "\n#include \"server/store.h\"\n", "schema includes engine", "schema/b.h:2:"},
    {"server/c.c", "#include \"client/wire.h\"\n", "server includes nothing", "server/c.c:1:"},
    {"client/d.c", "#include \"server/store.h\"\n", "client includes nothing", "client/d.c:1:"},
    {"engine/e.h", "#include <stdio.h>\n", "no input, output", "engine/e.h:1:"},
    {"server/f.c", "#include <cjson/cJSON.h>\n", "only schema", "server/f.c:1:"},
    {"server/g.c", "#include <microhttpd.h>\n", "only http_calls.h", "server/g.c:1:"},
    {"server/http.c", "#include <sqlite3.h>\n", "only database.h", "server/http.c:1:"},
    {"client/h.c", "#include <curl/curl.h>\n", "only wire.c", "client/h.c:1:"},
    {"client/i.c", "#include \"wire.h\"\n", "path from the root", "client/i.c:1:"},
    {"server/http_utils.c", "int http_utils;\n", "named by its noun", "server/http_utils.c"},
    {"engine/numeric/t.h", "#include \"engine/run/run.h\"\n", "one way", "engine/numeric/t.h:1:"},
    {"client/twin.h", "#include <stddef.h>\n", "stands for one file", "twin.h"},
    {"server/twin.h", "#include <stddef.h>\n", "stands for one file", "twin.h"},
    {"NOTES", "More.\n", "five folders", "NOTES"},
    {"engine/run/deep/u.h", "#include <stddef.h>\n", "rooms have no rooms", "engine/run/deep"},
    {"engine/r.h", "/*\n * Test     unit_r: it_is_so\n */\n", "named in a comment",
     "engine/r.h:2: unit_r: it_is_so"},
    {"schema/s.h", "#ifndef OTHER_H\n#define OTHER_H\n#endif\n", "guarded by its own name",
     "schema/s.h: S_H"},
    {"README.md", "What engine/gone.c does.\n", "files that there are", "README.md:1:engine/gone.c"},
    {"engine/j.h", "#if 0\n#endif\n", "dead code", "engine/j.h:1:"},
    {"engine/u.c",
     "int pound_u(int a, int b, int c, int (*d)(int, int),\n            int e, int f, int g)\n{\n"
     "\treturn a + b + c + d(e, f) + g;\n}\n",
     "missing struct", "engine/u.c:1: pound_u"},
    {"Makefile", "CFLAGS += -ffast-math\n", "floating point", "1:CFLAGS"},
    {"engine/k.c", "int other_name(void);\nint other_name(void)\n{\n\treturn 1;\n}\n", "start with pound_",
     "other_name"},
    {"engine/l.c", "int pound_l_count;\n", "data that changes", "pound_l_count"},
    {"engine/m.c", "static int hidden;\nint *pound_m(void);\nint *pound_m(void)\n{\n\treturn &hidden;\n}\n",
     "data that changes", "hidden"},
    {"engine/n.c",
     "int printf(const char *, ...);\nvoid pound_n(int);\nvoid pound_n(int n)\n{\n"
     "\tprintf(\"%d\", n);\n}\n",
     "prints nothing", "n.o: printf"},
    {"engine/o.c",
     "void *malloc(unsigned long);\nvoid *pound_o(void);\nvoid *pound_o(void)\n{\n"
     "\treturn malloc(8);\n}\n",
     "allocates in run.c", "o.o: malloc"},
    {"engine/p.c",
     "void *gsl_qrng_alloc(int);\nvoid *pound_p(void);\nvoid *pound_p(void)\n{\n"
     "\treturn gsl_qrng_alloc(8);\n}\n",
     "has GSL allocate", "p.o: gsl_qrng_alloc"},
    {"engine/q.c",
     "double log(double);\ndouble pound_q(double x);\ndouble pound_q(double x)\n{\n"
     "\treturn log(x);\n}\n",
     "those of elementary.h", "q.o: log"},
};

enum { N_VIOLATIONS = sizeof VIOLATIONS / sizeof VIOLATIONS[0] };

static char root[512]; /* folder of the tree under test */

static void write_file(const char *folder, const char *file, const char *text)
{
	char path[256];
	snprintf(path, sizeof path, "%s/%s", folder, file);
	FILE *out = fopen(path, "w");
	assert_non_null(out);
	fputs(text, out);
	fclose(out);
}

/* Compiles the engine of a small tree, as far as possible. */
static void build(const char *folder)
{
	char command[400];
	snprintf(command, sizeof command,
	         "cd %s && rm -f build/*.[oa] && for f in engine/*.c engine/*/*.c; do"
	         " cc -c -o build/$(basename $f .c).o $f 2>build/errors; done; ar rcs build/libpound.a build/*.o",
	         folder);
	assert_int_equal(system(command), 0);
}

static struct program_outcome lint(const char *folder)
{
	char command[1200];
	snprintf(command, sizeof command, "cd %s && exec %s/tests/lint build", folder, root);
	return program_run((const char *const[]){"sh", "-c", command, NULL}, NULL);
}

/* A tree that obeys all rules. */
static void plant(char folder[32])
{
	static const char *const folders[] = {"engine", "engine/run", "engine/numeric", "schema",
	                                      "server", "client",     "tests",          "build"};
	char path[64], text[64];
	strcpy(folder, "/tmp/pound-lint-XXXXXX");
	assert_non_null(mkdtemp(folder));
	for (size_t i = 0; i < sizeof folders / sizeof folders[0]; i++) {
		snprintf(path, sizeof path, "%s/%s", folder, folders[i]);
		assert_int_equal(mkdir(path, 0700), 0);
		snprintf(path, sizeof path, "%s/a%zu.h", folders[i], i);
		snprintf(text, sizeof text, "#ifndef A%zu_H\n#define A%zu_H\n#endif\n", i, i);
		write_file(folder, path, text);
	}
	write_file(folder, "engine/run/run.c", "extern const int pound_run_one;\nconst int pound_run_one = 1;\n");
	write_file(folder, "Makefile", "CFLAGS += -O2\n");
	write_file(folder, "README.md", "Nothing.\n");
	char *format = program_file(".clang-format", NULL);
	write_file(folder, ".clang-format", format);
	free(format);
	build(folder);
}

static void uproot(const char *folder)
{
	char command[64];
	snprintf(command, sizeof command, "rm -rf %s", folder);
	assert_int_equal(system(command), 0);
}

static void a_tree_that_keeps_the_rules_passes(void **state)
{
	char folder[32];
	(void)state;
	plant(folder);
	struct program_outcome outcome = lint(folder);
	assert_string_equal(outcome.out, "");
	assert_int_equal(outcome.status, 0);
	program_free(&outcome);
	uproot(folder);
}

/* Whether lint printed a sentence, and under it the violation. */
static bool named(const char *said, const struct violation *v)
{
	const char *rule = strstr(said, v->rule), *line = rule ? strchr(rule, '\n') : NULL;
	for (; line && strncmp(line, "\n    ", 5) == 0; line = strchr(line + 1, '\n')) {
		const char *offender = strstr(line + 1, v->offender);
		if (offender && offender < line + 1 + strcspn(line + 1, "\n"))
			return true;
	}
	return false;
}

static void every_rule_names_what_breaks_it(void **state)
{
	char folder[32];
	(void)state;
	plant(folder);
	char deep[64];
	snprintf(deep, sizeof deep, "%s/engine/run/deep", folder);
	assert_int_equal(mkdir(deep, 0700), 0);
	for (int i = 0; i < N_VIOLATIONS; i++)
		write_file(folder, VIOLATIONS[i].file, VIOLATIONS[i].text);
	build(folder);
	struct program_outcome outcome = lint(folder);
	program_expect(&outcome, 1);
	for (int i = 0; i < N_VIOLATIONS; i++)
		if (!named(outcome.out, &VIOLATIONS[i])) {
			fprintf(stderr, "%s is not named in\n%s", VIOLATIONS[i].file, outcome.out);
			fail();
		}
	program_free(&outcome);
	uproot(folder);
}

static void layout_is_decided_by_clang_format_where_it_is(void **state)
{
	char folder[32];
	(void)state;
	struct program_outcome version =
	    program_run((const char *const[]){"clang-format", "--version", NULL}, NULL);
	if (version.status != 0 || !strstr(version.out, "version 14.")) {
		program_free(&version);
		skip();
	}
	plant(folder);
	write_file(folder, "client/b.c", "int  x;\n");
	struct program_outcome outcome = lint(folder);
	program_expect(&outcome, 1);
	assert_non_null(strstr(outcome.out, "clang-format"));
	assert_non_null(strstr(outcome.out, "client/b.c:1"));
	program_free(&outcome);
	program_free(&version);
	uproot(folder);
}

static void a_file_of_701_lines_is_named(void **state)
{
	char folder[32], text[1500] = "";
	(void)state;
	plant(folder);
	memset(text, '\n', 700);
	write_file(folder, "tests/b.h", text);
	struct program_outcome outcome = lint(folder);
	assert_null(strstr(outcome.out, "700 lines"));
	program_free(&outcome);
	memset(text, '\n', 701);
	write_file(folder, "tests/b.h", text);
	outcome = lint(folder);
	assert_non_null(strstr(outcome.out, "tests/b.h: 701 lines"));
	program_free(&outcome);
	uproot(folder);
}

int main(int argc, char **argv)
{
	const struct CMUnitTest tests[] = {
	    cmocka_unit_test(a_tree_that_keeps_the_rules_passes),
	    cmocka_unit_test(every_rule_names_what_breaks_it),
	    cmocka_unit_test(layout_is_decided_by_clang_format_where_it_is),
	    cmocka_unit_test(a_file_of_701_lines_is_named),
	};
	(void)argc;
	if (!getcwd(root, sizeof root))
		return 1;
	return check_run(argv[0], tests, (int)(sizeof tests / sizeof tests[0]));
}
