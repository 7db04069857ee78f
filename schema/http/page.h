/* page.h - the files of client/page, built into the server. */
#ifndef PAGE_H
#define PAGE_H

struct page_file {
	const char *name; /* in client/page */
	const char *text;
};

extern const struct page_file page_files[]; /* ends with a row of NULLs; made by the Makefile */

#endif
