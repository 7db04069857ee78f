/* oscillator_bank_portable.c - the bank of oscillators: one lane, any processor of this architecture. */
#define POUND_LANES    1
#define POUND_SPECTRUM pound_spectrum_portable
#include "engine/floor/oscillator_bank.inl"
