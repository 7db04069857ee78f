/* unit_json_pointer.c - documents read by JSON Pointer. */
#include <math.h>
#include <string.h>

#include "schema/json/json_pointer.h"
#include "tests/support/check.h"

static const char text[] =
    "{\"status\": \"running\", \"progress\": 0.25, \"error\": null, \"done\": true, \"never\": false,\n"
    " \"errors\": [{\"pointer\": \"/a\"}, {\"pointer\": \"/b\", \"n\": -1e-300}],\n"
    " \"sweep\": {\"/law/type\": \"linear\", \"a~b\": 2, \"\": 3}, \"Status\": 5}";

static struct reading *opened(void)
{
	struct reading *reading = reading_open(text, strlen(text));
	assert_non_null(reading);
	return reading;
}

static void values_stand_where_their_pointers_say(void **state)
{
	(void)state;
	struct reading *r = opened();
	assert_string_equal(reading_text(r, "/status"), "running");
	check_near(reading_number(r, "/progress"), 0.25, 0);
	check_near(reading_number(r, "/Status"), 5, 0);
	assert_true(reading_true(r, "/done"));
	assert_false(reading_true(r, "/never") || reading_true(r, "/status") || reading_true(r, "/nowhere"));
	for (int i = 0; i < 2; i++)
		assert_string_equal(reading_text(r, "/errors/%d/pointer", i), i ? "/b" : "/a");
	check_near(reading_number(r, "/errors/%d/%s", 1, "n"), -1e-300, 0);
	assert_int_equal(reading_count(r, "/errors"), 2);
	assert_int_equal(reading_count(r, "/sweep"), 3);
	assert_int_equal(reading_count(r, "%s", ""), 8);
	reading_close(r);
}

static void escapes_reach_names_with_slashes_and_tildes(void **state)
{
	(void)state;
	struct reading *r = opened();
	assert_string_equal(reading_text(r, "/sweep/~1law~1type"), "linear");
	check_near(reading_number(r, "/sweep/a~0b"), 2, 0);
	check_near(reading_number(r, "/sweep/"), 3, 0);
	assert_string_equal(reading_member(r, 0, "/sweep"), "/law/type");
	assert_null(reading_member(r, 3, "/sweep"));
	assert_null(reading_member(r, -1, "/sweep"));
	assert_null(reading_member(r, 0, "/errors"));
	reading_close(r);
}

static void what_is_not_there_is_not_made_up(void **state)
{
	(void)state;
	struct reading *r = opened();
	char lengthy[1000];
	memset(lengthy, 'x', sizeof lengthy - 1);
	lengthy[sizeof lengthy - 1] = 0;
	assert_true(reading_has(r, "/error"));
	assert_null(reading_text(r, "/error"));
	assert_true(isnan(reading_number(r, "/error")));
	assert_true(isnan(reading_number(r, "/status")));
	assert_null(reading_text(r, "/progress"));
	static const char *const nowhere[] = {"/nowhere",
	                                      "/STATUS",
	                                      "status",
	                                      "/errors/2",
	                                      "/errors/-1",
	                                      "/errors/00",
	                                      "/errors/x",
	                                      "/errors/99999999999",
	                                      "/errors/",
	                                      "/status/0",
	                                      "/errors/0/pointer/0"};
	for (size_t i = 0; i < sizeof nowhere / sizeof nowhere[0]; i++)
		if (reading_has(r, "%s", nowhere[i]))
			fail_msg("found %s", nowhere[i]);
	assert_false(reading_has(r, "/%s", lengthy));
	assert_int_equal(reading_count(r, "/nowhere"), 0);
	assert_int_equal(reading_count(r, "/status"), 0);
	reading_close(r);
}

static void what_is_not_json_is_not_opened(void **state)
{
	(void)state;
	assert_null(reading_open("", 0));
	assert_null(reading_open("<html>", 6));
	assert_null(reading_open("{\"a\": 01}", 9));
	reading_close(NULL);
}

static void a_number_of_400_characters_keeps_its_value(void **state)
{
	(void)state;
	// cJSON reads 63 characters of a number; longer ones must be read correctly, too
	char document[1300], digits[401], leading[401];
	memset(digits, '7', 400);
	memcpy(digits, "0.1", 3);
	digits[400] = 0;
	memset(leading, '0', 400);
	memcpy(leading, "-0.", 3);
	memcpy(leading + 390, "125e-2", 7); // -0.000...0125e-2
	snprintf(document, sizeof document, "{\"%.64s\": [%s, \"%s\\\"\", 0.1e1, %s], \"e\": 1.5}", digits,
	         digits, digits, leading);
	struct reading *r = reading_open(document, strlen(document));
	assert_non_null(r);
	check_near(reading_number(r, "/%.64s/0", digits), strtod(digits, NULL), 0);
	assert_int_equal(strlen(reading_text(r, "/%.64s/1", digits)), 401);
	check_near(reading_number(r, "/%.64s/2", digits), 1, 0);
	check_near(reading_number(r, "/%.64s/3", digits), strtod(leading, NULL), 0);
	check_near(reading_number(r, "/e"), 1.5, 0);
	reading_close(r);
}

CHECK_MAIN(cmocka_unit_test(values_stand_where_their_pointers_say),
           cmocka_unit_test(escapes_reach_names_with_slashes_and_tildes),
           cmocka_unit_test(what_is_not_there_is_not_made_up),
           cmocka_unit_test(what_is_not_json_is_not_opened),
           cmocka_unit_test(a_number_of_400_characters_keeps_its_value))
