/* print_figure.c - a figure of a result as SVG: drawn here from a file, or fetched from the server. */
#include "client/answer.h"
#include "client/document.h"
#include "schema/figure/figure.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static enum outcome names_print(void)
{
	for (const struct figure_row *row = figure_rows; row->name; row++)
		printf("%-10s %-15s %s\n", row->name, row->kind, row->text);
	return OUTCOME_OK;
}

static enum outcome figure_print(enum figure_status status, const struct figure *figure)
{
	if (status == FIGURE_DRAWN) {
		fwrite(figure->svg, 1, figure->length, stdout);
		return OUTCOME_OK;
	}
	command_complain("%s", figure->detail);
	return status == FIGURE_UNKNOWN || status == FIGURE_CHOICE ? OUTCOME_USAGE : OUTCOME_FAILED;
}

static enum outcome plot_file(const struct options *options)
{
	size_t n;
	char *text = document_read(options->second, &n);
	if (!text)
		return OUTCOME_FAILED;
	// samples are CSV; a result is an object
	bool samples = text[strspn(text, " \t\r\n")] != '{';
	struct figure_source source = {.json = samples ? "{}" : text,
	                               .length = samples ? 2 : n,
	                               .samples = samples ? text : NULL,
	                               .n_samples = samples ? n : 0};
	struct figure figure;
	enum outcome outcome =
	    figure_print(figure_draw(options->argument, &source, &options->choice, &figure), &figure);
	free(figure.svg);
	free(text);
	return outcome;
}

/* The options of the figure as a URL query; the caller frees it. */
static char *query_of(struct wire *wire, const struct options *options)
{
	char *query = command_text("?partial=%s", options->partial ? "true" : "false");
	const struct {
		const char *name, *value;
	} chosen[] = {
#define X(name, values, lowest, highest, text) {#name, options->choice.name},
	    FIGURE_ARGUMENTS(X)
#undef X
	};
	for (size_t k = 0; k < sizeof chosen / sizeof chosen[0]; k++) {
		if (!chosen[k].value)
			continue;
		char *value = wire_escape(wire, chosen[k].value);
		char *longer = command_text("%s&%s=%s", query, chosen[k].name, value);
		free(value);
		free(query);
		query = longer;
	}
	return query;
}

static enum outcome plot_fetched(const struct options *options)
{
	struct wire *wire = wire_open(options->url);
	struct wire_reply reply;
	char *query = query_of(wire, options), *name = wire_escape(wire, options->argument);
	char *rest = command_text("/figures/%s%s", name, query);
	enum outcome outcome =
	    answer_about(wire, (struct wire_request){.method = "GET", .accept = "image/svg+xml", .made = true},
	                 options->second, rest, &reply);
	if (outcome == OUTCOME_OK)
		fwrite(reply.body, 1, reply.n_body, stdout);
	wire_reply_free(&reply);
	free(rest);
	free(name);
	free(query);
	wire_close(wire);
	return outcome;
}

/* `pound plot FIGURE RESULT|ID` prints SVG; `pound plot --names`.
 *
 * Returns  value   OUTCOME_USAGE: no such figure, or an option that the figure does not accept
 * Test     client_figure: a_figure_of_a_file_has_the_bytes_of_the_server
 */
enum outcome plot_figure(const struct options *options)
{
	if (options->names)
		return names_print();
	return command_is_id(options->second) ? plot_fetched(options) : plot_file(options);
}
