/* result_floor.c - writes floor spectra as JSON: ordinates over the signals, peaks of the mean, error estimates. */
#include "schema/result/result_floor.h"

#include <math.h>

#include "schema/study/study_spectrum.h"

static const char *const names[] = {
#define X(row, name) [POUND_SPECTRUM_##row] = name,
    POUND_SPECTRA(X)
#undef X
};

static void write_numbers(struct writer *w, const char *name, const double *values, int n)
{
	writer_array(w, name, WRITER_LINE);
	for (int k = 0; k < n; k++)
		writer_number(w, NULL, values[k]);
	writer_end(w);
}

static void write_spectra(struct writer *w, const struct pound_floor_result *floor, int n)
{
	writer_array(w, "spectra", WRITER_LINES);
	for (int row = 0; row < POUND_N_SPECTRA; row++) {
		const struct pound_floor_spectrum *spectrum = &floor->spectra[row];
		writer_object(w, NULL, WRITER_LINES);
		writer_text(w, "name", names[row]);
		write_numbers(w, "mean_m_s2", spectrum->mean, n);
		write_numbers(w, "p16_m_s2", spectrum->p16, n);
		write_numbers(w, "p84_m_s2", spectrum->p84, n);
		writer_end(w);
	}
	writer_end(w);
}

/* The local maxima of the mean spectrum with pounding, with the value of Eq. (21) at the same frequency. */
static void write_peaks(struct writer *w, const struct pound_study *study,
                        const struct pound_floor_result *floor)
{
	const double *mean = floor->spectra[POUND_SPECTRUM_POUNDING].mean;
	const double *train = floor->spectra[POUND_SPECTRUM_DIRAC_PEAKS].mean;
	writer_array(w, "peaks", WRITER_LINES);
	for (int k = 1; k + 1 < study->spectrum.n; k++) {
		double frequency = pound_spectrum_frequency(&study->spectrum, k);
		if (!(mean[k] > mean[k - 1] && mean[k] > mean[k + 1]))
			continue;
		writer_object(w, NULL, WRITER_LINE);
		writer_number(w, "frequency_hz", frequency);
		writer_number(w, "frequency_ratio", frequency / floor->frequency_hz);
		writer_number(w, "mean_m_s2", mean[k]);
		writer_number(w, "dirac_peaks_m_s2", train[k]);
		writer_number(w, "ratio", mean[k] / train[k]);
		writer_end(w);
	}
	writer_end(w);
}

static void write_accuracy(struct writer *w, const struct pound_floor_result *floor, int n)
{
	writer_object(w, "accuracy", WRITER_LINES);
	writer_whole(w, "signals_checked", floor->signals_checked);
	writer_array(w, "spectra", WRITER_LINES);
	for (int row = 0; row < POUND_N_INTEGRATED; row++) {
		const double *error = floor->spectra[row].error;
		double largest = NAN;
		for (int k = 0; k < n; k++)
			largest = fmax(largest, error[k]);
		writer_object(w, NULL, WRITER_LINES);
		writer_text(w, "name", names[row]);
		writer_number(w, "relative_error_max", largest);
		write_numbers(w, "relative_error", error, n);
		writer_end(w);
	}
	writer_end(w);
	writer_end(w);
}

/* Writes the result of a floor spectrum study.
 *
 * Test     unit_result_floor: every_spectrum_has_a_number_for_every_frequency
 */
void result_floor_spectra(struct writer *w, const struct pound_study *study,
                          const struct pound_result *result)
{
	const struct pound_floor_result *floor = &result->floor;
	int n = study->spectrum.n;
	writer_whole(w, "runs", floor->signals);
	writer_whole(w, "runs_failed", floor->signals_failed);
	if (floor->signals_failed)
		writer_text(w, "note",
		            "failed runs are left out of the spectra and their histories may end early; "
		            "work.failures has the reasons");
	writer_array(w, "frequencies_hz", WRITER_LINE);
	for (int k = 0; k < n; k++)
		writer_number(w, NULL, pound_spectrum_frequency(&study->spectrum, k));
	writer_end(w);
	writer_number(w, "damping_ratio", study->spectrum.damping_ratio);
	writer_number(w, "impulse_max_mean_n_s", floor->impulse_mean);
	writer_number(w, "pulses_mean", floor->pulses_mean);
	write_spectra(w, floor, n);
	write_peaks(w, study, floor);
	write_accuracy(w, floor, n);
}

/* Writes frequency, damping and correlation of an output that is an ordinate; if one output is an ordinate, all outputs have these
 * members, so that they fit into one table.
 *
 * Test     unit_result_floor: an_ordinate_has_its_frequency_and_its_correlation_with_the_impulse
 */
void result_floor_ordinate(struct writer *w, const struct pound_study *study,
                           const struct pound_indices *indices, int output)
{
	int k = pound_study_ordinate(study, output);
	if (study->spectrum.n == 0)
		return;
	writer_number(w, "frequency_hz", k < 0 ? NAN : pound_spectrum_frequency(&study->spectrum, k));
	writer_number(w, "damping_ratio", k < 0 ? NAN : study->spectrum.damping_ratio);
	writer_number(w, "impulse_correlation", indices->impulse_correlation.value);
	writer_number(w, "impulse_correlation_low", indices->impulse_correlation.low);
	writer_number(w, "impulse_correlation_high", indices->impulse_correlation.high);
}
