/* token.h - authentication of clients: bearer tokens of a file, kept as their SHA-256.  Constant after start; any thread. */
#ifndef TOKEN_H
#define TOKEN_H

enum { TOKEN_NAME_SIZE = 17 };

struct tokens;

/* One token per line, # starts a comment; release by free.  NULL: the file cannot be read, is accessible to other users, or has a
 * token that is too short; logged. */
struct tokens *tokens_open(const char *file);

/* The valid token in an Authorization header (NULL: no such header), as a name that does not reveal the token: the first
 * 16 hexadecimal digits of its SHA-256.  NULL: no valid token. */
const char *tokens_name(const struct tokens *tokens, const char *authorization);

#endif
