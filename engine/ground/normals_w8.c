/* normals_w8.c - normal deviates: eight lanes (AVX-512). */
#define POUND_LANES   8
#define POUND_NORMALS pound_normals_w8
#include "engine/ground/normals.inl"
