/* fair_share.h - at most so many answers that take long at once, of one client and in all.  Any thread. */
#ifndef FAIR_SHARE_H
#define FAIR_SHARE_H

#include <pthread.h>
#include <stdbool.h>

enum {
	SHARES = 64,            /* answers that wait or are made, all together; more are refused */
	SHARE_MOST = 16,        /* of one client's */
	SHARE_CLIENT_SIZE = 64, /* [bytes] */
};

struct shares {
	pthread_mutex_t lock;
	char clients[SHARES][SHARE_CLIENT_SIZE]; /* whose each is, "": nobody's */
};

int share_take(struct shares *shares,
               const char *client); /* its place, for share_give; -1: there are as many as may be */
void share_give(struct shares *shares, int place);

#endif
