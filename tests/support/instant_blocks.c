/* Linked into a worker in the place of pound_run_block: a block takes POUND_BLOCK_US [us] without a processor, and its values are
 * zeros.  What is left is what it costs to assign blocks, to send their values and to store them. */
#include <stdlib.h>
#include <unistd.h>

#include "engine/pound.h"

enum pound_status __wrap_pound_run_block(struct pound_run *run, int block, int worker);

enum pound_status __wrap_pound_run_block(struct pound_run *run, int block, int worker)
{
	const char *us = getenv("POUND_BLOCK_US");
	(void)run;
	(void)block;
	(void)worker;
	if (us && atoi(us) > 0)
		usleep((useconds_t)atoi(us));
	return POUND_OK;
}
