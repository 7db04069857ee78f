/* refusal.h - what the store says no with, as a reply. */
#ifndef REFUSAL_H
#define REFUSAL_H

#include "server/http.h"
#include "server/store.h"

struct reply refusal_of(enum store_status status, const char *absent); /* absent: what STORE_NONE says */

#endif
