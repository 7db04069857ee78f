/* The store without a server: order, states, and operations that happen once. */
#include "server/store.h"

#include <pthread.h>
#include <signal.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

#include <sqlite3.h>

#include "tests/support/check.h"

static enum store_status claim(struct store *store, int64_t *id)
{
	struct store_claimed claimed = {0};
	enum store_status status = store_claim(store, INT64_MAX, "", &claimed);
	*id = status == STORE_OK ? claimed.id : *id;
	return status;
}

static char path[64];

static int database(void **state)
{
	strcpy(path, "/tmp/poundd-store-XXXXXX");
	close(mkstemp(path)); // an empty file is a new database
	*state = store_open(path);
	return *state ? 0 : -1;
}

static int removal(void **state)
{
	static const char *const ends[] = {"", "-wal", "-shm", "-lock", "-ballast", "-v4"};
	if (*state)
		store_close(*state);
	for (size_t i = 0; i < sizeof ends / sizeof ends[0]; i++) {
		char name[96];
		snprintf(name, sizeof name, "%s%s", path, ends[i]);
		unlink(name);
	}
	return 0;
}

static int64_t submitted(struct store *store, const char *name)
{
	const struct store_study study = {.kind = "response", .name = name, .runs = 5, .hash = "hash"};
	int64_t id = 0;
	assert_int_equal(store_submit(store, &study, "{}", 2, &id), STORE_OK);
	return id;
}

static void name_keep(void *to, const struct study_status *study)
{
	snprintf(to, 128, "%s %s", study->name, study->status);
}

static void runs_keep(void *to, const struct study_status *study)
{
	*(int64_t *)to = study->runs_done;
}

/* Keeps a block; whether it was kept. */
static bool keep(struct store *store, int64_t id, const struct store_block *block)
{
	struct store_block mine = *block, *blocks[] = {&mine};
	mine.study = id;
	return store_keep(store, blocks, 1) == STORE_OK && mine.kept;
}

/* A server claims a study, keeps one block or none, crashes, and the store is opened again. */
static void crashed(void **state, int64_t id, const struct store_block *block)
{
	int status;
	store_close(*state);
	pid_t server = fork();
	if (server == 0) {
		int64_t claimed;
		struct store *store = store_open(path);
		if (!store || claim(store, &claimed) != STORE_OK || claimed != id)
			_exit(1);
		if (block && !keep(store, id, block))
			_exit(1);
		store_blame(store, id);
		_exit(0);
	}
	assert_int_equal(waitpid(server, &status, 0), server);
	assert_int_equal(status, 0);
	*state = store_open(path);
	assert_non_null(*state);
}

static void ids_grow_within_one_millisecond(void **state)
{
	int64_t last = 0;
	for (int i = 0; i < 50; i++) {
		int64_t id = submitted(*state, "a");
		assert_true(id > last);
		last = id;
	}
}

static void the_oldest_queued_study_is_claimed_first(void **state)
{
	int64_t first = submitted(*state, "first"), second = submitted(*state, "second"), id = 0;
	assert_int_equal(claim(*state, &id), STORE_OK);
	assert_true(id == first);
	assert_int_equal(claim(*state, &id), STORE_OK);
	assert_true(id == second);
	assert_int_equal(claim(*state, &id), STORE_NONE);
}

static void a_study_finishes_once(void **state)
{
	char *result;
	size_t length;
	int64_t id = submitted(*state, "a");
	assert_int_equal(store_finish(*state, id, "1", 1, NULL, 0), STORE_NONE); // not running yet
	assert_int_equal(claim(*state, &id), STORE_OK);
	assert_int_equal(store_document(*state, id, "result", &result, &length), STORE_NONE);
	assert_int_equal(store_finish(*state, id, "1", 1, NULL, 0), STORE_OK);
	assert_int_equal(store_finish(*state, id, "2", 1, NULL, 0), STORE_NONE);
	assert_int_equal(store_finish(*state, id, NULL, 0, "too late", 0), STORE_NONE);
	assert_int_equal(store_cancel(*state, id), STORE_NONE);
	assert_int_equal(store_document(*state, id, "result", &result, &length), STORE_OK);
	assert_string_equal(result, "1");
	free(result);
}

