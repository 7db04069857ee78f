/* The memory of the machine, or the limit of the control groups of this process. */
#include "server/memory.h"

#include <limits.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { LINE = 512 };

static const double MIB = 1 << 20;

/* The number at the start of the first line that begins with a word (empty: any); INFINITY: none, such as "max". */
static double number_in(const char *path, const char *word)
{
	char line[LINE];
	double number = INFINITY;
	FILE *file = fopen(path, "r");
	while (file && number == INFINITY && fgets(line, sizeof line, file)) {
		char *at = line + strlen(word), *rest = at;
		double value = strncmp(line, word, strlen(word)) == 0 ? strtod(at, &rest) : INFINITY;
		number = rest > at ? value : INFINITY;
	}
	if (file)
		fclose(file);
	return number;
}

/* The least limit of a control group and its ancestors [bytes]. */
static double group_least(const char *root, const char *mount, const char *file, char *group)
{
	double least = INFINITY;
	for (char *end = group + strlen(group); end; end = strrchr(group, '/')) {
		char path[PATH_MAX];
		*end = '\0';
		snprintf(path, sizeof path, "%s%s%s/%s", root, mount, group, file);
		least = fmin(least, number_in(path, ""));
	}
	return least;
}

/* Half of the memory available to this process: of the machine, or of a control group (version 1 or 2) if that is less.
 *
 * Given    root    ""; a folder that replaces / in tests
 * Returns  value   MiB   at least 1
 * Test     unit_server_memory: half_of_the_machine_or_of_the_least_control_group
 */
int memory_share(const char *root)
{
	char path[PATH_MAX], line[LINE];
	snprintf(path, sizeof path, "%s/proc/meminfo", root);
	double bytes = 1024 * number_in(path, "MemTotal:");
	snprintf(path, sizeof path, "%s/proc/self/cgroup", root);
	FILE *groups = fopen(path, "r");
	while (groups && fgets(line, sizeof line, groups)) {
		// number:controllers:path
		char *controllers = strchr(line, ':'), *group = controllers ? strchr(controllers + 1, ':') : NULL;
		line[strcspn(line, "\n")] = '\0';
		if (group && group == controllers + 1)
			bytes = fmin(bytes, group_least(root, "/sys/fs/cgroup", "memory.max", group + 1));
		else if (group && !strncmp(controllers, ":memory:", 8))
			bytes =
			    fmin(bytes, group_least(root, "/sys/fs/cgroup/memory", "memory.limit_in_bytes", group + 1));
	}
	if (groups)
		fclose(groups);
	return (int)fmin(fmax(1, bytes / 2 / MIB), INT_MAX);
}
