/* Inputs kept from fuzzing (tests/corpus/NAME) are replayed through their targets, and the examples through the
 * readers.  A target that detects a fault aborts. */
#include <dirent.h>
#include <string.h>

#include "tests/support/check.h"
#include "tests/support/program.h"

#define LLVMFuzzerTestOneInput fuzz_json
#include "tests/fuzz/fuzz_json.c"
#undef LLVMFuzzerTestOneInput
#define LLVMFuzzerTestOneInput fuzz_study
#include "tests/fuzz/fuzz_study.c"
#undef LLVMFuzzerTestOneInput
#define LLVMFuzzerTestOneInput fuzz_head
#include "tests/fuzz/fuzz_head.c"
#undef LLVMFuzzerTestOneInput
#define LLVMFuzzerTestOneInput fuzz_path
#include "tests/fuzz/fuzz_path.c"
#undef LLVMFuzzerTestOneInput

#define LLVMFuzzerTestOneInput fuzz_figure
#include "tests/fuzz/fuzz_figure.c"
#undef LLVMFuzzerTestOneInput

/* Runs a target on every file of a folder; returns their number. */
static int replayed(const char *folder, int (*target)(const uint8_t *bytes, size_t length))
{
	int n = 0;
	DIR *files = opendir(folder);
	assert_non_null(files);
	for (struct dirent *file = readdir(files); file; file = readdir(files)) {
		char path[512];
		size_t length;
		if (file->d_name[0] == '.')
			continue;
		snprintf(path, sizeof path, "%s/%s", folder, file->d_name);
		char *bytes = program_file(path, &length);
		assert_non_null(bytes);
		assert_int_equal(target((const uint8_t *)bytes, length), 0);
		free(bytes);
		n++;
	}
	closedir(files);
	return n;
}

static void the_corpora_of_the_fuzzers_pass_their_targets(void **state)
{
	static const struct {
		const char *folder;
		int (*target)(const uint8_t *bytes, size_t length);
	} corpora[] = {
	    {"tests/corpus/json", fuzz_json},     {"tests/corpus/study", fuzz_study},
	    {"tests/corpus/head", fuzz_head},     {"tests/corpus/path", fuzz_path},
	    {"tests/corpus/figure", fuzz_figure}, {"schema/examples", fuzz_json},
	    {"schema/examples", fuzz_study},
	};
	(void)state;
	for (size_t i = 0; i < sizeof corpora / sizeof corpora[0]; i++) {
		int n = replayed(corpora[i].folder, corpora[i].target);
		check_report("%s: %d", corpora[i].folder, n);
		assert_true(n >= 10);
	}
}

CHECK_MAIN(cmocka_unit_test(the_corpora_of_the_fuzzers_pass_their_targets))
