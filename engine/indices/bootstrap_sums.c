/* bootstrap_sums.c - sums over resampled rows at the widest lanes of this machine. */
#include "engine/indices/bootstrap_sums.h"
#include "engine/numeric/cpu_width.h"

typedef void resample(const struct pound_tiles *, uint64_t, int, double *);

void pound_resample_sums(int width, const struct pound_tiles *tiles, uint64_t seed, int first, double *sum)
{
	static resample *const run[POUND_WIDTHS] = {pound_resample_w8, pound_resample_w4, pound_resample_w1,
	                                            pound_resample_portable};
	run[width](tiles, seed, first, sum);
}
