/* status.c - descriptions of the status values. */
#include "engine/pound.h"

const char *pound_status_text(enum pound_status status)
{
	switch (status) {
#define X(name, value, text) \
	case name:               \
		return text;
		POUND_STATUS(X)
#undef X
	}
	return "unknown status";
}

/* Why a study ended without a result; a run status then applies to all runs. */
const char *pound_status_error(enum pound_status status)
{
	static const char *const none[] = {
#define X(name, value, text) [name##_RUNS] = "all runs failed: " text,
	    POUND_FAILURES(X)
#undef X
	};
	return status <= POUND_CHATTER ? none[POUND_CHATTER - status] : pound_status_text(status);
}
