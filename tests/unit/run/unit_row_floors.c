/* unit_row_floors.c - floor spectra and histories of rows of buildings, from documents.
 *
 * 1. One-story rows against two oscillators, which another solver integrates.
 * 2. Mirrored rows; places in studies of spectra and in sensitivity studies; the end of a history, and its contact.
 * 3. Spectra from histories of every contact model. */
#include <math.h>
#include <string.h>

#include "engine/pound.h"
#include "schema/study/study_json.h"
#include "tests/support/check.h"
#include "tests/support/floor_tasks.h"
#include "tests/support/study_documents.h"

static struct pound_run *run_all(const struct pound_study *study)
{
	struct pound_run *run = pound_run_create(study, 1);
	assert_non_null(run);
	for (int b = 0; b < pound_run_blocks(run); b++)
		assert_int_equal(pound_run_block(run, b, 0), POUND_OK);
	for (int r = 0; r < pound_run_reductions(run); r++)
		assert_int_equal(pound_run_reduce(run, r, 0), POUND_OK);
	return run;
}

/* A study of spectra of a scene, and its run. */
struct spectra {
	struct pound_study *study;
	struct pound_run *run;
	const struct pound_floor_result *floor;
};

static struct spectra spectra_of(const char *bodies, const char *contact, const char *ground,
                                 const char *place)
{
	char document[3000];
	snprintf(document, sizeof document,
	         "{\"kind\": \"floor_spectrum\", \"scene\": {%s, \"contact\": {%s}, \"excitation\": {%s}}, "
	         "\"spectrum\": {\"frequencies_hz\": [0.5, 2, 3.3, 7, 40, 200]%s}}",
	         bodies, contact, ground, place);
	struct spectra s = {.study = study_documents_study(document)};
	s.run = run_all(s.study);
	s.floor = &pound_run_result(s.run)->floor;
	assert_int_equal(s.floor->signals_failed, 0);
	return s;
}

static void spectra_free(struct spectra *s)
{
	pound_run_free(s->run);
	study_free(s->study);
}

/* Largest relative difference between two ordinates. */
static double spectra_apart(const struct spectra *a, const struct spectra *b)
{
	double most = 0;
	for (int row = 0; row < POUND_N_SPECTRA; row++)
		for (int k = 0; k < a->study->spectrum.n; k++) {
			const double one = a->floor->spectra[row].mean[k], other = b->floor->spectra[row].mean[k];
			most = fmax(most, one == other ? 0 : fabs(one - other) / fabs(other));
		}
	return most;
}

static const char noise[] = "\"cycles\": 8, \"signals\": 3";

static void a_row_of_one_story_buildings_is_two_oscillators(void **state)
{
	(void)state;
	static const char *const laws[] = {"", "\"law\": {\"type\": \"elastoplastic\", \"target_demand\": 3}, ",
	                                   "\"law\": {\"type\": \"origin_oriented\", \"target_demand\": 2}, "};
	static const char *const contacts[] = {"\"gap_m\": 0.01", "\"tension\": false, \"restitution\": 0.4",
	                                       "\"model\": \"hertz_damp\", \"gap_m\": 0.002",
	                                       "\"model\": \"rigid\", \"gap_m\": 0.002", "\"gap_m\": 1"};
	double most = 0;
	for (size_t l = 0; l < sizeof laws / sizeof laws[0]; l++)
		for (size_t c = 0; c < sizeof contacts / sizeof contacts[0]; c++) {
			char pair[400], row[400];
			snprintf(pair, sizeof pair,
			         "%s\"oscillators\": [{\"mass_kg\": 3, \"frequency_hz\": 2}, {\"frequency_hz\": 3.1}]",
			         laws[l]);
			snprintf(row, sizeof row,
			         "%s\"buildings\": [{\"mass_kg\": 3, \"frequency_hz\": 2}, {\"frequency_hz\": 3.1}]",
			         laws[l]);
			struct spectra a = spectra_of(row, contacts[c], noise, ""),
			               b = spectra_of(pair, contacts[c], noise, "");
			most = fmax(most, spectra_apart(&a, &b));
			check_near(a.floor->impulse_mean, b.floor->impulse_mean, 1e-11 * b.floor->impulse_mean);
			check_near(a.floor->pulses_mean, b.floor->pulses_mean, 0);
			check_near(a.floor->frequency_hz, 2, 1e-14);
			spectra_free(&a);
			spectra_free(&b);
		}
	check_report("one-story rows: spectra %.1e off those of two oscillators", most);
	assert_true(most < 1e-12);
}

