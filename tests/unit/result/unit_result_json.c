/* unit_result_json.c - results written with the names of the contract, from results made by hand. */
#include <math.h>
#include <string.h>

#include "schema/json/json_pointer.h"
#include "schema/result/result_json.h"
#include "schema/result/widest_interval.h"
#include "schema/study/study_json.h"
#include "tests/support/check.h"
#include "tests/support/study_documents.h"

static const struct timing timing = {1.5, 2.75, 2};

/* Measures whose values show their positions: k + 0.5 for the k-th, but no yield displacement of the left oscillator. */
static struct pound_response numbered(double first)
{
	struct pound_response response;
	double *const measures = (double *)&response;
	for (size_t k = 0; k < sizeof response / sizeof(double); k++)
		measures[k] = first + (double)k + 0.5;
	response.yield_displacement_1 = NAN;
	return response;
}

static char *json_of(const char *document, const struct pound_result *result, size_t *length)
{
	struct pound_study *study = study_documents_study(document);
	char *json = result_to_json(study, result, &timing, length);
	assert_non_null(json);
	assert_int_equal(strlen(json), *length);
	study_free(study);
	return json;
}

static struct reading *result_of(const char *document, const struct pound_result *result)
{
	size_t length;
	char *json = json_of(document, result, &length);
	struct reading *reading = reading_open(json, length);
	assert_non_null(reading);
	free(json);
	return reading;
}

static void a_response_is_written_whole(void **state)
{
	(void)state;
	static const char wanted[] =
	    "{\n  \"kind\": \"response\",\n  \"engine_version\": \"" POUND_VERSION "\",\n"
	    "  \"study_hash\": \"96e2d140f562cc85f018e269b3c41d47c3298d0557221069d9b6687291bc7a86\",\n  "
	    "\"seed\": 42,\n"
	    "  \"runs\": 1,\n  \"runs_failed\": 0,\n  \"signals\": [\n    {\n      \"index\": 0,\n      "
	    "\"oscillators\": [\n"
	    "        {\"displacement_max_m\": 0.5, \"displacement_max_free_m\": 1.5, \"force_max_n\": 2.5, "
	    "\"yield_displacement_m\": null, \"demand\": 4.5, \"demand_free\": 5.5},\n"
	    "        {\"displacement_max_m\": 6.5, \"displacement_max_free_m\": 7.5, \"force_max_n\": 8.5, "
	    "\"yield_displacement_m\": 9.5, \"demand\": 10.5, \"demand_free\": 11.5}\n      ],\n"
	    "      \"impulse_max_n_s\": 12.5,\n      \"contact_count\": 13.5,\n      \"contact_time_s\": 14.5,\n"
	    "      \"end\": {\"u1_m\": 15.5, \"v1_m_s\": 16.5, \"u2_m\": 17.5, \"v2_m_s\": 18.5}\n    }\n  ],\n"
	    "  \"outputs\": {\n    \"force_amplification\": 1.25,\n    \"impulse\": null\n  },\n"
	    "  \"accuracy\": {\n    \"energy_residual\": 21.5,\n    \"energy_responses\": 1\n  },\n"
	    "  \"work\": {\n    \"signals\": {\"what\": \"ground motions\", \"asked\": 1, \"run\": 1},\n"
	    "    \"free_runs\": {\"what\": \"linear responses without pounding\", \"asked\": 2, \"run\": 2},\n"
	    "    \"yield_runs\": {\"what\": \"nonlinear responses without pounding\", \"asked\": 0, \"run\": "
	    "0},\n"
	    "    \"pounding_runs\": {\"what\": \"responses with pounding\", \"asked\": 1, \"run\": 1},\n"
	    "    \"floors\": {\"what\": \"floor histories, for spectra\", \"asked\": 0, \"run\": 0},\n"
	    "    \"checks\": {\"what\": \"responses again on half the sample step\", \"asked\": 0, \"run\": 0},\n"
	    "    \"never_touching\": 0,\n    \"moving_alike\": 0,\n    \"contacts\": 14,\n    \"failures\": [],\n"
	    "    \"left_out\": [\n"
	    "      \"all nonlinear responses without pounding: no law needs them\"\n    ]\n  },\n"
	    "  \"timing\": {\"wall_s\": 1.5, \"cpu_s\": 2.75, \"threads\": 2}\n}\n";
	struct pound_response response = numbered(0);
	struct pound_cell cell = {.runs = 1, .n_signals = 1, .signals = &response, .outputs = {1.25, NAN}};
	struct pound_result result = {
	    .n_cells = 1,
	    .cells = &cell,
	    .work = {.signals = {1, 1}, .free_runs = {2, 2}, .pounding_runs = {1, 1}, .contacts = 14}};
	size_t length;
	char *json = json_of(study_documents_response, &result, &length);
	assert_string_equal(json, wanted);
	free(json);
}

