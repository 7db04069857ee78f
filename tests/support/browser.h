/* browser.h - Chromium, controlled through its debugging pipe by JSON messages that end with a zero.
 *
 * Errors in these functions fail the test. */
#ifndef BROWSER_H
#define BROWSER_H

#include <stdbool.h>

struct browser;

bool browser_there(void); /* a browser is installed */

struct browser *browser_new(const char *folder, bool dark, int width, int height);
void browser_free(struct browser *browser);

void browser_go(struct browser *browser, const char *url);

/* The value of an expression as a text, for free; a promise is awaited. */
char *browser_text(struct browser *browser, const char *expression);
/* Waits until an expression is true, 20 s at most. */
void browser_wait(struct browser *browser, const char *expression);

/* Keys: one press of "Tab", "Enter"; Tab until the element with that id has the focus; a text typed. */
void browser_press(struct browser *browser, const char *key);
void browser_tab(struct browser *browser, const char *id);
void browser_type(struct browser *browser, const char *text);

/* Whether the accessibility tree has an image of that name. */
bool browser_has_image(struct browser *browser, const char *name);

/* Exceptions, Content-Security-Policy violations and errors since the start, except network errors, which a test may cause. */
int browser_faults(const struct browser *browser);
const char *browser_fault(const struct browser *browser); /* the last */

#endif
