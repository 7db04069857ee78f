/* floor_outputs.c - floor spectra as outputs of a study.
 *
 * 1. After the marches of a block the tasks of its floors are run again with floor oscillators, and the spectra are stored with
 *    the other measures of the run; equal floors are run once.
 * 2. A floor spectrum study reduces the spectra to mean and percentiles over the signals; a sensitivity study has an output per
 *    frequency, and its correlation with the largest impulse.
 * 3. A check uses half the sample step and half the longest oscillator step. */
#include "engine/run/floor_outputs.h"

#include <assert.h>
#include <math.h>
#include <string.h>

#include <gsl/gsl_sort.h>
#include <gsl/gsl_statistics_double.h>

#include "engine/floor/pulse_train.h"
#include "engine/scene/building.h"

static const double PI = 3.14159265358979323846;

/* Longest step of an oscillator [rad], for results and for checks. */
static const double RADIANS = 1.5, RADIANS_CHECK = 0.75;

/* measures of a signal after its spectra */
enum { IMPULSE, PULSES, MEASURES };

/* state of the floor of a task */
struct followed {
	int ask; /* number of the ask with its ordinates, plus one; 0: none yet */
	enum pound_status status;
};

struct pound_ordinates {
	struct pound_floor *floor;
	int n;                     /* frequencies */
	double *psa;               /* of every floor of a batch  (POUND_FLOORS x POUND_DRIVES x n) */
	struct followed *followed; /* of each task  (n_tasks) */
	int n_tasks;
};

static bool has_spectra(const struct pound_study *study)
{
	return study->kind == POUND_KIND_FLOOR_SPECTRUM;
}

/* A run of a floor spectrum study stores all spectra; a run of a sensitivity study the impulse, ordinates being outputs. */
int pound_ordinate_measures(const struct pound_study *study)
{
	if (study->spectrum.n == 0)
		return 0;
	return has_spectra(study) ? POUND_N_SPECTRA * study->spectrum.n + MEASURES : 1;
}

/* ---- scratch memory ---- */

static size_t aligned(size_t bytes)
{
	return (bytes + 63) / 64 * 64;
}

size_t pound_ordinate_bytes(const struct pound_study *study, int n_tasks)
{
	int n = study->spectrum.n;
	if (n == 0)
		return 0;
	return aligned(sizeof(struct pound_ordinates)) + aligned(pound_floor_bytes(n)) +
	       aligned(POUND_FLOORS * POUND_DRIVES * sizeof(double) * (size_t)n) +
	       aligned(sizeof(struct followed) * (size_t)n_tasks);
}

struct pound_ordinates *pound_ordinate_init(void *memory, const struct pound_study *study, int n_tasks)
{
	struct pound_ordinates *ordinates = memory;
	char *at = (char *)memory + aligned(sizeof *ordinates);
	ordinates->floor = pound_floor_init(at, &study->spectrum);
	at += aligned(pound_floor_bytes(study->spectrum.n));
	ordinates->psa = (double *)(void *)at;
	at += aligned(POUND_FLOORS * POUND_DRIVES * sizeof(double) * (size_t)study->spectrum.n);
	ordinates->followed = (struct followed *)(void *)at;
	ordinates->n = study->spectrum.n;
	ordinates->n_tasks = n_tasks;
	return ordinates;
}

/* ---- blocks ---- */

static void scaled(const double *psa, int n, int exponent, double *into)
{
	for (int k = 0; k < n; k++)
		into[k] = ldexp(psa[k], exponent);
}

