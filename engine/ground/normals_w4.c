/* normals_w4.c - normal deviates: four lanes (AVX2). */
#define POUND_LANES   4
#define POUND_NORMALS pound_normals_w4
#include "engine/ground/normals.inl"
