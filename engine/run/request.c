/* request.c - runs the items of a block without duplicates.
 *
 * 1. every sample of every cell (an "ask") requests its ground motion, its responses without pounding and its run with pounding;
 * 2. each request is a key of numbers; equal keys are one motion or one march (a run of the solver);
 * 3. motions are filled, then marches run stage by stage: linear responses, nonlinear responses with the yield
 *    displacement found from earlier stages, last the runs with pounding.
 *
 * The check of an item repeats all this on ground motions with an interpolated sample between every two: the same
 * signal, which is linear between samples, but other steps with other maps, series and root searches. */
#include "engine/run/request.h"

#include <assert.h>
#include <float.h>
#include <math.h>
#include <string.h>

#include "engine/ground/excitation.h"
#include "engine/numeric/hash.h"
#include "engine/numeric/random.h"
#include "engine/run/demand.h"
#include "engine/run/outputs.h"
#include "engine/run/pair_peaks.h"
#include "engine/run/request_keys.h"
#include "engine/run/request_motions.h"
#include "engine/run/request_parts.h"
#include "engine/run/response.h"
#include "engine/run/row_runs.h"
#include "engine/run/scene.h"
#include "engine/solver/solver.h"

enum {
	SEARCH_MIN = 2, /* corrections from which on a search is made */
};

/* Registers the ground motion of a sample: its excitation, and the noise of its row and signal, if random. */
static int motion_ask(struct pound_request *request, const struct pound_excitation *e,
                      struct pound_stream noise, bool halved)
{
	if (!pound_excitation_random(e))
		noise = (struct pound_stream){0};
	int known = request->motion_keys.n;
	int j = pound_keys_motion(&request->motion_keys, e, noise, halved);
	if (j == known)
		request->motions[j] =
		    (struct pound_motion){.excitation = *e, .noise = noise, .halved = halved, .number = j};
	return j;
}

/* Registers a march; bodies and contact are set, the ground motion is added here. */
static int march_ask(struct pound_request *request, int motion, struct pound_task *task)
{
	const struct pound_motion *m = &request->motions[motion];
	int known = request->march_keys.n;
	int j = pound_keys_run(&request->march_keys, motion, task);
	if (j == known) {
		request->tasks[j] = *task;
		request->tasks[j].ground = m->ground;
		request->tasks[j].n_samples = m->n_samples;
		request->tasks[j].time_step = m->time_step;
	}
	return j;
}

/* ---- stages ---- */

/* Whether every contact force of the scenes scales with the motion: then scaling a ground motion by a power of two changes no
 * digit of any response. */
static bool forces_scale(const struct pound_request *request)
{
	bool scale = true;
	for (int a = 0; a < request->n_asks && scale; a++) {
		const struct pound_scene *scene = &request->asks[a].scene;
		scale = !scene->contact.present || pound_force_scales(pound_contact_force(scene->contact.model));
		for (int k = 0; k < scene->n_contacts && scale; k++)
			scale = pound_force_scales(pound_contact_force(scene->contacts[k].contact.model));
	}
	return scale;
}

/* Whether the exact solver can run the checks [from, end); else the study's solver runs them, on half the sample step. */
static bool exact_takes(const struct pound_request *request, int from, int end)
{
	bool takes = true;
	for (int j = from; j < end && takes; j++)
		takes = !request->tasks[j].contact ||
		        pound_solver_takes_force(POUND_SOLVER_EVENT, request->tasks[j].force);
	return takes;
}

/* Runs the marches requested since the previous stage.  The marches of the checks come first, and are run by the exact solver
 * if possible, whatever the study's solver. */
static enum pound_status marches_run(struct pound_request *request, const struct pound_solver *solver,
                                     int checks_end, int *done, const atomic_bool *stop)
{
	static const struct pound_solver exact = {.method = POUND_SOLVER_EVENT};
	int from = *done, n = request->march_keys.n;
	assert(n <= request->size.tasks);
	const struct pound_solver *checks = exact_takes(request, from, checks_end) ? &exact : solver;
	// one call for both if possible, as it fills the lanes better
	int cut = solver->method == checks->method ? n : checks_end;
	*done = n;
	enum pound_status status = pound_solver_run(checks, &request->tasks[from], &request->results[from],
	                                            cut - from, request->scratch, stop);
	return status ? status
	              : pound_solver_run(solver, &request->tasks[cut], &request->results[cut], n - cut,
	                                 request->scratch, stop);
}

