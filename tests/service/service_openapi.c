/* The OpenAPI document agrees with the server: every operation and status in it occurs, no others occur, and every answer
 * satisfies its schema. */
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include "schema/http/http_head.h"
#include "tests/support/jsonschema.h"
#include "tests/support/raw_http.h"

enum { HEAD_ROOM = (1 << 20) + 2 /* a body that is one byte too long, and a NUL */ };

enum situation { PLAIN, DAMAGED };

// {done}: a finished study; {new}: a study queued behind a long one; {none}: an id without a study
static const struct {
	enum situation situation;
	const char *method, *path;
	const char *headers[2];
	const char *body; /* NULL: none; "study": a small study; "stored": {done} as a model of UM-Bridge */
	int status;
} ASKED[] = {
    {PLAIN, "POST", "/v1/studies", {"Content-Type: application/json"}, "study", 201},
    {PLAIN, "POST", "/v1/studies?validate_only=true", {"Content-Type: application/json"}, "study", 200},
    {PLAIN, "POST", "/v1/studies?validate_only=1", {"Content-Type: application/json"}, "study", 400},
    {PLAIN, "POST", "/v1/studies", {"Content-Type: application/json"}, "{", 400},
    {PLAIN, "POST", "/v1/studies", {"Content-Type: application/json"}, "large", 413},
    {PLAIN, "POST", "/v1/studies", {"Content-Type: text/plain"}, "study", 415},
    {PLAIN, "POST", "/v1/studies", {"Content-Type: application/json", "Host: evil.example"}, "study", 421},
    {PLAIN, "POST", "/v1/studies", {"Content-Type: application/json"}, "{}", 422},
    {PLAIN, "POST", "/v1/studies", {"Content-Type: application/json", "Origin: null"}, "study", 403},
    {PLAIN, "POST", "/v1/studies/{new}/cancel", {"Origin: http://evil.example"}, NULL, 403},
    {PLAIN, "DELETE", "/v1/studies/{new}", {"Sec-Fetch-Site: cross-site"}, NULL, 403},
    {PLAIN, "GET", "/v1/studies", {0}, NULL, 200},
    {PLAIN, "GET", "/v1/studies?status=queued&limit=1", {0}, NULL, 200},
    {PLAIN, "GET", "/v1/studies?limit=0", {0}, NULL, 400},
    {PLAIN, "GET", "/v1/studies/{done}", {0}, NULL, 200},
    {PLAIN, "GET", "/v1/studies/{new}", {0}, NULL, 200},
    {PLAIN, "GET", "/v1/studies/{done}", {"If-None-Match: *"}, NULL, 304},
    {PLAIN, "GET", "/v1/studies/{none}", {0}, NULL, 404},
    {PLAIN, "GET", "/v1/studies/{done}/request", {0}, NULL, 200},
    {PLAIN, "GET", "/v1/studies/{done}/request", {"If-None-Match: *"}, NULL, 304},
    {PLAIN, "GET", "/v1/studies/{none}/request", {0}, NULL, 404},
    {PLAIN, "GET", "/v1/studies/{done}/results", {0}, NULL, 200},
    {PLAIN, "GET", "/v1/studies/{done}/results", {"Accept: text/csv"}, NULL, 200},
    {PLAIN, "GET", "/v1/studies/{done}/results", {"If-None-Match: *"}, NULL, 304},
    {PLAIN, "GET", "/v1/studies/{new}/results", {0}, NULL, 404},
    {PLAIN, "GET", "/v1/studies/{done}/samples", {0}, NULL, 200},
    {PLAIN, "GET", "/v1/studies/{done}/samples?format=npy", {0}, NULL, 200},
    {PLAIN, "GET", "/v1/studies/{done}/samples", {"If-None-Match: *"}, NULL, 304},
    {PLAIN, "GET", "/v1/studies/{new}/samples", {0}, NULL, 404},
    {PLAIN, "GET", "/v1/studies/{done}/motions", {0}, NULL, 200},
    {PLAIN, "GET", "/v1/studies/{done}/motions?format=npy", {0}, NULL, 200},
    {PLAIN, "GET", "/v1/studies/{done}/motions?format=at2&signal=0", {0}, NULL, 200},
    {PLAIN, "GET", "/v1/studies/{done}/motions?periods=0.5,1", {0}, NULL, 200},
    {PLAIN, "GET", "/v1/studies/{done}/motions", {"If-None-Match: *"}, NULL, 304},
    {PLAIN, "GET", "/v1/studies/{none}/motions", {0}, NULL, 404},
    {PLAIN, "GET", "/v1/studies/{done}/motions?signal=99999", {0}, NULL, 409},
    {PLAIN, "GET", "/v1/studies/{done}/motions?periods=1&format=npy", {0}, NULL, 400},
    {PLAIN, "GET", "/v1/studies/{done}/figures", {0}, NULL, 200},
    {PLAIN, "GET", "/v1/studies/{done}/figures", {"If-None-Match: *"}, NULL, 304},
    {PLAIN, "GET", "/v1/studies/{new}/figures", {0}, NULL, 404},
    {PLAIN, "GET", "/v1/studies/{done}/figures/indices", {0}, NULL, 200},
    {PLAIN, "GET", "/v1/studies/{done}/figures/indices?width=320&index=ST", {0}, NULL, 200},
    {PLAIN, "GET", "/v1/studies/{done}/figures/indices", {"If-None-Match: *"}, NULL, 304},
    {PLAIN, "GET", "/v1/studies/{done}/figures/indices?width=1", {0}, NULL, 400},
    {PLAIN, "GET", "/v1/studies/{done}/figures/errors", {0}, NULL, 409},
    {PLAIN, "GET", "/v1/studies/{new}/figures/indices", {0}, NULL, 404},
    {PLAIN, "POST", "/v1/studies/{done}/cancel", {0}, NULL, 409},
    {PLAIN, "POST", "/v1/studies/{new}/cancel", {0}, NULL, 200},
    {PLAIN, "POST", "/v1/studies/{none}/cancel", {0}, NULL, 404},
    {PLAIN, "GET", "/v1/studies/{new}/results", {0}, NULL, 409},
    {PLAIN, "GET", "/v1/studies/{new}/samples", {0}, NULL, 409},
    {PLAIN, "GET", "/v1/studies/{new}/figures", {0}, NULL, 409},
    {PLAIN, "GET", "/v1/studies/{new}/figures/indices", {0}, NULL, 409},
    {PLAIN, "DELETE", "/v1/studies/{new}", {0}, NULL, 204},
    {PLAIN, "DELETE", "/v1/studies/{none}", {0}, NULL, 404},
    {PLAIN,
     "PUT",
     "/v1/records/2cf24dba5fb0a30e26e83b2ac5b9e29e1b161e5c1fa7425e73043362938b9824",
     {0},
     "hello",
     201},
    {PLAIN,
     "PUT",
     "/v1/records/2cf24dba5fb0a30e26e83b2ac5b9e29e1b161e5c1fa7425e73043362938b9824",
     {0},
     "hello",
     204},
    {PLAIN,
     "PUT",
     "/v1/records/2cf24dba5fb0a30e26e83b2ac5b9e29e1b161e5c1fa7425e73043362938b9824",
     {0},
     "other",
     400},
    {PLAIN,
     "PUT",
     "/v1/records/2cf24dba5fb0a30e26e83b2ac5b9e29e1b161e5c1fa7425e73043362938b9824",
     {"Origin: null"},
     "hello",
     403},
    {PLAIN,
     "GET",
     "/v1/records/2cf24dba5fb0a30e26e83b2ac5b9e29e1b161e5c1fa7425e73043362938b9824",
     {0},
     NULL,
     200},
    {PLAIN,
     "GET",
     "/v1/records/2cf24dba5fb0a30e26e83b2ac5b9e29e1b161e5c1fa7425e73043362938b9824",
     {"If-None-Match: *"},
     NULL,
     304},
    {PLAIN,
     "GET",
     "/v1/records/0000000000000000000000000000000000000000000000000000000000000000",
     {0},
     NULL,
     404},
    {DAMAGED,
     "GET",
     "/v1/records/2cf24dba5fb0a30e26e83b2ac5b9e29e1b161e5c1fa7425e73043362938b9824",
     {0},
     NULL,
     500},
    {PLAIN, "GET", "/livez", {0}, NULL, 200},
    {PLAIN, "GET", "/readyz", {0}, NULL, 200},
    {PLAIN, "GET", "/metrics", {0}, NULL, 200},
    {PLAIN, "GET", "/version", {0}, NULL, 200},
    {PLAIN, "GET", "/v1/openapi.json", {0}, NULL, 200},
    {PLAIN, "GET", "/v1/openapi.json", {"If-None-Match: *"}, NULL, 304},
    {PLAIN, "GET", "/Info", {0}, NULL, 200},
    {PLAIN, "POST", "/ModelInfo", {0}, "stored", 200},
    {PLAIN, "POST", "/ModelInfo", {"Origin: null"}, "stored", 403},
    {PLAIN, "POST", "/InputSizes", {0}, "stored", 200},
    {PLAIN, "POST", "/InputSizes", {"Origin: null"}, "stored", 403},
    {PLAIN, "POST", "/OutputSizes", {0}, "stored", 200},
    {PLAIN, "POST", "/OutputSizes", {"Origin: null"}, "stored", 403},
    {PLAIN, "POST", "/Evaluate", {0}, "stored", 200},
    {PLAIN, "POST", "/Evaluate", {0}, "{\"name\": \"pound\"}", 400},
    {PLAIN, "POST", "/Evaluate", {"Origin: null"}, "stored", 403},
    {PLAIN, "POST", "/Gradient", {0}, "stored", 400},
    {PLAIN, "POST", "/Gradient", {"Origin: null"}, "stored", 403},
    {PLAIN, "POST", "/ApplyJacobian", {0}, "stored", 400},
    {PLAIN, "POST", "/ApplyJacobian", {"Origin: null"}, "stored", 403},
    {PLAIN, "POST", "/ApplyHessian", {0}, "stored", 400},
    {PLAIN, "POST", "/ApplyHessian", {"Origin: null"}, "stored", 403},
    {DAMAGED, "POST", "/ModelInfo", {0}, "stored", 500},
    {DAMAGED, "POST", "/InputSizes", {0}, "stored", 500},
    {DAMAGED, "POST", "/OutputSizes", {0}, "stored", 500},
    {DAMAGED, "POST", "/Evaluate", {0}, "stored", 500},
    {DAMAGED, "POST", "/Gradient", {0}, "stored", 500},
    {DAMAGED, "POST", "/ApplyJacobian", {0}, "stored", 500},
    {DAMAGED, "POST", "/ApplyHessian", {0}, "stored", 500},
    {PLAIN, "GET", "/v1/examples", {0}, NULL, 200},
    {PLAIN, "GET", "/v1/examples", {"If-None-Match: *"}, NULL, 304},
    {PLAIN, "GET", "/v1/examples/response", {0}, NULL, 200},
    {PLAIN, "GET", "/v1/examples/response", {"If-None-Match: *"}, NULL, 304},
    {PLAIN, "GET", "/v1/examples/nothing", {0}, NULL, 404},
    {PLAIN, "GET", "/", {0}, NULL, 200},
    {PLAIN, "GET", "/", {"If-None-Match: *"}, NULL, 304},
    {PLAIN, "GET", "/new", {0}, NULL, 200},
    {PLAIN, "GET", "/new", {"If-None-Match: *"}, NULL, 304},
    {PLAIN, "GET", "/studies/{done}", {0}, NULL, 200},
    {PLAIN, "GET", "/studies/{done}", {"If-None-Match: *"}, NULL, 304},
    {PLAIN, "GET", "/page.css", {0}, NULL, 200},
    {PLAIN, "GET", "/page.css", {"If-None-Match: *"}, NULL, 304},
    {PLAIN, "GET", "/page.js", {0}, NULL, 200},
    {PLAIN, "GET", "/page.js", {"If-None-Match: *"}, NULL, 304},
    {PLAIN, "GET", "/icon.svg", {0}, NULL, 200},
    {PLAIN, "GET", "/icon.svg", {"If-None-Match: *"}, NULL, 304},
    {DAMAGED, "GET", "/v1/studies/{done}/request", {0}, NULL, 500},
    {DAMAGED, "GET", "/v1/studies/{done}/results", {0}, NULL, 500},
    {DAMAGED, "GET", "/v1/studies/{done}/samples", {0}, NULL, 500},
    {DAMAGED, "GET", "/v1/studies/{done}/motions", {0}, NULL, 500},
    {DAMAGED, "GET", "/v1/studies/{done}/figures", {0}, NULL, 500},
    {DAMAGED, "GET", "/v1/studies/{done}/figures/indices", {0}, NULL, 500},
};

