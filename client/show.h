/* show.h - a result as JSON, as tables for people or as CSV. */
#ifndef SHOW_H
#define SHOW_H

#include "client/command.h"

#include <stddef.h>

/* Prints the JSON of a result on stdout in the format of the options, or the table that they name; an error on stderr when it is
 * not a result or has no such table. */
enum outcome show_result(const char *json, size_t length, const struct options *options);

#endif
