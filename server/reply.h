/* reply.h - what a route answers, as http.c sends it. */
#ifndef REPLY_H
#define REPLY_H

#include <stdbool.h>
#include <stddef.h>

struct reply {
	int status;
	const char *type;   /* media type of the body */
	char *body;         /* (length) bytes on the heap, http.c frees them unless ...; NULL: none */
	bool lasts;         /* ... they last as long as the server */
	int file;           /* unnamed temporary file with the body instead, which http.c closes; 0: none */
	size_t length;      /* of the body; also for a HEAD, where body may be NULL */
	const char *policy; /* Content-Security-Policy; NULL: nothing may be loaded */
	char location[64];  /* "": no such header, likewise below */
	char etag[64];
	int retry_after;  /* [s], 0: none */
	bool gone;        /* the client had disconnected before it was made */
	bool later;       /* not made: call again from a thread of the request's own, or with `crowded` */
	bool waits;       /* a client that has it already may wait for a change of the study */
	unsigned changes; /* store_changes of the study before it was read */
};

#endif