/* Largest negligible length [m], in the scale of the ground motion.
 *
 * 2^-90 of the displacement of a body in one sample by a unit ground acceleration: it is crossed in 2^-45 of a step or more,
 * which an event search still resolves; a shorter length would be crossed within a step's rounding.
 */
static double negligible(const struct pound_request *request, const struct ask *ask)
{
	double h = request->motions[ask->motion].excitation.time_step, least = h * h;
	for (int i = 0; i < POUND_OSCILLATORS; i++)
		least = fmin(least, 1 / fmax(pound_scene_body(&ask->scene, i).backbone.stiffness, DBL_MIN));
	return 0x1p-90 * least;
}

/* The yield displacement used in a march, limited to a resolvable range; 1 (arbitrary) for a body that never moves. */
static double yield_marched(const struct pound_request *request, const struct ask *ask, double yield)
{
	return yield > 0 ? fmin(fmax(yield, negligible(request, ask)), 1 / DBL_EPSILON / DBL_EPSILON) : 1;
}

static int body_march(struct pound_request *request, const struct ask *ask, int i, int law, double yield)
{
	struct pound_task task = {.bodies = {pound_scene_body(&ask->scene, i)}};
	task.bodies[0].followed = true;
	task.accounted = ask->balanced;
	task.bodies[0].backbone.law = law;
	task.bodies[0].backbone.yield = yield;
	if (pound_law_linear(law))
		task.bodies[0].backbone.hardening = 0;
	return march_ask(request, ask->motion, &task);
}

static bool searched(const struct pound_law *law)
{
	return !pound_law_linear(law->type) && !(law->yield_displacement > 0) && law->corrections >= SEARCH_MIN;
}

/* Requests the next march of a search for the target demand, which starts from the march with the reduced elastic displacement.
 *
 * Returns  value   false: none is needed; the march nearest to the target is the response
 *          work    counts how the search ended
 */
static bool search_stage(struct pound_request *request, const struct ask *ask, struct body_ask *body, int i,
                         int stage, struct pound_work *work)
{
	const struct pound_law *law = pound_scene_law(&ask->scene, i);
	const struct pound_task_result *before = &request->results[body->march];
	if (body->found)
		return false;
	body->status = body->status ? body->status : before->status;
	body->found = true;
	body->finished = body->wanted;
	if (body->status || !(body->yield > 0))
		return false; // there is no demand
	const double share = before->displacement_max[0] / body->yield / law->target_demand;
	double next;
	bool more = pound_demand_next(&body->demand, body->march, body->yield, share, &next);
	if (more && stage <= 1 + law->corrections) {
		body->found = body->finished = false;
		body->yield = next;
		body->march = body_march(request, ask, i, law->type, yield_marched(request, ask, next));
		return true;
	}
	body->march = body->demand.response;
	body->yield = body->demand.yield;
	bool reached = pound_demand_reached(&body->demand);
	work->yield_searches++;
	work->yield_jumps += !reached && !more;
	work->yield_missed += !reached && more;
	return false;
}

/* Requests a body's march of a stage: stage 0 is linear, stage k >= 1 uses the yield displacement found so far.
 *
 * Returns  value   false: none is needed
 *          work    counts skipped marches
 */
static bool body_stage(struct pound_request *request, const struct ask *ask, struct body_ask *body, int i,
                       int stage, struct pound_work *work)
{
	const struct pound_law *law = pound_scene_law(&ask->scene, i);
	bool linear = pound_law_linear(law->type);
	bool given = law->yield_displacement > 0;
	int last_stage = linear ? 0 : given ? 1 : 1 + law->corrections;
	if (stage > 1 && searched(law))
		return search_stage(request, ask, body, i, stage, work);
	if (stage > last_stage)
		return false;
	if (stage == 0 && !linear && given) {
		work->yield_given++;
		return false;
	}
	if (stage == 0 && linear && !body->wanted) {
		work->linear_unasked++;
		return false;
	}
	if (stage == 0)
		body->march = body_march(request, ask, i, 0, 0);
	else {
		const struct pound_task_result *before = given ? NULL : &request->results[body->march];
		if (given) {
			body->yield =
			    fmax(ldexp(law->yield_displacement, -request->motions[ask->motion].exponent), DBL_MIN);
		} else {
			body->status = body->status ? body->status : before->status;
			body->yield =
			    before->displacement_max[0] /
			    (stage == 1 ? pound_scene_reduction(&ask->scene, ask->scene.oscillators[i].frequency_hz,
			                                        law->target_demand)
			                : law->target_demand);
		}
		if (stage == last_stage && !body->wanted) {
			work->nonlinear_unasked++;
			return false;
		}
		body->march = body_march(request, ask, i, law->type, yield_marched(request, ask, body->yield));
	}
	body->finished = stage == last_stage;
	return true;
}

