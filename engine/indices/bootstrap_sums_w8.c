/* bootstrap_sums_w8.c - sums over resampled rows: eight lanes (AVX-512). */
#define POUND_LANES          8
#define POUND_BOOTSTRAP_SUMS pound_bootstrap_sums_w8
#include "engine/indices/bootstrap_sums.inl"
