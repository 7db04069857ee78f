/* Replaces pound_run_block in a worker: a block sleeps for POUND_BLOCK_US [us], and its values are zeros.  The
 * remaining time is the cost of assigning blocks, sending their values and storing them. */
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
