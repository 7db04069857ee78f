/* result_separation.c - writes gaps needed, probabilities of pounding and fragility curves as JSON. */
#include "schema/result/result_separation.h"

#include <math.h>

#include "schema/result/result_json.h"
#include "schema/study/study_json.h"

/* Writes a value and the ends of its interval. */
static void write_interval(struct writer *w, const char *names[3], const struct pound_estimate *estimate)
{
	writer_number(w, names[0], estimate->value);
	writer_number(w, names[1], estimate->low);
	writer_number(w, names[2], estimate->high);
}

static const char *probability_names[] = {"probability", "low", "high"},
                  *gap_names[] = {"gap_m", "low_m", "high_m"};

static void write_rules(struct writer *w, const struct pound_needs *needs)
{
	writer_array(w, "rules", WRITER_LINES);
	for (int k = 0; k < POUND_RULES; k++) {
		const struct pound_rule *rule = &needs->rules[k];
		writer_object(w, NULL, WRITER_LINE);
		writer_text(w, "name", pound_rule_name(k));
		writer_text(w, "what", pound_rule_text(k));
		writer_number(w, "gap_m", rule->gap);
		writer_number(w, "over_mean", rule->over);
		write_interval(w, probability_names, &rule->probability);
		writer_end(w);
	}
	writer_end(w);
}

/* Writes the position of a contact in a row. */
static void write_place(struct writer *w, const struct pound_scene *scene, int contact)
{
	struct pound_row_contact of;
	pound_row_contact_of(scene, contact, &of);
	writer_whole(w, "contact", contact);
	writer_whole(w, "left_building", of.left_building);
	writer_array(w, "levels", WRITER_LINE);
	for (int side = 0; side < 2; side++)
		writer_number(w, NULL, of.levels[side]);
	writer_end(w);
}

static void write_needs(struct writer *w, const struct pound_study *study, const struct pound_result *result,
                        int cell, int contact)
{
	const struct pound_separation_result *separation = &result->separation;
	const struct pound_needs *needs = &separation->needs[cell * pound_study_gaps(study) + contact];
	writer_object(w, "gap_needed", WRITER_LINES);
	writer_whole(w, "runs", needs->runs);
	writer_whole(w, "independent", needs->clusters);
	writer_number(w, "mean_m", needs->mean);
	writer_number(w, "standard_deviation_m", needs->deviation);
	writer_number(w, "largest_m", needs->largest);
	if (!pound_study_sampled(study)) {
		writer_array(w, "signals_m", WRITER_LINE);
		for (int k = 0; k < result->cells[cell].n_signals; k++)
			writer_number(w, NULL, needs->needed[k]);
		writer_end(w);
	}
	writer_end(w);
	writer_array(w, "pounding", WRITER_LINES);
	for (int g = 0; g < separation->n_gaps; g++) {
		writer_object(w, NULL, WRITER_LINE);
		writer_number(w, "gap_m", separation->gaps[g]);
		write_interval(w, probability_names, &needs->probability[g]);
		writer_end(w);
	}
	writer_end(w);
	writer_array(w, "gaps", WRITER_LINES);
	for (int k = 0; k < study->separation.n_probabilities; k++) {
		writer_object(w, NULL, WRITER_LINE);
		writer_number(w, "probability", study->separation.probabilities[k]);
		write_interval(w, gap_names, &needs->gap[k]);
		if (needs->runs > 0 && isnan(needs->gap[k].high))
			writer_text(w, "note", "too few runs for an upper limit");
		writer_end(w);
	}
	writer_end(w);
	writer_number(w, "displacement_left_m", needs->displacement[0]);
	writer_number(w, "displacement_right_m", needs->displacement[1]);
	writer_number(w, "correlation", needs->correlation);
	write_rules(w, needs);
}

/* Test     unit_separation_result: the_result_is_what_brute_force_counts, each_gap_of_a_row_is_that_of_its_pair */
void result_separation_cell(struct writer *w, const struct pound_study *study,
                            const struct pound_scene *scene, const struct pound_result *result, int cell)
{
	if (!study->scene.n_buildings) {
		write_needs(w, study, result, cell, 0);
		return;
	}
	writer_array(w, "contacts", WRITER_LINES);
	for (int k = 0; k < pound_study_gaps(study); k++) {
		writer_object(w, NULL, WRITER_LINES);
		write_place(w, scene, k);
		write_needs(w, study, result, cell, k);
		writer_end(w);
	}
	writer_end(w);
}

static void write_curve(struct writer *w, const struct pound_study *study,
                        const struct pound_fragility *curve, double gap)
{
	writer_object(w, NULL, WRITER_LINE);
	writer_number(w, "gap_m", gap);
	result_estimate(w, "median", &curve->median);
	result_estimate(w, "dispersion", &curve->dispersion);
	if (study->separation.n_intensities)
		result_estimate(w, "annual_rate", &curve->rate);
	if (isnan(curve->median.value))
		writer_text(w, "note",
		            "no curve: needs pounding at a weaker intensity than some run without pounding");
	writer_end(w);
}

static void write_hazard(struct writer *w, const struct pound_study *study,
                         const struct pound_stripe_set *set)
{
	const struct pound_separation *asked = &study->separation;
	writer_number(w, "annual_rate_beyond", set->beyond);
	writer_array(w, "return_periods", WRITER_LINES);
	for (int k = 0; k < asked->n_periods; k++) {
		writer_object(w, NULL, WRITER_LINE);
		writer_number(w, "return_period_years", asked->periods[k]);
		write_interval(w, gap_names, &set->return_gap[k]);
		if (isnan(set->return_gap[k].value))
			writer_text(w, "note",
			            "motions above the largest swept intensity are more frequent than this: add higher "
			            "intensities");
		writer_end(w);
	}
	writer_end(w);
}

void result_separation_fragility(struct writer *w, const struct pound_study *study,
                                 const struct pound_result *result)
{
	const struct pound_separation_result *separation = &result->separation;
	if (study->separation.stripes < 0)
		return;
	writer_array(w, "fragility", WRITER_LINES);
	for (int k = 0; k < separation->n_sets; k++) {
		const struct pound_stripe_set *set = &separation->sets[k];
		writer_object(w, NULL, WRITER_LINES);
		if (study->scene.n_buildings)
			writer_whole(w, "contact", set->contact);
		writer_text(w, "intensity", study->separation.intensity);
		writer_object(w, "sweep", WRITER_LINE);
		for (int s = 0; s < study->n_sweeps; s++)
			if (s != study->separation.stripes)
				study_value(w, study->sweeps[s].path, study->sweeps[s].path,
				            result->cells[set->cell].sweep[s]);
		writer_end(w);
		writer_array(w, "curves", WRITER_LINES);
		for (int g = 0; g < separation->n_gaps; g++)
			write_curve(w, study, &set->curves[g], separation->gaps[g]);
		writer_end(w);
		if (study->separation.n_intensities)
			write_hazard(w, study, set);
		writer_end(w);
	}
	writer_end(w);
}