static void timing_is_the_last_line_but_one_and_all_that_differs(void **state)
{
	(void)state;
	struct pound_response response = numbered(0);
	struct pound_cell cell = {.n_signals = 1, .signals = &response};
	struct pound_result result = {.n_cells = 1, .cells = &cell};
	static const struct timing other = {0.1, 1e9, 128};
	struct pound_study *study = study_documents_study(study_documents_response);
	size_t length, length_other;
	char *json = result_to_json(study, &result, &timing, &length);
	char *json_other = result_to_json(study, &result, &other, &length_other);
	char *line = strstr(json, "\n  \"timing\":"), *line_other = strstr(json_other, "\n  \"timing\":");
	assert_int_equal(line - json, line_other - json_other);
	assert_int_equal(memcmp(json, json_other, (size_t)(line - json)), 0);
	assert_string_equal(strchr(line + 1, '\n'), "\n}\n");
	assert_string_equal(strchr(line_other + 1, '\n'), "\n}\n");
	free(json);
	free(json_other);
	study_free(study);
}

static void a_swept_law_stands_by_its_name(void **state)
{
	(void)state;
	char *document = study_documents_with(
	    study_documents_response, "\"scene\"",
	    "\"sweep\": [{\"path\": \"/law/type\", \"values\": [\"linear\", \"elastoplastic\"]}, "
	    "{\"path\": \"/contact/tension\", \"values\": [true]}, {\"path\": \"/law/corrections\", "
	    "\"values\": [3]}, {\"path\": \"/contact/gap_m\", \"values\": [0.1]}], \"scene\"");
	struct pound_response responses[2] = {numbered(0), numbered(100)};
	struct pound_cell cells[2];
	for (int c = 0; c < 2; c++)
		cells[c] = (struct pound_cell){.sweep = {c, 1, 3, 0.1},
		                               .runs = 5,
		                               .n_signals = 1,
		                               .signals = &responses[c],
		                               .outputs = {1.25, 2.5, 3.75}};
	struct pound_result result = {.n_cells = 2, .cells = cells};
	struct reading *r = result_of(document, &result);
	assert_int_equal(reading_count(r, "/cells"), 2);
	assert_string_equal(reading_text(r, "/cells/0/sweep/~1law~1type"), "linear");
	assert_string_equal(reading_text(r, "/cells/1/sweep/~1law~1type"), "elastoplastic");
	assert_true(reading_true(r, "/cells/0/sweep/~1contact~1tension"));
	check_near(reading_number(r, "/cells/1/sweep/~1law~1corrections"), 3, 0);
	check_near(reading_number(r, "/cells/1/sweep/~1contact~1gap_m"), 0.1, 0);
	check_near(reading_number(r, "/cells/1/signals/0/impulse_max_n_s"), 112.5, 0);
	// outputs in the order of the engine: force, demand, impulse; each cell has the applicable ones
	check_near(reading_number(r, "/cells/0/outputs/force_amplification"), 1.25, 0);
	check_near(reading_number(r, "/cells/1/outputs/demand_amplification"), 2.5, 0);
	check_near(reading_number(r, "/cells/1/outputs/impulse"), 3.75, 0);
	assert_int_equal(reading_count(r, "/cells/0/outputs"), 2);
	assert_string_equal(reading_text(r, "/cells/0/not_applicable/0/name"), "demand_amplification");
	assert_string_equal(reading_text(r, "/cells/0/not_applicable/0/note"),
	                    "needs a nonlinear law of the left oscillator");
	assert_string_equal(reading_text(r, "/cells/1/not_applicable/0/name"), "force_amplification");
	assert_false(reading_has(r, "/signals"));
	reading_close(r);
	free(document);
}

enum { ESTIMATES = 2 * POUND_N_INDICES }; /* of two inputs */

