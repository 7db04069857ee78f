/* reply.h - what a route answers, as http.c sends it. */
#ifndef REPLY_H
#define REPLY_H

#include <stdbool.h>
#include <stddef.h>

struct reply {
	int status;
	const char *type;   /* media type of the body */
	char *body;         /* (length) bytes on the heap, http.c frees them unless ...; NULL: none */
	bool lasts;         /* ... it lasts as long as the server */
	int file;           /* without a name, which has them in its place, for http.c to close; 0: none */
	size_t length;      /* of a HEAD, too, for which they need not be there */
	const char *policy; /* Content-Security-Policy; NULL: nothing may be loaded */
	char location[64];  /* "": no such header, likewise below */
	char etag[64];
	int retry_after;  /* [s], 0: none */
	bool gone;        /* the client had gone before it was made */
	bool later;       /* none yet: the request is to have a thread of its own, or is crowded */
	bool waits;       /* who knows it already may wait for another, when the study has changed */
	unsigned changes; /* of the study, before it was looked at */
};

#endif
