/* pound-worker-mpi: ranks of MPI that run blocks for a coordinator.
 *
 *   coordinator <-- connection --> rank 0 <-- MPI --> rank 1, 2, 3 ...
 *
 * 1. Rank 0 sends a study, and its end, to all ranks, and a block to the rank with the fewest blocks per thread; it computes, too.
 * 2. It answers with the digest of the design when all ranks have computed theirs, and with zeros if two differ.
 * 3. The MPI messages equal the messages of the connection, head and body in one; their tag is the tag of the study.  Rank 0 posts
 *    the receive of an answer when it sends the request, so that answers need no probing.
 * 4. Only the main thread calls MPI.  It sleeps when there is nothing to do, because MPI's waits spin; the computing threads and the
 *    thread that reads the connection leave packets in a mailbox.
 * 5. When the connection ends, all ranks stop their blocks, rank 0 receives what is outstanding, and all end together. */
#include <mpi.h>
#include <pthread.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/queue.h>
#include <unistd.h>

#include <gsl/gsl_errno.h>

#include "client/thread_pool.h"
#include "client/worker_connection.h"

enum {
	TAG_END = 0,      /* tag of the last message of rank 0 */
	TAGS = 30000,     /* number of tags for studies; MPI guarantees 32,767 */
	STUDIES_MAX = 64, /* studies open at a time; a coordinator has fewer */
	IDLE_US = 100,
	END_MAX = 10, /* [s] from the end of the connection to the exit of the program */
};

/* A message to or from a rank or the coordinator. */
struct packet {
	STAILQ_ENTRY(packet) next;
	int rank; /* sender, or CONNECTION */
	int n_users;
	bool over; /* the connection has ended */
	struct wire {
		struct message head;
		char body[];
	} wire;
};

enum { CONNECTION = -1 };

/* Packets of other threads for the main thread. */
struct mailbox {
	pthread_mutex_t lock;
	STAILQ_HEAD(, packet) packets;
};

/* A nonblocking send or receive that has not completed. */
struct posted {
	struct packet *packet;
	bool is_receive;
};

struct rank_study {
	uint64_t id; /* 0: no study */
	int n_awaited;
	struct message design; /* the answer to the coordinator */
	uint8_t digest[MESSAGE_DIGEST_SIZE];
};

struct ranks {
	int rank, n;
	int *threads, *out; /* (n) of each rank: number of threads, number of assigned blocks */
	int connection;
	pthread_mutex_t sending; /* serializes sends to the connection */
	struct thread_pool *pool;
	struct mailbox mailbox;
	MPI_Request *requests;
	struct posted *posted; /* (n_posted), as requests */
	int n_posted, n_posted_max;
	struct rank_study studies[STUDIES_MAX];
	bool ending;
};

__attribute__((noreturn)) static void fail(const char *what)
{
	fprintf(stderr, "pound-worker-mpi: %s\n", what);
	MPI_Abort(MPI_COMM_WORLD, EXIT_FAILURE);
	_exit(EXIT_FAILURE);
}

static void *must(void *memory)
{
	if (!memory)
		fail("out of memory");
	return memory;
}

static struct packet *packet_new(int rank, size_t body)
{
	struct packet *p = must(calloc(1, sizeof *p + body));
	p->rank = rank;
	p->n_users = 1;
	return p;
}

static struct packet *packet_of(int rank, const struct message *head, const void *body)
{
	const size_t n = message_body_size(head);
	struct packet *p = packet_new(rank, n);
	p->wire.head = *head;
	if (n)
		memcpy(p->wire.body, body, n);
	return p;
}

static void packet_free(struct packet *p)
{
	if (--p->n_users == 0)
		free(p);
}

static void mail_put(struct mailbox *mailbox, struct packet *p)
{
	pthread_mutex_lock(&mailbox->lock);
	STAILQ_INSERT_TAIL(&mailbox->packets, p, next);
	pthread_mutex_unlock(&mailbox->lock);
}