/* Sets which responses without pounding a sample needs. */
static void ask_free(const struct pound_cells *campaign, struct ask *ask)
{
	const struct pound_scene *scene = &ask->scene;
	bool response = ask->response = campaign->study->kind == POUND_KIND_RESPONSE;
	bool may_miss = !scene->contact.present || scene->contact.gap > 0;
	ask->free_pair = ask->chain = ask->chain_free = -1;
	bool right = response || may_miss || pound_outputs_asked(campaign->study) & POUND_ASKS_RIGHT;
	for (int i = 0; i < POUND_OSCILLATORS; i++) {
		bool moves = !scene->oscillators[i].rigid_wall;
		// a study of gaps needed only reads the run of both bodies together, if there is one
		const struct pound_law *law = pound_scene_law(scene, i);
		bool together =
		    !pound_study_pounds(campaign->study) && !pound_law_linear(law->type) && !searched(law);
		ask->bodies[i] = (struct body_ask){.march = -1, .wanted = moves && !together && (i == 0 || right)};
	}
}

static int stages_of(const struct ask *ask)
{
	int stages = 1;
	for (int i = 0; i < POUND_OSCILLATORS; i++) {
		const struct pound_law *law = pound_scene_law(&ask->scene, i);
		stages = (int)fmax(stages,
		                   2 + law->corrections + (searched(law) ? 1 : 0)); // one to evaluate the last march
	}
	return stages;
}

static double free_max(const struct pound_request *request, const struct body_ask *body)
{
	return body->finished ? request->results[body->march].displacement_max[0] : 0;
}

struct pound_task pound_request_pair_task(const struct pound_request *request, const struct ask *ask)
{
	struct pound_task task = {0};
	for (int i = 0; i < POUND_OSCILLATORS; i++) {
		task.bodies[i] = pound_scene_body(&ask->scene, i);
		task.bodies[i].followed = ask->bodies[i].wanted;
		double yield = ask->bodies[i].yield;
		bool linear = pound_law_linear(task.bodies[i].backbone.law);
		task.bodies[i].backbone.yield = linear ? 0 : yield_marched(request, ask, yield);
		if (linear)
			task.bodies[i].backbone.hardening = 0;
	}
	if (!ask->scene.contact.present)
		return task;
	pound_scene_contact(&ask->scene, &task);
	task.gap = ldexp(task.gap, -request->motions[ask->motion].exponent);
	if (task.gap < negligible(request, ask))
		task.gap = 0;
	return task;
}

/* Requests the run with pounding, unless the responses without pounding are final. */
static void ask_pounding(struct pound_request *request, struct ask *ask, struct pound_work *work)
{
	ask->march = -1;
	if (!ask->scene.contact.present || !pound_study_pounds(request->campaign->study))
		return;
	if (pound_scene_alike(&ask->scene)) {
		work->moving_alike++;
		return;
	}
	struct pound_task task = pound_request_pair_task(request, ask);
	task.accounted = ask->balanced;
	if (task.gap > 0 && free_max(request, &ask->bodies[0]) + free_max(request, &ask->bodies[1]) < task.gap) {
		work->never_touching++;
		return;
	}
	ask->march = march_ask(request, ask->motion, &task);
}

/* Follows both bodies without contact, or requests a march, if an output reads their closing displacement.
 *
 * Returns  value   false: a march was requested
 */
static bool follow_free_pair(struct pound_request *request, int a)
{
	struct ask *ask = &request->asks[a];
	const struct pound_motion *m = &request->motions[ask->motion];
	const struct pound_task pair = pound_request_pair_task(request, ask);
	struct pound_task task = {.bodies = {pair.bodies[0], pair.bodies[1]},
	                          .ground = m->ground,
	                          .n_samples = m->n_samples,
	                          .time_step = m->time_step};
	if (pound_pairs_add(&request->pairs, &task, request->free_pair[a]))
		return true;
	for (int i = 0; i < POUND_OSCILLATORS; i++)
		task.bodies[i].followed |= !ask->bodies[i].finished && !ask->scene.oscillators[i].rigid_wall;
	// a body beside a wall without contact is not the run of the body alone, which has no observer
	const int known = request->march_keys.n;
	task.observer = &request->peaks[known].observer;
	ask->free_pair = march_ask(request, ask->motion, &task);
	if (ask->free_pair == known)
		pound_pair_peaks_start(&request->peaks[known], &request->tasks[known]);
	return false;
}