enum { HELD = 65 /* open connections; with these even probes are refused */ };

static const char STUDY_OF_A_TOKEN[] = "Authorization: Bearer 0123456789abcdef0123456789abcdef";

struct world {
	struct service *service;
	struct reading *api;
	char done[17], new[17], tokens[128];
	char *large, *study;
	bool seen[API_N_OPERATIONS][600];
	int n;
};

/* Sends one request; fails unless the document has the operation, the status, the headers and the schema of the answer.
 * Returns the status. */
static int ask(struct world *world, const char *method, const char *path, const char *const headers[2],
               const char *body)
{
	char target[HEAD_TARGET_MAX + 200], allow[64], pointer[160], schema[200], escaped[96] = "", stored[80];
	long long id;
	struct jsonschema_fault fault = {0};
	struct ask asked = {.method = method, .path = target, .headers = {headers[0], headers[1]}};
	if (body) {
		snprintf(stored, sizeof stored, "{\"name\": \"%s\", \"input\": [[3.1, 1, 0.6]]}", world->done);
		asked.body = !strcmp(body, "study")    ? world->study
		             : !strcmp(body, "large")  ? world->large
		             : !strcmp(body, "stored") ? stored
		                                       : body;
		asked.length = strlen(asked.body);
	}
	const char *open = strchr(path, '{'), *close = open ? strchr(open, '}') : NULL;
	const char *name = !open            ? ""
	                   : open[1] == 'd' ? world->done
	                   : open[2] == 'e' ? world->new
	                                    : "0123456789abcdef";
	snprintf(target, sizeof target, "%.*s%s%s", open ? (int)(open - path) : (int)strlen(path), path, name,
	         open ? close + 1 : "");
	struct answer answer = service_ask(world->service, &asked);
	int status = answer.status;
	char decoded[160];
	snprintf(decoded, sizeof decoded, "%.*s", (int)strcspn(target, "?"), target);
	int operation = api_match(method, decoded, &id, allow);
	if (operation < 0)
		fail_msg("%s %s is no operation", method, decoded);
	const char *form = api_operations[operation].path;
	for (size_t n = 0; *form; form++)
		n += (size_t)sprintf(escaped + n, *form == '/' ? "~1" : "%c", *form);
	snprintf(pointer, sizeof pointer, "/paths/%s/%s/responses/%d", escaped,
	         !strcmp(method, "GET")    ? "get"
	         : !strcmp(method, "POST") ? "post"
	         : !strcmp(method, "PUT")  ? "put"
	                                   : "delete",
	         status);
	if (!reading_has(world->api, "%s", pointer))
		fail_msg("%s %s: %d is not in the document\n%s", method, target, status, answer.body);
	const struct {
		const char *name, *value;
	} heads[] = {{"Location", answer.location}, {"ETag", answer.etag}, {"Retry-After", answer.retry_after}};
	for (int i = 0; i < 3; i++) {
		bool listed = reading_has(world->api, "%s/headers/%s", pointer, heads[i].name);
		// a 404 has Retry-After only if the result is not available yet
		if (listed != (*heads[i].value != '\0') && status != 404)
			fail_msg("%s %s: %d, %s '%s' is%s in the document", method, target, status, heads[i].name,
			         heads[i].value, listed ? "" : " not");
	}
	// the media type, and for JSON the schema
	char media[96] = "";
	for (const char *c = answer.type; *c && *c != ';'; c++)
		sprintf(media + strlen(media), *c == '/' ? "~1" : "%c", *c);
	snprintf(schema, sizeof schema, "%.120s/content/%.60s/schema", pointer, media);
	if (answer.length > 0 && !reading_has(world->api, "%s", schema))
		fail_msg("%s %s: %d as %s is not in the document", method, target, status, answer.type);
	if (answer.length > 0 && strstr(answer.type, "json")) {
		struct reading *value = answer_read(&answer);
		if (!jsonschema_takes(world->api, schema, value, "", &fault))
			fail_msg("%s %s: %d: %s %s\n%s", method, target, status, fault.pointer, fault.text, answer.body);
		reading_close(value);
	}
	world->seen[operation][status] = true;
	world->n++;
	answer_free(&answer);
	return status;
}

