/* fair_share.c - the client of each slow answer. */
#include "server/fair_share.h"

#include <stdio.h>
#include <string.h>

/* Takes a place for one more answer.
 *
 * Given    client   not ""
 * Test     service_shares: who_asks_for_more_than_a_share_is_refused
 */
int share_take(struct shares *shares, const char *client)
{
	int place = -1, own = 0;
	pthread_mutex_lock(&shares->lock);
	for (int i = 0; i < SHARES; i++) {
		place = shares->clients[i][0] ? place : i;
		own += !strcmp(shares->clients[i], client);
	}
	if (own >= SHARE_MOST)
		place = -1;
	if (place >= 0)
		snprintf(shares->clients[place], SHARE_CLIENT_SIZE, "%s", client);
	pthread_mutex_unlock(&shares->lock);
	return place;
}

void share_give(struct shares *shares, int place)
{
	pthread_mutex_lock(&shares->lock);
	shares->clients[place][0] = '\0';
	pthread_mutex_unlock(&shares->lock);
}
