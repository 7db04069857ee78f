/* fuzz_figure.c - any bytes as a result and any text as choices: a figure is drawn as XML of bounded size, or refused with a
 * sentence.  The first line is the figure and its choices, each name=value; the rest is the result.  libFuzzer: make fuzz. */
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "schema/figure/figure.h"
#include "schema/figure/report.h"

int LLVMFuzzerTestOneInput(const uint8_t *bytes, size_t length);

static void choose(struct figure_choice *choice, char *word)
{
	char *value = strchr(word, '=');
	if (!value)
		return;
	*value++ = '\0';
#define X(name, values, lowest, highest, text) \
	if (!strcmp(word, #name))                  \
		choice->name = value;
	FIGURE_ARGUMENTS(X)
#undef X
}

/* No element is closed that was not opened, and none left open. */
static int balanced(const char *svg)
{
	int depth = 0;
	for (const char *c = svg; (c = strchr(c, '<')); c++) {
		const char *end = strchr(c, '>');
		if (!end)
			return 0;
		depth += c[1] == '/' ? -1 : end[-1] != '/';
		if (depth < 0)
			return 0;
	}
	return depth == 0;
}

int LLVMFuzzerTestOneInput(const uint8_t *bytes, size_t length)
{
	char *text = malloc(length + 1), *rest, name[32];
	memcpy(text, bytes, length);
	text[length] = '\0';
	size_t line = strcspn(text, "\n");
	struct figure_source source = {.json = text + line, .length = length - line};
	struct figure_choice choice = {0};
	struct figure figure;
	if (text[line] == '\n')
		text[line] = '\0', source.json++, source.length--;
	char *word = strtok_r(text, " ", &rest);
	snprintf(name, sizeof name, "%.30s", word ? word : "indices");
	while ((word = strtok_r(NULL, " ", &rest)))
		choose(&choice, word);
	const struct figure_source result = source;
	for (int sampled = 0; sampled < 2; sampled++) {
		if (sampled)
			source = (struct figure_source){"{}", 2, source.json, source.length};
		enum figure_status status = figure_draw(name, &source, &choice, &figure);
		if (status == FIGURE_DRAWN ? strlen(figure.svg) != figure.length || !balanced(figure.svg)
		                           : figure.svg != NULL || (!*figure.detail && status != FIGURE_NOMEM))
			abort();
		free(figure.svg);
	}
	size_t n;
	free(report_html(&result, NULL, 0, &n));
	free(text);
	return 0;
}
