/* cpu_width.c - the lane counts that this processor supports; all give the same bits. */
#include <stdbool.h>

#include "engine/numeric/cpu_width.h"

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

static const struct width {
	int lanes;
	bool (*supported)(void);
} widths[POUND_WIDTHS] = {
    [POUND_WIDTH_8] = {8, has_avx512},
    [POUND_WIDTH_4] = {4, has_avx2},
    [POUND_WIDTH_1] = {1, has_fma},
    [POUND_WIDTH_PORTABLE] = {1, always},
};

/* The compilation to run for a lane count.
 *
 * Given    lanes  8, 4 or 1; 0: the most that the processor supports
 * Returns  value  one of the enum in cpu_width.h; -1: not supported by this processor
 */
int pound_dispatch_width(int lanes)
{
	for (int w = 0; w < POUND_WIDTHS; w++)
		if ((lanes == 0 || widths[w].lanes == lanes) && widths[w].supported())
			return w;
	return -1;
}
