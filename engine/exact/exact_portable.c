/* exact_portable.c - the exact solver: one lane, any processor of this architecture. */
#define POUND_LANES 1
#define POUND_EXACT pound_exact_portable
#include "engine/exact/exact.inl"
