/* scenes.c - response studies built in C. */
#include "tests/support/scenes.h"
#include "engine/scene/contact.h"

#include <assert.h>
#include <float.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

#include "engine/run/scene.h"

static const double pi = 3.14159265358979323846;

// clang-format off
const struct specimen_reference specimen_references[SPECIMEN_REFERENCES] = {
	/* name               f1    f2    m2      eps   K/k  gap   tension contacts
	 *   first start       first speed     max u1          max u2            max impulse     end u1            end u2 */
	{"A",                 1.0,  2.5,  2,      0.6,  100, 0,    true,   7,
	    .746232167723,     .224212769587,  .03687529426,   .0065691881009,   .236645435429,  -5.88023995069e-4, 4.65933703491e-4},
	{"A, no tension",     1.0,  2.5,  2,      0.6,  100, 0,    false,  7,
	    .746232167723,     .224212769587,  .03687529426,   .00670937915699,  .241450432488,   8.01784036823e-6, 6.7329622993e-4},
	{"D",                 1.0,  2.5,  2,      0.6,  1e4, 0,    true,   7,
	    .746232167723,     .224212769587,  .03687529426,   .00652957010282,  .238906816782,  -6.40223388774e-4, 5.59148420806e-4},
	{"B",                 1.0,  2.5,  2,      0.6,  100, 0.01, true,   1,
	    .794216441975,     .189878824093,  .03687529426,   .00666765871103,  .197800326659,   1.82618659129e-3, 3.22430943441e-4},
	{"B, no tension",     1.0,  2.5,  2,      0.6,  100, 0.01, false,  1,
	    .794216441975,     .189878824093,  .03687529426,   .00678716528806,  .201882572513,   1.52126389156e-3, 3.25390714071e-4},
	{"C",                 0.5,  5.0,  6,      0.0,  100, 0,    false,  3,
	    1.2530044906,      .256412769723,  .0885240981558, .00122570090273,  .249620269104,  -1.42082803705e-3, -1.06129560819e-5},
	{"E",                 0.5,  5.0,  1 / 6., 1.0,  100, 0,    true,  10,
	    1.2530044906,      .256412769723,  .0885240981558, .0178151583003,   .112418272066,  -.036985211958,    -6.00619131115e-4},
};
// clang-format on

static int row_of(const char *(*name)(int), const char *wanted)
{
	int row = 0;
	while (strcmp(name(row), wanted) != 0)
		row++;
	return row;
}

/* A response study with one record of two zeros. */
void specimen_init(struct specimen *specimen)
{
	*specimen = (struct specimen){
	    .study = {
	        .kind = POUND_KIND_RESPONSE,
	        .scene =
	            {
	                .law = {.type = row_of(pound_law_name, "linear"),
	                        .hardening_ratio = 0.05,
	                        .target_demand = 2,
	                        .corrections = 1},
	                .oscillators = {{.mass = 1, .frequency_hz = 1, .damping_ratio = 0.05},
	                                {.mass = 1, .frequency_hz = 2.5, .damping_ratio = 0.05}},
	                .contact = {.present = true,
	                            .model = row_of(pound_contact_name, "kelvin_voigt"),
	                            .stiffness_ratio = 100,
	                            .restitution = 0.6,
	                            .tension = true},
	                .excitation = {.type = row_of(pound_excitation_name, "record"), .signals = 1},
	            },
	        .n_outputs = 1,
	        .outputs = {row_of(pound_output_name, "impulse")},
	        .solver = {.method = row_of(pound_solver_name, "event"), .tolerance = 1e-9},
	    }};
	specimen_record(specimen, 0.01, 2);
}

/* Frees the record. */
void specimen_free(struct specimen *specimen)
{
	free(specimen->record);
}

/* Sets the law of the scene. */
void specimen_law(struct specimen *specimen, const char *name, double yield)
{
	specimen->study.scene.law.type = row_of(pound_law_name, name);
	specimen->study.scene.law.yield_displacement = yield;
}

/* Sets the excitation to a record of zeros; allocates. */
double *specimen_record(struct specimen *specimen, double time_step, int n)
{
	struct pound_excitation *e = &specimen->study.scene.excitation;
	free(specimen->record);
	specimen->record = calloc((size_t)n, sizeof *specimen->record);
	assert(specimen->record);
	e->time_step = time_step;
	e->n_record = n;
	e->factor = 1;
	e->record = specimen->record;
	return specimen->record;
}

/* Sets the record to a half sine followed by zeros.
 *
 * Straight lines between samples of sin(w t) are the convolution of those samples with a triangle, which multiplies
 * the sine by sinc^2(w step / 2); after division by this factor only images at multiples of the sampling rate remain.
 */
