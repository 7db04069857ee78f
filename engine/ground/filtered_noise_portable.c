/* filtered_noise_portable.c - filtered noise: one lane, any processor of this architecture. */
#define POUND_LANES          1
#define POUND_FILTERED_NOISE pound_filtered_noise_portable
#define POUND_NORMALS        pound_normals_portable
#include "engine/ground/filtered_noise.inl"