static void dirac_fill(const struct pound_spectrum *spectrum, const struct pound_pulse_train *dirac,
                       double *values)
{
	static double (*const rows[])(const struct pound_pulse_train *, double, double) = {
	    [POUND_SPECTRUM_DIRAC_LINE] = pound_pulse_train_line,
	    [POUND_SPECTRUM_DIRAC_TRAIN] = pound_pulse_train_train,
	    [POUND_SPECTRUM_DIRAC_PEAKS] = pound_pulse_train_peaks,
	};
	for (int row = POUND_N_INTEGRATED; row < POUND_N_SPECTRA; row++)
		for (int k = 0; k < spectrum->n && !pound_stopped(dirac->stop); k++)
			values[row * spectrum->n + k] =
			    rows[row](dirac, 2 * PI * pound_spectrum_frequency(spectrum, k), spectrum->damping_ratio);
}

/* A batch of floors that are run together, for several asks. */
struct floor_batch {
	int n_floors, n_asks;
	struct pound_floor_ask asks[POUND_FLOORS];       /* (n_floors) */
	struct pound_floor_answer answers[POUND_FLOORS]; /* (n_floors) */
	struct {
		int ask, first; /* number of the ask, and of its first floor */
		struct pound_request_floor floor;
		double *values;
	} of[POUND_FLOORS]; /* (n_asks) */
};

/* Adds a floor to the batch, with or without pounding. */
static void batch_add(struct floor_batch *b, struct pound_ordinates *o, struct pound_floor_ask ask,
                      const struct pound_request_floor *request, bool pounding)
{
	ask.task = pounding ? request->pounding : request->free;
	ask.chain = pounding ? request->row.pounding : request->row.free;
	ask.n_drives = pounding ? ask.n_drives : 1; // without contact there is no force
	struct pound_floor_answer *answer = &b->answers[b->n_floors];
	*answer = (struct pound_floor_answer){0};
	for (int d = 0; d < POUND_DRIVES; d++)
		answer->psa[d] = o->psa + (size_t)(b->n_floors * POUND_DRIVES + d) * (size_t)o->n;
	b->asks[b->n_floors++] = ask;
}

/* All spectra of one signal.
 *
 * Given    answers  of the floor without pounding, then with pounding if contact occurs
 */
static void spectra_fill(const struct pound_study *study, const struct pound_request_floor *request,
                         const struct pound_floor_answer *answers, const atomic_bool *stop, double *values)
{
	int n = study->spectrum.n;
	const struct pound_floor_answer *pounding = &answers[request->touches ? 1 : 0];
	scaled(answers->psa[POUND_DRIVE_FLOOR], n, request->exponent, values + POUND_SPECTRUM_FREE * n);
	scaled(pounding->psa[POUND_DRIVE_FLOOR], n, request->exponent, values + POUND_SPECTRUM_POUNDING * n);
	for (int k = 0; k < n; k++)
		values[POUND_SPECTRUM_IMPACT_ONLY * n + k] =
		    request->touches ? ldexp(pounding->psa[POUND_DRIVE_PUSH][k], request->exponent) : 0;
	int pulses = study->spectrum.pulses;
	const struct pound_pulse_train dirac = {.speed = ldexp(pounding->impulse_max, request->exponent),
	                                        .spacing = 0.5 / request->frequency_hz,
	                                        .pulses = pulses ? pulses : (double)pounding->contacts,
	                                        .stop = stop};
	dirac_fill(&study->spectrum, &dirac, values);
	values[POUND_N_SPECTRA * n + IMPULSE] = request->mass * dirac.speed;
	values[POUND_N_SPECTRA * n + PULSES] = dirac.pulses;
}

/* The ordinates of one sample and signal. */
static void ordinates_fill(const struct pound_study *study, const struct pound_request_floor *request,
                           const struct pound_floor_answer *answer, double *values)
{
	for (int output = 0; output < study->n_outputs; output++) {
		int k = pound_study_ordinate(study, output);
		if (k >= 0)
			values[2 * output] = ldexp(answer->psa[POUND_DRIVE_FLOOR][k], request->exponent);
	}
}