#define TALL "{\"storeys\": 4, \"mass_kg\": 2e5, \"frequency_hz\": 1.6}"
#define LOW  "{\"storeys\": 3, \"mass_kg\": 1.5e5, \"frequency_hz\": 3}"
#define WAVE                                                                                    \
	"\"type\": \"harmonic\", \"frequency_hz\": 1.9, \"duration_s\": 2, \"time_step_s\": 0.01, " \
	"\"peak_m_s2\": "

static void a_mirrored_row_has_mirrored_floors(void **state)
{
	(void)state;
	char one[600], other[600];
	double value = 0;
	int n =
	    snprintf(one, sizeof one, "\"type\": \"record\", \"time_step_s\": 0.05, \"acceleration_m_s2\": [0");
	int m = snprintf(other, sizeof other, "%s", one);
	for (int i = 1; i < 40; i++) {
		value = 4 * sin(0.65 * i) + 2 * cos(1.7 * i);
		n += snprintf(one + n, sizeof one - (size_t)n, ", %.2f", value);
		m += snprintf(other + m, sizeof other - (size_t)m, ", %.2f", -value);
	}
	strcat(one, "]");
	strcat(other, "]");
	struct spectra a = spectra_of("\"buildings\": [" TALL ", " LOW "]", "\"gap_m\": 0.005", one,
	                              ", \"place\": {\"building\": 0, \"storey\": 3}");
	struct spectra b = spectra_of("\"buildings\": [" LOW ", " TALL "]", "\"gap_m\": 0.005", other,
	                              ", \"place\": {\"building\": 1, \"storey\": 3}");
	assert_true(a.floor->impulse_mean > 0);
	check_near(a.floor->frequency_hz, 1.6, 1e-13);
	check_near(spectra_apart(&a, &b), 0, 1e-11);
	spectra_free(&a);
	spectra_free(&b);
}

static void a_place_without_a_name_is_the_top_of_the_left_building(void **state)
{
	(void)state;
	struct spectra a = spectra_of("\"buildings\": [" TALL ", " LOW "]", "\"gap_m\": 0.005", noise, "");
	struct spectra b = spectra_of("\"buildings\": [" TALL ", " LOW "]", "\"gap_m\": 0.005", noise,
	                              ", \"place\": {\"storey\": 4}");
	struct spectra c = spectra_of("\"buildings\": [" TALL ", " LOW "]", "\"gap_m\": 0.005", noise,
	                              ", \"place\": {\"storey\": 2}");
	check_near(spectra_apart(&a, &b), 0, 0);
	assert_true(spectra_apart(&a, &c) > 0.1);
	for (int row = 0; row < POUND_N_INTEGRATED; row++)
		for (int k = 0; k < a.study->spectrum.n; k++)
			assert_true(c.floor->spectra[row].error[k] < 1e-8);
	// floor 4 has no contact, so its impact-only spectrum is zero
	check_near(a.floor->spectra[POUND_SPECTRUM_IMPACT_ONLY].mean[2], 0, 0);
	assert_true(c.floor->spectra[POUND_SPECTRUM_IMPACT_ONLY].mean[2] > 0);
	spectra_free(&a);
	spectra_free(&b);
	spectra_free(&c);
}

