/* http_head.c - checks the head of a request: target, headers, framing and host.
 *
 * libmicrohttpd accepts requests that RFC 9112 forbids (two lengths, a length and a coding, NUL anywhere).  Two servers that read
 * such a request differently allow request smuggling, so the rules are applied here to the head that libmicrohttpd read.  A body
 * needs a Content-Length: a chunked body is refused, which RFC 9112 section 6.3 allows. */
#include "schema/http/http_head.h"

#include <arpa/inet.h>
#include <ctype.h>
#include <limits.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>

#include "schema/json/json_strict.h"

/* Notes why a request is refused; only the first reason is kept.
 *
 * Given    close    the end of the request is uncertain
 *          format   printf format of a sentence, and its values
 */
void head_refuse(struct head *head, enum api_fault fault, bool close, const char *format, ...)
{
	va_list values;
	head->close |= close;
	if (head->fault != API_NO_FAULT)
		return;
	head->fault = fault;
	va_start(values, format);
	vsnprintf(head->detail, sizeof head->detail, format, values);
	va_end(values);
	// bytes from a client may be invalid in JSON
	for (char *c = head->detail; *c; c++)
		*c = *c < ' ' || *c > '~' ? '?' : *c;
}

/* Starts the check with the target of the request.
 *
 * Given    target   path and arguments, not decoded
 * Returns  value    bytes of the target to parse: without the arguments if these are too many for the
 *                   memory of libmicrohttpd
 * Test     unit_http_head: a_target_is_visible_ascii_and_its_escapes_are_whole; a_target_has_so_many_bytes_and_arguments
 */
size_t head_target(struct head *head, const char *target)
{
	const size_t n = strlen(target), n_path = strcspn(target, "?");
	int n_arguments = target[n_path] == '?';
	*head = (struct head){.fault = API_NO_FAULT};
	if (n > HEAD_TARGET_MAX)
		head_refuse(head, API_TARGET_LONG, true, "the request target may have at most %d bytes",
		            HEAD_TARGET_MAX);
	for (const char *c = target; *c; c++) {
		if (*c <= ' ' || *c > '~')
			head_refuse(head, API_BAD_REQUEST, true,
			            "the request target contains characters that must be percent-encoded");
		if (*c != '%')
			continue;
		if (!isxdigit((unsigned char)c[1]) || !isxdigit((unsigned char)c[2]))
			head_refuse(head, API_BAD_REQUEST, false,
			            "a percent sign must be followed by two hexadecimal digits");
		else if (c[1] == '0' && c[2] == '0')
			head_refuse(head, API_BAD_REQUEST, false, "the request target must not contain %%00");
	}
	for (const char *c = target + n_path; *c; c++)
		n_arguments += *c == '&';
	if (n_arguments > HEAD_ARGUMENTS_MAX)
		head_refuse(head, API_BAD_REQUEST, true, "the request target may have at most %d query parameters",
		            HEAD_ARGUMENTS_MAX);
	return n > HEAD_TARGET_MAX || n_arguments > HEAD_ARGUMENTS_MAX ? n_path : n;
}

/* Checks the bytes of the headers.  libmicrohttpd writes a NUL at the end of each name and two in place of each CR LF.  Any
 * other number of NULs means that the client sent a NUL, which hides the bytes after it, or that a line is invalid: folded into
 * the previous line, without a name (libmicrohttpd then ends the head), or ended by LF only.
 *
 * Given    bytes     (n)   from the end of the version to the end of the empty line
 *          n_lines   number of headers found
 * Test     unit_http_head: a_head_has_no_byte_but_those_of_its_lines
 */
void head_bytes(struct head *head, const char *bytes, size_t n, int n_lines)
{
	int n_ends = 0;
	for (size_t i = 0; i < n; i++)
		n_ends += bytes[i] == '\0';
	if (n_lines > HEAD_LINES_MAX)
		head_refuse(head, API_HEAD_LARGE, true, "a request may have at most %d headers", HEAD_LINES_MAX);
	if (n_ends != 3 * n_lines + 4)
		head_refuse(head, API_BAD_REQUEST, true,
		            "a header must be a line NAME: VALUE that ends with CR LF and has no NUL");
}

