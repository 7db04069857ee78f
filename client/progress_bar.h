/* progress_bar.h - the progress bar on stderr: redrawn in place on a terminal, nothing elsewhere. */
#ifndef PROGRESS_BAR_H
#define PROGRESS_BAR_H

/* Draws the bar: runs done of the runs asked (total 0: not known yet), and seconds left (< 0: not known).  Whatever the
 * numbers are that a server has sent: it is not drawn beyond its ends. */
void bar_draw(double done, double total, double left_s);

/* Takes the bar off its line. */
void bar_clear(void);

#endif
