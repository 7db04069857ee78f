/* bootstrap_sums_portable.c - sums over resampled rows: one lane, any processor of this architecture. */
#define POUND_LANES          1
#define POUND_BOOTSTRAP_SUMS pound_bootstrap_sums_portable
#include "engine/indices/bootstrap_sums.inl"
