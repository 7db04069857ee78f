/* near_path.c - the path of a field of the scene that was probably meant by a mistyped path. */
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "schema/study/fields.h"
#include "schema/study/near_name.h"

/* The indices in a path that may be invalid; -1: the path has no such index. */
static void indices_of(const char *path, int indices[2])
{
	int n = 0;
	indices[0] = indices[1] = -1;
	for (const char *part = path; (part = strchr(part, '/')) && n < 2; part++) {
		const size_t digits = strspn(part + 1, "0123456789");
		if (digits > 0 && digits <= 3 && strchr("/", part[1 + digits]))
			indices[n++] = atoi(part + 1);
	}
}

/* The path of a field with these indices. */
static void path_of(const struct field *field, const int indices[2], char *path, size_t size)
{
	size_t length = 0;
	for (const char *at = field->pattern + strlen("/scene"); *at && length + 1 < size; at++)
		if (*at == '*')
			length += (size_t)snprintf(path + length, size - length, "%d", *indices++);
		else
			path[length++] = *at;
	path[length < size ? length : size - 1] = 0;
}

/* Whether two paths name members of one object. */
static bool beside(const char *a, const char *b)
{
	const char *last = strrchr(b, '/');
	const size_t n = last ? (size_t)(last - b) + 1 : 0;
	return n > 1 && strncmp(a, b, n) == 0 && !strchr(a + n, '/');
}

/* The path that was probably meant by a path that names no field.
 *
 * Test     unit_study_cases
 */
bool fields_nearest_path(const char *path, bool input, char *nearest, size_t size)
{
	int best = INT32_MAX - 1, own[2];
	// an index above 1 may count from 1: prefer the second element
	const bool beyond = path[strcspn(path, "23456789")];
	char sibling[128] = "";
	if (strncmp(path, "/scene/", 7) == 0) // a common mistake: paths already start in the scene
		path += strlen("/scene");
	indices_of(path, own);
	for (int i = 0; i < fields_count; i++) {
		if (strncmp(fields[i].pattern, "/scene/", 7) != 0 || !fields_vary(&fields[i], input))
			continue;
		const bool same = fields_may_have(fields[i].pattern, own[0]);
		for (int bits = 0; bits < (strchr(fields[i].pattern, '*') ? 4 : 1); bits++) {
			char candidate[128];
			const int indices[2] = {same ? own[0] : bits & 1,
			                        own[1] == 0 || own[1] == 1 ? own[1] : bits >> 1};
			path_of(&fields[i], indices, candidate, sizeof candidate);
			const int distance = near_name_distance(path, candidate);
			if (distance < best + (beyond && !same && bits > 0)) {
				best = distance;
				snprintf(nearest, size, "%s", candidate);
			}
			if (!*sibling && !fields[i].types && beside(candidate, path))
				memcpy(sibling, candidate, sizeof sibling);
		}
	}
	if (!near_name(best, path))
		snprintf(nearest, size, "%s", sibling);
	return near_name(best, path);
}
