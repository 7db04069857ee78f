/* fair_share.h - limits on the slow answers at a time, of one client and in all.  Any thread. */
#ifndef FAIR_SHARE_H
#define FAIR_SHARE_H

#include <pthread.h>
#include <stdbool.h>

enum {
	SHARES = 64,            /* slow answers that wait or are made, of all clients; more are refused */
	SHARE_MOST = 16,        /* of one client */
	SHARE_CLIENT_SIZE = 64, /* [bytes] */
};

struct shares {
	pthread_mutex_t lock;
	char clients[SHARES][SHARE_CLIENT_SIZE]; /* the client of each place, "": free */
};

int share_take(struct shares *shares,
               const char *client); /* its place, for share_give; -1: a limit is reached */
void share_give(struct shares *shares, int place);

#endif
