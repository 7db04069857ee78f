/* unit_json_strict.c - texts that are JSON and texts that are not, of every kind; the public test suite if it is installed. */
#include <dirent.h>
#include <stdio.h>
#include <string.h>

#include "schema/json/json_strict.h"
#include "tests/support/check.h"

struct text {
	const char *bytes;
	size_t length;
};

#define TEXT(literal)                \
	{                                \
		literal, sizeof(literal) - 1 \
	}
#define COUNT(array) ((int)(sizeof(array) / sizeof(array)[0]))

static bool passes(const char *bytes, size_t length)
{
	struct json_fault fault;
	// a copy without a terminating zero, so that a sanitizer detects reading beyond the end
	char *copy = malloc(length ? length : 1);
	assert_non_null(copy);
	memcpy(copy, bytes, length);
	bool strict = json_strict_check(copy, length, &fault);
	free(copy);
	if (!strict) {
		assert_true(fault.line >= 1 && fault.column >= 1);
		assert_true(strlen(fault.detail) > 0);
	}
	return strict;
}

static void every_kind_of_broken_text_is_refused(void **state)
{
	(void)state;
	static const struct text broken[] = {
	    // nothing, or too much
	    TEXT(""),
	    TEXT(" "),
	    TEXT("{}{}"),
	    TEXT("[] x"),
	    TEXT("1 2"),
	    TEXT("{},"),
	    TEXT("\"a\" \"b\""),
	    TEXT("[1]]"),
	    TEXT("{}}"),
	    TEXT("\xEF\xBB\xBF{}"),
	    TEXT("\xEF\xBB\xBF"),
	    TEXT("\0"),
	    TEXT("[]\0"),
	    // numbers
	    TEXT("01"),
	    TEXT("-01"),
	    TEXT("00"),
	    TEXT("2."),
	    TEXT("2.e3"),
	    TEXT(".5"),
	    TEXT("-.1"),
	    TEXT("-"),
	    TEXT("+1"),
	    TEXT("1e"),
	    TEXT("1e+"),
	    TEXT("1E-"),
	    TEXT("0e"),
	    TEXT("1.5.2"),
	    TEXT("0x1F"),
	    TEXT("1_000"),
	    TEXT("- 1"),
	    TEXT("1 000"),
	    TEXT("NaN"),
	    TEXT("-NaN"),
	    TEXT("Infinity"),
	    TEXT("-Infinity"),
	    TEXT("inf"),
	    TEXT("nan"),
	    TEXT("1a"),
	    TEXT("--1"),
	    TEXT("1e1.5"),
	    TEXT("1e400"),
	    TEXT("-1e400"),
	    TEXT("1.8e308"),
	    TEXT("[1e9999999999]"),
	    TEXT("1,5"),
	    TEXT("\xEF\xBC\x91"),
	    // literals
	    TEXT("tru"),
	    TEXT("True"),
	    TEXT("TRUE"),
	    TEXT("nul"),
	    TEXT("truee"),
	    TEXT("falsE"),
	    TEXT("undefined"),
	    TEXT("nulll"),
	    // arrays
	    TEXT("["),
	    TEXT("[1"),
	    TEXT("[1,"),
	    TEXT("[1,]"),
	    TEXT("[,1]"),
	    TEXT("[1,,2]"),
	    TEXT("[1 2]"),
	    TEXT("[1;2]"),
	    TEXT("]"),
	    TEXT("[1}"),
	    TEXT("[:]"),
	    TEXT("[1:2]"),
	    TEXT("[\"a\" true]"),
	    // objects
	    TEXT("{"),
	    TEXT("{\"a\""),
	    TEXT("{\"a\":"),
	    TEXT("{\"a\":1"),
	    TEXT("{\"a\":1,"),
	    TEXT("{\"a\":1,}"),
	    TEXT("{,}"),
	    TEXT("{\"a\" 1}"),
	    TEXT("{\"a\"=1}"),
	    TEXT("{a:1}"),
	    TEXT("{'a':1}"),
	    TEXT("{1:1}"),
	    TEXT("{null:1}"),
	    TEXT("{\"a\"}"),
	    TEXT("{\"a\"::1}"),
	    TEXT("{\"a\":1 \"b\":2}"),
	    TEXT("{\"a\":1]"),
	    TEXT("{[]:1}"),
	    TEXT("{\"a\":1,,\"b\":2}"),
	    // strings
	    TEXT("\""),
	    TEXT("\"a"),
	    TEXT("'a'"),
	    TEXT("\"a\nb\""),
	    TEXT("\"a\tb\""),
	    TEXT("\"a\x01\""),
	    TEXT("\"a\x1f\""),
	    TEXT("\"a\0b\""),
	    TEXT("\"\\\""),
	    TEXT("\"\\"),
	    TEXT("\"\\x41\""),
	    TEXT("\"\\a\""),
	    TEXT("\"\\'\""),
	    TEXT("\"\\0\""),
	    TEXT("\"\\\0\""),
	    TEXT("\"\\U0041\""),
	    TEXT("\"\\u\""),
	    TEXT("\"\\u12\""),
	    TEXT("\"\\u12g4\""),
	    TEXT("\"\\u 123\""),
	    TEXT("\"\\u"),
	    TEXT("\"\\u0000\""),
	    TEXT("{\"\\u0000\":1}"),
	    // surrogates
	    TEXT("\"\\uD800\""),
	    TEXT("\"\\uDBFFx\""),
	    TEXT("\"\\uD800\\n\""),
	    TEXT("\"\\uD800\\u0041\""),
	    TEXT("\"\\uD800\\uD800\""),
	    TEXT("\"\\uDC00\""),
	    TEXT("\"\\uDC00\\uD800\""),
	    TEXT("\"\\uD800\\u\""),
	    TEXT("\"\\uD800\\"),
	    // UTF-8: lone and missing continuations, overlong forms, surrogates, past U+10FFFF, Latin-1, UTF-16
	    TEXT("\"\x80\""),
	    TEXT("\"\xBF\""),
	    TEXT("\"\xC3\""),
	    TEXT("\"\xC3"),
	    TEXT("\"\xC0\x80\""),
	    TEXT("\"\xC1\xBF\""),
	    TEXT("\"\xE0\x80\x80\""),
	    TEXT("\"\xE0\x9F\xBF\""),
	    TEXT("\"\xE2\x82\""),
	    TEXT("\"\xED\xA0\x80\""),
	    TEXT("\"\xED\xBF\xBF\""),
	    TEXT("\"\xF0\x80\x80\x80\""),
	    TEXT("\"\xF0\x8F\xBF\xBF\""),
	    TEXT("\"\xF0\x9F\x98\""),
	    TEXT("\"\xF4\x90\x80\x80\""),
	    TEXT("\"\xF5\x80\x80\x80\""),
	    TEXT("\"\xF8\x88\x80\x80\x80\""),
	    TEXT("\"\xFC\x84\x80\x80\x80\x80\""),
	    TEXT("\"\xFE\""),
	    TEXT("\"\xFF\""),
	    TEXT("\"\xE9t\xE9\""),
	    TEXT("\xFF\xFE{\0}\0"),
	    TEXT("{\0}\0"),
	    TEXT("\"\xF0\x9F\x98"),
	    // characters that are not white space, and comments
	    TEXT("[\f]"),
	    TEXT("[\v]"),
	    TEXT("[\xC2\xA0]"),
	    TEXT("[\xE2\x80\xA8]"),
	    TEXT("[1]\0 "),
	    TEXT("/* c */ {}"),
	    TEXT("{} // c"),
	    TEXT("# c\n{}"),
	    TEXT("{\"a\":/* c */1}"),
	    TEXT("<a/>"),
	    TEXT("[\x7F]"),
	};
	for (int i = 0; i < COUNT(broken); i++)
		if (passes(broken[i].bytes, broken[i].length))
			fail_msg("accepted: %s", broken[i].bytes);
}

