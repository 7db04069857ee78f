/* http_head.h - what the head of a request must be before anything is done for it.
 *
 * Bytes in, a verdict out: no library, no allocation.  Plain memory of the caller; one thread at a time. */
#ifndef HTTP_HEAD_H
#define HTTP_HEAD_H

#include <stdbool.h>
#include <stddef.h>

#include "schema/http/api.h"

enum {
	HEAD_BODY_MAX = 1 << 20,   /* [bytes] */
	HEAD_RECORD_MAX = 8 << 20, /* of a file of a recorded ground motion */
	HEAD_TEXT_SIZE = 1024,     /* of a value that is kept [bytes] */
	HEAD_KEY_MAX = 200,        /* characters of an Idempotency-Key */
	HEAD_TARGET_MAX = 4096,    /* [bytes] */
	HEAD_ARGUMENTS_MAX = 16,
	HEAD_LINES_MAX = 64,      /* headers */
	HEAD_BYTES_MAX = 1 << 14, /* of the request line and the headers */
};

/* A header that is read later. */
struct head_text {
	int lines;                  /* headers of that name */
	char value[HEAD_TEXT_SIZE]; /* of the first, "" when it does not fit; of a list all, but for elements
	                               that do not */
};

struct head {
	int hosts, lengths, codings, types; /* headers of that name */
	bool encoded;                       /* the body is compressed or the like */
	bool json;                          /* the body is declared as JSON */
	bool has_body;
	bool of_record; /* the body is a file of a recorded ground motion; set before head_end */
	size_t length;  /* of the body, as it is declared */
	char host[256];
	struct head_text authorization, key; /* key: Idempotency-Key */
	struct head_text etags;              /* If-None-Match */
	struct head_text prefer, accept;
	struct head_text origin, site; /* site: Sec-Fetch-Site */
	enum api_fault fault;          /* the first that was found, API_NO_FAULT: none */
	char detail[200];              /* a sentence about it */
	bool close;                    /* it leaves in doubt where the request ends */
};

/* the first, with the raw target; its bytes to parse: all, or without the arguments when they are refused */
size_t head_target(struct head *head, const char *target);
/* what follows the target, as libmicrohttpd has left it when it has found so many headers in it */
void head_bytes(struct head *head, const char *bytes, size_t n, int n_lines);
void head_header(struct head *head, const char *name, size_t n_name, const char *value, size_t n_value);
/* the last; `names`: comma-separated hosts accepted in addition to localhost and addresses (NULL: none) */
void head_end(struct head *head, bool needs_host, const char *names);

void head_origin(struct head *head); /* after that, if the request changes something */
void head_key(struct head *head);    /* after that, if the request may have an Idempotency-Key */
void head_argument(struct head *head, int operation, const char *name, const char *value);
/* a fault that is found later */
void head_refuse(struct head *head, enum api_fault fault, bool close, const char *format, ...)
    __attribute__((format(printf, 4, 5)));

bool head_has_host(const char *host, const char *names);
bool head_names(const char *accept, const char *type);  /* an Accept names a media type */
bool head_has_etag(const char *list, const char *etag); /* an If-None-Match has a tag */
int head_wait(const char *prefer);                      /* N of a Prefer with wait=N [s], else 0 */

#endif
