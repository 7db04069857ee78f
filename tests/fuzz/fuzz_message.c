/* fuzz_message.c - any bytes as a connection: messages are taken until one has a fault or the bytes end; none that is let
 * through has a body longer than it may be.  The first byte says whose they are.  libFuzzer: make fuzz. */
#include <stdlib.h>
#include <sys/socket.h>
#include <unistd.h>

#include "schema/message/message.h"

int LLVMFuzzerTestOneInput(const uint8_t *bytes, size_t length);

int LLVMFuzzerTestOneInput(const uint8_t *bytes, size_t length)
{
	int ends[2];
	struct message m;
	char *body;
	if (length == 0 || socketpair(AF_UNIX, SOCK_STREAM, 0, ends) != 0)
		return 0;
	const enum message_sender sender = bytes[0] % 2 ? MESSAGE_OF_WORKER : MESSAGE_OF_COORDINATOR;
	if (send(ends[0], bytes + 1, length - 1, MSG_DONTWAIT) < 0)
		length = 1;
	close(ends[0]);
	for (size_t taken = 1; message_take(ends[1], sender, &m, &body);) {
		taken += sizeof m + message_body_size(&m);
		if (message_fault(&m, sender) || taken > length || (m.n > 0) != (body != NULL))
			abort();
		free(body);
	}
	close(ends[1]);
	return 0;
}
