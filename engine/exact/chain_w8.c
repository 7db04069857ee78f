/* chain_w8.c - chains: eight lanes (AVX-512). */
#define POUND_LANES 8
#define POUND_CHAIN pound_chain_w8
#include "engine/exact/chain.inl"
