/* The run of a stored study. */
#include "server/stored_run.h"

#include <stdlib.h>
#include <time.h>

#include "schema/json/problems.h"
#include "schema/study/study_json.h"
#include "server/records.h"

/* CPU time of this thread [s]. */
double stored_run_clock(void)
{
	struct timespec now;
	clock_gettime(CLOCK_THREAD_CPUTIME_ID, &now);
	return (double)now.tv_sec + 1e-9 * (double)now.tv_nsec;
}

static bool restore(void *to, const struct store_block *block)
{
	struct stored_run *opened = to;
	bool goes_on = !pound_run_stopped(opened->run);
	if (block->number >= pound_run_blocks_most(opened->run) ||
	    (size_t)block->n != pound_run_block_size(opened->run, block->number))
		return goes_on;
	pound_run_block_restore(opened->run, block->number, block->values);
	opened->stored[block->number] = true;
	opened->cpu_s += block->cpu_s;
	opened->wall_s = block->wall_s > opened->wall_s ? block->wall_s : opened->wall_s;
	return goes_on;
}

/* Makes the run of a stored study and restores its stored blocks, until it is stopped.
 *
 * Given    id          of the study
 *          n_workers   workers that will run its blocks
 * Returns  opened      closed by stored_run_close, even after a failure
 *          value       NULL, or why it failed
 * Memory   allocates
 * Test     service_resume: a_killed_study_goes_on_to_the_same_bytes_without_running_stored_blocks_again
 */
const char *stored_run_open(struct store *store, int64_t id, int n_workers, const atomic_bool *stop,
                            struct stored_run *opened)
{
	*opened = (struct stored_run){0};
	enum store_status found = store_document(store, id, "request", &opened->document, &opened->length);
	opened->passing = found == STORE_FAILED;
	if (found != STORE_OK)
		return "the stored study could not be read";
	struct problems problems;
	opened->study = records_study(store, opened->document, opened->length, &problems);
	if (!opened->study && problems.status != PROBLEMS_NOMEM)
		return "this version does not accept the study";
	opened->passing = true;
	if (opened->study && study_names_files(opened->document, opened->length)) {
		// worker groups do not have the files
		char *whole = records_inline(store, opened->document, &opened->length, opened->study);
		free(opened->document);
		opened->document = whole;
		if (!whole)
			return "out of memory";
	}
	opened->run = opened->study ? pound_run_create_by(opened->study, n_workers, stop) : NULL;
	if (!opened->run)
		return "out of memory";
	pound_run_clock(opened->run, stored_run_clock);
	pound_run_stop_by(opened->run, stop);
	opened->stored = calloc((size_t)pound_run_blocks_most(opened->run), sizeof *opened->stored);
	if (!opened->stored)
		return "out of memory";
	found = store_blocks(store, id, restore, opened);
	opened->leftovers = found == STORE_CORRUPT;
	return found == STORE_FAILED ? "the stored blocks could not be read" : NULL;
}

/* The number of blocks of the current rows that are not stored. */
int stored_run_left(const struct stored_run *opened)
{
	int n = 0;
	for (int block = pound_run_blocks(opened->run) - 1; block >= 0; block--)
		n += !opened->stored[block];
	return n;
}

/* Frees what stored_run_open made. */
void stored_run_close(struct stored_run *opened)
{
	if (opened->run)
		pound_run_free(opened->run);
	if (opened->study)
		study_free(opened->study);
	free(opened->stored);
	free(opened->document);
}
