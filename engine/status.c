/* status.c - what a status means, in words. */
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