static void a_study_of_another_token_is_claimed_before_an_older_one(void **state)
{
	int64_t ids[3];
	for (int i = 0; i < 3; i++) {
		const struct store_study study = {
		    .kind = "response", .runs = 5, .hash = "hash", .client = i < 2 ? "first" : "second"};
		assert_int_equal(store_submit(*state, &study, "{}", 2, &ids[i]), STORE_OK);
	}
	struct store_claimed claimed;
	static const char *const avoided[] = {"", "first", "first"};
	static const int expected[] = {0, 2, 1};
	for (int i = 0; i < 3; i++) {
		assert_int_equal(store_claim(*state, INT64_MAX, avoided[i], &claimed), STORE_OK);
		assert_true(claimed.id == ids[expected[i]]);
		assert_string_equal(claimed.client, expected[i] < 2 ? "first" : "second");
	}
	assert_int_equal(store_claim(*state, INT64_MAX, "first", &claimed), STORE_NONE);
}

static void blocks_are_kept_together_and_only_while_their_studies_run(void **state)
{
	const double values[] = {1, 2, 3};
	const struct store_block block = {.number = 0, .runs = 5, .cpu_s = 0.5, .n = 3, .values = values};
	int64_t id = submitted(*state, "a"), other = submitted(*state, "b"), sum = 0;
	assert_false(keep(*state, id, &block));
	assert_int_equal(claim(*state, &id), STORE_OK);
	assert_true(keep(*state, id, &block));
	// of two studies alternately, one of which does not run
	struct store_block mixed[6], *blocks[6];
	for (int i = 0; i < 6; i++) {
		mixed[i] = block;
		mixed[i].study = i % 2 ? other : id;
		mixed[i].number = i;
		blocks[i] = &mixed[i];
	}
	assert_int_equal(store_keep(*state, blocks, 6), STORE_OK);
	for (int i = 0; i < 6; i++)
		assert_int_equal(mixed[i].kept, i % 2 == 0);
	assert_int_equal(store_study(*state, id, runs_keep, &sum), STORE_OK);
	assert_int_equal(sum, 3 * 5);
	assert_int_equal(store_study(*state, other, runs_keep, &sum), STORE_OK);
	assert_int_equal(sum, 0);
	assert_int_equal(store_cancel(*state, id), STORE_OK);
	assert_false(keep(*state, id, &block));
	assert_int_equal(store_delete(*state, id), STORE_OK);
	assert_false(keep(*state, id, &block));
}

static void a_failed_study_says_why(void **state)
{
	char known[128] = "";
	int64_t id = submitted(*state, "a");
	assert_int_equal(claim(*state, &id), STORE_OK);
	assert_int_equal(store_finish(*state, id, NULL, 0, "out of memory", 0), STORE_OK);
	assert_int_equal(store_study(*state, id, name_keep, known), STORE_OK);
	assert_string_equal(known, "a failed");
}

static void names_are_bytes_and_never_sql(void **state)
{
	static const char *const names[] = {"'; DROP TABLE study; --", "\" OR 1=1", "\xc3\xa4\xe2\x82\xac",
	                                    "%s%n", ""};
	for (size_t i = 0; i < sizeof names / sizeof names[0]; i++) {
		char known[128] = "", want[128];
		int64_t id = submitted(*state, names[i]);
		assert_int_equal(store_study(*state, id, name_keep, known), STORE_OK);
		snprintf(want, sizeof want, "%s queued", names[i]);
		assert_string_equal(known, want);
	}
}

static void a_store_in_use_is_not_opened_again(void **state)
{
	(void)state;
	assert_null(store_open(path));
}

/* Opens a store under another name of the file in use, created by `make`; NULL: refused. */
static struct store *opened_by(int (*make)(const char *, const char *), const char *name)
{
	assert_int_equal(make(path, name), 0);
	struct store *store = store_open(name);
	unlink(name);
	return store;
}

