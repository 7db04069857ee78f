/* Bearer tokens: their owners, and which files may hold them. */
#include "server/token.h"

#include <fcntl.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include "tests/support/check.h"

static const char RIGHT[] = "0123456789abcdef0123456789abcdef";

/* The tokens of a file with this text and mode; NULL: refused. */
static struct tokens *opened(const char *text, mode_t mode)
{
	char path[] = "/tmp/pound-token-XXXXXX";
	int file = mkstemp(path);
	assert_true(write(file, text, strlen(text)) == (ssize_t)strlen(text));
	assert_int_equal(fchmod(file, mode), 0);
	close(file);
	struct tokens *tokens = tokens_open(path);
	unlink(path);
	return tokens;
}

static void a_token_is_known_to_its_last_character(void **state)
{
	(void)state;
	struct tokens *tokens = opened("# people\n0123456789abcdef0123456789abcdef  # anna\n\n"
	                               "fedcba9876543210fedcba9876543210\n",
	                               0600);
	assert_non_null(tokens);
	const char *anna = tokens_name(tokens, "Bearer 0123456789abcdef0123456789abcdef");
	const char *other = tokens_name(tokens, "bearer  fedcba9876543210fedcba9876543210");
	assert_non_null(anna);
	assert_non_null(other);
	assert_int_equal(strlen(anna), TOKEN_NAME_SIZE - 1);
	assert_string_not_equal(anna, other);
	assert_null(strstr(RIGHT, anna));
	assert_null(tokens_name(tokens, NULL));
	assert_null(tokens_name(tokens, ""));
	assert_null(tokens_name(tokens, "Bearer"));
	assert_null(tokens_name(tokens, "Bearer "));
	assert_null(tokens_name(tokens, "Basic 0123456789abcdef0123456789abcdef"));
	assert_null(tokens_name(tokens, RIGHT));
	for (size_t n = 0; n < strlen(RIGHT); n++) {
		char wrong[64];
		snprintf(wrong, sizeof wrong, "Bearer %.*s", (int)n, RIGHT); // only the beginning
		assert_null(tokens_name(tokens, wrong));
		snprintf(wrong, sizeof wrong, "Bearer %s", RIGHT);
		wrong[7 + n] ^= 1; // one bit wrong
		assert_null(tokens_name(tokens, wrong));
	}
	assert_null(tokens_name(tokens, "Bearer 0123456789ABCDEF0123456789ABCDEF"));
	assert_null(tokens_name(tokens, "Bearer 0123456789abcdef0123456789abcdef0"));
	assert_null(tokens_name(tokens, "Bearer # people"));
	free(tokens);
}

static void a_file_that_others_may_read_is_refused(void **state)
{
	static const mode_t modes[] = {0640, 0604, 0620, 0601, 0666};
	(void)state;
	for (size_t i = 0; i < sizeof modes / sizeof modes[0]; i++)
		assert_null(opened(RIGHT, modes[i]));
	struct tokens *tokens = opened(RIGHT, 0400);
	assert_non_null(tokens);
	free(tokens);
}

static void a_file_without_a_good_token_is_refused(void **state)
{
	(void)state;
	assert_null(opened("", 0600));
	assert_null(opened("# nobody\n\n", 0600));
	assert_null(opened("short\n", 0600));
	assert_null(opened("0123456789abcdef0123456789abcdef\n0123456789abcdef0123456789abcde\n", 0600));
	// one long line is not read as two tokens
	char line[1024];
	snprintf(line, sizeof line, "%01000d\n", 1);
	assert_null(opened(line, 0600));
	assert_null(tokens_open("/nonexistent"));
	assert_null(tokens_open("/tmp"));
}

CHECK_MAIN(cmocka_unit_test(a_token_is_known_to_its_last_character),
           cmocka_unit_test(a_file_that_others_may_read_is_refused),
           cmocka_unit_test(a_file_without_a_good_token_is_refused))
