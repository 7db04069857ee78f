/* show.h - a result as tables for people. */
#ifndef SHOW_H
#define SHOW_H

#include "client/command.h"

#include <stddef.h>

/* Prints the JSON of a result on stdout; complains when it is none. */
enum outcome show_result(const char *json, size_t length);

#endif
