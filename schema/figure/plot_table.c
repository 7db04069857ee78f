/* plot_table.c - reads samples from CSV: the rows of one signal in an interval of time, or all rows. */
#include <ctype.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "schema/figure/plot.h"

enum { EVERY_SIGNAL = -1 };

/* Reads the rows of the signal, or of all signals, with a number in [from, to] in the second column.  A cell is a number or empty;
 * the header must start with `head`. */
static bool table_read(struct plot *plot, const char *head, double from, double to, struct plot_table *table)
{
	const char *at = plot->source->samples, *end = at + plot->source->n_samples;
	size_t lines = 0;
	table->n_columns = table->n = 0;
	for (const char *c = at; c < end; c++)
		lines += *c == '\n' || *c == '\r';
	while (at < end && *at != '\r' && *at != '\n' && table->n_columns < PLOT_COLUMNS_MOST) {
		size_t n = 0;
		while (at + n < end && !strchr(",\r\n", at[n]))
			n++;
		table->names[table->n_columns] = at;
		table->lengths[table->n_columns] = n;
		table->values[table->n_columns] = plot_memory(plot, sizeof(double) * (lines + 1));
		if (!table->values[table->n_columns++])
			return false;
		at += n + (at + n < end && at[n] == ',');
	}
	if (table->n_columns < 3 || strncmp(table->names[0], head, strlen(head)) != 0)
		return false;
	while (at < end) {
		double row[PLOT_COLUMNS_MOST] = {0};
		at += strspn(at, "\r\n");
		if (at >= end || !*at)
			break;
		// most rows belong to other signals: skip their numbers
		bool wanted = true;
		for (int c = 0; c < table->n_columns && wanted; c++) {
			// strtod would skip white space into the next line
			char *after = (char *)at;
			row[c] = isspace((unsigned char)*at) ? NAN : strtod(at, &after);
			row[c] = after == at ? NAN : row[c];
			at = after + strcspn(after, ",\r\n");
			at += *at == ',';
			wanted = c == 0 ? table->signal == EVERY_SIGNAL || row[0] == table->signal
			                : c > 1 || (row[1] >= from && row[1] <= to);
		}
		at += strcspn(at, "\r\n");
		if (wanted && isfinite(row[1])) {
			for (int c = 0; c < table->n_columns; c++)
				table->values[c][table->n] = row[c];
			table->n++;
		}
	}
	return true;
}

const double *plot_table_column(const struct plot_table *table, const char *name)
{
	for (int c = 0; c < table->n_columns; c++)
		if (table->lengths[c] == strlen(name) && strncmp(table->names[c], name, table->lengths[c]) == 0)
			return table->values[c];
	return NULL;
}

static double second_of(struct plot *plot, const char *name, const char *text, double absent)
{
	char *end;
	double value = text ? strtod(text, &end) : absent;
	if (text && (!*text || *end || !isfinite(value) || isspace((unsigned char)*text)))
		snprintf(plot->fault, sizeof plot->fault, "%s must be a time in s", name);
	return value;
}

/* Reads the rows of the chosen signal and time.
 *
 * Returns  value  false: invalid, see plot->fault
 */
bool plot_table(struct plot *plot, struct plot_table *table)
{
	const double from = second_of(plot, "from", plot->choice->from, 0);
	const double to = second_of(plot, "to", plot->choice->to, INFINITY);
	table->signal = plot->choice->signal ? atoi(plot->choice->signal) : 0;
	if (*plot->fault)
		return false;
	if (!table_read(plot, "signal,time_s,", from, to, table))
		snprintf(plot->fault, sizeof plot->fault,
		         "the samples are not time histories: their first columns must be signal,time_s");
	return !*plot->fault;
}

/* Reads all rows.
 *
 * Returns  value  false: invalid, see plot->fault
 */
bool plot_table_whole(struct plot *plot, struct plot_table *table)
{
	table->signal = EVERY_SIGNAL;
	if (!table_read(plot, "signal,", -INFINITY, INFINITY, table))
		snprintf(plot->fault, sizeof plot->fault,
		         "the samples have no signals: their first column must be signal");
	return !*plot->fault;
}
