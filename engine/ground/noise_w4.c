/* noise_w4.c - noise: four lanes (AVX2). */
#define POUND_LANES   4
#define POUND_NOISE   pound_noise_w4
#define POUND_NORMALS pound_normals_w4
#include "engine/ground/noise.inl"