/* Indices whose values show their positions. */
static void indices_fill(struct pound_indices *indices, struct pound_estimate *estimates, double first)
{
	*indices = (struct pound_indices){.mean = first - 1, .variance = first - 2, .noise_share = first - 3};
	for (int k = 0; k < ESTIMATES; k++)
		estimates[k] = (struct pound_estimate){first + k, first + k - 0.25, first + k + 0.25};
	for (int k = 0; k < POUND_N_INDICES; k++)
		indices->index[k] = estimates + 2 * k;
	for (int k = 0; k < POUND_N_SHARES; k++)
		indices->share[k] = (struct pound_estimate){k, k - 0.25, k + 0.25};
}

static void indices_stand_by_output_and_input(void **state)
{
	(void)state;
	struct pound_estimate estimates[2 * ESTIMATES];
	struct pound_indices indices[4];
	for (int o = 0; o < 4; o++)
		indices_fill(&indices[o], estimates, 10);
	indices_fill(&indices[3], estimates + ESTIMATES, 20);
	struct pound_cell cells[2] = {
	    {.sweep = {0.2}, .runs = 200, .indices = indices},
	    {.sweep = {0.9}, .runs = 200, .runs_failed = 3, .rows_dropped = 1, .indices = indices + 2}};
	struct pound_result result = {.n_cells = 2, .cells = cells};
	struct reading *r = result_of(study_documents_sensitivity, &result);
	assert_string_equal(reading_text(r, "/name"), "a study");
	check_near(reading_number(r, "/cells/1/sweep/~1contact~1restitution"), 0.9, 0);
	check_near(reading_number(r, "/cells/0/runs_failed"), 0, 0);
	check_near(reading_number(r, "/cells/1/runs_failed"), 3, 0);
	check_near(reading_number(r, "/cells/1/rows_dropped"), 1, 0);
	assert_string_equal(reading_text(r, "/cells/0/outputs/1/name"), "impulse");
	assert_string_equal(reading_text(r, "/cells/1/outputs/1/inputs/0/name"), "f_e");
	assert_string_equal(reading_text(r, "/cells/1/outputs/1/inputs/1/path"), "/oscillators/1/mass_kg");
	check_near(reading_number(r, "/cells/1/outputs/1/mean"), 19, 0);
	check_near(reading_number(r, "/cells/1/outputs/1/variance"), 18, 0);
	check_near(reading_number(r, "/cells/1/outputs/1/noise_share"), 17, 0);
	static const char *const names[POUND_N_INDICES] = {"S1",     "ST",     "S1_pick_freeze", "ST_pick_freeze",
	                                                   "S1_raw", "ST_raw", "S2_excitation",  "shapley"};
	for (int k = 0; k < ESTIMATES; k++) {
		char member[80];
		snprintf(member, sizeof member, "/cells/1/outputs/1/inputs/%d/%s", k % 2, names[k / 2]);
		check_near(reading_number(r, "%s", member), 20 + k, 0);
		check_near(reading_number(r, "%s_low", member), 19.75 + k, 0);
		check_near(reading_number(r, "%s_high", member), 20.25 + k, 0);
	}
	static const char *const shares[POUND_N_SHARES] = {"S1_one_signal", "ST_one_signal",
	                                                   "ST_mean_of_signals"};
	for (int k = 0; k < POUND_N_SHARES; k++) {
		check_near(reading_number(r, "/cells/1/outputs/1/excitation/%s", shares[k]), k, 0);
		check_near(reading_number(r, "/cells/1/outputs/1/excitation/%s_low", shares[k]), k - 0.25, 0);
	}
	assert_false(reading_has(r, "/cells/1/outputs/1/note"));
	reading_close(r);
}

