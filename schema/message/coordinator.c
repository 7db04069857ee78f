/* coordinator.c - states of a worker group:
 *
 *   idle -- blocks are wanted --> launch --> wait for the connection --> serve --+
 *    ^                              ^  failed: 1, 2, 4 ... 60 s later            |
 *    +------------------------------+--------------------- idle for 60 s, or lost
 *
 * No block is taken before the group has connected, so a launcher in a batch queue delays nothing.  While it is served,
 * a group has two blocks per thread: one that runs, one that waits.
 *
 * External workers have no launcher.  One thread waits for a connection, starts the next waiting thread, and serves the
 * connection until it ends. */
#include "schema/message/coordinator.h"

#include <assert.h>
#include <ctype.h>
#include <errno.h>
#include <poll.h>
#include <pthread.h>
#include <signal.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/eventfd.h>
#include <sys/socket.h>
#include <time.h>
#include <unistd.h>

#include "schema/message/listen.h"

enum {
	AHEAD = 2,        /* blocks per thread of a group */
	STUDIES_MAX = 16, /* of a group at the same time */
	LOOK_MS = 200,    /* interval of polling for late blocks and the end of the launcher */
	IDLE_MAX = 60,    /* [s] without a block before the group ends */
	PAUSE_MAX = 60,   /* [s] longest pause before a launcher is started again */
	REFUSED_MS = 500, /* pause after a refused connection, so that refusals cannot flood the log */
};

/* State of a study at a group. */
enum standing { UNKNOWN, SENT, AGREED, REFUSED, DROPPED };
struct known {
	enum standing standing;
	uint64_t id;
	int n_out;                           /* blocks of the group without an answer */
	uint8_t digest[MESSAGE_DIGEST_SIZE]; /* digest of the coordinator's design */
};

struct out {
	struct coordinator_block block;
	uint64_t id; /* of its study, valid after the study has ended */
	bool taken;  /* not yet done or given back */
	bool waits;  /* to be sent after the group has agreed on the design */
};

struct group {
	struct coordinator *of;
	int number; /* from 1 */
	pthread_t thread;
	int wakes; /* eventfd */
	struct launcher launcher;
	pthread_mutex_t lock; /* for the socket, which another thread may shut down */
	int socket, n_threads;
	struct known known[STUDIES_MAX];
	struct out *out; /* (n_out_max) */
	int n_out, n_out_max;
	uint64_t refused[STUDIES_MAX];
	int n_refused;
	bool worked;                 /* has run a block since the launch */
	char peer[LISTEN_PEER_SIZE]; /* address of its connection */
};

struct coordinator {
	struct launch launch;
	struct coordinator_source source;
	atomic_bool stopping;
	atomic_int n_connected;
	atomic_long n_blocks;
	pthread_mutex_t lock;  /* for the start of threads */
	int n_waiting;         /* threads that wait for external workers */
	int n_launched, n_max; /* groups with a launcher, most groups */
	atomic_int n;          /* groups whose threads have started */
	struct group groups[]; /* (n_max) */
};

static bool has_launcher(const struct group *g)
{
	return g->number <= g->of->n_launched;
}

static double now_s(void)
{
	struct timespec now;
	clock_gettime(CLOCK_MONOTONIC, &now);
	return (double)now.tv_sec + 1e-9 * (double)now.tv_nsec;
}

__attribute__((format(printf, 2, 3))) static void say(const struct group *g, const char *format, ...)
{
	char line[256];
	int n = snprintf(line, sizeof line, "worker group %d: ", g->number);
	va_list values;
	va_start(values, format);
	vsnprintf(line + n, sizeof line - (size_t)n, format, values);
	va_end(values);
	g->of->source.log(line);
}

/* Waits for a wake-up, or for data at the socket (-1: none); true: data. */
static bool pause_for(struct group *g, int socket, int ms)
{
	struct pollfd of[2] = {{.fd = g->wakes, .events = POLLIN}, {.fd = socket, .events = POLLIN}};
	uint64_t count;
	poll(of, 2, ms);
	if (of[0].revents && read(g->wakes, &count, sizeof count) < 0)
		return false;
	return of[1].revents != 0;
}

