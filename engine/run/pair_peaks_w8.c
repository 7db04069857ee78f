/* pair_peaks_w8.c - linear bodies without contact: eight lanes (AVX-512). */
#define POUND_LANES      8
#define POUND_PAIR_PEAKS pound_pairs_w8
#include "engine/run/pair_peaks.inl"