static void every_output_says_how_far_it_may_be_off(void **state)
{
	(void)state;
	struct pound_estimate estimates[ESTIMATES];
	struct pound_indices indices[4];
	for (int o = 0; o < 4; o++) {
		indices_fill(&indices[o], estimates, 10);
		indices[o].accuracy = (struct pound_accuracy){.runs_checked = 30 + o,
		                                              .difference_median = 1e-12 * (o + 1),
		                                              .difference_largest = 1e-9 * (o + 1),
		                                              .rows = {0, 0, 50, 100},
		                                              .slope = {-0.5, -0.75, -0.25},
		                                              .rows_to_halve = 399.5,
		                                              .errors = {0.125 * (o + 1), NAN, 1e-6, 0},
		                                              .excitation_low = NAN};
		indices[o].accuracy.inputs[1].total_change = 0.375;
		indices[o].accuracy.inputs[1].first_half[2] = 0.75;
		indices[o].accuracy.inputs[1].first_half[3] = 0.5;
	}
	struct pound_cell cells[2] = {{.indices = indices}, {.indices = indices + 2}};
	struct pound_result result = {.n_cells = 2, .cells = cells};
	struct reading *r = result_of(study_documents_sensitivity, &result);
	static const char accuracy[] = "/cells/1/outputs/0/accuracy";
	check_near(reading_number(r, "%s/runs_checked", accuracy), 32, 0);
	check_near(reading_number(r, "%s/rows_to_halve", accuracy), 400, 0);
	check_near(reading_number(r, "%s/slope_low", accuracy), -0.75, 0);
	check_near(reading_number(r, "%s/slope_high", accuracy), -0.25, 0);
	check_near(reading_number(r, "%s/inputs/1/ST_integration", accuracy), 0.375, 0);
	assert_int_equal(reading_count(r, "%s/rows", accuracy), 2);
	assert_int_equal(reading_count(r, "%s/inputs/1/S1_half_widths", accuracy), 2);
	check_near(reading_number(r, "%s/inputs/1/S1_half_widths/0", accuracy), 0.75, 0);
	check_near(reading_number(r, "%s/errors/sampling", accuracy), 0.375, 0);
	assert_true(isnan(reading_number(r, "%s/errors/excitation", accuracy)));
	assert_string_equal(reading_text(r, "%s/dominant", accuracy), "sampling");
	assert_string_equal(reading_text(r, "%s/note", accuracy),
	                    "The number of rows is the largest source of error: the largest half-width of an "
	                    "interval is 0.38, of S1 "
	                    "of /oscillators/1/mass_kg.");
	// the largest over all outputs of all cells; runs are the total of the cells
	check_near(reading_number(r, "/accuracy/runs_checked"), 31 + 33, 0);
	check_near(reading_number(r, "/accuracy/difference_largest"), 4e-9, 0);
	check_near(reading_number(r, "/accuracy/errors/sampling"), 0.5, 0);
	// proportional
	check_near(reading_number(r, "/timing/rows/0/rows"), 50, 0);
	check_near(reading_number(r, "/timing/rows/0/cpu_s"), 1.375, 0);
	check_near(reading_number(r, "/timing/rows/1/cpu_s"), 2.75, 0);
	reading_close(r);
}

static void undefined_indices_are_null_and_say_why(void **state)
{
	(void)state;
	struct pound_estimate none[2] = {{NAN, NAN, NAN}, {NAN, NAN, NAN}};
	struct pound_indices indices[2] = {{.notes = 1 << POUND_NOTE_CONSTANT},
	                                   {.notes = 1 << POUND_NOTE_NO_ROWS | 1 << POUND_NOTE_NOISE}};
	for (int o = 0; o < 2; o++)
		for (int k = 0; k < POUND_N_INDICES; k++)
			indices[o].index[k] = none;
	struct pound_cell cells[2] = {{.indices = indices}, {.indices = indices}};
	struct pound_result result = {.n_cells = 2, .cells = cells};
	struct reading *r = result_of(study_documents_sensitivity, &result);
	assert_true(reading_has(r, "/cells/0/outputs/0/inputs/0/S1"));
	assert_true(isnan(reading_number(r, "/cells/0/outputs/0/inputs/0/S1")));
	assert_string_equal(reading_text(r, "/cells/0/outputs/0/note"),
	                    "the output is the same for every row, so it has no indices");
	assert_string_equal(
	    reading_text(r, "/cells/0/outputs/1/note"),
	    "all rows of the design failed, so there are no indices; without the noise the variance may be 0, "
	    "so all indices except the raw ones are missing or unreliable");
	// each note has a name that programs can rely on
	assert_string_equal(reading_text(r, "/cells/0/outputs/0/notes/0/name"), "constant");
	assert_int_equal(reading_count(r, "/cells/0/outputs/1/notes"), 2);
	assert_string_equal(reading_text(r, "/cells/0/outputs/1/notes/0/name"), "no_rows");
	assert_string_equal(reading_text(r, "/cells/0/outputs/1/notes/1/name"), "noise");
	assert_string_equal(reading_text(r, "/cells/0/outputs/1/notes/0/text"),
	                    "all rows of the design failed, so there are no indices");
	reading_close(r);
}

