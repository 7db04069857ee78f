/* Messages between coordinator and workers: valid heads, and connections that end. */
#include <math.h>
#include <string.h>
#include <sys/socket.h>
#include <sys/wait.h>
#include <unistd.h>

#include "schema/examples/examples.h"
#include "schema/json/problems.h"
#include "schema/message/message.h"
#include "schema/study/study_json.h"
#include "tests/support/check.h"

/* A valid head of every type. */
static const struct message sound[] = {
    {.type = MESSAGE_READY, .block = 4, .n = 6},
    {.type = MESSAGE_STUDY, .study = 7, .n = 100},
    {.type = MESSAGE_DESIGN, .study = 7, .n = MESSAGE_DIGEST_SIZE},
    {.type = MESSAGE_DESIGN, .study = 7, .status = POUND_NOMEM},
    {.type = MESSAGE_BLOCK, .study = 7, .block = 3},
    {.type = MESSAGE_VALUES, .study = 7, .block = 3, .n = 5, .cpu_s = 0.25},
    {.type = MESSAGE_VALUES, .study = 7, .block = 3, .status = POUND_STOPPED, .cpu_s = 0.25},
    {.type = MESSAGE_DROP, .study = 7},
    {.type = MESSAGE_REFUSE, .n = 20},
};
enum { SOUND = sizeof sound / sizeof sound[0] };

static enum message_sender sender_of(const struct message *m)
{
	const bool worker = m->type == MESSAGE_READY || m->type == MESSAGE_DESIGN || m->type == MESSAGE_VALUES;
	return !worker ? MESSAGE_OF_COORDINATOR : MESSAGE_OF_WORKER;
}

/* Fails unless the fault of a head is about this field. */
static void check_fault(const struct message *m, const char *field)
{
	const char *fault = message_fault(m, sender_of(m));
	if (!fault || !strstr(fault, field))
		fail_msg("type %u: '%s' instead of a fault of its %s", m->type, fault ? fault : "none", field);
}

static void every_field_of_a_head_is_checked(void **state)
{
	(void)state;
	for (int i = 0; i < SOUND; i++) {
		const bool has_block = sound[i].block != 0,
		           has_status = sound[i].type == MESSAGE_DESIGN || sound[i].type == MESSAGE_VALUES;
		struct message m = sound[i];
		assert_null(message_fault(&m, sender_of(&m)));
		assert_non_null(message_fault(&m, !sender_of(&m)));
		for (uint32_t type = 0; type < 9; type++) {
			m = sound[i];
			m.type = type ? MESSAGE_REFUSE + type : 0;
			assert_non_null(message_fault(&m, MESSAGE_OF_WORKER));
			assert_non_null(message_fault(&m, MESSAGE_OF_COORDINATOR));
		}
		m = sound[i];
		m.block = -1;
		check_fault(&m, m.type == MESSAGE_READY ? "threads" : "block");
		m.block = m.type == MESSAGE_READY ? MESSAGE_THREADS_MAX + 1 : has_block ? INT32_MIN : 1;
		check_fault(&m, m.type == MESSAGE_READY ? "threads" : "block");
		m = sound[i];
		m.status = has_status ? 1 : POUND_NOMEM;
		check_fault(&m, "status");
		m.status = -1000;
		check_fault(&m, "status");
		m = sound[i];
		m.study = m.study ? 0 : 1;
		check_fault(&m, "study");
		m = sound[i];
		m.n = UINT32_MAX;
		check_fault(&m, "length");
		m.n = sound[i].n ? 0 : 1;
		check_fault(&m, "length");
		m = sound[i];
		m.cpu_s = NAN;
		check_fault(&m, "time");
		m.cpu_s = -1;
		check_fault(&m, "time");
		m.cpu_s = m.type == MESSAGE_VALUES ? INFINITY : 1;
		check_fault(&m, "time");
	}
}

