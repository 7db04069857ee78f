/* motion_reply.c - the ground motions of a study and their response spectra, computed again for each request.
 *
 * They may differ between versions, so a run of another version is not opened. */
#include "server/motion_reply.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "schema/result/motion_spectrum.h"
#include "schema/result/result_json.h"

enum { SAMPLES_MAX = 1000000 /* of an answer with all signals; one signal may have any number */ };

/* An integer query parameter; -1: absent. */
static int whole(const struct request *request, const char *name)
{
	const char *value = http_argument(request, name);
	return value ? atoi(value) : -1;
}

static struct reply problem(enum api_fault fault, const char *detail)
{
	return http_problem(fault, detail, NULL);
}

/* Test     service_records: a_long_record_is_stored_and_its_motions_are_given_back */
struct reply motions_of(const struct request *request, const struct stored_run *opened)
{
	static const struct format formats[] = {{"csv", "text/csv"}, {"npy", "application/octet-stream"}};
	const char *list = http_argument(request, "periods"), *format = http_argument(request, "format");
	const bool peer = format && !strcmp(format, "at2"), npy = http_asks_second(request, formats, NULL);
	const struct pound_place place = {
	    .cell = whole(request, "cell"), .row = whole(request, "row") - 1, .signal = whole(request, "signal")};
	struct periods periods;
	struct motion_choice choice;
	struct reply reply = {.status = 200,
	                      .type = list   ? formats[0].type
	                              : peer ? "text/plain"
	                                     : formats[npy].type};
	char why[100];
	snprintf(why, sizeof why, "periods must be %s", motion_spectrum_expected);
	if (!motion_spectrum_periods(list, &periods))
		return problem(API_BAD_REQUEST, why);
	if (list && format && strcmp(format, "csv") != 0)
		return problem(API_BAD_REQUEST, "response spectra are CSV: format must be csv or absent");
	if (opened->study->elsewhere)
		return problem(API_CONFLICT, "a study without scene has no ground motions");
	if (!motions_choose(opened->study, opened->run, place, &choice, why))
		return problem(API_CONFLICT, why);
	if (!peer && !choice.one && motions_samples(opened->run, &choice) > SAMPLES_MAX)
		return problem(API_CONFLICT,
		               "the signals have more than 1000000 samples in all: select one with ?signal=");
	snprintf(reply.etag, sizeof reply.etag, "\"%s-%s\"",
	         list   ? "spectra"
	         : peer ? "at2"
	                : formats[npy].name,
	         POUND_VERSION);
	if (http_known(request, reply.etag))
		return reply;
	reply.body = list   ? motions_to_spectra(opened->run, &choice, &periods, &reply.length)
	             : peer ? motions_to_peer(opened->run, &choice, &reply.length)
	                    : (npy ? motions_to_npy : motions_to_csv)(opened->run, &choice, &reply.length);
	return reply.body ? reply : problem(API_UNAVAILABLE, "out of memory");
}
