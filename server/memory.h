/* memory.h - how much memory there is for this process. */
#ifndef MEMORY_H
#define MEMORY_H

int memory_share(const char *root); /* [MiB] half of it, at least 1; root: "", or a folder that replaces / */

#endif
