/* The pages for browsers: the answers of the server; and the pages in Chromium, used by the keyboard only (skipped
 * without Chromium). */
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <time.h>
#include <unistd.h>

#include "schema/examples/examples.h"
#include "schema/figure/report.h"
#include "schema/http/page.h"
#include "schema/json/json_pointer.h"
#include "tests/support/browser.h"
#include "tests/support/check.h"
#include "tests/support/raw_http.h"
#include "tests/support/study_documents.h"

enum { PAGE_BYTES = 40000, PAGE_NODES = 2000, PAGE_MS = 1000 };

static const struct {
	const char *path, *type;
} FILES[] = {
    {"/", "text/html"},
    {"/new", "text/html"},
    {"/studies/0123456789abcdef", "text/html"},
    {"/page.css", "text/css"},
    {"/page.js", "text/javascript"},
    {"/icon.svg", "image/svg+xml"},
    // addresses in links of the pages: a filter, the next page, a choice of figures, "use as a start"
    {"/?status=queued", "text/html"},
    {"/?status=running&cursor=0123456789abcdef", "text/html"},
    {"/studies/0123456789abcdef?cell=0&output=impulse&index=S1", "text/html"},
    {"/new?from=0123456789abcdef", "text/html"},
};

static void every_page_has_its_type_its_policy_and_its_tag(void **state)
{
	const struct service *service = *state;
	for (size_t i = 0; i < sizeof FILES / sizeof FILES[0]; i++) {
		char request[200];
		static struct raw_answer raw;
		struct answer answer = service_get(service, "%s", FILES[i].path);
		assert_int_equal(answer.status, 200);
		assert_int_equal(strncmp(answer.type, FILES[i].type, strlen(FILES[i].type)), 0);
		char none_match[100];
		snprintf(none_match, sizeof none_match, "If-None-Match: %s", answer.etag);
		struct answer again = service_ask(
		    service, &(struct ask){.method = "GET", .path = FILES[i].path, .headers = {none_match}});
		assert_int_equal(again.status, 304);
		answer_free(&again);
		answer_free(&answer);
		snprintf(request, sizeof request, "HEAD %s HTTP/1.1\r\nHost: localhost\r\nConnection: close\r\n\r\n",
		         FILES[i].path);
		raw_ask(service, request, strlen(request), 5, &raw);
		assert_non_null(
		    strstr(raw.text, "\r\nContent-Security-Policy: default-src 'none'; script-src 'self'; style-src "
		                     "'self'; img-src 'self' blob:; connect-src 'self'; base-uri 'none'; form-action "
		                     "'none'; frame-ancestors 'none'\r\n"));
		assert_non_null(strstr(raw.text, "\r\nX-Content-Type-Options: nosniff\r\n"));
		assert_non_null(strstr(raw.text, "\r\nReferrer-Policy: no-referrer\r\n"));
	}
}

static const char SCRIPT[] = "<script type=\"module\" src=\"/page.js\"></script>";

static void pages_are_small_and_have_nothing_inline(void **state)
{
	static const char *const none[] = {
	    " style=",   "onclick=",           "onload=", "javascript:",   "http://www.g", "innerHTML",
	    "outerHTML", "insertAdjacentHTML", "eval(",   "document.write"};
	size_t bytes = 0;
	(void)state;
	for (int i = 0; page_files[i].name; i++) {
		const char *text = page_files[i].text;
		bytes += strlen(text);
		for (size_t k = 0; k < sizeof none / sizeof none[0]; k++)
			if (strstr(text, none[k]))
				fail_msg("%s has %s", page_files[i].name, none[k]);
		bool document = strstr(page_files[i].name, ".html");
		assert_false(document && strstr(text, "<style"));
		for (const char *script = text; document && (script = strstr(script, "<script")); script++)
			assert_int_equal(strncmp(script, SCRIPT, strlen(SCRIPT)), 0);
	}
	check_report("all files of the pages: %zu bytes", bytes);
	assert_true(bytes <= PAGE_BYTES);
}

