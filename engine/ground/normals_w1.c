/* normals_w1.c - normal deviates: one lane, with fused multiply-add. */
#define POUND_LANES   1
#define POUND_NORMALS pound_normals_w1
#include "engine/ground/normals.inl"
