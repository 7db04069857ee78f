/* noise.c - noise, by the compilation of noise.inl for a lane width. */
#include "engine/ground/noise.h"
#include "engine/numeric/cpu_width.h"

typedef void noise(const struct pound_noise *, int n);

void pound_noise_fill(int width, const struct pound_noise *signals, int n)
{
	static noise *const run[POUND_WIDTHS] = {pound_noise_w8, pound_noise_w4, pound_noise_w1,
	                                         pound_noise_portable};
	run[width](signals, n);
}
