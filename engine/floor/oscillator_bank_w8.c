/* oscillator_bank_w8.c - the bank of oscillators: eight lanes (AVX-512). */
#define POUND_LANES           8
#define POUND_OSCILLATOR_BANK pound_oscillator_bank_w8
#include "engine/floor/oscillator_bank.inl"
