/* oscillator_bank_w1.c - the bank of oscillators: one lane, with fused multiply-add. */
#define POUND_LANES           1
#define POUND_OSCILLATOR_BANK pound_oscillator_bank_w1
#include "engine/floor/oscillator_bank.inl"
