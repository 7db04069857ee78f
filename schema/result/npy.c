/* npy.c - the header of a NumPy file with a structured array. */
#include "schema/result/npy.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* Quotes and backslashes of the name are escaped as in Python. */
void npy_field(struct writer *fields, const char *name, const char *suffix, const char *type)
{
	writer_raw(fields, "('", 2);
	for (const char *s = name; *s; s++) {
		if (*s == '\'' || *s == '\\')
			writer_raw(fields, "\\", 1);
		writer_raw(fields, s, 1);
	}
	writer_raw(fields, suffix, strlen(suffix));
	writer_raw(fields, "', '", 4);
	writer_raw(fields, type, strlen(type));
	writer_raw(fields, "'), ", 4);
}

/* Magic, version 3 (UTF-8), length, dictionary; padded so that the data start at a multiple of 64.
 *
 * Given    fields    written by npy_field; freed here
 *          n         records that follow
 * Test     unit_samples: a_numpy_file_holds_the_same_numbers
 */
bool npy_head(struct writer *w, struct writer *fields, int64_t n)
{
	enum { LEAD = 12 };
	static const char before[] = "{'descr': [";
	char after[96];
	size_t length;
	char *text = writer_take(fields, &length);
	if (!text)
		return false;
	int n_after =
	    snprintf(after, sizeof after, "], 'fortran_order': False, 'shape': (%lld,), }", (long long)n);
	size_t inside = sizeof before - 1 + length + (size_t)n_after;
	size_t whole = (LEAD + inside + 1 + 63) / 64 * 64;
	uint32_t size = (uint32_t)(whole - LEAD);
	unsigned char lead[LEAD] = {0x93, 'N', 'U', 'M', 'P', 'Y', 3, 0};
	for (int i = 0; i < 4; i++)
		lead[8 + i] = (unsigned char)(size >> (8 * i));
	writer_raw(w, (const char *)lead, LEAD);
	writer_raw(w, before, sizeof before - 1);
	writer_raw(w, text, length);
	writer_raw(w, after, (size_t)n_after);
	for (size_t i = LEAD + inside; i < whole; i++)
		writer_raw(w, i + 1 < whole ? " " : "\n", 1);
	free(text);
	return true;
}