/* NULL: the mailbox is empty. */
static struct packet *mail_take(struct mailbox *mailbox)
{
	pthread_mutex_lock(&mailbox->lock);
	struct packet *p = STAILQ_FIRST(&mailbox->packets);
	if (p)
		STAILQ_REMOVE_HEAD(&mailbox->packets, next);
	pthread_mutex_unlock(&mailbox->lock);
	return p;
}

/* ---- sends and receives ---- */

static int tag_of(uint64_t study)
{
	return 1 + (int)(study % TAGS);
}

static int size_of(const struct packet *p)
{
	return (int)(sizeof p->wire.head + message_body_size(&p->wire.head));
}

static MPI_Request *post(struct ranks *r, struct packet *p, bool is_receive)
{
	if (r->n_posted == r->n_posted_max) {
		r->n_posted_max = 2 * r->n_posted_max + 64;
		r->requests = must(realloc(r->requests, (size_t)r->n_posted_max * sizeof *r->requests));
		r->posted = must(realloc(r->posted, (size_t)r->n_posted_max * sizeof *r->posted));
	}
	r->posted[r->n_posted] = (struct posted){p, is_receive};
	return &r->requests[r->n_posted++];
}

static void send_packet(struct ranks *r, int rank, struct packet *p, int tag)
{
	p->n_users++;
	MPI_Isend(&p->wire, tag == TAG_END ? 0 : size_of(p), MPI_BYTE, rank, tag, MPI_COMM_WORLD,
	          post(r, p, false));
}

/* Posts the receive of an answer with a body of at most `body` bytes. */
static void expect(struct ranks *r, int rank, uint64_t study, size_t body)
{
	struct packet *p = packet_new(rank, body);
	MPI_Irecv(&p->wire, (int)(sizeof p->wire.head + body), MPI_BYTE, rank, tag_of(study), MPI_COMM_WORLD,
	          post(r, p, true));
}

static void answer_take(struct ranks *r, struct packet *p);

/* Handles completed sends and receives; false: none has completed. */
static bool progress(struct ranks *r)
{
	int n = 0;
	if (r->n_posted == 0)
		return false;
	int *ended = must(malloc((size_t)r->n_posted * sizeof *ended));
	struct packet **received = must(malloc((size_t)r->n_posted * sizeof(struct packet *)));
	MPI_Testsome(r->n_posted, r->requests, &n, ended, MPI_STATUSES_IGNORE);
	int n_received = 0, kept = 0;
	for (int i = 0; i < n; i++) {
		struct posted *posted = &r->posted[ended[i]];
		if (posted->is_receive)
			received[n_received++] = posted->packet;
		else
			packet_free(posted->packet);
		posted->packet = NULL;
	}
	for (int i = 0; n > 0 && i < r->n_posted; i++)
		if (r->posted[i].packet) {
			r->posted[kept] = r->posted[i];
			r->requests[kept++] = r->requests[i];
		}
	r->n_posted = n > 0 ? kept : r->n_posted;
	for (int i = 0; i < n_received; i++)
		answer_take(r, received[i]);
	free(received);
	free(ended);
	return n > 0;
}

/* ---- rank 0 ---- */

/* Sends to the coordinator.  Errors are ignored: the thread that reads the connection detects its end. */
static void connection_send(struct ranks *r, const struct message *message, const void *body)
{
	pthread_mutex_lock(&r->sending);
	message_send(r->connection, message, body);
	pthread_mutex_unlock(&r->sending);
}

/* The answers of rank 0's own threads: values go to the coordinator at once. */
static void answer_own(void *of, const struct message *message, const void *body)
{
	struct ranks *r = of;
	if (message->type == MESSAGE_DESIGN)
		mail_put(&r->mailbox, packet_of(0, message, body));
	else {
		connection_send(r, message, body);
		mail_put(&r->mailbox, packet_of(0, &(struct message){.type = MESSAGE_VALUES}, NULL));
	}
}

