/* unit_row_results.c - rows of buildings from documents to results.
 *
 * 1. Known answers of seven rows, by two independent programs with 113-bit arithmetic.
 * 2. One-story rows against two oscillators, which another solver integrates.
 * 3. Invariants without an oracle: mirrored rows, equal buildings, scaling. */
#include <math.h>
#include <string.h>

#include "engine/pound.h"
#include "schema/json/json_pointer.h"
#include "schema/result/result_json.h"
#include "schema/study/study_json.h"
#include "tests/support/check.h"
#include "tests/support/study_documents.h"

/* Relative to the largest number of the list: the digits of the known answers. */
static const double KNOWN = 1e-12;

enum { VALUES = 8 };

static char *json_of_result(const char *document)
{
	struct pound_study *study = study_documents_study(document);
	struct pound_run *run = pound_run_create(study, 1);
	size_t length;
	assert_non_null(run);
	for (int b = 0; b < pound_run_blocks(run); b++)
		assert_int_equal(pound_run_block(run, b, 0), POUND_OK);
	for (int r = 0; r < pound_run_reductions(run); r++)
		assert_int_equal(pound_run_reduce(run, r, 0), POUND_OK);
	char *json = result_to_json(study, pound_run_result(run), NULL, &length);
	assert_non_null(json);
	pound_run_free(run);
	study_free(study);
	return json;
}

/* Runs a document and returns its result. */
static struct reading *result_of(const char *document)
{
	char *json = json_of_result(document);
	struct reading *reading = reading_open(json, strlen(json));
	assert_non_null(reading);
	free(json);
	return reading;
}

/* ---- known answers ---- */

#define HARMONIC(f, T, peak)                                                                 \
	"\"excitation\": {\"type\": \"harmonic\", \"frequency_hz\": " #f ", \"duration_s\": " #T \
	", \"time_step_s\": 0.01, \"peak_m_s2\": " #peak "}"
#define ROW(buildings, rest, excitation) \
	"{\"kind\": \"response\", \"scene\": {\"buildings\": [" buildings "], " rest ", " excitation "}}"

static const char T2[] = ROW(
    "{\"storeys\": 2, \"mass_kg\": 1e5, \"stiffness_n_m\": [4e7, 3e7], \"damping\": \"storey\"},"
    "{\"storeys\": 2, \"mass_kg\": [1.5e5, 1e5], \"stiffness_n_m\": [1.2e8, 9e7], \"damping\": \"storey\"}",
    "\"contact\": {\"gap_m\": 0.01}", HARMONIC(1.7, 3, 3));
static const char T3[] = ROW(
    "{\"storeys\": 3, \"mass_kg\": 2e5, \"frequency_hz\": 2, \"stiffness_profile\": [1.5, 1.2, 1]},"
    "{\"storeys\": 2, \"mass_kg\": 1.5e5, \"frequency_hz\": 4}",
    "\"contact\": {\"gap_m\": 0.005, \"tension\": false, \"calibration\": \"exact\", \"restitution\": 0.5}",
    HARMONIC(2.2, 3, 2.5));
static const char EP[] =
    ROW("{\"storeys\": 5, \"mass_kg\": 2e5, \"stiffness_n_m\": 2.4e8, \"damping\": \"stiffness\","
        " \"law\": {\"type\": \"elastoplastic\", \"yield_displacement_m\": 0.006}},"
        "{\"storeys\": 3, \"mass_kg\": 1.5e5, \"stiffness_n_m\": 2.4e8, \"damping\": \"stiffness\","
        " \"law\": {\"type\": \"elastoplastic\", \"yield_displacement_m\": 0.004}}",
        "\"contact\": {\"gap_m\": 0.01, \"restitution\": 0.65}", HARMONIC(1.6, 3, 4));
static const char LA[] = ROW("{\"storeys\": 3, \"mass_kg\": 1e5, \"stiffness_n_m\": [9e7, 8e7, 7e7],"
                             " \"law\": {\"type\": \"origin_oriented\", \"yield_displacement_m\": 0.004}},"
                             "{\"storeys\": 2, \"mass_kg\": 1e5, \"stiffness_n_m\": [1.5e8, 1.2e8],"
                             " \"law\": {\"type\": \"nonlinear_elastic\", \"yield_displacement_m\": 0.002}}",
                             "\"contact\": {\"gap_m\": 0.008}", HARMONIC(2.5, 3, 5));
