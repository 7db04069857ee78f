/* chain_w1.c - chains: one lane, with fused operations in hardware. */
#define POUND_LANES 1
#define POUND_CHAIN pound_chain_w1
#include "engine/exact/chain.inl"
