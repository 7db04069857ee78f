/* bench_march.c - benchmarks of the exact solver on the reference scene: against the plain loop, by lanes, by law,
 * and in other scenes. */
#include "tests/long/bench.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "engine/exact/task.h"
#include "engine/ground/excitation.h"
#include "engine/numeric/random.h"
#include "engine/run/scene.h"
#include "schema/study/study_json.h"
#include "tests/support/baseline_loop.h"
#include "tests/support/oracle.h"
#include "tests/support/scenes.h"

enum {
	SIGNALS = 1000,
	LOOPED = 50,  /* number of signals through the plain loop */
	OTHERS = 100, /* number of signals in other scenes */
	REPEATS = 9,  /* other programs often disturb a measurement */
};

static const char reference[] =
    "{\"kind\": \"response\", \"scene\": {"
    "\"oscillators\": [{\"mass_kg\": 1, \"frequency_hz\": 2}, {\"mass_kg\": 1.7, \"frequency_hz\": 3.1}],"
    "\"contact\": {\"stiffness_ratio\": 100, \"restitution\": 0.6, \"gap_m\": 0},"
    "\"excitation\": {\"type\": \"kanai_tajimi\", \"frequency_hz\": 1, \"cycles\": 20, \"signals\": 1000}}}";

/* ---- batches of tasks ---- */

struct batch {
	int n, lanes; /* lanes 0: the widest available */
	struct pound_task *tasks;
	struct pound_task_result *results;
};

static struct batch batch_create(int n)
{
	return (struct batch){.n = n,
	                      .tasks = bench_memory(sizeof(struct pound_task) * (size_t)n),
	                      .results = bench_memory(sizeof(struct pound_task_result) * (size_t)n)};
}

static void batch_free(struct batch *batch)
{
	free(batch->tasks);
	free(batch->results);
}

static struct batch batch_copy(const struct batch *from, int n)
{
	struct batch batch = batch_create(n);
	memcpy(batch.tasks, from->tasks, sizeof *batch.tasks * (size_t)n);
	return batch;
}

static _Alignas(64) char scratch[POUND_EXACT_SCRATCH];

static void batch_run(void *of)
{
	const struct batch *batch = of;
	pound_exact_lanes(batch->lanes, batch->tasks, batch->results, batch->n, scratch, NULL);
}

static double batch_contacts(const struct batch *batch)
{
	double contacts = 0;
	for (int j = 0; j < batch->n; j++)
		contacts += (double)batch->results[j].contacts;
	return contacts;
}

static double batch_samples(const struct batch *batch)
{
	return (double)batch->n * (batch->tasks[0].n_samples - 1);
}

/* Signals of an excitation, one after another.
 *
 * Given    n_samples  of one signal
 */
static void signals_make(const struct pound_excitation *e, int n_signals, int n_samples, double *ground)
{
	struct pound_signal signals[POUND_SIGNALS_MAX];
	for (int j = 0, waiting = 0; j < n_signals; j++) {
		signals[waiting++] =
		    (struct pound_signal){.excitation = e,
		                          .noise = {.seed = 1, .what = POUND_STREAM_NOISE, .signal = (uint32_t)j},
		                          .a = ground + (size_t)j * (size_t)n_samples};
		if (waiting == POUND_SIGNALS_MAX || j == n_signals - 1) {
			pound_signals_fill(signals, waiting);
			waiting = 0;
		}
	}
}

/* A task for each signal of a scene, with all ground motions in one array that the caller frees. */
static struct batch scene_batch(const struct pound_scene *scene, double **ground)
{
	const struct pound_excitation *e = &scene->excitation;
	int n = pound_excitation_samples(e);
	struct batch batch = batch_create(e->signals);
	*ground = bench_memory(sizeof **ground * (size_t)n * (size_t)e->signals);
	struct pound_task task = {.n_samples = n, .time_step = e->time_step};
	for (int i = 0; i < POUND_OSCILLATORS; i++)
		task.bodies[i] = pound_scene_body(scene, i);
	task.bodies[0].followed = true;
	pound_scene_contact(scene, &task);
	signals_make(e, e->signals, n, *ground);
	for (int j = 0; j < e->signals; j++) {
		batch.tasks[j] = task;
		batch.tasks[j].ground = *ground + (size_t)j * (size_t)n;
	}
	return batch;
}

/* ---- against the plain loop ---- */

struct loop {
	const char *name;
	struct baseline_result (*run)(const struct pound_task *task, int steps);
	int steps; /* steps per sample */
	const struct batch *batch;
	double impulse[LOOPED];
};