/* Runs the floors of a batch, and fills in the spectra or ordinates of its asks. */
static void batch_run(struct floor_batch *b, struct pound_ordinates *o, const struct pound_study *study,
                      const atomic_bool *stop)
{
	if (b->n_floors)
		pound_floor_spectra(o->floor, b->asks, b->answers, b->n_floors);
	for (int i = 0; i < b->n_asks && !pound_stopped(stop); i++) {
		const struct pound_request_floor *floor = &b->of[i].floor;
		const struct pound_floor_answer *answers = &b->answers[b->of[i].first];
		const int n_floors = (i + 1 < b->n_asks ? b->of[i + 1].first : b->n_floors) - b->of[i].first;
		enum pound_status status = answers->status ? answers->status : answers[n_floors - 1].status;
		o->followed[floor->march] = (struct followed){b->of[i].ask + 1, status};
		if (status)
			continue;
		if (has_spectra(study))
			spectra_fill(study, floor, answers, stop, b->of[i].values);
		else
			ordinates_fill(study, floor, answers, b->of[i].values);
	}
	b->n_floors = b->n_asks = 0;
}

static int measures_of(const struct pound_study *study)
{
	return (has_spectra(study) ? 0 : 2 * study->n_outputs) + pound_ordinate_measures(study);
}

/* Copies ordinates to asks that share a floor with an earlier ask; if the run of the floor failed, all asks with this floor
 * have failed. */
static void ordinates_share(const struct pound_ordinates *o, const struct pound_study *study,
                            const struct pound_request *request, double *values, struct pound_work *work)
{
	int n_items, n_asks = pound_request_count(request, &n_items), n = measures_of(study);
	for (int a = 0; a < n_asks; a++) {
		const struct followed *followed = &o->followed[pound_request_floor(request, a).march];
		double *own = values + (size_t)a * (size_t)n;
		if (isnan(own[n - 1]))
			continue;
		const double *known = values + (size_t)(followed->ask - 1) * (size_t)n;
		for (int output = 0; output < study->n_outputs && known != own && !has_spectra(study); output++)
			if (pound_study_ordinate(study, output) >= 0)
				own[2 * output] = known[2 * output];
		if (followed->status <= POUND_CHATTER && a < n_items)
			work->failed[POUND_CHATTER - followed->status]++;
		for (int j = 0; j < n && followed->status; j++)
			own[j] = NAN;
	}
}

/* Adds the requested spectra to a block that the request has run.
 *
 * Given    request     its asks in the order of their values
 *          values   (asks x measures)  the last is NAN for a failed run
 *          stop     checked throughout
 * Returns  values   with spectra or ordinates; all NAN if the run of a floor failed
 *          work     floors requested and run, and runs that failed in a floor; without checks
 * Status   POUND_STOPPED  stop was set
 */
enum pound_status pound_ordinate_block(struct pound_ordinates *o, const struct pound_study *study,
                                       const struct pound_request *request, double *values,
                                       const atomic_bool *stop, struct pound_work *work)
{
	int n_items, n_asks = pound_request_count(request, &n_items), n = measures_of(study);
	const bool spectra = has_spectra(study);
	struct floor_batch batch = {0};
	memset(o->followed, 0, sizeof *o->followed * (size_t)o->n_tasks);
	for (int a = 0; a < n_asks && !pound_stopped(stop); a++) {
		const struct pound_request_floor floor = pound_request_floor(request, a);
		const struct pound_floor_ask ask = {.n_drives = spectra ? POUND_DRIVES : 1,
		                                    .radians = a < n_items ? RADIANS : RADIANS_CHECK,
		                                    .stop = stop,
		                                    .scratch = floor.scratch};
		const int floors = spectra && floor.touches ? 2 : 1;
		double *own = values + (size_t)a * (size_t)n;
		assert(floor.march < o->n_tasks);
		work->floors.asked += a < n_items ? floors : 0;
		if (isnan(own[n - 1]) || (!spectra && o->followed[floor.march].ask))
			continue;
		work->floors.run += a < n_items ? floors : 0;
		if (batch.n_floors + floors > POUND_FLOORS)
			batch_run(&batch, o, study, stop);
		o->followed[floor.march].ask = a + 1;
		batch.of[batch.n_asks].ask = a;
		batch.of[batch.n_asks].first = batch.n_floors;
		batch.of[batch.n_asks].floor = floor;
		batch.of[batch.n_asks++].values = own;
		if (spectra)
			batch_add(&batch, o, ask, &floor, false);
		if (!spectra || floor.touches)
			batch_add(&batch, o, ask, &floor, floor.touches);
	}
	batch_run(&batch, o, study, stop);
	if (!pound_stopped(stop))
		ordinates_share(o, study, request, values, work);
	return pound_stopped(stop) ? POUND_STOPPED : POUND_OK;
}

