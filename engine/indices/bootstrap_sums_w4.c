/* bootstrap_sums_w4.c - sums over resampled rows: four lanes (AVX2). */
#define POUND_LANES          4
#define POUND_BOOTSTRAP_SUMS pound_bootstrap_sums_w4
#include "engine/indices/bootstrap_sums.inl"