/* Requests both bodies as one-story buildings, if an output reads their quantities. */
static void follow_chain(struct pound_request *request, struct ask *ask)
{
	const unsigned asks = pound_outputs_asked(request->campaign->study);
	const struct pound_motion *m = &request->motions[ask->motion];
	const unsigned asked = (asks & POUND_ASKS_ACCELERATIONS ? POUND_CHAIN_ACCELERATIONS : 0) |
	                       (asks & POUND_ASKS_FORCES ? POUND_CHAIN_FORCES : 0) |
	                       (asks & POUND_ASKS_ENERGIES ? POUND_CHAIN_ENERGY : 0);
	struct pound_task pair = pound_request_pair_task(request, ask);
	pair.contact = ask->march >= 0;
	ask->chain = pound_row_ask_pair(&request->rows, &pair, m, asked);
	ask->chain_free = ask->chain;
	if (!pair.contact || !(asks & POUND_ASKS_FREE_FLOORS))
		return;
	pair.contact = false;
	ask->chain_free = pound_row_ask_pair(&request->rows, &pair, m, POUND_CHAIN_ACCELERATIONS);
}

static const struct pound_chain_result *chain_result(const struct pound_request *request, int march)
{
	return march < 0 ? NULL : &request->rows.results[march];
}

/* The runs of an ask. */
static struct pound_runs_known ask_known(const struct pound_request *request, const struct ask *ask)
{
	struct pound_runs_known known = {.scene = &ask->scene,
	                                 .exponent = request->motions[ask->motion].exponent,
	                                 .pounding = ask->march < 0 ? NULL : &request->results[ask->march]};
	for (int i = 0; i < POUND_OSCILLATORS; i++) {
		const struct body_ask *body = &ask->bodies[i];
		known.bodies[i] =
		    (struct pound_body_known){.free = body->finished ? &request->results[body->march] : NULL,
		                              .yield = body->yield,
		                              .status = body->status};
	}
	if (ask->free_pair >= 0)
		known.free_pair = &request->results[ask->free_pair];
	known.peaks_free = !request->peaks       ? NULL
	                   : ask->free_pair >= 0 ? request->peaks[ask->free_pair].peak
	                                         : request->free_pair[ask - request->asks];
	known.chain = chain_result(request, ask->chain);
	known.chain_free = chain_result(request, ask->chain_free);
	return known;
}

/* ---- rows of buildings ---- */

struct pound_scene pound_request_row_scene(const struct pound_request *request, const struct ask *ask)
{
	return pound_cells_scene(request->campaign, ask->cell, ask->row, ask->sample, request->rows.memory);
}

static void row_free(struct pound_request *request, int a)
{
	const struct pound_study *study = request->campaign->study;
	const struct pound_scene scene = pound_request_row_scene(request, &request->asks[a]);
	pound_row_ask_free(&request->rows, &scene, &request->row_asks[a],
	                   study->kind == POUND_KIND_RESPONSE || study->spectrum.n > 0 ||
	                       pound_outputs_asked(study) & POUND_ASKS_FREE_PAIR,
	                   pound_row_asked(study) | (request->asks[a].balanced ? POUND_CHAIN_ENERGY : 0));
	// a study of gaps needed only reads the run of all buildings together
	for (int b = 0; b < scene.n_buildings && !pound_study_pounds(study); b++)
		request->row_asks[a].buildings[b].wanted = false;
}

/* Marches registered so far, of both kinds. */
static int marches_known(const struct pound_request *request)
{
	return request->march_keys.n + request->rows.n;
}

