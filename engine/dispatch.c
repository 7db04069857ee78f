/* dispatch.c - which lanes this machine has, and what is run at the widest of them; all widths give the same bits. */
#include <stdbool.h>

#include "engine/dispatch.h"
#include "engine/filter.h"
#include "engine/march.h"
#include "engine/noise.h"
#include "engine/resample.h"

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

/* The compilation to run at a lane count; 0: the widest there is.
 *
 * Returns  value  one of the enum in dispatch.h; -1: this machine has no such lanes
 */
int pound_dispatch_width(int lanes)
{
	for (int w = 0; w < POUND_WIDTHS; w++)
		if ((lanes == 0 || widths[w].lanes == lanes) && widths[w].supported())
			return w;
	return -1;
}

typedef void march(const struct pound_march_task *, struct pound_march_result *, int n, void *scratch,
                   const atomic_bool *stop);

/* Runs tasks at a lane count; 0: the widest there is.
 *
 * Given    stop     looked at throughout: when it is set the results are not to be used; NULL: never
 * Returns  value    false: this machine has no such lanes, nothing was run
 *          results  one for each task  (n)
 */
bool pound_march_lanes(int lanes, const struct pound_march_task *tasks, struct pound_march_result *results,
                       int n, void *scratch, const atomic_bool *stop)
{
	static march *const run[POUND_WIDTHS] = {pound_march_w8, pound_march_w4, pound_march_w1,
	                                         pound_march_portable};
	int width = pound_dispatch_width(lanes);
	if (width >= 0)
		run[width](tasks, results, n, scratch, stop);
	return width >= 0;
}

typedef void normals(struct pound_stream, uint32_t, double z[NOISE_WORDS][NOISE_CHUNK]);

void pound_noise_normals(int width, struct pound_stream stream, uint32_t first,
                         double z[NOISE_WORDS][NOISE_CHUNK])
{
	static normals *const run[POUND_WIDTHS] = {pound_noise_w8, pound_noise_w4, pound_noise_w1,
	                                           pound_noise_portable};
	run[width](stream, first, z);
}

typedef void colour(const struct pound_coloured *, int n);

void pound_filters_run(int width, const struct pound_coloured *signals, int n)
{
	static colour *const run[POUND_WIDTHS] = {pound_colour_w8, pound_colour_w4, pound_colour_w1,
	                                          pound_colour_portable};
	run[width](signals, n);
}

typedef void resample(const struct pound_tiles *, uint64_t, int, double *);

void pound_resample_sums(int width, const struct pound_tiles *tiles, uint64_t seed, int first, double *sum)
{
	static resample *const run[POUND_WIDTHS] = {pound_resample_w8, pound_resample_w4, pound_resample_w1,
	                                            pound_resample_portable};
	run[width](tiles, seed, first, sum);
}
