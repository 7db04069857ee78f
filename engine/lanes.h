/* lanes.h - W doubles side by side: GCC vectors for W = 4 and 8, plain doubles for W = 1.
 *
 * Every operation acts on each lane alone and rounds once, so the bits of a lane do not depend on W.
 * A mask has all bits of a lane set or none.  Arithmetic and comparisons are the vector types' own; the few operations
 * they do not have stand below for each width as the one instruction it has for them: left to be recognised from a
 * loop over the lanes they came out as dozens. */
#ifndef LANES_H
#define LANES_H

#include <math.h>
#include <stdint.h>

#ifndef POUND_LANES
#define POUND_LANES 1
#endif

enum { W = POUND_LANES };

#define LANE_INLINE static inline __attribute__((always_inline))

#if POUND_LANES == 1

typedef double vd;
typedef int64_t vi;
#define LANE_COMPARE(a, op, b) (-(vi)((a)op(b)))
#define LANE(x, l)             (*(&(x) + (l)))
#define LANE_SPLAT(x)          (x)
#define LANE_SELECT(m, a, b)   ((m) ? (a) : (b))
#define LANE_MAX(a, b)         ((a) < (b) ? (b) : (a))
#define LANE_MIN(a, b)         ((b) < (a) ? (b) : (a))
#define LANE_ABS(a)            fabs(a)
#define LANE_FMA(a, b, c)      __builtin_fma(a, b, c)
#define LANE_SQRT(a)           __builtin_sqrt(a)
#define LANE_ANY(m)            ((m) != 0)

#else

#include <immintrin.h>

typedef double vd __attribute__((vector_size(8 * POUND_LANES)));
typedef int64_t vi __attribute__((vector_size(8 * POUND_LANES)));
#define LANE_COMPARE(a, op, b) ((vi)((a)op(b)))
#define LANE(x, l)             ((x)[l])
#define LANE_ABS(a)            ((vd)((vi)(a)&INT64_MAX))

#if POUND_LANES == 4
#define LANE_SPLAT(x)        _mm256_set1_pd(x)
#define LANE_SELECT(m, a, b) _mm256_blendv_pd(b, a, (vd)(m))
#define LANE_MAX(a, b)       _mm256_max_pd(b, a)
#define LANE_MIN(a, b)       _mm256_min_pd(b, a)
#define LANE_FMA(a, b, c)    _mm256_fmadd_pd(a, b, c)
#define LANE_SQRT(a)         _mm256_sqrt_pd(a)
#define LANE_ANY(m)          (_mm256_movemask_pd((vd)(m)) != 0)
#else
#define LANE_SPLAT(x)        _mm512_set1_pd(x)
#define LANE_SELECT(m, a, b) _mm512_mask_blend_pd(_mm512_movepi64_mask((__m512i)(m)), b, a)
#define LANE_MAX(a, b)       _mm512_max_pd(b, a)
#define LANE_MIN(a, b)       _mm512_min_pd(b, a)
#define LANE_FMA(a, b, c)    _mm512_fmadd_pd(a, b, c)
#define LANE_SQRT(a)         _mm512_sqrt_pd(a)
#define LANE_ANY(m)          (_mm512_movepi64_mask((__m512i)(m)) != 0)
#endif

#endif

LANE_INLINE vd vsplat(double x)
{
	return LANE_SPLAT(x);
}

LANE_INLINE vi vless(vd a, vd b)
{
	return LANE_COMPARE(a, <, b);
}
LANE_INLINE vi vequal(vd a, vd b)
{
	return LANE_COMPARE(a, ==, b);
}
LANE_INLINE vi vless_index(vi a, vi b)
{
	return LANE_COMPARE(a, <, b);
}
LANE_INLINE vi vequal_index(vi a, vi b)
{
	return LANE_COMPARE(a, ==, b);
}

LANE_INLINE vd vselect(vi mask, vd a, vd b)
{
	return LANE_SELECT(mask, a, b);
}
LANE_INLINE int vany(vi mask)
{
	return LANE_ANY(mask);
}

LANE_INLINE vd vmax(vd a, vd b)
{
	return LANE_MAX(a, b);
} /* a where they are equal or not ordered */
LANE_INLINE vd vmin(vd a, vd b)
{
	return LANE_MIN(a, b);
}
LANE_INLINE vd vabs(vd a)
{
	return LANE_ABS(a);
}
LANE_INLINE vd vsqrt(vd a)
{
	return LANE_SQRT(a);
}
LANE_INLINE vd vfma(vd a, vd b, vd c)
{
	return LANE_FMA(a, b, c);
} /* a b + c, rounded once: the one fused operation */

/* Mask of one lane. */
LANE_INLINE vi vonly(int lane)
{
	vi r = {0};
	LANE(r, lane) = -1;
	return r;
}

#endif