static struct known *known_of(struct group *g, uint64_t id)
{
	for (int i = 0; i < STUDIES_MAX; i++)
		if (g->known[i].standing != UNKNOWN && g->known[i].id == id)
			return &g->known[i];
	return NULL;
}

static void give_back(struct group *g, struct out *out)
{
	if (out->taken)
		g->of->source.back(g->of->source.of, g->number, &out->block);
	out->taken = false;
}

static void out_remove(struct group *g, struct out *out)
{
	*out = g->out[--g->n_out];
}

/* Takes no more blocks of a study for this group. */
static void refuse(struct group *g, struct known *k, const char *why)
{
	say(g, "refused for this study: %s", why);
	k->standing = REFUSED;
	assert(g->n_refused < STUDIES_MAX); // each is one of the STUDIES_MAX known studies
	g->refused[g->n_refused++] = k->id;
	for (int i = g->n_out - 1; i >= 0; i--)
		if (g->out[i].id == k->id && g->out[i].waits) {
			give_back(g, &g->out[i]);
			out_remove(g, &g->out[i]);
			k->n_out--;
		}
}

/* Removes an ended study from the refused ones. */
static void refused_forget(struct group *g, uint64_t id)
{
	int kept = 0;
	for (int i = 0; i < g->n_refused; i++)
		if (g->refused[i] != id)
			g->refused[kept++] = g->refused[i];
	g->n_refused = kept;
}

/* Drops studies that have ended; false: the connection failed. */
static bool drop_ended(struct group *g)
{
	for (int s = 0; s < STUDIES_MAX; s++) {
		struct known *k = &g->known[s];
		if (k->standing == UNKNOWN)
			continue;
		if (k->standing != DROPPED && !g->of->source.lives(g->of->source.of, k->id)) {
			const struct message drop = {.type = MESSAGE_DROP, .study = k->id};
			for (int i = g->n_out - 1; i >= 0; i--)
				if (g->out[i].id == k->id) {
					const bool sent = !g->out[i].waits;
					give_back(g, &g->out[i]);
					if (sent)
						continue;
					out_remove(g, &g->out[i]);
					k->n_out--;
				}
			refused_forget(g, k->id);
			const bool unanswered = k->standing == SENT;
			k->standing = DROPPED;
			k->n_out += unanswered; // the answer about the design
			if (!message_send(g->socket, &drop, NULL))
				return false;
		}
		if (k->standing == DROPPED && k->n_out == 0)
			k->standing = UNKNOWN;
	}
	return true;
}

/* Sends a study, before its first block; NULL: the connection failed, or out of memory. */
static struct known *introduce(struct group *g, const struct coordinator_study *study)
{
	struct known *k = g->known;
	while (k < g->known + STUDIES_MAX && k->standing != UNKNOWN)
		k++;
	assert(k < g->known + STUDIES_MAX);
	const struct message head = {.type = MESSAGE_STUDY, .study = study->id, .n = (uint32_t)study->length};
	*k = (struct known){.standing = SENT, .id = study->id};
	if (!message_design(study->study, study->run, k->digest) ||
	    !message_send(g->socket, &head, study->document))
		return NULL;
	return k;
}

static bool send_block(struct group *g, struct out *out)
{
	const struct message head = {.type = MESSAGE_BLOCK, .study = out->id, .block = out->block.number};
	out->waits = false;
	return message_send(g->socket, &head, NULL);
}

/* Whether the group may get one more study: the table may be full of short studies that have ended since its last answer. */
static bool has_place(const struct group *g)
{
	int n = 0;
	for (int s = 0; s < STUDIES_MAX; s++)
		n += g->known[s].standing != UNKNOWN;
	return n < STUDIES_MAX;
}

/* Takes blocks until the group has enough; false: the connection failed. */
static bool fill(struct group *g)
{
	const struct coordinator_source *source = &g->of->source;
	struct coordinator_block block;
	if (!has_place(g) && !drop_ended(g))
		return false;
	while (g->n_out < g->n_out_max && has_place(g) &&
	       source->take(source->of, g->number, g->refused, g->n_refused, &block)) {
		struct out *out = &g->out[g->n_out++];
		struct known *k = known_of(g, block.study->id);
		*out = (struct out){.block = block, .id = block.study->id, .taken = true, .waits = true};
		if (!k && !(k = introduce(g, block.study)))
			return false;
		k->n_out++;
		if (k->standing == AGREED && !send_block(g, out))
			return false;
	}
	return true;
}

