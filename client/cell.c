/* cell.c - the sweep values and the failed runs of a cell. */
#include "client/cell.h"

#include "client/table.h"

#include <stdio.h>

/* A member's name as written in a JSON Pointer: ~ is ~0, / is ~1. */
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
	for (int i = 0; (path = reading_member(result, i, "/cells/%d/sweep", cell)); i++) {
		fputs(i ? ", " : "\n", stdout);
		table_say(path);
		char token[400];
		pointer_token(token, sizeof token, path);
		const char *text = reading_text(result, "/cells/%d/sweep/%s", cell, token);
		fputs(" = ", stdout);
		if (text)
			table_say(text);
		else if (reading_type(result, "/cells/%d/sweep/%s", cell, token) == 'b')
			fputs(reading_true(result, "/cells/%d/sweep/%s", cell, token) ? "true" : "false", stdout);
		else
			printf("%.10g", reading_number(result, "/cells/%d/sweep/%s", cell, token));
	}
	if (reading_count(result, "/cells/%d/sweep", cell))
		putchar('\n');
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