static void loop_run(void *of)
{
	struct loop *loop = of;
	for (int j = 0; j < LOOPED; j++)
		loop->impulse[j] = loop->run(&loop->batch->tasks[j], loop->steps).impulse_max;
}

static int ascending(const void *a, const void *b)
{
	double x = *(const double *)a, y = *(const double *)b;
	return (x > y) - (x < y);
}

/* Median over LOOPED signals of the relative error of the largest impulse. */
static double impulse_error(const double impulse[static LOOPED], const struct batch *exact)
{
	double errors[LOOPED];
	for (int j = 0; j < LOOPED; j++)
		errors[j] = fabs(impulse[j] / exact->results[j].impulse_max - 1);
	qsort(errors, LOOPED, sizeof errors[0], ascending);
	return 0.5 * (errors[LOOPED / 2 - 1] + errors[LOOPED / 2]);
}

/* The error of the event solver, estimated by its result for the same ground motion with twice as many samples. */
static double own_error(const struct batch *exact)
{
	int n = exact->tasks[0].n_samples, finer = 2 * n - 1;
	double *ground = bench_memory(sizeof *ground * LOOPED * (size_t)finer), impulse[LOOPED];
	struct batch batch = batch_copy(exact, LOOPED);
	for (int j = 0; j < LOOPED; j++) {
		const double *a = exact->tasks[j].ground;
		double *b = ground + (size_t)j * (size_t)finer;
		for (int i = 0; i < finer; i++)
			b[i] = 0.5 * (a[i / 2] + a[(i + 1) / 2]);
		batch.tasks[j].ground = b;
		batch.tasks[j].n_samples = finer;
		batch.tasks[j].time_step *= 0.5;
	}
	batch_run(&batch);
	for (int j = 0; j < LOOPED; j++)
		impulse[j] = batch.results[j].impulse_max;
	double error = impulse_error(impulse, exact);
	batch_free(&batch);
	free(ground);
	return error;
}

/* The error of the event solver, or of the oracle if larger, by comparison with an independent integrator. */
static double oracle_error(const struct pound_scene *scene, const struct batch *exact)
{
	const struct oracle_method method = {.radians = 0.005, .located = true};
	double impulse[LOOPED];
	for (int j = 0; j < LOOPED; j++) {
		const struct oracle_motion motion = {.time_step = exact->tasks[j].time_step,
		                                     .n = exact->tasks[j].n_samples,
		                                     .acceleration = exact->tasks[j].ground};
		impulse[j] =
		    oracle_response(scene, &motion, &method, NULL, NULL).impulse_max / scene->oscillators[0].mass;
	}
	return impulse_error(impulse, exact);
}

static void event_rows(const struct pound_scene *scene, const struct batch *exact, double seconds)
{
	double own = own_error(exact), other = oracle_error(scene, exact);
	bench_print((struct bench_row){
	    .what = bench_text("reference scene, %d signals of 20 s: a run by the event solver", exact->n),
	    .value = 1e6 * seconds,
	    .unit = "us"});
	bench_print((struct bench_row){.what = "its own error, with samples twice as dense",
	                               .error = own,
	                               .goal = "below 1e-9",
	                               .met = own < 1e-9});
	bench_print((struct bench_row){.what = "its error by an independent integrator, steps of 0.005 rad",
	                               .error = other,
	                               .goal = "below 1e-9",
	                               .met = other < 1e-9});
}

/* The reference scene by the event solver and by central differences: time of a run, error of the largest impulse. */
void bench_reference(void)
{
	struct pound_study *study = bench_study(reference);
	double *ground;
	struct batch exact = scene_batch(&study->scene, &ground);
	struct loop loops[] = {
	    {.name = "plain", .run = baseline_plain, .steps = 10},
	    {.name = "plain", .run = baseline_plain, .steps = 100},
	    {.name = "plain", .run = baseline_plain, .steps = 1000},
	    {.name = "tuned", .run = baseline_tuned, .steps = 100},
	};
	enum { LOOPS = sizeof loops / sizeof loops[0] };
	struct bench_job jobs[LOOPS + 1] = {{.run = batch_run, .of = &exact}};
	for (int k = 0; k < LOOPS; k++) {
		loops[k].batch = &exact;
		jobs[k + 1] = (struct bench_job){.run = loop_run, .of = &loops[k]};
	}
	bench_jobs(jobs, LOOPS + 1, REPEATS);

	double event = jobs[0].seconds / exact.n;
	event_rows(&study->scene, &exact, event);
	for (int k = 0; k < LOOPS; k++) {
		double loop = jobs[k + 1].seconds / LOOPED, step = study->scene.excitation.time_step / loops[k].steps;
		bench_print((struct bench_row){
		    .what = bench_text("a run by a %s loop of central differences, step %g s", loops[k].name, step),
		    .value = 1e6 * loop,
		    .unit = "us",
		    .ratio = loop / event,
		    .to = "times the event solver",
		    .error = impulse_error(loops[k].impulse, &exact),
		    .goal = k == 1 ? "at least 50" : NULL,
		    .met = loop / event >= 50});
	}
	batch_free(&exact);
	free(ground);
	study_free(study);
}

