/* json_pointer.h - reads values of a JSON document, such as a response of the server or a result, by JSON Pointer.
 *
 *   struct reading *status = reading_open(body, length);
 *   printf("%s %g\n", reading_text(status, "/status"), reading_number(status, "/progress"));
 *   for (int i = 0; i < reading_count(status, "/errors"); i++)
 *       puts(reading_text(status, "/errors/%d/pointer", i));
 *   reading_close(status);
 *
 * The pointer is a printf format, for array indices.  Returned strings are valid until reading_close. */
#ifndef JSON_POINTER_H
#define JSON_POINTER_H

#include <stdbool.h>
#include <stddef.h>

struct reading;

/* Reads the token of a pointer at a "/", with ~0 and ~1 replaced by ~ and /; returns the position behind it.  token: as long as the
 * pointer */
const char *json_pointer_token(const char *at, char *token);

struct reading *reading_open(const char *text, size_t length); /* NULL: not JSON, or out of memory */
void reading_close(struct reading *reading);

#define READING_FORMAT __attribute__((format(printf, 2, 3)))
const char *reading_text(const struct reading *reading, const char *pointer,
                         ...) READING_FORMAT; /* NULL: not a string */
double reading_number(const struct reading *reading, const char *pointer,
                      ...) READING_FORMAT; /* NAN: not a number */
bool reading_true(const struct reading *reading, const char *pointer,
                  ...) READING_FORMAT; /* the value exists and is true */
bool reading_has(const struct reading *reading, const char *pointer,
                 ...) READING_FORMAT; /* the value exists, possibly null */
/* 'o'bject, 'a'rray, 's'tring, 'n'umber, 'b'oolean, '0' null; 0: no such value */
char reading_type(const struct reading *reading, const char *pointer, ...) READING_FORMAT;
int reading_count(const struct reading *reading, const char *pointer,
                  ...) READING_FORMAT; /* elements or members; else 0 */
/* the name of member `index` of an object, NULL after the last */
const char *reading_member(const struct reading *reading, int index, const char *pointer, ...)
    __attribute__((format(printf, 3, 4)));

#endif