static bool is_token(const char *name, size_t n)
{
	for (size_t i = 0; i < n; i++)
		if (!isalnum((unsigned char)name[i]) && (!name[i] || !strchr("!#$%&'*+-.^_`|~", name[i])))
			return false;
	return n > 0;
}

static bool is_text(const char *value, size_t n)
{
	for (size_t i = 0; i < n; i++)
		if (((unsigned char)value[i] < ' ' && value[i] != '\t') || value[i] == 0x7f)
			return false;
	return true;
}

static bool is(const char *name, size_t n, const char *known)
{
	return n == strlen(known) && !strncasecmp(name, known, n);
}

static bool is_blank(char c)
{
	return c == ' ' || c == '\t';
}

static bool is_json(const char *type, size_t n)
{
	size_t end = 0;
	while (end < n && type[end] != ';' && !is_blank(type[end]))
		end++;
	return is(type, end, "application/json");
}

/* Headers that are stored. */
static const struct {
	const char *name;
	size_t at; /* offset of its head_text in struct head */
	bool list; /* several lines are joined by commas into one list; false: the first line counts */
} texts[] = {
    {"Authorization", offsetof(struct head, authorization), false},
    {"Idempotency-Key", offsetof(struct head, key), false},
    {"If-None-Match", offsetof(struct head, etags), true},
    {"Prefer", offsetof(struct head, prefer), true},
    {"Accept", offsetof(struct head, accept), true},
    {"Origin", offsetof(struct head, origin), false},
    {"Sec-Fetch-Site", offsetof(struct head, site), false},
};

/* Stores a value, or as many whole elements of its list as fit: half an element could mean something else. */
static void keep(struct head_text *text, bool list, const char *value, size_t n_value)
{
	size_t n = strlen(text->value), room = sizeof text->value - n;
	if (text->lines++ > 0 && (!list || room < 2)) // no room for a comma, which marks where to truncate
		return;
	int wanted = snprintf(text->value + n, room, "%s%.*s", n ? "," : "", (int)n_value, value);
	if ((size_t)wanted < room)
		return;
	char *end = list ? strrchr(text->value, ',') : NULL;
	*(end ? end : text->value) = '\0';
}

/* Checks and stores the next header.
 *
 * Given    name    (n_name) bytes
 *          value   (n_value) bytes   without leading white space; trailing white space is removed here
 * Source   RFC 9110 section 5.5
 * Test     unit_http_head: white_space_behind_a_value_is_no_part_of_it
 */
void head_header(struct head *head, const char *name, size_t n_name, const char *value, size_t n_value)
{
	while (n_value > 0 && is_blank(value[n_value - 1]))
		n_value--;
	if (!is_token(name, n_name))
		head_refuse(head, API_BAD_REQUEST, true, "a header name contains characters that are not allowed");
	else if (!is_text(value, n_value))
		head_refuse(head, API_BAD_REQUEST, true, "a header value contains control characters");
	else if (is(name, n_name, "Host")) {
		head->hosts++;
		snprintf(head->host, sizeof head->host, "%.*s", (int)n_value, value);
	} else if (is(name, n_name, "Content-Length")) {
		head->lengths++;
		// libmicrohttpd has refused invalid numbers; strtoull returns its largest value for larger numbers
		unsigned long long length = strtoull(value, NULL, 10);
		head->has_body |= length > 0;
		head->length = length;
	} else if (is(name, n_name, "Transfer-Encoding")) {
		head->codings++;
		head->has_body = true;
	} else if (is(name, n_name, "Content-Encoding"))
		head->encoded |= !is(value, n_value, "identity");
	else if (is(name, n_name, "Content-Type")) {
		head->types++;
		head->json = is_json(value, n_value);
	}
	for (size_t i = 0; i < sizeof texts / sizeof texts[0]; i++)
		if (is(name, n_name, texts[i].name))
			keep((void *)((char *)head + texts[i].at), texts[i].list, value, n_value);
}

/* Checks a query argument.
 *
 * Given    operation   row of api_operations
 *          name        "" between two ampersands: ignored
 * Test     service_list: list_arguments_that_make_no_sense_are_400
 */
