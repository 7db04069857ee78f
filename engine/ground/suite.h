/* suite.h - recorded ground motions as the signals of a scene: record and factor of each signal. */
#ifndef SUITE_H
#define SUITE_H

#include "engine/numeric/random.h"
#include "engine/pound.h"

/* Record and factor of the signal `stream.signal`; if records are drawn, the stream's draw 0 selects the record. */
struct pound_suite_signal pound_suite_signal(const struct pound_excitation *suite, const double *references,
                                             struct pound_stream stream);
/* The same signal as an excitation of type record. */
struct pound_excitation pound_suite_excitation(const struct pound_excitation *suite,
                                               struct pound_suite_signal signal);

#endif
