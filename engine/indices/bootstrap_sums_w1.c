/* bootstrap_sums_w1.c - sums over resampled rows: one lane, with fused multiply-add. */
#define POUND_LANES          1
#define POUND_BOOTSTRAP_SUMS pound_bootstrap_sums_w1
#include "engine/indices/bootstrap_sums.inl"
