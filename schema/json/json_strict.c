/* json_strict.c - a strict check of JSON text: the grammar of RFC 8259 by recursive descent, one function per rule.
 *
 * cJSON accepts `01`, `2.`, control characters and lone surrogates, truncates strings at \u0000 and turns
 * 1e400 into infinity; all of these are refused here.  \u0000 is refused although JSON allows it, because a C string
 * ends there. */
#include "schema/json/json_strict.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

struct scan {
	const char *text;
	size_t length, at;
	int depth;
	struct json_fault *fault;
};

/* Stores an error with the line and column of the current position; always false. */
static bool refuse(struct scan *scan, const char *detail)
{
	scan->fault->line = 1;
	scan->fault->column = 1;
	for (size_t i = 0; i < scan->at; i++) {
		if (scan->text[i] == '\n') {
			scan->fault->line++;
			scan->fault->column = 1;
		} else if ((scan->text[i] & 0xC0) != 0x80) {
			scan->fault->column++;
		}
	}
	snprintf(scan->fault->detail, sizeof scan->fault->detail, "%s", detail);
	return false;
}

/* The byte at the current position, -1 after the last. */
static int peek(const struct scan *scan)
{
	return scan->at < scan->length ? (unsigned char)scan->text[scan->at] : -1;
}

static bool is_digit(int c)
{
	return c >= '0' && c <= '9';
}

/* A hint about a construct from other languages at the current position; "": none is recognized. */
static const char *habit(const struct scan *scan)
{
	static const char *const words[] = {"NaN", "nan", "Infinity", "inf"};
	const char *at = scan->text + scan->at;
	const size_t left = scan->length - scan->at;
	size_t before = scan->at;
	while (before > 0 && strchr(" \t\r\n", scan->text[before - 1]))
		before--;
	const bool comma = before > 0 && scan->text[before - 1] == ',';
	for (size_t k = 0; k < sizeof words / sizeof words[0]; k++)
		if (left >= strlen(words[k]) && memcmp(at, words[k], strlen(words[k])) == 0)
			return ": JSON has no such number";
	return left == 0                             ? ""
	       : comma && (*at == '}' || *at == ']') ? ": the comma before it is one too many"
	       : *at == '/' || *at == '#'            ? ": JSON has no comments"
	       : comma && before > 1 && before == scan->at && is_digit(scan->text[before - 2]) && is_digit(*at)
	           ? ": a decimal comma? JSON has a decimal point"
	           : "";
}

static bool refuse_expected(struct scan *scan, const char *expected)
{
	char detail[sizeof scan->fault->detail];
	int c = peek(scan);
	if (c < 0)
		snprintf(detail, sizeof detail, "the text ends where %s is expected", expected);
	else if (c > ' ' && c < 0x7F)
		snprintf(detail, sizeof detail, "expected %s, found %c%s", expected, c, habit(scan));
	else
		snprintf(detail, sizeof detail, "expected %s, found the byte 0x%02X", expected, (unsigned)c);
	return refuse(scan, detail);
}

static void space(struct scan *scan)
{
	for (int c = peek(scan); c == ' ' || c == '\t' || c == '\n' || c == '\r'; c = peek(scan))
		scan->at++;
}

static bool digits(struct scan *scan, const char *expected)
{
	if (!is_digit(peek(scan)))
		return refuse_expected(scan, expected);
	while (is_digit(peek(scan)))
		scan->at++;
	return true;
}

static bool number(struct scan *scan)
{
	char copy[JSON_NUMBER_MAX + 1];
	size_t start = scan->at;
	if (peek(scan) == '-')
		scan->at++;
	bool zero = peek(scan) == '0';
	if (!digits(scan, "a digit"))
		return false;
	if (zero && scan->at - start > (scan->text[start] == '-' ? 2u : 1u)) {
		scan->at = start;
		return refuse(scan, "a number must not have leading zeros");
	}
	if (peek(scan) == '.') {
		scan->at++;
		if (!digits(scan, "a digit after the decimal point"))
			return false;
	}
	if (peek(scan) == 'e' || peek(scan) == 'E') {
		scan->at++;
		if (peek(scan) == '+' || peek(scan) == '-')
			scan->at++;
		if (!digits(scan, "a digit of the exponent"))
			return false;
	}
	size_t length = scan->at - start;
	size_t end = scan->at;
	scan->at = start;
	if (length > JSON_NUMBER_MAX)
		return refuse(scan, "a number of more than 400 characters");
	memcpy(copy, scan->text + start, length);
	copy[length] = 0;
	if (isinf(strtod(copy, NULL)))
		return refuse(scan, "a number beyond the largest double, 1.797e308");
	scan->at = end;
	return true;
}

/* The code unit of \uXXXX with the current position at the first X, -1 if these are not four hex digits. */
static int code_unit(struct scan *scan)
{
	int unit = 0;
	for (int i = 0; i < 4; i++, scan->at++) {
		int c = peek(scan), low = c | 0x20;
		if (!is_digit(c) && !(low >= 'a' && low <= 'f'))
			return -1;
		unit = unit * 16 + (is_digit(c) ? c - '0' : low - 'a' + 10);
	}
	return unit;
}

