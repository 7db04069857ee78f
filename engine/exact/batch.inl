/* batch.inl - a batch of simulations: loads their rows into lanes, stores them back, and finds lanes by trait.
 *
 * Included by exact.inl alone, once per lane count.
 *
 * Included by exact.inl after shared_start.inl. */

#include "engine/numeric/lanes.h"

/* simulations that share the lanes; lanes from n on hold the filler */
struct batch {
	int n;
	struct simulation *sim[W];
	double *row[W];
	unsigned traits;    /* union of their traits */
	struct queue *from; /* the queue they were taken from: scheduler.inl */
};

/* The lanes in use. */
static unsigned batch_lanes(const struct batch *b)
{
	return (1u << b->n) - 1;
}

/* Removes the lowest lane from a set that is not empty. */
static int lane_next(unsigned *lanes)
{
	int l = __builtin_ctz(*lanes);
	*lanes &= *lanes - 1;
	return l;
}

/* Loads one row of every simulation into lanes, or stores it back. */
LANE_INLINE void lanes_fill(struct lanes *g, const struct batch *b, int at)
{
	rows_load((vd *)g + at, (const double *const *)b->row, at);
}
LANE_INLINE void lanes_empty(const struct lanes *g, const struct batch *b, int at)
{
	rows_store((const vd *)g + at, b->row, at);
}

/* Loads one row of constants into lanes.
 *
 * Given    common  rows shared by all simulations; NULL: the rows may differ
 */
LANE_INLINE void lanes_constant(struct lanes *g, const struct batch *b, const struct state_rows *common,
                                int at)
{
	if (!common) {
		lanes_fill(g, b, at);
		return;
	}
	for (int j = at; j < at + ROW; j++)
		((vd *)g)[j] = vsplat(((const double *)common)[j]);
}

/* Lanes of simulations with a trait. */
LANE_INLINE vm batch_trait(const struct batch *b, unsigned trait)
{
	unsigned lanes = 0;
	for (int l = 0; l < W; l++)
		lanes |= (unsigned)((b->sim[l]->traits & trait) != 0) << l;
	return vmask(lanes);
}

/* Lanes that run several tasks at once and in which a branch edge decided the step: it is undone, and a task leaves. */
static unsigned batch_leaving(const struct batch *b, vm decided)
{
	if (!(b->traits & TRAIT_SHARED))
		return 0;
	return vbits(decided & batch_trait(b, TRAIT_SHARED)) & batch_lanes(b);
}

/* Discards the results of these lanes: their rows are stored to the filler. */
static void batch_forget(struct batch *b, unsigned lanes, struct simulation *filler)
{
	while (lanes)
		b->row[lane_next(&lanes)] = (double *)&filler->x;
}

/* Lanes whose bodies overlap without force, and lanes in which the force has just passed zero. */
LANE_INLINE void batch_forces(const struct batch *b, vm *released, vm *fresh)
{
	unsigned gone = 0, passed = 0;
	for (int l = 0; l < W; l++) {
		gone |= (unsigned)b->sim[l]->released << l;
		passed |= (unsigned)b->sim[l]->fresh << l;
	}
	*released = vmask(gone);
	*fresh = vmask(passed);
}