static const char R3[] = ROW("{\"storeys\": 2, \"mass_kg\": 1e5, \"frequency_hz\": 1.8},"
                             "{\"storeys\": 3, \"mass_kg\": 1.2e5, \"frequency_hz\": 1.4},"
                             "{\"storeys\": 2, \"mass_kg\": 8e4, \"frequency_hz\": 2.9}",
                             "\"contact\": {\"gap_m\": 0.01}", HARMONIC(1.5, 3, 3));
static const char W[] =
    ROW("{\"storeys\": 4, \"mass_kg\": 1e5, \"frequency_hz\": 1.25, \"damping_ratio\": 0.03}, "
        "{\"rigid_wall\": true}",
        "\"contact\": {\"gap_m\": 0.02}, \"contacts\": [{\"levels\": [4, 1]}, {\"levels\": [3, 1]}]",
        HARMONIC(1.2, 3, 1.5));
static const char MS[] =
    ROW("{\"storeys\": 2, \"mass_kg\": 1e5, \"frequency_hz\": 2.1}, {\"storeys\": 3, \"mass_kg\": 1e5, "
        "\"frequency_hz\": 3}",
        "\"contact\": {\"gap_m\": 0.004}, \"contacts\": [{\"levels\": [2, 2.6]}, {\"levels\": [1, 1.3]}]",
        HARMONIC(2, 2.5, 3));

/* Source: the project's design pages, buildings.md 4; %d in a member's pointer counts from `first`. */
static const struct known {
	const char *document, *member;
	int first, n;
	double values[VALUES];
} known[] = {
    {T2, "/buildings/0/storeys/%d/drift_max_m", 0, 2, {.0355398603521552, .0310402674200034}},
    {T2, "/contacts/%d/impulse_max_n_s", 0, 2, {47492.1856286693, 70454.5447246573}},
    {T2, "/contacts/%d/contact_count", 0, 2, {10, 11}},
    {T2, "/contacts/%d/first_time_s", 1, 1, {.445732289767119}},
    {T2, "/buildings/%d/floors/1/acceleration_max_m_s2", 0, 2, {157.957423978705, 154.721872308446}},
    {T3, "/contacts/%d/impulse_max_n_s", 0, 2, {92064.1704763961, 171145.829011237}},
    {T3, "/contacts/%d/contact_count", 0, 2, {15, 24}},
    {EP, "/buildings/0/storeys/%d/drift_max_m", 0, 1, {.0543830397504243}},
    {EP, "/buildings/0/storeys/%d/drift_max_m", 4, 1, {.00437356787206889}},
    {EP, "/buildings/0/storeys/%d/residual_drift_m", 0, 1, {-.0237297967531740}},
    {EP, "/buildings/0/storeys/%d/residual_drift_m", 3, 2, {-.00190093692600578, 0}},
    {EP, "/contacts/%d/impulse_max_n_s", 0, 3, {20846.9044225477, 6377.99175536268, 46038.3574530376}},
    {EP, "/contacts/%d/contact_count", 0, 3, {1, 1, 4}},
    {LA,
     "/buildings/0/floors/%d/end/u_m",
     0,
     3,
     {-.0288257306792830, -.0349757137371883, .00542429407945448}},
    {LA, "/buildings/1/floors/%d/end/u_m", 0, 2, {-.00765103769578269, .000479404201646032}},
    {LA, "/contacts/%d/impulse_max_n_s", 0, 2, {46379.3500931483, 32147.0962135886}},
    {R3,
     "/contacts/%d/impulse_max_n_s",
     0,
     4,
     {64417.5150918300, 154865.564934878, 89265.2187302767, 235098.891474731}},
    {R3, "/contacts/%d/contact_count", 0, 4, {7, 27, 11, 17}},
    {W,
     "/buildings/0/storeys/%d/drift_max_m",
     0,
     4,
     {.0276030785389800, .0187474422578475, .0227574862260666, .0169328391209189}},
    {W, "/contacts/%d/impulse_max_n_s", 0, 2, {85009.0893182793, 78054.5007567976}},
    {MS,
     "/buildings/1/floors/%d/end/u_m",
     0,
     3,
     {.00352661275337169, .00678666765581637, .00704048971824242}},
    {MS, "/contacts/%d/impulse_max_n_s", 0, 2, {85896.7700219882, 46498.6591743184}},
};