static void ask_all(struct world *world, enum situation situation)
{
	for (size_t i = 0; i < sizeof ASKED / sizeof ASKED[0]; i++) {
		const char *const headers[] = {ASKED[i].headers[0], ASKED[i].headers[1]};
		if (ASKED[i].situation != situation)
			continue;
		int status = ask(world, ASKED[i].method, ASKED[i].path, headers, ASKED[i].body);
		if (status != ASKED[i].status)
			fail_msg("%s %s: %d instead of %d", ASKED[i].method, ASKED[i].path, status, ASKED[i].status);
	}
}

/* Requests every operation, with a body if it takes one; fails unless each is answered with `status`. */
static void ask_each(struct world *world, const char *header, int status, bool open_too)
{
	static char arguments[HEAD_TARGET_MAX + 1];
	memset(arguments, '&', status == 414 ? sizeof arguments - 1 : 0);
	*arguments = '?';
	arguments[status == 414 ? sizeof arguments - 1 : 0] = '\0';
	for (int o = 0; o < API_N_OPERATIONS; o++) {
		const struct api_operation *operation = &api_operations[o];
		char path[HEAD_TARGET_MAX + 96];
		const char *rest = strstr(operation->path, "{id}");
		snprintf(path, sizeof path, "%.*s%s%s%s",
		         (int)(rest ? rest - operation->path : (long)strlen(operation->path)), operation->path,
		         rest ? "{none}" : "", rest ? rest + 4 : "", arguments);
		char *named = strstr(path, "{name}");
		if (named) {
			memmove(named + strlen("swept"), named + strlen("{name}"), strlen(named + strlen("{name}")) + 1);
			memcpy(named, "swept", strlen("swept"));
		}
		char *hash = strstr(path, "{sha256}");
		if (hash) {
			memmove(hash + 64, hash + strlen("{sha256}"), strlen(hash + strlen("{sha256}")) + 1);
			memset(hash, '0', 64);
		}
		const char *const headers[] = {"Content-Type: application/json", header};
		if (operation->open && !open_too)
			continue;
		int got = ask(world, operation->method, path, headers, operation->takes_study ? "study" : NULL);
		if (got != status)
			fail_msg("%s %s: %d instead of %d", operation->method, operation->path, got, status);
	}
}

