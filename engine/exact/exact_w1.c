/* exact_w1.c - the exact solver: one lane, with fused multiply-add. */
#define POUND_LANES 1
#define POUND_EXACT pound_exact_w1
#include "engine/exact/exact.inl"
