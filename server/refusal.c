/* refusal.c - what the store says no with, as a reply. */
#include "server/refusal.h"

#include <stddef.h>

/* What the store says no with. */
struct reply refusal_of(enum store_status status, const char *absent)
{
	static const struct {
		enum api_fault fault;
		const char *detail;
	} refusals[] = {
	    [STORE_NONE] = {API_NOT_FOUND, NULL},
	    [STORE_CORRUPT] = {API_CORRUPT, "the stored bytes are damaged"},
	    [STORE_FAILED] = {API_UNAVAILABLE, "the database does not answer; please try again"},
	    [STORE_CLASH] = {API_KEY_REUSED, "this Idempotency-Key was used before with another body"},
	    [STORE_FULL] = {API_UNAVAILABLE, "the disk has no room for new studies"},
	    [STORE_REPLACED] =
	        {API_UNAVAILABLE,
	         "the database file was removed or replaced: nothing is accepted until the server is "
	         "started again"},
	    [STORE_CROWDED] = {API_UNAVAILABLE, "the queue is full"},
	    [STORE_UNRECORDED] = {API_UNAVAILABLE,
	                          "a record that the study names was just deleted: PUT it again"},
	    [STORE_CLIENT_CROWDED] = {API_TOO_MANY, "the queue has no room for more studies of this token"},
	};
	return http_problem(refusals[status].fault, status == STORE_NONE ? absent : refusals[status].detail,
	                    NULL);
}
