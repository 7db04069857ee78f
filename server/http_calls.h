/* http_calls.h - callbacks of libmicrohttpd: `of` is the server, `kept` the request. */
#ifndef HTTP_CALLS_H
#define HTTP_CALLS_H

#include <microhttpd.h>

#include "server/http.h"

void *http_begin(void *of, const char *target, struct MHD_Connection *connection);
enum MHD_Result http_answer(void *of, struct MHD_Connection *connection, const char *path, const char *method,
                            const char *version, const char *bytes, size_t *n, void **kept);
void http_completed(void *of, struct MHD_Connection *connection, void **kept,
                    enum MHD_RequestTerminationCode why);
void http_resume(void *connection);

#endif