static void a_negative_index_is_not_clipped_but_explained(void **state)
{
	(void)state;
	struct pound_estimate estimates[ESTIMATES];
	struct pound_indices indices[4];
	for (int o = 0; o < 4; o++)
		indices_fill(&indices[o], estimates, 0);
	for (int k = 0; k < ESTIMATES; k++)
		estimates[k] = (struct pound_estimate){k % 2 ? 0 : 0.5, -0.25, 0.75};
	estimates[2 * POUND_ST_PICK_FREEZE] = (struct pound_estimate){-0.125, -0.25, 0.125};
	struct pound_cell cells[2] = {{.indices = indices}, {.indices = indices + 2}};
	struct pound_result result = {.n_cells = 2, .cells = cells};
	struct reading *r = result_of(study_documents_sensitivity, &result);
	check_near(reading_number(r, "/cells/0/outputs/0/inputs/0/ST_pick_freeze"), -0.125, 0);
	assert_string_equal(
	    reading_text(r, "/cells/0/outputs/0/inputs/0/note"),
	    "ST_pick_freeze: below 0 by sampling error, so the index is between 0 and the upper end of "
	    "its interval");
	// an index of 0 whose interval reaches below 0 needs no note
	assert_false(reading_has(r, "/cells/0/outputs/0/inputs/1/note"));
	reading_close(r);
}

static void all_there_is_to_say_has_room(void **state)
{
	(void)state;
	struct pound_estimate estimates[ESTIMATES];
	struct pound_indices indices[4];
	for (int o = 0; o < 4; o++) {
		indices_fill(&indices[o], estimates, 10);
		indices[o].notes = (1u << POUND_N_NOTES) - 1;
		indices[o].rows_needed = 1200;
	}
	struct pound_cell cells[2] = {{.indices = indices}, {.indices = indices + 2}};
	struct pound_result result = {.n_cells = 2, .cells = cells};
	struct reading *r = result_of(study_documents_sensitivity, &result);
	const char *note = reading_text(r, "/cells/0/outputs/0/note");
	assert_string_equal(strrchr(note, ';'), "; few rows hold most of the variance, so intervals are too "
	                                        "narrow: 1200 rows or more are needed");
	assert_int_equal(reading_count(r, "/cells/0/outputs/0/notes"), POUND_N_NOTES);
	check_near(reading_number(r, "/cells/0/outputs/0/notes/%d/rows_needed", POUND_NOTE_FEW_DECIDE), 1200, 0);
	assert_string_equal(reading_text(r, "/cells/0/outputs/0/notes/%d/name", POUND_NOTE_FEW_DECIDE),
	                    "few_decide");
	reading_close(r);
}

static void failed_runs_are_counted_by_reason(void **state)
{
	(void)state;
	struct pound_response response = numbered(0);
	struct pound_cell cell = {.runs = 9, .runs_failed = 7, .n_signals = 1, .signals = &response};
	struct pound_result result = {
	    .n_cells = 1, .cells = &cell, .work.failed = {[POUND_CHATTER_RUNS] = 4, [POUND_TOLERANCE_RUNS] = 3}};
	struct reading *r = result_of(study_documents_response, &result);
	assert_int_equal(reading_count(r, "/work/failures"), 2);
	assert_string_equal(reading_text(r, "/work/failures/0/reason"),
	                    "more events in one sample interval than allowed");
	check_near(reading_number(r, "/work/failures/0/runs"), 4, 0);
	assert_string_equal(reading_text(r, "/work/failures/1/reason"),
	                    "the tolerance of the solver is out of its reach");
	check_near(reading_number(r, "/work/failures/1/runs"), 3, 0);
	reading_close(r);
}

