/* suite.c - recorded ground motions as the signals of a scene: which record a signal is, and its factor.
 *
 * For what runs it a signal is an excitation of type record, with samples, step and factor of its own. */
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

/* Which record a signal of a suite is, and its factor.
 *
 * Given    references  (n_records)  m/s2   what the intensity is divided by; NULL: the records are not scaled
 *          stream      -            -      of the signal, of whose draw 0 it depends where records are drawn
 * Returns  value       record       -      signal k, or k/2 with both directions, the second one reversed
 *                      factor       -
 *
 *   factor = F f_k s_k, reversed: -F f_k s_k      s_k = 1 or intensity / reference_k
 *
 * with F the factor of the suite and f_k the factor of the record.
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
