/* show.h - a result as tables for people. */
#ifndef SHOW_H
#define SHOW_H

#include "client/command.h"

#include <stddef.h>

/* Prints the JSON of a result on stdout; complains when it is none. */
enum outcome show_result(const char *json, size_t length);

/* Prints it as json, table or csv. */
enum outcome show_as(const char *json, size_t length, const char *format);

#endif
