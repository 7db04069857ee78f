/* suite.h - recorded ground motions as the signals of a scene: which record a signal is, and its factor. */
#ifndef SUITE_H
#define SUITE_H

#include "engine/numeric/random.h"
#include "engine/pound.h"

/* The record that a signal of a suite is; `stream` is drawn from where records are drawn. */
struct pound_suite_signal pound_suite_signal(const struct pound_excitation *suite, const double *references,
                                             struct pound_stream stream);
/* That record as an excitation of its own. */
struct pound_excitation pound_suite_excitation(const struct pound_excitation *suite,
                                               struct pound_suite_signal signal);

#endif
