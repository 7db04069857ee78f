/* exact_w4.c - the exact solver: four lanes (AVX2). */
#define POUND_LANES 4
#define POUND_EXACT pound_exact_w4
#include "engine/exact/exact.inl"