static double member_of(const struct reading *result, const char *member, int index)
{
	char pointer[128], at[128];
	snprintf(at, sizeof at, "/signals/0%s", member);
	const char *digit = strstr(at, "%d");
	assert_non_null(digit);
	snprintf(pointer, sizeof pointer, "%.*s%d%s", (int)(digit - at), at, index, digit + 2);
	return reading_number(result, "%s", pointer);
}

static void rows_have_their_known_answers(void **state)
{
	(void)state;
	double worst = 0;
	for (size_t k = 0; k < sizeof known / sizeof known[0]; k++) {
		struct reading *result = result_of(known[k].document);
		double scale = 0;
		for (int j = 0; j < known[k].n; j++)
			scale = fmax(scale, fabs(known[k].values[j]));
		for (int j = 0; j < known[k].n; j++) {
			const double got = member_of(result, known[k].member, known[k].first + j);
			worst = fmax(worst, fabs(got - known[k].values[j]) / scale);
			check_near_at(got, known[k].values[j], KNOWN * scale, known[k].member, __FILE__, __LINE__);
		}
		assert_true(reading_number(result, "/accuracy/energy_residual") < 1e-11);
		reading_close(result);
	}
	check_report("known answers to %.1e", worst);
}

/* ---- one story ---- */

/* Two oscillators, and the same as buildings; %s is their law. */
#define ONE_STOREY "\"contact\": {\"gap_m\": 0.003, \"restitution\": 0.55}, " HARMONIC(1.9, 4, 3)
#define LEFT       "\"mass_kg\": 1e5, \"frequency_hz\": 2, \"damping_ratio\": 0.04"
#define RIGHT      "\"mass_kg\": 1.7e5, \"frequency_hz\": 3.1"

static void one_story_rows_move_as_two_oscillators(void **state)
{
	(void)state;
	static const char *const laws[] = {
	    "{\"type\": \"linear\"}", "{\"type\": \"elastoplastic\"}",
	    "{\"type\": \"nonlinear_elastic\", \"yield_displacement_m\": 0.01}",
	    "{\"type\": \"origin_oriented\", \"target_demand\": 3, \"corrections\": 0}"};
	static const struct {
		const char *pair, *storey, *floor;
	} members[] = {{"displacement_max_m", "drift_max_m", "displacement_max_m"},
	               {"displacement_max_free_m", "drift_max_free_m", "displacement_max_free_m"},
	               {"force_max_n", "shear_max_n", NULL},
	               {"yield_displacement_m", "yield_drift_m", NULL},
	               {"demand", "demand", NULL},
	               {"demand_free", "demand_free", NULL}};
	double worst = 0;
	for (size_t l = 0; l < sizeof laws / sizeof laws[0]; l++) {
		char pair[1024], row[1024];
		snprintf(pair, sizeof pair,
		         "{\"kind\": \"response\", \"scene\": {\"law\": %s, \"oscillators\": [{" LEFT "}, {" RIGHT
		         "}], " ONE_STOREY "}}",
		         laws[l]);
		snprintf(row, sizeof row,
		         "{\"kind\": \"response\", \"scene\": {\"law\": %s, \"buildings\": [{" LEFT "}, {" RIGHT
		         "}], " ONE_STOREY "}}",
		         laws[l]);
		struct reading *of_pair = result_of(pair), *of_row = result_of(row);
		for (int b = 0; b < 2; b++)
			for (size_t m = 0; m < sizeof members / sizeof members[0]; m++) {
				const double want =
				    reading_number(of_pair, "/signals/0/oscillators/%d/%s", b, members[m].pair);
				const double got =
				    reading_number(of_row, "/signals/0/buildings/%d/storeys/0/%s", b, members[m].storey);
				if (isnan(want) && isnan(got))
					continue;
				worst = fmax(worst, fabs(got - want) / fabs(want));
				check_near(got, want, 1e-13 * fabs(want));
				if (members[m].floor)
					check_near(
					    reading_number(of_row, "/signals/0/buildings/%d/floors/0/%s", b, members[m].floor),
					    want, 1e-13 * fabs(want));
			}
		static const char *const of_contact[] = {"impulse_max_n_s", "contact_count", "contact_time_s"};
		for (int m = 0; m < 3; m++) {
			const double want = reading_number(of_pair, "/signals/0/%s", of_contact[m]);
			assert_true(want > 0);
			check_near(reading_number(of_row, "/signals/0/contacts/0/%s", of_contact[m]), want, 1e-12 * want);
		}
		check_near(reading_number(of_row, "/outputs/impulse"), reading_number(of_pair, "/outputs/impulse"),
		           1e-12 * reading_number(of_pair, "/outputs/impulse"));
		reading_close(of_pair);
		reading_close(of_row);
	}
	check_report("one-story rows as two oscillators to %.1e", worst);
}

