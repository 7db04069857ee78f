/* groups_sentence.c - the indices of the groups of inputs of a sensitivity result, in one sentence.
 *
 *   S1/ST of the groups soil, contact; impulse: 0.41/0.95, 0.06/0.09; 2 more outputs: --table groups */
#include "client/groups_sentence.h"

#include "client/command.h"
#include "client/table.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { PATH_SIZE = 64, LINES_MOST = 4 };

/* An output of a cell that has groups; the next one after `cell` and `output`. */
struct at {
	int cell, output;
	char path[PATH_SIZE];
};

/* The next output with groups; false: none. */
static bool next_output(const struct reading *result, struct at *at)
{
	for (at->output++; at->cell < reading_count(result, "/cells"); at->cell++, at->output = 0)
		for (; at->output < reading_count(result, "/cells/%d/outputs", at->cell); at->output++) {
			snprintf(at->path, sizeof at->path, "/cells/%d/outputs/%d", at->cell, at->output);
			if (reading_count(result, "%s/groups", at->path) > 0)
				return true;
		}
	return false;
}

static const char *name_at(const struct reading *result, const struct at *at)
{
	const char *name = reading_text(result, "%s/name", at->path);
	return name ? name : "?";
}

/* Whether an output of this name comes before, in another cell or at another place. */
static bool is_repeated(const struct reading *result, const struct at *of)
{
	struct at at = {.output = -1};
	while (next_output(result, &at) && (at.cell != of->cell || at.output != of->output))
		if (strcmp(name_at(result, &at), name_at(result, of)) == 0)
			return true;
	return false;
}

/* Appends an index of a group from the lowest to the highest over all outputs of the name. */
static char *index_append(char *line, const struct reading *result, const struct at *of, int group,
                          const char *index)
{
	struct at at = *of;
	double low = NAN, high = NAN;
	char lowest[24], highest[24];
	do {
		const double value = reading_number(result, "%s/groups/%d/%s", at.path, group, index);
		if (strcmp(name_at(result, &at), name_at(result, of)) != 0)
			continue;
		low = fmin(low, value);
		high = fmax(high, value);
	} while (next_output(result, &at));
	if (!isfinite(low))
		return command_append(line, "-");
	table_round(lowest, sizeof lowest, "%.2f", low);
	table_round(highest, sizeof highest, "%.2f", high);
	return strcmp(lowest, highest) == 0 ? command_append(line, "%s", lowest)
	                                    : command_append(line, "%s..%s", lowest, highest);
}

/* The sentence with at most `most` outputs; `all` is how many there are. */
static char *sentence_with(const struct reading *result, const char *over, int most, int *all)
{
	struct at at = {.output = -1};
	char *line = NULL;
	*all = 0;
	while (next_output(result, &at)) {
		const int groups = reading_count(result, "%s/groups", at.path);
		for (int g = 0; g < groups && !line; g++) {
			line = command_text("S1/ST of the groups");
			for (int name = 0; name < groups; name++)
				line = command_append(line, "%s %s", name ? "," : "",
				                      reading_text(result, "%s/groups/%d/name", at.path, name));
			line = command_append(line, "%s%s", *over ? ", lowest to highest over " : "", over);
		}
		if (is_repeated(result, &at) || ++*all > most)
			continue;
		line = command_append(line, "; %s:", name_at(result, &at));
		for (int g = 0; g < groups; g++) {
			line = index_append(command_append(line, g ? ", " : " "), result, &at, g, "S1");
			line = index_append(command_append(line, "/"), result, &at, g, "ST");
		}
	}
	if (line && most == 0) {
		free(line);
		return command_text("S1/ST of the groups: --table groups");
	}
	if (*all > most)
		line = command_append(line, "; %d more output%s: --table groups", *all - most,
		                      *all - most == 1 ? "" : "s");
	return line;
}

/* Test     client_tables: groups_are_in_the_summary_over_cells_and_places */
char *groups_sentence(const struct reading *result, const char *over)
{
	int all, most = 3;
	char *line = sentence_with(result, over, most, &all);
	while (line && most > 0 && table_prose_lines(0, line) > LINES_MOST) {
		free(line);
		line = sentence_with(result, over, --most, &all);
	}
	return line;
}