static void a_store_in_use_is_not_opened_by_another_name(void **state)
{
	char name[96], link_of_link[128];
	snprintf(name, sizeof name, "%s-link", path);
	snprintf(link_of_link, sizeof link_of_link, "%s-of-link", name);
	assert_null(opened_by(symlink, name));
	assert_int_equal(symlink(path, name), 0);
	assert_int_equal(symlink(strrchr(name, '/') + 1, link_of_link), 0);
	assert_null(store_open(link_of_link));
	unlink(link_of_link);
	unlink(name);
	// nor under the first name, while the file has two
	assert_null(opened_by(link, name));
	store_close(*state);
	*state = NULL;
	assert_null(opened_by(link, name));
	*state = store_open(path);
	assert_non_null(*state);
}

static void a_link_to_no_database_yet_makes_it_where_it_leads(void **state)
{
	char name[96];
	struct stat about;
	snprintf(name, sizeof name, "%s-link", path);
	store_close(*state);
	unlink(path);
	assert_int_equal(symlink(path, name), 0);
	*state = store_open(name);
	assert_non_null(*state);
	assert_int_equal(stat(path, &about), 0);
	assert_null(store_open(path));
	assert_null(store_open(name));
	strcat(name, "-lock");
	assert_int_not_equal(stat(name, &about), 0);
	name[strlen(name) - strlen("-lock")] = '\0';
	unlink(name);
}

/* The kernel releases the lock of a killed process only after its memory, which takes longer the larger the memory is. */
static void a_store_whose_server_was_just_killed_is_opened(void **state)
{
	enum { LARGE = 256 << 20 };
	char byte;
	int ready[2];
	store_close(*state);
	*state = NULL;
	assert_int_equal(pipe(ready), 0);
	pid_t server = fork();
	if (server == 0) {
		char *memory = malloc(LARGE);
		bool opened = store_open(path) != NULL;
		if (memory && opened && write(ready[1], memset(memory, 1, LARGE), 1) == 1)
			pause();
		_exit(1);
	}
	close(ready[1]);
	assert_int_equal(read(ready[0], &byte, 1), 1);
	close(ready[0]);
	kill(server, SIGKILL);
	*state = store_open(path);
	assert_non_null(*state);
	assert_int_equal(waitpid(server, NULL, 0), server);
}

static void a_running_study_is_queued_again_when_the_store_opens(void **state)
{
	char known[128];
	int64_t id = submitted(*state, "a"), other = 0;
	assert_int_equal(claim(*state, &id), STORE_OK);
	store_close(*state);
	*state = store_open(path);
	assert_non_null(*state);
	assert_int_equal(store_study(*state, id, name_keep, known), STORE_OK);
	assert_string_equal(known, "a queued");
	assert_int_equal(claim(*state, &other), STORE_OK);
	assert_true(other == id);
}

static void a_file_that_is_no_database_is_refused_and_left_alone(void **state)
{
	static const char text[] = "this is a letter, not a database; it is longer than the header of one, "
	                           "which has a hundred bytes, to the last of them.";
	char other[96], read[sizeof text] = "";
	(void)state;
	snprintf(other, sizeof other, "%s-letter", path);
	FILE *file = fopen(other, "w");
	assert_non_null(file);
	fputs(text, file);
	fclose(file);
	assert_null(store_open(other));
	file = fopen(other, "r");
	assert_non_null(fgets(read, sizeof read, file));
	fclose(file);
	assert_string_equal(read, text);
	unlink(other);
	strcat(other, "-lock");
	unlink(other);
}

static void a_key_stands_for_one_study(void **state)
{
	struct store_study study = {.kind = "response", .runs = 5, .key = "a key", .hash = "hash"};
	int64_t first = 0, again = 0, other = 0;
	assert_int_equal(store_submit(*state, &study, "{}", 2, &first), STORE_OK);
	assert_int_equal(store_submit(*state, &study, "{}", 2, &again), STORE_REPEATED);
	assert_true(again == first);
	assert_int_equal(store_submit(*state, &study, "{ }", 3, &other), STORE_CLASH);
	// a repeated study is found even if the queue is full
	study.queue_max = 1;
	assert_int_equal(store_submit(*state, &study, "{}", 2, &again), STORE_REPEATED);
	study.key = "b key";
	assert_int_equal(store_submit(*state, &study, "{}", 2, &other), STORE_CROWDED);
	study.queue_max = 2;
	assert_int_equal(store_submit(*state, &study, "{}", 2, &other), STORE_OK);
	assert_true(other != first);
	// a deleted study releases its key
	assert_int_equal(store_delete(*state, first), STORE_OK);
	study.key = "a key";
	assert_int_equal(store_submit(*state, &study, "{ }", 3, &again), STORE_OK);
}

