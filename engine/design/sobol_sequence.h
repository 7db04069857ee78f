/* sobol_sequence.h - columns of scrambled Sobol' points, each point by its number. */
#ifndef NET_H
#define NET_H

#include "engine/numeric/random.h"

enum {
	POUND_NET_COLUMNS = 32,
	POUND_NET_DIGITS = 32, /* binary digits of a point, and of its number */
};

struct pound_net {
	uint32_t direction
	    [POUND_NET_DIGITS]; /* what bit k of a point's number adds to its digits, first digit highest */
	uint32_t shift;         /* added to every point */
};

void pound_net_init(struct pound_net *net, int column);
void pound_net_scramble(struct pound_net *net, struct pound_stream stream);
double pound_net_point(const struct pound_net *net, uint32_t number); /* in (0, 1) */

#endif
