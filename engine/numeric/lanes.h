/* lanes.h - vectors of W doubles, one per lane: GCC vectors for W = 4 and 8, plain doubles for W = 1.
 *
 * Every operation acts on each lane separately and rounds once, so the bits of a lane do not depend on W.
 * Arithmetic uses the operators of the vector types; comparisons give masks, which have & | ~ and the functions below.
 * Operations without an operator are intrinsics for each width: from a loop over the lanes compilers make dozens of
 * instructions. */
#ifndef LANES_H
#define LANES_H

#include <math.h>
#include <stdint.h>

#ifndef POUND_LANES
#define POUND_LANES 1
#endif

enum {
	W = POUND_LANES,
	ROW = 8, /* doubles that rows_load and rows_store move per lane: a cache line */
};

#define LANE_INLINE static inline __attribute__((always_inline))
/* not inlined: one copy of a large function stays in the instruction cache, and rare code does not fill it */
#define LANE_SHARED static __attribute__((noinline))

#if POUND_LANES == 1

typedef double vd;
typedef uint64_t vu;
typedef uint64_t vm;
#define LANE_SPLAT(x)        (x)
#define LANE_LESS(a, b)      (-(vm)((a) < (b)))
#define LANE_EQUAL(a, b)     (-(vm)((a) == (b)))
#define LANE_SELECT(m, a, b) ((m) ? (a) : (b))
#define LANE_MAX(a, b)       ((a) < (b) ? (b) : (a))
#define LANE_MIN(a, b)       ((b) < (a) ? (b) : (a))
#define LANE_ABS(a)          fabs(a)
#define LANE_FMA(a, b, c)    __builtin_fma(a, b, c)
#define LANE_SQRT(a)         __builtin_sqrt(a)
#define LANE_FLOOR(a)        __builtin_floor(a)
#define LANE_ADD(m, at, n)   ((at) + ((m) & (n)))
#define LANE_GATHER(at)      (*(const double *)(at))
#define LANE_EACH(x)         (x)[0]
#define LANE_BITS(m)         ((unsigned)(m)&1)
#define LANE_MASK(bits)      (-(vm)((bits)&1))
#define LANE_PRODUCT(a, b)   (((a)&UINT32_MAX) * ((b)&UINT32_MAX))
#define LANE_ABOVE(a, b)     ((void)(a), (b))
#define LANE_BELOW(a, b)     ((void)(b), (a))

#else

#include <immintrin.h>

typedef double vd __attribute__((vector_size(8 * POUND_LANES)));
typedef uint64_t vu __attribute__((vector_size(8 * POUND_LANES)));
#define LANE_ABS(a)    ((vd)((lane_bits)(a)&INT64_MAX))
typedef int64_t lane_bits __attribute__((vector_size(8 * POUND_LANES)));
#define LANE_AT(at, l) (*(const double *)(at)[l]) /* a gather instruction takes twice as long */

#if POUND_LANES == 4
typedef lane_bits vm;
#define LANE_SPLAT(x)        _mm256_set1_pd(x)
#define LANE_LESS(a, b)      ((vm)((a) < (b)))
#define LANE_EQUAL(a, b)     ((vm)((a) == (b)))
#define LANE_SELECT(m, a, b) _mm256_blendv_pd(b, a, (vd)(m))
#define LANE_MAX(a, b)       _mm256_max_pd(b, a)
#define LANE_MIN(a, b)       _mm256_min_pd(b, a)
#define LANE_FMA(a, b, c)    _mm256_fmadd_pd(a, b, c)
#define LANE_SQRT(a)         _mm256_sqrt_pd(a)
#define LANE_FLOOR(a)        _mm256_floor_pd(a)
#define LANE_ADD(m, at, n)   ((at) + ((vu)(m) & (n)))
#define LANE_GATHER(at)      _mm256_set_pd(LANE_AT(at, 3), LANE_AT(at, 2), LANE_AT(at, 1), LANE_AT(at, 0))
#define LANE_EACH(x)         (x)[0], (x)[1], (x)[2], (x)[3]
#define LANE_BITS(m)         ((unsigned)_mm256_movemask_pd((vd)(m)))
#define LANE_MASK(bits)      (((vm)_mm256_set1_epi64x(bits) & (vm){1, 2, 4, 8}) == (vm){1, 2, 4, 8})
#define LANE_PRODUCT(a, b)   ((vu)_mm256_mul_epu32((__m256i)(a), (__m256i)(b)))
#define LANE_ABOVE(a, b)     _mm256_shuffle_pd(a, _mm256_permute2f128_pd(a, b, 0x21), 0x5)
#define LANE_BELOW(a, b)     _mm256_shuffle_pd(_mm256_permute2f128_pd(a, b, 0x21), b, 0x5)
#else
typedef __mmask8 vm;
#define LANE_SPLAT(x)        _mm512_set1_pd(x)
#define LANE_LESS(a, b)      _mm512_cmp_pd_mask(a, b, _CMP_LT_OQ)
#define LANE_EQUAL(a, b)     _mm512_cmp_pd_mask(a, b, _CMP_EQ_OQ)
#define LANE_SELECT(m, a, b) _mm512_mask_blend_pd(m, b, a)
#define LANE_MAX(a, b)       _mm512_max_pd(b, a)
#define LANE_MIN(a, b)       _mm512_min_pd(b, a)
#define LANE_FMA(a, b, c)    _mm512_fmadd_pd(a, b, c)
#define LANE_SQRT(a)         _mm512_sqrt_pd(a)
#define LANE_FLOOR(a)        _mm512_roundscale_pd(a, _MM_FROUND_TO_NEG_INF)
#define LANE_ADD(m, at, n) \
	((vu)_mm512_mask_add_epi64((__m512i)(at), m, (__m512i)(at), _mm512_set1_epi64((int64_t)(n))))
