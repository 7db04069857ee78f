/* baseline_chain.h - rows of shear buildings by a plain time-stepping loop: the baseline for the speed of
 * chains.
 *
 * Never linked into the product.  SI units; calls may run in any thread. */
#ifndef BASELINE_CHAIN_H
#define BASELINE_CHAIN_H

#include "engine/exact/chain.h"

/* Largest drifts of all stories [m]  (n_floors), by `steps` equal steps from each sample to the next.
 *
 * Given    yields  elastoplastic stories with kinematic hardening; else linear ones */
void baseline_chain_linear(const struct pound_chain_task *task, int steps, double *drift_max);
void baseline_chain_yielding(const struct pound_chain_task *task, int steps, double *drift_max);

#endif
