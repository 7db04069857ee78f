/* study_status.h - status and progress of a study, from the store, as JSON for clients. */
#ifndef STUDY_STATUS_H
#define STUDY_STATUS_H

#include <stdint.h>

#include "schema/json/json_writer.h"

/* The caller owns the strings. */
struct study_status {
	int64_t id;
	const char *status, *kind, *name;         /* name: NULL if none */
	const char *created, *started, *finished; /* RFC 3339 UTC, NULL: not yet */
	const char *error;                        /* NULL unless failed */
	int64_t runs, runs_done;
	double cpu_s, cpu_s_estimated; /* used so far; estimated at submission, 0: not known [s] */
	int64_t queue_position;        /* 1: next to run; 0: not queued */
	double cpu_s_before;           /* estimated remaining CPU time of the studies before it [s] */
};

/* whether it has taken at least three times the estimated CPU time */
bool study_status_over(double cpu_s, double cpu_s_estimated);
double study_status_eta(const struct study_status *study, int n_workers); /* time left [s], NAN: unknown */
void study_status_write(struct writer *writer, const struct study_status *study, int n_workers);

#endif
