/* normals.c - normal deviates at the widest lanes of this machine. */
#include "engine/ground/normals.h"
#include "engine/numeric/cpu_width.h"

typedef void normals(struct pound_stream, uint32_t, double z[NOISE_WORDS][NOISE_CHUNK]);

void pound_noise_normals(int width, struct pound_stream stream, uint32_t first,
                         double z[NOISE_WORDS][NOISE_CHUNK])
{
	static normals *const run[POUND_WIDTHS] = {pound_noise_w8, pound_noise_w4, pound_noise_w1,
	                                           pound_noise_portable};
	run[width](stream, first, z);
}
