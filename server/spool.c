/* Long answers in files. */
#include "server/spool.h"

#include <stdlib.h>
#include <unistd.h>

#include "server/store.h"

/* Opens a file for a body.
 *
 * Returns  value   for spool_close; -1: the disk or the number of descriptors does not allow one now
 * Test     service_http: long_answers_wait_for_slow_readers_in_files_without_names
 */
int spool_open(struct spools *spools, size_t n)
{
	int file = -1;
	if (++spools->n <= spools->most)
		file = store_spool(spools->store, n);
	spools->n -= file < 0;
	return file;
}

void spool_close(struct spools *spools, int file)
{
	close(file);
	spools->n--;
}

void spool_reply(struct spools *spools, struct reply *reply)
{
	const bool is_long = reply->body && !reply->lasts && reply->length >= SPOOL_LONG;
	const int file = is_long ? spool_open(spools, reply->length) : -1;
	ssize_t written = 1;
	if (file < 0)
		return;
	for (size_t at = 0; written > 0 && at < reply->length; at += (size_t)written)
		written = write(file, reply->body + at, reply->length - at);
	if (written <= 0) {
		spool_close(spools, file);
		return;
	}
	free(reply->body);
	reply->body = NULL;
	reply->file = file;
}
