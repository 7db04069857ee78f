/* exact_w8.c - the exact solver: eight lanes (AVX-512). */
#define POUND_LANES 8
#define POUND_EXACT pound_exact_w8
#include "engine/exact/exact.inl"
