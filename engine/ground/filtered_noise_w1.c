/* filtered_noise_w1.c - filtered noise: one lane, with fused multiply-add. */
#define POUND_LANES          1
#define POUND_FILTERED_NOISE pound_filtered_noise_w1
#define POUND_NORMALS        pound_normals_w1
#include "engine/ground/filtered_noise.inl"
