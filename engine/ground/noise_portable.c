/* noise_portable.c - noise: one lane, any processor of this architecture. */
#define POUND_LANES   1
#define POUND_NOISE   pound_noise_portable
#define POUND_NORMALS pound_normals_portable
#include "engine/ground/noise.inl"
