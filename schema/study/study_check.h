/* study_check.h - what the members of a study mean together. */
#ifndef STUDY_CHECK_H
#define STUDY_CHECK_H

#include "engine/pound.h"
#include "schema/json/problems.h"
#include "schema/study/fields.h"

/* Adds what is wrong between members that are each right on their own. */
void study_check(const struct pound_study *study, struct problems *problems);

bool study_check_applies(const struct pound_study *study, int output); /* in one cell at least */

/* Whether a study's responses are computed by a solver. */
bool study_check_solves(const struct pound_study *study, int solver);

/* The interval of a real field of the scene, over all samples and cells. */
void study_check_reach(const struct pound_study *study, const char *path, double *low, double *high);

/* Whether that is known whatever is wrong with other members; the same of the length of the ground motion. */
bool study_check_known(const struct pound_study *study, const char *path, const struct problems *problems);
bool study_check_steps_known(const struct pound_study *study, const struct problems *problems);

/* What contact models do not take: study_contact.c. */
void study_contact_check(const struct pound_study *study, struct problems *problems);
/* Why varying a member of the contact would change nothing, NULL when it may vary. */
const char *study_contact_idle(const struct pound_study *study, const char *member);

/* Whether the study's excitation uses a field. */
bool study_check_uses(const struct pound_study *study, const char *pattern);

/* The varied field that a path names, for pound_scene_assign; the path names one. */
struct pound_field study_check_field(const char *path);

/* Why varying a field of the scene would change nothing, NULL when it may vary. */
const char *study_idle(const struct pound_study *study, const struct field *field, struct field_place place);

#endif
