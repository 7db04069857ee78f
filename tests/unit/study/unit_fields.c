/* unit_fields.c - the table of request fields: complete and consistent; suggestions for misspelled names. */
#include <math.h>
#include <string.h>

#include "schema/study/fields.h"
#include "schema/study/near_name.h"
#include "schema/study/study_json.h"
#include "tests/support/check.h"

static void every_default_is_in_its_range(void **state)
{
	(void)state;
	for (int i = 0; i < fields_count; i++) {
		const struct field *field = &fields[i];
		bool number = field->type == FIELD_REAL || field->type == FIELD_COUNT;
		// a default of 0 outside the range: absent, derived from other members
		const bool not_given = field->ends == FIELD_OPEN_MIN && field->absent == 0;
		if (!number || isnan(field->absent) || not_given)
			continue;
		if (!fields_in_range(field, field->absent))
			fail_msg("%s: %g is out of range", field->pattern, field->absent);
	}
}

static void every_row_stands_below_an_object_or_a_list(void **state)
{
	(void)state;
	for (int i = 0; i < fields_count; i++) {
		char parent[128];
		strcpy(parent, fields[i].pattern);
		*strrchr(parent, '/') = 0;
		assert_ptr_equal(fields_find(fields[i].pattern), &fields[i]);
		assert_true(strlen(fields[i].text) > 0 && fields[i].unit);
		assert_true(fields[i].type != FIELD_CHOICE || fields[i].choice);
		if (*parent == 0)
			continue;
		const struct field *above = fields_find(parent);
		assert_non_null(above);
		assert_true(fields_child(&fields[i], parent));
		bool list = strcmp(fields_name(&fields[i]), "*") == 0;
		// frequencies are a list, or an object that describes one
		bool range = strcmp(parent, "/spectrum/frequencies_hz") == 0;
		assert_int_equal(above->type, list || range ? FIELD_LIST : FIELD_OBJECT);
	}
}

static void every_field_says_what_it_takes(void **state)
{
	(void)state;
	static const struct {
		const char *pattern, *expected;
	} cases[] = {
	    {"/scene/contact/restitution", "a number in [0, 1]"},
	    {"/scene/oscillators/*/damping_ratio", "a number in [0, 1)"},
	    {"/scene/oscillators/*/mass_kg", "a number greater than 0 kg"},
	    {"/scene/contact/gap_m", "a number of at least 0 m"},
	    {"/scene/excitation/acceleration_m_s2/*", "a number m/s2"},
	    {"/scene/law/corrections", "a whole number in [0, 100]"},
	    {"/scene/contact/tension", "true or false"},
	    {"/scene/contact/calibration", "one of \"classic\", \"exact\""},
	    {"/design/signals", "one of \"independent\", \"common\""},
	    {"/design/seed", "a whole number below 2^53, or the digits of one below 2^64 as a string"},
	    {"/inputs/*/path", "a string of 1 to 200 characters"},
	    {"/scene/contact", "an object"},
	    {"/scene/oscillators", "an array of 2 elements"},
	    {"/outputs", "an array of 1 to 24 elements"},
	};
	for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
		char expected[FIELDS_EXPECTED_SIZE];
		fields_expected(fields_find(cases[i].pattern), expected, sizeof expected);
		assert_string_equal(expected, cases[i].expected);
	}
	for (int i = 0; i < fields_count; i++) {
		char expected[FIELDS_EXPECTED_SIZE];
		fields_expected(&fields[i], expected, sizeof expected);
		assert_true(strlen(expected) > 0 && strlen(expected) < sizeof expected - 1);
	}
}

static void a_path_names_one_field_of_the_scene(void **state)
{
	(void)state;
	struct field_place place;
	const struct field *field = fields_scene("/oscillators/1/law/type", &place);
	assert_string_equal(field->pattern, "/scene/oscillators/*/law/type");
	assert_int_equal(place.element, 1);
	field = fields_scene("/oscillators/0", &place);
	assert_int_equal(field->type, FIELD_OBJECT);
	assert_int_equal(place.element, 0);
	field = fields_scene("/contact/gap_m", &place);
	assert_string_equal(field->pattern, "/scene/contact/gap_m");
	assert_int_equal(place.element, -1);
	field = fields_scene("/buildings/7/mass_kg/49", &place);
	assert_string_equal(field->pattern, "/scene/buildings/*/mass_kg");
	assert_int_equal(place.element, 7);
	assert_int_equal(place.index, 49);
	field = fields_scene("/contacts/399/levels/1", &place);
	assert_string_equal(field->pattern, "/scene/contacts/*/levels/*");
	assert_int_equal(place.element, 399);
	assert_int_equal(place.index, 1);
	static const char *const none[] = {"/buildings/8/mass_kg",        "/buildings/0/mass_kg/50",
	                                   "/contacts/400/gap_m",         "/contacts/0/levels/2",
	                                   "/buildings/0/frequency_hz/0", "/buildings/00/mass_kg",
	                                   "/buildings/0/mass_kg/",       "/buildings/0/mass_kg/0/0"};
	for (size_t k = 0; k < sizeof none / sizeof none[0]; k++)
		assert_null(fields_scene(none[k], &place));
}

