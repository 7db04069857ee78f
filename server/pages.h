/* pages.h - answers built into the server: pages for browsers, and example studies. */
#ifndef PAGES_H
#define PAGES_H

#include "schema/http/api.h"
#include "server/reply.h"

struct reply pages_file(int operation);       /* one of the operations of pages */
struct reply pages_example(const char *name); /* body NULL: there is no such example */
struct reply pages_example_list(void);

#endif
