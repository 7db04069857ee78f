/* study_split.c - studies whose number of signals the engine chooses: required members and size.
 *
 * After reading, the study has the least number of signals that a pilot may choose, and so the most rows.  Every choice has the same
 * number of runs, so counts and estimates of this study hold for all choices. */
#include "schema/study/study_split.h"

#include "schema/study/study_check.h"

static const char signals[] = "/scene/excitation/signals";
static const char runs[] = "/design/runs";

/* Reads "auto", and checks that /design/runs, /design/rows and /design/until are given only where they are used.
 *
 * Test     unit_study_cases
 */
void reader_split(struct reader *r, const cJSON *document)
{
	struct pound_study *study = r->study;
	const cJSON *design = cJSON_GetObjectItemCaseSensitive(document, "design");
	const bool grows = cJSON_HasObjectItem(design, "until");
	const bool asked = study->scene.excitation.signals == 0 && !problems_at(r->problems, signals);
	if (study->scene.excitation.signals == 0)
		study->scene.excitation.signals = POUND_SPLIT_LEAST;
	if (cJSON_HasObjectItem(design, "runs") && !asked && !problems_at(r->problems, runs) &&
	    !problems_at(r->problems, signals))
		problems_add(r->problems, runs, "is used with \"signals\": \"auto\" only");
	if (!asked || !r->kind)
		return;
	if (study->kind != POUND_KIND_SENSITIVITY || r->designed) {
		problems_add(r->problems, signals,
		             "must be a number here: only runs of kind \"sensitivity\" choose the number of signals");
		return;
	}
	study->design.split = true;
	if (problems_at(r->problems, "/design"))
		return;
	if (grows && cJSON_HasObjectItem(design, "runs"))
		problems_add(r->problems, runs, "is not used with \"until\", whose max_runs is the limit");
	if (!grows && !cJSON_HasObjectItem(design, "runs"))
		problems_add(r->problems, runs,
		             "is required with \"signals\": \"auto\": how many pounding runs to spend; or \"until\"");
	if (!grows && cJSON_HasObjectItem(design, "rows"))
		problems_add(r->problems, "/design/rows",
		             "is not used with \"signals\": \"auto\": rows follow from \"runs\"");
}

/* Test     unit_study_cases */
void study_split_lay(struct pound_study *study, struct problems *problems)
{
	if (!study->design.split || problems_at(problems, "/design") || problems_at(problems, "/inputs") ||
	    problems_at(problems, "/sweep"))
		return;
	struct pound_study least;
	const bool grows = study->design.until.half_width > 0;
	pound_study_split(study, POUND_SPLIT_LEAST, &least);
	const int rows = grows ? pound_design_rows_least(&least) : POUND_SPLIT_PILOT_LEAST;
	const long long pilot = pound_study_pilot_runs(study),
	                least_runs = pilot + rows * (long long)pound_design_row_runs(&least);
	if (!grows)
		study->design.rows = least.design.rows < rows ? rows : least.design.rows;
	if ((grows ? pound_design_rows(&least, 0) : least.design.rows) < rows)
		problems_add(problems, grows ? "/design/until/max_runs" : runs,
		             "must be at least %lld: %lld of a pilot, and %d rows with %d signals", least_runs, pilot,
		             rows, POUND_SPLIT_LEAST);
}
