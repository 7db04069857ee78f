/* check.h - included by every test program: cmocka, and a comparison that shows both numbers to 17 digits.
 *
 * A program is `tests/unit_<stem>.c` with one CHECK_MAIN(test, test, ...) line; T=substring runs the tests, and the
 * programs, that have it in their names. */
#ifndef CHECK_H
#define CHECK_H

#include <setjmp.h>
#include <stdarg.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>

#include <cmocka.h>

#define check_near(got, want, allowed) check_near_at((got), (want), (allowed), #got, __FILE__, __LINE__)

/* Fails unless |got - want| <= allowed, all finite; prints both, the difference and the tolerance. */
void check_near_at(double got, double want, double allowed, const char *what, const char *file, int line);

/* Prints a line of results of a test, such as counts and times, which tests/run-tests shows. */
void check_report(const char *format, ...) __attribute__((format(printf, 1, 2)));

/* Number of repetitions: `brief` in make test, POUND_SOAK % of `soak` in make soak if that is more. */
int check_count(int brief, int soak);
bool check_soaks(void); /* POUND_SOAK is set: the machine is idle, so times may be checked */

/* Runs a table of tests under the name of the program; when T is set and not in that name, only those that it names. */
int check_run(const char *program, const struct CMUnitTest *tests, int n);

#define CHECK_MAIN(...)                                                          \
	int main(int argc, char **argv)                                              \
	{                                                                            \
		const struct CMUnitTest tests[] = {__VA_ARGS__};                         \
		(void)argc;                                                              \
		return check_run(argv[0], tests, (int)(sizeof tests / sizeof tests[0])); \
	}

#endif
