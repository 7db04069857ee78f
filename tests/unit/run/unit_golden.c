/* unit_golden.c - the result bytes of every example without timing, as hashes in tests/cases/golden.txt: the same at
 * every lane width, with 1, 2 and 4 threads, and in every version until one declares a change.
 *
 * `make test` uses few rows and omits the portable build, which is ten times slower; `make golden` computes whole
 * examples in every way (POUND_GOLDEN=whole).
 * For a version that changes results on purpose, POUND_GOLDEN=print prints the new file.
 * The Makefile links pound_dispatch_width through this file, which requests one width. */
#include <nettle/sha2.h>
#include <pthread.h>
#include <stdatomic.h>
#include <stdlib.h>
#include <string.h>

#include "engine/numeric/cpu_width.h"
#include "engine/pound.h"
#include "schema/examples/examples.h"
#include "schema/result/result_json.h"
#include "schema/study/study_json.h"
#include "tests/support/check.h"

enum {
	HASH_TEXT = 2 * SHA256_DIGEST_SIZE + 1,
	NAME_MAX_ = 64,
	THREADS_MAX = 4,
	ROWS_CUT = 24,
	RUNS_CUT = 1300,
	PORTABLE = -1
};

int __real_pound_dispatch_width(int lanes);
int __wrap_pound_dispatch_width(int lanes);

static int asked_lanes; /* 0: the widest of this machine; PORTABLE: one lane without fused instructions */

int __wrap_pound_dispatch_width(int lanes)
{
	if (asked_lanes == PORTABLE)
		return POUND_WIDTH_PORTABLE;
	return __real_pound_dispatch_width(lanes ? lanes : asked_lanes);
}

struct pool {
	struct pound_run *run;
	enum pound_status (*job)(struct pound_run *run, int index, int worker);
	int n_jobs;
	atomic_int next;
	pthread_barrier_t ready; /* all threads take jobs, even if one could do all of them */
};

struct member {
	pthread_t thread;
	struct pool *pool;
	int worker;
};

static void *member_work(void *of)
{
	const struct member *member = of;
	struct pool *pool = member->pool;
	pthread_barrier_wait(&pool->ready);
	for (int i; (i = atomic_fetch_add(&pool->next, 1)) < pool->n_jobs;)
		if (pool->job(pool->run, i, member->worker) != POUND_OK)
			abort();
	return NULL;
}

static void all_jobs(struct pool *pool, int first, int n_threads)
{
	struct member members[THREADS_MAX];
	atomic_store(&pool->next, first);
	pthread_barrier_init(&pool->ready, NULL, (unsigned)n_threads);
	for (int i = 0; i < n_threads; i++) {
		members[i] = (struct member){.pool = pool, .worker = i};
		assert_int_equal(pthread_create(&members[i].thread, NULL, member_work, &members[i]), 0);
	}
	for (int i = 0; i < n_threads; i++)
		pthread_join(members[i].thread, NULL);
	pthread_barrier_destroy(&pool->ready);
}

/* The SHA-256 of a study's result with a number of threads, in hexadecimal digits. */
static void hash_result(const struct pound_study *study, int n_threads, char hash[static HASH_TEXT])
{
	struct pool pool = {.run = pound_run_create(study, n_threads)};
	assert_non_null(pool.run);
	int done = 0;
	do {
		pool.job = pound_run_block;
		pool.n_jobs = pound_run_blocks(pool.run);
		all_jobs(&pool, done, n_threads);
		done = pool.n_jobs;
		pool.job = pound_run_reduce;
		pool.n_jobs = pound_run_reductions(pool.run);
		all_jobs(&pool, 0, n_threads);
	} while (pound_run_grow(pool.run));
	size_t n;
	char *json = result_to_json(study, pound_run_result(pool.run), NULL, &n);
	assert_non_null(json);
	struct sha256_ctx context;
	uint8_t digest[SHA256_DIGEST_SIZE];
	sha256_init(&context);
	sha256_update(&context, n, (const uint8_t *)json);
	sha256_digest(&context, sizeof digest, digest);
	for (int i = 0; i < SHA256_DIGEST_SIZE; i++)
		snprintf(hash + 2 * i, 3, "%02x", digest[i]);
	free(json);
	pound_run_free(pool.run);
}

