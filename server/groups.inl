/* Included by workers.c, after `take` and `hand_over`: the callbacks of the coordinator of worker groups, called in its threads.
 *
 * A block that a group has keeps its study in memory, but does not delay its end: a late block is run elsewhere too. */

static bool groups_wanted(void *of)
{
	struct work *work = of;
	bool wanted = false;
	pthread_mutex_lock(&work->lock);
	struct job *job;
	TAILQ_FOREACH(job, &work->jobs, others)
	wanted |= job->opened && !job->ended && job->movable &&
	          assignment_next(&job->blocks, pound_run_blocks(job->of.run), ASSIGNMENT_HERE,
	                          seconds(CLOCK_MONOTONIC)) >= 0;
	pthread_mutex_unlock(&work->lock);
	return wanted;
}

static bool groups_lives(void *of, uint64_t study)
{
	struct work *work = of;
	bool lives = false;
	pthread_mutex_lock(&work->lock);
	const struct job *job;
	TAILQ_FOREACH(job, &work->jobs, others)
	lives |= job->known.id == study && !job->ended;
	pthread_mutex_unlock(&work->lock);
	return lives;
}

static bool groups_take(void *of, int group, const uint64_t refused[], int n_refused,
                        struct coordinator_block *block)
{
	struct work *work = of;
	const struct taker taker = {group, refused, n_refused};
	struct step step;
	pthread_mutex_lock(&work->lock);
	const bool taken = !work->stopping && take(work, &taker, &step);
	if (taken)
		*block = (struct coordinator_block){&step.job->known, step.block};
	pthread_mutex_unlock(&work->lock);
	return taken;
}

/* The study of a block assigned to a group. */
static struct job *groups_job(struct work *work, const struct coordinator_block *block)
{
	struct job *job = TAILQ_FIRST(&work->jobs);
	while (&job->known != block->study)
		job = TAILQ_NEXT(job, others);
	return job;
}

static void groups_back(void *of, int group, const struct coordinator_block *block)
{
	struct work *work = of;
	pthread_mutex_lock(&work->lock);
	struct job *job = groups_job(work, block);
	assignment_back(&job->blocks, block->number, group);
	job->n_out--;
	finish_if_complete(work, job);
	pthread_cond_broadcast(&work->changed);
	pthread_mutex_unlock(&work->lock);
}

/* Takes the values of a block, unless it was already done. */
static void groups_done(void *of, int group, const struct coordinator_block *block,
                        const struct message *message, const double *values)
{
	struct work *work = of;
	const enum pound_status status = (enum pound_status)message->status;
	const int number = block->number;
	pthread_mutex_lock(&work->lock);
	struct job *job = groups_job(work, block);
	job->n_out--;
	job->n_inside++;
	job->cpu_s += message->cpu_s;
	note_over(work, job);
	const bool first = status == POUND_OK &&
	                   assignment_done(&job->blocks, number, group, seconds(CLOCK_MONOTONIC)) && !job->ended;
	if (first) {
		pound_run_block_restore(job->of.run, number, values);
		hand_over(work, job, number, message->cpu_s);
	} else {
		if (status != POUND_OK)
			end(job, pound_status_error(status));
		job->n_inside--;
		finish_if_complete(work, job);
	}
	pthread_cond_broadcast(&work->changed);
	pthread_mutex_unlock(&work->lock);
}

static void groups_log(const char *line)
{
	log_line("%s", line);
}

static struct coordinator *groups_start(struct work *work, const struct launch *launch)
{
	const struct coordinator_source source = {.of = work,
	                                          .wanted = groups_wanted,
	                                          .take = groups_take,
	                                          .back = groups_back,
	                                          .done = groups_done,
	                                          .lives = groups_lives,
	                                          .log = groups_log};
	return coordinator_start(launch, &source);
}

/* Stops the groups; no thread wakes them any more. */
static void groups_stop(struct work *work)
{
	pthread_mutex_lock(&work->lock);
	struct coordinator *coordinator = work->coordinator;
	work->coordinator = NULL;
	pthread_mutex_unlock(&work->lock);
	coordinator_stop(coordinator);
}

int work_groups(const struct work *work)
{
	return coordinator_groups(work->coordinator);
}

long work_group_blocks(const struct work *work)
{
	return coordinator_blocks(work->coordinator);
}