/* Handles a DESIGN; NULL, or an error message. */
static const char *take_design(struct group *g, const struct message *m, const char *body)
{
	struct known *k = known_of(g, m->study);
	if (k && k->standing == DROPPED && k->n_out > 0) {
		k->n_out--;
		return NULL;
	}
	if (!k || k->standing != SENT)
		return "an answer about a study that was not sent";
	if (m->status != POUND_OK)
		refuse(g, k, pound_status_text((enum pound_status)m->status));
	else if (memcmp(body, k->digest, sizeof k->digest) != 0)
		refuse(g, k, "its design differs, because its processor or its GSL computes other quantiles");
	else {
		k->standing = AGREED;
		for (int i = 0; i < g->n_out; i++)
			if (g->out[i].id == k->id && g->out[i].waits && !send_block(g, &g->out[i]))
				return "the connection ended";
	}
	return NULL;
}

static const char *take_values(struct group *g, const struct message *m, const char *body)
{
	struct known *k = known_of(g, m->study);
	struct out *out = g->out;
	while (out < g->out + g->n_out && (out->id != m->study || out->block.number != m->block || out->waits))
		out++;
	if (!k || out == g->out + g->n_out)
		return "values of a block that was not sent";
	if (out->taken) {
		const bool ran = m->status == POUND_OK;
		if (ran && m->n != pound_run_block_size(out->block.study->run, m->block))
			return "a block of another size";
		if (m->status == POUND_STOPPED)
			return "a block that was stopped";
		// out of memory in the worker does not mean out of memory here
		if (m->status == POUND_NOMEM)
			return "out of memory";
		out->taken = false;
		g->of->source.done(g->of->source.of, g->number, &out->block, m, (const double *)(const void *)body);
		g->worked = true;
		atomic_fetch_add(&g->of->n_blocks, ran);
	}
	out_remove(g, out);
	k->n_out--;
	return NULL;
}

/* Receives and handles one message; false: the connection is to be closed. */
static bool answer(struct group *g)
{
	struct message m;
	char *body;
	if (!message_take(g->socket, MESSAGE_OF_WORKER, &m, &body)) {
		if (!g->of->stopping)
			say(g, "the connection ended");
		return false;
	}
	const char *fault = m.type == MESSAGE_DESIGN   ? take_design(g, &m, body)
	                    : m.type == MESSAGE_VALUES ? take_values(g, &m, body)
	                                               : "a second greeting";
	free(body);
	if (fault)
		say(g, "the connection is closed: %s", fault);
	return !fault;
}

/* Logs why a worker is refused, and sends it the reason. */
__attribute__((format(printf, 2, 3))) static void turn_away(struct group *g, const char *format, ...)
{
	char why[MESSAGE_TEXT_MAX];
	va_list values;
	va_start(values, format);
	vsnprintf(why, sizeof why, format, values);
	va_end(values);
	const struct message m = {.type = MESSAGE_REFUSE, .n = (uint32_t)strlen(why)};
	message_send(g->socket, &m, why);
	say(g, "refused: %s", why);
}

/* Receives the first message; false: another version, or no valid greeting. */
static bool greet(struct group *g)
{
	struct message m;
	char *version = NULL;
	bool ready = message_take(g->socket, MESSAGE_OF_WORKER, &m, &version) && m.type == MESSAGE_READY;
	bool same = ready && m.n == strlen(POUND_VERSION) && memcmp(version, POUND_VERSION, m.n) == 0;
	for (uint32_t i = 0; ready && i < m.n; i++)
		version[i] = isprint((unsigned char)version[i]) ? version[i] : '?';
	if (!ready)
		turn_away(g, "its first message is not the greeting of a pound-worker");
	else if (!same)
		turn_away(g, "pound-worker has version %.*s, this program " POUND_VERSION "; both must be the same",
		          (int)m.n, version);
	free(version);
	if (!same)
		return false;
	g->n_threads = m.block;
	g->n_out_max = AHEAD * g->n_threads;
	g->out = calloc((size_t)g->n_out_max, sizeof *g->out);
	return g->out;
}

