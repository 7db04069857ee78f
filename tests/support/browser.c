/* browser.c - Chromium's debugging pipe: it reads descriptor 3 and writes descriptor 4. */
#include "tests/support/browser.h"

#include <fcntl.h>
#include <poll.h>
#include <signal.h>
#include <stdlib.h>
#include <string.h>
#include <sys/prctl.h>
#include <sys/wait.h>
#include <time.h>
#include <unistd.h>

#include "schema/json/json_pointer.h"
#include "schema/json/json_writer.h"
#include "tests/support/check.h"

enum { WAIT_S = 20, TABS_MOST = 80 };

struct browser {
	pid_t pid;
	int to, from;
	int id; /* id of the last command */
	char session[64];
	char *buffer; /* (n) received bytes, at its end an incomplete message */
	size_t n;
	int faults;
	char fault[600];
};

static const char *program(void)
{
	static const char *const names[] = {"/usr/bin/chromium", "/usr/bin/chromium-browser",
	                                    "/usr/bin/google-chrome"};
	for (size_t i = 0; i < sizeof names / sizeof names[0]; i++)
		if (access(names[i], X_OK) == 0)
			return names[i];
	return NULL;
}

bool browser_there(void)
{
	return program() != NULL;
}

static void start(struct browser *browser, const char *folder)
{
	char profile[200];
	int to[2], from[2];
	assert_int_equal(pipe(to), 0);
	assert_int_equal(pipe(from), 0);
	snprintf(profile, sizeof profile, "--user-data-dir=%s/chromium", folder);
	browser->pid = fork();
	assert_true(browser->pid >= 0);
	if (browser->pid == 0) {
		int nowhere = open("/dev/null", O_RDWR);
		// a separate process group, so that all processes of the browser can be ended
		setpgid(0, 0);
		prctl(PR_SET_PDEATHSIG, SIGKILL);
		int input = fcntl(to[0], F_DUPFD, 10), output = fcntl(from[1], F_DUPFD, 10);
		dup2(nowhere, 0), dup2(nowhere, 1), dup2(nowhere, 2);
		dup2(input, 3), dup2(output, 4);
		for (int file = 5; file < 64; file++)
			close(file);
		execl(program(), "chromium", "--headless", "--no-sandbox", "--disable-gpu", "--remote-debugging-pipe",
		      profile, "about:blank", (char *)NULL);
		_exit(127);
	}
	setpgid(browser->pid, browser->pid);
	close(to[0]), close(from[1]);
	browser->to = to[1];
	browser->from = from[0];
}

/* Records exceptions, logged errors and violations of the Content Security Policy. */
static void judge(struct browser *browser, const struct reading *event, const char *text)
{
	const char *method = reading_text(event, "/method");
	const char *level = reading_text(event, "/params/entry/level"),
	           *source = reading_text(event, "/params/entry/source");
	const char *issue = reading_text(event, "/params/issue/code");
	bool bad =
	    method && (strcmp(method, "Runtime.exceptionThrown") == 0 ||
	               (level && strcmp(level, "error") == 0 && source && strcmp(source, "network") != 0) ||
	               (issue && strcmp(issue, "ContentSecurityPolicyIssue") == 0));
	if (!bad)
		return;
	browser->faults++;
	snprintf(browser->fault, sizeof browser->fault, "%s", text);
}

/* Waits for the next message; the caller frees it. */
static char *message(struct browser *browser)
{
	for (;;) {
		char *end = browser->n ? memchr(browser->buffer, '\0', browser->n) : NULL;
		if (end) {
			size_t n = (size_t)(end - browser->buffer) + 1;
			char *text = strdup(browser->buffer);
			browser->n -= n;
			memmove(browser->buffer, end + 1, browser->n);
			return text;
		}
		struct pollfd file = {.fd = browser->from, .events = POLLIN};
		if (poll(&file, 1, WAIT_S * 1000) <= 0)
			fail_msg("the browser does not answer");
		browser->buffer = realloc(browser->buffer, browser->n + 65536);
		assert_non_null(browser->buffer);
		ssize_t got = read(browser->from, browser->buffer + browser->n, 65536);
		if (got <= 0)
			fail_msg("the browser has ended");
		browser->n += (size_t)got;
	}
}

/* Sends a command and returns its answer, for reading_close; events before the answer are checked by judge. */
static struct reading *call(struct browser *browser, const char *method, const char *parameters)
{
	char session[100] = "", *text = NULL;
	size_t n;
	if (*browser->session)
		snprintf(session, sizeof session, ", \"sessionId\": \"%s\"", browser->session);
	FILE *out = open_memstream(&text, &n);
	fprintf(out, "{\"id\": %d, \"method\": \"%s\", \"params\": %s%s}", ++browser->id, method, parameters,
	        session);
	fclose(out);
	for (size_t at = 0; at < n + 1;) {
		ssize_t written = write(browser->to, text + at, n + 1 - at);
		assert_true(written > 0);
		at += (size_t)written;
	}
	free(text);
	for (;;) {
		text = message(browser);
		struct reading *answer = reading_open(text, strlen(text));
		assert_non_null(answer);
		if (reading_number(answer, "/id") == browser->id) {
			// navigation while a value is computed ends in this error, which is accepted
			if (reading_has(answer, "/error") && !strstr(text, "Inspected target navigated or closed"))
				fail_msg("%s: %s", method, text);
			free(text);
			return answer;
		}
		judge(browser, answer, text);
		reading_close(answer);
		free(text);
	}
}

static void command(struct browser *browser, const char *method, const char *parameters)
{
	reading_close(call(browser, method, parameters));
}