static void strict_texts_pass(void **state)
{
	(void)state;
	static const struct text strict[] = {
	    TEXT("{}"),
	    TEXT("[]"),
	    TEXT("0"),
	    TEXT("-0"),
	    TEXT("\"\""),
	    TEXT("true"),
	    TEXT("false"),
	    TEXT("null"),
	    TEXT(" \t\r\n{ \"a\" : [ 1 , 2 ] }\n"),
	    TEXT("1e5"),
	    TEXT("1E+5"),
	    TEXT("1e-5"),
	    TEXT("0.5"),
	    TEXT("-0.0e-0"),
	    TEXT("0e1"),
	    TEXT("1e-400"),
	    TEXT("1.7976931348623157e308"),
	    TEXT("123456789012345678901234567890"),
	    TEXT("\"\\\"\\\\\\/\\b\\f\\n\\r\\t\""),
	    TEXT("\"\\u0041\\u00e9\\uFFFF\""),
	    TEXT("\"\\uD83D\\uDE00\""),
	    TEXT("\"\\udbff\\udfff\""),
	    TEXT("\"\\\\u0000\""),
	    TEXT("\"\xC3\xA9\xE2\x82\xAC\xF0\x9F\x98\x80\""),
	    TEXT("\"\xC2\x80\xDF\xBF\xE0\xA0\x80\xED\x9F\xBF\xEE\x80\x80\xF0\x90\x80\x80\xF4\x8F\xBF\xBF\""),
	    TEXT("\"\x7F\""),
	    TEXT("{\"a\":1,\"a\":2}"),
	    TEXT("[[[[]]],{\"\":{}}]"),
	};
	for (int i = 0; i < COUNT(strict); i++)
		if (!passes(strict[i].bytes, strict[i].length))
			fail_msg("refused: %s", strict[i].bytes);
}

