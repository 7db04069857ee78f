/* What a study will take, before any of it is run.
 *
 * Time is that of the runs, each of the mean number of samples of its ground motion, or of the steps of its solver, of the
 * spectra of its floor and of the reductions.  What a design shares between its samples is in the unit costs as it is for
 * the examples, which take the estimated time within three (soak_cost); so do four of five studies drawn at random, and none
 * takes more than eight times as long (soak_valid): how often bodies touch, and how much is shared, nobody knows before. */
#include "schema/study/cost.h"

#include <assert.h>
#include <math.h>

#include "engine/solver/solver.h"
#include "schema/json/json_writer.h"
#include "schema/study/fields.h"
#include "schema/study/study_json.h"

enum { MIB = 1 << 20 };
enum { QUANTILES = 64 /* of a distribution, for a mean */ };

/* [s] of one core: for a study, for a sample of a ground motion by each solver, for a step within it, and for a radian that
 * an oscillator turns by within it, where that is too many for maps */
static const double STUDY_S = 0.001;
static const struct {
	double sample, step, radian;
} units[] = {
    // in the order of the solvers: event, newmark, central_difference, adaptive
    {5e-8, 0, 3e-7},
    {1.0e-7, 6e-8, 0},
    {1.0e-7, 4e-8, 0},
    {2e-6, 0, 6e-7},
};
/* radians of a sample that go by maps, and with more than which a run ends as chatter */
static const double MAPPED = 2, TURNED_MOST = 5e5;

static_assert(sizeof units / sizeof units[0] == POUND_SOLVERS, "a row for each solver");

/* [s] for a sample of a floor that spectra ride on, and for each frequency of these; and how many there are of both for a run:
 * a study of spectra has the floor with pounding and without, and the contact's own part */
static const double FLOOR_S = 3e-7, ORDINATE_S = 1.1e-8;
static const struct {
	int floors, spectra;
} rides[] = {[POUND_KIND_SENSITIVITY] = {1, 1}, [POUND_KIND_FLOOR_SPECTRUM] = {2, 3}};

/* part of the time in which bodies are taken to ride on each other, and the radians of a step of a floor */
static const double RIDING = 0.02, FLOOR_RADIANS = 1.5;

/* [s] for a pulse of an idealised train, at each frequency */
static const double PULSE_S = 6e-8;

/* [s] of an output's indices: for a drawn row of a resample and each tile of its moments, and for a sample that polynomials
 * are fitted to; and how many moments there are, for all and for each input */
static const double DRAW_S = 5e-9, TILE_S = 5e-9, FIT_S = 1.5e-6;
enum { RESAMPLES = 2000, MOMENTS = 10, MOMENTS_INPUT = 7, TILE = 16 };

/* marches by which a yield displacement is found, over those of the scene */
static const double YIELDING = 0.7;

/* how much more a kind computes of a run than the outputs of a sensitivity study: other measures, histories; and what of a
 * run's time each further response takes that a search for a target demand makes */
static const struct {
	double run, searched;
} kinds[] = {[POUND_KIND_RESPONSE] = {3, 0.3},
             [POUND_KIND_SENSITIVITY] = {1, 0.1},
             [POUND_KIND_CONVERGENCE] = {12, 0.1},
             [POUND_KIND_FLOOR_SPECTRUM] = {3, 0.1}};

/* Corrections that a search takes where it may, in the mean. */
static const double SEARCH_MEAN = 6;

/* [bytes] in a result: of an index or of a signal, with its name and all members beside it */
static const double INDEX_BYTES = 2000, SIGNAL_BYTES = 900, NUMBER_BYTES = 20, DOCUMENT_BYTES = 3000;

/* [bytes] of memory for a study, for a number of its document, and for a byte of its result, which is text that grows by doubling
 * and is then put into the database */
static const double STUDY_MEMORY = 1.5 * MIB, NUMBER_MEMORY = 100, RESULT_MEMORY = 2;

