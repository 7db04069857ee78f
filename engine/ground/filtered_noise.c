/* filtered_noise.c - filtered noise at the widest lanes of this machine. */
#include "engine/ground/kanai_tajimi.h"
#include "engine/numeric/cpu_width.h"

typedef void colour(const struct pound_filtered *, int n);

void pound_filtered_noise_fill(int width, const struct pound_filtered *signals, int n)
{
	static colour *const run[POUND_WIDTHS] = {pound_filtered_noise_w8, pound_filtered_noise_w4,
	                                          pound_filtered_noise_w1, pound_filtered_noise_portable};
	run[width](signals, n);
}