static void examples_are_listed_and_given_as_they_are(void **state)
{
	struct answer answer = service_get(*state, "/v1/examples");
	struct reading *list = answer_read(&answer);
	int n = reading_count(list, "/examples");
	assert_true(n > 10);
	for (int i = 0; i < n; i++) {
		const char *name = reading_text(list, "/examples/%d/name", i);
		struct answer one = service_get(*state, "/v1/examples/%s", name);
		assert_string_equal(one.body, example_text(name));
		answer_free(&one);
	}
	reading_close(list);
	answer_free(&answer);
}

/* ---- in the browser ---- */

static struct browser *opened(const struct service *service, bool dark, int width)
{
	if (!browser_there())
		skip();
	return browser_new(service->directory, dark, width, 900);
}

static void go(struct browser *browser, const struct service *service, const char *path)
{
	char url[200];
	snprintf(url, sizeof url, "http://127.0.0.1:%d%s", service->port, path);
	browser_go(browser, url);
}

static void expect_no_fault(struct browser *browser)
{
	if (browser_faults(browser))
		fail_msg("%d faults, the last %s", browser_faults(browser), browser_fault(browser));
}

static double number(struct browser *browser, const char *expression)
{
	char *text = browser_text(browser, expression);
	double value = strtod(text, NULL);
	free(text);
	return value;
}

/* Fails if the page scrolls sideways at its text size or at twice that size. */
static void expect_no_sideways_scroll(struct browser *browser)
{
	static const char *const sizes[] = {"200%", ""};
	assert_true(number(browser, "document.documentElement.scrollWidth - innerWidth") <= 0);
	for (int i = 0; i < 2; i++) {
		char expression[120];
		snprintf(expression, sizeof expression, "document.documentElement.style.fontSize = '%s'", sizes[i]);
		free(browser_text(browser, expression));
		assert_true(number(browser, "document.documentElement.scrollWidth - innerWidth") <= 0);
	}
}

static const char HOSTILE[] = "<img src=x onerror=document.title=1>";

/* Submits a study with hostile names and waits until it is finished. */
static void finished(const struct service *service, char id[17])
{
	char *document = study_documents_with(example_text("sensitivity_small"), "A quick look", HOSTILE);
	char *study = study_documents_with(document, "\"name\": \"f_2\"", "\"name\": \"<b>f_2</b>\"");
	service_submit(service, study, id);
	assert_true(service_wait(service, id, "succeeded", 0));
	free(study);
	free(document);
}

static void a_study_is_shown_in_both_schemes_and_widths_without_a_fault(void **state)
{
	const struct service *service = *state;
	char id[17], path[40];
	if (!browser_there())
		skip();
	finished(service, id);
	snprintf(path, sizeof path, "/studies/%s", id);
	for (int way = 0; way < 4; way++) {
		struct browser *browser = opened(service, way % 2, way / 2 ? 320 : 1280);
		go(browser, service, path);
		browser_wait(browser, "document.querySelectorAll('#figures svg').length === 1");
		// the hostile names are shown as text, in the page and in the figure
		char *name = browser_text(browser, "document.getElementById('name').textContent");
		assert_int_equal(strncmp(name, HOSTILE, strlen(HOSTILE)), 0);
		free(name);
		browser_wait(browser, "document.querySelector('#figures svg').textContent.includes('<b>f_2</b>')");
		browser_wait(browser, "document.querySelector('img, b') === null");
		assert_true(browser_has_image(browser, "Sobol' indices with 95 % intervals"));
		expect_no_sideways_scroll(browser);
		// the style sheet of the page has the light and dark colors of the figure
		char *ink =
		    browser_text(browser, "getComputedStyle(document.querySelector('#figures svg .f6')).fill");
		assert_string_equal(ink, way % 2 ? "rgb(236, 239, 242)" : "rgb(20, 23, 27)");
		free(ink);
		// the table below the figure has a header for each column
		browser_text(browser, "document.querySelector('#figures details').open = true");
		browser_wait(browser, "document.querySelectorAll('#figures th[scope=col]').length > 5");
		go(browser, service, "/");
		browser_wait(browser, "document.querySelectorAll('#studies tbody tr').length === 1");
		expect_no_sideways_scroll(browser);
		go(browser, service, "/new");
		browser_wait(browser, "document.querySelectorAll('#example option').length > 10");
		expect_no_sideways_scroll(browser);
		expect_no_fault(browser);
		browser_free(browser);
	}
}

