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
	const cJSON *sweeps;                    /* of the document; NULL: none */
	double *number;                         /* next free place for a sample or a sweep value */
	char *text;                             /* next free place for a text */
	const struct study_files *files;        /* of recorded ground motions; NULL: cannot be read */
	struct suite_source *suite;             /* of the records, in the study's block  (suite_room) */
	bool designed;                          /* the document is read for its design alone */
	int storeys;                            /* of the current building; 0: not known */
	const struct field *swept; /* by the current sweep; NULL: its path names no field that varies */
	char pointer[512];         /* of the current member */
};

/* Into a member or an element and out again: enter gives what leave takes. */
size_t reader_enter(struct reader *reader, const char *name);
size_t reader_enter_element(struct reader *reader, int i);
void reader_leave(struct reader *reader, size_t length);

/* Notes that something else was expected here. */
void reader_mistyped(struct reader *reader, const char *expected, const cJSON *node);
void reader_mistyped_field(struct reader *reader, const struct field *field, const cJSON *node);
void reader_misspelt(struct reader *reader, const char *expected, const cJSON *node, const char *nearest);

/* A text; other values: field_types.c. */
void reader_text(struct reader *reader, const struct field *field, const cJSON *node, const char **at);

/* Lists.  The elements to read: 0 when it is no list or too long; any wrong number is noted. */
int reader_elements(struct reader *reader, const struct field *field, const cJSON *node);
/* Reads each of them by a function; their number. */
int reader_each(struct reader *reader, const struct field *field, const cJSON *node,
                void (*read)(struct reader *reader, const cJSON *element, int i));
/* Reads numbers, each as `element` says, into the study's own memory, NAN for one that is wrong; their number. */
int reader_numbers(struct reader *reader, const struct field *field, const struct field *element,
                   const cJSON *node, const double **numbers);
/* Reports every number that occurs before, too, as that of a `what`. */
void reader_distinct(struct reader *reader, const double *numbers, int n, const char *what);

/* Objects: study_json.c. */
bool reader_seen(const cJSON *object, const cJSON *member); /* an earlier member has its name */
void reader_require(struct reader *reader, const cJSON *node, const char *pattern);
bool reader_object(struct reader *reader, const char *pattern, const cJSON *node, char *base);
void reader_value(struct reader *reader, const struct field *field, const cJSON *node, char *base);
/* Fills an element of a list with what its absent members mean. */
void reader_defaults(const char *pattern, char *base);

/* Members of what is a rigid wall, each refused; false: it is none. */
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
