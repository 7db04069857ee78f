/* cell.c - the sweep values and the failed runs of a cell. */
#include "client/cell.h"

#include "client/command.h"
#include "client/table.h"
#include "schema/result/output_label.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>

/* Escapes a member name for a JSON Pointer (RFC 6901): ~ becomes ~0, / becomes ~1. */
static void pointer_token(char *token, size_t size, const char *name)
{
	size_t n = 0;
	for (; *name && n + 2 < size; name++) {
		if (*name == '/' || *name == '~')
			token[n++] = '~';
		token[n++] = *name == '/' ? '1' : *name == '~' ? '0' : *name;
	}
	token[n] = '\0';
}

void cell_sweep(const struct reading *result, int cell)
{
	const char *path;
	char *line = command_text("%s", "");
	for (int i = 0; (path = reading_member(result, i, "/cells/%d/sweep", cell)); i++) {
		char token[400], number[32];
		pointer_token(token, sizeof token, path);
		const char *text = reading_text(result, "/cells/%d/sweep/%s", cell, token);
		if (!text && reading_type(result, "/cells/%d/sweep/%s", cell, token) == 'b')
			text = reading_true(result, "/cells/%d/sweep/%s", cell, token) ? "true" : "false";
		snprintf(number, sizeof number, "%.10g", reading_number(result, "/cells/%d/sweep/%s", cell, token));
		line = command_append(line, "%s%s = %s", i ? ", " : "", path, text ? text : number);
	}
	if (*line) {
		putchar('\n');
		table_prose(0, line);
	}
	free(line);
}

void cell_failed(const struct reading *result, const char *at)
{
	double failed = reading_number(result, "%s/runs_failed", at);
	double dropped = reading_number(result, "%s/rows_dropped", at);
	if (failed > 0.0)
		printf("\n%.0f of %.0f runs failed", failed, reading_number(result, "%s/runs", at));
	if (failed > 0.0 && dropped > 0.0)
		printf("; %.0f rows of the design are left out", dropped);
	if (failed > 0.0)
		putchar('\n');
}

char *cell_output(const struct reading *result, const char *at, const struct measure measures[])
{
	char label[OUTPUT_LABEL], more[80];
	const double mean = reading_number(result, "%s/mean", at);
	char *text = command_text("%s", output_label(result, at, label));
	if (isfinite(mean))
		text = command_append(text, ": mean %.4g", mean);
	for (; measures->member; measures++) {
		const double value = reading_number(result, "%s/%s", at, measures->member);
		if (!isfinite(value))
			continue;
		snprintf(more, sizeof more, measures->format, measures->times * value);
		text = command_append(text, "%s", more);
	}
	return text;
}
