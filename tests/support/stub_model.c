/* stub_model.c - a model server by libmicrohttpd, a thread for each connection. */
#include "tests/support/stub_model.h"

#include <math.h>
#include <microhttpd.h>
#include <signal.h>
#include <string.h>
#include <sys/mman.h>
#include <sys/prctl.h>
#include <sys/wait.h>
#include <time.h>
#include <unistd.h>

#include "schema/json/json_pointer.h"
#include "schema/json/json_writer.h"
#include "tests/support/check.h"

enum { BODY_MAX = 4096, DELAYS_US = 5000 };

struct call {
	char body[BODY_MAX];
	size_t length;
};

struct stub {
	enum stub_manner manner;
	atomic_int *calls;
};

/* The Ishigami function. */
double stub_model_value(const double x[3])
{
	return sin(x[0]) + 7.0 * sin(x[1]) * sin(x[1]) + 0.1 * pow(x[2], 4) * sin(x[0]);
}

/* Hash of the inputs: selects the runs that fail pseudorandomly, but equally in every session. */
static unsigned mixed(const double x[3])
{
	unsigned long long bits, sum = 0;
	for (int j = 0; j < 3; j++) {
		memcpy(&bits, &x[j], sizeof bits);
		sum = (sum ^ bits) * 0x9E3779B97F4A7C15u;
		sum ^= sum >> 29;
	}
	return (unsigned)(sum >> 32);
}

bool stub_model_fails(const double x[3])
{
	return mixed(x) % 50 == 0;
}

double stub_model_noise(long seed)
{
	const double x[3] = {(double)seed, 0, 0};
	return mixed(x) / 4294967296.0 - 0.5;
}

static enum MHD_Result reply(struct MHD_Connection *connection, unsigned status, const char *text)
{
	struct MHD_Response *response =
	    MHD_create_response_from_buffer(strlen(text), (void *)(size_t)text, MHD_RESPMEM_MUST_COPY);
	enum MHD_Result queued = MHD_queue_response(connection, status, response);
	MHD_destroy_response(response);
	return queued;
}

static enum MHD_Result fail_run(struct MHD_Connection *connection, unsigned which)
{
	static const struct {
		unsigned status;
		const char *text;
	} failures[] = {
	    {500, "{\"error\": {\"type\": \"InvalidOutput\", \"message\": \"diverged\"}}"},
	    {400, "{\"error\": {\"type\": \"InvalidInput\", \"message\": \"out of range\"}}"},
	    {500, "500 Internal Server Error"},
	    {200, "{\"output\": [[null]]}"},
	    {200, "{\"output\": [[NaN]]}"},
	};
	which %= sizeof failures / sizeof failures[0];
	return reply(connection, failures[which].status, failures[which].text);
}

static enum MHD_Result evaluate(struct stub *stub, struct MHD_Connection *connection,
                                const struct reading *asked)
{
	const int n = atomic_fetch_add(stub->calls, 1) + 1;
	const double x[3] = {reading_number(asked, "/input/0/0"), reading_number(asked, "/input/1/0"),
	                     reading_number(asked, "/input/1/1")};
	double value = stub_model_value(x);
	char digits[WRITER_NUMBER_SIZE], text[128];
	if (stub->manner == STUB_SHUFFLED) {
		struct timespec time;
		clock_gettime(CLOCK_MONOTONIC, &time);
		usleep((unsigned)((time.tv_nsec / 7 + n * 7919L) % DELAYS_US));
	}
	if (stub->manner == STUB_FAILING && stub_model_fails(x))
		return fail_run(connection, mixed(x) / 50);
	if (stub->manner == STUB_DEAD || (stub->manner == STUB_SHAKY && n % 40 == 0))
		return reply(connection, 503, "busy");
	if (stub->manner == STUB_SHAKY && n % 40 == 20)
		return MHD_NO;
	if (stub->manner == STUB_REFUSING)
		return reply(connection, 401, "who are you?");
	while (stub->manner == STUB_SILENT)
		pause();
	if (stub->manner == STUB_NOISY)
		value += stub_model_noise((long)reading_number(asked, "/config/seed"));
	writer_digits(value, digits);
	snprintf(text, sizeof text, "{\"output\": [[%s%s]]}", digits, stub->manner == STUB_WIDE ? ", 1" : "");
	return reply(connection, 200, text);
}