/* Before version 3 keys were stored unchanged; since then they follow the name of the token, if any, and a space. */
static void keys_of_every_version_stand_for_their_studies(void **state)
{
	static const struct {
		const char *stored, *client, *asked; /* asked: the key in the form used since version 3 */
	} keys[] = {{"old", NULL, " old"},
	            {"old with spaces", NULL, " old with spaces"},
	            {"0123456789abcdef old", NULL, " 0123456789abcdef old"},
	            {" new", NULL, " new"},
	            {"0123456789abcdef new", "0123456789abcdef", "0123456789abcdef new"},
	            {"again", NULL, NULL}, // submitted before version 3, and again since:
	            {" again", NULL, " again"}};
	enum { KEYS = sizeof keys / sizeof keys[0] };
	int64_t ids[KEYS], id;
	sqlite3 *db;
	struct store_study study = {.kind = "response", .runs = 5, .hash = "hash"};
	for (int i = 0; i < KEYS; i++) {
		study.key = keys[i].stored;
		study.client = keys[i].client;
		assert_int_equal(store_submit(*state, &study, "{}", 2, &ids[i]), STORE_OK);
	}
	store_close(*state);
	assert_int_equal(sqlite3_open(path, &db), SQLITE_OK);
	assert_int_equal(sqlite3_exec(db,
	                              "PRAGMA user_version = 4; ALTER TABLE study DROP COLUMN cpu_s_estimated; "
	                              "ALTER TABLE study DROP COLUMN memory; DROP TABLE study_record; "
	                              "DROP TABLE record",
	                              NULL, NULL, NULL),
	                 SQLITE_OK);
	assert_int_equal(sqlite3_close(db), SQLITE_OK);
	*state = store_open(path);
	assert_non_null(*state);
	for (int i = 0; i < KEYS; i++) {
		if (!keys[i].asked)
			continue;
		study.key = keys[i].asked;
		assert_int_equal(store_submit(*state, &study, "{}", 2, &id), STORE_REPEATED);
		assert_true(id == ids[i]);
	}
}

enum { SUBMITTERS = 8, EACH = 20, QUEUE_MAX = 50, OWN_MAX = 20 };

/* one of several clients that submit at the same time */
struct submitter {
	struct store *store;
	struct store_study study;
	int answers[STORE_CLIENT_CROWDED + 1];
};

static void *submit_each(void *argument)
{
	struct submitter *s = argument;
	for (int i = 0; i < EACH; i++) {
		int64_t id;
		s->answers[store_submit(s->store, &s->study, "{}", 2, &id)]++;
	}
	return NULL;
}

/* How often each of two clients that submit at the same time received each answer. */
static void submit_all(struct store *store, int64_t own_max, int answers[2][STORE_CLIENT_CROWDED + 1])
{
	struct submitter submitters[SUBMITTERS];
	pthread_t threads[SUBMITTERS];
	for (int i = 0; i < SUBMITTERS; i++) {
		submitters[i] = (struct submitter){store,
		                                   {.kind = "response",
		                                    .runs = 5,
		                                    .hash = "hash",
		                                    .client = i % 2 ? "one" : "another",
		                                    .queue_max = QUEUE_MAX,
		                                    .own_max = own_max},
		                                   {0}};
		assert_int_equal(pthread_create(&threads[i], NULL, submit_each, &submitters[i]), 0);
	}
	memset(answers, 0, sizeof(int[2][STORE_CLIENT_CROWDED + 1]));
	for (int i = 0; i < SUBMITTERS; i++) {
		pthread_join(threads[i], NULL);
		for (int status = 0; status <= STORE_CLIENT_CROWDED; status++)
			answers[i % 2][status] += submitters[i].answers[status];
	}
}

