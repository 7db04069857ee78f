/* pair_peaks_w1.c - linear bodies without contact: one lane, with fused multiply-add. */
#define POUND_LANES      1
#define POUND_PAIR_PEAKS pound_pairs_w1
#include "engine/run/pair_peaks.inl"
