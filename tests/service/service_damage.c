/* A database with one flipped bit: the server refuses it or reports what is damaged, and never returns wrong data.
 *
 * This process opens the copies by the server's store, so that sanitizers check the store. */
#include <fcntl.h>
#include <string.h>
#include <unistd.h>

#include "server/store.h"
#include "tests/support/program.h"
#include "tests/support/service.h"

enum { STUDIES = 4, BLOCKS_MAX = 64 };

static const char *const names[] = {"request", "result"};

/* Content of the undamaged database. */
static struct {
	int64_t id;
	char *content[2];
	size_t length[2];
	int n_blocks;
	struct {
		double *values;
		int n;
	} block[BLOCKS_MAX]; /* by number */
} whole[STUDIES];

static struct {
	int copies, refused, same, damaged, missing, unread, wrong;
} count;

/* Copies a block to `whole`; study: index in `whole`, an int. */
static bool block_keep(void *study, const struct store_block *block)
{
	int i = *(int *)study;
	size_t size = sizeof *block->values * (size_t)block->n;
	assert_int_equal(block->number, whole[i].n_blocks);
	assert_true(block->number < BLOCKS_MAX);
	whole[i].block[whole[i].n_blocks].values = memcpy(malloc(size), block->values, size);
	whole[i].block[whole[i].n_blocks++].n = block->n;
	return true;
}

struct seen {
	int study, blocks;
};

static bool block_compare(void *of, const struct store_block *block)
{
	struct seen *seen = of;
	int i = seen->study;
	size_t size = sizeof *block->values * (size_t)block->n;
	bool same = block->number >= 0 && block->number < whole[i].n_blocks &&
	            block->n == whole[i].block[block->number].n &&
	            !memcmp(block->values, whole[i].block[block->number].values, size);
	count.wrong += !same;
	seen->blocks++;
	return true;
}

static void ignore(void *to, const struct study_status *study)
{
	// any content of the row is accepted
	*(int *)to += study->status != NULL;
}

static void look(struct store *store)
{
	int rows = 0;
	store_list(store, &(struct store_filter){.before = INT64_MAX, .limit = 100}, ignore, &rows);
	for (int i = 0; i < STUDIES; i++) {
		struct seen seen = {.study = i};
		// some or all blocks of the study, never a wrong value
		enum store_status blocks = store_blocks(store, whole[i].id, block_compare, &seen);
		if (blocks == STORE_CORRUPT)
			count.unread++;
		count.wrong += blocks == STORE_OK && seen.blocks > whole[i].n_blocks;
		for (int k = 0; k < 2; k++) {
			char *content = NULL;
			size_t length = 0;
			enum store_status status = store_document(store, whole[i].id, names[k], &content, &length);
			bool same = status == STORE_OK && length == whole[i].length[k] &&
			            !memcmp(content, whole[i].content[k], length);
			count.same += same;
			count.damaged += status == STORE_CORRUPT || status == STORE_FAILED;
			count.missing += status == STORE_NONE;
			count.wrong += status == STORE_OK && !same;
			free(content);
		}
	}
}

static void remember(struct service *service)
{
	service_start(service, 2);
	for (int i = 0; i < STUDIES; i++) {
		char *study = service_study(30 + i, 5, i), id[17];
		service_submit(service, study, id);
		whole[i].id = (int64_t)strtoull(id, NULL, 16);
		assert_true(service_wait(service, id, "succeeded", 0));
		free(study);
	}
	service_stop(service);
	struct store *store = store_open(service->database);
	assert_non_null(store);
	for (int i = 0; i < STUDIES; i++) {
		for (int k = 0; k < 2; k++)
			assert_int_equal(
			    store_document(store, whole[i].id, names[k], &whole[i].content[k], &whole[i].length[k]),
			    STORE_OK);
		assert_int_equal(store_blocks(store, whole[i].id, block_keep, &i), STORE_OK);
		assert_true(whole[i].n_blocks > 0);
	}
	store_close(store);
}

static void put(const char *path, const char *bytes, size_t n)
{
	int file = open(path, O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC, 0600);
	assert_true(file >= 0);
	assert_int_equal(write(file, bytes, n), n);
	close(file);
}

static void a_flipped_bit_is_refused_or_reported_and_never_served(void **state)
{
	struct service *service = service_new();
	char copy[96], removal[128];
	size_t n;
	int flips = check_count(1000, 10000);
	(void)state;
	remember(service);
	char *bytes = program_file(service->database, &n);
	snprintf(copy, sizeof copy, "%s/pound-damage-%d.db", access("/dev/shm", W_OK) == 0 ? "/dev/shm" : "/tmp",
	         (int)getpid());
	srand(1);
	for (; count.copies < flips; count.copies++) {
		// a third of the flips in the first two pages, which hold the structure of the tables
		size_t at = (size_t)rand() % (count.copies % 3 ? n : 8192);
		char flip = (char)(1 << rand() % 8);
		bytes[at] ^= flip;
		put(copy, bytes, n);
		struct store *store = store_open(copy);
		count.refused += !store;
		if (store) {
			look(store);
			store_close(store);
		}
		bytes[at] ^= flip;
		snprintf(removal, sizeof removal, "%s-wal", copy);
		unlink(removal);
	}
	check_report(
	    "flipped bits: %d; databases refused %d, documents the same %d, reported as damaged %d, missing %d, "
	    "wrong %d; studies with blocks left out %d",
	    count.copies, count.refused, count.same, count.damaged, count.missing, count.wrong, count.unread);
	assert_int_equal(count.wrong, 0);
	assert_true(count.refused > 0 && count.damaged > 0 && count.unread > 0);
	snprintf(removal, sizeof removal, "rm -f %s*", copy);
	assert_int_equal(system(removal), 0);
	for (int i = 0; i < STUDIES; i++) {
		for (int k = 0; k < 2; k++)
			free(whole[i].content[k]);
		for (int k = 0; k < whole[i].n_blocks; k++)
			free(whole[i].block[k].values);
	}
	free(bytes);
	service_free(service);
}

CHECK_MAIN(cmocka_unit_test(a_flipped_bit_is_refused_or_reported_and_never_served))
