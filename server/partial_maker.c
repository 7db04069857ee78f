/* Partial results of studies.
 *
 *   request | fresh one kept?  else few rows | -> answer, at once
 *   maker              | all complete rows               | -> kept, for the next request
 *
 * 1. Every row changes all indices of all cells, so that a result of all rows costs as much as the end of the study: of the
 *    paper's campaign a twentieth of its time.  Nothing is made before it is asked for.
 * 2. The first request makes a result of so few rows that it takes about a tenth of a second, and has the maker make one of all.
 * 3. Later requests get the kept one; if it is not fresh any more, the maker makes a later one meanwhile.
 *
 * A study whose run is in memory is not read from the store. */
#include "server/partial_maker.h"

#include <stdlib.h>
#include <string.h>
#include <sys/resource.h>
#include <time.h>
#include <unistd.h>

#include "schema/result/result_json.h"
#include "server/http.h"
#include "server/log.h"

enum {
	MAKER_NICENESS = 5, /* between the answers and the workers */
	REDUCERS_MAX = 4,   /* threads of a request, for less than a tenth of a second */
};

static const double STOP_MAX = 0.3; /* [s] for the maker to exit */

const char *partial_source_open(struct server *server, int64_t id, const atomic_bool *stop,
                                struct partial_source *source)
{
	*source = (struct partial_source){0};
	const int workers = server->options->workers;
	if (work_view(server->work, id, workers < REDUCERS_MAX ? workers : REDUCERS_MAX, stop, &source->view)) {
		source->n_reducers = source->view.n_reducers;
		source->study = source->view.study;
		source->run = source->view.run;
		source->rows_done = source->view.rows_done;
		return NULL;
	}
	source->stored = true;
	source->n_reducers = 1;
	const char *error = stored_run_open(server->store, id, 1, stop, &source->opened);
	source->study = source->opened.study;
	source->run = source->opened.run;
	if (!error && pound_study_sampled(source->study))
		source->rows_done = pound_run_rows_done(source->run, source->opened.stored);
	return error;
}

void partial_source_close(struct partial_source *source)
{
	work_unview(&source->view);
	if (source->stored)
		stored_run_close(&source->opened);
}

/* The reductions of a run, shared by threads. */
struct reductions {
	struct pound_run *run;
	atomic_int next, status; /* the next to take; POUND_OK, or why one failed */
	atomic_int n_reducers;   /* the next worker number */
};

static void *reduce(void *of)
{
	struct reductions *all = of;
	const int worker = all->n_reducers++, n = pound_run_reductions(all->run);
	for (int k = all->next++; k < n && !all->status; k = all->next++) {
		const enum pound_status status = pound_run_reduce(all->run, k, worker);
		if (status)
			all->status = (int)status;
	}
	return NULL;
}

/* Makes all reductions in n threads at most, of which the caller is one. */
static enum pound_status reduce_all(struct pound_run *run, int n)
{
	struct reductions all = {.run = run};
	pthread_t threads[REDUCERS_MAX];
	int started = 0;
	while (started < n - 1 && pthread_create(&threads[started], NULL, reduce, &all) == 0)
		started++;
	reduce(&all);
	for (int t = 0; t < started; t++)
		pthread_join(threads[t], NULL);
	return (enum pound_status)all.status;
}

/* The result of the first rows, its body on the heap: NULL, if any status or out of memory; keeps a copy. */
static enum pound_status source_make(struct server *server, struct partial_source *source, int64_t id,
                                     int rows, struct partial_result *made)
{
	const double start = stored_run_clock();
	*made = (struct partial_result){.id = id, .rows = rows, .ended = source->ended};
	pound_run_rows_take(source->run, rows);
	pound_run_rows_complete(source->run, source->rows_done);
	// one thread for all rows, of which its CPU time is the time that it took
	const enum pound_status status =
	    reduce_all(source->run, rows < source->rows_done ? source->n_reducers : 1);
	if (!status)
		made->body = result_to_json(source->study, pound_run_result(source->run), NULL, &made->length);
	if (made->body)
		partial_results_give(&server->partials, made,
		                     rows < source->rows_done ? 0 : stored_run_clock() - start);
	return status;
}

