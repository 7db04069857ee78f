/* oscillator_bank_w4.c - the bank of oscillators: four lanes (AVX2). */
#define POUND_LANES           4
#define POUND_OSCILLATOR_BANK pound_oscillator_bank_w4
#include "engine/floor/oscillator_bank.inl"