static void begin(struct world *world)
{
	char first[17];
	struct answer answer;
	service_start(world->service, 1);
	if (!world->api) {
		answer = service_get(world->service, "/v1/openapi.json");
		world->api = answer_read(&answer);
		answer_free(&answer);
		service_submit(world->service, world->study, world->done);
		assert_true(service_wait(world->service, world->done, "succeeded", 0));
		char *lengthy = service_study(SERVICE_ROWS, 5, 1);
		service_submit(world->service, lengthy, first);
		assert_true(service_wait(world->service, first, "running", 1));
		service_submit(world->service, lengthy, world->new);
		free(lengthy);
	}
}

static void every_operation_and_status_of_the_document_happens_and_no_other(void **state)
{
	static struct world world;
	int documented = 0, seen = 0;
	(void)state;
	world.service = service_new();
	world.study = service_study(4, 2, 1);
	world.large = malloc(HEAD_ROOM);
	assert_non_null(world.large);
	memset(world.large, ' ', HEAD_ROOM);
	world.large[HEAD_ROOM - 1] = '\0';
	begin(&world);
	ask_all(&world, PLAIN);
	ask_each(&world, "Host: evil.example", 421, true);
	ask_each(&world, "X: \x01", 400, true);
	ask_each(&world, "Content-Length: 9000000", 413, true);
	ask_each(&world, "Transfer-Encoding: chunked", 411, true);
	ask_each(&world, NULL, 414, true);
	memset(world.large, 'X', HEAD_BYTES_MAX);
	world.large[1] = ':';
	world.large[HEAD_BYTES_MAX] = '\0';
	ask_each(&world, world.large, 431, true);
	service_stop(world.service);

	service_change(world.service, "UPDATE document SET content = CAST(replace(content, '1', '2') AS BLOB);"
	                              "UPDATE record SET content = x'00'");
	begin(&world);
	ask_all(&world, DAMAGED);
	service_stop(world.service);

	setenv("POUNDD_CONNECTIONS_MAX", "1", 1);
	begin(&world);
	int held[HELD];
	for (int i = 0; i < HELD; i++)
		held[i] = raw_open(world.service);
	// one of them may have been refused while an earlier connection was still counted
	const char *const none[2] = {NULL, NULL};
	for (int i = 0; i < 100 && ask(&world, "GET", "/livez", none, NULL) != 503; i++) {
		close(held[0]);
		held[0] = raw_open(world.service);
	}
	ask_each(&world, NULL, 503, true);
	for (int i = 0; i < HELD; i++)
		close(held[i]);
	service_stop(world.service);
	unsetenv("POUNDD_CONNECTIONS_MAX");

	snprintf(world.tokens, sizeof world.tokens, "%s.tokens", world.service->log);
	FILE *file = fopen(world.tokens, "w");
	fprintf(file, "%s\n", STUDY_OF_A_TOKEN + strlen("Authorization: Bearer "));
	fclose(file);
	chmod(world.tokens, 0600);
	setenv("POUNDD_TOKEN_FILE", world.tokens, 1);
	setenv("POUNDD_QUEUE_TOKEN_MAX", "1", 1);
	service_change(world.service, "UPDATE study SET client = 'x'; DELETE FROM study");
	begin(&world);
	ask_each(&world, NULL, 401, false);
	int status = 201;
	const char *const headers[] = {"Content-Type: application/json", STUDY_OF_A_TOKEN};
	// studies of a minute each: four run, one is queued, the next one is refused
	char *lengthy = service_study(SERVICE_ROWS, 500, 1);
	for (int i = 0; i < 6 && status == 201; i++)
		status = ask(&world, "POST", "/v1/studies", headers, lengthy);
	assert_int_equal(status, 429);
	free(lengthy);
	unsetenv("POUNDD_TOKEN_FILE");
	unsetenv("POUNDD_QUEUE_TOKEN_MAX");
	service_stop(world.service);
	unlink(world.tokens);

	for (int o = 0; o < API_N_OPERATIONS; o++) {
		const char *key, *method = api_operations[o].method;
		char escaped[96] = "", path[160];
		for (const char *c = api_operations[o].path; *c; c++)
			sprintf(escaped + strlen(escaped), *c == '/' ? "~1" : "%c", *c);
		snprintf(path, sizeof path, "/paths/%s/%s/responses", escaped,
		         !strcmp(method, "GET")    ? "get"
		         : !strcmp(method, "POST") ? "post"
		         : !strcmp(method, "PUT")  ? "put"
		                                   : "delete");
		for (int i = 0; (key = reading_member(world.api, i, "%s", path)); i++, documented++) {
			seen += world.seen[o][atoi(key)];
			if (!world.seen[o][atoi(key)])
				print_error("%s %s: %s is in the document and never came\n", method, api_operations[o].path,
				            key);
		}
	}
	check_report("%d requests: %d of %d documented answers seen, none undocumented", world.n, seen,
	             documented);
	assert_int_equal(seen, documented);
	reading_close(world.api);
	service_free(world.service);
	free(world.large);
	free(world.study);
}

CHECK_MAIN(cmocka_unit_test(every_operation_and_status_of_the_document_happens_and_no_other))
