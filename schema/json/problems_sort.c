/* problems_sort.c - puts problems in the order of the document. */
#include <cjson/cJSON.h>
#include <limits.h>
#include <stdlib.h>
#include <string.h>

#include "schema/json/problems.h"

/* Whether a segment of a JSON Pointer, with ~0 for ~ and ~1 for /, is a name. */
static bool is_name(const char *segment, size_t length, const char *name)
{
	const char *end = segment + length;
	for (; segment < end && *name; segment++, name++) {
		const bool escaped = *segment == '~' && segment + 1 < end;
		const char meant = escaped ? (*++segment == '0' ? '~' : '/') : *segment;
		if (meant != *name)
			return false;
	}
	return segment == end && !*name;
}

/* The member of an object, and its position; NULL and INT_MAX: there is none, such as a required member. */
static const cJSON *member(const cJSON *object, const char *segment, size_t length, int *position)
{
	int i = 0;
	const cJSON *at = cJSON_IsObject(object) ? object->child : NULL;
	for (; at && !is_name(segment, length, at->string); at = at->next)
		i++;
	*position = at ? i : INT_MAX;
	return at;
}

/* Less than 0: the first pointer comes before the second in the document, and a value before its members. */
static int compare(const cJSON *document, const char *a, const char *b)
{
	const cJSON *at = document;
	while (*a && *b) {
		const size_t n_a = strcspn(++a, "/"), n_b = strcspn(++b, "/");
		const bool list = cJSON_IsArray(at), same = n_a == n_b && strncmp(a, b, n_a) == 0;
		int in_a = list ? atoi(a) : 0, in_b = list ? atoi(b) : 0;
		if (!list && !same) {
			member(at, a, n_a, &in_a);
			member(at, b, n_b, &in_b);
		}
		if (!same)
			return (in_a > in_b) - (in_a < in_b);
		a += n_a;
		b += n_b;
		if (*a && *b) // a list of samples is long
			at = list ? cJSON_GetArrayItem(at, in_a) : member(at, a - n_a, n_a, &in_a);
	}
	return (*a != 0) - (*b != 0);
}

/* Sorts problems by their places in a document; problems of one place, and of absent members of one object, keep their order.
 *
 * Test     unit_study_cases
 */
void problems_sort(struct problems *problems, const struct cJSON *document)
{
	for (int i = 1; i < problems->n; i++) {
		struct problem *const list = problems->list;
		const struct problem moved = list[i];
		int to = i;
		while (to > 0 && compare(document, list[to - 1].pointer, moved.pointer) > 0)
			to--;
		memmove(&list[to + 1], &list[to], (size_t)(i - to) * sizeof *list);
		list[to] = moved;
	}
}