static void the_place_of_a_fault_is_its_line_and_column(void **state)
{
	(void)state;
	static const struct {
		const char *text;
		int line, column;
		const char *detail;
	} cases[] = {
	    {"", 1, 1, "the text ends where a value is expected"},
	    {"{\"a\": 01}", 1, 7, "a number must not have leading zeros"},
	    {"{\n  \"a\": 1,\n  \"b\": tru\n}", 3, 8, "expected a value, found t"},
	    {"[1, 2", 1, 6, "the text ends where a comma or ] is expected"},
	    {"[1 2]", 1, 4, "expected a comma or ], found 2"},
	    {"{\"a\" 1}", 1, 6, "expected a colon, found 1"},
	    {"{\"a\":1,}", 1, 8,
	     "expected a member name in double quotes, found }: the comma before it is one too many"},
	    {"[1, 2, ]", 1, 8, "expected a value, found ]: the comma before it is one too many"},
	    {"{\"a\": NaN}", 1, 7, "expected a value, found N: JSON has no such number"},
	    {"[-Infinity]", 1, 3, "expected a digit, found I: JSON has no such number"},
	    {"{\"a\": 1, // one", 1, 10,
	     "expected a member name in double quotes, found /: JSON has no comments"},
	    {"# a\n{}", 1, 1, "expected a value, found #: JSON has no comments"},
	    {"{\"a\": 0,02}", 1, 9,
	     "expected a member name in double quotes, found 0: a decimal comma? JSON has a decimal point"},
	    {"{} x", 1, 4, "expected the end of the text, found x"},
	    // a column counts characters, not bytes
	    {"[\"\xC3\xA9\xF0\x9F\x98\x80\", x]", 1, 8, "expected a value, found x"},
	    {"[\r\n\r\n  1e999]", 3, 3, "a number beyond the largest double, 1.797e308"},
	    {"[\"ab\\q\"]", 1, 5, "an unknown escape sequence"},
	    {"[\"ab\\uD800\"]", 1, 5, "a high surrogate without its low surrogate"},
	    {"[\"ab\xFF\"]", 1, 5, "not UTF-8"},
	    {"[\f]", 1, 2, "expected a value, found the byte 0x0C"},
	};
	for (int i = 0; i < COUNT(cases); i++) {
		struct json_fault fault = {0};
		assert_false(json_strict_check(cases[i].text, strlen(cases[i].text), &fault));
		assert_string_equal(fault.detail, cases[i].detail);
		assert_int_equal(fault.line, cases[i].line);
		assert_int_equal(fault.column, cases[i].column);
	}
}

