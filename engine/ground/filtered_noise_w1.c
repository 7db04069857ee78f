/* filtered_noise_w1.c - filtered noise: one lane, with fused multiply-add. */
#define POUND_LANES  1
#define POUND_COLOUR pound_colour_w1
#define POUND_NOISE  pound_noise_w1
#include "engine/ground/filtered_noise.inl"
