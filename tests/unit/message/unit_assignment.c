/* Which blocks are assigned, returned and done. */
#include "schema/message/assignment.h"
#include "tests/support/check.h"

/* The block that is assigned to a taker; -1: none. */
static int take(struct assignment *a, int n_blocks, int taker, double now)
{
	int block = assignment_next(a, n_blocks, taker, now);
	if (block >= 0)
		assignment_take(a, block, taker, now);
	return block;
}

static void blocks_are_taken_by_number_and_those_given_back_first(void **state)
{
	struct assignment a;
	(void)state;
	assert_true(assignment_init(&a, 5));
	for (int i = 0; i < 3; i++)
		assert_int_equal(take(&a, 4, i, 0), i);
	assignment_back(&a, 1, 1);
	assert_int_equal(take(&a, 4, 2, 0), 1);
	assignment_restore(&a, 3);
	assert_int_equal(take(&a, 4, 0, 0), -1);
	// the design has grown
	assert_int_equal(take(&a, 5, 0, 0), 4);
	for (int i = 0; i < 5; i++)
		assert_int_equal(assignment_is_done(&a, i), i == 3);
	assignment_free(&a);
}

static void a_block_that_is_out_for_long_runs_elsewhere_and_counts_once(void **state)
{
	struct assignment a;
	(void)state;
	assert_true(assignment_init(&a, 3));
	assert_int_equal(take(&a, 3, 1, 0), 0);
	assert_int_equal(take(&a, 3, 2, 0), 1);
	assert_int_equal(take(&a, 3, 0, 0), 2);
	assert_true(assignment_done(&a, 2, 0, 1)); // a mean of one second
	assert_int_equal(take(&a, 3, 2, 9.9), -1);
	assert_int_equal(take(&a, 3, 1, 10.1), 1); // not its own block
	assert_int_equal(take(&a, 3, 1, 10.2), -1);
	assert_int_equal(take(&a, 3, 0, 10.3), 0);
	assert_int_equal(take(&a, 3, 2, 30), -1); // a block that runs here is never late
	// the first values count; a thread of this process writes directly into the run, so values of others for its
	// block are discarded
	assert_true(assignment_done(&a, 1, 2, 30));
	assert_false(assignment_done(&a, 1, 1, 30));
	assert_false(assignment_done(&a, 0, 1, 30));
	assert_true(assignment_done(&a, 0, 0, 31));
	for (int i = 0; i < 3; i++)
		assert_true(assignment_is_done(&a, i));
	assignment_free(&a);
}

static void a_copy_that_is_given_back_frees_nothing(void **state)
{
	struct assignment a;
	(void)state;
	assert_true(assignment_init(&a, 1));
	assert_int_equal(take(&a, 1, 1, 0), 0);
	assert_int_equal(take(&a, 1, 2, 6), 0);
	assignment_back(&a, 0, 1);
	assert_int_equal(take(&a, 1, 3, 6), -1);
	assignment_back(&a, 0, 2);
	assert_int_equal(take(&a, 1, 3, 6), 0);
	assignment_free(&a);
}

CHECK_MAIN(cmocka_unit_test(blocks_are_taken_by_number_and_those_given_back_first),
           cmocka_unit_test(a_block_that_is_out_for_long_runs_elsewhere_and_counts_once),
           cmocka_unit_test(a_copy_that_is_given_back_frees_nothing))