static void texts_are_in_american_spelling(void **state)
{
	(void)state;
	for (int i = 0; i < fields_count; i++) {
		char expected[2048];
		fields_expected(&fields[i], expected, sizeof expected);
		const char *const texts[] = {fields[i].text, fields[i].choice ? "" : expected};
		for (int k = 0; k < 2; k++)
			for (const char *at = texts[k]; at && (at = strstr(at, "storey")); at++)
				if (at == texts[k] || at[-1] != '"') // a name of the contract stands in quotes
					fail_msg("%s: %s", fields[i].pattern, texts[k]);
	}
}

static void a_slip_of_the_pen_is_near_and_a_stranger_is_not(void **state)
{
	(void)state;
	static const struct {
		const char *a, *b;
		int distance;
	} cases[] = {
	    {"restitution", "restitution", 0},
	    {"restituton", "restitution", 1},
	    {"Restitution", "restitution", 0},
	    {"resittution", "restitution", 1},
	    {"mass", "mass_kg", 1},
	    {"mass_kg", "mass", 1},
	    {"ab", "abc", 1},
	    {"", "abc", 3},
	    {"kitten", "sitting", 3},
	    {"abcd", "acbd", 1},
	    {"colour", "seed", 6},
	    {"ca", "abc", 3},
	};
	for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
		assert_int_equal(near_name_distance(cases[i].a, cases[i].b), cases[i].distance);
		assert_int_equal(near_name_distance(cases[i].b, cases[i].a), cases[i].distance);
	}
	assert_true(near_name(1, "gap"));
	assert_false(near_name(2, "gap"));
	assert_true(near_name(3, "restitution"));
	assert_false(near_name(4, "restitution"));
	// longer than any table of distances
	char lengthy[5000];
	memset(lengthy, 'x', sizeof lengthy - 1);
	lengthy[sizeof lengthy - 1] = 0;
	assert_false(near_name(near_name_distance(lengthy, "restitution"), lengthy));
}

static void kind_excitation_and_solver_decide_what_is_used(void **state)
{
	(void)state;
	assert_true(fields_used(fields_find("/inputs"), "sensitivity", NULL, NULL));
	assert_false(fields_used(fields_find("/inputs"), "response", NULL, NULL));
	assert_true(fields_used(fields_find("/inputs"), NULL, NULL, NULL));
	assert_true(fields_used(fields_find("/scene/excitation/rise"), "response", "white_noise", NULL));
	assert_false(fields_used(fields_find("/scene/excitation/rise"), "response", "record", NULL));
	assert_false(fields_used(fields_find("/scene/excitation/rise"), "response", "noise",
	                         NULL)); // part of a name does not match
	assert_true(fields_used(fields_find("/solver/step_s"), "response", NULL, "newmark"));
	assert_false(fields_used(fields_find("/solver/step_s"), "response", NULL, "event"));
	assert_true(fields_used(fields_find("/solver/step_s"), "response", NULL, NULL));
	// every name in a row is a name of the engine
	for (int i = 0; i < fields_count; i++) {
		int n = 0, known = 0;
		for (const char *s = fields[i].types; s && s[1]; s = strchr(s + 1, ' '))
			n++;
		for (int row = 0; fields[i].types && pound_excitation_name(row); row++)
			known += fields_used(&fields[i], NULL, pound_excitation_name(row), NULL);
		assert_int_equal(n, known);
	}
}

/* A limit that depends on other members must be in the text of its field, which schema/study.md and OpenAPI show. */
static void every_limit_between_members_stands_in_the_text_of_its_field(void **state)
{
	(void)state;
	static const struct {
		const char *pattern;
		double limit;
	} limits[] = {
	    {"/scene/excitation/time_step_s", STUDY_SAMPLES_MAX},
	    {"/ratios", POUND_FACTORIAL_INPUTS_MAX},
	    {"/sweep", STUDY_CELLS_MAX},
	    {"/design/rows", STUDY_RUNS_MAX},
	    {"/design/order", POUND_FACTORIAL_INPUTS_MAX},
	    {"/solver/step_s", STUDY_STEPS_MAX},
	    {"/spectrum/frequencies_hz", POUND_ORDINATES_MAX},
	    {"/spectrum/frequencies_hz", STUDY_ORDINATES_MAX},
	    {"/histories", STUDY_HISTORIES_MAX},
	    {"/convergence", STUDY_TRIALS_MAX},
	};
	for (size_t i = 0; i < sizeof limits / sizeof limits[0]; i++) {
		char number[32];
		snprintf(number, sizeof number, " %.0f", limits[i].limit);
		const char *text = fields_find(limits[i].pattern)->text, *at = strstr(text, number);
		if (!at || (at[strlen(number)] >= '0' && at[strlen(number)] <= '9'))
			fail_msg("%s does not say%s", limits[i].pattern, number);
	}
}

CHECK_MAIN(cmocka_unit_test(every_limit_between_members_stands_in_the_text_of_its_field),
           cmocka_unit_test(every_default_is_in_its_range),
           cmocka_unit_test(every_row_stands_below_an_object_or_a_list),
           cmocka_unit_test(every_field_says_what_it_takes),
           cmocka_unit_test(a_path_names_one_field_of_the_scene),
           cmocka_unit_test(texts_are_in_american_spelling),
           cmocka_unit_test(a_slip_of_the_pen_is_near_and_a_stranger_is_not),
           cmocka_unit_test(kind_excitation_and_solver_decide_what_is_used))
