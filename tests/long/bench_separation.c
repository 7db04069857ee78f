/* bench_separation.c - cost of a gap curve relative to its runs without contact, and of outputs relative to their runs. */
#include <stdio.h>
#include <stdlib.h>

#include "schema/result/result_json.h"
#include "schema/study/study_json.h"
#include "tests/long/bench.h"

enum { REPEATS = 7, LAWS = 2 };

static void study_run(void *of)
{
	struct pound_run *run = pound_run_create(of, 1);
	size_t length;
	for (int block = 0; block < pound_run_blocks(run); block++)
		if (pound_run_block(run, block, 0))
			bench_fail("a block failed");
	for (int k = 0; k < pound_run_reductions(run); k++)
		if (pound_run_reduce(run, k, 0))
			bench_fail("a reduction failed");
	char *json = result_to_json(of, pound_run_result(run), NULL, &length);
	if (!json)
		bench_fail("out of memory");
	free(json);
	pound_run_free(run);
}

void bench_separation(void)
{
	static const char *const laws[LAWS] = {"{\"type\": \"linear\"}",
	                                       "{\"type\": \"elastoplastic\", \"yield_displacement_m\": 0.01}"};
	static const char *const kinds[] = {"\"response\", \"outputs\": [\"peak_displacement_m\"]",
	                                    "\"separation\""};
	for (int law = 0; law < LAWS; law++) {
		struct bench_job jobs[2];
		for (int k = 0; k < 2; k++) {
			char document[512];
			snprintf(document, sizeof document,
			         "{\"kind\": %s, \"scene\": {\"law\": %s, \"oscillators\": [{\"frequency_hz\": 1.1}, "
			         "{\"frequency_hz\": 1.7}], \"contact\": null, \"excitation\": {\"signals\": 1000}}}",
			         kinds[k], laws[law]);
			jobs[k] = (struct bench_job){.run = study_run, .of = bench_study(document)};
		}
		bench_jobs(jobs, 2, REPEATS);
		const double ratio = jobs[1].seconds / jobs[0].seconds;
		bench_print((struct bench_row){
		    .what = bench_text("a gap curve of 1000 signals, %s bodies, with its result as JSON",
		                       law ? "elastoplastic" : "linear"),
		    .value = 1e3 * jobs[1].seconds,
		    .unit = "ms",
		    .ratio = ratio,
		    .to = "of its runs without contact",
		    .goal = "at most 1.2",
		    .met = ratio <= 1.2});
		for (int k = 0; k < 2; k++)
			study_free(jobs[k].of);
	}
}

/* Cost of outputs of a pair that need additional runs; runs that no output needs are left out. */
void bench_outputs(void)
{
	static const struct {
		const char *what, *outputs;
	} asked[] = {{NULL, "\"peak_displacement_m\", \"peak_impulse_n_s\""},
	             {"forces and approach speeds", "\"peak_contact_force_n\", \"peak_approach_speed_m_s\""},
	             {"accelerations with and without pounding", "\"acceleration_amplification\""},
	             {"energies lost", "\"contact_energy_ratio\""}};
	enum { ASKED = sizeof asked / sizeof asked[0] };
	struct bench_job jobs[ASKED];
	for (int k = 0; k < ASKED; k++) {
		char document[512];
		snprintf(
		    document, sizeof document,
		    "{\"kind\": \"response\", \"scene\": {\"oscillators\": [{\"frequency_hz\": 1.1}, "
		    "{\"frequency_hz\": 1.7}], \"contact\": {\"gap_m\": 0.01}, \"excitation\": {\"signals\": 500}}, "
		    "\"outputs\": [%s]}",
		    asked[k].outputs);
		jobs[k] = (struct bench_job){.run = study_run, .of = bench_study(document)};
	}
	bench_jobs(jobs, ASKED, REPEATS);
	for (int k = 1; k < ASKED; k++)
		bench_print((struct bench_row){.what = bench_text("500 signals with pounding and %s", asked[k].what),
		                               .value = 1e3 * jobs[k].seconds,
		                               .unit = "ms",
		                               .ratio = jobs[k].seconds / jobs[0].seconds,
		                               .to = "of the study without that output"});
	for (int k = 0; k < ASKED; k++)
		study_free(jobs[k].of);
}