void specimen_half_sine(struct specimen *specimen, double peak, double pulse, double duration,
                        double time_step)
{
	int n_pulse = (int)lround(pulse / time_step);
	double *a = specimen_record(specimen, time_step, (int)lround(duration / time_step) + 1);
	double half = 0.5 * pi / n_pulse;
	double triangle = sin(half) / half * (sin(half) / half);
	for (int t = 1; t < n_pulse; t++)
		a[t] = peak * sin(pi * t / n_pulse) / triangle;
}

/* Next number of a stream (Steele, Lea and Flood 2014, SplitMix64), scaled. */
double specimen_uniform(uint64_t *stream, double low, double high)
{
	uint64_t z = *stream += 0x9e3779b97f4a7c15;
	z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9;
	z = (z ^ (z >> 27)) * 0x94d049bb133111eb;
	return low + (high - low) * (double)((z ^ (z >> 31)) >> 11) * 0x1p-53;
}

/* Sets the record to a sum of twelve sines of random frequency (0.3 to 8 Hz), phase and amplitude. */
void specimen_noise(struct specimen *specimen, uint64_t seed, double peak, double time_step, int n)
{
	enum { SINES = 12 };
	double *a = specimen_record(specimen, time_step, n);
	for (int s = 0; s < SINES; s++) {
		double w = 2 * pi * specimen_uniform(&seed, 0.3, 8);
		double phase = specimen_uniform(&seed, 0, 2 * pi);
		double share = specimen_uniform(&seed, 0, 4 * peak / SINES);
		for (int t = 0; t < n; t++)
			a[t] += share * sin(w * t * time_step + phase);
	}
}

const char *const specimen_laws[SPECIMEN_LAWS] = {"linear", "elastoplastic", "nonlinear_elastic",
                                                  "origin_oriented"};

static void random_oscillator(struct pound_oscillator *o, uint64_t *stream)
{
	o->frequency_hz = specimen_uniform(stream, 0.5, 5);
	o->mass = specimen_uniform(stream, 1, 6);
	o->damping_ratio = fmax(0, specimen_uniform(stream, -0.02, 0.1));
}

static void random_law(struct specimen *specimen, uint64_t *stream, int number)
{
	struct pound_scene *scene = &specimen->study.scene;
	// of the order of the displacements: a fraction of the static displacement under 1 m/s2 at 1 Hz
	double given = specimen_uniform(stream, -0.01, 0.01);
	specimen_law(specimen, specimen_laws[number % SPECIMEN_LAWS], fmax(0, given));
	scene->law.hardening_ratio = fmax(0, specimen_uniform(stream, -0.05, 0.3));
	scene->law.target_demand = specimen_uniform(stream, 1.2, 4);
	scene->law.corrections = specimen_uniform(stream, 0, 3) >= 1; // values of a search: see unit_yield
	if (specimen_uniform(stream, 0, 1) > 0.25)
		return;
	struct pound_law common = scene->law;
	specimen_law(specimen, specimen_laws[(int)specimen_uniform(stream, 0, SPECIMEN_LAWS)], fmax(0, -given));
	scene->oscillators[1].law = scene->law;
	scene->oscillators[1].has_law = true;
	scene->law = common;
}

/* Sets a random scene determined by a number; the law, tension and first sample depend on its remainders. */
void specimen_random(struct specimen *specimen, int number, double time_step, int n)
{
	uint64_t stream = 1000 + (uint64_t)number;
	specimen_init(specimen);
	struct pound_scene *scene = &specimen->study.scene;
	random_law(specimen, &stream, number);
	random_oscillator(&scene->oscillators[0], &stream);
	random_oscillator(&scene->oscillators[1], &stream);
	scene->oscillators[1].rigid_wall = specimen_uniform(&stream, 0, 1) < 0.15;
	scene->contact.stiffness_ratio = pow(10, specimen_uniform(&stream, 1, 4));
	scene->contact.restitution = fmin(1, fmax(0, specimen_uniform(&stream, -0.1, 1.1)));
	scene->contact.gap = fmax(0, specimen_uniform(&stream, -0.01, 0.01));
	scene->contact.tension = number / 4 % 2;
	specimen_noise(specimen, stream, 1, time_step, n);
	if (number % 3 == 0)
		specimen->record[0] = 0;
}

/* Contact force at a sample, as a share of the plateau: it rises, stays, oscillates, and is 0 in the last 50 samples. */
static double pressing(int t, int rise, int from, int period, double share, int n)
{
	if (t >= n - 50)
		return 0;
	double to_and_fro = t < from ? 0 : abs((t - from + period) % (2 * period) - period) - period;
	return fmin(1, (double)t / rise) + share * to_and_fro;
}