/* The mean of a power of a field of the scene, over its distribution or its sweep. */
static double mean(const struct pound_study *study, size_t offset, double power)
{
	double sum = 0;
	for (int j = 0; j < study->n_inputs; j++) {
		if (study->inputs[j].field.offset != offset)
			continue;
		for (int k = 0; k < QUANTILES; k++)
			sum += pow(pound_distribution_quantile(&study->inputs[j].distribution, (k + 0.5) / QUANTILES),
			           power);
		return sum / QUANTILES;
	}
	for (int s = 0; s < study->n_sweeps; s++) {
		const struct pound_sweep *sweep = &study->sweeps[s];
		if (sweep->field.offset != offset)
			continue;
		for (int k = 0; k < sweep->n_values; k++)
			sum += pow(sweep->values[k], power);
		return sum / sweep->n_values;
	}
	const struct pound_field field = {POUND_FIELD_REAL, offset};
	return pow(pound_scene_field(&study->scene, field), power);
}

#define MEAN(study, member, power) mean((study), offsetof(struct pound_scene, member), (power))

/* Samples of a ground motion, in the mean. */
static double samples_mean(const struct pound_study *study)
{
	const struct pound_excitation *excitation = &study->scene.excitation;
	if (excitation->n_record)
		return excitation->n_record;
	bool cycles = fields_used(fields_find("/scene/excitation/cycles"), NULL,
	                          pound_excitation_name(excitation->type), NULL);
	double duration = cycles ? MEAN(study, excitation.cycles, 1) * MEAN(study, excitation.frequency_hz, -1)
	                         : MEAN(study, excitation.duration, 1);
	return duration * MEAN(study, excitation.time_step, -1) + 1;
}

/* What the contact's own frequency, over those of the oscillators, adds to the steps of a solver that follows each swing
 * of it: it goes with the root of the stiffness and of the masses' ratio. */
static double swings(const struct pound_study *study)
{
	bool wall = study->scene.oscillators[1].rigid_wall;
	double light = wall ? 1 : MEAN(study, oscillators[0].mass, 0.5) * MEAN(study, oscillators[1].mass, -0.5);
	double heavy = wall ? 1 : MEAN(study, oscillators[0].mass, -0.5) * MEAN(study, oscillators[1].mass, 0.5);
	return study->scene.contact.present
	           ? 0.002 * MEAN(study, contact.stiffness_ratio, 0.5) * fmax(light, heavy)
	           : 0;
}

/* Radians of a sample that oscillators turn by, beyond those that go by maps. */
static double turned(const struct pound_study *study)
{
	const double step = 2 * 3.14159265358979323846 * MEAN(study, excitation.time_step, 1);
	const double frequency[] = {
	    MEAN(study, oscillators[0].frequency_hz, 1),
	    study->scene.oscillators[1].rigid_wall ? 0 : MEAN(study, oscillators[1].frequency_hz, 1)};
	double sum = 0;
	for (int i = 0; i < POUND_OSCILLATORS; i++)
		sum += fmax(0, step * frequency[i] - MAPPED);
	return fmin(sum, TURNED_MOST);
}

static bool varies(const struct pound_study *study, size_t offset)
{
	for (int j = 0; j < study->n_inputs; j++)
		if (study->inputs[j].field.offset == offset)
			return true;
	for (int s = 0; s < study->n_sweeps; s++)
		if (study->sweeps[s].field.offset == offset)
			return true;
	return false;
}

/* Corrections of a run beyond those that are no search: of each body whose law may have one. */
static double searched(const struct pound_study *study)
{
	const struct pound_oscillator *o = study->scene.oscillators;
	double sum = 0;
	for (int i = 0; i < POUND_OSCILLATORS; i++) {
		const struct pound_law *law = pound_scene_law(&study->scene, i);
		const size_t at = (size_t)((const char *)law - (const char *)&study->scene);
		const size_t times = at + offsetof(struct pound_law, corrections);
		const double corrections = varies(study, times) ? mean(study, times, 1) : law->corrections;
		bool linear = law->type == 0 && !varies(study, at + offsetof(struct pound_law, type));
		if (!o[i].rigid_wall && !linear && law->yield_displacement == 0 && corrections > 1)
			sum += fmin(corrections, SEARCH_MEAN) - 1;
	}
	return sum;
}