/* ---- without an oracle ---- */

static void equal_buildings_never_touch_with_force(void **state)
{
	(void)state;
	static const char equal[] =
	    ROW("{\"storeys\": 3, \"mass_kg\": 1e5, \"frequency_hz\": 2}, {\"storeys\": 3, \"mass_kg\": 1e5, "
	        "\"frequency_hz\": 2}",
	        "\"law\": {\"type\": \"elastoplastic\"}, \"contact\": {\"gap_m\": 0}", HARMONIC(1.8, 3, 4));
	struct reading *result = result_of(equal);
	for (int k = 0; k < 3; k++)
		assert_true(reading_number(result, "/signals/0/contacts/%d/impulse_max_n_s", k) == 0);
	assert_true(reading_number(result, "/work/moving_alike") == 1);
	assert_true(reading_number(result, "/work/pounding_runs/run") == 0);
	// the second building equals the first: its responses without pounding are computed once
	assert_true(reading_number(result, "/work/free_runs/asked") == 2);
	assert_true(reading_number(result, "/work/free_runs/run") == 1);
	for (int i = 0; i < 3; i++)
		check_near(reading_number(result, "/signals/0/buildings/1/storeys/%d/drift_max_m", i),
		           reading_number(result, "/signals/0/buildings/0/storeys/%d/drift_max_m", i), 0);
	reading_close(result);
}

static void a_wide_gap_is_never_closed(void **state)
{
	(void)state;
	char *wide = study_documents_with(R3, "\"gap_m\": 0.01", "\"gap_m\": 10");
	struct reading *result = result_of(wide);
	assert_true(reading_number(result, "/work/never_touching") == 1);
	for (int b = 0; b < 3; b++)
		check_near(reading_number(result, "/signals/0/buildings/%d/storeys/0/drift_max_m", b),
		           reading_number(result, "/signals/0/buildings/%d/storeys/0/drift_max_free_m", b), 0);
	check_near(reading_number(result, "/outputs/drift_amplification.building_0.storey_2"), 1, 0);
	assert_true(reading_number(result, "/outputs/impulse") == 0);
	reading_close(result);
	free(wide);
}