/* Makes the result of all complete rows of a study, to be kept; a failure leaves it to the next request. */
static void make_whole(struct partial_maker *maker, int64_t id)
{
	struct partial_source source;
	struct partial_result made = {0};
	if (!partial_source_open(maker->server, id, &maker->stopping, &source) && source.rows_done > 0)
		source_make(maker->server, &source, id, source.rows_done, &made);
	partial_source_close(&source);
	free(made.body);
}

static void *make(void *of)
{
	struct partial_maker *maker = of;
	setpriority(PRIO_PROCESS, (id_t)gettid(), MAKER_NICENESS);
	pthread_mutex_lock(&maker->lock);
	while (!maker->stopping) {
		if (maker->n_wanted == 0) {
			pthread_cond_wait(&maker->changed, &maker->lock);
			continue;
		}
		const int64_t id = maker->busy = maker->wanted[0];
		memmove(maker->wanted, maker->wanted + 1, sizeof maker->wanted[0] * (size_t)--maker->n_wanted);
		pthread_mutex_unlock(&maker->lock);
		make_whole(maker, id);
		pthread_mutex_lock(&maker->lock);
		maker->busy = 0;
	}
	pthread_mutex_unlock(&maker->lock);
	return NULL;
}

bool partial_maker_start(struct partial_maker *maker, struct server *server)
{
	maker->server = server;
	pthread_mutex_init(&maker->lock, NULL);
	pthread_cond_init(&maker->changed, NULL);
	maker->started = pthread_create(&maker->thread, NULL, make, maker) == 0;
	if (!maker->started)
		log_line("cannot start the thread that makes partial results");
	return maker->started;
}

/* Has the result of all complete rows of a study made, unless too many wait. */
static void want(struct partial_maker *maker, int64_t id)
{
	pthread_mutex_lock(&maker->lock);
	bool waits = maker->busy == id || maker->n_wanted == PARTIAL_RESULTS;
	for (int i = 0; i < maker->n_wanted; i++)
		waits |= maker->wanted[i] == id;
	if (!waits)
		maker->wanted[maker->n_wanted++] = id;
	pthread_cond_signal(&maker->changed);
	pthread_mutex_unlock(&maker->lock);
}

/* Test     service_growth: the_first_results_so_far_of_a_large_study_are_made_of_few_rows */
enum pound_status partial_maker_soon(struct partial_maker *maker, struct partial_source *source, int64_t id,
                                     struct partial_result *result)
{
	const int done = source->rows_done, quick = pound_run_rows_quick(source->run),
	          rows = source->ended || done < quick ? done : quick;
	enum pound_status status = POUND_OK;
	if (!result->body || result->rows < rows || (source->ended && !result->ended)) {
		if (rows > quick)
			setpriority(PRIO_PROCESS, (id_t)gettid(), MAKER_NICENESS);
		free(result->body);
		status = source_make(maker->server, source, id, rows, result);
		maker->values += (unsigned long long)rows * (unsigned)pound_run_samples(source->run) *
		                 (unsigned)pound_run_reductions(source->run);
	}
	if (result->body && result->rows < done)
		want(maker, id);
	return status;
}

bool partial_maker_stop(struct partial_maker *maker)
{
	if (!maker->started)
		return true;
	pthread_mutex_lock(&maker->lock);
	maker->stopping = true;
	pthread_cond_signal(&maker->changed);
	pthread_mutex_unlock(&maker->lock);
	// CLOCK_REALTIME, as in work_stop
	struct timespec until;
	clock_gettime(CLOCK_REALTIME, &until);
	until.tv_nsec += (long)(1e9 * STOP_MAX);
	until.tv_sec += until.tv_nsec / 1000000000;
	until.tv_nsec %= 1000000000;
	return pthread_timedjoin_np(maker->thread, NULL, &until) == 0;
}
