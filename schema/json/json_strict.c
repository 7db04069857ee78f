/* json_strict.c - a strict check of JSON text: the grammar of RFC 8259 by recursive descent, one function per rule.
 *
 * The parser behind it takes `01`, `2.`, control characters and half surrogates, cuts texts at \u0000 and turns
 * 1e400 into infinity; none of these comes through here.  \u0000 is refused although JSON allows it: a C string
 * ends there. */
#include "schema/json/json_strict.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

struct gate {
	const char *text;
	size_t length, at;
	int depth;
	struct gate_fault *fault;
};

/* Notes what is wrong at the current place and where that is; always false. */
static bool refuse(struct gate *gate, const char *detail)
{
	gate->fault->line = 1;
	gate->fault->column = 1;
	for (size_t i = 0; i < gate->at; i++) {
		if (gate->text[i] == '\n') {
			gate->fault->line++;
			gate->fault->column = 1;
		} else if ((gate->text[i] & 0xC0) != 0x80) {
			gate->fault->column++;
		}
	}
	snprintf(gate->fault->detail, sizeof gate->fault->detail, "%s", detail);
	return false;
}

/* The byte at the current place, -1 after the last. */
static int peek(const struct gate *gate)
{
	return gate->at < gate->length ? (unsigned char)gate->text[gate->at] : -1;
}

static bool refuse_expected(struct gate *gate, const char *expected)
{
	char detail[sizeof gate->fault->detail];
	int c = peek(gate);
	if (c < 0)
		snprintf(detail, sizeof detail, "the text ends where %s is expected", expected);
	else if (c > ' ' && c < 0x7F)
		snprintf(detail, sizeof detail, "expected %s, found %c", expected, c);
	else
		snprintf(detail, sizeof detail, "expected %s, found the byte 0x%02X", expected, (unsigned)c);
	return refuse(gate, detail);
}

static void space(struct gate *gate)
{
	for (int c = peek(gate); c == ' ' || c == '\t' || c == '\n' || c == '\r'; c = peek(gate))
		gate->at++;
}

static bool is_digit(int c)
{
	return c >= '0' && c <= '9';
}

static bool digits(struct gate *gate, const char *expected)
{
	if (!is_digit(peek(gate)))
		return refuse_expected(gate, expected);
	while (is_digit(peek(gate)))
		gate->at++;
	return true;
}

static bool number(struct gate *gate)
{
	char copy[GATE_NUMBER_MAX + 1];
	size_t start = gate->at;
	if (peek(gate) == '-')
		gate->at++;
	bool zero = peek(gate) == '0';
	if (!digits(gate, "a digit"))
		return false;
	if (zero && gate->at - start > (gate->text[start] == '-' ? 2u : 1u)) {
		gate->at = start;
		return refuse(gate, "a number must not have leading zeros");
	}
	if (peek(gate) == '.') {
		gate->at++;
		if (!digits(gate, "a digit after the decimal point"))
			return false;
	}
	if (peek(gate) == 'e' || peek(gate) == 'E') {
		gate->at++;
		if (peek(gate) == '+' || peek(gate) == '-')
			gate->at++;
		if (!digits(gate, "a digit of the exponent"))
			return false;
	}
	size_t length = gate->at - start;
	size_t end = gate->at;
	gate->at = start;
	if (length > GATE_NUMBER_MAX)
		return refuse(gate, "a number of more than 400 characters");
	memcpy(copy, gate->text + start, length);
	copy[length] = 0;
	if (isinf(strtod(copy, NULL)))
		return refuse(gate, "a number beyond the largest double, 1.797e308");
	gate->at = end;
	return true;
}

/* The code unit of \uXXXX with the current place on the first X, -1 if these are not four hex digits. */
static int code_unit(struct gate *gate)
{
	int unit = 0;
	for (int i = 0; i < 4; i++, gate->at++) {
		int c = peek(gate), low = c | 0x20;
		if (!is_digit(c) && !(low >= 'a' && low <= 'f'))
			return -1;
		unit = unit * 16 + (is_digit(c) ? c - '0' : low - 'a' + 10);
	}
	return unit;
}

static bool escape(struct gate *gate)
{
	size_t start = gate->at++;
	int c = peek(gate);
	if (c < 0 || !strchr("\"\\/bfnrtu", c) || c == 0) {
		gate->at = start;
		return refuse(gate, "an unknown escape sequence");
	}
	gate->at++;
	if (c != 'u')
		return true;
	int unit = code_unit(gate);
	const char *detail = unit < 0                           ? "\\u must be followed by four hex digits"
	                     : unit == 0                        ? "\\u0000 is not allowed in a string"
	                     : unit >= 0xDC00 && unit <= 0xDFFF ? "a lone low surrogate"
	                                                        : NULL;
	if (!detail && unit >= 0xD800 && unit <= 0xDBFF) {
		bool pair = peek(gate) == '\\' && gate->at + 1 < gate->length && gate->text[gate->at + 1] == 'u';
		gate->at += pair ? 2 : 0;
		int low = pair ? code_unit(gate) : -1;
		if (low < 0xDC00 || low > 0xDFFF)
			detail = "a high surrogate without its low surrogate";
	}
	if (detail) {
		gate->at = start;
		return refuse(gate, detail);
	}
	return true;
}

