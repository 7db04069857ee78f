/* filtered_noise_w8.c - filtered noise: eight lanes (AVX-512). */
#define POUND_LANES  8
#define POUND_COLOUR pound_colour_w8
#define POUND_NOISE  pound_noise_w8
#include "engine/ground/filtered_noise.inl"