/* ---- over the signals ---- */

void pound_ordinate_layout(const struct pound_study *study, double *numbers,
                           struct pound_floor_result *result)
{
	int n = study->spectrum.n;
	for (int row = 0; row < POUND_N_SPECTRA; row++, numbers += 4 * n)
		result->spectra[row] =
		    (struct pound_floor_spectrum){numbers, numbers + n, numbers + 2 * n, numbers + 3 * n};
}

size_t pound_ordinate_scratch(const struct pound_study *study, int n_rows)
{
	if (study->spectrum.n == 0)
		return 0;
	if (has_spectra(study))
		return (size_t)study->scene.excitation.signals;
	return 5 * (size_t)n_rows + pound_bootstrap_scratch(n_rows, 5, 1);
}

/* The finite values of a measure over the signals, sorted; returns how many. */
static int measure_sort(const struct pound_run *run, int measure, double *sorted)
{
	int n = 0;
	for (int signal = 0; signal < run->campaign.n_signals; signal++) {
		double value = pound_blocks_run(&run->layout, signal, 0, 0)[measure];
		if (!isnan(value))
			sorted[n++] = value;
	}
	gsl_sort(sorted, 1, (size_t)n);
	return n;
}

/* Largest relative difference of a measure between runs and their checks; NAN: no checks. */
static double measure_error(const struct pound_run *run, int measure)
{
	double largest = NAN;
	const struct pound_cells *c = &run->campaign;
	for (int signal = 0; signal < c->n_signals && c->check_every; signal += c->check_every) {
		double once = pound_blocks_run(&run->layout, signal, 0, 0)[measure];
		double again = pound_blocks_check(&run->layout, signal, 0, 0)[measure];
		largest = fmax(largest, once == again ? 0 : fabs(again - once) / fabs(once));
	}
	return largest;
}

static double mean_of(const double *value, int n)
{
	double sum = 0;
	for (int i = 0; i < n; i++)
		sum += value[i];
	return n ? sum / n : NAN;
}

/* First frequency of the floor's body or building [Hz]. */
static double body_frequency(const struct pound_study *study)
{
	struct pound_storeys storeys;
	if (study->scene.n_buildings == 0)
		return study->scene.oscillators[0].frequency_hz;
	pound_building_storeys(&study->scene.buildings[study->spectrum.place.building], &storeys);
	return storeys.frequency / (2 * PI);
}

/* Mean, 16 % and 84 % quantiles of every spectrum over the signals, and errors from the checks.
 *
 * Given    scratch  (pound_ordinate_scratch)
 * Returns  result   quantiles linear between order statistics
 * Test     unit_floor_outputs
 */