static void *connection_read(void *of)
{
	struct ranks *r = of;
	struct message head;
	char *body;
	while (worker_take(r->connection, &head, &body)) {
		mail_put(&r->mailbox, packet_of(CONNECTION, &head, body));
		free(body);
	}
	struct packet *end = packet_new(CONNECTION, 0);
	end->over = true;
	mail_put(&r->mailbox, end);
	return NULL;
}

static struct rank_study *study_of(struct ranks *r, uint64_t id)
{
	for (int i = 0; i < STUDIES_MAX; i++)
		if (r->studies[i].id == id)
			return &r->studies[i];
	return NULL;
}

/* Takes the digest of the design from one rank; after the last one, answers the coordinator. */
static void design_take(struct ranks *r, const struct packet *p)
{
	struct rank_study *s = study_of(r, p->wire.head.study);
	const bool made = p->wire.head.status == POUND_OK;
	if (!s)
		fail("a design of an unknown study");
	if (s->design.type == 0 || !made) {
		s->design = p->wire.head;
		memcpy(s->digest, p->wire.body, message_body_size(&p->wire.head));
	} else if (s->design.status == POUND_OK && memcmp(s->digest, p->wire.body, sizeof s->digest) != 0)
		memset(s->digest, 0, sizeof s->digest); // the coordinator refuses a digest that differs from its own
	if (--s->n_awaited > 0)
		return;
	connection_send(r, &s->design, s->digest);
	s->id = 0;
}

/* Takes an answer of another rank, or the notice that rank 0 itself has answered. */
static void answer_take(struct ranks *r, struct packet *p)
{
	if (p->wire.head.type == MESSAGE_DESIGN)
		design_take(r, p);
	else {
		r->out[p->rank]--;
		if (p->rank > 0)
			connection_send(r, &p->wire.head, p->wire.body);
	}
	packet_free(p);
}

/* Executes a message in this process; false: the message is invalid. */
static bool obey(struct ranks *r, const struct packet *p)
{
	const size_t n = message_body_size(&p->wire.head);
	char *body = n ? must(malloc(n)) : NULL;
	if (n)
		memcpy(body, p->wire.body, n);
	return thread_pool_take(r->pool, &p->wire.head, body);
}

static void study_begin(struct ranks *r, uint64_t id)
{
	struct rank_study *s = study_of(r, 0);
	if (!s)
		fail("too many studies at a time");
	*s = (struct rank_study){.id = id, .n_awaited = r->n};
	for (int rank = 1; rank < r->n; rank++)
		expect(r, rank, id, MESSAGE_DIGEST_SIZE);
}

/* The rank with the fewest assigned blocks per thread. */
static int rank_next(const struct ranks *r)
{
	int best = 0;
	for (int rank = 1; rank < r->n; rank++)
		if ((long)r->out[rank] * r->threads[best] < (long)r->out[best] * r->threads[rank])
			best = rank;
	return best;
}

/* Distributes a message of the coordinator to the ranks. */
static void pass_on(struct ranks *r, struct packet *p)
{
	const uint64_t study = p->wire.head.study;
	int to = 0;
	if (p->over) {
		r->ending = true;
		alarm(END_MAX);
		thread_pool_stop(r->pool);
		for (int rank = 1; rank < r->n; rank++)
			send_packet(r, rank, p, TAG_END);
		return;
	}
	if (p->wire.head.type == MESSAGE_STUDY)
		study_begin(r, study);
	if (p->wire.head.type == MESSAGE_BLOCK) {
		to = rank_next(r);
		r->out[to]++;
		if (to > 0)
			expect(r, to, study, thread_pool_values_most(r->pool, study) * sizeof(double));
	}
	for (int rank = 1; rank < r->n; rank++)
		if (p->wire.head.type != MESSAGE_BLOCK || rank == to)
			send_packet(r, rank, p, tag_of(study));
	if (to == 0 && !obey(r, p))
		fail("a message of the coordinator is invalid");
}

