/* record.c - the table of formats.
 *
 * A file has the first format that recognizes its first lines.  A new format needs two functions, in their own file, and
 * a row. */
#include "schema/record/record.h"

#include <stdlib.h>
#include <string.h>

#include "schema/record/record_text.h"

static const struct {
	const char *name;
	const char *text; /* one line of documentation */
	bool (*recognized)(struct record_text *text);
	bool (*read)(struct record_text *text, struct record *record);
} formats[] = {
    {"peer", "PEER NGA (.AT2): four lines of header with NPTS and DT, samples in g", record_peer_recognized,
     record_peer_read},
    {"cosmos",
     "COSMOS 1.20 (.V1, .V2, .V2c): headers of text, integers and reals, samples as their line says",
     record_cosmos_recognized, record_cosmos_read},
    {"esm", "Engineering Strong Motion and ITACA (.ASC): lines KEY: value, one sample per line",
     record_esm_recognized, record_esm_read},
    {"columns",
     "time and acceleration, or accelerations alone with a step; blanks, tabs, commas or semicolons",
     record_columns_recognized, record_columns_read},
};

enum { FORMATS = sizeof formats / sizeof formats[0], COLUMNS = FORMATS - 1 };

const char *record_format_name(int row)
{
	return row >= 0 && row < FORMATS ? formats[row].name : NULL;
}

const char *record_format_text(int row)
{
	return formats[row].text;
}

/* The row of the format of a text; `columns` if no other format recognizes it. */
static int format_of(const struct record_text *start)
{
	int row = 0;
	for (; row < COLUMNS; row++) {
		struct record_text text = *start;
		if (formats[row].recognized(&text))
			break;
	}
	return row;
}

bool record_recognized(const char *text, size_t length)
{
	return format_of(&(struct record_text){.at = text, .end = text + length}) < COLUMNS;
}

/* Reads a file of a recorded acceleration.
 *
 * Given    text    (length)   any bytes
 *          choice             information that may be missing in the file
 * Returns  value              false: failed, see problems
 *          record   m/s2, s   to be freed
 * Memory   allocates the samples
 *
 *   a [m/s2] = sample x 9.80665 (g), x 0.01 (cm/s2), x 1 (m/s2)
 *
 * Test     unit_record: files_of_every_format_have_their_known_values
 */
bool record_read(const char *text, size_t length, const struct record_choice *choice, struct record *record,
                 struct problems *problems)
{
	problems_init(problems);
	struct record_text start = {.at = text, .end = text + length, .choice = choice, .problems = problems};
	*record = (struct record){0};
	if (memchr(text, 0, length)) {
		record_text_complain(&start, -1, "is not a text file");
		return false;
	}
	const int row = format_of(&start);
	record->format = formats[row].name;
	if (formats[row].read(&start, record))
		return true;
	record_free(record);
	return false;
}

void record_free(struct record *record)
{
	free(record->acceleration);
	record->acceleration = NULL;
}