/* A row in reversed order under the reversed motion. */
static void a_mirrored_row_has_mirrored_results(void **state)
{
	(void)state;
	static const char left[] = "{\"storeys\": 2, \"mass_kg\": 1e5, \"frequency_hz\": 2.1}",
	                  right[] = "{\"storeys\": 3, \"mass_kg\": [1e5, 9e4, 8e4], \"frequency_hz\": 3}";
	static const char form[] = "{\"kind\": \"response\", \"scene\": {\"law\": {\"type\": \"elastoplastic\"}, "
	                           "\"buildings\": [%s, %s], \"contact\": {\"gap_m\": 0.004}, \"contacts\": "
	                           "[{\"levels\": [%s]}, {\"levels\": [%s]}], \"excitation\": {\"type\": "
	                           "\"record\", \"time_step_s\": 0.05, \"acceleration_m_s2\": [0, %s]}}}";
	char row[1500], mirrored[1500];
	snprintf(row, sizeof row, form, left, right, "2, 2.6", "1, 1.3",
	         "9, -6, -12, 3, 15, 6, -9, -15, 0, 12, 9, -12, -6, 15, -3, 9, -9, 6, 3, -3");
	snprintf(mirrored, sizeof mirrored, form, right, left, "2.6, 2", "1.3, 1",
	         "-9, 6, 12, -3, -15, -6, 9, 15, 0, -12, -9, 12, 6, -15, 3, -9, 9, -6, -3, 3");
	struct reading *a = result_of(row), *b = result_of(mirrored);
	for (int side = 0; side < 2; side++)
		for (int i = 0; i < 2 + side; i++) {
			const double drift = reading_number(a, "/signals/0/buildings/%d/storeys/%d/drift_max_m", side, i);
			const double end = reading_number(a, "/signals/0/buildings/%d/floors/%d/end/u_m", side, i);
			check_near(reading_number(b, "/signals/0/buildings/%d/storeys/%d/drift_max_m", 1 - side, i),
			           drift, 1e-12 * drift);
			check_near(reading_number(b, "/signals/0/buildings/%d/floors/%d/end/u_m", 1 - side, i), -end,
			           1e-12 * drift);
		}
	for (int k = 0; k < 2; k++) {
		const double impulse = reading_number(a, "/signals/0/contacts/%d/impulse_max_n_s", k);
		assert_true(impulse > 0);
		check_near(reading_number(b, "/signals/0/contacts/%d/impulse_max_n_s", k), impulse, 1e-12 * impulse);
	}
	reading_close(a);
	reading_close(b);
}

/* Linear: ground motion and gaps times four give displacements times four. */
static void a_linear_row_scales(void **state)
{
	(void)state;
	char *wider = study_documents_with(T2, "\"gap_m\": 0.01", "\"gap_m\": 0.04");
	char *stronger = study_documents_with(wider, "\"peak_m_s2\": 3", "\"peak_m_s2\": 12");
	struct reading *a = result_of(T2), *b = result_of(stronger);
	for (int i = 0; i < 2; i++)
		check_near(reading_number(b, "/signals/0/buildings/0/storeys/%d/drift_max_m", i),
		           4 * reading_number(a, "/signals/0/buildings/0/storeys/%d/drift_max_m", i), 0);
	check_near(reading_number(b, "/signals/0/contacts/1/impulse_max_n_s"),
	           4 * reading_number(a, "/signals/0/contacts/1/impulse_max_n_s"), 0);
	reading_close(a);
	reading_close(b);
	free(wider);
	free(stronger);
}

