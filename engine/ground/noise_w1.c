/* noise_w1.c - noise: one lane, with fused multiply-add. */
#define POUND_LANES   1
#define POUND_NOISE   pound_noise_w1
#define POUND_NORMALS pound_normals_w1
#include "engine/ground/noise.inl"