static int uniform_of(uint64_t *stream, const int *choices, int n)
{
	return choices[(int)specimen_uniform(stream, 0, n)];
}

void specimen_creeping(struct specimen *specimen, int number, int parts)
{
	enum { SAMPLES = 301 };
	static const int rises[] = {1, 5, 10, 100}, froms[] = {110, 150, 200}, periods[] = {3, 7, 20, 50};
	uint64_t stream = 2000 + (uint64_t)number;
	specimen_init(specimen);
	struct pound_scene *scene = &specimen->study.scene;
	specimen_law(specimen, specimen_laws[1 + number % (SPECIMEN_LAWS - 1)],
	             pow(10, specimen_uniform(&stream, -11, -2)));
	scene->law.hardening_ratio = fmax(0, specimen_uniform(&stream, -0.1, 0.3));
	for (int i = 0; i < POUND_OSCILLATORS; i++) {
		scene->oscillators[i].frequency_hz = pow(10, specimen_uniform(&stream, -0.3, i ? 1.5 : 1));
		scene->oscillators[i].damping_ratio = fmax(0, specimen_uniform(&stream, -0.02, 0.05));
	}
	scene->oscillators[1].rigid_wall = specimen_uniform(&stream, 0, 1) < 0.5;
	scene->oscillators[1].mass = pow(10, specimen_uniform(&stream, -3, 3));
	scene->contact.stiffness_ratio = pow(10, specimen_uniform(&stream, 3, 9));
	scene->contact.restitution = fmax(0, specimen_uniform(&stream, -0.5, 0.5));
	scene->contact.tension = number / 3 % 2;
	const int rise = uniform_of(&stream, rises, 4), from = uniform_of(&stream, froms, 3);
	const int period = uniform_of(&stream, periods, 4);
	const double share = pow(10, specimen_uniform(&stream, -17, -1.5)),
	             step = specimen_uniform(&stream, 0.005, 0.02);
	double *a = specimen_record(specimen, step / parts, parts * (SAMPLES - 1) + 1);
	for (int k = 0; k <= parts * (SAMPLES - 1); k++) {
		const double here = pressing(k / parts, rise, from, period, share, SAMPLES);
		const double next = pressing(k / parts + 1, rise, from, period, share, SAMPLES);
		a[k] = -(here + (next - here) * (k % parts) / parts);
	}
}

void specimen_alike(struct specimen *specimen, int number, int law)
{
	uint64_t stream = 3000 + (uint64_t)number;
	specimen_init(specimen);
	struct pound_scene *scene = &specimen->study.scene;
	const double frequency = pow(10, specimen_uniform(&stream, -0.3, 1));
	const int roundings = 1 + (int)specimen_uniform(&stream, 0, 20);
	scene->oscillators[0].frequency_hz = frequency;
	scene->oscillators[1].frequency_hz = frequency * (1 + roundings * DBL_EPSILON);
	scene->oscillators[1].mass = pow(10, specimen_uniform(&stream, -1, 1));
	scene->contact.stiffness_ratio = pow(10, specimen_uniform(&stream, 2, 6));
	scene->contact.restitution = fmin(1, fmax(0, specimen_uniform(&stream, -0.5, 1.5)));
	scene->contact.tension = number % 2;
	specimen_law(specimen, specimen_laws[law], law ? pow(10, specimen_uniform(&stream, -4, -2)) : 0);
	specimen_noise(specimen, stream, 1, 0.01, 1001);
}

/* Sets the scene and the record of a reference. */
void specimen_reference(struct specimen *specimen, const struct specimen_reference *reference,
                        double time_step)
{
	struct pound_scene *scene = &specimen->study.scene;
	scene->oscillators[0].frequency_hz = reference->f1;
	scene->oscillators[1].frequency_hz = reference->f2;
	scene->oscillators[1].mass = reference->m2;
	scene->contact.restitution = reference->restitution;
	scene->contact.stiffness_ratio = reference->stiffness_ratio;
	scene->contact.gap = reference->gap;
	scene->contact.tension = reference->tension;
	specimen_half_sine(specimen, 1, 0.5, 3, time_step);
}

const double specimen_textbook_u[SPECIMEN_TEXTBOOK] = {.0318,  .2274, .6336, 1.1339, 1.4896,
                                                       1.4480, .9037, .0579, -.7578, -1.2432};

void specimen_textbook(struct specimen *specimen, int t)
{
	const double mass = 0.2533, stiffness = 10, force = 10;
	specimen_init(specimen);
	struct pound_scene *scene = &specimen->study.scene;
	scene->contact.present = false;
	scene->oscillators[0].mass = mass;
	scene->oscillators[0].frequency_hz = sqrt(stiffness / mass) / (2 * pi);
	double *a = specimen_record(specimen, 0.1, t + 1);
	for (int i = 0; i <= t && i < 6; i++)
		a[i] = -force / mass * sin(pi * i / 6);
}

