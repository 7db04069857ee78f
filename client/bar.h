/* bar.h - the progress bar on stderr: redrawn in place on a terminal, nothing elsewhere. */
#ifndef BAR_H
#define BAR_H

#include <stdint.h>

/* Draws the bar: runs done of the runs asked (total 0: not known yet), and seconds left (< 0: not known). */
void bar_draw(int64_t done, int64_t total, double left_s);

/* Takes the bar off its line. */
void bar_clear(void);

#endif