static void a_connection_that_ends_at_any_byte_is_an_end(void **state)
{
	(void)state;
	for (int i = 0; i < SOUND; i++) {
		char bytes[32 + 1024] = {0}, *body;
		const size_t n = sizeof sound[i] + message_body_size(&sound[i]);
		memcpy(bytes, &sound[i], sizeof sound[i]);
		for (size_t k = sizeof sound[i]; k < n; k++)
			bytes[k] = (char)k;
		for (size_t k = 0; k <= n; k++) {
			int ends[2];
			struct message m;
			assert_int_equal(socketpair(AF_UNIX, SOCK_STREAM, 0, ends), 0);
			assert_int_equal(send(ends[0], bytes, k, 0), k);
			close(ends[0]);
			assert_int_equal(message_take(ends[1], sender_of(&sound[i]), &m, &body), k == n);
			assert_true(k == n && n > sizeof m ? memcmp(body, bytes + sizeof m, n - sizeof m) == 0 : !body);
			free(body);
			close(ends[1]);
		}
	}
}

static void what_is_sent_is_received(void **state)
{
	enum { N = 100000 }; // more than the buffer of a socket
	static double values[N];
	const struct message sent = {.type = MESSAGE_VALUES, .study = 1, .block = 2, .n = N, .cpu_s = 1};
	struct message m;
	char *body;
	int ends[2], status = 1;
	(void)state;
	for (int i = 0; i < N; i++)
		values[i] = i;
	assert_int_equal(socketpair(AF_UNIX, SOCK_STREAM, 0, ends), 0);
	pid_t child = fork();
	if (child == 0)
		_exit(!message_send(ends[0], &sent, values));
	assert_true(message_take(ends[1], MESSAGE_OF_WORKER, &m, &body));
	assert_memory_equal(&m, &sent, sizeof m);
	assert_memory_equal(body, values, sizeof values);
	free(body);
	assert_int_equal(waitpid(child, &status, 0), child);
	assert_int_equal(status, 0);
	close(ends[0]);
	close(ends[1]);
}

static struct pound_study *example(const char *name, const char *find, const char *put)
{
	const struct example *e = examples;
	while (strcmp(e->name, name) != 0)
		e++;
	struct problems problems;
	char *text = malloc(strlen(e->text) + 100);
	const char *at = find ? strstr(e->text, find) : NULL;
	strcpy(text, e->text);
	if (find) {
		assert_non_null(at);
		sprintf(text + (at - e->text), "%s%s", put, at + strlen(find));
	}
	struct pound_study *study = study_from_json(text, strlen(text), &problems);
	assert_non_null(study);
	free(text);
	return study;
}

static void the_digest_of_a_design_is_its_own(void **state)
{
	uint8_t digests[3][MESSAGE_DIGEST_SIZE];
	(void)state;
	for (int i = 0; i < 3; i++) {
		struct pound_study *study =
		    example("sensitivity_small", i == 2 ? "\"seed\": 42" : NULL, "\"seed\": 2");
		struct pound_run *run = pound_run_create(study, 1);
		assert_true(message_design(study, run, digests[i]));
		pound_run_free(run);
		study_free(study);
	}
	assert_memory_equal(digests[0], digests[1], MESSAGE_DIGEST_SIZE);
	assert_memory_not_equal(digests[0], digests[2], MESSAGE_DIGEST_SIZE);
}

static void what_depends_on_the_processor_stays_here(void **state)
{
	static const struct {
		const char *name;
		bool movable;
	} cases[] = {{"sensitivity_small", true}, {"convergence", false}};
	(void)state;
	for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
		struct pound_study *study = example(cases[i].name, NULL, NULL);
		assert_int_equal(message_movable(study), cases[i].movable);
		for (int method = 0; cases[i].movable && pound_solver_name(method); method++) {
			study->solver.method = method;
			assert_int_equal(message_movable(study), pound_solver_is_portable(method));
		}
		study_free(study);
	}
}

CHECK_MAIN(cmocka_unit_test(every_field_of_a_head_is_checked),
           cmocka_unit_test(a_connection_that_ends_at_any_byte_is_an_end),
           cmocka_unit_test(what_is_sent_is_received), cmocka_unit_test(the_digest_of_a_design_is_its_own),
           cmocka_unit_test(what_depends_on_the_processor_stays_here))