static void no_more_are_queued_than_may_be(void **state)
{
	const int tries = SUBMITTERS / 2 * EACH;
	int answers[2][STORE_CLIENT_CROWDED + 1];
	submit_all(*state, OWN_MAX, answers);
	for (int client = 0; client < 2; client++) {
		assert_int_equal(answers[client][STORE_OK], OWN_MAX);
		assert_int_equal(answers[client][STORE_CLIENT_CROWDED], tries - OWN_MAX);
	}
	submit_all(*state, 0, answers);
	const int more = QUEUE_MAX - 2 * OWN_MAX;
	assert_int_equal(answers[0][STORE_OK] + answers[1][STORE_OK], more);
	assert_int_equal(answers[0][STORE_CROWDED] + answers[1][STORE_CROWDED], 2 * tries - more);
}

static void a_study_taken_three_times_in_vain_lets_the_others_go_first(void **state)
{
	int64_t first = submitted(*state, "first"), second = 0, id = 0;
	for (int i = 0; i < 3; i++) {
		store_close(*state);
		pid_t pid = fork();
		if (pid == 0) {
			// a server that is killed
			struct store *store = store_open(path);
			_exit(store && claim(store, &id) == STORE_OK && id == first ? 0 : 1);
		}
		int status;
		assert_int_equal(waitpid(pid, &status, 0), pid);
		assert_int_equal(status, 0);
		*state = store_open(path);
		assert_non_null(*state);
	}
	second = submitted(*state, "second");
	assert_int_equal(claim(*state, &id), STORE_OK);
	assert_true(id == second);
	assert_int_equal(claim(*state, &id), STORE_OK);
	assert_true(id == first);
}

static void only_crashes_that_follow_each_other_without_a_block_make_a_poison(void **state)
{
	const double value = 1;
	const struct store_block block = {.number = 0, .runs = 5, .n = 1, .values = &value};
	char known[128];
	int64_t id = submitted(*state, "a");
	// two crashes, one crash after a block, two crashes: never three in succession without a block
	for (int i = 0; i < 5; i++) {
		crashed(state, id, i == 2 ? &block : NULL);
		assert_int_equal(store_study(*state, id, name_keep, known), STORE_OK);
		assert_string_equal(known, "a queued");
	}
	crashed(state, id, NULL);
	assert_int_equal(store_study(*state, id, name_keep, known), STORE_OK);
	assert_string_equal(known, "a failed");
}

struct listed {
	char names[256]; /* each followed by a space */
};

static void name_add(void *to, const struct study_status *study)
{
	struct listed *listed = to;
	strcat(strcat(listed->names, study->name), " ");
}

static void list_is(struct store *store, struct store_filter filter, const char *names)
{
	struct listed listed = {""};
	filter.before = filter.before ? filter.before : INT64_MAX;
	filter.limit = 10;
	assert_int_equal(store_list(store, &filter, name_add, &listed), *names ? STORE_OK : STORE_NONE);
	assert_string_equal(listed.names, names);
}

static void a_list_has_the_studies_of_a_status_a_name_and_a_hash(void **state)
{
	static const char *const rows[][2] = {{"tower", "a"}, {"tower%", "b"}, {"bridge", "a"}, {"Tower", "b"}};
	int64_t ids[4], id = 0;
	for (int i = 0; i < 4; i++) {
		const struct store_study study = {
		    .kind = "response", .name = rows[i][0], .runs = 5, .hash = rows[i][1]};
		assert_int_equal(store_submit(*state, &study, "{}", 2, &ids[i]), STORE_OK);
	}
	assert_int_equal(claim(*state, &id), STORE_OK);
	list_is(*state, (struct store_filter){0}, "Tower bridge tower% tower ");
	list_is(*state, (struct store_filter){.name = "tower"}, "tower% tower ");
	// the name is matched as text, not as a pattern
	list_is(*state, (struct store_filter){.name = "%"}, "tower% ");
	list_is(*state, (struct store_filter){.hash = "a"}, "bridge tower ");
	list_is(*state, (struct store_filter){.hash = "a", .status = "running"}, "tower ");
	list_is(*state, (struct store_filter){.hash = "a", .name = "ow", .before = ids[0]}, "");
	list_is(*state, (struct store_filter){.name = "ow", .before = ids[3]}, "tower% tower ");
	list_is(*state, (struct store_filter){.name = "ow", .status = "queued"}, "Tower tower% ");
}

