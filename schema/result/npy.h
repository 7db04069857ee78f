/* npy.h - the header of a NumPy file with a structured array.
 *
 * Source: numpy.lib.format, version 3.0 */
#ifndef NPY_H
#define NPY_H

#include "schema/json/json_writer.h"

/* Writes a field of the array's dtype: name and suffix, and a type such as "<f8". */
void npy_field(struct writer *fields, const char *name, const char *suffix, const char *type);

/* Writes magic, length and dictionary of n records with the `fields` written by npy_field.  false: out of memory. */
bool npy_head(struct writer *w, struct writer *fields, int64_t n);

#endif
