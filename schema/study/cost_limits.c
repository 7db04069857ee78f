/* cost_limits.c - compares the cost of a study with the limits of a server, and writes it as JSON. */
#include <math.h>

#include "schema/json/json_writer.h"
#include "schema/study/cost.h"
#include "schema/study/study_json.h"
#include "schema/study/warnings.h"

enum { MIB = 1 << 20 };

/* Whether a study is within the limits of a server.
 *
 * Given    most       limits of the server
 * Returns  problems   one for every limit that the study exceeds
 * Test     service_submit: a_study_over_a_limit_is_refused_with_the_limit_and_what_was_asked
 */
bool cost_allowed(const struct cost *cost, const struct cost *most, struct problems *problems)
{
	const struct {
		double asked, most;
		const char *what, *option;
	} limits[] = {
	    {(double)cost->runs, (double)most->runs, "pounding runs", "runs-max"},
	    {cost->cpu_s, most->cpu_s, "estimated seconds of one core", "cpu-max"},
	    {cost->bytes / MIB, most->bytes / MIB, "estimated MiB in the database", "result-max"},
	    {cost->memory / MIB, most->memory / MIB, "estimated MiB of memory", "memory-max"},
	};
	problems_init(problems);
	for (size_t i = 0; i < sizeof limits / sizeof limits[0]; i++)
		if (limits[i].asked > limits[i].most)
			problems_exceed(problems, "", limits[i].asked, limits[i].most,
			                "needs %.6g %s, but this server accepts at most %.6g (--%s)", limits[i].asked,
			                limits[i].what, limits[i].most, limits[i].option);
	return problems->n == 0;
}

/* Writes the object Estimate of the OpenAPI document. */
char *cost_to_json(const struct cost *cost, const struct pound_study *study, size_t *length)
{
	struct writer w;
	char hash[STUDY_HASH_SIZE];
	if (!study_hash(study, hash))
		return NULL;
	writer_init(&w);
	writer_object(&w, NULL, WRITER_LINES);
	writer_text(&w, "kind", study_kind_name(study->kind));
	writer_text(&w, "study_hash", hash);
	writer_whole(&w, "runs_total", cost->runs);
	writer_number(&w, "estimated_cpu_s", cost->cpu_s);
	writer_number(&w, "estimated_cpu_s_high", cost->cpu_s_high);
	writer_number(&w, "estimated_bytes", ceil(cost->bytes));
	writer_number(&w, "estimated_memory_bytes", ceil(cost->memory));
	warnings_write(&w, study, NULL);
	writer_end(&w);
	return writer_take(&w, length);
}
