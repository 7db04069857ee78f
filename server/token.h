/* token.h - who may use the server: bearer tokens of a file, kept as their SHA-256.  Constant after start; any thread. */
#ifndef TOKEN_H
#define TOKEN_H

enum { TOKEN_NAME_SIZE = 17 };

struct tokens;

/* A token a line, # starts a remark; for free.  NULL: it cannot be read, others can, or a token is short; logged. */
struct tokens *tokens_open(const char *file);

/* The one that an Authorization header has (NULL: there is no such header), as a name that does not give it away:
 * the first 16 hexadecimal digits of its SHA-256.  NULL: none of them. */
const char *tokens_name(const struct tokens *tokens, const char *authorization);

#endif