/* The study of an example that this program can run, NULL for an external model; cut: with few rows. */
static struct pound_study *study_of(const char *text, bool cut)
{
	struct problems problems;
	struct pound_study *study = study_from_json(text, strlen(text), &problems);
	if (study && cut) {
		if (study->design.rows > ROWS_CUT)
			study->design.rows = ROWS_CUT;
		if (study->design.until.max_runs > RUNS_CUT)
			study->design.until.max_runs = RUNS_CUT;
		if (study->design.runs > RUNS_CUT)
			study->design.runs = RUNS_CUT;
	}
	return study;
}

static bool asked(const char *what)
{
	const char *golden = getenv("POUND_GOLDEN");
	return golden && strcmp(golden, what) == 0;
}

/* The hash in tests/cases/golden.txt for an example: lines of name, hash when cut, hash when whole. */
static void hash_known(const char *name, bool whole, char hash[static HASH_TEXT])
{
	FILE *file = fopen("tests/cases/golden.txt", "r");
	if (!file)
		fail_msg("there is no tests/cases/golden.txt here");
	char found[NAME_MAX_], of_cut[HASH_TEXT], of_whole[HASH_TEXT];
	hash[0] = '\0';
	while (fscanf(file, "%63s %64s %64s", found, of_cut, of_whole) == 3)
		if (strcmp(found, name) == 0)
			strcpy(hash, whole ? of_whole : of_cut);
	fclose(file);
	if (!hash[0])
		fail_msg("tests/cases/golden.txt has no example %s", name);
}

/* Prints new contents of tests/cases/golden.txt. */
static void print_hashes(void)
{
	for (int i = 0; example_name(i); i++) {
		char hashes[2][HASH_TEXT];
		struct pound_study *study = NULL;
		for (int whole = 0; whole < 2; whole++) {
			study = study_of(example_text(example_name(i)), !whole);
			if (!study)
				break;
			hash_result(study, 2, hashes[whole]);
			study_free(study);
		}
		if (study)
			printf("%s %s %s\n", example_name(i), hashes[0], hashes[1]);
	}
}

static void every_example_has_its_golden_bytes_at_every_width_and_by_1_2_and_4_threads(void **state)
{
	(void)state;
	static const struct {
		int lanes, n_threads;
	} ways[] = {{0, 1}, {4, 2}, {1, 4}, {PORTABLE, 2}, {0, 2}, {0, 4}, {8, 4}};
	bool whole = asked("whole");
	size_t n_ways = whole ? sizeof ways / sizeof ways[0] : 3;
	int n = 0;
	if (asked("print")) {
		print_hashes();
		return;
	}
	for (int i = 0; example_name(i); i++) {
		struct pound_study *study = study_of(example_text(example_name(i)), !whole);
		if (!study)
			continue;
		char known[HASH_TEXT], hash[HASH_TEXT];
		hash_known(example_name(i), whole, known);
		for (size_t way = 0; way < n_ways; way++) {
			asked_lanes = ways[way].lanes;
			if (asked_lanes > 0 && __real_pound_dispatch_width(asked_lanes) < 0)
				continue;
			hash_result(study, ways[way].n_threads, hash);
			if (strcmp(hash, known) != 0)
				fail_msg("%s at %d lanes by %d threads: %s, tests/cases/golden.txt has %s", example_name(i),
				         asked_lanes, ways[way].n_threads, hash, known);
			n++;
		}
		asked_lanes = 0;
		study_free(study);
	}
	check_report("%d results of examples, each with its golden bytes", n);
	assert_true(n > 40);
}

CHECK_MAIN(cmocka_unit_test(every_example_has_its_golden_bytes_at_every_width_and_by_1_2_and_4_threads))
