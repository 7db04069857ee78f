/* fields.h - every member of a study document: one row each, by which it is read, checked, varied and described.
 *
 * A row is found by its pattern: the JSON Pointer with * for an index.  Constant; any thread. */
#ifndef FIELDS_H
#define FIELDS_H

#include <stdbool.h>
#include <stddef.h>

#include "engine/pound.h"

/* What a field can be: a row each in field_types.c. */
enum field_type {
	FIELD_REAL,          /* double */
	FIELD_EACH,          /* struct pound_each: a number, or an array of one for each storey */
	FIELD_COUNT,         /* int */
	FIELD_COUNT_OR_AUTO, /* int; 0: "auto" */
	FIELD_CHOICE,        /* int: row of the table that `choice` names */
	FIELD_ALTERNATIVE,   /* bool: row 0 or 1 of that table */
	FIELD_BOOL,          /* bool */
	FIELD_SEED,          /* uint64_t: a number below 2^53 or its decimal digits as text */
	FIELD_TEXT,          /* const char *; min and max are its length in characters */
	FIELD_OBJECT,        /* its members are rows of their own */
	FIELD_LIST,          /* its element is a row of its own; min and max are their number */
	FIELD_N_TYPES
};

/* What a field is in a study without a scene, of a model that is run elsewhere. */
enum field_sceneless { FIELD_ALIKE, FIELD_UNUSED, FIELD_OPTIONAL };

enum field_ends { FIELD_CLOSED, FIELD_OPEN_MIN, FIELD_OPEN_MAX, FIELD_OPEN };

struct field {
	const char *pattern;
	enum field_type type;
	/* in struct pound_study (of the first element), pound_input, pound_sweep, pound_building or pound_row_contact [bytes] */
	size_t offset;
	double absent;        /* value of an absent member; NAN: it must be there */
	double min, max;      /* valid range; an infinite end is never reached */
	enum field_ends ends; /* which ends are outside */
	const char *unit;     /* "": none */
	const char *text;     /* one line for people */
	const char *(*choice)(int row);
	const char *kinds; /* names of the kinds that use it, between spaces; NULL: all */
	const char
	    *optional;     /* names of those that can do without it though others cannot, likewise; NULL: none */
	const char *types; /* names of the excitations that use it, likewise */
	bool (*solvers)(int row); /* whether the solver of that row uses it; NULL: all */
	enum field_sceneless sceneless;
	bool
	    unwritten; /* left out of a study's hash with its default value: it came after hashes had been stored */
	const char *instead; /* the member that may be there in its place */
	const char *fixed;   /* why it may not vary; NULL: a sweep may vary it, and an input if it is real */
};

extern const struct field fields[];
extern const int fields_count;

const struct field *fields_find(const char *pattern); /* NULL: none */
const char *fields_name(const struct field *field);   /* last part of the pattern */
bool fields_child(const struct field *field,
                  const char *pattern); /* a member of the object at that pattern */

/* Whether its pattern begins with one of n. */
bool fields_within(const struct field *field, const char *const starts[], size_t n);

/* Whether a name is one of those between spaces; NULL: of none. */
bool fields_listed(const char *names, const char *name);

/* Whether a study of this kind, excitation and solver uses a field; a NULL name is any. */
bool fields_used(const struct field *field, const char *kind, const char *excitation, const char *solver);

/* "a number in [0, 1]", "a whole number of at least 2", "one of "lhs", "random"": what a field takes. */
void fields_expected(const struct field *field, char *text, size_t size);
void fields_range(const struct field *field, char *text, size_t size); /* "in [0, 1]", "at least 2" */
void fields_span(const struct field *field, char *text, size_t size);  /* of a length: "2", "1 to 200" */
bool fields_in_range(const struct field *field, double value);

/* The number of the choice of that name, -1 if there is none. */
int fields_choice(const char *(*choice)(int row), const char *name);

/* Where a path is in the lists on its way; -1: none. */
struct field_place {
	int element; /* of the oscillators, the buildings or the contacts */
	int index;   /* of the numbers of the storeys, or of the levels, from 0 */
};

/* The field that a JSON Pointer into "scene" names, and its place; NULL: none. */
const struct field *fields_scene(const char *path, struct field_place *place);

/* The field of the scene nearest to a mistyped path, as a path; false: none is near. */
bool fields_nearest_path(const char *path, char *nearest, size_t size);

extern const char
    *const fields_outputs_absent[]; /* names of the outputs of a study that asks for none; up to NULL */

#endif