static void set_socket(struct group *g, int socket)
{
	pthread_mutex_lock(&g->lock);
	if (g->socket >= 0)
		close(g->socket);
	g->socket = socket;
	pthread_mutex_unlock(&g->lock);
}

/* Serves a connected group until its connection ends or it is idle for too long. */
static void serve(struct group *g)
{
	double busy = now_s(), looked = 0;
	bool ok = !g->of->stopping && greet(g);
	if (ok) {
		say(g, "connected, %d thread%s%s%s", g->n_threads, g->n_threads == 1 ? "" : "s",
		    has_launcher(g) ? "" : ", from ", has_launcher(g) ? "" : g->peer);
		atomic_fetch_add(&g->of->n_connected, 1);
	}
	const bool connected = ok;
	while (ok && !g->of->stopping) {
		if (now_s() - looked > 1e-3 * LOOK_MS) {
			looked = now_s();
			ok = drop_ended(g);
		}
		ok = ok && fill(g);
		if (!ok)
			break;
		if (g->n_out > 0)
			busy = now_s();
		else if (has_launcher(g) && now_s() - busy > IDLE_MAX) {
			say(g, "ended, because there were no blocks for %d s", IDLE_MAX);
			break;
		}
		if (pause_for(g, g->socket, LOOK_MS))
			ok = answer(g);
		else
			looked = 0;
	}
	for (int i = 0; i < g->n_out; i++)
		give_back(g, &g->out[i]);
	if (connected)
		atomic_fetch_sub(&g->of->n_connected, 1);
	set_socket(g, -1);
	free(g->out);
	g->out = NULL;
	g->n_out = g->n_threads = g->n_refused = 0;
	memset(g->known, 0, sizeof g->known);
}

/* Accepts a connection of the launched workers; false: none, or a wrong token. */
static bool launched_accept(struct group *g)
{
	const int connection = listen_accept(g->launcher.listens, g->peer);
	if (connection < 0)
		return false;
	set_socket(g, connection); // so that coordinator_stop can shut it down while it waits for the token
	if (!g->of->stopping && listen_entry(connection, g->launcher.token) == LISTEN_TOKEN)
		return true;
	set_socket(g, -1);
	return false;
}

/* Starts the launcher, waits for the connection, serves it. */
static void launch(struct group *g)
{
	const struct coordinator_source *source = &g->of->source;
	const char *fault = launcher_start(&g->launcher, &g->of->launch);
	g->worked = false;
	if (fault)
		say(g, "%s", fault);
	bool ended = fault != NULL;
	bool connected = false;
	for (double busy = now_s(); !ended && !connected && !g->of->stopping && now_s() - busy < IDLE_MAX;) {
		ended = launcher_ended(&g->launcher);
		if (pause_for(g, g->launcher.listens, LOOK_MS))
			connected = launched_accept(g);
		if (source->wanted(source->of))
			busy = now_s();
	}
	launcher_close(&g->launcher);
	if (connected)
		serve(g);
	else if (ended && !fault)
		say(g, "its launcher ended with status %d and without a connection", g->launcher.status);
	launcher_stop(&g->launcher, connected);
}

static void *launched_run(void *of)
{
	struct group *g = of;
	int pause = 1;
	while (!g->of->stopping) {
		if (!g->of->source.wanted(g->of->source.of)) {
			pause_for(g, -1, -1);
			continue;
		}
		launch(g);
		pause = g->worked ? 1 : pause;
		for (double until = now_s() + pause; !g->of->stopping && now_s() < until;)
			pause_for(g, -1, LOOK_MS);
		pause = 2 * pause < PAUSE_MAX ? 2 * pause : PAUSE_MAX;
	}
	return NULL;
}

static bool group_start(struct coordinator *c);