/* Source   Unicode 15, table 3-7 */
size_t gate_character(const char *text, size_t length)
{
	const unsigned char *s = (const unsigned char *)text;
	size_t n = s[0] < 0x80 ? 1 : s[0] >= 0xC2 && s[0] < 0xE0 ? 2 : (s[0] & 0xF0) == 0xE0 ? 3 : 4;
	if (n > length || (n == 4 && (s[0] < 0xF0 || s[0] > 0xF4)))
		return 0;
	// no overlong forms, no surrogates, nothing past U+10FFFF
	unsigned low = s[0] == 0xE0 ? 0xA0 : s[0] == 0xF0 ? 0x90 : 0x80;
	unsigned high = s[0] == 0xED ? 0x9F : s[0] == 0xF4 ? 0x8F : 0xBF;
	for (size_t i = 1; i < n; i++, low = 0x80, high = 0xBF)
		if (s[i] < low || s[i] > high)
			return 0;
	return n;
}

static bool string(struct gate *gate)
{
	size_t start = ++gate->at;
	for (int c = peek(gate); c != '"'; c = peek(gate)) {
		if (c < 0)
			return refuse(gate, "the text ends inside a string");
		if (gate->at - start >= GATE_STRING_MAX)
			return refuse(gate, "a string of more than 65536 bytes");
		if (c < 0x20)
			return refuse(gate, "a control character in a string must be written as an escape");
		if (c == '\\') {
			if (!escape(gate))
				return false;
		} else {
			size_t n = gate_character(gate->text + gate->at, gate->length - gate->at);
			if (!n)
				return refuse(gate, "not UTF-8");
			gate->at += n;
		}
	}
	gate->at++;
	return true;
}

static bool value(struct gate *gate);

static bool member(struct gate *gate, int n)
{
	space(gate);
	if (n > GATE_MEMBERS_MAX)
		return refuse(gate, "an object of more than 256 members");
	if (peek(gate) != '"')
		return refuse_expected(gate, "a member name in double quotes");
	if (!string(gate))
		return false;
	space(gate);
	if (peek(gate) != ':')
		return refuse_expected(gate, "a colon");
	gate->at++;
	return value(gate);
}

/* What stands between brackets, the current place being on the opening one. */
static bool list(struct gate *gate, char close)
{
	if (gate->depth == GATE_DEPTH_MAX)
		return refuse(gate, "arrays and objects nested more than 32 deep");
	gate->depth++;
	gate->at++;
	space(gate);
	if (peek(gate) != close) {
		for (int n = 1;; n++, gate->at++) {
			if (close == '}' ? !member(gate, n) : !value(gate))
				return false;
			space(gate);
			if (peek(gate) != ',')
				break;
		}
		if (peek(gate) != close)
			return refuse_expected(gate, close == '}' ? "a comma or }" : "a comma or ]");
	}
	gate->at++;
	gate->depth--;
	return true;
}

static bool word(struct gate *gate, const char *expected)
{
	size_t length = strlen(expected);
	if (gate->length - gate->at < length || memcmp(gate->text + gate->at, expected, length) != 0)
		return refuse_expected(gate, "a value");
	gate->at += length;
	return true;
}

static bool value(struct gate *gate)
{
	space(gate);
	int c = peek(gate);
	if (c == '{' || c == '[')
		return list(gate, c == '{' ? '}' : ']');
	if (c == '"')
		return string(gate);
	if (c == '-' || is_digit(c))
		return number(gate);
	return word(gate, c == 't' ? "true" : c == 'f' ? "false" : "null");
}

/* Whether a text is one JSON value within the limits of json_strict.h and nothing else.
 *
 * Given    text      (length)  bytes   need not end with a zero
 * Returns  value     -         -       true: strict JSON
 *          fault     -         -       where and why not (only then written)
 *
 * Test     unit_json_strict: every_kind_of_broken_text_is_refused
 */
bool gate_check(const char *text, size_t length, struct gate_fault *fault)
{
	struct gate gate = {.text = text, .length = length, .fault = fault};
	if (length >= 3 && memcmp(text, "\xEF\xBB\xBF", 3) == 0)
		return refuse(&gate, "a byte order mark, which JSON does not allow");
	if (!value(&gate))
		return false;
	space(&gate);
	return gate.at == length || refuse_expected(&gate, "the end of the text");
}
