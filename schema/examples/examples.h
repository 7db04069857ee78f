/* examples.h - the study documents of schema/examples, built into the programs. */
#ifndef EXAMPLES_H
#define EXAMPLES_H

struct example {
	const char *name;  /* file name without .json */
	const char *title; /* the document's "name" */
	const char *text;  /* the document */
};

extern const struct example examples[]; /* by name; ends with a row of NULLs; made by the Makefile */

const char *example_name(int i);            /* NULL after the last */
const char *example_title(int i);           /* description in one line; NULL after the last */
const char *example_text(const char *name); /* NULL: no such example */

#endif
