/* pair_peaks_w4.c - linear bodies without contact: four lanes (AVX2). */
#define POUND_LANES      4
#define POUND_PAIR_PEAKS pound_pairs_w4
#include "engine/run/pair_peaks.inl"
