/* normals.c - normal deviates at the widest lanes of this machine. */
#include "engine/ground/normals.h"
#include "engine/numeric/cpu_width.h"

typedef void normals(struct pound_stream, uint32_t, double z[NOISE_WORDS][NOISE_CHUNK]);

void pound_normals_fill(int width, struct pound_stream stream, uint32_t first,
                        double z[NOISE_WORDS][NOISE_CHUNK])
{
	static normals *const run[POUND_WIDTHS] = {pound_normals_w8, pound_normals_w4, pound_normals_w1,
	                                           pound_normals_portable};
	run[width](stream, first, z);
}
