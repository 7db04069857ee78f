/* The rules that `make lint` keeps: the tree keeps them, and each of them bites on a small tree that breaks it. */
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include "tests/check.h"
#include "tests/program.h"

struct violation {
	const char *file;
	const char *text;
	const char *rule; /* words of the sentence lint must print */
};

static const struct violation VIOLATIONS[] = {
    {"engine/x.c", "#include \"schema/reading.h\"\n", "engine includes nothing"},
    {"schema/x.h", "#include \"server/store.h\"\n", "schema includes engine"},
    {"server/x.c", "#include \"client/wire.h\"\n", "server includes nothing"},
    {"client/x.c", "#include \"server/store.h\"\n", "client includes nothing"},
    {"engine/x.c", "#include <stdio.h>\n", "no input, output"},
    {"server/x.c", "#include <cjson/cJSON.h>\n", "only schema"},
    {"server/x.c", "#include <microhttpd.h>\n", "only http.c"},
    {"server/http.c", "#include <sqlite3.h>\n", "only store.c"},
    {"client/x.c", "#include <curl/curl.h>\n", "only wire.c"},
    {"client/x.c", "#include \"wire.h\"\n", "path from the root"},
    {"server/http_utils.c", "int http_utils;\n", "named by its noun"},
    {"engine/x.c", "#if 0\n#endif\n", "dead code"},
    {"Makefile", "CFLAGS += -ffast-math\n", "floating point"},
    {"client/x.c", "int  x;\n", "clang-format"},
    {"engine/run.c", "int other_name(void);\nint other_name(void)\n{\n\treturn 1;\n}\n", "start with pound_"},
    {"engine/run.c", "int pound_run_count;\n", "data that changes"},
    {"engine/run.c", "static int n;\nint *pound_run_n(void);\nint *pound_run_n(void)\n{\n\treturn &n;\n}\n",
     "data that changes"},
    {"engine/run.c",
     "int printf(const char *, ...);\nvoid pound_run_say(int);\nvoid pound_run_say(int n)\n{\n"
     "\tprintf(\"%d\", n);\n}\n",
     "prints nothing"},
    {"engine/x.c",
     "void *malloc(unsigned long);\nvoid *pound_x(void);\nvoid *pound_x(void)\n{\n"
     "\treturn malloc(8);\n}\n",
     "allocates in run.c"},
};

enum { N_VIOLATIONS = sizeof VIOLATIONS / sizeof VIOLATIONS[0] };

static char root[512]; /* of the tree under test */

static void write_file(const char *folder, const char *file, const char *text)
{
	char path[256];
	snprintf(path, sizeof path, "%s/%s", folder, file);
	FILE *out = fopen(path, "w");
	assert_non_null(out);
	fputs(text, out);
	fclose(out);
}

/* Builds the engine of a small tree, as far as it compiles. */
static void build(const char *folder)
{
	char command[400];
	snprintf(command, sizeof command,
	         "cd %s && rm -f build/*.[oa] && for f in engine/*.c; do"
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

/* A tree that keeps all rules. */
static void plant(char folder[32])
{
	static const char *const folders[] = {"engine", "schema", "server", "client", "tests", "build"};
	char path[64];
	strcpy(folder, "/tmp/pound-lint-XXXXXX");
	assert_non_null(mkdtemp(folder));
	for (size_t i = 0; i < sizeof folders / sizeof folders[0]; i++) {
		snprintf(path, sizeof path, "%s/%s", folder, folders[i]);
		assert_int_equal(mkdir(path, 0700), 0);
		snprintf(path, sizeof path, "%s/a.h", folders[i]);
		write_file(folder, path, "#include <stddef.h>\n");
	}
	write_file(folder, "engine/run.c", "extern const int pound_run_one;\nconst int pound_run_one = 1;\n");
	write_file(folder, "Makefile", "CFLAGS += -O2\n");
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

static void every_rule_names_what_breaks_it(void **state)
{
	(void)state;
	struct program_outcome formatter =
	    program_run((const char *const[]){"clang-format", "--version", NULL}, NULL);
	bool formats = formatter.status == 0 && strstr(formatter.out, "version 14.");
	program_free(&formatter);
	char folder[32], path[128];
	plant(folder);
	for (int i = 0; i < N_VIOLATIONS; i++) {
		const struct violation *v = &VIOLATIONS[i];
		if (strcmp(v->rule, "clang-format") == 0 && !formats)
			continue;
		snprintf(path, sizeof path, "%s/%s", folder, v->file);
		char *before = program_file(path, NULL);
		bool compiled = strncmp(v->file, "engine/", 7) == 0;
		write_file(folder, v->file, v->text);
		if (compiled)
			build(folder);
		struct program_outcome outcome = lint(folder);
		if (outcome.status != 1 || !strstr(outcome.out, v->rule)) {
			print_error("%s with\n%s: status %d, said\n%s%s\n", v->file, v->text, outcome.status, outcome.out,
			            outcome.err);
			fail();
		}
		program_free(&outcome);
		if (before)
			write_file(folder, v->file, before);
		else
			unlink(path);
		free(before);
		if (compiled)
			build(folder);
	}
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
	    cmocka_unit_test(a_file_of_701_lines_is_named),
	};
	(void)argc;
	if (!getcwd(root, sizeof root))
		return 1;
	return check_run(argv[0], tests, (int)(sizeof tests / sizeof tests[0]));
}