static void a_report_does_not_scroll_sideways_however_narrow_or_large_its_text(void **state)
{
	const struct service *service = *state;
	char id[17], path[200], url[220];
	size_t n;
	if (!browser_there())
		skip();
	finished(service, id);
	struct answer result = service_get(service, "/v1/studies/%s/results", id),
	              study = service_get(service, "/v1/studies/%s/request", id);
	const struct figure_source source = {.json = result.body, .length = strlen(result.body)};
	char *page = report_html(&source, study.body, strlen(study.body), &n);
	snprintf(path, sizeof path, "%s/report.html", service->directory);
	FILE *file = fopen(path, "w");
	assert_true(page && file && fwrite(page, 1, n, file) == n && fclose(file) == 0);
	snprintf(url, sizeof url, "file://%s", path);
	for (int way = 0; way < 2; way++) {
		struct browser *browser = opened(service, way, way ? 320 : 1280);
		browser_go(browser, url);
		browser_wait(browser, "document.querySelectorAll('figure svg').length === 1");
		expect_no_sideways_scroll(browser);
		// also with all details open
		free(browser_text(browser, "document.querySelectorAll('details').forEach(one => one.open = true)"));
		expect_no_sideways_scroll(browser);
		expect_no_fault(browser);
		browser_free(browser);
	}
	free(page);
	answer_free(&result);
	answer_free(&study);
}

static void warnings_are_shown_while_typing_and_with_the_result(void **state)
{
	const struct service *service = *state;
	static const char study[] =
	    "{\"kind\": \"response\", \"scene\": {\"oscillators\": [{\"mass_kg\": 50000, \"frequency_hz\": 1}, "
	    "{\"frequency_hz\": 2}], \"contact\": {\"gap_m\": 90, \"restitution\": 0.6}, \"excitation\": "
	    "{\"type\": "
	    "\"kanai_tajimi\", \"frequency_hz\": 2, \"signals\": 2}}}";
	char id[17], path[40];
	struct browser *browser = opened(service, false, 1280);
	go(browser, service, "/new");
	browser_wait(browser, "document.querySelectorAll('#example option').length > 10");
	browser_tab(browser, "text");
	browser_type(browser, study);
	browser_wait(browser,
	             "document.getElementById('verdict').textContent.includes('warnings') && "
	             "document.querySelector('#faults button').textContent.includes('was it left out?')");
	assert_true(number(browser, "document.getElementById('submit').disabled ? 1 : 0") == 0);
	service_submit(service, study, id);
	assert_true(service_wait(service, id, "succeeded", 0));
	snprintf(path, sizeof path, "/studies/%s", id);
	go(browser, service, path);
	browser_wait(browser, "document.getElementById('warnings-section').hidden === false && "
	                      "document.querySelectorAll('#warnings li').length === 2 && "
	                      "document.getElementById('warnings').textContent.includes('no run has a contact')");
	expect_no_fault(browser);
	browser_free(browser);
}

