/* The threads take orders from a queue: to make the run of a study and answer with the digest of its design, or to run a
 * block.  The thread that receives messages never sends, so that it and a sending coordinator cannot block each other.  A dropped
 * study is stopped, its orders are answered as stopped, and the last thread that uses it frees it. */
#include "client/thread_pool.h"

#include <assert.h>
#include <pthread.h>
#include <stdatomic.h>
#include <stdlib.h>
#include <sys/queue.h>
#include <time.h>

#include "schema/json/problems.h"
#include "schema/study/study_json.h"

struct work_study {
	TAILQ_ENTRY(work_study) others;
	uint64_t id;
	char *document; /* (length) bytes; freed when the run is created */
	size_t length;
	struct pound_study *study;
	struct pound_run *run; /* NULL: not created yet, or creation failed */
	size_t values_most;    /* largest number of values of a block */
	atomic_bool stop;      /* the coordinator dropped the study */
	int n_orders;          /* orders queued or being executed */
};

struct order {
	STAILQ_ENTRY(order) next;
	struct work_study *study;
	int block; /* -1: create the run */
};

struct thread_pool {
	pthread_mutex_t lock;
	pthread_cond_t ordered;
	TAILQ_HEAD(, work_study) studies;
	STAILQ_HEAD(, order) orders;
	pthread_mutex_t answers; /* serializes calls of answer */
	worker_answer *answer;
	void *to;
	int n_threads, n_numbered;
};

static double thread_cpu(void)
{
	struct timespec now;
	clock_gettime(CLOCK_THREAD_CPUTIME_ID, &now);
	return (double)now.tv_sec + 1e-9 * (double)now.tv_nsec;
}

static void give_answer(struct thread_pool *pool, const struct message *message, const void *body)
{
	pthread_mutex_lock(&pool->answers);
	pool->answer(pool->to, message, body);
	pthread_mutex_unlock(&pool->answers);
}

/* Creates the run of a study and answers with the digest of its design. */
static void open_study(struct thread_pool *pool, struct work_study *s)
{
	struct message m = {.type = MESSAGE_DESIGN, .study = s->id, .status = POUND_NOMEM};
	uint8_t digest[MESSAGE_DIGEST_SIZE];
	struct problems problems;
	s->study = study_from_json(s->document, s->length, &problems);
	free(s->document);
	s->document = NULL;
	struct pound_run *run = s->study ? pound_run_create_by(s->study, pool->n_threads, &s->stop) : NULL;
	if (run)
		pound_run_stop_by(run, &s->stop);
	if (run && message_design(s->study, run, digest)) {
		m.status = POUND_OK;
		m.n = sizeof digest;
	}
	size_t most = 0;
	for (int block = run ? pound_run_blocks_most(run) - 1 : -1; block >= 0; block--)
		most = pound_run_block_size(run, block) > most ? pound_run_block_size(run, block) : most;
	pthread_mutex_lock(&pool->lock);
	s->values_most = most;
	s->run = run;
	pthread_mutex_unlock(&pool->lock);
	give_answer(pool, &m, digest);
}

static void run_block(struct thread_pool *pool, struct work_study *s, int block, int worker)
{
	struct message m = {.type = MESSAGE_VALUES, .study = s->id, .block = block, .status = POUND_STOPPED};
	double cpu_s = thread_cpu();
	if (!s->stop)
		m.status = (int32_t)pound_run_block(s->run, block, worker);
	m.cpu_s = thread_cpu() - cpu_s;
	if (m.status == POUND_OK)
		m.n = (uint32_t)pound_run_block_size(s->run, block);
	give_answer(pool, &m, m.n ? pound_run_block_values(s->run, block) : NULL);
}

static void study_end(struct thread_pool *pool, struct work_study *s)
{
	TAILQ_REMOVE(&pool->studies, s, others);
	if (s->run)
		pound_run_free(s->run);
	if (s->study)
		study_free(s->study);
	free(s->document);
	free(s);
}