/* ---- the kernel ---- */

/* Time of a sample of two bodies always separated, of a sample with contacts, and the additional time of a contact, by lanes. */
static void lanes_rows(const struct batch *pounding, const struct batch *apart)
{
	static const int widths[] = {1, 4, 8};
	enum { WIDTHS = sizeof widths / sizeof widths[0] };
	struct batch batches[2 * WIDTHS];
	struct bench_job jobs[2 * WIDTHS];
	for (int k = 0; k < 2 * WIDTHS; k++) {
		batches[k] = k % 2 ? *apart : *pounding;
		batches[k].lanes = widths[k / 2];
		jobs[k] = (struct bench_job){.run = batch_run, .of = &batches[k]};
	}
	bench_jobs(jobs, 2 * WIDTHS, REPEATS);
	double samples = batch_samples(pounding), contacts = batch_contacts(pounding);
	for (int w = 0; w < WIDTHS; w++) {
		const struct bench_job *with = &jobs[2 * w], *without = &jobs[2 * w + 1];
		const struct {
			const char *what;
			double of, one; /* with these lanes, with one lane */
		} rows[] = {
		    {"a sample without contact", without->seconds / samples, jobs[1].seconds / samples},
		    {"a sample in all", with->seconds / samples, jobs[0].seconds / samples},
		    {"more for a contact", (with->seconds - without->seconds) / contacts,
		     (jobs[0].seconds - jobs[1].seconds) / contacts},
		};
		bool runs = pound_exact_lanes(widths[w], NULL, NULL, 0, scratch, NULL);
		for (size_t r = 0; r < sizeof rows / sizeof rows[0] && runs; r++)
			bench_print(
			    (struct bench_row){.what = bench_text("%d lane%s: %s", widths[w], w ? "s" : "", rows[r].what),
			                       .value = 1e9 * rows[r].of,
			                       .unit = "ns",
			                       .ratio = rows[r].one / rows[r].of,
			                       .to = "times as fast as one lane"});
	}
}

/* Time of a run for every law, with the yield displacement at half of the largest displacement without contact. */
static void law_rows(const struct batch *linear, const struct batch *apart)
{
	enum { LAWS = SPECIMEN_LAWS };
	struct batch batches[LAWS];
	struct bench_job jobs[LAWS];
	for (int law = 0; law < LAWS; law++) {
		batches[law] = batch_copy(linear, linear->n);
		jobs[law] = (struct bench_job){.run = batch_run, .of = &batches[law]};
		for (int j = 0; j < linear->n; j++)
			for (int i = 0; i < POUND_OSCILLATORS; i++) {
				struct pound_backbone *backbone = &batches[law].tasks[j].bodies[i].backbone;
				backbone->law = law;
				backbone->yield = 0.5 * apart->results[j].displacement_max[i];
			}
	}
	bench_jobs(jobs, LAWS, REPEATS);
	for (int law = 0; law < LAWS; law++) {
		bench_print((struct bench_row){.what = bench_text("a run with %s oscillators", pound_law_name(law)),
		                               .value = 1e6 * jobs[law].seconds / linear->n,
		                               .unit = "us",
		                               .ratio = jobs[law].seconds / jobs[0].seconds,
		                               .to = "times linear"});
		batch_free(&batches[law]);
	}
}

/* the reference scene with one change */
struct variant {
	const char *what;
	double stiffness_ratio, restitution;
	bool clipped; /* without tension */
	bool apart;   /* without contact */
	double faster;
	const char *goal;
};