void specimen_bouncing(struct specimen *specimen)
{
	enum { SAMPLES = 2000000 };
	specimen_init(specimen);
	struct pound_scene *scene = &specimen->study.scene;
	scene->oscillators[0].damping_ratio = 0;
	scene->oscillators[1].rigid_wall = true;
	scene->contact.stiffness_ratio = 1e10;
	scene->contact.restitution = 1;
	double *a = specimen_record(specimen, 0.01, SAMPLES);
	for (int t = 0; t < SAMPLES; t++)
		a[t] = -1;
}

struct pound_task specimen_impact(double restitution, bool tension, int n_samples)
{
	static const double still[1000];
	double stiffness = 7.9e3, ratio = 0.5; // contact, N/m; m1/m2
	double zeta = pound_contact_damping_ratio(0, restitution);
	return (struct pound_task){.ground = still,
	                           .n_samples = n_samples,
	                           .time_step = 0.01,
	                           .bodies = {{.v = 1}, {.v = -0.5}},
	                           .contact = true,
	                           .gap = 0.1,
	                           .contact_stiffness = stiffness,
	                           .contact_damping = 2 * zeta * sqrt(stiffness / (1 + ratio)),
	                           .mass_ratio = ratio,
	                           .tension = tension};
}

static struct {
	void (*act)(void *);
	void *of;
	clockid_t clock; /* CPU clock of the computing thread */
	double from;     /* [s] */
} later;

double specimen_seconds(clockid_t clock)
{
	struct timespec now;
	clock_gettime(clock, &now);
	return (double)now.tv_sec + 1e-9 * (double)now.tv_nsec;
}

static void *later_act(void *argument)
{
	const struct timespec pause = {.tv_nsec = 1000000};
	while (specimen_seconds(later.clock) < later.from + 0.05)
		nanosleep(&pause, NULL);
	later.act(later.of);
	return argument;
}

pthread_t specimen_later(void act(void *), void *of)
{
	pthread_t thread;
	later.act = act;
	later.of = of;
	int failed = pthread_getcpuclockid(pthread_self(), &later.clock);
	later.from = specimen_seconds(later.clock);
	failed |= pthread_create(&thread, NULL, later_act, NULL);
	assert(!failed);
	return thread;
}

enum pound_status specimen_compute(struct pound_run *run)
{
	enum pound_status status = POUND_OK;
	for (int block = 0; block < pound_run_blocks(run) && !status; block++)
		status = pound_run_block(run, block, 0);
	for (int reduction = 0; reduction < pound_run_reductions(run) && !status; reduction++)
		status = pound_run_reduce(run, reduction, 0);
	return status;
}

struct pound_run *specimen_run(const struct pound_study *study)
{
	struct pound_run *run = pound_run_create(study, 1);
	assert(run);
	enum pound_status status = specimen_compute(run);
	assert(status == POUND_OK);
	return run;
}

/* Response of the specimen by the engine; the run must succeed. */
struct pound_response specimen_engine(const struct specimen *specimen)
{
	struct pound_run *run = specimen_run(&specimen->study);
	const struct pound_result *result = pound_run_result(run);
	assert(result->n_cells == 1 && result->cells[0].n_signals == 1 && result->cells[0].runs_failed == 0);
	struct pound_response response = result->cells[0].signals[0];
	pound_run_free(run);
	return response;
}

/* Response of the specimen by the oracle with located events. */
struct pound_response specimen_oracle(const struct specimen *specimen, double radians)
{
	const struct pound_excitation *e = &specimen->study.scene.excitation;
	const struct oracle_motion motion = {e->time_step, e->n_record, e->record};
	const struct oracle_method method = {.radians = radians, .located = true};
	return oracle_response(&specimen->study.scene, &motion, &method, NULL, NULL);
}

struct pound_task specimen_pressed(uint64_t *seed)
{
	static const double push[] = {-1, -1, -1, -1};
	const double k = 100, xi = specimen_uniform(seed, 0.01, 1);
	struct pound_task task = {.ground = push, .n_samples = 4, .contact = true, .tension = true};
	task.bodies[0] = (struct pound_task_body){
	    .backbone = {.stiffness = k}, .damping = 2 * xi * sqrt(k), .drive = 1, .followed = true};
	task.contact_stiffness = k * pow(10, specimen_uniform(seed, -1, 2));
	task.contact_damping = 2 * specimen_uniform(seed, 0, 1) * sqrt(task.contact_stiffness);
	task.time_step = specimen_uniform(seed, 0.3, 1) / sqrt(k + task.contact_stiffness);
	return task;
}
