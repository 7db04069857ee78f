/* bootstrap_sums.c - sums over resampled rows: dispatch to a lane count. */
#include "engine/indices/bootstrap_sums.h"
#include "engine/numeric/cpu_width.h"

typedef void resample(const struct pound_tiles *, uint64_t, int, double *);

void pound_bootstrap_sums(int width, const struct pound_tiles *tiles, uint64_t seed, int first, double *sum)
{
	static resample *const run[POUND_WIDTHS] = {pound_bootstrap_sums_w8, pound_bootstrap_sums_w4,
	                                            pound_bootstrap_sums_w1, pound_bootstrap_sums_portable};
	run[width](tiles, seed, first, sum);
}