static void errors_against_a_reference_without_a_result_are_null_and_say_why(void **state)
{
	(void)state;
	enum { TRIALS = 6 };
	struct pound_trial trials[TRIALS] = {{.runs_failed = 2}};
	struct pound_cell cell = {.runs = 2 * TRIALS, .runs_failed = 2};
	struct pound_result result = {.n_cells = 1, .cells = &cell, .n_trials = TRIALS, .trials = trials};
	struct reading *r = result_of(study_documents_convergence, &result);
	assert_string_equal(reading_text(r, "/note"),
	                    "the reference run failed, so there are no errors; work.failures has the reasons");
	assert_true(isnan(reading_number(r, "/orders/newmark")));
	reading_close(r);
	trials[0].runs_failed = 1;
	for (int j = 2; j < 4; j++)
		trials[j] = (struct pound_trial){.solver = {.method = 1, .step = pow(10, -j)},
		                                 .history.mean = pow(10, -3 * j)};
	r = result_of(study_documents_convergence, &result);
	assert_false(reading_has(r, "/note"));
	check_near(reading_number(r, "/orders/newmark"), 3, 1e-12);
	assert_true(isnan(reading_number(r, "/orders/adaptive")));
	reading_close(r);
}

static void left_out_work_adds_up(void **state)
{
	(void)state;
	struct pound_response response = numbered(0);
	struct pound_cell cell = {.n_signals = 1, .signals = &response};
	struct pound_result result = {.n_cells = 1,
	                              .cells = &cell,
	                              .work = {.signals = {100, 40},
	                                       .free_runs = {150, 60},
	                                       .yield_runs = {80, 70},
	                                       .pounding_runs = {100, 50},
	                                       .never_touching = 20,
	                                       .moving_alike = 10,
	                                       .yield_given = 4,
	                                       .linear_unasked = 3,
	                                       .nonlinear_unasked = 2}};
	struct reading *r = result_of(study_documents_response, &result);
	static const char *const sentences[] = {
	    "60 ground motions: equal to one already made",
	    "90 linear responses without pounding: equal to one already made",
	    "4 linear responses without pounding: the yield displacement is given",
	    "3 linear responses of the right oscillator without pounding: no output needs them",
	    "10 nonlinear responses without pounding: equal to one already made",
	    "2 last nonlinear responses of the right oscillator without pounding: no output needs them",
	    "20 responses with pounding: the responses without pounding never close the gap",
	    "10 responses with pounding: equal oscillators move together and never touch with force",
	    "20 responses with pounding: equal to one already made",
	};
	assert_int_equal(reading_count(r, "/work/left_out"), 9);
	for (int i = 0; i < 9; i++)
		assert_string_equal(reading_text(r, "/work/left_out/%d", i), sentences[i]);
	check_near(reading_number(r, "/work/pounding_runs/asked"), 100, 0);
	check_near(reading_number(r, "/work/pounding_runs/run"), 50, 0);
	reading_close(r);
	char *document = study_documents_with(study_documents_response, "\"oscillators\"",
	                                      "\"contact\": null, \"oscillators\"");
	result.work = (struct pound_work){.signals = {5, 5}, .free_runs = {10, 10}, .pounding_runs = {5, 0}};
	r = result_of(document, &result);
	assert_int_equal(reading_count(r, "/work/left_out"), 2);
	assert_string_equal(reading_text(r, "/work/left_out/1"),
	                    "all responses with pounding: the scene has no contact");
	reading_close(r);
	free(document);
}

static void points_that_do_not_fill_their_nets_are_noted(void **state)
{
	(void)state;
	static const struct {
		const char *design, *note; /* "": no note */
	} cases[] = {{"\"method\": \"sobol\", \"rows\": 1000", "use 512 or 1024 rows"},
	             {"\"method\": \"sobol\", \"rows\": 17, \"randomisations\": 4",
	              "17 rows are not a power of two for each of 4"},
	             {"\"method\": \"sobol\", \"rows\": 96, \"randomisations\": 6", ""},
	             {"\"method\": \"sobol\", \"rows\": 16", ""},
	             {"\"method\": \"lhs\", \"rows\": 10", ""}};
	for (size_t k = 0; k < sizeof cases / sizeof cases[0]; k++) {
		char *document = study_documents_with(study_documents_sensitivity,
		                                      "\"method\": \"lhs\", \"rows\": 10", cases[k].design);
		struct pound_study *study = study_documents_study(document);
		struct pound_run *run = pound_run_create(study, 1);
		struct reading *r = result_of(document, pound_run_result(run));
		const char *note = reading_text(r, "/design/note");
		if (*cases[k].note)
			assert_non_null(strstr(note, cases[k].note));
		else
			assert_null(note);
		reading_close(r);
		pound_run_free(run);
		study_free(study);
		free(document);
	}
}

