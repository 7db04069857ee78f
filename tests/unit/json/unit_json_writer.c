/* unit_json_writer.c - JSON and CSV text as written; numbers are read back bit for bit. */
#include <float.h>
#include <math.h>
#include <string.h>

#include "schema/json/json_writer.h"
#include "tests/support/check.h"

static void takes(struct writer *w, const char *wanted)
{
	size_t length;
	char *text = writer_take(w, &length);
	assert_string_equal(text, wanted);
	assert_int_equal(length, strlen(wanted));
	free(text);
}

static void a_document_comes_out_as_it_was_put_in(void **state)
{
	(void)state;
	struct writer w;
	writer_init(&w);
	writer_object(&w, NULL, WRITER_LINES);
	writer_text(&w, "name", "a");
	writer_text(&w, "nothing", NULL);
	writer_array(&w, "none", WRITER_LINES);
	writer_end(&w);
	writer_array(&w, "rows", WRITER_LINES);
	for (int i = 0; i < 2; i++) {
		writer_object(&w, NULL, WRITER_LINE);
		writer_whole(&w, "i", -i);
		writer_array(&w, "x", WRITER_LINES);
		writer_number(&w, NULL, 0.1);
		writer_number(&w, NULL, NAN);
		writer_end(&w);
		writer_bool(&w, "even", i == 0);
		writer_end(&w);
	}
	writer_end(&w);
	writer_object(&w, "empty", WRITER_LINE);
	writer_end(&w);
	writer_end(&w);
	takes(&w, "{\n  \"name\": \"a\",\n  \"nothing\": null,\n  \"none\": [],\n  \"rows\": [\n"
	          "    {\"i\": 0, \"x\": [0.1, null], \"even\": true},\n"
	          "    {\"i\": -1, \"x\": [0.1, null], \"even\": false}\n  ],\n  \"empty\": {}\n}\n");
}

static void texts_are_escaped(void **state)
{
	(void)state;
	struct writer w;
	writer_init(&w);
	writer_array(&w, NULL, WRITER_LINE);
	writer_text(&w, NULL, "");
	writer_text(&w, NULL, "\"\\/\n\t\r\b\x01\x1f\x7f");
	writer_text(&w, NULL, "a\"b\xC3\xA9\\");
	// text that is not UTF-8, or was truncated
	writer_text(&w, NULL, "\xE9t\xC3");
	writer_end(&w);
	takes(&w, "[\"\", \"\\\"\\\\/\\n\\t\\u000d\\u0008\\u0001\\u001f\x7f\", \"a\\\"b\xC3\xA9\\\\\", "
	          "\"\\ufffdt\\ufffd\"]\n");
}

static void a_seed_past_2_to_the_53_is_text(void **state)
{
	(void)state;
	struct writer w;
	writer_init(&w);
	writer_array(&w, NULL, WRITER_LINE);
	writer_seed(&w, NULL, 0);
	writer_seed(&w, NULL, (UINT64_C(1) << 53) - 1);
	writer_seed(&w, NULL, UINT64_C(1) << 53);
	writer_seed(&w, NULL, UINT64_MAX);
	writer_end(&w);
	takes(&w, "[0, 9007199254740991, \"9007199254740992\", \"18446744073709551615\"]\n");
}

static void plain_numbers_stay_plain(void **state)
{
	(void)state;
	static const struct {
		double value;
		const char *digits;
	} cases[] = {
	    {0.0, "0"},
	    {-0.0, "-0"},
	    {1.0, "1"},
	    {0.1, "0.1"},
	    {-2.5, "-2.5"},
	    {0.1 + 0.2, "0.30000000000000004"},
	    {1e300, "1e+300"},
	    {1e15, "1e+15"},
	    {123456789012345.0, "123456789012345"},
	    {0x1p53, "9007199254740992"},
	    {DBL_MAX, "1.7976931348623157e+308"},
	    {DBL_TRUE_MIN, "4.94065645841247e-324"},
	    {DBL_MIN, "2.2250738585072014e-308"},
	    {NAN, "null"},
	    {INFINITY, "null"},
	    {-INFINITY, "null"},
	};
	for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
		char digits[WRITER_NUMBER_SIZE];
		assert_int_equal(writer_digits(cases[i].value, digits), strlen(cases[i].digits));
		assert_string_equal(digits, cases[i].digits);
	}
}

