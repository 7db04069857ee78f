/* progress_bar.h - the progress bar on stderr: redrawn in place on a terminal, nothing elsewhere. */
#ifndef PROGRESS_BAR_H
#define PROGRESS_BAR_H

/* Draws the bar: runs done of all runs (total 0: not known yet), and seconds left (< 0: not known).  Numbers from a server
 * are not trusted: the bar never exceeds its ends. */
void bar_draw(double done, double total, double left_s);

/* Erases the bar. */
void bar_clear(void);

#endif
