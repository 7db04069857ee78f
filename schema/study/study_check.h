/* study_check.h - checks between the members of a study. */
#ifndef STUDY_CHECK_H
#define STUDY_CHECK_H

#include "engine/pound.h"
#include "schema/json/problems.h"
#include "schema/study/fields.h"

/* Adds problems between members that are each valid. */
void study_check(struct pound_study *study, struct problems *problems);

bool study_check_applies(const struct pound_study *study, int output); /* in at least one cell */

/* Whether a study's responses are computed by a solver. */
bool study_check_solves(const struct pound_study *study, int solver);

/* The interval of a real field of the scene, over all samples and cells. */
void study_check_reach(const struct pound_study *study, const char *path, double *low, double *high);

/* Whether that interval is known in spite of the problems found; the same for the length of the ground motion. */
bool study_check_known(const struct pound_study *study, const char *path, const struct problems *problems);
bool study_check_steps_known(const struct pound_study *study, const struct problems *problems);

/* Adds values that the contact models cannot use: study_contact.c. */
void study_contact_check(const struct pound_study *study, struct problems *problems);
/* Why varying a member of the contact would change nothing; NULL: it may vary. */
const char *study_contact_idle(const struct pound_study *study, const char *member);

/* Whether the study's excitation uses a field. */
bool study_check_uses(const struct pound_study *study, const char *pattern);

/* The field of the scene that a valid path names, for pound_scene_assign. */
struct pound_field study_check_field(const char *path);

/* Why varying a field of the scene would change nothing; NULL: it may vary. */
const char *study_idle(const struct pound_study *study, const struct field *field, struct field_place place);

#endif
