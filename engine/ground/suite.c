/* suite.c - recorded ground motions as the signals of a scene: record and factor of each signal.
 *
 * To solvers a signal of a suite is an excitation of type record, with the samples, time step and factor of that record. */
#include "engine/ground/suite.h"

#include <assert.h>
#include <string.h>

const char *pound_scale_name(int row)
{
	static const char *const names[] = {[POUND_SCALE_NONE] = "none",
	                                    [POUND_SCALE_PGA] = "pga",
	                                    [POUND_SCALE_SA] = "sa",
	                                    [POUND_SCALE_MEDIAN_SA] = "median_sa"};
	return row >= 0 && row < (int)(sizeof names / sizeof names[0]) ? names[row] : NULL;
}

int pound_suite_signals(const struct pound_excitation *suite)
{
	return suite->n_records * (suite->both ? 2 : 1);
}

void pound_suite_samples(const struct pound_excitation *suite, int *least, int *most)
{
	*least = *most = suite->records[0].n;
	for (int k = 1; k < suite->n_records; k++) {
		const int n = suite->records[k].n;
		*least = n < *least ? n : *least;
		*most = n > *most ? n : *most;
	}
}

/* Record and factor of a signal of a suite.
 *
 * Given    references  (n_records)  m/s2   reference intensities (suite_references.c); NULL: records are not scaled
 *          stream      -            -      random stream of the signal; if records are drawn, its draw 0 selects k
 * Returns  value       record       -      k, the signal's number or drawn; with both directions k / 2
 *                      factor       -      with both directions negative for odd k
 *
 *   factor = F f_r s_r, reversed: -F f_r s_r      s_r = 1 or intensity / reference_r
 *
 * with r the record, F the factor of the suite and f_r the factor of the record.  record->reversed changes the sign, too.
 *
 * Test     unit_suite: factors_are_those_of_their_definition; a_drawn_record_is_any_with_the_same_probability
 */
struct pound_suite_signal pound_suite_signal(const struct pound_excitation *suite, const double *references,
                                             struct pound_stream stream)
{
	stream.what = POUND_STREAM_RECORD;
	const int among = pound_suite_signals(suite);
	const int k = suite->draw ? (int)pound_random_below(stream, 0, (uint32_t)among) : (int)stream.signal;
	assert(k < among);
	const int number = suite->both ? k / 2 : k;
	const struct pound_record *record = &suite->records[number];
	const bool reversed = record->reversed != (suite->both && k % 2);
	const double scaled = references ? suite->scale.intensity / references[number] : 1;
	const double factor = suite->factor * record->factor * scaled;
	return (struct pound_suite_signal){.record = number, .factor = reversed ? -factor : factor};
}

static int record_type(void)
{
	int row = 0;
	while (strcmp(pound_excitation_name(row), "record") != 0)
		row++;
	return row;
}

struct pound_excitation pound_suite_excitation(const struct pound_excitation *suite,
                                               struct pound_suite_signal signal)
{
	const struct pound_record *record = &suite->records[signal.record];
	return (struct pound_excitation){.type = record_type(),
	                                 .time_step = record->time_step,
	                                 .signals = 1,
	                                 .factor = signal.factor,
	                                 .n_record = record->n,
	                                 .record = record->a,
	                                 .number = signal.record};
}