/* [s] of the reductions of a sensitivity study. */
static double reductions_s(const struct pound_study *study)
{
	const double outputs = (double)study_cells(study) * study->n_outputs;
	const int tiles = (MOMENTS + MOMENTS_INPUT * study->n_inputs + TILE - 1) / TILE;
	// where rows come in groups, these are left out one by one instead
	const bool grouped =
	    study->design.until.half_width > 0 || pound_design_quasi_random(study->design.method);
	const double estimators = study->design.estimator ? 3 : 1; // the one named twice
	return outputs * pound_design_rows_most(study) *
	       ((grouped ? 0 : estimators * RESAMPLES * (DRAW_S + TILE_S * tiles)) +
	        pound_design_samples(study) * FIT_S);
}

/* How many times the marches of a linear scene a run takes: the yield displacement of a body is found, and corrected once,
 * first; searched() counts the rest.
 * In the units of a sensitivity study it is there once. */
static double marches(const struct pound_study *study)
{
	double most = 0;
	for (int i = 0; i < POUND_OSCILLATORS; i++) {
		const struct pound_law *law = pound_scene_law(&study->scene, i);
		if (law->type != 0 && !(law->yield_displacement > 0))
			most = fmax(most, YIELDING * (1 + fmin(law->corrections, 1)));
	}
	return study->kind == POUND_KIND_RESPONSE ? 1 + most : fmax(1, most / (2 * YIELDING));
}

/* Steps of a floor within a sample, besides one: while bodies touch the contact's own frequency sets them. */
static double steps_riding(const struct pound_study *study)
{
	const bool wall = study->scene.oscillators[1].rigid_wall;
	const double masses =
	    wall ? 1
	         : 1 + fmax(MEAN(study, oscillators[0].mass, 1) * MEAN(study, oscillators[1].mass, -1),
	                    MEAN(study, oscillators[0].mass, -1) * MEAN(study, oscillators[1].mass, 1));
	const double hz = fmax(MEAN(study, oscillators[0].frequency_hz, 1),
	                       wall ? 0 : MEAN(study, oscillators[1].frequency_hz, 1));
	if (!study->scene.contact.present)
		return 0;
	return RIDING * 2 * 3.14159265358979323846 * hz * MEAN(study, excitation.time_step, 1) *
	       sqrt(MEAN(study, contact.stiffness_ratio, 1) * masses) / FLOOR_RADIANS;
}

/* [s] of one run by a solver. */
static double run_s(const struct pound_study *study, const struct pound_solver *solver)
{
	const int row = solver->method;
	bool fixed = pound_solver_takes_step(solver->method);
	double steps = fixed ? fmax(1, MEAN(study, excitation.time_step, 1) / solver->step) : 0;
	// the march takes few more for more contacts
	double more = fixed ? 0 : row == POUND_SOLVER_EVENT ? 0.2 * log1p(swings(study)) : swings(study);
	return samples_mean(study) * (units[row].sample * (1 + more) * (fixed ? 1 : marches(study)) +
	                              units[row].step * steps + units[row].radian * turned(study));
}

/* What a study will take.
 *
 * Given    study       valid
 *          n_workers   that run its blocks, each in work space of its own
 * Returns  value       runs exactly; time, bytes and memory as above
 * Test     unit_cost: what_is_asked_twice_costs_twice; soak_cost: an_estimate_is_near_what_a_study_takes
 */
