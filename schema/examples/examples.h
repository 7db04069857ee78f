/* examples.h - the study documents of schema/examples, built into the programs. */
#ifndef EXAMPLES_H
#define EXAMPLES_H

struct example {
	const char *name;  /* of the file, without .json */
	const char *title; /* the document's "name" */
	const char *text;  /* the document */
};

extern const struct example examples[]; /* by name; ends with a row of NULLs; made by the Makefile */

const char *example_name(int i);            /* NULL past the last */
const char *example_title(int i);           /* one line about it; NULL past the last */
const char *example_text(const char *name); /* NULL: no such example */

#endif
