/* normals_w1.c - normal deviates: one lane, with fused multiply-add. */
#define POUND_LANES 1
#define POUND_NOISE pound_noise_w1
#include "engine/ground/normals.inl"