/* The server stops, a statement changes its database, and the store is opened again. */
static void changed_to(void **state, const char *sql)
{
	sqlite3 *db;
	store_close(*state);
	assert_int_equal(sqlite3_open(path, &db), SQLITE_OK);
	assert_int_equal(sqlite3_exec(db, sql, NULL, NULL, NULL), SQLITE_OK);
	sqlite3_close(db);
	*state = store_open(path);
	assert_non_null(*state);
}

static bool block_count(void *to, const struct store_block *block)
{
	(void)block;
	++*(int *)to;
	return true;
}

static int blocks_of(struct store *store, int64_t id)
{
	int n = 0;
	store_blocks(store, id, block_count, &n);
	return n;
}

/* Five studies that ended i days and an hour ago, each with a block, and one that has not ended. */
static void what_ended_too_long_ago_is_deleted_and_nothing_else(void **state)
{
	enum { N = 5, DAYS = 3, DAYS_BLOCKS = 1 };
	const double values[] = {1, 2, 3};
	const struct store_block block = {.number = 0, .runs = 5, .n = 3, .values = values};
	char known[128];
	int64_t ids[N + 1], id = 0;
	for (int i = 0; i <= N; i++) {
		ids[i] = submitted(*state, "a");
		assert_int_equal(claim(*state, &id), STORE_OK);
		assert_true(keep(*state, id, &block));
		if (i < N)
			assert_int_equal(i % 2 ? store_finish(*state, id, NULL, 0, "why", 0)
			                       : store_finish(*state, id, "1", 1, NULL, 0),
			                 STORE_OK);
	}
	assert_false(store_expire(*state, 1, 1));
	changed_to(state, "UPDATE study SET finished = finished - 3600000 - 86400000 * "
	                  "(SELECT count(*) FROM study AS other WHERE other.id < study.id)");
	assert_false(store_expire(*state, 0, 0));
	int n = 0;
	while (store_expire(*state, DAYS, DAYS_BLOCKS))
		n++;
	assert_int_equal(n, (N - DAYS) + (DAYS - DAYS_BLOCKS));
	for (int i = 0; i <= N; i++) {
		const bool there = i == N || i < DAYS, whole = i == N || i < DAYS_BLOCKS;
		assert_int_equal(store_study(*state, ids[i], name_keep, known), there ? STORE_OK : STORE_NONE);
		assert_int_equal(blocks_of(*state, ids[i]), whole);
	}
	char *result;
	size_t length;
	assert_int_equal(store_document(*state, ids[2], "result", &result, &length), STORE_OK);
	free(result);
}

#define STORED(test) cmocka_unit_test_setup_teardown(test, database, removal)

CHECK_MAIN(STORED(a_list_has_the_studies_of_a_status_a_name_and_a_hash),
           STORED(what_ended_too_long_ago_is_deleted_and_nothing_else), STORED(a_key_stands_for_one_study),
           STORED(keys_of_every_version_stand_for_their_studies), STORED(no_more_are_queued_than_may_be),
           STORED(a_study_taken_three_times_in_vain_lets_the_others_go_first),
           STORED(only_crashes_that_follow_each_other_without_a_block_make_a_poison),
           STORED(ids_grow_within_one_millisecond), STORED(the_oldest_queued_study_is_claimed_first),
           STORED(a_study_finishes_once), STORED(a_study_of_another_token_is_claimed_before_an_older_one),
           STORED(blocks_are_kept_together_and_only_while_their_studies_run), STORED(a_failed_study_says_why),
           STORED(names_are_bytes_and_never_sql), STORED(a_store_in_use_is_not_opened_again),
           STORED(a_store_in_use_is_not_opened_by_another_name),
           STORED(a_link_to_no_database_yet_makes_it_where_it_leads),
           STORED(a_store_whose_server_was_just_killed_is_opened),
           STORED(a_running_study_is_queued_again_when_the_store_opens),
           STORED(a_file_that_is_no_database_is_refused_and_left_alone))
