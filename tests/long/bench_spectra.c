/* bench_spectra.c - benchmarks of floor spectra: of one signal, and their cost in studies. */
#include "tests/long/bench.h"

#include <stdlib.h>

#include "engine/run/floor_outputs.h"
#include "schema/study/study_json.h"

enum { REPEATS = 20, STUDIES = 3 };

static const double GOAL = 5e-3; /* [s] */

static const char signal[] =
    "{\"kind\": \"floor_spectrum\", \"scene\": {"
    "\"oscillators\": [{\"mass_kg\": 1, \"frequency_hz\": 2}, {\"mass_kg\": 1.7, \"frequency_hz\": 3.1}],"
    "\"contact\": {\"stiffness_ratio\": 100, \"restitution\": 0.6, \"gap_m\": 0},"
    "\"excitation\": {\"type\": \"kanai_tajimi\", \"frequency_hz\": 1, \"cycles\": 20, \"signals\": 1}}}";

#define SENSITIVITY(outputs)                                                                               \
	"{\"kind\": \"sensitivity\", \"scene\": {\"oscillators\": [{\"frequency_hz\": 2}, {\"frequency_hz\": " \
	"3}]},"                                                                                                \
	"\"inputs\": [{\"path\": \"/oscillators/1/mass_kg\", \"name\": \"m\", \"distribution\": {\"type\": "   \
	"\"reciprocal_uniform\", \"max\": 6}}, {\"path\": \"/contact/restitution\", \"name\": \"eps\", "       \
	"\"distribution\": {\"type\": \"uniform\", \"min\": 0, \"max\": 1}}], \"design\": {\"rows\": "         \
	"40}, " outputs "}"

/* ---- one signal ---- */

struct ridden {
	struct pound_floor *floor;
	void *scratch;
	const struct pound_task *task;
	int n_drives;
	double *psa[POUND_DRIVES];
};

static void move(void *of)
{
	const struct ridden *ridden = of;
	const struct pound_floor_ask ask = {
	    .task = ridden->task, .n_drives = ridden->n_drives, .radians = 1.5, .scratch = ridden->scratch};
	struct pound_floor_answer answer = {.psa = {ridden->psa[0], ridden->psa[1]}};
	if (pound_floor_spectra(ridden->floor, &ask, &answer, 1))
		bench_fail("a floor could not be followed");
}

static void leave(void *into, const struct pound_outcome *outcome)
{
	(void)into, (void)outcome;
}

static void one_signal(void)
{
	struct pound_study *study = bench_study(signal);
	struct pound_run *run = pound_run_create(study, 1);
	struct pound_work work = {0};
	if (!run || pound_request_run(run->requests[0], (struct pound_items){&run->campaign, 0, 1}, run->stop,
	                              &work, leave, NULL))
		bench_fail("out of memory");
	const struct pound_request_floor floor = pound_request_floor(run->requests[0], 0);
	struct ridden with = {.task = floor.pounding, .n_drives = 1, .scratch = floor.scratch};
	with.floor = pound_floor_init(bench_memory(pound_floor_bytes(study->spectrum.n)), &study->spectrum);
	for (int d = 0; d < POUND_DRIVES; d++)
		with.psa[d] = bench_memory(sizeof(double) * (size_t)study->spectrum.n);
	struct ridden both = with, without = with;
	both.n_drives = POUND_DRIVES;
	without.task = floor.free;
	struct bench_job jobs[] = {{move, &with, 0}, {move, &both, 0}, {move, &without, 0}};
	bench_jobs(jobs, 3, REPEATS);
	bench_print((struct bench_row){.what = "spectrum of 200 frequencies, 20 s with 91 contacts",
	                               .value = 1e3 * jobs[0].seconds,
	                               .unit = "ms",
	                               .goal = "at most 5 ms",
	                               .met = jobs[0].seconds <= GOAL});
	bench_print((struct bench_row){
	    .what = "the spectrum of the contact force alone", .value = 1e3 * jobs[1].seconds, .unit = "ms"});
	bench_print((struct bench_row){.what = "without pounding", .value = 1e3 * jobs[2].seconds, .unit = "ms"});
	for (int d = 0; d < POUND_DRIVES; d++)
		free(with.psa[d]);
	free(with.floor);
	pound_run_free(run);
	study_free(study);
}

/* ---- studies ---- */

static void study_run(void *of)
{
	struct pound_run *run = pound_run_create(of, 1);
	if (!run)
		bench_fail("out of memory");
	for (int b = 0; b < pound_run_blocks(run); b++)
		if (pound_run_block(run, b, 0))
			bench_fail("a block of a study failed");
	pound_run_free(run);
}

/* The blocks only: reductions are the same for every output. */
static void studies(void)
{
	struct pound_study *without = bench_study(SENSITIVITY("\"outputs\": [\"impulse\"]"));
	struct pound_study *with =
	    bench_study(SENSITIVITY("\"outputs\": [\"impulse\", \"floor_spectrum\"], \"spectrum\": "
	                            "{\"frequencies_hz\": [0.5, 1, 2, 4, 8, 16, 32, 64]}"));
	struct bench_job jobs[] = {{study_run, without, 0}, {study_run, with, 0}};
	bench_jobs(jobs, 2, STUDIES);
	double runs = (double)study_runs(without);
	bench_print((struct bench_row){.what = "a run of a sensitivity study without spectra, 8 s",
	                               .value = 1e6 * jobs[0].seconds / runs,
	                               .unit = "us"});
	bench_print((struct bench_row){.what = "a run of the same with ordinates at 8 frequencies",
	                               .value = 1e6 * jobs[1].seconds / runs,
	                               .unit = "us",
	                               .ratio = jobs[1].seconds / jobs[0].seconds,
	                               .to = "times one without"});
	study_free(without);
	study_free(with);
}

void bench_spectra(void)
{
	one_signal();
	studies();
}
