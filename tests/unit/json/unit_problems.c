/* unit_problems.c - the list of mistakes and the body that reports them. */
#include <string.h>

#include "schema/json/problems.h"
#include "tests/support/check.h"

static void a_body_lists_every_problem(void **state)
{
	(void)state;
	struct problems problems;
	struct problem_head head = {422, "invalid-study", "Unprocessable Content", "the study has 2 problems"};
	size_t length;
	problems_init(&problems);
	problems_add(&problems, "/scene/contact/restitution", "must be in [%d, %d], got %g", 0, 1, 1.4);
	problems_add(&problems, "/x\"y", "unknown member, did you mean \"%s\"?", "name");
	char *body = problem_to_json(&head, &problems, &length);
	assert_string_equal(
	    body,
	    "{\n  \"type\": \"invalid-study\",\n  \"title\": \"Unprocessable Content\",\n  \"status\": 422,\n"
	    "  \"detail\": \"the study has 2 problems\",\n  \"errors\": [\n"
	    "    {\"pointer\": \"/scene/contact/restitution\", \"detail\": \"must be in [0, 1], got 1.4\"},\n"
	    "    {\"pointer\": \"/x\\\"y\", \"detail\": \"unknown member, did you mean \\\"name\\\"?\"}\n  "
	    "]\n}\n");
	assert_int_equal(length, strlen(body));
	free(body);
}

static void a_body_without_a_study_has_no_errors(void **state)
{
	(void)state;
	struct problem_head head = {404, NULL, "Not Found", NULL};
	size_t length;
	char *body = problem_to_json(&head, NULL, &length);
	assert_string_equal(body,
	                    "{\n  \"type\": \"about:blank\",\n  \"title\": \"Not Found\",\n  \"status\": 404,\n"
	                    "  \"detail\": null\n}\n");
	free(body);
}

static void malformed_text_has_its_line_and_column(void **state)
{
	(void)state;
	struct problems problems;
	struct problem_head head = {400, NULL, "Bad Request", "x"};
	size_t length;
	problems_init(&problems);
	problems_add(&problems, "", "not UTF-8");
	problems.status = PROBLEMS_MALFORMED;
	problems.line = 3;
	problems.column = 14;
	char *body = problem_to_json(&head, &problems, &length);
	assert_non_null(strstr(body, "\"line\": 3,\n  \"column\": 14,\n"));
	assert_non_null(strstr(body, "{\"pointer\": \"\", \"detail\": \"not UTF-8\"}"));
	free(body);
}

static void a_full_list_counts_what_it_cannot_hold(void **state)
{
	(void)state;
	struct problems problems;
	struct problem_head head = {422, NULL, "x", "y"};
	size_t length;
	problems_init(&problems);
	for (int i = 0; i < PROBLEMS_MAX + 7; i++)
		problems_add(&problems, "/a", "%d", i);
	assert_int_equal(problems.n, PROBLEMS_MAX);
	assert_int_equal(problems.n_more, 7);
	assert_string_equal(problems.list[PROBLEMS_MAX - 1].detail, "99");
	char *body = problem_to_json(&head, &problems, &length);
	assert_non_null(strstr(body, "\"errors_not_listed\": 7"));
	free(body);
}

static void long_texts_end_with_dots_between_characters(void **state)
{
	(void)state;
	struct problems problems;
	char lengthy[3001] = {0};
	problems_init(&problems);
	for (int shift = 0; shift < 4; shift++) {
		memset(lengthy, 'x', (size_t)shift);
		for (int i = shift; i + 3 <= 3000; i += 3)
			memcpy(lengthy + i, "\xE2\x82\xAC", 3);
		problems_add(&problems, lengthy, "%s", lengthy);
		struct problem *problem = &problems.list[shift];
		char *const texts[] = {problem->pointer, problem->detail};
		for (int k = 0; k < 2; k++) {
			size_t length = strlen(texts[k]);
			assert_string_equal(texts[k] + length - 3, "...");
			assert_int_equal((length - 3 - (size_t)shift) % 3, 0);
			assert_int_equal(memcmp(texts[k], lengthy, length - 3), 0);
		}
	}
}

static void a_problem_is_at_its_pointer_and_all_above_it(void **state)
{
	(void)state;
	struct problems problems;
	problems_init(&problems);
	problems_add(&problems, "/inputs/1/name", "x");
	static const char *const at[] = {"", "/inputs", "/inputs/1", "/inputs/1/name"};
	static const char *const elsewhere[] = {"/input", "/inputs/10", "/inputs/1/nam", "/inputs/1/name/0"};
	for (int k = 0; k < 4; k++) {
		assert_true(problems_at(&problems, at[k]));
		assert_false(problems_at(&problems, elsewhere[k]));
	}
}

static void a_problem_is_over_all_that_is_in_it(void **state)
{
	(void)state;
	struct problems problems;
	problems_init(&problems);
	problems_add(&problems, "/scene/contact", "must be an object, got a number");
	problems_add(&problems, "/design/rows", "must be at least 2, got 1");
	assert_true(problems_over(&problems, "/scene/contact"));
	assert_true(problems_over(&problems, "/scene/contact/gap_m"));
	assert_false(problems_over(&problems, "/scene/contacts"));
	assert_false(problems_over(&problems, "/scene"));
	assert_false(problems_over(&problems, "/design"));
}

CHECK_MAIN(cmocka_unit_test(a_problem_is_over_all_that_is_in_it),
           cmocka_unit_test(a_problem_is_at_its_pointer_and_all_above_it),
           cmocka_unit_test(a_body_lists_every_problem),
           cmocka_unit_test(a_body_without_a_study_has_no_errors),
           cmocka_unit_test(malformed_text_has_its_line_and_column),
           cmocka_unit_test(a_full_list_counts_what_it_cannot_hold),
           cmocka_unit_test(long_texts_end_with_dots_between_characters))