static struct batch variant_batch(const struct variant *v, const struct pound_scene *scene,
                                  const struct batch *like)
{
	struct batch batch = batch_copy(like, OTHERS);
	struct pound_scene with = *scene;
	with.contact.stiffness_ratio = v->stiffness_ratio;
	with.contact.restitution = v->restitution;
	with.contact.tension = !v->clipped;
	for (int i = 0; i < POUND_OSCILLATORS; i++)
		with.oscillators[i].frequency_hz *= v->faster;
	for (int j = 0; j < OTHERS; j++) {
		for (int i = 0; i < POUND_OSCILLATORS; i++) {
			const bool followed = batch.tasks[j].bodies[i].followed;
			batch.tasks[j].bodies[i] = pound_scene_body(&with, i);
			batch.tasks[j].bodies[i].followed = followed;
		}
		pound_scene_contact(&with, &batch.tasks[j]);
		batch.tasks[j].contact = !v->apart;
	}
	return batch;
}

/* Time of a run with stiffer contacts, without restitution or tension, without contact, and with faster bodies. */
static void variant_rows(const struct pound_scene *scene, const struct batch *like)
{
	static const char goal[] = "at most 3";
	static const struct variant variants[] = {
	    {"K/k = 100", 1e2, 0.6, .faster = 1},
	    {"K/k = 10000", 1e4, 0.6, .faster = 1, .goal = goal},
	    {"K/k = 1e+06", 1e6, 0.6, .faster = 1, .goal = goal},
	    {"K/k = 1e+08", 1e8, 0.6, .faster = 1, .goal = goal},
	    {"restitution 0", 1e2, 0, .faster = 1},
	    {"no tension", 1e2, 0.6, true, .faster = 1},
	    {"restitution 0 and no tension", 1e2, 0, true, .faster = 1},
	    {"bodies separated", 1e2, 0.6, .apart = true, .faster = 1},
	    {"bodies separated, of 16 and 24.8 Hz", 1e2, 0.6, .apart = true, .faster = 8},
	};
	enum { VARIANTS = sizeof variants / sizeof variants[0] };
	struct batch batches[VARIANTS];
	struct bench_job jobs[VARIANTS];
	for (int k = 0; k < VARIANTS; k++) {
		batches[k] = variant_batch(&variants[k], scene, like);
		jobs[k] = (struct bench_job){.run = batch_run, .of = &batches[k]};
	}
	bench_jobs(jobs, VARIANTS, REPEATS);
	for (int k = 0; k < VARIANTS; k++) {
		double ratio = jobs[k].seconds / jobs[0].seconds;
		bench_print((struct bench_row){.what = bench_text("a run with %s, %.0f contacts", variants[k].what,
		                                                  batch_contacts(&batches[k]) / OTHERS),
		                               .value = 1e6 * jobs[k].seconds / OTHERS,
		                               .unit = "us",
		                               .ratio = ratio,
		                               .to = "times K/k = 100",
		                               .goal = variants[k].goal,
		                               .met = ratio <= 3});
		batch_free(&batches[k]);
	}
}

struct motions {
	const struct pound_excitation *excitation;
	int n_samples;
	double *ground; /* (SIGNALS x n_samples) */
};

static void motions_fill(void *of)
{
	const struct motions *motions = of;
	signals_make(motions->excitation, SIGNALS, motions->n_samples, motions->ground);
}

static void signal_rows(const struct pound_excitation *e)
{
	int n = pound_excitation_samples(e);
	struct motions motions = {
	    .excitation = e, .n_samples = n, .ground = bench_memory(sizeof(double) * SIGNALS * (size_t)n)};
	struct bench_job job = {.run = motions_fill, .of = &motions};
	bench_jobs(&job, 1, REPEATS);
	bench_print((struct bench_row){.what = bench_text("ground motions of %d samples, one thread", n),
	                               .value = SIGNALS / job.seconds,
	                               .unit = "a second"});
	bench_print((struct bench_row){
	    .what = "a sample of them", .value = 1e9 * job.seconds / SIGNALS / n, .unit = "ns"});
	free(motions.ground);
}

/* The reference scene through the exact solver by lanes, by law and in other scenes, and the generation of ground motions. */
void bench_kernel(void)
{
	struct pound_study *study = bench_study(reference);
	double *ground;
	struct batch pounding = scene_batch(&study->scene, &ground), apart = batch_copy(&pounding, pounding.n);
	for (int j = 0; j < apart.n; j++) {
		apart.tasks[j].contact = false;
		apart.tasks[j].bodies[1].followed = true;
	}
	lanes_rows(&pounding, &apart);
	law_rows(&pounding, &apart);
	variant_rows(&study->scene, &pounding);
	signal_rows(&study->scene.excitation);
	batch_free(&apart);
	batch_free(&pounding);
	free(ground);
	study_free(study);
}
