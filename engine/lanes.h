/* lanes.h - W doubles side by side: GCC vectors for W = 4 and 8, plain doubles for W = 1.
 *
 * Every operation acts on each lane alone and rounds once, so the bits of a lane do not depend on W.
 * A mask has all bits of a lane set or none.  vfma is the one fused operation of the engine. */
#ifndef LANES_H
#define LANES_H

#include <math.h>
#include <stdint.h>

#ifndef POUND_LANES
#define POUND_LANES 1
#endif

enum { W = POUND_LANES };

#if POUND_LANES == 1
typedef double vd;
typedef int64_t vi;
#define LANE_COMPARE(a, op, b) (-(vi)((a)op(b)))
#define LANE(x, l)             (*(&(x) + (l)))
#else
typedef double vd __attribute__((vector_size(8 * POUND_LANES)));
typedef int64_t vi __attribute__((vector_size(8 * POUND_LANES)));
#define LANE_COMPARE(a, op, b) ((vi)((a)op(b)))
#define LANE(x, l)             ((x)[l])
#endif

#define LANE_INLINE static inline __attribute__((always_inline))

LANE_INLINE vd vsplat(double x)
{
	vd r = {0};
	for (int l = 0; l < W; l++)
		LANE(r, l) = x;
	return r;
}

LANE_INLINE vi vless(vd a, vd b)
{
	return LANE_COMPARE(a, <, b);
}
LANE_INLINE vi vequal(vd a, vd b)
{
	return LANE_COMPARE(a, ==, b);
}

LANE_INLINE vd vselect(vi mask, vd a, vd b)
{
	vd r = {0};
	for (int l = 0; l < W; l++)
		LANE(r, l) = LANE(mask, l) ? LANE(a, l) : LANE(b, l);
	return r;
}

/* Mask of one lane. */
LANE_INLINE vi vonly(int lane)
{
	vi r = {0};
	for (int l = 0; l < W; l++)
		LANE(r, l) = -(int64_t)(l == lane);
	return r;
}

LANE_INLINE vi vselect_mask(vi mask, vi a, vi b)
{
	return (a & mask) | (b & ~mask);
}

LANE_INLINE vd vmax(vd a, vd b)
{
	vd r = {0};
	for (int l = 0; l < W; l++)
		LANE(r, l) = LANE(a, l) < LANE(b, l) ? LANE(b, l) : LANE(a, l);
	return r;
}

LANE_INLINE vd vmin(vd a, vd b)
{
	vd r = {0};
	for (int l = 0; l < W; l++)
		LANE(r, l) = LANE(b, l) < LANE(a, l) ? LANE(b, l) : LANE(a, l);
	return r;
}

LANE_INLINE vd vabs(vd a)
{
#if POUND_LANES == 1
	return fabs(a);
#else
	return (vd)((vi)a & INT64_MAX);
#endif
}

LANE_INLINE vd vfma(vd a, vd b, vd c)
{
	vd r = {0};
	for (int l = 0; l < W; l++)
		LANE(r, l) = __builtin_fma(LANE(a, l), LANE(b, l), LANE(c, l));
	return r;
}

LANE_INLINE vd vsqrt(vd a)
{
	vd r = {0};
	for (int l = 0; l < W; l++)
		LANE(r, l) = __builtin_sqrt(LANE(a, l));
	return r;
}

LANE_INLINE int vany(vi mask)
{
	int64_t r = 0;
	for (int l = 0; l < W; l++)
		r |= LANE(mask, l);
	return r != 0;
}

#endif
