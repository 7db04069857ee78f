/* message.h - messages between a coordinator and the workers that run blocks for it, over a socket.
 *
 * A message is a head of 32 bytes and a body of n bytes, or n doubles in native byte order.
 *
 *   worker       coordinator
 *   READY   ->                threads, version
 *           <-   STUDY        document: once, before the first block of the study
 *   DESIGN  ->                digest of the worker's design
 *           <-   BLOCK
 *   VALUES  ->                status, values
 *           <-   DROP         the study has ended
 *           <-   REFUSE       instead of all others: why the worker is refused
 *
 * Any thread. */
#ifndef MESSAGE_H
#define MESSAGE_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "engine/pound.h"

enum message_type {
	MESSAGE_READY = 1, /* `block` threads; body: version */
	MESSAGE_STUDY,     /* body: document */
	MESSAGE_DESIGN,    /* body: SHA-256, if the status is POUND_OK */
	MESSAGE_BLOCK,     /* run it */
	MESSAGE_VALUES,    /* body: doubles, if the status is POUND_OK */
	MESSAGE_DROP,      /* outstanding blocks return POUND_STOPPED */
	MESSAGE_REFUSE,    /* body: a sentence; the connection ends */
};

enum message_sender { MESSAGE_OF_WORKER, MESSAGE_OF_COORDINATOR };

enum {
	MESSAGE_THREADS_MAX = 4096,
	MESSAGE_VERSION_MAX = 64,       /* [bytes] */
	MESSAGE_TEXT_MAX = 256,         /* [bytes] */
	MESSAGE_DOCUMENT_MAX = 1 << 28, /* [bytes] */
	MESSAGE_VALUES_MAX = 1 << 27,   /* doubles */
	MESSAGE_DIGEST_SIZE = 32,       /* [bytes] */
	MESSAGE_TOKEN_SIZE = 64, /* [characters] hexadecimal digits of 256 bits: start of each connection */
	MESSAGE_SILENCE = 30,    /* [s] after which a connection without an answer is closed */
};

struct message {
	uint32_t type;
	int32_t block;
	int32_t status; /* enum pound_status */
	uint32_t n;     /* length of the body: bytes, or doubles of VALUES */
	uint64_t study; /* number of the study at the coordinator, from 1 */
	double cpu_s;   /* CPU time of the block [s] */
};

_Static_assert(sizeof(struct message) == 32, "a head has 32 bytes");

/* NULL, or a sentence about an invalid field of a head. */
const char *message_fault(const struct message *message, enum message_sender sender);
size_t message_body_size(const struct message *message); /* [bytes] of a valid head */

void message_prepare(int socket); /* sends without delay; a silent peer fails after MESSAGE_SILENCE */
/* Transfer all bytes; false: the connection ended or failed. */
bool message_send(int socket, const struct message *message, const void *body);
bool message_receive(int socket, void *bytes, size_t n);
/* Receives a checked head and its body on the heap (NULL: no body); false: close the connection. */
bool message_take(int socket, enum message_sender sender, struct message *message, char **body);

/* A digest of the conditions, besides the document, on which values of blocks depend: version, sizes of blocks, values of
 * the design, whose last bits may depend on the processor.  false: out of memory. */
bool message_design(const struct pound_study *study, struct pound_run *run,
                    uint8_t digest[MESSAGE_DIGEST_SIZE]);
/* Whether blocks may run on another machine: not with a solver whose results depend on the processor, and not of a convergence
 * study, which measures CPU times. */
bool message_movable(const struct pound_study *study);

#endif