/* Links of the pages work: the list filtered by status, a study as the start of a new one. */
static void the_list_is_filtered_and_a_study_is_a_start_for_another(void **state)
{
	const struct service *service = *state;
	char *study = service_study(2, 2, 1), id[17];
	struct browser *browser = opened(service, false, 1000);
	service_submit(service, study, id);
	assert_true(service_wait(service, id, "succeeded", 0));
	go(browser, service, "/");
	for (int k = 0; k < 2; k++) {
		char choose[200], shown[200];
		const char *status = k ? "succeeded" : "failed";
		snprintf(choose, sizeof choose,
		         "document.getElementById('status').value = '%s', "
		         "document.getElementById('status').dispatchEvent(new Event('change'))",
		         status);
		snprintf(shown, sizeof shown,
		         "location.search === '?status=%s' && document.getElementById('none')?.hidden === %s", status,
		         k ? "true && document.querySelectorAll('#studies tbody tr').length === 1" : "false");
		browser_wait(browser, "typeof document.getElementById('status')?.onchange === 'function'");
		free(browser_text(browser, choose));
		browser_wait(browser, shown);
	}
	free(browser_text(browser, "document.querySelector('#studies a').click()"));
	browser_wait(
	    browser,
	    "location.pathname.startsWith('/studies/') && document.getElementById('again')?.href.length > 0");
	browser_tab(browser, "again");
	browser_press(browser, "Enter");
	browser_wait(
	    browser,
	    "location.pathname === '/new' && document.getElementById('text')?.value.includes('sensitivity')");
	expect_no_fault(browser);
	browser_free(browser);
	free(study);
}

/* A server with tokens: a wrong token is rejected with a message, the right one is used from then on, and the commands to
 * copy name the variable POUND_TOKEN. */
static void a_token_is_asked_for_until_it_is_right(void **state)
{
	static const char token[] = "correct-horse-battery-staple-0123456789";
	const struct service *served = *state; // its folder holds the token file
	char path[128], id[17];
	if (!browser_there())
		skip();
	snprintf(path, sizeof path, "%s/tokens", served->directory);
	FILE *file = fopen(path, "w");
	assert_non_null(file);
	fprintf(file, "%s\n", token);
	fclose(file);
	chmod(path, 0600);
	struct service *service = service_new();
	// the study is submitted before the server has tokens
	service_start(service, 1);
	char *study = service_study(2, 2, 1);
	service_submit(service, study, id);
	assert_true(service_wait(service, id, "succeeded", 0));
	free(study);
	service_stop(service);
	setenv("POUNDD_TOKEN_FILE", path, 1);
	service_start(service, 1);
	unsetenv("POUNDD_TOKEN_FILE");
	struct browser *browser = opened(service, false, 1000);
	snprintf(path, sizeof path, "/studies/%s", id);
	go(browser, service, path);
	browser_wait(browser, "document.getElementById('ask').open && "
	                      "document.getElementById('ask-text').textContent.includes('asks for a token')");
	browser_type(browser, "not this one");
	browser_press(browser, "Enter");
	browser_wait(browser, "document.getElementById('ask').open && "
	                      "document.getElementById('ask-text').textContent.includes('does not know')");
	browser_type(browser, token);
	browser_press(browser, "Enter");
	browser_wait(browser,
	             "document.getElementById('use-shell').textContent.includes('Bearer $POUND_TOKEN') && "
	             "document.getElementById('use-python').textContent.includes('POUND_TOKEN') && "
	             "document.querySelectorAll('#figures svg').length > 0");
	browser_free(browser);
	service_stop(service);
	service_free(service);
}

static void a_campaign_is_shown_in_a_second_and_2000_nodes(void **state)
{
	const struct service *service = *state;
	char id[17], path[40];
	struct timespec before, after;
	if (!browser_there())
		skip();
	char *study = study_documents_with(example_text("paper"), "\"rows\": 1000", "\"rows\": 40");
	service_submit(service, study, id);
	free(study);
	assert_true(service_wait(service, id, "succeeded", 0));
	struct browser *browser = opened(service, false, 1280);
	snprintf(path, sizeof path, "/studies/%s", id);
	clock_gettime(CLOCK_MONOTONIC, &before);
	go(browser, service, path);
	browser_wait(browser, "document.querySelectorAll('#figures svg').length >= 4");
	clock_gettime(CLOCK_MONOTONIC, &after);
	double ms =
	    1e3 * (double)(after.tv_sec - before.tv_sec) + 1e-6 * (double)(after.tv_nsec - before.tv_nsec);
	double nodes = number(browser, "document.querySelectorAll('*').length");
	check_report("the page of a campaign: %.0f ms, %.0f nodes", ms, nodes);
	assert_true(nodes <= PAGE_NODES);
	// the time is only reported: other processes may use the processor
	expect_no_fault(browser);
	browser_free(browser);
}

