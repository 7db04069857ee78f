/* bootstrap_sums.inl - rows drawn with replacement, and sums over them.
 *
 * 1. The segment of each draw is drawn first, then the rows within the segments: the same distribution as drawing from
 *    all rows, but a segment is read from memory only once per group of resamples, however many rows there are.
 * 2. The rows drawn are a function of (seed, resample) alone. */
#include "engine/indices/bootstrap_sums.h"

#include "engine/numeric/lanes.h"
#include "engine/numeric/random.h"
#include "engine/numeric/stop.h"

#include <string.h>

// the tiles of a segment stay in the cache while its rows are drawn
enum {
	SEGMENT = 1024,
	SEGMENTS_MAX = POUND_RESAMPLE_ROWS_MAX / SEGMENT,
	GROUP = POUND_RESAMPLE_GROUP,
	DRAWS_PER_WORD_MAX = 8,
};

/* A sequence of random integers below n; several from each 64-bit word. */
struct draws {
	philox4x64_key_t key;
	philox4x64_ctr_t counter;
	uint64_t n, surplus;
	int per_word;
};

/* Draws below n from a random stream of their own.
 *
 * A word w yields hi(w n), then hi(lo(w n) n), and so on, as long as n^k leaves ten bits to spare; words whose last low
 * half is below 2^64 mod n^k are rejected, so that all numbers are equally likely.
 *
 * Source   Brackett-Rozinsky, Lemire 2024, Softw. Pract. Exper. 55(1), 66-77
 * Test     unit_bootstrap: rows_are_drawn_as_often_as_a_multinomial_says
 */
static struct draws draws_below(int n, uint64_t seed, int resample, int segment)
{
	struct draws draws = {.key = {{seed, 0}},
	                      .counter = {{0, segment, resample, POUND_STREAM_BOOTSTRAP}},
	                      .n = n,
	                      .per_word = 1};
	uint64_t power = n;
	for (; draws.per_word < DRAWS_PER_WORD_MAX && power <= (UINT64_C(1) << 54) / n; power *= n)
		draws.per_word++;
	draws.surplus = -power % power;
	return draws;
}

/* Fills at least `wanted` further draws; surplus draws are not used.  draw: (wanted + 4 DRAWS_PER_WORD_MAX) */
static void draws_fill(struct draws *draws, int wanted, uint32_t *draw)
{
	const uint64_t n = draws->n;
	const int per_word = draws->per_word;
	for (int have = 0; have < wanted; draws->counter.v[0]++) {
		const philox4x64_ctr_t words = philox4x64_R(10, draws->counter, draws->key);
		for (int k = 0; k < 4; k++) {
			uint64_t word = words.v[k], high;
			for (int i = 0; i < per_word; i++) {
				word = mulhilo64(word, n, &high);
				draw[have + i] = (uint32_t)high;
			}
			have += word >= draws->surplus ? per_word : 0;
		}
	}
}

// vectors of a tile's row; every column has its own lane, so that the vector width changes no sum
typedef double columns __attribute__((vector_size(W > 1 ? 8 * W : 16), may_alias));
enum { VECTORS = POUND_TILE * sizeof(double) / sizeof(columns) };

/* Adds the drawn rows of one tile to a sum; even and odd draws are summed separately, to hide the adder's latency. */
static void tile_add(const double *tile, const uint32_t *draw, int n, double *sum)
{
	const columns *row = (const columns *)tile;
	columns even[VECTORS] = {{0}}, odd[VECTORS] = {{0}}, *to = (columns *)sum;
	int i = 0;
	for (; i + 1 < n; i += 2) {
		const columns *p = row + (size_t)draw[i] * VECTORS, *q = row + (size_t)draw[i + 1] * VECTORS;
		for (int k = 0; k < VECTORS; k++) {
			even[k] += p[k];
			odd[k] += q[k];
		}
	}
	for (int k = 0; k < VECTORS && i < n; k++)
		even[k] += row[(size_t)draw[i] * VECTORS + k];
	for (int k = 0; k < VECTORS; k++)
		to[k] += even[k] + odd[k];
}

/* Number of a resample's draws in each segment of rows. */
static void segment_shares(int n_rows, uint64_t seed, int resample, int *share)
{
	uint32_t draw[SEGMENT + 4 * DRAWS_PER_WORD_MAX];
	struct draws draws = draws_below(n_rows, seed, resample, 0);
	memset(share, 0, sizeof *share * SEGMENTS_MAX);
	for (int left = n_rows; left > 0; left -= SEGMENT) {
		int n = left < SEGMENT ? left : SEGMENT;
		draws_fill(&draws, n, draw);
		for (int i = 0; i < n; i++)
			share[draw[i] / SEGMENT]++;
	}
}

/* Adds a resample's rows of one segment to its sums. */
static void segment_add(const struct pound_tiles *tiles, int segment, uint64_t seed, int resample, int share,
                        double *sum)
{
	const int first = segment * SEGMENT, rows = tiles->n_rows - first;
	uint32_t draw[SEGMENT + 4 * DRAWS_PER_WORD_MAX];
	struct draws draws = draws_below(rows < SEGMENT ? rows : SEGMENT, seed, resample, 1 + segment);
	for (int left = share; left > 0; left -= SEGMENT) {
		int n = left < SEGMENT ? left : SEGMENT;
		draws_fill(&draws, n, draw);
		for (int t = 0; t < tiles->n_tiles; t++)
			tile_add(tiles->tile + ((size_t)t * tiles->n_rows + first) * POUND_TILE, draw, n,
			         sum + POUND_TILE * t);
	}
}

/* Sums over a group of resamples of the rows: see the header.
 *
 * Test     unit_bootstrap: sums_are_the_same_bits_at_any_width
 */
void POUND_BOOTSTRAP_SUMS(const struct pound_tiles *tiles, uint64_t seed, int first, double *sum)
{
	const int segments = (tiles->n_rows + SEGMENT - 1) / SEGMENT, width = tiles->n_tiles * POUND_TILE;
	int share[GROUP][SEGMENTS_MAX];
	memset(sum, 0, sizeof *sum * GROUP * (size_t)width);
	for (int g = 0; g < GROUP && !pound_stopped(tiles->stop); g++)
		if (segments > 1)
			segment_shares(tiles->n_rows, seed, first + g, share[g]);
		else
			share[g][0] = tiles->n_rows;
	for (int s = 0; s < segments && !pound_stopped(tiles->stop); s++)
		for (int g = 0; g < GROUP; g++)
			segment_add(tiles, s, seed, first + g, share[g][s], sum + (size_t)g * width);
	lanes_leave();
}
