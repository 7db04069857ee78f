/* problems.c - the list of all problems of a request, and the response body with it (RFC 9457). */
#include "schema/json/problems.h"

#include <stdarg.h>
#include <stdio.h>
#include <string.h>

#include "schema/json/json_writer.h"

void problems_init(struct problems *problems)
{
	problems->status = PROBLEMS_NONE;
	problems->line = problems->column = 0;
	problems->n = problems->n_more = 0;
}

/* Ends a truncated text with "...", not inside a UTF-8 character. */
static void mend(char *text, size_t size, int wanted)
{
	if (wanted < (int)size)
		return;
	size_t end = size - 4;
	while (end > 0 && ((unsigned char)text[end] & 0xC0) == 0x80)
		end--;
	memcpy(text + end, "...", 4);
}

static void add(struct problems *problems, const char *pointer, double requested, double limit,
                const char *format, va_list arguments)
{
	problems->status = PROBLEMS_INVALID;
	if (problems->n == PROBLEMS_MAX) {
		problems->n_more++;
		return;
	}
	struct problem *problem = &problems->list[problems->n++];
	problem->requested = requested;
	problem->limit = limit;
	mend(problem->pointer, sizeof problem->pointer,
	     snprintf(problem->pointer, sizeof problem->pointer, "%s", pointer));
	mend(problem->detail, sizeof problem->detail,
	     vsnprintf(problem->detail, sizeof problem->detail, format, arguments));
}

/* Adds one problem of an invalid study; above PROBLEMS_MAX problems are only counted.
 *
 * Given    pointer   -         -       JSON Pointer, truncated if too long
 *          format    -         -       printf format of the sentence
 *
 * Test     unit_problems: a_full_list_counts_what_it_cannot_hold
 */
void problems_add(struct problems *problems, const char *pointer, const char *format, ...)
{
	va_list arguments;
	va_start(arguments, format);
	add(problems, pointer, 0, 0, format, arguments);
	va_end(arguments);
}

/* Adds the problem that a limit is exceeded.
 *
 * Given    requested, limit   in the unit of the sentence;  limit > 0
 *
 * Test     unit_study_check: what_is_too_large_is_reported_with_its_limit
 */
void problems_exceed(struct problems *problems, const char *pointer, double requested, double limit,
                     const char *format, ...)
{
	va_list arguments;
	va_start(arguments, format);
	add(problems, pointer, requested, limit, format, arguments);
	va_end(arguments);
}

/* Whether a member or a value inside it has a problem, so that checks that depend on it can be skipped.
 *
 * Test     unit_problems: a_problem_is_at_its_pointer_and_all_above_it
 */
bool problems_at(const struct problems *problems, const char *pointer)
{
	size_t length = strlen(pointer);
	for (int i = 0; i < problems->n; i++) {
		const char *at = problems->list[i].pointer;
		if (strncmp(at, pointer, length) == 0 && (at[length] == '/' || at[length] == 0))
			return true;
	}
	return problems->n_more > 0;
}

/* Whether a member, or a value that contains it, has a problem as a whole; problems of values inside it do not count.
 *
 * Test     unit_problems: a_problem_is_over_all_that_is_in_it
 */
bool problems_over(const struct problems *problems, const char *pointer)
{
	for (int i = 0; i < problems->n; i++) {
		const char *at = problems->list[i].pointer;
		size_t length = strlen(at);
		if (strncmp(at, pointer, length) == 0 && (pointer[length] == '/' || pointer[length] == 0))
			return true;
	}
	return problems->n_more > 0;
}

/* The body of an error response.
 *
 * Given    head      -         -       status, type, title and detail
 *          problems  -         -       the list becomes `errors`, a position `line` and `column`; NULL: neither
 * Returns  value     (length)  -       JSON; NULL: out of memory
 * Memory   allocates; the caller frees
 *
 * Source   RFC 9457 section 3
 * Test     unit_problems: a_body_lists_every_problem
 */
char *problem_to_json(const struct problem_head *head, const struct problems *problems, size_t *length)
{
	struct writer w;
	writer_init(&w);
	writer_object(&w, NULL, WRITER_LINES);
	writer_text(&w, "type", head->type ? head->type : "about:blank");
	writer_text(&w, "title", head->title);
	writer_whole(&w, "status", head->status);
	writer_text(&w, "detail", head->detail);
	if (problems && problems->status == PROBLEMS_MALFORMED) {
		writer_whole(&w, "line", problems->line);
		writer_whole(&w, "column", problems->column);
	}
	if (problems && problems->n > 0) {
		writer_array(&w, "errors", WRITER_LINES);
		for (int i = 0; i < problems->n; i++) {
			writer_object(&w, NULL, WRITER_LINE);
			writer_text(&w, "pointer", problems->list[i].pointer);
			writer_text(&w, "detail", problems->list[i].detail);
			if (problems->list[i].limit > 0) {
				writer_number(&w, "requested", problems->list[i].requested);
				writer_number(&w, "limit", problems->list[i].limit);
			}
			writer_end(&w);
		}
		writer_end(&w);
		if (problems->n_more)
			writer_whole(&w, "errors_not_listed", problems->n_more);
	}
	writer_end(&w);
	return writer_take(&w, length);
}