static enum MHD_Result answer(void *of, struct MHD_Connection *connection, const char *path,
                              const char *method, const char *version, const char *bytes, size_t *n,
                              void **kept)
{
	struct stub *stub = of;
	struct call *call = *kept;
	(void)method;
	(void)version;
	if (!call) {
		*kept = calloc(1, sizeof *call);
		return *kept ? MHD_YES : MHD_NO;
	}
	if (*n) {
		const size_t take = *n < BODY_MAX - call->length ? *n : BODY_MAX - call->length;
		memcpy(call->body + call->length, bytes, take);
		call->length += take;
		*n = 0;
		return MHD_YES;
	}
	struct reading *asked = reading_open(call->body, call->length);
	const char *name = asked ? reading_text(asked, "/name") : NULL;
	enum MHD_Result replied;
	if (!strcmp(path, "/Info"))
		replied = reply(connection, 200, "{\"protocolVersion\": 1.0, \"models\": [\"forward\"]}");
	else if (!name || strcmp(name, "forward") != 0)
		replied =
		    reply(connection, 400,
		          "{\"error\": {\"type\": \"ModelNotFound\", \"message\": \"there is forward alone\"}}");
	else if (!strcmp(path, "/InputSizes"))
		replied = reply(connection, 200, "{\"inputSizes\": [1, 2]}");
	else if (!strcmp(path, "/OutputSizes"))
		replied = reply(connection, 200, "{\"outputSizes\": [1]}");
	else if (!strcmp(path, "/Evaluate"))
		replied = evaluate(stub, connection, asked);
	else
		replied = reply(connection, 404, "");
	reading_close(asked);
	return replied;
}

static void completed(void *of, struct MHD_Connection *connection, void **kept,
                      enum MHD_RequestTerminationCode why)
{
	(void)of;
	(void)connection;
	(void)why;
	free(*kept);
}

/* Runs in the child and does not return: serves until the child is killed or its parent ends. */
static void serve(struct stub *stub, int port_to)
{
	prctl(PR_SET_PDEATHSIG, SIGKILL);
	struct MHD_Daemon *daemon =
	    MHD_start_daemon(MHD_USE_THREAD_PER_CONNECTION | MHD_USE_INTERNAL_POLLING_THREAD, 0, NULL, NULL,
	                     answer, stub, MHD_OPTION_NOTIFY_COMPLETED, completed, NULL, MHD_OPTION_END);
	int port = daemon ? MHD_get_daemon_info(daemon, MHD_DAEMON_INFO_BIND_PORT)->port : 0;
	if (write(port_to, &port, sizeof port) != sizeof port)
		_exit(1);
	for (;;)
		pause();
}

struct stub_model stub_model_start(enum stub_manner manner)
{
	int ends[2], port = 0;
	struct stub_model model = {
	    .calls = mmap(NULL, sizeof *model.calls, PROT_READ | PROT_WRITE, MAP_SHARED | MAP_ANONYMOUS, -1, 0)};
	assert_true(model.calls != MAP_FAILED);
	assert_int_equal(pipe(ends), 0);
	model.pid = fork();
	assert_true(model.pid >= 0);
	if (model.pid == 0)
		serve(&(struct stub){manner, model.calls}, ends[1]);
	assert_int_equal(read(ends[0], &port, sizeof port), sizeof port);
	assert_true(port > 0);
	close(ends[0]);
	close(ends[1]);
	snprintf(model.url, sizeof model.url, "http://127.0.0.1:%d", port);
	return model;
}

void stub_model_stop(struct stub_model *model)
{
	kill(model->pid, SIGKILL);
	waitpid(model->pid, NULL, 0);
	munmap(model->calls, sizeof *model->calls);
}
