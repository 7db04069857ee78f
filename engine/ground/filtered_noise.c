/* filtered_noise.c - filtered noise at the widest lanes of this machine. */
#include "engine/ground/kanai_tajimi.h"
#include "engine/numeric/cpu_width.h"

typedef void colour(const struct pound_coloured *, int n);

void pound_filters_run(int width, const struct pound_coloured *signals, int n)
{
	static colour *const run[POUND_WIDTHS] = {pound_colour_w8, pound_colour_w4, pound_colour_w1,
	                                          pound_colour_portable};
	run[width](signals, n);
}