#define LANE_GATHER(at)                                                                           \
	_mm512_set_pd(LANE_AT(at, 7), LANE_AT(at, 6), LANE_AT(at, 5), LANE_AT(at, 4), LANE_AT(at, 3), \
	              LANE_AT(at, 2), LANE_AT(at, 1), LANE_AT(at, 0))
#define LANE_EACH(x)       (x)[0], (x)[1], (x)[2], (x)[3], (x)[4], (x)[5], (x)[6], (x)[7]
#define LANE_BITS(m)       ((unsigned)(m))
#define LANE_MASK(bits)    ((vm)(bits))
#define LANE_PRODUCT(a, b) ((vu)_mm512_mul_epu32((__m512i)(a), (__m512i)(b)))
#define LANE_ABOVE(a, b)   ((vd)_mm512_alignr_epi64((__m512i)(b), (__m512i)(a), 1))
#define LANE_BELOW(a, b)   ((vd)_mm512_alignr_epi64((__m512i)(b), (__m512i)(a), 7))
#endif

#endif

LANE_INLINE vd vsplat(double x)
{
	return LANE_SPLAT(x);
}

LANE_INLINE vm vless(vd a, vd b)
{
	return LANE_LESS(a, b);
}
LANE_INLINE vm vequal(vd a, vd b)
{
	return LANE_EQUAL(a, b);
}

LANE_INLINE vd vselect(vm mask, vd a, vd b)
{
	return LANE_SELECT(mask, a, b);
}
/* bit l: lane l */
LANE_INLINE unsigned vbits(vm mask)
{
	return LANE_BITS(mask);
}
LANE_INLINE vm vmask(unsigned bits)
{
	return LANE_MASK(bits);
}
LANE_INLINE int vany(vm mask)
{
	return vbits(mask) != 0;
}

/* maximum and minimum: a if both are equal or one is NAN */
LANE_INLINE vd vmax(vd a, vd b)
{
	return LANE_MAX(a, b);
}
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
LANE_INLINE vd vfloor(vd a)
{
	return LANE_FLOOR(a);
}
/* a b + c, rounded once; no other operation is fused */
LANE_INLINE vd vfma(vd a, vd b, vd c)
{
	return LANE_FMA(a, b, c);
}

/* product of the lower 32 bits of each lane */
LANE_INLINE vu vproduct(vu a, vu b)
{
	return LANE_PRODUCT(a, b);
}

/* ---- shifts by one lane: b follows a in memory ---- */

/* Each lane gets the next element of a; the last lane gets the first element of b. */
LANE_INLINE vd vabove(vd a, vd b)
{
	return LANE_ABOVE(a, b);
}
/* Each lane gets the previous element of b; the first lane gets the last element of a. */
LANE_INLINE vd vbelow(vd a, vd b)
{
	return LANE_BELOW(a, b);
}

/* ---- addresses of doubles, one per lane ---- */

/* Addresses, moved on by one double in the lanes of a mask. */
LANE_INLINE vu vnext(vm mask, vu at)
{
	return LANE_ADD(mask, at, sizeof(double));
}
LANE_INLINE vd vgather(vu at)
{
	return LANE_GATHER(at);
}

