/* unit_replicates.c - outputs of a random model with a column for each replicate, against closed forms. */
#include <math.h>
#include <string.h>

#include "schema/external/external_model.h"
#include "schema/json/json_pointer.h"
#include "schema/study/study_json.h"
#include "tests/support/check.h"
#include "tests/support/results.h"

#define UNIFORM     "\"distribution\": {\"type\": \"uniform\", \"min\": 0, \"max\": 1}}"
#define INPUTS      "{\"inputs\": [{\"name\": \"p\", " UNIFORM ", {\"name\": \"q\", " UNIFORM "], "
#define INDEPENDENT INPUTS "\"design\": {\"rows\": 1000}}"
#define COMMON      INPUTS "\"design\": {\"rows\": 1000, \"signals\": \"common\"}}"

static double index_of(const struct reading *result, int input, const char *name)
{
	return reading_number(result, "/cells/0/outputs/0/inputs/%d/%s", input, name);
}

/* An additive function of two inputs with noise: if common, all samples of a row share four factors, else each has its own. */
static char *noisy_csv(const struct pound_study *study, bool common, double noise)
{
	char *csv = NULL;
	size_t n;
	struct pound_run *run = pound_run_create(study, 1);
	FILE *out = open_memstream(&csv, &n);
	fputs("z.replicate1,z.replicate2,z.replicate3,z.replicate4\n", out);
	uint64_t state = 1;
	double factor[4] = {1, 1, 1, 1};
	for (int row = 0; row < pound_run_rows(run); row++)
		for (int sample = 0; sample < pound_run_samples(run); sample++) {
			double x[2];
			pound_run_sample_inputs(run, row, sample, x);
			for (int r = 0; r < 4; r++) {
				// uniform with variance noise^2
				state = state * 6364136223846793005u + 1442695040888963407u;
				if (!common || sample == 0)
					factor[r] = 1 + noise * sqrt(12.0) * ((double)(state >> 11) * 0x1p-53 - 0.5);
				fprintf(out, r ? ",%.17g" : "%.17g", (x[0] + 2 * x[1]) * factor[r]);
			}
			fputc('\n', out);
		}
	fclose(out);
	pound_run_free(run);
	return csv;
}

static void replicates_take_their_noise_out_of_the_indices(void **state)
{
	(void)state;
	static const char *const documents[] = {INDEPENDENT, COMMON};
	for (int common = 0; common < 2; common++) {
		struct pound_study *study = results_design(documents[common]);
		char *csv = noisy_csv(study, common, 0.5);
		struct reading *result = results_of_lines(documents[common], csv);
		assert_string_equal(reading_text(result, "/cells/0/outputs/0/name"), "z");
		check_near(reading_number(result, "/cells/0/runs"), 4 * 4 * 1000, 0);
		for (int j = 0; j < 2; j++) {
			// variances 1/12 and 4/12, no interaction
			const double exact = j ? 0.8 : 0.2;
			static const char *const names[] = {"S1", "ST"};
			for (int k = 0; k < 2; k++) {
				char low[8], high[8];
				snprintf(low, sizeof low, "%s_low", names[k]);
				snprintf(high, sizeof high, "%s_high", names[k]);
				const double half = (index_of(result, j, high) - index_of(result, j, low)) / 2;
				// four standard errors
				check_near(index_of(result, j, names[k]), exact, 2.04 * half);
				assert_true(half < 0.1);
			}
		}
		// the noise of a mean of four: E z^2 (1/4) (1/4) against 5/12, E z^2 = 9/4 + 5/12
		const double noise = (9.0 / 4 + 5.0 / 12) / 16;
		check_near(reading_number(result, "/cells/0/outputs/0/noise_share"), noise / (5.0 / 12 + noise),
		           0.04);
		reading_close(result);
		free(csv);
		study_free(study);
	}
}

static void replicates_without_noise_are_the_output_itself(void **state)
{
	(void)state;
	struct pound_study *study = results_design(INDEPENDENT);
	char *copies = noisy_csv(study, false, 0), *csv = strdup(copies), *to = csv;
	// the first column only
	for (const char *from = copies; *from; from = strchr(from, '\n') + 1) {
		const size_t n = strcspn(from, ",");
		memcpy(to, from, n);
		to[n] = '\n';
		to += n + 1;
	}
	*to = 0;
	memset(csv + 1, ' ', strlen("z.replicate1") - 1);
	struct reading *one = results_of_lines(INDEPENDENT, csv), *two = results_of_lines(INDEPENDENT, copies);
	for (int j = 0; j < 2; j++) {
		check_near(index_of(two, j, "S1_raw"), index_of(one, j, "S1_raw"), 0);
		check_near(index_of(two, j, "ST_raw"), index_of(one, j, "ST_raw"), 0);
	}
	reading_close(one);
	reading_close(two);
	study_free(study);
	free(csv);
	free(copies);
}

static void replicates_must_be_complete(void **state)
{
	(void)state;
	static const char *const headers[] = {"y.replicate1\n", "y.replicate1,y.replicate3\n",
	                                      "y.replicate1,y.replicate2,z.replicate1\n",
	                                      "y.replicate1,y.replicate2,y\n", "y.replicate0,y.replicate1\n"};
	struct pound_study *study = results_design(INDEPENDENT);
	for (size_t k = 0; k < sizeof headers / sizeof headers[0]; k++) {
		struct problems problems;
		size_t n;
		assert_null(model_indices(study, headers[k], strlen(headers[k]), &problems, &n));
		assert_int_equal(problems.status, PROBLEMS_INVALID);
		assert_non_null(strstr(problems.list[0].detail, "replicates"));
	}
	study_free(study);
}

CHECK_MAIN(cmocka_unit_test(replicates_take_their_noise_out_of_the_indices),
           cmocka_unit_test(replicates_without_noise_are_the_output_itself),
           cmocka_unit_test(replicates_must_be_complete))