void pound_ordinate_reduce(const struct pound_run *run, double *scratch, struct pound_floor_result *result)
{
	const struct pound_cells *c = &run->campaign;
	int n = c->study->spectrum.n;
	result->signals = c->n_signals;
	result->frequency_hz = body_frequency(c->study);
	result->signals_checked = pound_cells_checks(c, c->n_signals);
	for (int row = 0; row < POUND_N_SPECTRA; row++)
		for (int k = 0; k < n && !pound_stopped(run->stop); k++) {
			struct pound_floor_spectrum *into = &result->spectra[row];
			int known = measure_sort(run, row * n + k, scratch);
			into->mean[k] = mean_of(scratch, known);
			into->p16[k] = known ? gsl_stats_quantile_from_sorted_data(scratch, 1, (size_t)known, 0.16) : NAN;
			into->p84[k] = known ? gsl_stats_quantile_from_sorted_data(scratch, 1, (size_t)known, 0.84) : NAN;
			if (row < POUND_N_INTEGRATED)
				into->error[k] = measure_error(run, row * n + k);
		}
	int known = measure_sort(run, POUND_N_SPECTRA * n + IMPULSE, scratch);
	result->impulse_mean = mean_of(scratch, known);
	result->signals_failed = c->n_signals - known;
	known = measure_sort(run, POUND_N_SPECTRA * n + PULSES, scratch);
	result->pulses_mean = mean_of(scratch, known);
}

/* ---- correlation with the impulse ---- */

/* x: ordinate, y: impulse, of samples A and B, both centered  (n_rows x 2) each */
struct pairs {
	const double *x, *y;
};

static void pair_moments(const void *subject, int row, double *m)
{
	const struct pairs *pairs = subject;
	for (int j = 0; j < 5; j++)
		m[j] = 0;
	for (int i = 2 * row; i < 2 * row + 2; i++) {
		double x = pairs->x[i], y = pairs->y[i];
		m[0] += 0.5 * x, m[1] += 0.5 * y;
		m[2] += 0.5 * x * x, m[3] += 0.5 * y * y, m[4] += 0.5 * x * y;
	}
}

static void pair_correlation(const void *subject, const double *m, double *value)
{
	(void)subject;
	double xx = m[2] - m[0] * m[0], yy = m[3] - m[1] * m[1];
	*value = xx > 0 && yy > 0 ? (m[4] - m[0] * m[1]) / sqrt(xx * yy) : NAN;
}

struct pair {
	double x, y;
};

/* Means over the signals of one sample's ordinate x and largest impulse per mass y: not finite if a run failed. */
static struct pair pair_of(const struct pound_run *run, int cell, int row, int sample, int output)
{
	int n_signals = run->campaign.n_signals;
	struct pair pair = {0, 0};
	for (int r = 0; r < n_signals; r++) {
		const double *values = pound_blocks_run(&run->layout, row * n_signals + r, cell, sample);
		pair.x += values[2 * output] / n_signals;
		pair.y += values[2 * run->campaign.study->n_outputs] / n_signals;
	}
	return pair;
}

static void centre(double *x, int n)
{
	double mean = mean_of(x, n);
	for (int i = 0; i < n; i++)
		x[i] -= mean;
}

/* Correlation, over the samples A and B, of an ordinate with the largest impulse over the left mass.
 *
 * Given    scratch  (pound_ordinate_scratch)
 * Returns  value    Pearson's, with a 95 % interval by jackknife or bootstrap; NAN: no ordinate, or x or y is constant
 * Test     unit_floor_outputs: the_correlation_is_that_of_the_samples, its_interval_is_by_groups_where_the_rows_have_some
 */