/* ---- ROW doubles per lane to and from memory: lane l of vector j is row[l][at + j] ---- */

#if POUND_LANES == 8

/* Transposes: lane l of vector j becomes lane j of vector l. */
LANE_INLINE void lanes_transpose(vd x[8])
{
	vd pair[8], four[8];
	for (int j = 0; j < 8; j += 2) {
		pair[j] = _mm512_unpacklo_pd(x[j], x[j + 1]);
		pair[j + 1] = _mm512_unpackhi_pd(x[j], x[j + 1]);
	}
	for (int j = 0; j < 8; j += 4)
		for (int k = 0; k < 2; k++) {
			four[j + k] = _mm512_shuffle_f64x2(pair[j + k], pair[j + k + 2], 0x88);
			four[j + k + 2] = _mm512_shuffle_f64x2(pair[j + k], pair[j + k + 2], 0xdd);
		}
	for (int k = 0; k < 4; k++) {
		x[k] = _mm512_shuffle_f64x2(four[k], four[k + 4], 0x88);
		x[k + 4] = _mm512_shuffle_f64x2(four[k], four[k + 4], 0xdd);
	}
}

LANE_INLINE void rows_load(vd to[ROW], const double *const row[W], int at)
{
	for (int l = 0; l < W; l++)
		to[l] = _mm512_loadu_pd(row[l] + at);
	lanes_transpose(to);
}

LANE_INLINE void rows_store(const vd from[ROW], double *const row[W], int at)
{
	vd x[8];
	for (int j = 0; j < 8; j++)
		x[j] = from[j];
	lanes_transpose(x);
	for (int l = 0; l < W; l++)
		_mm512_storeu_pd(row[l] + at, x[l]);
}

#elif POUND_LANES == 4

LANE_INLINE void lanes_transpose(vd x[4])
{
	vd a = _mm256_unpacklo_pd(x[0], x[1]), b = _mm256_unpackhi_pd(x[0], x[1]);
	vd c = _mm256_unpacklo_pd(x[2], x[3]), d = _mm256_unpackhi_pd(x[2], x[3]);
	x[0] = _mm256_permute2f128_pd(a, c, 0x20);
	x[1] = _mm256_permute2f128_pd(b, d, 0x20);
	x[2] = _mm256_permute2f128_pd(a, c, 0x31);
	x[3] = _mm256_permute2f128_pd(b, d, 0x31);
}

LANE_INLINE void rows_load(vd to[ROW], const double *const row[W], int at)
{
	for (int half = 0; half < ROW; half += W) {
		for (int l = 0; l < W; l++)
			to[half + l] = _mm256_loadu_pd(row[l] + at + half);
		lanes_transpose(to + half);
	}
}

LANE_INLINE void rows_store(const vd from[ROW], double *const row[W], int at)
{
	for (int half = 0; half < ROW; half += W) {
		vd x[4] = {from[half], from[half + 1], from[half + 2], from[half + 3]};
		lanes_transpose(x);
		for (int l = 0; l < W; l++)
			_mm256_storeu_pd(row[l] + at + half, x[l]);
	}
}

#else

LANE_INLINE void rows_load(vd to[ROW], const double *const row[W], int at)
{
	for (int j = 0; j < ROW; j++)
		to[j] = row[0][at + j];
}

LANE_INLINE void rows_store(const vd from[ROW], double *const row[W], int at)
{
	for (int j = 0; j < ROW; j++)
		row[0][at + j] = from[j];
}

#endif

/* Call before returning to code of another width: nonzero upper halves of registers slow that code down, and the compiler
 * does not always clear them at the end of long functions. */
LANE_INLINE void lanes_leave(void)
{
#if POUND_LANES > 1
	_mm256_zeroupper();
#endif
}

/* A vector to and from memory. */
LANE_INLINE void lanes_store(double to[W], vd x)
{
	__builtin_memcpy(to, &x, sizeof x);
}
LANE_INLINE vd lanes_load(const double from[W])
{
	vd x;
	__builtin_memcpy(&x, from, sizeof x);
	return x;
}

/* A vector of numbers that were just computed one by one: a vector load would wait until all of them are stored. */
LANE_INLINE vd lanes_of(const double x[W])
{
	return (vd){LANE_EACH(x)};
}
LANE_INLINE vu lanes_at(const uint64_t x[W])
{
	return (vu){LANE_EACH(x)};
}

#endif
