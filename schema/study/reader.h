/* reader.h - the state of reading a study document.  For study_json.c and study_varied.c. */
#ifndef READER_H
#define READER_H

#include <cjson/cJSON.h>

#include "engine/pound.h"
#include "schema/json/problems.h"
#include "schema/study/fields.h"

struct reader {
	struct problems *problems;
	struct pound_study *study;
	const char *kind, *excitation, *solver; /* names; NULL: not known */
	const cJSON *sweeps;                    /* array in the document; NULL: none */
	double *number;                         /* next free element for samples and sweep values */
	char *text;                             /* next free byte for strings */
	const struct study_files *files;        /* reads files of ground motions; NULL: files cannot be read */
	struct suite_source *suite;             /* sources of the records, in the study's block  (suite_room) */
	bool designed;                          /* only the design of the document is read */
	int storeys;                            /* of the current building; 0: not known */
	const struct field *swept; /* by the current sweep; NULL: its path names no field that may vary */
	char pointer[512];         /* JSON Pointer of the current member */
};

/* Move into a member or an element and back: reader_leave takes the value that the enter function returned. */
size_t reader_enter(struct reader *reader, const char *name);
size_t reader_enter_element(struct reader *reader, int i);
void reader_leave(struct reader *reader, size_t length);

/* Add the problem that something else was expected here. */
void reader_mistyped(struct reader *reader, const char *expected, const cJSON *node);
void reader_mistyped_field(struct reader *reader, const struct field *field, const cJSON *node);
void reader_misspelt(struct reader *reader, const char *expected, const cJSON *node, const char *nearest);

/* Reads a string; other values: field_types.c. */
void reader_text(struct reader *reader, const struct field *field, const cJSON *node, const char **at);

/* Lists.  Number of elements to read: 0 if it is no list or too long; adds a problem for a wrong number of elements. */
int reader_elements(struct reader *reader, const struct field *field, const cJSON *node);
/* Reads each element with a function; returns their number. */
int reader_each(struct reader *reader, const struct field *field, const cJSON *node,
                void (*read)(struct reader *reader, const cJSON *element, int i));
/* Reads numbers by the row `element` into the study's own memory, NAN if one is invalid; returns their number. */
int reader_numbers(struct reader *reader, const struct field *field, const struct field *element,
                   const cJSON *node, const double **numbers);
/* Adds a problem for every number that repeats an earlier one; `what` names the numbers, such as "frequency". */
void reader_distinct(struct reader *reader, const double *numbers, int n, const char *what);

/* Objects: study_json.c. */
bool reader_seen(const cJSON *object, const cJSON *member); /* an earlier member has the same name */
void reader_require(struct reader *reader, const cJSON *node, const char *pattern);
bool reader_object(struct reader *reader, const char *pattern, const cJSON *node, char *base);
void reader_value(struct reader *reader, const struct field *field, const cJSON *node, char *base);
/* Fills an element of a list with the defaults of its members. */
void reader_defaults(const char *pattern, char *base);

/* Refuses the other members of a rigid wall; false: the body is no rigid wall. */
bool reader_wall(struct reader *reader, const char *pattern, const cJSON *node, const char *refused);

/* Rows of buildings: study_buildings.c. */
void reader_buildings(struct reader *reader, const struct field *field, const cJSON *node, char *base);
void reader_building_law(struct reader *reader, const struct field *field, const cJSON *node, char *base);
void reader_modes(struct reader *reader, const struct field *field, const cJSON *node, char *base);
void reader_contacts(struct reader *reader, const cJSON *document);
void reader_levels(struct reader *reader, const struct field *field, const cJSON *node, char *base);
void reader_places(struct reader *reader, const struct field *field, const cJSON *node, char *base);

/* What varies: study_varied.c. */
void reader_distribution(struct reader *reader, const struct field *field, const cJSON *node, char *base);
void reader_inputs(struct reader *reader, const struct field *field, const cJSON *node, char *base);
void reader_groups(struct reader *reader, const struct field *field, const cJSON *node, char *base);
void reader_group(struct reader *reader, const struct field *field, const cJSON *node, char *base);
void reader_groups_find(struct pound_study *study);
void reader_ratios(struct reader *reader, const struct field *field, const cJSON *node, char *base);
void reader_ratio(struct reader *reader, const struct field *field, const cJSON *node, char *base);
void reader_sweeps(struct reader *reader, const struct field *field, const cJSON *node, char *base);
void reader_values(struct reader *reader, const struct field *field, const cJSON *node, char *base);

/* Floor spectra: study_spectrum.c. */
void reader_frequencies(struct reader *reader, const struct field *field, const cJSON *node, char *base);
void reader_ordinates(struct reader *reader, const cJSON *document);

/* Members of a contact that its models do not read: study_contact.c. */
void reader_contact(struct reader *reader, const cJSON *node, int model);

/* Suites of recorded ground motions: study_suite.c. */
void reader_records(struct reader *reader, const struct field *field, const cJSON *node, char *base);
void reader_samples(struct reader *reader, const struct field *field, const cJSON *node, char *base);
void reader_scale(struct reader *reader, const struct field *field, const cJSON *node, char *base);

/* Settings of solvers: study_settings.c. */
void settings_default(struct pound_study *study);
void reader_settings(struct reader *reader, const struct field *field, const cJSON *node, char *base);

#endif
