/* run_view.c - a second run that reads the values of a run while its blocks are still run, for intermediate results. */
#include "engine/run/run.h"

#include <assert.h>
#include <string.h>

/* Makes a run with the same design, rows, blocks and values, which it shares, and with reductions and a result of its own.
 *
 * Given    run     sampled; its blocks and reductions may run meanwhile; it must outlive the view
 *          n_workers   threads that reduce, at least 1
 *          stop    checked by the reductions of the view; NULL: never
 * Returns  value   for pound_run_rows_take, reductions, the result and pound_run_free; NULL: out of memory
 * Test     unit_growth: a_view_has_the_result_of_its_rows_while_the_run_goes_on
 */
struct pound_run *pound_run_view(const struct pound_run *run, int n_workers, const atomic_bool *stop)
{
	assert(pound_study_sampled(&run->study));
	struct pound_run *view = pound_run_piece(sizeof *view);
	if (!view)
		return NULL;
	// not run->rows and run->result, which may be changing: of the result only what is constant from the start
	view->view = true;
	view->stop = stop ? stop : &view->stopped;
	view->study = run->study;
	view->campaign = run->campaign;
	view->campaign.study = &view->study;
	view->layout = run->layout;
	view->layout.campaign = &view->campaign;
	view->u = run->u;
	view->result.split = run->result.split;
	view->scratch = pound_run_piece(sizeof *view->scratch * (size_t)(n_workers + 1)); // ends with NULL
	if (!view->scratch || !pound_run_result_create(view))
		goto fail;
	for (int w = 0; w < n_workers; w++) {
		// the scratch of many rows is not touched before it is needed
		view->scratch[w] = pound_run_room(sizeof(double) * pound_run_reduction_size(&view->campaign));
		if (!view->scratch[w])
			goto fail;
		memset(view->scratch[w], 0, sizeof(double) * pound_run_kept_size(&view->campaign));
	}
	const size_t n_records = (size_t)view->study.scene.excitation.n_records;
	if (n_records > 0) {
		memcpy(view->references, run->references, sizeof *view->references * 2 * n_records);
		view->result.differences = view->references + n_records;
	}
	if (run->campaign.references)
		view->campaign.references = view->result.references = view->references;
	return view;
fail:
	pound_run_free(view);
	return NULL;
}
