/* Bearer tokens.  A token sent by a client is hashed and compared with all bytes of every token's hash, so that the time
 * reveals nothing about the valid tokens. */
#include "server/token.h"

#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>
#include <sys/stat.h>

#include <nettle/memops.h>
#include <nettle/sha2.h>

#include "server/log.h"

enum { TOKENS_MAX = 100, TOKEN_LENGTH_MIN = 32 };

struct tokens {
	int n;
	struct {
		uint8_t sha256[SHA256_DIGEST_SIZE];
		char name[TOKEN_NAME_SIZE];
	} list[TOKENS_MAX];
};

static void hash(const char *token, size_t n, uint8_t sha256[SHA256_DIGEST_SIZE])
{
	struct sha256_ctx context;
	sha256_init(&context);
	sha256_update(&context, n, (const uint8_t *)token);
	sha256_digest(&context, SHA256_DIGEST_SIZE, sha256);
}

/* Reads the tokens of a file; NULL, or why it cannot. */
static const char *take(struct tokens *tokens, FILE *file)
{
	char line[512];
	struct stat about;
	if (fstat(fileno(file), &about) != 0 || !S_ISREG(about.st_mode))
		return "is not a file";
	if (about.st_mode & (S_IRWXG | S_IRWXO))
		return "may be used by others: chmod 600";
	while (fgets(line, sizeof line, file)) {
		if (strlen(line) == sizeof line - 1)
			return "has a line of more than 510 characters";
		line[strcspn(line, "\r\n#")] = '\0';
		const char *token = line + strspn(line, " \t");
		size_t n = strcspn(token, " \t");
		if (n == 0)
			continue;
		if (n < TOKEN_LENGTH_MIN)
			return "has a token of fewer than 32 characters";
		if (tokens->n == TOKENS_MAX)
			return "has more than 100 tokens";
		hash(token, n, tokens->list[tokens->n].sha256);
		for (int i = 0; i < TOKEN_NAME_SIZE / 2; i++)
			snprintf(tokens->list[tokens->n].name + 2 * i, 3, "%02x", tokens->list[tokens->n].sha256[i]);
		tokens->n++;
	}
	return ferror(file) ? "cannot be read" : tokens->n == 0 ? "has no token" : NULL;
}

/* Reads a file of tokens.
 *
 * Given    file    of mode 0600 or less; one token per line, 32 characters or more, # starts a comment
 * Returns  value   release by free; NULL: the file cannot be used, logged
 * Test     unit_token: a_file_that_others_may_read_is_refused
 */
struct tokens *tokens_open(const char *file)
{
	struct tokens *tokens = calloc(1, sizeof *tokens);
	FILE *in = fopen(file, "re");
	const char *fault = !tokens ? "does not fit into memory" : !in ? strerror(errno) : take(tokens, in);
	if (in)
		fclose(in);
	if (!fault)
		return tokens;
	log_line("token file %s: %s", file, fault);
	free(tokens);
	return NULL;
}

/* The name of the valid token in an Authorization header.
 *
 * Test     unit_token: a_token_is_known_to_its_last_character
 */
const char *tokens_name(const struct tokens *tokens, const char *authorization)
{
	static const char scheme[] = "Bearer ";
	uint8_t sha256[SHA256_DIGEST_SIZE];
	const char *name = NULL;
	if (!authorization || strncasecmp(authorization, scheme, sizeof scheme - 1) != 0)
		return NULL;
	const char *token = authorization + sizeof scheme - 1;
	token += strspn(token, " ");
	hash(token, strlen(token), sha256);
	for (int i = 0; i < tokens->n; i++)
		name = memeql_sec(sha256, tokens->list[i].sha256, sizeof sha256) ? tokens->list[i].name : name;
	return name;
}
