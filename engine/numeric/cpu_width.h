/* cpu_width.h - which of the lane counts that a file is compiled for this machine has. */
#ifndef CPU_WIDTH_H
#define CPU_WIDTH_H

/* the compilations of a file, widest first: a table of functions has its row for each */
enum { POUND_WIDTH_8, POUND_WIDTH_4, POUND_WIDTH_1, POUND_WIDTH_PORTABLE, POUND_WIDTHS };

int pound_dispatch_width(int lanes);

#endif
