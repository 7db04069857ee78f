/* cost.c - estimates the CPU time, memory and storage of a study before it is run.
 *
 * CPU time: the number of each operation (operations.c) times its seconds.  Test soak_valid measures the accuracy, unit_estimates
 * for some of its studies. */
#include "schema/study/cost.h"

#include <math.h>
#include <stdint.h>

#include "schema/study/means.h"
#include "schema/study/operations.h"
#include "schema/study/study_buildings.h"
#include "schema/study/study_json.h"

enum { MIB = 1 << 20 };

enum { KINDS = 4 };

/* Seconds of one core per operation and kind of study.  A response study computes energy balances for its first signals only; its
 * other runs cost as much as runs of a sensitivity study.
 * Fitted to 2,500 valid studies (distribution: soak_valid) with eight lanes, for rows of buildings to 2,280: there an estimate that
 * is too small weighs 2.5 times as much as one that is too large. */
static const double seconds_of[OPERATIONS][KINDS] = {
    // response, sensitivity, convergence, floor_spectrum
    [STUDY] = {1e-3, 1e-3, 1e-3, 1e-3},
    [BEGIN] = {2.2e-6, 1.6e-6, 2.2e-5, 1.6e-5},
    [GROUND] = {2.0e-8, 9e-9, 9.8e-8, 2.5e-8},
    [FREE] = {4.2e-8, 9e-10, 2.8e-8, 3.4e-9},
    [YIELD] = {3.6e-8, 2.5e-9, 2.8e-9, 3.4e-10},
    [FLOW] = {1.02e-7, 9.6e-9, 4.2e-8, 1.7e-9},
    [MARCH] = {5.0e-8, 1.7e-9, 5.6e-8, 1.8e-7},
    [TOUCH] = {3.9e-7, 8.4e-8, 2.1e-6, 8e-8},
    [SWING] = {3.4e-8, 2.3e-8, 4.2e-8, 1.5e-7},
    [POUNDED] = {9.4e-8, 5e-9, 6.4e-7, 5.2e-9},
    [TURN] = {3e-7, 3e-7, 3e-7, 3e-7},
    [SHAPE] = {3.1e-8, 4.8e-8, 4.8e-8, 4.8e-8},
    [CHAIN] = {1.7e-7, 4.4e-8, 4.4e-8, 4.4e-8},
    [YIELD_STEP] = {1.8e-7, 6.5e-8, 6.5e-8, 6.5e-8},
    [NEARBY] = {2.1e-7, 1e-7, 1e-7, 1e-7},
    [MEET] = {1.2e-7, 1.6e-7, 1.6e-7, 1.6e-7},
    [SUSTAINED] = {8.8e-8, 2.5e-7, 2.5e-7, 2.5e-7},
    [STICK] = {1.7e-6, 7.2e-7, 7.2e-7, 7.2e-7},
    [ROOT] = {5e-7, 4.9e-7, 4.9e-7, 4.9e-7},
    [JUMP] = {1e-6, 2.3e-6, 2.3e-6, 2.3e-6},
    [DASH] = {3e-9, 1.5e-9, 1.5e-9, 1.5e-9},
    [REST] = {0.00036, 0.00013, 0.00013, 0.00013},
    [POWER_FORCE] = {0.0012, 0.0022, 0.0022, 0.0022},
    [BALANCE] = {1.6e-7, 0, 0, 0},
    [PAIR_MAPS] = {1.3e-7, 1.3e-7, 1.3e-7, 1.3e-7},
    [PAIR] = {1.3e-7, 1.3e-7, 1.3e-7, 1.3e-7},
    [PAIR_TURN] = {9e-7, 9e-7, 9e-7, 9e-7},
    [START] = {8e-8, 8e-8, 1.4e-9, 0},
    [NEWMARK] = {3e-8, 3e-8, 6.3e-10, 0},
    [CENTRAL] = {2e-8, 2e-8, 6.3e-10, 0},
    [ADAPT_START] = {1.1e-6, 1.1e-6, 2.5e-8, 0},
    [ADAPT] = {1.3e-6, 1.6e-6, 4.5e-8, 0},
    [FOLLOW] = {2.5e-7, 9e-7, 1.5e-6, 0},
    [ROW_STEP] = {4e-8, 4e-8, 4e-8, 4e-8},
    [ROW_ADAPT] = {1.6e-5, 1.6e-5, 1.6e-5, 1.6e-5},
    [FLOOR] = {0, 3.9e-8, 0, 3.9e-8},
    [PART] = {0, 2.6e-6, 0, 2.6e-6},
    [FLOOR_DRIVEN] = {0, 3e-8, 0, 3e-8},
    [FOLLOWED] = {0, 5.5e-8, 0, 5.5e-8},
    [FOLLOWED_NEAR] = {0, 3.2e-5, 0, 3.2e-5},
    [ORDINATE] = {0, 5.6e-9, 0, 5.6e-9},
    [BOUNCE] = {0, 1.8e-7, 0, 1.8e-7},
    [SHAKE] = {0, 5.2e-10, 0, 5.2e-10},
    [PULSE] = {0, 0, 0, 6.2e-8},
    [DRAW] = {0, 5e-9, 0, 0},
    [TILE] = {0, 5e-9, 0, 0},
    [FIT] = {0, 1.5e-6, 0, 0},
    [CLOCK] = {0, 0, 0.029, 0},
};

