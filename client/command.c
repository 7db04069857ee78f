/* command.c - functions for all subcommands: error lines on stderr, allocated texts and memory. */
#include "client/command.h"

#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

/* Ends the program when an allocation has failed: no unfinished work is worth saving. */
void *command_sure(void *memory)
{
	if (!memory) {
		fputs("pound: out of memory\n", stderr);
		exit(OUTCOME_FAILED);
	}
	return memory;
}

static char *text_of(const char *format, va_list arguments)
{
	char *text;
	return command_sure(vasprintf(&text, format, arguments) < 0 ? NULL : text);
}

/* Formats a text of any length.
 *
 * Memory   allocates; the caller frees
 */
char *command_text(const char *format, ...)
{
	va_list arguments;
	va_start(arguments, format);
	char *text = text_of(format, arguments);
	va_end(arguments);
	return text;
}

char *command_append(char *text, const char *format, ...)
{
	va_list arguments;
	va_start(arguments, format);
	char *more = text_of(format, arguments), *whole = command_text("%s%s", text, more);
	va_end(arguments);
	free(text), free(more);
	return whole;
}

/* Replaces control characters, so that text from others cannot control the terminal. */
void command_tame(char *text)
{
	for (unsigned char *c = (unsigned char *)text; *c; c++) {
		// C0 controls, DEL, and C1 controls, which UTF-8 encodes as c2 80 .. c2 9f
		if (*c < ' ' || *c == 0x7f)
			*c = '?';
		else if (*c == 0xc2 && c[1] >= 0x80 && c[1] < 0xa0)
			c[0] = c[1] = '?';
	}
}

/* Prints one line on stderr, with control characters replaced. */
void command_complain(const char *format, ...)
{
	va_list arguments;
	va_start(arguments, format);
	char *line = text_of(format, arguments);
	va_end(arguments);
	command_tame(line);
	fprintf(stderr, "pound: %s\n", line);
	free(line);
}

bool command_is_id(const char *text)
{
	return strlen(text) == 16 && strspn(text, "0123456789abcdef") == 16 && access(text, F_OK) != 0;
}