/* Thread that waits for external workers and serves one after the other. */
static void *waiting_run(void *of)
{
	struct group *g = of;
	struct coordinator *c = g->of;
	while (!c->stopping) {
		pause_for(g, c->launch.socket, -1);
		const int connection = c->stopping ? -1 : listen_accept(c->launch.socket, g->peer);
		if (connection < 0) {
			// another thread accepted it, or there are no descriptors
			if (!c->stopping && errno != EAGAIN)
				pause_for(g, -1, LOOK_MS);
			continue;
		}
		set_socket(g, connection);
		pthread_mutex_lock(&c->lock);
		const bool next = --c->n_waiting > 0 || c->n == c->n_max || group_start(c);
		pthread_mutex_unlock(&c->lock);
		const enum listen_entry entry =
		    next && !c->stopping ? listen_entry(connection, c->launch.token) : LISTEN_NO_TOKEN;
		if (entry == LISTEN_TOKEN)
			serve(g);
		else if (!next) // the worker will reconnect
			say(g, "closed: no thread or descriptor to wait for further workers");
		else if (entry == LISTEN_OTHER_TOKEN)
			turn_away(g, "the token from %s differs from the one in --worker-token-file", g->peer);
		set_socket(g, -1);
		if (entry != LISTEN_TOKEN && !c->stopping)
			pause_for(g, -1, REFUSED_MS);
		pthread_mutex_lock(&c->lock);
		c->n_waiting++;
		pthread_mutex_unlock(&c->lock);
	}
	return NULL;
}

/* Starts the thread of the next group, with the lock held; true also while stopping; false: no descriptor or thread. */
static bool group_start(struct coordinator *c)
{
	struct group *g = &c->groups[c->n];
	*g = (struct group){.of = c, .number = c->n + 1, .socket = -1};
	if (c->stopping || (g->wakes = eventfd(0, EFD_CLOEXEC | EFD_NONBLOCK)) < 0)
		return c->stopping;
	pthread_mutex_init(&g->lock, NULL);
	if (pthread_create(&g->thread, NULL, has_launcher(g) ? launched_run : waiting_run, g) != 0) {
		close(g->wakes);
		return false;
	}
	c->n_waiting += !has_launcher(g);
	c->n++;
	return true;
}

/* Starts the threads of the groups; launchers start when there are blocks.
 *
 * Test     client_worker: every_example_gives_the_same_bytes_with_any_number_of_groups,
 *          client_listen: workers_that_others_start_join_and_leave_at_any_time
 */
struct coordinator *coordinator_start(const struct launch *launch, const struct coordinator_source *source)
{
	const int n_launched = launch->command ? (launch->n ? launch->n : 1) : 0,
	          n_max = n_launched + (launch->at ? COORDINATOR_GROUPS_MAX : 0);
	struct coordinator *c = calloc(1, sizeof *c + (size_t)n_max * sizeof c->groups[0]);
	if (!c)
		return NULL;
	c->launch = *launch;
	c->source = *source;
	c->n_launched = n_launched;
	c->n_max = n_max;
	pthread_mutex_init(&c->lock, NULL);
	pthread_mutex_lock(&c->lock);
	bool started = true;
	for (int i = 0; i < n_launched + (launch->at != NULL) && started; i++)
		started = group_start(c);
	pthread_mutex_unlock(&c->lock);
	if (started)
		return c;
	coordinator_stop(c);
	return NULL;
}

void coordinator_wake(struct coordinator *c)
{
	const uint64_t one = 1;
	for (int i = 0; c && i < c->n; i++)
		if (write(c->groups[i].wakes, &one, sizeof one) < 0)
			continue; // already woken
}

int coordinator_groups(const struct coordinator *c)
{
	return c ? c->n_connected : 0;
}

long coordinator_blocks(const struct coordinator *c)
{
	return c ? c->n_blocks : 0;
}

void coordinator_stop(struct coordinator *c)
{
	if (!c)
		return;
	pthread_mutex_lock(&c->lock);
	c->stopping = true; // no further threads start
	pthread_mutex_unlock(&c->lock);
	coordinator_wake(c);
	for (int i = 0; i < c->n; i++) {
		struct group *g = &c->groups[i];
		pthread_mutex_lock(&g->lock);
		// a thread may be blocked in the middle of a message of a worker that does not answer
		if (g->socket >= 0)
			shutdown(g->socket, SHUT_RDWR);
		pthread_mutex_unlock(&g->lock);
	}
	for (int i = 0; i < c->n; i++) {
		pthread_join(c->groups[i].thread, NULL);
		pthread_mutex_destroy(&c->groups[i].lock);
		close(c->groups[i].wakes);
	}
	if (c->launch.at)
		close(c->launch.socket);
	pthread_mutex_destroy(&c->lock);
	free(c);
}
