/* chain_portable.c - chains: one lane, any processor of this architecture. */
#define POUND_LANES 1
#define POUND_CHAIN pound_chain_portable
#include "engine/exact/chain.inl"
