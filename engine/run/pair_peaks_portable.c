/* pair_peaks_portable.c - linear bodies without contact: one lane, any processor of this architecture. */
#define POUND_LANES      1
#define POUND_PAIR_PEAKS pound_pairs_portable
#include "engine/run/pair_peaks.inl"
