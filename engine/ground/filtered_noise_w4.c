/* filtered_noise_w4.c - filtered noise: four lanes (AVX2). */
#define POUND_LANES  4
#define POUND_COLOUR pound_colour_w4
#define POUND_NOISE  pound_noise_w4
#include "engine/ground/filtered_noise.inl"
