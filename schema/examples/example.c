/* example.c - the study documents of schema/examples, built into the programs. */
#include <stddef.h>
#include <string.h>

#include "schema/examples/examples.h"

const char *example_name(int i)
{
	return examples[i].name;
}

const char *example_title(int i)
{
	return examples[i].title;
}

const char *example_text(const char *name)
{
	for (int i = 0; examples[i].name; i++)
		if (strcmp(examples[i].name, name) == 0)
			return examples[i].text;
	return NULL;
}
