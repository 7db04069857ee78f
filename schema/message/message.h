/* message.h - messages between a coordinator and the workers that run blocks for it, over a socket.
 *
 * A message is a head of 32 bytes and then its body: (n) bytes, or (n) doubles in memory order.
 *
 *   worker       coordinator
 *   READY   ->                threads, version
 *           <-   STUDY        document: once, before the first block of the study
 *   DESIGN  ->                digest of the worker's design
 *           <-   BLOCK
 *   VALUES  ->                status, values
 *           <-   DROP         the study has ended
 *           <-   REFUSE       in the place of all this: why the worker is not wanted
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
	MESSAGE_DESIGN,    /* body: SHA-256, when the status is POUND_OK */
	MESSAGE_BLOCK,     /* run it */
	MESSAGE_VALUES,    /* body: doubles, when the status is POUND_OK */
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
	MESSAGE_TOKEN_SIZE = 64, /* [characters] hexadecimal digits of 256 bits: what a connection starts with */
	MESSAGE_SILENCE = 30,    /* [s] after which a connection without an answer is closed */
};

struct message {
	uint32_t type;
	int32_t block;
	int32_t status; /* enum pound_status */
	uint32_t n;     /* of the body */
	uint64_t study; /* number that the coordinator gave it, from 1 */
	double cpu_s;   /* that the block took [s] */
};

_Static_assert(sizeof(struct message) == 32, "a head has 32 bytes");

/* NULL, or which field of a head is wrong. */
const char *message_fault(const struct message *message, enum message_sender sender);
size_t message_body_size(const struct message *message); /* [bytes] of a head without a fault */

void message_prepare(int socket); /* sent at once; a silent peer is an error after MESSAGE_SILENCE */
/* All of the bytes; false: the connection ended or failed. */
bool message_send(int socket, const struct message *message, const void *body);
bool message_receive(int socket, void *bytes, size_t n);
/* A head that is checked, and its body on the heap (NULL: it has none); false: the connection is to be closed. */
bool message_take(int socket, enum message_sender sender, struct message *message, char **body);

/* A digest of what the values of blocks depend on beside the document: the version, the sizes of the blocks, the values of
 * the design, whose last bits a processor may decide.  false: out of memory. */
bool message_design(const struct pound_study *study, struct pound_run *run,
                    uint8_t digest[MESSAGE_DIGEST_SIZE]);
/* Whether blocks may run on another machine: not with a solver whose bytes depend on the processor; a convergence study
 * measures CPU times. */
bool message_movable(const struct pound_study *study);

#endif