/* A property of one story, of all stories, their number, a level, and the gap of one contact: each cell equals its document. */
static void what_a_sweep_varies_is_what_a_document_says(void **state)
{
	(void)state;
	static const struct {
		const char *path, *values, *from, *to[2];
	} cases[] = {
	    {"/buildings/0/mass_kg",
	     "[9e4, 2e5]",
	     "\"storeys\": 2, \"mass_kg\": 1e5",
	     {"\"storeys\": 2, \"mass_kg\": 9e4", "\"storeys\": 2, \"mass_kg\": 2e5"}},
	    {"/buildings/0/mass_kg/1",
	     "[9e4, 2e5]",
	     "\"storeys\": 2, \"mass_kg\": 1e5",
	     {"\"storeys\": 2, \"mass_kg\": [1e5, 9e4]", "\"storeys\": 2, \"mass_kg\": [1e5, 2e5]"}},
	    {"/buildings/1/storeys", "[3, 5]", "\"storeys\": 3", {"\"storeys\": 3", "\"storeys\": 5"}},
	    {"/contacts/0/levels/1",
	     "[1.4, 3]",
	     "\"levels\": [2, 2.6]",
	     {"\"levels\": [2, 1.4]", "\"levels\": [2, 3]"}},
	    {"/contacts/1/gap_m",
	     "[0, 0.01]",
	     "{\"levels\": [1, 1.3]}",
	     {"{\"levels\": [1, 1.3], \"gap_m\": 0}", "{\"levels\": [1, 1.3], \"gap_m\": 0.01}"}},
	    {"/contact/restitution",
	     "[0.2, 0.9]",
	     "\"gap_m\": 0.004",
	     {"\"gap_m\": 0.004, \"restitution\": 0.2", "\"gap_m\": 0.004, \"restitution\": 0.9"}},
	};
	for (size_t k = 0; k < sizeof cases / sizeof cases[0]; k++) {
		char sweep[256];
		snprintf(sweep, sizeof sweep, "{\"sweep\": [{\"path\": \"%s\", \"values\": %s}], \"kind\"",
		         cases[k].path, cases[k].values);
		char *swept = study_documents_with(MS, "{\"kind\"", sweep);
		struct reading *all = result_of(swept);
		for (int cell = 0; cell < 2; cell++) {
			char *document = study_documents_with(MS, cases[k].from, cases[k].to[cell]);
			struct reading *one = result_of(document);
			for (int c = 0; c < 2; c++) {
				const double want = reading_number(one, "/signals/0/contacts/%d/impulse_max_n_s", c);
				check_near(reading_number(all, "/cells/%d/signals/0/contacts/%d/impulse_max_n_s", cell, c),
				           want, 0);
			}
			check_near(reading_number(all, "/cells/%d/outputs/impulse", cell),
			           reading_number(one, "/outputs/impulse"), 0);
			reading_close(one);
			free(document);
		}
		reading_close(all);
		free(swept);
	}
}

/* A sensitivity study has an output for every place, named by building and story; its rows equal single documents. */
static void places_are_outputs(void **state)
{
	(void)state;
	static const char study[] =
	    "{\"kind\": \"sensitivity\", \"scene\": {\"buildings\": [{\"storeys\": 2, \"mass_kg\": 1e5, "
	    "\"frequency_hz\": 2}, {\"storeys\": 2, \"mass_kg\": 1e5, \"frequency_hz\": 3}], \"contact\": "
	    "{\"gap_m\": "
	    "0.002}, " HARMONIC(
	        1.8, 2,
	        3) "}, \"inputs\": [{\"path\": \"/buildings/0/mass_kg/1\", \"name\": \"m\", "
	           "\"distribution\": {\"type\": \"uniform\", \"min\": 5e4, \"max\": 2e5}}], \"places\": "
	           "[{\"storey\": 2}, "
	           "{\"building\": 1, \"storey\": 1}], \"outputs\": [\"impulse\", \"drift_amplification\", "
	           "\"acceleration_amplification\"], \"design\": {\"rows\": 12}}";
	static const struct {
		const char *name;
		double building, storey;
	} outputs[] = {{"impulse", NAN, NAN},
	               {"drift_amplification", 0, 2},
	               {"drift_amplification", 1, 1},
	               {"acceleration_amplification", 0, 2},
	               {"acceleration_amplification", 1, 1}};
	struct reading *result = result_of(study);
	assert_int_equal(reading_count(result, "/cells/0/outputs"), 5);
	for (int o = 0; o < 5; o++) {
		assert_string_equal(reading_text(result, "/cells/0/outputs/%d/name", o), outputs[o].name);
		const double building = reading_number(result, "/cells/0/outputs/%d/building", o);
		assert_true(building == outputs[o].building || (isnan(building) && isnan(outputs[o].building)));
		const double storey = reading_number(result, "/cells/0/outputs/%d/storey", o);
		assert_true(storey == outputs[o].storey || (isnan(storey) && isnan(outputs[o].storey)));
		assert_true(reading_number(result, "/cells/0/outputs/%d/mean", o) > 0);
		// one input explains all of the variance, and half the sample step gives the same
		check_near(reading_number(result, "/cells/0/outputs/%d/inputs/0/ST_raw", o), 1, 0.9);
		assert_true(reading_number(result, "/cells/0/outputs/%d/accuracy/runs_checked", o) > 0);
		assert_true(reading_number(result, "/cells/0/outputs/%d/accuracy/difference_largest", o) < 1e-10);
	}
	assert_true(reading_number(result, "/work/checks/run") > 0);
	// the second building is the same in every row
	assert_true(reading_number(result, "/work/free_runs/run") <
	            reading_number(result, "/work/free_runs/asked"));
	reading_close(result);
}