/* The response of an ask. */
static struct pound_outcome ask_outcome(const struct pound_request *request, int a, struct pound_scene *scene,
                                        struct pound_response *pair, struct pound_row_response *row)
{
	const struct ask *ask = &request->asks[a];
	struct pound_outcome outcome = {.scene = scene, .pair = pair, .row = row};
	if (ask->scene.n_buildings) {
		*scene = pound_request_row_scene(request, ask);
		outcome.status = pound_row_response_of(&request->rows, scene, &request->row_asks[a],
		                                       request->motions[ask->motion].exponent, row);
	} else {
		const struct pound_runs_known known = ask_known(request, ask);
		*scene = ask->scene;
		outcome.status = pound_response_of(&known, pair);
	}
	return outcome;
}

/* ---- the block ---- */

/* Enters the samples of one item from ask `a` on; returns the next free ask. */
static int item_write(struct pound_request *request, const struct pound_cells *campaign, int a, int item,
                      bool halved)
{
	int row = item / campaign->n_signals, signal = item % campaign->n_signals;
	for (int cell = 0; cell < campaign->n_cells; cell++)
		for (int sample = 0; sample < campaign->n_samples; sample++) {
			struct ask *ask = &request->asks[a++];
			ask->scene = pound_cells_scene(campaign, cell, row, sample, NULL);
			ask->cell = cell, ask->row = row, ask->sample = sample;
			ask->balanced = campaign->study->kind == POUND_KIND_RESPONSE && !campaign->study->unbalanced &&
			                signal < POUND_BALANCED_SIGNALS;
			const struct pound_place place = {cell, row, sample, signal};
			const struct pound_excitation excitation = pound_cells_excitation(campaign, &ask->scene, &place);
			ask->motion =
			    motion_ask(request, &excitation, pound_cells_noise(campaign, row, sample, signal), halved);
			if (ask->scene.n_buildings)
				row_free(request, a - 1);
			else
				ask_free(campaign, ask);
		}
	return a;
}

/* Requests the marches of a stage without pounding for asks [first, end); false: none in this stage or later. */
static bool stage_ask(struct pound_request *request, int first, int end, int stage,
                      struct pound_stage_work *counted, struct pound_work *work)
{
	int before = marches_known(request);
	int64_t asked = 0;
	for (int a = first; a < end; a++) {
		struct ask *ask = &request->asks[a];
		if (ask->scene.n_buildings) {
			const struct pound_scene scene = pound_request_row_scene(request, ask);
			asked += pound_row_stage(&request->rows, &scene, &request->row_asks[a],
			                         &request->motions[ask->motion], stage, work);
			continue;
		}
		for (int i = 0; i < POUND_OSCILLATORS; i++)
			if (!ask->scene.oscillators[i].rigid_wall)
				asked += body_stage(request, ask, &ask->bodies[i], i, stage, work);
	}
	counted->asked += asked;
	counted->run += marches_known(request) - before;
	return asked > 0 || stage == 0; // with a given yield displacement stage 0 is skipped
}

/* Requests the runs with pounding of asks [first, end). */
static void pounding_ask(struct pound_request *request, int first, int end, struct pound_stage_work *counted,
                         struct pound_work *work)
{
	int before = marches_known(request);
	const bool pounds = pound_study_pounds(request->campaign->study);
	for (int a = first; a < end; a++) {
		struct ask *ask = &request->asks[a];
		if (ask->scene.n_buildings && pounds) {
			const struct pound_scene scene = pound_request_row_scene(request, ask);
			pound_row_ask_pounding(&request->rows, &scene, &request->row_asks[a],
			                       &request->motions[ask->motion], work);
		} else if (!ask->scene.n_buildings)
			ask_pounding(request, ask, work);
	}
	counted->asked += end - first;
	counted->run += marches_known(request) - before;
}

/* Runs items [first, first + n) of a campaign, and their checks.
 *
 * Given    stop      checked throughout
 * Returns  take      called for every item, cell and sample in this order, then for the checks
 *          work      work requested and done is added
 * Status   POUND_STOPPED  stop was set; take was not called
 *          POUND_NOMEM    no memory for a run; take was not called
 */