static void a_study_is_made_followed_cancelled_and_deleted_by_keys_while_the_server_is_killed(void **state)
{
	struct service *service = *state;
	struct browser *browser = opened(service, true, 1000);
	char *study = service_study(200000, 5, 1);
	go(browser, service, "/");
	browser_wait(browser, "document.getElementById('none')?.hidden === false");
	browser_tab(browser, "/new");
	browser_press(browser, "Enter");
	browser_wait(browser,
	             "location.pathname === '/new' && document.querySelectorAll('#example option').length > 10");
	browser_tab(browser, "text");
	browser_type(browser, "{\"kind\": \"response\", \"sceme\": {}}");
	browser_wait(browser, "document.querySelector('#faults button')?.textContent.includes('/sceme')");
	// Tab reaches the button of the problem, which moves the cursor to its position
	browser_press(browser, "Tab");
	browser_press(browser, "Enter");
	browser_wait(browser,
	             "document.activeElement.id === 'text' && document.activeElement.selectionStart > 20");
	browser_text(browser, "localStorage.clear()");
	go(browser, service, "/new");
	browser_wait(browser, "document.querySelectorAll('#example option').length > 10");
	browser_tab(browser, "text");
	browser_type(browser, study);
	browser_wait(browser, "document.getElementById('submit').disabled === false");
	browser_tab(browser, "submit");
	browser_press(browser, "Enter");
	browser_wait(browser, "location.pathname.startsWith('/studies/') && "
	                      "document.getElementById('status').textContent === 'running'");
	int port = service->port;
	service_kill(service);
	browser_wait(browser, "document.getElementById('server').textContent.includes('does not answer')");
	service_start(service, 2);
	if (service->port != port) {
		// the server has another port: load the page from there
		char path[64], *from = browser_text(browser, "location.pathname");
		snprintf(path, sizeof path, "%s", from);
		free(from);
		go(browser, service, path);
	}
	browser_wait(browser, "document.getElementById('status')?.textContent === 'running'");
	browser_tab(browser, "cancel");
	browser_press(browser, "Enter");
	browser_wait(browser, "document.getElementById('ask').open");
	browser_tab(browser, "ask-yes");
	browser_press(browser, "Enter");
	browser_wait(browser, "document.getElementById('status').textContent === 'cancelled'");
	browser_tab(browser, "delete");
	browser_press(browser, "Enter");
	browser_tab(browser, "ask-yes");
	browser_press(browser, "Enter");
	browser_wait(browser, "location.pathname === '/' && document.getElementById('none')?.hidden === false");
	expect_no_fault(browser);
	browser_free(browser);
	free(study);
}

#define SERVED(name) cmocka_unit_test_setup_teardown(name, service_setup, service_teardown)

CHECK_MAIN(SERVED(every_page_has_its_type_its_policy_and_its_tag),
           cmocka_unit_test(pages_are_small_and_have_nothing_inline),
           SERVED(examples_are_listed_and_given_as_they_are),
           SERVED(a_study_is_shown_in_both_schemes_and_widths_without_a_fault),
           SERVED(a_report_does_not_scroll_sideways_however_narrow_or_large_its_text),
           SERVED(warnings_are_shown_while_typing_and_with_the_result),
           SERVED(the_list_is_filtered_and_a_study_is_a_start_for_another),
           SERVED(a_token_is_asked_for_until_it_is_right),
           SERVED(a_campaign_is_shown_in_a_second_and_2000_nodes),
           SERVED(a_study_is_made_followed_cancelled_and_deleted_by_keys_while_the_server_is_killed))