struct pound_estimate pound_ordinate_correlation(const struct pound_run *run, int cell, int output,
                                                 double *scratch)
{
	const struct pound_study *study = run->campaign.study;
	struct pound_estimate correlation = {NAN, NAN, NAN};
	if (pound_study_ordinate(study, output) < 0)
		return correlation;
	int n = 0;
	double *x = scratch, *y = scratch + 2 * run->rows;
	int64_t *rows = (int64_t *)(y + 2 * run->rows);
	for (int row = 0; row < run->rows && !pound_stopped(run->stop); row++) {
		bool whole = true;
		for (int sample = 0; sample < 2; sample++) {
			const struct pair pair = pair_of(run, cell, row, sample, output);
			x[2 * n + sample] = pair.x, y[2 * n + sample] = pair.y;
			whole &= isfinite(pair.x) && isfinite(pair.y);
		}
		rows[n] = row;
		n += whole;
	}
	if (n < 2)
		return correlation;
	centre(x, 2 * n);
	centre(y, 2 * n);
	const struct pairs pairs = {x, y};
	const struct pound_statistic statistic = {.n_moments = 5,
	                                          .n_values = 1,
	                                          .moments = pair_moments,
	                                          .values = pair_correlation,
	                                          .subject = &pairs,
	                                          .stop = run->stop};
	const struct pound_sample_values values = pound_cells_values(&run->campaign, run->rows, NULL);
	const struct pound_scatter scatter = pound_rows_scatter(&values, rows);
	pound_bootstrap_estimates(&statistic, &scatter, n,
	                          (struct pound_resampling){study->design.seed, POUND_RESAMPLES},
	                          scratch + 5 * run->rows, &correlation);
	return correlation;
}

/* ---- histories ---- */

/* Receiver of the instants of a signal, in the units of the study. */
struct history {
	pound_run_take *take;
	void *into;
	int signal, exponent;
	bool both; /* a second body exists */
	bool contact;
	double mass;
};

static double history_scaled(const struct history *to, double value)
{
	return ldexp(value, to->exponent) + 0.0; // no -0
}

static void history_take(void *of, const struct pound_floor_instant *instant)
{
	const struct history *to = of;
	struct pound_instant row = {.time = instant->time,
	                            .force = 0 - to->mass * ldexp(instant->push, to->exponent),
	                            .gap = to->contact ? history_scaled(to, instant->gap) : NAN,
	                            .ground = history_scaled(to, instant->ground)};
	for (int i = 0; i < POUND_OSCILLATORS; i++) {
		const bool has = i == 0 || to->both;
		row.u[i] = has ? history_scaled(to, instant->u[i]) : NAN;
		row.v[i] = has ? history_scaled(to, instant->v[i]) : NAN;
		row.acceleration[i] = has ? history_scaled(to, instant->acceleration[i]) : NAN;
	}
	to->take(to->into, to->signal, &row);
}

static void response_leave(void *into, const struct pound_outcome *outcome)
{
	enum pound_status *first = into;
	*first = *first ? *first : outcome->status;
}

/* Reports the history of a signal.
 *
 * Given    run     of a floor spectrum study
 * Returns  take    called in order of time
 * Status   POUND_CHATTER and others  the run or its repetition failed
 *          POUND_STOPPED             pound_run_stop was called
 * Test     unit_floor_outputs: a_history_is_that_of_the_signal
 */
enum pound_status pound_run_history(struct pound_run *run, int signal, pound_run_take *take, void *into)
{
	struct pound_work work = {0};
	enum pound_status status = POUND_OK, left = POUND_OK;
	assert(has_spectra(run->campaign.study));
	status = pound_request_run(run->requests[0], (struct pound_items){&run->campaign, signal, 1}, run->stop,
	                           &work, response_leave, &left);
	if (status || left)
		return status ? status : left;
	const struct pound_request_floor floor = pound_request_floor(run->requests[0], 0);
	struct history to = {.take = take,
	                     .into = into,
	                     .signal = signal,
	                     .exponent = floor.exponent,
	                     .both = true,
	                     .contact = floor.contact,
	                     .mass = floor.mass};
	struct pound_floor_ask ask = {.stop = run->stop, .scratch = floor.scratch};
	struct pound_task pair;
	if (run->campaign.study->scene.n_buildings > 0) {
		ask.chain = floor.touches ? floor.row.pounding : floor.row.free;
		to.both = to.contact = pound_floor_contact(&ask.chain) >= 0;
	} else {
		pair = pound_request_pair(run->requests[0], 0);
		ask.task = &pair;
	}
	return pound_floor_history(run->floors[0]->floor, &ask, history_take, &to);
}
