/* chain_w4.c - chains: four lanes (AVX2). */
#define POUND_LANES 4
#define POUND_CHAIN pound_chain_w4
#include "engine/exact/chain.inl"
