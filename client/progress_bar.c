/* progress_bar.c - one line of stderr:  [##########------------]  43 %  12,900 / 30,000 runs  1:05 left */
#include "client/progress_bar.h"

#include <math.h>
#include <stdbool.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/ioctl.h>
#include <unistd.h>

enum { WIDTH_MAX = 100, WIDTH_DEFAULT = 80, CELLS_MIN = 10, CELLS_MAX = 40 };

static bool on_terminal(void)
{
	const char *terminal = getenv("TERM");
	return isatty(STDERR_FILENO) && terminal && strcmp(terminal, "dumb") != 0;
}

static int line_width(void)
{
	struct winsize size;
	int width = WIDTH_DEFAULT;
	if (ioctl(STDERR_FILENO, TIOCGWINSZ, &size) == 0 && size.ws_col > 0)
		width = size.ws_col;
	// writing in the last column would wrap the line
	return (width < WIDTH_MAX ? width : WIDTH_MAX) - 1;
}

/* Converts a number of runs; NAN, negative and too large numbers give 0. */
static int64_t count_of(double n)
{
	return n >= 0.0 && n < 1e18 ? (int64_t)n : 0;
}

/* Writes n with a comma between thousands, n >= 0. */
static int grouped(char *out, size_t size, int64_t n)
{
	if (n < 1000)
		return snprintf(out, size, "%d", (int)n);
	int length = grouped(out, size, n / 1000);
	return length + snprintf(out + length, size - (size_t)length, ",%03d", (int)(n % 1000));
}

static void left(char *out, size_t size, double seconds)
{
	long s = lround(seconds);
	if (s >= 3600)
		snprintf(out, size, "  %ld:%02ld:%02ld left", s / 3600, s / 60 % 60, s % 60);
	else
		snprintf(out, size, "  %ld:%02ld left", s / 60, s % 60);
}

/* Draws the bar; on a narrow terminal only the percentage.
 *
 * Given    done, total   pounding runs
 *          left_s   s    time left, < 0: unknown
 */
void bar_draw(double done, double total, double left_s)
{
	if (!on_terminal())
		return;
	char tail[120], n_done[32], n_total[32], time[40] = "";
	double part = total > 0.0 ? fmin(fmax(done / total, 0.0), 1.0) : 0.0; // fmax and fmin turn a NAN into 0
	grouped(n_done, sizeof n_done, count_of(done));
	grouped(n_total, sizeof n_total, count_of(total));
	if (left_s >= 0.0 && left_s < 1e7)
		left(time, sizeof time, left_s);
	int length =
	    snprintf(tail, sizeof tail, " %3d %%  %s / %s runs%s", (int)(100.0 * part), n_done, n_total, time);
	int cells = line_width() - length - 2;
	if (cells > CELLS_MAX)
		cells = CELLS_MAX;
	if (cells < CELLS_MIN) {
		fprintf(stderr, "\r\033[K%3d %%", (int)(100.0 * part));
		return;
	}
	char row[CELLS_MAX + 1];
	int full = (int)(part * cells);
	memset(row, '#', (size_t)full);
	memset(row + full, '-', (size_t)(cells - full));
	row[cells] = '\0';
	fprintf(stderr, "\r\033[K[%s]%s", row, tail);
}

/* Clears the line. */
void bar_clear(void)
{
	if (on_terminal())
		fputs("\r\033[K", stderr);
}
