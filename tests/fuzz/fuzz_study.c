/* fuzz_study.c - any bytes as a study document: refused with reasons, or a study with a hash that the engine's
 * limits hold for.  libFuzzer: make fuzz. */
#include <stdint.h>
#include <stdlib.h>

#include "schema/study/study_json.h"

int LLVMFuzzerTestOneInput(const uint8_t *bytes, size_t length);

int LLVMFuzzerTestOneInput(const uint8_t *bytes, size_t length)
{
	static struct problems problems;
	char hex[STUDY_HASH_SIZE];
	struct pound_study *study = study_from_json((const char *)bytes, length, &problems);
	if (study ? problems.n != 0 : problems.n == 0)
		abort();
	if (!study)
		return 0;
	bool fits = study_runs(study) >= 1 && study_runs(study) <= STUDY_RUNS_MAX &&
	            (study->n_outputs >= 1 || study->kind == POUND_KIND_FLOOR_SPECTRUM) &&
	            study_samples(study) >= 2 && study_samples(study) <= STUDY_SAMPLES_MAX;
	if (!fits || !study_hash(study, hex))
		abort();
	study_free(study);
	return 0;
}
