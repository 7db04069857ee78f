/* filtered_noise_w4.c - filtered noise: four lanes (AVX2). */
#define POUND_LANES          4
#define POUND_FILTERED_NOISE pound_filtered_noise_w4
#define POUND_NORMALS        pound_normals_w4
#include "engine/ground/filtered_noise.inl"