struct cost cost_of(const struct pound_study *study, int n_workers)
{
	struct cost cost = {.runs = study_runs(study), .cpu_s = STUDY_S, .bytes = DOCUMENT_BYTES};
	double cells = study_cells(study), runs = (double)cost.runs;
	double numbers; // doubles that are stored of a run
	if (study->kind == POUND_KIND_CONVERGENCE) {
		int n = pound_convergence_trials(study);
		for (int j = 0; j < n; j++) {
			const struct pound_solver solver = pound_convergence_solver(study, j);
			cost.cpu_s += kinds[study->kind].run * runs / n * run_s(study, &solver);
		}
	} else
		cost.cpu_s += kinds[study->kind].run * runs * run_s(study, &study->solver);
	cost.cpu_s *= 1 + kinds[study->kind].searched * searched(study);
	if (study->spectrum.n)
		cost.cpu_s += runs * samples_mean(study) * (1 + steps_riding(study)) *
		              (rides[study->kind].floors * FLOOR_S +
		               rides[study->kind].spectra * study->spectrum.n * ORDINATE_S);
	if (study->kind == POUND_KIND_FLOOR_SPECTRUM)
		cost.cpu_s += runs * study->spectrum.n * study->spectrum.pulses * PULSE_S;
	if (study->kind == POUND_KIND_SENSITIVITY) {
		cost.cpu_s += reductions_s(study);
		numbers = 2 * study->n_outputs;
		cost.bytes += cells * study->n_outputs * (study->n_inputs + 1) * INDEX_BYTES;
	} else {
		numbers = sizeof(struct pound_response) / sizeof(double) + 6 * study->spectrum.n;
		cost.bytes += runs * SIGNAL_BYTES + cells * 20 * study->spectrum.n * NUMBER_BYTES;
	}
	cost.memory = STUDY_MEMORY + NUMBER_MEMORY * study->scene.excitation.n_record +
	              RESULT_MEMORY * cost.bytes + pound_run_bytes(study, n_workers, samples_mean(study));
	cost.bytes += runs * numbers * sizeof(double);
	return cost;
}

/* Whether a server takes a study.
 *
 * Given    most       of each, that it takes
 * Returns  problems   a sentence for every limit that the study would go over
 * Test     service_submit: a_study_over_a_limit_is_refused_with_the_limit_and_what_was_asked
 */
bool cost_allowed(const struct cost *cost, const struct cost *most, struct problems *problems)
{
	const struct {
		double asked, most;
		const char *what, *option;
	} limits[] = {
	    {(double)cost->runs, (double)most->runs, "pounding runs", "runs-max"},
	    {cost->cpu_s, most->cpu_s, "estimated seconds of one core", "cpu-max"},
	    {cost->bytes / MIB, most->bytes / MIB, "estimated MiB in the database", "result-max"},
	    {cost->memory / MIB, most->memory / MIB, "estimated MiB of memory", "memory-max"},
	};
	problems_init(problems);
	for (size_t i = 0; i < sizeof limits / sizeof limits[0]; i++)
		if (limits[i].asked > limits[i].most)
			problems_exceed(problems, "", limits[i].asked, limits[i].most,
			                "asks for %.6g %s, this server accepts at most %.6g (--%s)", limits[i].asked,
			                limits[i].what, limits[i].most, limits[i].option);
	return problems->n == 0;
}

/* The object Estimate of the OpenAPI document. */
char *cost_to_json(const struct cost *cost, const struct pound_study *study, size_t *length)
{
	struct writer w;
	writer_init(&w);
	writer_object(&w, NULL, WRITER_LINES);
	writer_text(&w, "kind", study_kind_name(study->kind));
	writer_whole(&w, "runs_total", cost->runs);
	writer_number(&w, "estimated_cpu_s", cost->cpu_s);
	writer_number(&w, "estimated_bytes", ceil(cost->bytes));
	writer_number(&w, "estimated_memory_bytes", ceil(cost->memory));
	writer_end(&w);
	return writer_take(&w, length);
}
