/* normals_portable.c - normal deviates: one lane, any processor of this architecture. */
#define POUND_LANES   1
#define POUND_NORMALS pound_normals_portable
#include "engine/ground/normals.inl"