static void a_result_says_why_its_design_grew_no_further(void **state)
{
	(void)state;
	char *document = study_documents_with(study_documents_sensitivity, "\"rows\": 10",
	                                      "\"until\": {\"half_width\": 0.05, \"max_runs\": 60000}");
	struct pound_study *study = study_documents_study(document);
	struct pound_run *run = pound_run_create(study, 1);
	struct pound_result result = *pound_run_result(run);
	struct pound_look looks[] = {{1000, INFINITY, 0, 0, 0, POUND_S1}, {1200, 0.04, 1, 1, 0, POUND_ST}};
	// before the first look it describes the rows so far
	struct reading *r = result_of(document, &result);
	assert_false(reading_has(r, "/stopping"));
	check_near(reading_number(r, "/partial/rows"), 1000, 0);
	check_near(reading_number(r, "/partial/rows_most"), 1500, 0);
	check_near(reading_number(r, "/partial/rows_done"), 1000, 0);
	assert_string_equal(reading_text(r, "/design/method"), "lhs");
	reading_close(r);
	result.rows = 1200;
	result.looks = looks;
	for (result.n_looks = 1; result.n_looks <= 2; result.n_looks++) {
		bool reached = result.n_looks == 2;
		r = result_of(document, &result);
		assert_false(reading_has(r, "/partial"));
		assert_true(reading_true(r, "/stopping/reached") == reached);
		check_near(reading_number(r, "/stopping/rows"), reached ? 1200 : 1000, 0);
		check_near(reading_number(r, "/stopping/runs"), reached ? 48000 : 40000, 0);
		assert_int_equal(reading_count(r, "/stopping/looks"), result.n_looks);
		assert_string_equal(reading_text(r, "/stopping/decided_by/index"), reached ? "ST" : "S1");
		assert_string_equal(reading_text(r, "/stopping/decided_by/input"), "f_e");
		assert_string_equal(reading_text(r, "/stopping/decided_by/output"),
		                    reached ? "impulse" : "demand_amplification");
		check_near(reading_number(r, "/stopping/decided_by/sweep/~1contact~1restitution"),
		           reached ? 0.9 : 0.2, 0);
		assert_true(isnan(reading_number(r, "/stopping/looks/0/half_width")));
		assert_non_null(
		    strstr(reading_text(r, "/stopping/note"), reached ? "every interval" : "not every interval"));
		reading_close(r);
	}
	pound_run_free(run);
	study_free(study);
	free(document);
}

/* The note on errors of an output whose widest interval may be due to few signals. */
static void check_note(double excitation, double low, const char *dominant, const char *note)
{
	struct pound_estimate estimates[ESTIMATES];
	struct pound_indices indices[4];
	for (int o = 0; o < 4; o++) {
		indices_fill(&indices[o], estimates, 10);
		indices[o].accuracy =
		    (struct pound_accuracy){.errors = {0.5, excitation, 1e-6, 0}, .excitation_low = low};
		indices[o].accuracy.inputs[1].total_half[3] = 0.5;
	}
	struct pound_cell cells[2] = {{.indices = indices}, {.indices = indices + 2}};
	struct pound_result result = {.n_cells = 2, .cells = cells};
	struct reading *r = result_of(study_documents_sensitivity, &result);
	const char *got = reading_text(r, "/cells/0/outputs/0/accuracy/dominant");
	assert_true(dominant ? got && strcmp(got, dominant) == 0 : !got);
	assert_string_equal(reading_text(r, "/cells/0/outputs/0/accuracy/note"), note);
	check_near(reading_number(r, "/cells/0/outputs/0/accuracy/errors/excitation_low"), low, 0);
	check_near(reading_number(r, "/accuracy/errors/excitation_low"), low, 0);
	reading_close(r);
}

