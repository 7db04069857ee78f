/* study_documents.h - study documents for tests: complete ones, and copies with one piece of text replaced. */
#ifndef STUDY_DOCUMENTS_H
#define STUDY_DOCUMENTS_H

#include "engine/pound.h"
#include "schema/json/problems.h"

extern const char
    study_documents_sensitivity[]; /* every member of a sensitivity study but its sweep, all written out */
extern const char study_documents_row[]; /* a sensitivity study of a row of buildings, with all its members */
extern const char study_documents_response[]; /* the least response: two frequencies */

extern const char
    study_documents_convergence[]; /* a short convergence study, every member of it written out */

extern const char
    study_documents_separation[];          /* how wide a gap has to be, every member of that written out */
extern const char study_documents_floor[]; /* a floor spectrum study, every member of it written out */

/* One of these by its name: "sensitivity", "row", "response", "convergence", "floor", "separation". */
const char *documents_named(const char *name);

/* A copy with the first `from` replaced, which must be there; the caller frees it. */
char *study_documents_with(const char *document, const char *from, const char *to);

/* The study of a document without problems; fails the test when it has any. */
struct pound_study *study_documents_study(const char *document);

/* Reads a document that must have problems. */
void study_documents_refused(const char *document, struct problems *problems);

/* Fails unless the document has exactly this one problem. */
void study_documents_problem(const char *document, const char *pointer, const char *detail);

#endif
