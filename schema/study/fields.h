/* fields.h - the table of all members of a study document; reading, checking, varying and describing use its rows.
 *
 * A row is found by its pattern: the JSON Pointer with * for an index.  Constant; any thread. */
#ifndef FIELDS_H
#define FIELDS_H

#include <stdbool.h>
#include <stddef.h>

#include "engine/pound.h"

/* Types of fields; each has a row in field_types.c. */
enum field_type {
	FIELD_REAL,          /* double */
	FIELD_EACH,          /* struct pound_each: a number, or an array of one for each storey */
	FIELD_COUNT,         /* int */
	FIELD_COUNT_OR_AUTO, /* int; 0: "auto" */
	FIELD_CHOICE,        /* int: row of the table whose names `choice` returns */
	FIELD_ALTERNATIVE,   /* bool: row 0 or 1 of that table */
	FIELD_BOOL,          /* bool */
	FIELD_SEED,          /* uint64_t: a number below 2^53 or its decimal digits as text */
	FIELD_TEXT,          /* const char *; min and max are its length in characters */
	FIELD_OBJECT,        /* its members have their own rows */
	FIELD_LIST,          /* its element has its own row; min and max are the number of elements */
	FIELD_N_TYPES
};

/* How a study without a scene (of an external model) treats a field: as usual, refused, or never required. */
enum field_sceneless { FIELD_ALIKE, FIELD_UNUSED, FIELD_OPTIONAL };

enum field_ends { FIELD_CLOSED, FIELD_OPEN_MIN, FIELD_OPEN_MAX, FIELD_OPEN };

struct field {
	const char *pattern;
	enum field_type type;
	/* in struct pound_study (of the first element), pound_input, pound_sweep, pound_building or pound_row_contact [bytes] */
	size_t offset;
	double absent;        /* value of an absent member; NAN: the member is required */
	double min, max;      /* valid range; an infinite end is never reached */
	enum field_ends ends; /* which ends the range excludes */
	const char *unit;     /* "": none */
	const char *text;     /* description in one line */
	const char *(*choice)(int row);
	const char *kinds;        /* names of the kinds that use it, each between spaces; NULL: all */
	const char *optional;     /* kinds in which a required member is optional, likewise; NULL: none */
	const char *types;        /* names of the excitations that use it, likewise */
	bool (*solvers)(int row); /* whether the solver of that row uses it; NULL: all */
	enum field_sceneless sceneless;
	bool unwritten; /* left out of a study's hash if it has its default: added after hashes had been stored */
	const char *instead; /* the member that may replace it */
	const char *fixed;   /* why it may not vary; NULL: a sweep may vary it, and an input if it is real */
};

extern const struct field fields[];
extern const int fields_count;

const struct field *fields_find(const char *pattern);              /* NULL: none */
const char *fields_name(const struct field *field);                /* last segment of the pattern */
bool fields_child(const struct field *field, const char *pattern); /* whether it is a member of that object */

/* Whether the field's pattern begins with one of n prefixes. */
bool fields_within(const struct field *field, const char *const starts[], size_t n);

/* Whether a list of names, each between spaces, contains a name; a NULL list is empty. */
bool fields_listed(const char *names, const char *name);

/* Whether a study of this kind, excitation and solver uses a field; a NULL name matches any. */
bool fields_used(const struct field *field, const char *kind, const char *excitation, const char *solver);

/* The valid values of a field in words: "a number in [0, 1]", "a whole number of at least 2", "one of "lhs", "random"".
 * The size holds the longest of these texts; the detail of a problem is longer. */
enum { FIELDS_EXPECTED_SIZE = 1792 };
void fields_expected(const struct field *field, char *text, size_t size);
void fields_range(const struct field *field, char *text, size_t size); /* "in [0, 1]", "at least 2" */
void fields_span(const struct field *field, char *text, size_t size); /* range of a length: "2", "1 to 200" */
bool fields_in_range(const struct field *field, double value);

/* The row of the choice with that name, -1 if there is none. */
int fields_choice(const char *(*choice)(int row), const char *name);

/* Indices in a path; -1: the path has no such index. */
struct field_place {
	int element; /* index of the oscillator, building or contact */
	int index;   /* index in a list with one number per storey, or in the levels, from 0 */
};

/* The field that a JSON Pointer into "scene" names, and the indices in the pointer; NULL: none. */
const struct field *fields_scene(const char *path, struct field_place *place);

/* Whether the list at the first * of a pattern may have an element with this index. */
bool fields_may_have(const char *pattern, int index);

/* Whether a sweep may vary a field of the scene or, if `input`, an input. */
bool fields_vary(const struct field *field, bool input);

/* The path nearest to a mistyped path, of a field that may vary, with the indices of that path if there may be such elements; false:
 * none is near, and the path is that of a field beside it, or "". */
bool fields_nearest_path(const char *path, bool input, char *nearest, size_t size);

extern const char
    *const fields_outputs_absent[]; /* names of the outputs of a study that lists none; ends with NULL */

#endif
