/* npy.h - the head of a NumPy file that holds records.
 *
 * Source: numpy.lib.format, version 3.0 */
#ifndef NPY_H
#define NPY_H

#include "schema/json/json_writer.h"

/* A field of the records, its name in two parts; `type` in the words of numpy.dtype. */
void npy_field(struct writer *fields, const char *name, const char *suffix, const char *type);

/* Magic, length and dictionary of n records; `fields` is what npy_field wrote.  false: out of memory. */
bool npy_head(struct writer *w, struct writer *fields, int64_t n);

#endif