static void coordinate(struct ranks *r)
{
	pthread_t reader;
	if (pthread_create(&reader, NULL, connection_read, r) != 0)
		fail("no thread to read the connection");
	while (!r->ending || r->n_posted > 0 || !thread_pool_idle(r->pool)) {
		bool idle = !progress(r);
		for (struct packet *p; (p = mail_take(&r->mailbox)); idle = false)
			if (p->rank == CONNECTION) {
				pass_on(r, p);
				packet_free(p);
			} else
				answer_take(r, p);
		if (idle)
			usleep(IDLE_US);
	}
}

/* ---- other ranks ---- */

static void answer_queue(void *of, const struct message *message, const void *body)
{
	struct ranks *r = of;
	mail_put(&r->mailbox, packet_of(r->rank, message, body));
}

/* Receives and executes a message of rank 0; false: no message has arrived. */
static bool question_take(struct ranks *r)
{
	MPI_Status status;
	int there, n;
	MPI_Iprobe(0, MPI_ANY_TAG, MPI_COMM_WORLD, &there, &status);
	if (!there)
		return false;
	MPI_Get_count(&status, MPI_BYTE, &n);
	struct packet *p = packet_new(0, (size_t)n);
	MPI_Recv(&p->wire, n, MPI_BYTE, 0, status.MPI_TAG, MPI_COMM_WORLD, MPI_STATUS_IGNORE);
	if (status.MPI_TAG == TAG_END) {
		r->ending = true;
		alarm(END_MAX);
		thread_pool_stop(r->pool);
	} else if (!obey(r, p))
		fail("a message of rank 0 is invalid");
	packet_free(p);
	return true;
}

static void work(struct ranks *r)
{
	for (bool more = true; more;) {
		// check for idle threads before taking answers: a thread leaves its answer first and is idle afterwards
		more = !r->ending || !thread_pool_idle(r->pool);
		bool idle = !question_take(r);
		for (struct packet *p; (p = mail_take(&r->mailbox)); idle = false) {
			send_packet(r, 0, p, tag_of(p->wire.head.study));
			packet_free(p);
		}
		idle = !progress(r) && idle;
		more = more || r->n_posted > 0;
		if (idle && more)
			usleep(IDLE_US);
	}
}

int main(int argc, char **argv)
{
	const struct worker_options options = worker_options(argc, argv);
	int n_threads = options.n_threads, provided;
	struct ranks r = {.mailbox = {.lock = PTHREAD_MUTEX_INITIALIZER}, .sending = PTHREAD_MUTEX_INITIALIZER};
	STAILQ_INIT(&r.mailbox.packets);
	gsl_set_error_handler_off();
	if (MPI_Init_thread(&argc, &argv, MPI_THREAD_FUNNELED, &provided) != MPI_SUCCESS ||
	    provided < MPI_THREAD_FUNNELED)
		fail("MPI has no MPI_THREAD_FUNNELED");
	MPI_Comm_rank(MPI_COMM_WORLD, &r.rank);
	MPI_Comm_size(MPI_COMM_WORLD, &r.n);
	r.threads = must(calloc((size_t)r.n, sizeof *r.threads));
	r.out = must(calloc((size_t)r.n, sizeof *r.out));
	MPI_Gather(&n_threads, 1, MPI_INT, r.threads, 1, MPI_INT, 0, MPI_COMM_WORLD);
	int all = 0;
	for (int rank = 0; rank < r.n; rank++)
		all += r.threads[rank];
	if (all > MESSAGE_THREADS_MAX)
		fail("the ranks have more than 4096 threads: start several groups by --launchers");
	if (r.rank == 0)
		r.connection = worker_connect(&options, all, false);
	r.pool = must(thread_pool_start(n_threads, r.rank == 0 ? answer_own : answer_queue, &r));
	(r.rank == 0 ? coordinate : work)(&r);
	MPI_Finalize();
	// _exit, because the threads of the pool still wait for blocks
	_exit(EXIT_SUCCESS);
}