static void an_ordinate_of_a_row_is_that_of_a_study_of_spectra(void **state)
{
	(void)state;
	struct pound_study *study = study_documents_study(
	    "{\"kind\": \"sensitivity\", \"scene\": {\"buildings\": [" TALL ", " LOW
	    "], \"contact\": {\"gap_m\": 0.005}, \"excitation\": {\"cycles\": 8, \"signals\": 3}}, "
	    "\"inputs\": [{\"path\": \"/buildings/1/mass_kg\", \"distribution\": {\"type\": \"uniform\", "
	    "\"min\": 1e5, "
	    "\"max\": 3e5}}], \"design\": {\"rows\": 2}, \"outputs\": [\"drift_amplification\", "
	    "\"floor_spectrum\"], "
	    "\"spectrum\": {\"frequencies_hz\": [0.5, 2, 3.3, 7, 40, 200], \"place\": {\"building\": 1, "
	    "\"storey\": 2}}}");
	struct pound_run *run = run_all(study);
	double x[1];
	char right[200];
	pound_run_sample_inputs(run, 0, 0, x);
	snprintf(right, sizeof right,
	         "\"buildings\": [" TALL ", {\"storeys\": 3, \"mass_kg\": %.17g, \"frequency_hz\": 3}]", x[0]);
	struct spectra whole =
	    spectra_of(right, "\"gap_m\": 0.005", noise, ", \"place\": {\"building\": 1, \"storey\": 2}");
	for (int k = 0; k < 6; k++) {
		const double mean = pound_run_sample_output(run, 0, 0, 0, 4 + k).mean;
		check_near(mean, whole.floor->spectra[POUND_SPECTRUM_POUNDING].mean[k], 1e-12 * mean);
	}
	spectra_free(&whole);
	pound_run_free(run);
	study_free(study);
}

/* ---- histories ---- */

struct last {
	int rows;
	double impulse; /* integral of the contact force by the trapezoidal rule */
	struct pound_instant at;
};

static void instant_take(void *of, int signal, const struct pound_instant *instant)
{
	struct last *last = of;
	assert_int_equal(signal, 0);
	assert_true(last->rows == 0 || instant->time >= last->at.time);
	assert_true(isnan(instant->u[1]) && isnan(instant->v[1]) && isnan(instant->acceleration[1]) &&
	            isnan(instant->gap)); // the last building has no right neighbor
	if (last->rows++)
		last->impulse += 0.5 * (instant->time - last->at.time) * (instant->force + last->at.force);
	last->at = *instant;
}

static void a_history_ends_where_the_response_does(void **state)
{
	(void)state;
	static const char bodies[] = "\"buildings\": [" TALL ", " LOW "]", contact[] = "\"gap_m\": 0.005",
	                  ground[] = WAVE "4";
	char document[2000];
	snprintf(document, sizeof document,
	         "{\"kind\": \"response\", \"scene\": {%s, \"contact\": {%s}, \"excitation\": {%s}}}", bodies,
	         contact, ground);
	struct pound_study *study = study_documents_study(document);
	struct pound_run *run = run_all(study);
	const struct pound_row_response *row = &pound_run_result(run)->cells[0].rows[0];
	for (int storey = 1; storey <= 3; storey++) {
		char place[60];
		struct last last = {0};
		snprintf(place, sizeof place, ", \"place\": {\"building\": 1, \"storey\": %d}", storey);
		struct spectra s = spectra_of(bodies, contact, ground, place);
		assert_int_equal(pound_run_history(s.run, 0, instant_take, &last), POUND_OK);
		check_near(last.at.time, 2, 1e-12);
		check_near(last.at.u[0], row->storeys[4 + storey - 1].end_u, 1e-13);
		check_near(last.at.v[0], row->storeys[4 + storey - 1].end_v, 1e-11);
		// the contact pushes the left building to the left, the right one to the right
		assert_true(last.impulse < 0);
		assert_true(last.rows > 201);
		spectra_free(&s);
	}
	pound_run_free(run);
	study_free(study);
}