static uint64_t bits_of(double value)
{
	uint64_t bits;
	memcpy(&bits, &value, sizeof bits);
	return bits;
}

static void reads_back(uint64_t bits)
{
	double value;
	char digits[WRITER_NUMBER_SIZE];
	memcpy(&value, &bits, sizeof value);
	if (!isfinite(value))
		return;
	assert_true(writer_digits(value, digits) < WRITER_NUMBER_SIZE);
	if (bits_of(strtod(digits, NULL)) != bits)
		fail_msg("%a reads back from %s as %a", value, digits, strtod(digits, NULL));
}

static void a_million_random_numbers_read_back_to_the_same_bits(void **state)
{
	(void)state;
	uint64_t x = 88172645463325252u; // xorshift64, Marsaglia 2003
	for (int i = 0; i < 1000000; i++) {
		x ^= x << 13;
		x ^= x >> 7;
		x ^= x << 17;
		// every eighth is subnormal, every other one of ordinary size
		uint64_t exponent = i % 8 == 0 ? 0 : i % 2 ? 1023 - 10 + x % 20 : x >> 52 & 0x7FF;
		reads_back((x & UINT64_C(0x800FFFFFFFFFFFFF)) | exponent << 52);
	}
	for (uint64_t bits = 1; bits; bits <<= 1)
		reads_back(bits);
}

static void a_cell_is_never_a_formula(void **state)
{
	(void)state;
	static const struct {
		const char *text, *cell;
	} cases[] = {
	    {"", ""},
	    {"f_e", "f_e"},
	    {"m_2/m_1", "m_2/m_1"},
	    {"a,b", "\"a,b\""},
	    {"say \"x\"", "\"say \"\"x\"\"\""},
	    {"two\nlines", "\"two\nlines\""},
	    {"=1+1", "'=1+1"},
	    {"+1", "'+1"},
	    {"-1", "'-1"},
	    {"@sum", "'@sum"},
	    {"\tx", "'\tx"},
	    {"\rx", "\"'\rx\""},
	    {"=HYPERLINK(\"a\",\"b\")", "\"'=HYPERLINK(\"\"a\"\",\"\"b\"\")\""},
	};
	for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
		struct writer w;
		writer_init(&w);
		writer_cell(&w, cases[i].text);
		takes(&w, cases[i].cell);
	}
}

static void out_of_memory_shows_only_at_the_end(void **state)
{
	(void)state;
	struct writer w;
	size_t length = 1;
	writer_init(&w);
	writer_array(&w, NULL, WRITER_LINES);
	writer_text(&w, NULL, "kept");
	w.failed = true; // as after a failed growth
	writer_text(&w, NULL, "dropped");
	writer_number(&w, NULL, 1.0);
	writer_end(&w);
	assert_null(writer_take(&w, &length));
	assert_int_equal(length, 0);
	writer_array(&w, NULL, WRITER_LINE);
	writer_end(&w);
	takes(&w, "[]\n");
}

static void long_documents_grow_without_loss(void **state)
{
	(void)state;
	struct writer w;
	size_t length;
	enum { N = 20000 };
	writer_init(&w);
	writer_array(&w, NULL, WRITER_LINE);
	for (int i = 0; i < N; i++)
		writer_whole(&w, NULL, 10000 + i);
	writer_end(&w);
	char *text = writer_take(&w, &length);
	assert_int_equal(length,
	                 7 * N + 1); // five digits, comma and space each; no last comma, brackets, newline
	for (int i = 0; i < N; i++)
		assert_int_equal(strtol(text + 1 + 7 * i, NULL, 10), 10000 + i);
	free(text);
}

CHECK_MAIN(cmocka_unit_test(a_document_comes_out_as_it_was_put_in), cmocka_unit_test(texts_are_escaped),
           cmocka_unit_test(a_seed_past_2_to_the_53_is_text), cmocka_unit_test(plain_numbers_stay_plain),
           cmocka_unit_test(a_million_random_numbers_read_back_to_the_same_bits),
           cmocka_unit_test(a_cell_is_never_a_formula), cmocka_unit_test(out_of_memory_shows_only_at_the_end),
           cmocka_unit_test(long_documents_grow_without_loss))