/* {"name": "text"} with further members; the caller frees it. */
static char *with_text(const char *name, const char *text, const char *more)
{
	struct writer w;
	size_t n;
	writer_init(&w);
	writer_object(&w, NULL, WRITER_LINE);
	writer_text(&w, name, text);
	writer_end(&w);
	char *object = writer_take(&w, &n), *whole;
	assert_non_null(object);
	*strrchr(object, '}') = '\0';
	assert_true(asprintf(&whole, "%s%s}", object, more) > 0);
	free(object);
	return whole;
}

struct browser *browser_new(const char *folder, bool dark, int width, int height)
{
	static const char *const domains[] = {"Page.enable", "Runtime.enable", "Log.enable", "Audits.enable",
	                                      "Accessibility.enable"};
	char parameters[200];
	struct browser *browser = calloc(1, sizeof *browser);
	assert_non_null(browser);
	start(browser, folder);
	struct reading *target = call(browser, "Target.createTarget", "{\"url\": \"about:blank\"}");
	snprintf(parameters, sizeof parameters, "{\"targetId\": \"%s\", \"flatten\": true}",
	         reading_text(target, "/result/targetId"));
	struct reading *session = call(browser, "Target.attachToTarget", parameters);
	snprintf(browser->session, sizeof browser->session, "%s", reading_text(session, "/result/sessionId"));
	reading_close(session);
	reading_close(target);
	for (size_t i = 0; i < sizeof domains / sizeof domains[0]; i++)
		command(browser, domains[i], "{}");
	snprintf(parameters, sizeof parameters,
	         "{\"features\": [{\"name\": \"prefers-color-scheme\", \"value\": \"%s\"}]}",
	         dark ? "dark" : "light");
	command(browser, "Emulation.setEmulatedMedia", parameters);
	snprintf(parameters, sizeof parameters,
	         "{\"width\": %d, \"height\": %d, \"deviceScaleFactor\": 1, \"mobile\": false}", width, height);
	command(browser, "Emulation.setDeviceMetricsOverride", parameters);
	return browser;
}

void browser_free(struct browser *browser)
{
	if (!browser)
		return;
	kill(-browser->pid, SIGKILL);
	waitpid(browser->pid, NULL, 0);
	close(browser->to), close(browser->from);
	free(browser->buffer);
	free(browser);
}

void browser_go(struct browser *browser, const char *url)
{
	char *parameters = with_text("url", url, "");
	command(browser, "Page.navigate", parameters);
	free(parameters);
}

char *browser_text(struct browser *browser, const char *expression)
{
	char *whole, *parameters;
	assert_true(asprintf(&whole, "Promise.resolve(%s).then(String)", expression) > 0);
	parameters = with_text("expression", whole, ", \"awaitPromise\": true, \"returnByValue\": true");
	struct reading *answer = call(browser, "Runtime.evaluate", parameters);
	const char *value = reading_text(answer, "/result/result/value");
	char *text = strdup(value ? value : "?");
	reading_close(answer);
	free(parameters);
	free(whole);
	return text;
}

void browser_wait(struct browser *browser, const char *expression)
{
	time_t end = time(NULL) + WAIT_S;
	for (;;) {
		char *value = browser_text(browser, expression);
		bool is = strcmp(value, "true") == 0;
		free(value);
		if (is)
			return;
		if (time(NULL) > end)
			fail_msg("never true: %s; last fault: %s", expression, browser->fault);
		nanosleep(&(struct timespec){.tv_nsec = 30000000}, NULL);
	}
}

void browser_press(struct browser *browser, const char *key)
{
	static const char *const types[] = {"keyDown", "keyUp"};
	bool enter = strcmp(key, "Enter") == 0;
	for (int i = 0; i < 2; i++) {
		char parameters[200];
		snprintf(parameters, sizeof parameters,
		         "{\"type\": \"%s\", \"key\": \"%s\", \"code\": \"%s\", \"windowsVirtualKeyCode\": %d%s}",
		         types[i], key, key, enter ? 13 : 9, enter && i == 0 ? ", \"text\": \"\\r\"" : "");
		command(browser, "Input.dispatchKeyEvent", parameters);
	}
}

void browser_tab(struct browser *browser, const char *id)
{
	for (int i = 0; i < TABS_MOST; i++) {
		browser_press(browser, "Tab");
		char *at = browser_text(browser,
		                        "document.activeElement?.id || document.activeElement?.getAttribute('href')");
		bool there = strcmp(at, id) == 0;
		free(at);
		if (there)
			return;
	}
	fail_msg("Tab does not lead to %s", id);
}

void browser_type(struct browser *browser, const char *text)
{
	char *parameters = with_text("text", text, "");
	command(browser, "Input.insertText", parameters);
	free(parameters);
}

bool browser_has_image(struct browser *browser, const char *name)
{
	struct reading *tree = call(browser, "Accessibility.getFullAXTree", "{}");
	bool found = false;
	for (int i = 0, n = reading_count(tree, "/result/nodes"); i < n && !found; i++) {
		const char *role = reading_text(tree, "/result/nodes/%d/role/value", i);
		const char *own = reading_text(tree, "/result/nodes/%d/name/value", i);
		found =
		    role && own && (strcmp(role, "image") == 0 || strcmp(role, "img") == 0) && strcmp(own, name) == 0;
	}
	reading_close(tree);
	return found;
}

int browser_faults(const struct browser *browser)
{
	return browser->faults;
}

const char *browser_fault(const struct browser *browser)
{
	return browser->fault;
}