void head_argument(struct head *head, int operation, const char *name, const char *value)
{
	const struct api_argument *argument = api_argument(operation, name, "query");
	char expected[512];
	if (*name && !argument) {
		api_names(operation, "query", expected, sizeof expected);
		head_refuse(head, API_BAD_REQUEST, false, "%.60s is not a query parameter of %s%s%s", name,
		            api_operations[operation].path, *expected ? ", which has " : "", expected);
	} else if (*name && !api_takes(argument, value)) {
		api_expected(argument, expected, sizeof expected);
		char choice[API_CHOICE_SIZE];
		const char *nearest = api_nearest(argument, value, choice);
		head_refuse(head, API_BAD_REQUEST, false,
		            nearest ? "%s must be %s; did you mean %s?" : "%s must be %s", name, expected, nearest);
	}
}

/* Checks the whole head.
 *
 * Given    needs_host   HTTP/1.1 and later
 *          names        comma-separated hosts accepted in addition to localhost and addresses; NULL: none
 * Returns  head         with its fault, API_NO_FAULT: none
 * Test     unit_http_head: what_leaves_a_request_s_end_in_doubt_is_refused
 */
void head_end(struct head *head, bool needs_host, const char *names)
{
	if (head->lengths > 1)
		head_refuse(head, API_BAD_REQUEST, true, "a request must not have more than one Content-Length");
	if (head->lengths && head->codings)
		head_refuse(head, API_BAD_REQUEST, true,
		            "a request must not have both Content-Length and Transfer-Encoding");
	if (head->codings)
		head_refuse(head, API_NO_LENGTH, true,
		            "a body needs a Content-Length; Transfer-Encoding is not supported");
	if (head->authorization.lines > 1)
		head_refuse(head, API_BAD_REQUEST, true,
		            "a request must not have more than one Authorization header");
	if (head->types > 1)
		head_refuse(head, API_BAD_REQUEST, true, "a request must not have more than one Content-Type");
	if (head->hosts > 1 || (needs_host && !head->hosts))
		head_refuse(head, API_BAD_REQUEST, true, "a request must have exactly one Host");
	if (head->hosts && !head_has_host(head->host, names))
		head_refuse(head, API_MISDIRECTED, false,
		            "this server does not accept that Host; poundd --host adds names");
	if (head->encoded)
		head_refuse(head, API_NOT_JSON, false, "the only supported Content-Encoding is identity");
	if (!head->of_record && head->length > HEAD_BODY_MAX)
		head_refuse(head, API_TOO_LARGE, false, "a body may have at most 1 MiB");
	if (head->of_record && head->length > HEAD_RECORD_MAX)
		head_refuse(head, API_TOO_LARGE, false, "the file of a record may have at most 8 MiB");
}

/* Checks the origin of a request that changes data: for a web page the browser sends Origin and Sec-Fetch-Site, which must name
 * this server.  Other programs send neither.
 *
 * Source   RFC 6454 section 7; Fetch Metadata Request Headers section 2.3
 * Test     unit_http_head: what_a_page_of_another_origin_sends_is_foreign
 */
void head_origin(struct head *head)
{
	static const char *const schemes[] = {"http://", "https://"};
	const char *origin = head->origin.value, *site = head->site.value;
	bool own = head->origin.lines == 0;
	for (size_t i = 0; i < sizeof schemes / sizeof schemes[0]; i++) {
		size_t n = strlen(schemes[i]);
		own |= head->origin.lines == 1 && !strncasecmp(origin, schemes[i], n) && *head->host &&
		       !strcasecmp(origin + n, head->host);
	}
	if (!own || (head->site.lines && strcmp(site, "same-origin") != 0 && strcmp(site, "none") != 0))
		head_refuse(head, API_FOREIGN, false, "pages of another origin must not change anything here");
}

/* Checks the Idempotency-Key of a request that may have one: UTF-8, because it is stored as text, and only one, because a proxy
 * might read a different one.
 *
 * Test     unit_http_head: a_key_is_one_text_of_1_to_200_characters
 */
void head_key(struct head *head)
{
	const char *at = head->key.value, *end = at + strlen(at);
	size_t n = 1;
	int characters = 0;
	if (head->key.lines == 0)
		return;
	for (; at < end && (n = json_strict_character(at, (size_t)(end - at))) > 0; at += n)
		characters++;
	if (head->key.lines > 1)
		head_refuse(head, API_BAD_REQUEST, false, "a request must not have more than one Idempotency-Key");
	else if (n == 0)
		head_refuse(head, API_BAD_REQUEST, false, "an Idempotency-Key must be UTF-8");
	else if (characters < 1 || characters > HEAD_KEY_MAX)
		head_refuse(head, API_BAD_REQUEST, false, "an Idempotency-Key must have 1 to %d characters",
		            HEAD_KEY_MAX);
}

