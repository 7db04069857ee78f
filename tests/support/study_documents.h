/* study_documents.h - study documents for tests: complete ones, and copies with one piece of text replaced. */
#ifndef DOCUMENTS_H
#define DOCUMENTS_H

#include "engine/pound.h"
#include "schema/json/problems.h"

extern const char
    documents_sensitivity[]; /* every member of a sensitivity study but its sweep, all written out */
extern const char documents_response[]; /* the least response: two frequencies */

extern const char documents_convergence[]; /* a short convergence study, every member of it written out */

extern const char documents_floor[]; /* a floor spectrum study, every member of it written out */

/* One of these by its name: "sensitivity", "response", "convergence", "floor". */
const char *documents_named(const char *name);

/* A copy with the first `from` replaced, which must be there; the caller frees it. */
char *documents_with(const char *document, const char *from, const char *to);

/* The study of a document without problems; fails the test when it has any. */
struct pound_study *documents_study(const char *document);

/* Reads a document that must have problems. */
void documents_refused(const char *document, struct problems *problems);

/* Fails unless the document has exactly this one problem. */
void documents_problem(const char *document, const char *pointer, const char *detail);

#endif
