/* filtered_noise_portable.c - filtered noise: one lane, any processor of this architecture. */
#define POUND_LANES  1
#define POUND_COLOUR pound_colour_portable
#define POUND_NOISE  pound_noise_portable
#include "engine/ground/filtered_noise.inl"