/* Whether `n` repetitions of a piece between two ends are accepted. */
static bool repeated_passes(const char *before, const char *piece, int n, const char *after)
{
	size_t size = strlen(before) + strlen(piece) * (size_t)n + strlen(after) + 1;
	char *text = malloc(size);
	assert_non_null(text);
	char *at = stpcpy(text, before);
	for (int i = 0; i < n; i++)
		at = stpcpy(at, piece);
	stpcpy(at, after);
	bool strict = passes(text, size - 1);
	free(text);
	return strict;
}

static void each_limit_is_allowed_and_one_more_is_not(void **state)
{
	(void)state;
	assert_true(
	    repeated_passes("[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[", "", 0, "]]]]]]]]]]]]]]]]]]]]]]]]]]]]]]]]"));
	assert_false(
	    repeated_passes("[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[", "", 0, "]]]]]]]]]]]]]]]]]]]]]]]]]]]]]]]]]"));
	assert_true(repeated_passes("\"", "x", JSON_STRING_MAX, "\""));
	assert_false(repeated_passes("\"", "x", JSON_STRING_MAX + 1, "\""));
	assert_true(repeated_passes("{\"a\":1", ",\"a\":1", JSON_MEMBERS_MAX - 1, "}"));
	assert_false(repeated_passes("{\"a\":1", ",\"a\":1", JSON_MEMBERS_MAX, "}"));
	assert_true(repeated_passes("0.", "1", JSON_NUMBER_MAX - 2, ""));
	assert_false(repeated_passes("0.", "1", JSON_NUMBER_MAX - 1, ""));
	assert_true(repeated_passes("[0", ",0", 100000, "]"));
	assert_false(repeated_passes("", "[", 100000, ""));
	assert_false(repeated_passes("", "{\"a\":", 100000, ""));
}

/* The whole file; the caller frees it. */
static char *file_bytes(const char *folder, const char *name, size_t *length)
{
	char path[1024];
	snprintf(path, sizeof path, "%s/%s", folder, name);
	FILE *file = fopen(path, "rb");
	assert_non_null(file);
	enum { SIZE = 1 << 20 };
	char *bytes = malloc(SIZE);
	assert_non_null(bytes);
	*length = fread(bytes, 1, SIZE, file);
	fclose(file);
	return bytes;
}

static void the_public_suite_is_judged_as_it_says(void **state)
{
	(void)state;
	// valid JSON that is refused on purpose: a C string ends at U+0000
	static const char *const refused[] = {"y_object_escaped_null_in_key.json", "y_string_null_escape.json"};
	const char *folder = getenv("JSONTESTSUITE_DIR");
	DIR *files = folder ? opendir(folder) : NULL;
	if (!files)
		skip();
	int broken = 0, strict = 0;
	for (struct dirent *entry = readdir(files); entry; entry = readdir(files)) {
		const char *name = entry->d_name;
		if (name[1] != '_' || !strstr(name, ".json") || !strchr("nyi", name[0]))
			continue;
		size_t length;
		char *bytes = file_bytes(folder, name, &length);
		bool passed = passes(bytes, length);
		bool on_purpose = !strcmp(name, refused[0]) || !strcmp(name, refused[1]);
		free(bytes);
		if ((name[0] == 'n' && passed) || (name[0] == 'y' && passed == on_purpose))
			fail_msg("%s: %s", name, passed ? "accepted" : "refused");
		broken += name[0] == 'n';
		strict += name[0] == 'y';
	}
	closedir(files);
	print_message("%d must-reject and %d must-accept files\n", broken, strict);
	assert_true(broken > 100 && strict > 50);
}

CHECK_MAIN(cmocka_unit_test(every_kind_of_broken_text_is_refused), cmocka_unit_test(strict_texts_pass),
           cmocka_unit_test(the_place_of_a_fault_is_its_line_and_column),
           cmocka_unit_test(each_limit_is_allowed_and_one_more_is_not),
           cmocka_unit_test(the_public_suite_is_judged_as_it_says))
