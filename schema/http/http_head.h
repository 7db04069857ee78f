/* http_head.h - checks the head of a request (target, headers, framing, host) before the request is handled.
 *
 * No library calls for HTTP, no allocation.  Memory of the caller; one thread at a time. */
#ifndef HTTP_HEAD_H
#define HTTP_HEAD_H

#include <stdbool.h>
#include <stddef.h>

#include "schema/http/api.h"

enum {
	HEAD_BODY_MAX = 1 << 20,   /* [bytes] */
	HEAD_RECORD_MAX = 8 << 20, /* file of a recorded ground motion [bytes] */
	HEAD_TEXT_SIZE = 1024,     /* stored value of a header [bytes] */
	HEAD_KEY_MAX = 200,        /* characters of an Idempotency-Key */
	HEAD_TARGET_MAX = 4096,    /* [bytes] */
	HEAD_ARGUMENTS_MAX = 16,
	HEAD_LINES_MAX = 64,      /* headers */
	HEAD_BYTES_MAX = 1 << 14, /* request line and headers [bytes] */
};

/* A stored header. */
struct head_text {
	int lines;                  /* number of such headers */
	char value[HEAD_TEXT_SIZE]; /* of the first, "" if it is too long; of a list header all elements
	                               that fit */
};

struct head {
	int hosts, lengths, codings, types; /* number of such headers */
	bool encoded;                       /* the body has a Content-Encoding, such as gzip */
	bool json;                          /* the body is declared as JSON */
	bool has_body;
	bool of_record; /* the body is a file of a recorded ground motion; set before head_end */
	size_t length;  /* Content-Length of the body */
	char host[256];
	struct head_text authorization, key; /* key: Idempotency-Key */
	struct head_text etags;              /* If-None-Match */
	struct head_text prefer, accept;
	struct head_text origin, site; /* site: Sec-Fetch-Site */
	enum api_fault fault;          /* the first one found, API_NO_FAULT: none */
	char detail[640];              /* a sentence about it */
	bool close;                    /* close the connection: the end of the request is uncertain */
};

/* call first, with the raw target; returns how many of its bytes to parse: all, or only the path if arguments are refused */
size_t head_target(struct head *head, const char *target);
/* call with the bytes after the request line, as libmicrohttpd leaves them, and the number of headers it found */
void head_bytes(struct head *head, const char *bytes, size_t n, int n_lines);
void head_header(struct head *head, const char *name, size_t n_name, const char *value, size_t n_value);
/* call last; `names`: comma-separated hosts accepted in addition to localhost and addresses (NULL: none) */
void head_end(struct head *head, bool needs_host, const char *names);

void head_origin(struct head *head); /* after head_end, if the request changes data */
void head_key(struct head *head);    /* after head_end, if the request may have an Idempotency-Key */
void head_argument(struct head *head, int operation, const char *name, const char *value);
/* notes a fault found later */
void head_refuse(struct head *head, enum api_fault fault, bool close, const char *format, ...)
    __attribute__((format(printf, 4, 5)));

bool head_has_host(const char *host, const char *names);
bool head_names(const char *accept, const char *type);  /* whether Accept lists a media type */
bool head_has_etag(const char *list, const char *etag); /* whether If-None-Match lists a tag */
int head_wait(const char *prefer);                      /* N of wait=N in Prefer [s], else 0 */

#endif