/* CPU time that nearly all studies stay below, over the estimate.  Chains (rows of buildings, and pairs with a contact that is not
 * linear) may have long series of small impacts, most of all if neighbors touch at rest; these series cannot be predicted before
 * a run. */
static const double HIGH = 3, HIGH_CHAIN = 5, HIGH_CHAIN_AT_REST = 13;

/* [bytes] in a result: the object of an index, of a signal, a number, a measure of a row, a mode of a building, and all else */
static const double INDEX_BYTES = 2000, SIGNAL_BYTES = 900, NUMBER_BYTES = 20, MEASURE_BYTES = 45,
                    MODE_BYTES = 170, DOCUMENT_BYTES = 3000;

/* [bytes] of memory for a study, per number of its document, and per byte of its result: the text grows by doubling before it is
 * stored in the database */
static const double STUDY_MEMORY = 1.5 * MIB, NUMBER_MEMORY = 100, RESULT_MEMORY = 2;

/* Memory of a study's records: the parser makes a tree node of each number. */
static double record_memory(const struct pound_study *study)
{
	const struct pound_excitation *e = &study->scene.excitation;
	double bytes = NUMBER_MEMORY * e->n_record;
	for (int k = 0; k < e->n_records; k++)
		bytes += e->records[k].n * NUMBER_MEMORY;
	return bytes;
}

static double seconds(const struct pound_study *study, int first, int behind)
{
	struct counts counts = {0};
	operations_count(study, &counts);
	const bool response = study->kind == POUND_KIND_RESPONSE;
	const double signals = fmax(study->scene.excitation.signals, 1),
	             balanced = !response           ? 1
	                        : study->unbalanced ? 0
	                                            : fmin(POUND_BALANCED_SIGNALS / signals, 1);
	const enum pound_kind other = response ? POUND_KIND_SENSITIVITY : study->kind;
	double sum = 0;
	for (int k = first; k < behind; k++)
		sum += counts.of[k] * (balanced * seconds_of[k][study->kind] + (1 - balanced) * seconds_of[k][other]);
	return sum;
}

double cost_of_runs(const struct pound_study *study)
{
	return seconds(study, BEGIN, DRAW);
}

static double high(const struct pound_study *study)
{
	return !study->scene.contact.present || !operations_chained(study, &study->solver) ? HIGH
	       : MEAN(study, contact.gap, 1) > 0                                           ? HIGH_CHAIN
	                                                                                   : HIGH_CHAIN_AT_REST;
}

/* Estimates the cost of a study.
 *
 * Given    asked       valid
 *          n_workers   workers that run its blocks, each with its own work space
 * Returns  value       exact number of runs; estimated time, bytes and memory
 * Test     unit_cost: what_is_asked_twice_costs_twice; soak_cost: an_estimate_is_near_what_a_study_takes
 */
struct cost cost_of(const struct pound_study *asked, int n_workers)
{
	const struct pound_study like = study_separation_like(asked), *study = &like;
	struct cost cost = {.runs = study_runs(study),
	                    .cpu_s = seconds(study, 0, OPERATIONS),
	                    .bytes = DOCUMENT_BYTES + study_separation_bytes(asked)};
	double cells = study_cells(study), runs = (double)cost.runs, numbers; // doubles stored per run
	cost.cpu_s_high = high(study) * cost.cpu_s;
	if (study->kind == POUND_KIND_SENSITIVITY) {
		numbers = 2 * study->n_outputs;
		cost.bytes += cells * study->n_outputs * (study->n_inputs + 1) * INDEX_BYTES;
	} else {
		const double of_row =
		    study->scene.n_buildings && study->kind != POUND_KIND_CONVERGENCE ? pound_row_measures(study) : 0;
		numbers = asked->kind == POUND_KIND_SEPARATION ? 2 * study->n_outputs
		          : of_row > 0                         ? of_row
		                       : sizeof(struct pound_response) / sizeof(double) + 6 * study->spectrum.n;
		if (asked->kind == POUND_KIND_RESPONSE)
			cost.bytes += cells * pound_row_floors(&study->scene) * MODE_BYTES;
		cost.bytes +=
		    runs * (asked->kind == POUND_KIND_SEPARATION ? 0 : SIGNAL_BYTES + of_row * MEASURE_BYTES) +
		    cells * 20 * study->spectrum.n * NUMBER_BYTES;
	}
	const struct pound_run_shared shared = operations_shared(study);
	cost.memory = STUDY_MEMORY + record_memory(study) + RESULT_MEMORY * cost.bytes +
	              pound_run_bytes(asked, n_workers, &shared);
	cost.bytes += runs * numbers * sizeof(double);
	return cost;
}
