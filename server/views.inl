/* Included by workers.c: views of running studies, for partial results.
 *
 * A view reads blocks that are stored, which do not change any more, while the workers run others. */

/* Opens a view of a study whose run is in memory.
 *
 * Given    id      of the study
 *          n_reducers   threads that reduce
 *          stop    checked by the reductions of the view; NULL: never
 * Returns  view    for work_unview
 *          value   false: its run is not in memory, it is not sampled, or out of memory
 * Test     service_growth: the_first_results_so_far_of_a_large_study_are_made_of_few_rows
 */
bool work_view(struct work *work, int64_t id, int n_reducers, const atomic_bool *stop, struct work_view *view)
{
	struct job *job;
	*view = (struct work_view){.work = work, .n_reducers = n_reducers};
	pthread_mutex_lock(&work->lock);
	TAILQ_FOREACH(job, &work->jobs, others)
	if (job->id == id && job->opened && !job->ended && pound_study_sampled(job->of.study)) {
		job->n_views++;
		view->job = job;
		view->study = job->of.study;
		view->rows_done = pound_run_rows_done(job->of.run, job->of.stored);
		break;
	}
	pthread_mutex_unlock(&work->lock);
	if (view->job && !(view->run = pound_run_view(view->job->of.run, n_reducers, stop)))
		work_unview(view);
	return view->run;
}

void work_unview(struct work_view *view)
{
	if (!view->job)
		return;
	pound_run_free(view->run);
	pthread_mutex_lock(&view->work->lock);
	// the study may have ended meanwhile
	if (--view->job->n_views == 0 && view->job->finished)
		finish_if_complete(view->work, view->job);
	pthread_mutex_unlock(&view->work->lock);
	view->job = NULL;
}
