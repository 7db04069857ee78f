/* pages.c - answers built into the server: pages for browsers, and example studies. */
#include "server/pages.h"

#include <assert.h>
#include <inttypes.h>
#include <stdio.h>
#include <string.h>

#include "engine/pound.h"
#include "schema/examples/examples.h"
#include "schema/http/page.h"
#include "schema/json/json_writer.h"

/* A reply with a constant body; its ETag is the FNV-1a hash of the bytes, 64 bits. */
static struct reply lasting(const char *type, const char *text)
{
	uint64_t hash = 0xcbf29ce484222325;
	struct reply reply = {
	    .status = 200, .type = type, .body = (char *)text, .length = strlen(text), .lasts = true};
	for (const char *c = text; *c; c++)
		hash = (hash ^ (unsigned char)*c) * 0x100000001b3;
	snprintf(reply.etag, sizeof reply.etag, "\"%016" PRIx64 "\"", hash);
	return reply;
}

struct reply pages_example(const char *name)
{
	const char *text = example_text(name);
	return text ? lasting("application/json", text) : (struct reply){0};
}

struct reply pages_example_list(void)
{
	struct writer w;
	writer_init(&w);
	writer_object(&w, NULL, WRITER_LINES);
	writer_array(&w, "examples", WRITER_LINES);
	for (int i = 0; example_name(i); i++) {
		writer_object(&w, NULL, WRITER_LINE);
		writer_text(&w, "name", example_name(i));
		writer_text(&w, "title", example_title(i));
		writer_end(&w);
	}
	writer_end(&w);
	writer_end(&w);
	struct reply reply = {.status = 200, .type = "application/json"};
	reply.body = writer_take(&w, &reply.length);
	snprintf(reply.etag, sizeof reply.etag, "\"%s\"", POUND_VERSION);
	return reply;
}

/* A file of the pages, which load and request nothing from other servers. */
struct reply pages_file(int operation)
{
	static const struct {
		const char *name, *type;
	} files[API_N_OPERATIONS] = {
	    [API_home] = {"list.html", "text/html; charset=utf-8"},
	    [API_new] = {"new.html", "text/html; charset=utf-8"},
	    [API_study] = {"study.html", "text/html; charset=utf-8"},
	    [API_style] = {"page.css", "text/css; charset=utf-8"},
	    [API_script] = {"page.js", "text/javascript; charset=utf-8"},
	    [API_icon] = {"icon.svg", "image/svg+xml"},
	};
	int i = 0;
	assert(files[operation].name);
	while (strcmp(page_files[i].name, files[operation].name) != 0)
		i++;
	struct reply reply = lasting(files[operation].type, page_files[i].text);
	reply.policy = "default-src 'none'; script-src 'self'; style-src 'self'; img-src 'self' blob:; "
	               "connect-src 'self'; base-uri 'none'; form-action 'none'; frame-ancestors 'none'";
	return reply;
}
