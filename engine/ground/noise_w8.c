/* noise_w8.c - noise: eight lanes (AVX-512). */
#define POUND_LANES   8
#define POUND_NOISE   pound_noise_w8
#define POUND_NORMALS pound_normals_w8
#include "engine/ground/noise.inl"
