/* json_pointer.h - answers of the server and results, read by JSON Pointer.
 *
 *   struct reading *status = reading_open(body, length);
 *   printf("%s %g\n", reading_text(status, "/status"), reading_number(status, "/progress"));
 *   for (int i = 0; i < reading_count(status, "/errors"); i++)
 *       puts(reading_text(status, "/errors/%d/pointer", i));
 *   reading_close(status);
 *
 * The pointer is a printf format, for array indices.  What is returned lives until reading_close. */
#ifndef JSON_POINTER_H
#define JSON_POINTER_H

#include <stdbool.h>
#include <stddef.h>

struct reading;

struct reading *reading_open(const char *text, size_t length); /* NULL: not JSON, or out of memory */
void reading_close(struct reading *reading);

#define READING_FORMAT __attribute__((format(printf, 2, 3)))
const char *reading_text(const struct reading *reading, const char *pointer,
                         ...) READING_FORMAT; /* NULL: not a text */
double reading_number(const struct reading *reading, const char *pointer,
                      ...) READING_FORMAT; /* NAN: not a number */
bool reading_true(const struct reading *reading, const char *pointer,
                  ...) READING_FORMAT; /* it is there and is true */
bool reading_has(const struct reading *reading, const char *pointer,
                 ...) READING_FORMAT; /* it is there, maybe null */
/* 'o'bject, 'a'rray, 's'tring, 'n'umber, 'b'oolean, '0' null; 0: not there */
char reading_type(const struct reading *reading, const char *pointer, ...) READING_FORMAT;
int reading_count(const struct reading *reading, const char *pointer,
                  ...) READING_FORMAT; /* elements, members; 0 */
/* the name of member `index` of an object, NULL past the last */
const char *reading_member(const struct reading *reading, int index, const char *pointer, ...)
    __attribute__((format(printf, 3, 4)));

#endif