static void few_signals_are_named_only_if_they_surely_make_the_interval(void **state)
{
	(void)state;
	check_note(
	    0.5, 0.4, "excitation",
	    "The number of signals is the largest source of error: their noise makes up at least 0.4 of the "
	    "largest half-width of an interval, of ST of /oscillators/1/mass_kg.");
	check_note(0.5, 0.25, NULL,
	           "Whether more rows or more signals would narrow the widest interval cannot be decided with so "
	           "few signals: their noise makes up between 0.25 and 0.5 of its half-width of 0.5, of ST of "
	           "/oscillators/1/mass_kg; design.signals = auto finds out.");
	check_note(0.25, 0.25, "sampling",
	           "The number of rows is the largest source of error: the largest half-width of an interval is "
	           "0.5, of ST of /oscillators/1/mass_kg.");
}

// an output whose interval grows with the rows, and one whose interval shrinks and is the narrower
#define WIDENING(half)                                                                            \
	"{\"cells\": [{\"outputs\": [{\"name\": \"impulse\", \"accuracy\": {\"rows_to_halve\": 4000," \
	" \"rows\": [250, 1000], \"inputs\": [{\"name\": \"f_2\", \"S1_half_widths\": [0.01, 0.02],"  \
	" \"ST_half_widths\": [0.09, " half "]}]}}, {\"name\": \"force\", \"accuracy\": {"            \
	"\"rows_to_halve\": null, \"rows\": [250, 1000], \"inputs\": [{\"name\": \"f_2\","            \
	" \"S1_half_widths\": [null, null], \"ST_half_widths\": [0.16, 0.08]}]}}]}]}"

static void the_widest_interval_is_named_and_why_fewer_rows_have_a_narrower_one(void **state)
{
	static const struct {
		const char *json, *size, *narrower;
	} cases[] = {
	    {WIDENING("0.21"),
	     "The widest 95 % interval is +-0.21, of ST of input f_2, output impulse; about 4000 rows would "
	     "halve its width.",
	     "With 250 rows it was +-0.09, narrower but not better: a few rare rows hold much of the variance, "
	     "and so few rows may not contain them. Quote the interval of 1000 rows."},
	    // less than a tenth wider may be chance
	    {WIDENING("0.095"),
	     "The widest 95 % interval is +-0.095, of ST of input f_2, output impulse; about 4000 rows would "
	     "halve its width.",
	     ""},
	    {WIDENING("0.05"), "The widest 95 % interval is +-0.08, of ST of input f_2, output force.", ""},
	    // stories have the same output name
	    {"{\"cells\": [{\"outputs\": [{\"name\": \"peak_shear_n\", \"building\": 1, \"storey\": 5, "
	     "\"accuracy\": "
	     "{\"rows\": [60], \"inputs\": [{\"name\": \"pga\", \"S1_half_widths\": [0.5]}]}}]}]}",
	     "The widest 95 % interval is +-0.5, of S1 of input pga, output peak_shear_n, building 1, story 5.",
	     ""},
	    {"{\"kind\": \"response\"}", "", ""},
	};
	(void)state;
	for (size_t k = 0; k < sizeof cases / sizeof cases[0]; k++) {
		struct reading *result = reading_open(cases[k].json, strlen(cases[k].json));
		struct widest_interval text;
		assert_non_null(result);
		widest_interval_find(result, &text);
		assert_string_equal(text.size, cases[k].size);
		assert_string_equal(text.narrower, cases[k].narrower);
		reading_close(result);
	}
}

CHECK_MAIN(cmocka_unit_test(few_signals_are_named_only_if_they_surely_make_the_interval),
           cmocka_unit_test(the_widest_interval_is_named_and_why_fewer_rows_have_a_narrower_one),
           cmocka_unit_test(points_that_do_not_fill_their_nets_are_noted),
           cmocka_unit_test(a_result_says_why_its_design_grew_no_further),
           cmocka_unit_test(a_response_is_written_whole),
           cmocka_unit_test(timing_is_the_last_line_but_one_and_all_that_differs),
           cmocka_unit_test(a_swept_law_stands_by_its_name),
           cmocka_unit_test(indices_stand_by_output_and_input),
           cmocka_unit_test(every_output_says_how_far_it_may_be_off),
           cmocka_unit_test(undefined_indices_are_null_and_say_why),
           cmocka_unit_test(a_negative_index_is_not_clipped_but_explained),
           cmocka_unit_test(all_there_is_to_say_has_room),
           cmocka_unit_test(failed_runs_are_counted_by_reason),
           cmocka_unit_test(errors_against_a_reference_without_a_result_are_null_and_say_why),
           cmocka_unit_test(left_out_work_adds_up))