static void *thread(void *of)
{
	struct thread_pool *pool = of;
	pthread_mutex_lock(&pool->lock);
	const int worker = pool->n_numbered++;
	for (;;) {
		struct order *order = STAILQ_FIRST(&pool->orders);
		if (!order) {
			pthread_cond_wait(&pool->ordered, &pool->lock);
			continue;
		}
		STAILQ_REMOVE_HEAD(&pool->orders, next);
		pthread_mutex_unlock(&pool->lock);
		struct work_study *s = order->study;
		if (order->block < 0)
			open_study(pool, s);
		else
			run_block(pool, s, order->block, worker);
		free(order);
		pthread_mutex_lock(&pool->lock);
		if (--s->n_orders == 0 && s->stop)
			study_end(pool, s);
	}
	return NULL;
}

struct thread_pool *thread_pool_start(int n_threads, worker_answer *answer, void *to)
{
	struct thread_pool *pool = calloc(1, sizeof *pool);
	if (!pool)
		return NULL;
	*pool = (struct thread_pool){.lock = PTHREAD_MUTEX_INITIALIZER,
	                             .ordered = PTHREAD_COND_INITIALIZER,
	                             .answers = PTHREAD_MUTEX_INITIALIZER,
	                             .answer = answer,
	                             .to = to,
	                             .n_threads = n_threads};
	TAILQ_INIT(&pool->studies);
	STAILQ_INIT(&pool->orders);
	for (int i = 0; i < n_threads; i++) {
		pthread_t id;
		if (pthread_create(&id, NULL, thread, pool) != 0)
			return NULL; // the caller then ends the program, and with it the started threads
		pthread_detach(id);
	}
	return pool;
}

/* Queues an order; false: no memory.  The caller holds the lock. */
static bool put(struct thread_pool *pool, struct work_study *s, int block)
{
	struct order *order = malloc(sizeof *order);
	if (!order)
		return false;
	*order = (struct order){.study = s, .block = block};
	s->n_orders++;
	STAILQ_INSERT_TAIL(&pool->orders, order, next);
	pthread_cond_signal(&pool->ordered);
	return true;
}

/* Executes a message for the study that it names (s NULL: no such study); false: the message is invalid. */
static bool obey(struct thread_pool *pool, const struct message *m, struct work_study *s, char **body)
{
	switch ((enum message_type)m->type) {
	case MESSAGE_STUDY:
		if (s || !(s = calloc(1, sizeof *s)))
			return false;
		s->id = m->study;
		s->document = *body;
		s->length = m->n;
		*body = NULL;
		TAILQ_INSERT_TAIL(&pool->studies, s, others);
		return put(pool, s, -1);
	case MESSAGE_BLOCK:
		return s && s->run && m->block < pound_run_blocks_most(s->run) && put(pool, s, m->block);
	case MESSAGE_DROP:
		if (!s)
			return false;
		s->stop = true;
		if (s->n_orders == 0)
			study_end(pool, s);
		return true;
	case MESSAGE_READY:
	case MESSAGE_DESIGN:
	case MESSAGE_VALUES:
	case MESSAGE_REFUSE: // handled by worker_take
		break;
	}
	return false;
}

bool thread_pool_take(struct thread_pool *pool, const struct message *m, char *body)
{
	struct work_study *s;
	pthread_mutex_lock(&pool->lock);
	TAILQ_FOREACH(s, &pool->studies, others)
	if (s->id == m->study && !s->stop)
		break;
	bool sense = obey(pool, m, s, &body);
	pthread_mutex_unlock(&pool->lock);
	free(body);
	return sense;
}

size_t thread_pool_values_most(struct thread_pool *pool, uint64_t study)
{
	size_t most = 0;
	const struct work_study *s;
	pthread_mutex_lock(&pool->lock);
	TAILQ_FOREACH(s, &pool->studies, others)
	most = s->id == study ? s->values_most : most;
	pthread_mutex_unlock(&pool->lock);
	return most;
}

void thread_pool_stop(struct thread_pool *pool)
{
	pthread_mutex_lock(&pool->lock);
	for (struct work_study *s = TAILQ_FIRST(&pool->studies), *next; s; s = next) {
		next = TAILQ_NEXT(s, others);
		s->stop = true;
		if (s->n_orders == 0)
			study_end(pool, s);
	}
	pthread_mutex_unlock(&pool->lock);
}

bool thread_pool_idle(struct thread_pool *pool)
{
	pthread_mutex_lock(&pool->lock);
	const bool idle = TAILQ_EMPTY(&pool->studies);
	pthread_mutex_unlock(&pool->lock);
	return idle;
}
