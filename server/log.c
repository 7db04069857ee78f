/* A line is the UTC time, what happened, and a newline, written by one call so that threads do not mix.
 * Bytes that are not visible ASCII become '?': a path sent by a client can neither start a new line nor control a
 * terminal. */
#include "server/log.h"

#include <stdarg.h>
#include <stdio.h>
#include <time.h>
#include <unistd.h>

enum { LINE_MAX_BYTES = 1024 };

/* Logs what happened, or what went wrong.
 *
 * Given    format   printf format and its values, without a newline
 * Test     service_routes: a_path_with_a_newline_is_one_line_of_the_log
 */
void log_line(const char *format, ...)
{
	char text[LINE_MAX_BYTES];
	struct timespec now;
	struct tm utc;
	va_list values;
	clock_gettime(CLOCK_REALTIME, &now);
	gmtime_r(&now.tv_sec, &utc);
	size_t n = strftime(text, sizeof text, "%Y-%m-%dT%H:%M:%S", &utc);
	n += (size_t)snprintf(text + n, sizeof text - n, ".%03ldZ ", now.tv_nsec / 1000000);
	va_start(values, format);
	vsnprintf(text + n, sizeof text - n, format, values);
	va_end(values);
	for (n = 0; text[n]; n++)
		if (text[n] < ' ' || text[n] > '~')
			text[n] = '?';
	text[n++] = '\n'; // over the zero
	// a log that cannot be written must not stop the service
	if (write(STDERR_FILENO, text, n) < 0)
		return;
}