enum pound_status pound_request_run(struct pound_request *request, struct pound_items items,
                                    const atomic_bool *stop, struct pound_work *work,
                                    pound_request_take *take, void *into)
{
	const struct pound_cells *campaign = items.campaign;
	const int first = items.first, n = items.n;
	int n_items = n * campaign->n_cells * campaign->n_samples, n_asks = 0;
	const struct pound_solver solver = pound_cells_solver(campaign, first / campaign->n_signals);
	request->campaign = campaign;
	pound_row_clear(&request->rows);
	pound_keys_clear(&request->motion_keys);
	pound_keys_clear(&request->march_keys);
	for (int item = first; item < first + n; item++)
		n_asks = item_write(request, campaign, n_asks, item, false);
	work->signals.asked += n_asks;
	work->signals.run += request->motion_keys.n;
	for (int k = pound_cells_checks(campaign, first); k < pound_cells_checks(campaign, first + n); k++)
		n_asks = item_write(request, campaign, n_asks, k * campaign->check_every, true);
	assert(n_asks <= request->size.asks);
	request->n_asks = n_asks;
	request->n_items = n_items;
	pound_motions_fill(request->motions, request->motion_keys.n, forces_scale(request), request->ground,
	                   request->size.samples);

	struct pound_work of_checks = {0}; // skipped work of checks is not reported
	int done = 0, stages = 1;
	for (int a = 0; a < n_asks; a++) {
		const struct ask *ask = &request->asks[a];
		stages = (int)fmax(stages, ask->scene.n_buildings ? pound_row_stages(&ask->scene) : stages_of(ask));
	}
	enum pound_status status = POUND_OK;
	bool more = true;
	for (int stage = 0; stage < stages && more && !status; stage++) {
		// the checks, which take longer, start first, so that no lane idles at the end
		more = stage_ask(request, n_items, n_asks, stage, &work->checks, &of_checks);
		int checks_end = request->march_keys.n, row_checks_end = request->rows.n;
		more |=
		    stage_ask(request, 0, n_items, stage, stage == 0 ? &work->free_runs : &work->yield_runs, work);
		status = marches_run(request, &solver, checks_end, &done, stop);
		status = status ? status : pound_row_run(&request->rows, &solver, row_checks_end, stop);
	}
	const unsigned asked = pound_outputs_asked(campaign->study);
	request->pairs.n = 0;
	for (int a = n_asks - 1; a >= 0 && !status && asked & POUND_ASKS_FREE_PAIR; a--) { // the checks first
		if (pound_stopped(stop))
			return POUND_STOPPED;
		const struct ask *ask = &request->asks[a];
		const struct pound_scene scene = pound_request_row_scene(request, ask);
		const int known = marches_known(request);
		if (scene.n_buildings)
			pound_row_ask_closing(&request->rows, &scene, &request->row_asks[a],
			                      &request->motions[ask->motion]);
		else
			work->free_pair_runs.run += follow_free_pair(request, a);
		work->free_pair_runs.run += marches_known(request) - known;
		work->free_pair_runs.asked++;
	}
	pound_pairs_finish(&request->pairs);
	status = status ? status : marches_run(request, &solver, request->march_keys.n, &done, stop);
	status = status ? status : pound_row_run(&request->rows, &solver, request->rows.n, stop);
	if (status)
		return status;
	pounding_ask(request, n_items, n_asks, &work->checks, &of_checks);
	int before = request->n_before = request->march_keys.n;
	int rows_before = request->n_rows_before = request->rows.n;
	pounding_ask(request, 0, n_items, &work->pounding_runs, work);
	status = marches_run(request, &solver, before, &done, stop);
	status = status ? status : pound_row_run(&request->rows, &solver, rows_before, stop);
	if (status)
		return status;
	for (int j = before; j < done; j++)
		work->contacts += request->results[j].contacts;
	work->contacts += pound_row_contacts_run(&request->rows, rows_before);
	for (int a = 0; a < n_asks && asked & POUND_ASKS_CHAIN; a++) {
		const int known = request->rows.n;
		if (request->asks[a].scene.n_buildings)
			continue;
		follow_chain(request, &request->asks[a]);
		work->chain_runs.run += request->rows.n - known;
		work->chain_runs.asked += 1 + (request->asks[a].chain_free != request->asks[a].chain);
	}
	// by the exact solver, as the pairs
	status = pound_row_run(&request->rows, &solver, request->rows.n, stop);
	if (status)
		return status;
	for (int a = 0; a < n_asks; a++) {
		struct pound_scene scene;
		struct pound_response pair;
		struct pound_row_response row;
		const struct pound_outcome outcome = ask_outcome(request, a, &scene, &pair, &row);
		assert(!outcome.status || outcome.status <= POUND_CHATTER);
		if (outcome.status && a < n_items)
			work->failed[POUND_CHATTER - outcome.status]++;
		take(into, &outcome);
	}
	return POUND_OK;
}
