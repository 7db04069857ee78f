/* check.c - the comparison and the runner of check.h. */
#include "tests/support/check.h"

#include <math.h>
#include <string.h>

void check_near_at(double got, double want, double allowed, const char *what, const char *file, int line)
{
	if (fabs(got - want) <= allowed)
		return;
	print_error("%s:%d: %s\n  got     %.17g\n  want    %.17g\n  differ  %.3g\n  allowed %.3g\n", file, line,
	            what, got, want, got - want, allowed);
	_fail(file, line);
}

bool check_soaks(void)
{
	return getenv("POUND_SOAK");
}

void check_report(const char *format, ...)
{
	va_list values;
	va_start(values, format);
	printf("# ");
	vprintf(format, values);
	va_end(values);
	printf("\n");
	fflush(stdout);
}

int check_count(int brief, int soak)
{
	const char *more = getenv("POUND_SOAK");
	int part = more ? (int)((long)soak * atoi(more) / 100) : 0;
	return part > brief ? part : brief;
}

int check_run(const char *program, const struct CMUnitTest *tests, int n)
{
	const char *wanted = getenv("T"), *slash = strrchr(program, '/'), *name = slash ? slash + 1 : program;
	char pattern[128];
	if (wanted && *wanted && !strstr(name, wanted)) {
		snprintf(pattern, sizeof pattern, "*%s*", wanted);
		cmocka_set_test_filter(pattern);
	}
	return _cmocka_run_group_tests(name, tests, (size_t)n, NULL, NULL);
}