/* What a history shows of the contact of its floor. */
struct contact_history {
	double gap;           /* gap in the document [m] */
	double off, size;     /* largest |gap_m - (gap + u_right - u)|, and largest displacement [m] */
	double force, impact; /* largest force [N]; largest impulse of a contact, trapezoidal rule [N s] */
	double wrong;         /* largest force at times when there must be none [N] */
	double now;
	struct pound_instant at;
};

static void contact_take(void *of, int signal, const struct pound_instant *i)
{
	struct contact_history *h = of;
	(void)signal;
	h->size = fmax(h->size, fmax(fabs(i->u[0]), fabs(i->u[1])));
	h->off = fmax(h->off, fabs(i->gap - (h->gap + i->u[1] - i->u[0])));
	h->force = fmax(h->force, i->force);
	// an elastic contact never pulls, and has no force without overlap
	h->wrong = fmax(h->wrong, i->gap > 0 ? fabs(i->force) : -i->force);
	h->now = i->force == 0 && h->at.force == 0
	             ? 0
	             : h->now + 0.5 * (i->time - h->at.time) * (i->force + h->at.force);
	h->impact = fmax(h->impact, h->now);
	h->at = *i;
}

static void a_history_has_the_contact_of_its_floor(void **state)
{
	(void)state;
	static const char bodies[] =
	    "\"buildings\": [" TALL ", " LOW ", " TALL "], \"contacts\": ["
	    "{\"left_building\": 0, \"levels\": [1, 1]}, {\"left_building\": 0, \"levels\": [2, 1.5]}, "
	    "{\"left_building\": 0, \"levels\": [3, 3]}, {\"left_building\": 1, \"levels\": [3, 3.25]}]",
	                  contact[] = "\"gap_m\": 0.005, \"restitution\": 1", ground[] = WAVE "4";
	static const struct {
		int contact, building, storey, right[2]; /* floors of the right level in the response */
		double weight[2];
	} places[] = {{0, 0, 1, {4, 4}, {1, 0}},
	              {1, 0, 2, {4, 5}, {0.5, 0.5}},
	              {2, 0, 3, {6, 6}, {1, 0}},
	              {3, 1, 3, {9, 10}, {0.75, 0.25}}};
	char document[2000];
	snprintf(document, sizeof document,
	         "{\"kind\": \"response\", \"scene\": {%s, \"contact\": {%s}, \"excitation\": {%s}}}", bodies,
	         contact, ground);
	struct pound_study *study = study_documents_study(document);
	struct pound_run *run = run_all(study);
	const struct pound_row_response *row = &pound_run_result(run)->cells[0].rows[0];
	for (size_t k = 0; k < sizeof places / sizeof places[0]; k++) {
		char place[60];
		struct contact_history h = {.gap = 0.005};
		const struct pound_contact_response *of = &row->contacts[places[k].contact];
		double end = 0;
		snprintf(place, sizeof place, ", \"place\": {\"building\": %d, \"storey\": %d}", places[k].building,
		         places[k].storey);
		struct spectra s = spectra_of(bodies, contact, ground, place);
		assert_int_equal(pound_run_history(s.run, 0, contact_take, &h), POUND_OK);
		for (int i = 0; i < 2; i++)
			end += places[k].weight[i] * row->storeys[places[k].right[i]].end_u;
		assert_true(of->contact_count > 1);
		check_near(h.at.u[1], end, 1e-13);
		check_near(h.off, 0, 64 * 2.2e-16 * (h.size + 0.005));
		check_near(h.wrong, 0, 1e-9 * h.force);
		check_near(h.force, of->force_max, 0.005 * of->force_max);
		check_near(h.impact, of->impulse_max, 0.005 * of->impulse_max);
		spectra_free(&s);
	}
	pound_run_free(run);
	study_free(study);
}

/* ---- spectra from histories ---- */

enum { LINES_MAX = 1 << 18 };

