/* study_status.h - how far a study is: as the store has it, and as it is reported to a client. */
#ifndef STUDY_STATUS_H
#define STUDY_STATUS_H

#include <stdint.h>

#include "schema/json/json_writer.h"

/* Texts are whose hands it over. */
struct study_status {
	int64_t id;
	const char *status, *kind, *name;         /* name: NULL if none */
	const char *created, *started, *finished; /* RFC 3339 UTC, NULL: not yet */
	const char *error;                        /* NULL unless failed */
	int64_t runs, runs_done;
	double cpu_s, cpu_s_estimated; /* taken; estimated when it was submitted, 0: not known [s] */
	int64_t queue_position;        /* 1: the next; 0: not queued */
	double cpu_s_before;           /* of the studies before it, estimated, what is left [s] */
};

/* whether it has taken three times as long as estimated */
bool study_status_over(double cpu_s, double cpu_s_estimated);
double study_status_eta(const struct study_status *study, int n_workers); /* [s] to its end, NAN: unknown */
void study_status_write(struct writer *writer, const struct study_status *study, int n_workers);

#endif
