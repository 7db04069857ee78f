/* filtered_noise_w8.c - filtered noise: eight lanes (AVX-512). */
#define POUND_LANES          8
#define POUND_FILTERED_NOISE pound_filtered_noise_w8
#define POUND_NORMALS        pound_normals_w8
#include "engine/ground/filtered_noise.inl"
