/* oscillator_bank_portable.c - the bank of oscillators: one lane, any processor of this architecture. */
#define POUND_LANES           1
#define POUND_OSCILLATOR_BANK pound_oscillator_bank_portable
#include "engine/floor/oscillator_bank.inl"