/* Whether a Host header names this server: a numeric address, localhost or one of the names, with any port.  This refuses DNS
 * rebinding: a web page whose own host name resolves to this server.
 *
 * Test     unit_http_head: a_host_is_an_address_localhost_or_a_name_that_was_given
 */
bool head_has_host(const char *host, const char *names)
{
	char name[256];
	struct in6_addr address;
	bool v6 = *host == '[';
	size_t n = v6 ? strcspn(host, "]") : strcspn(host, ":");
	const char *port = host + n + (v6 && host[n]);
	if ((v6 && !host[n]) || n == 0 || n >= sizeof name)
		return false;
	if (*port && (*port != ':' || strspn(port + 1, "0123456789") != strlen(port + 1)))
		return false;
	snprintf(name, sizeof name, "%.*s", (int)n - v6, host + v6);
	if (inet_pton(v6 ? AF_INET6 : AF_INET, name, &address) == 1)
		return true;
	if (v6)
		return false;
	if (!strcasecmp(name, "localhost"))
		return true;
	for (const char *at = names; at && *at; at += strcspn(at, ",") + (at[strcspn(at, ",")] == ','))
		if (strcspn(at, ",") == n && !strncasecmp(at, name, n))
			return true;
	return false;
}

/* Whether If-None-Match matches a tag: `*`, or a list of tags, weak ones too (RFC 9110 section 13.1.2).
 *
 * Given    etag   "\"...\"", strong
 * Test     unit_http_head: a_tag_is_found_in_every_form_of_a_list
 */
bool head_has_etag(const char *list, const char *etag)
{
	const char *at = list + strspn(list, " \t");
	if (*at == '*')
		return at[1 + strspn(at + 1, " \t")] == '\0';
	while (*at) {
		at += strspn(at, " \t,");
		if (!strncmp(at, "W/", 2))
			at += 2;
		if (*at != '"')
			return false;
		size_t n = strcspn(at + 1, "\"") + 2;
		if (n > strlen(at))
			return false;
		if (n == strlen(etag) && !strncmp(at, etag, n))
			return true;
		at += n + strspn(at + n, " \t");
		if (*at && *at != ',')
			return false;
	}
	return false;
}

/* Number of bytes before the first character of `ends` outside quotes, or before the end. */
static size_t part(const char *at, const char *ends)
{
	bool quoted = false;
	size_t n = 0;
	for (; at[n] && (quoted || !strchr(ends, at[n])); n++) {
		quoted ^= at[n] == '"';
		n += quoted && at[n] == '\\' && at[n + 1];
	}
	return n;
}

/* Whether Accept lists a media type; weights, other parameters and ranges with a star are ignored.
 *
 * Given    accept   "": no such header
 * Test     unit_http_head: an_accept_names_the_types_in_its_list
 */
bool head_names(const char *accept, const char *type)
{
	for (const char *at = accept; *at; at += part(at, ","), at += *at == ',') {
		at += strspn(at, " \t");
		if (is(at, strcspn(at, " \t;,"), type))
			return true;
	}
	return false;
}

/* The seconds that a client is willing to wait, from its Prefer header (RFC 7240): 0 without a valid wait=N; at most INT_MAX.
 *
 * Test     unit_http_head: the_seconds_to_wait_are_found_among_other_preferences
 */
int head_wait(const char *prefer)
{
	for (const char *at = prefer; *at; at += part(at, ","), at += *at == ',') {
		at += strspn(at, " \t");
		if (strncasecmp(at, "wait", 4) != 0)
			continue;
		const char *value = at + 4 + strspn(at + 4, " \t");
		if (*value++ != '=')
			continue;
		value += strspn(value, " \t\"");
		long seconds = isdigit((unsigned char)*value) ? strtol(value, NULL, 10) : 0;
		return seconds < INT_MAX ? (int)seconds : INT_MAX;
	}
	return 0;
}
