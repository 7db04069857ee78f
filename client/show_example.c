/* show_example.c - the study documents that are built in. */
#include "client/command.h"
#include "schema/examples/examples.h"

#include <stdio.h>
#include <string.h>

static const char EXAMPLE_DEFAULT[] = "paper";

/* `pound example [NAME]` */
enum outcome example_print(const struct options *options)
{
	const char *name = options->argument ? options->argument : EXAMPLE_DEFAULT;
	if (options->names) {
		for (int i = 0; example_name(i); i++)
			printf("%s\n", example_name(i));
		return OUTCOME_OK;
	}
	const char *text = example_text(name);
	if (text) {
		fputs(text, stdout);
		return OUTCOME_OK;
	}
	command_complain("no example '%s'; there are:", name);
	for (int i = 0; example_name(i); i++)
		command_complain("  %-24s %s", example_name(i), example_title(i));
	return OUTCOME_USAGE;
}