static bool escape(struct scan *scan)
{
	size_t start = scan->at++;
	int c = peek(scan);
	if (c < 0 || !strchr("\"\\/bfnrtu", c) || c == 0) {
		scan->at = start;
		return refuse(scan, "an unknown escape sequence");
	}
	scan->at++;
	if (c != 'u')
		return true;
	int unit = code_unit(scan);
	const char *detail = unit < 0                           ? "\\u must be followed by four hex digits"
	                     : unit == 0                        ? "\\u0000 is not allowed in a string"
	                     : unit >= 0xDC00 && unit <= 0xDFFF ? "a lone low surrogate"
	                                                        : NULL;
	if (!detail && unit >= 0xD800 && unit <= 0xDBFF) {
		bool pair = peek(scan) == '\\' && scan->at + 1 < scan->length && scan->text[scan->at + 1] == 'u';
		scan->at += pair ? 2 : 0;
		int low = pair ? code_unit(scan) : -1;
		if (low < 0xDC00 || low > 0xDFFF)
			detail = "a high surrogate without its low surrogate";
	}
	if (detail) {
		scan->at = start;
		return refuse(scan, detail);
	}
	return true;
}

/* Source   Unicode 15, table 3-7 */
size_t json_strict_character(const char *text, size_t length)
{
	const unsigned char *s = (const unsigned char *)text;
	size_t n = s[0] < 0x80 ? 1 : s[0] >= 0xC2 && s[0] < 0xE0 ? 2 : (s[0] & 0xF0) == 0xE0 ? 3 : 4;
	if (n > length || (n == 4 && (s[0] < 0xF0 || s[0] > 0xF4)))
		return 0;
	// no overlong forms, no surrogates, nothing above U+10FFFF
	unsigned low = s[0] == 0xE0 ? 0xA0 : s[0] == 0xF0 ? 0x90 : 0x80;
	unsigned high = s[0] == 0xED ? 0x9F : s[0] == 0xF4 ? 0x8F : 0xBF;
	for (size_t i = 1; i < n; i++, low = 0x80, high = 0xBF)
		if (s[i] < low || s[i] > high)
			return 0;
	return n;
}

static bool string(struct scan *scan)
{
	size_t start = ++scan->at;
	for (int c = peek(scan); c != '"'; c = peek(scan)) {
		if (c < 0)
			return refuse(scan, "the text ends inside a string");
		if (scan->at - start >= JSON_STRING_MAX)
			return refuse(scan, "a string of more than 65536 bytes");
		if (c < 0x20)
			return refuse(scan, "a control character in a string must be written as an escape");
		if (c == '\\') {
			if (!escape(scan))
				return false;
		} else {
			size_t n = json_strict_character(scan->text + scan->at, scan->length - scan->at);
			if (!n)
				return refuse(scan, "not UTF-8");
			scan->at += n;
		}
	}
	scan->at++;
	return true;
}

static bool value(struct scan *scan);

static bool member(struct scan *scan, int n)
{
	space(scan);
	if (n > JSON_MEMBERS_MAX)
		return refuse(scan, "an object of more than 256 members");
	if (peek(scan) != '"')
		return refuse_expected(scan, "a member name in double quotes");
	if (!string(scan))
		return false;
	space(scan);
	if (peek(scan) != ':')
		return refuse_expected(scan, "a colon");
	scan->at++;
	return value(scan);
}

/* Members or elements in brackets, with the current position at the opening bracket. */
static bool list(struct scan *scan, char close)
{
	if (scan->depth == JSON_DEPTH_MAX)
		return refuse(scan, "arrays and objects nested more than 32 deep");
	scan->depth++;
	scan->at++;
	space(scan);
	if (peek(scan) != close) {
		for (int n = 1;; n++, scan->at++) {
			if (close == '}' ? !member(scan, n) : !value(scan))
				return false;
			space(scan);
			if (peek(scan) != ',')
				break;
		}
		if (peek(scan) != close)
			return refuse_expected(scan, close == '}' ? "a comma or }" : "a comma or ]");
	}
	scan->at++;
	scan->depth--;
	return true;
}

static bool word(struct scan *scan, const char *expected)
{
	size_t length = strlen(expected);
	if (scan->length - scan->at < length || memcmp(scan->text + scan->at, expected, length) != 0)
		return refuse_expected(scan, "a value");
	scan->at += length;
	return true;
}

static bool value(struct scan *scan)
{
	space(scan);
	int c = peek(scan);
	if (c == '{' || c == '[')
		return list(scan, c == '{' ? '}' : ']');
	if (c == '"')
		return string(scan);
	if (c == '-' || is_digit(c))
		return number(scan);
	return word(scan, c == 't' ? "true" : c == 'f' ? "false" : "null");
}

/* Whether a text is one JSON value within the limits of json_strict.h and nothing else.
 *
 * Given    text      (length)  bytes   not necessarily zero-terminated
 * Returns  value     -         -       true: strict JSON
 *          fault     -         -       position and error; unchanged if there is none
 *
 * Test     unit_json_strict: every_kind_of_broken_text_is_refused
 */
bool json_strict_check(const char *text, size_t length, struct json_fault *fault)
{
	struct scan scan = {.text = text, .length = length, .fault = fault};
	if (length >= 3 && memcmp(text, "\xEF\xBB\xBF", 3) == 0)
		return refuse(&scan, "a byte order mark, which JSON does not allow");
	if (!value(&scan))
		return false;
	space(&scan);
	return scan.at == length || refuse_expected(&scan, "the end of the text");
}