/* Of a row whose left building has 1 and then 2 equal stories, beside a wall: w_j = 2 sqrt(k/m) sin((2 j - 1) pi/(4 N + 2)). */
static void modes_are_of_the_buildings_of_the_cell(void **state)
{
	(void)state;
	static const double pi = 3.14159265358979323846;
	static const char swept[] =
	    "{\"kind\": \"response\", \"sweep\": [{\"path\": \"/buildings/1/storeys\", \"values\": [1, 2]}], "
	    "\"scene\": {\"buildings\": [{\"storeys\": 3, \"mass_kg\": 1e5, \"frequency_hz\": 1.25, \"damping\": "
	    "\"modal\", \"damping_ratio\": 0.02}, {\"storeys\": 2, \"mass_kg\": 2e5, \"stiffness_n_m\": 3e8}], "
	    "\"contact\": {\"gap_m\": 0.01}, " HARMONIC(2, 1, 1) "}}";
	struct reading *result = result_of(swept);
	for (int cell = 0; cell < 2; cell++) {
		double mass[2] = {0};
		assert_int_equal(reading_count(result, "/cells/%d/modes", cell), 3 + cell + 1);
		for (int k = 0; k < 3 + cell + 1; k++) {
			char at[64];
			snprintf(at, sizeof at, "/cells/%d/modes/%d", cell, k);
			const int b = k >= 3, mode = b ? k - 2 : k + 1, n = b ? cell + 1 : 3;
			const double f = reading_number(result, "%s/frequency_hz", at);
			const double w = 2 * sqrt(3e8 / 2e5) * sin((2 * mode - 1) * pi / (4 * n + 2));
			assert_true(reading_number(result, "%s/building", at) == b);
			assert_true(reading_number(result, "%s/mode", at) == mode);
			check_near(f * reading_number(result, "%s/period_s", at), 1, 1e-15);
			if (b)
				check_near(f, w / (2 * pi), 1e-13 * f);
			else
				check_near(reading_number(result, "%s/damping_ratio", at), 0.02, 0);
			mass[b] += reading_number(result, "%s/effective_mass_ratio", at);
		}
		check_near(reading_number(result, "/cells/%d/modes/0/frequency_hz", cell), 1.25, 0);
		for (int b = 0; b < 2; b++)
			check_near(mass[b], 1, 1e-14);
	}
	reading_close(result);
	// a wall has no modes, and two oscillators have no list
	result = result_of(W);
	assert_int_equal(reading_count(result, "/modes"), 4);
	assert_true(reading_number(result, "/modes/3/building") == 0);
	reading_close(result);
	result = result_of("{\"kind\": \"response\", \"scene\": {\"oscillators\": [{\"frequency_hz\": 1}, "
	                   "{\"frequency_hz\": 2}], " HARMONIC(2, 1, 1) "}}");
	assert_false(reading_has(result, "/modes"));
	assert_true(reading_has(result, "/signals/0"));
	reading_close(result);
}

CHECK_MAIN(cmocka_unit_test(rows_have_their_known_answers),
           cmocka_unit_test(one_story_rows_move_as_two_oscillators),
           cmocka_unit_test(equal_buildings_never_touch_with_force),
           cmocka_unit_test(a_wide_gap_is_never_closed),
           cmocka_unit_test(a_mirrored_row_has_mirrored_results), cmocka_unit_test(a_linear_row_scales),
           cmocka_unit_test(what_a_sweep_varies_is_what_a_document_says),
           cmocka_unit_test(places_are_outputs), cmocka_unit_test(modes_are_of_the_buildings_of_the_cell))
