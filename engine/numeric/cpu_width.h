/* cpu_width.h - selects among the compilations of a file for several lane counts, by what the processor supports. */
#ifndef CPU_WIDTH_H
#define CPU_WIDTH_H

/* the compilations of a file, widest first; indices of tables of functions */
enum { POUND_WIDTH_8, POUND_WIDTH_4, POUND_WIDTH_1, POUND_WIDTH_PORTABLE, POUND_WIDTHS };

int pound_dispatch_width(int lanes);

#endif
