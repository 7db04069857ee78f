/* dispatch.c - the march at the widest lanes this machine has; all widths give the same bits. */
#include <stddef.h>

#include "engine/march.h"

static bool always(void)
{
	return true;
}
static bool has_fma(void)
{
	return __builtin_cpu_supports("fma");
}
static bool has_avx2(void)
{
	return __builtin_cpu_supports("avx2") && __builtin_cpu_supports("fma");
}
static bool has_avx512(void)
{
	return __builtin_cpu_supports("avx512f") && __builtin_cpu_supports("avx512dq") &&
	       __builtin_cpu_supports("avx512vl") && __builtin_cpu_supports("fma");
}

typedef void march(const struct pound_march_task *, struct pound_march_result *, int n, void *scratch);

// widest first
static const struct width {
	int lanes;
	bool (*supported)(void);
	march *run;
} widths[] = {
    {8, has_avx512, pound_march_w8},
    {4, has_avx2, pound_march_w4},
    {1, has_fma, pound_march_w1},
    {1, always, pound_march_portable},
};

/* Runs tasks at a lane count; 0: the widest there is.
 *
 * Returns  value    false: this machine has no such lanes, nothing was run
 *          results  one for each task  (n)
 */
bool pound_march_lanes(int lanes, const struct pound_march_task *tasks, struct pound_march_result *results,
                       int n, void *scratch)
{
	for (size_t w = 0; w < sizeof widths / sizeof widths[0]; w++)
		if ((lanes == 0 || widths[w].lanes == lanes) && widths[w].supported()) {
			widths[w].run(tasks, results, n, scratch);
			return true;
		}
	return false;
}
