/* problems_sort.c - puts problems in the order of the document. */
#include <cjson/cJSON.h>
#include <limits.h>
#include <stdlib.h>
#include <string.h>

#include "schema/json/json_pointer.h"
#include "schema/json/problems.h"

/* The member of an object, and its position; NULL and INT_MAX if it is absent. */
static const cJSON *member(const cJSON *object, const char *name, int *position)
{
	int i = 0;
	const cJSON *at = cJSON_IsObject(object) ? object->child : NULL;
	for (; at && strcmp(at->string, name) != 0; at = at->next)
		i++;
	*position = at ? i : INT_MAX;
	return at;
}

/* Less than 0: the first pointer comes before the second in the document, and a value before its members. */
static int compare(const cJSON *document, const char *a, const char *b)
{
	char name_a[sizeof((struct problem *)0)->pointer], name_b[sizeof name_a];
	const cJSON *at = document;
	while (*a && *b) {
		a = json_pointer_token(a, name_a);
		b = json_pointer_token(b, name_b);
		const bool list = cJSON_IsArray(at);
		int in_a = list ? atoi(name_a) : 0, in_b = list ? atoi(name_b) : 0;
		if (strcmp(name_a, name_b) != 0) {
			if (!list) {
				member(at, name_a, &in_a);
				member(at, name_b, &in_b);
			}
			return (in_a > in_b) - (in_a < in_b);
		}
		if (*a && *b) // a list of samples is long
			at = list ? cJSON_GetArrayItem(at, in_a) : member(at, name_a, &in_a);
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
