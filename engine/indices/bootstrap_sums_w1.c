/* bootstrap_sums_w1.c - sums over resampled rows: one lane, with fused multiply-add. */
#define POUND_LANES    1
#define POUND_RESAMPLE pound_resample_w1
#include "engine/indices/bootstrap_sums.inl"