struct lines {
	int n;
	struct floor_line line[LINES_MAX];
};

static void line_take(void *of, int signal, const struct pound_instant *instant)
{
	struct lines *lines = of;
	(void)signal;
	assert_true(lines->n < LINES_MAX);
	lines->line[lines->n++] = (struct floor_line){instant->time, instant->v[0], instant->acceleration[0]};
}

/* Includes rigid impacts, where the velocity jumps. */
static void histories_of_every_contact_model_give_the_spectrum_within_half_a_percent(void **state)
{
	(void)state;
	static const char lossy[] = ", \"restitution\": 0.6",
	                  yields[] = ", \"second_stiffness_ratio\": 0.4, \"yield_overlap_m\": 2e-4";
	static const struct {
		const char *name, *members;
	} models[] = {{"kelvin_voigt", lossy},  {"linear", ""},          {"modified_kelvin_voigt", lossy},
	              {"hunt_crossley", lossy}, {"hertz", ""},           {"hertz_damp", lossy},
	              {"viscoelastic", lossy},  {"damped_hertz", lossy}, {"bilinear", yields},
	              {"rigid", lossy}};
	static const char *const bodies[] = {"\"oscillators\": [{\"mass_kg\": 1e5, \"frequency_hz\": 2}, "
	                                     "{\"mass_kg\": 1.7e5, \"frequency_hz\": 3.1}]",
	                                     "\"buildings\": [" TALL ", " LOW "]"};
	static const char *const places[] = {"", ", \"place\": {\"building\": 0, \"storey\": 3}"};
	static struct lines lines;
	static const double PI = 3.14159265358979323846;
	double most[2] = {0, 0};
	for (size_t m = 0; m < sizeof models / sizeof models[0]; m++)
		for (int b = 0; b < 2; b++) {
			char contact[200];
			snprintf(contact, sizeof contact, "\"model\": \"%s\", \"gap_m\": 0.004%s", models[m].name,
			         models[m].members);
			struct spectra s = spectra_of(bodies[b], contact, WAVE "4", places[b]);
			const struct pound_floor_spectrum *with = &s.floor->spectra[POUND_SPECTRUM_POUNDING],
			                                  *impacts = &s.floor->spectra[POUND_SPECTRUM_IMPACT_ONLY];
			lines.n = 0;
			assert_int_equal(pound_run_history(s.run, 0, line_take, &lines), POUND_OK);
			assert_true(s.floor->pulses_mean > 1);
			for (int k = 0; k < s.study->spectrum.n; k++) {
				const double psa =
				    floor_task_lines(lines.n, lines.line, 2 * PI * s.study->spectrum.frequencies_hz[k],
				                     s.study->spectrum.damping_ratio);
				assert_true(impacts->mean[k] < 60 * with->mean[k]);
				most[b] = fmax(most[b], fabs(psa / with->mean[k] - 1));
				if (!(fabs(psa / with->mean[k] - 1) < 0.005))
					fail_msg("%s of %s: %.17g beside %.17g at %g Hz", models[m].name, b ? "a row" : "a pair",
					         psa, with->mean[k], s.study->spectrum.frequencies_hz[k]);
			}
			spectra_free(&s);
		}
	check_report("spectra by straight lines between rows, ten contact models: pairs %.2e off, rows %.2e",
	             most[0], most[1]);
}

CHECK_MAIN(cmocka_unit_test(a_row_of_one_story_buildings_is_two_oscillators),
           cmocka_unit_test(a_mirrored_row_has_mirrored_floors),
           cmocka_unit_test(a_place_without_a_name_is_the_top_of_the_left_building),
           cmocka_unit_test(an_ordinate_of_a_row_is_that_of_a_study_of_spectra),
           cmocka_unit_test(a_history_ends_where_the_response_does),
           cmocka_unit_test(a_history_has_the_contact_of_its_floor),
           cmocka_unit_test(histories_of_every_contact_model_give_the_spectrum_within_half_a_percent))
