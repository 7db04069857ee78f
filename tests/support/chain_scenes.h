/* chain_scenes.h - rows of shear buildings as chains, for tests of the engine without documents.
 *
 * SI units.  A row owns the data that its task points to, so it must not be moved. */
#ifndef CHAIN_SCENES_H
#define CHAIN_SCENES_H

#include "engine/exact/chain.h"
#include "engine/scene/modes.h"

enum { ROW_BUILDINGS = 8, ROW_FLOORS = 100, ROW_LINKS = 120, ROW_SAMPLES = 2401 };

enum row_damping { ROW_RAYLEIGH, ROW_STIFFNESS, ROW_STORY, ROW_MODAL };

struct row_building {
	int stories;
	double mass[POUND_STORIES], stiffness[POUND_STORIES];
	double frequency_hz; /* > 0: `stiffness` is a profile */
	enum row_damping damping;
	double damping_ratio;
	struct pound_backbone law; /* law, hardening and yield drift of every story */
};

struct row_contact {
	int left;         /* building */
	double levels[2]; /* right: 0 of a wall */
};

struct row {
	struct row_building buildings[ROW_BUILDINGS];
	int n_buildings;
	bool wall; /* behind the last building */
	struct row_contact contacts[ROW_LINKS];
	int n_contacts; /* 0: floors i with i, in every gap */
	struct pound_contact contact;
	double ground[ROW_SAMPLES];
	// made by row_task
	struct pound_chain_floor floors[ROW_FLOORS];
	struct pound_link links[ROW_LINKS];
	double modal[ROW_BUILDINGS][POUND_STORIES * POUND_STORIES];
	int first[ROW_BUILDINGS]; /* floor of a building */
	// room for a result
	double floor_measures[ROW_FLOORS][POUND_FLOOR_MEASURES], link_measures[ROW_LINKS][POUND_LINK_MEASURES];
};

/* A building of equal stories, rayleigh damping of 5 %, linear. */
struct row_building row_building(int stories, double mass, double stiffness);

/* An empty row: contact of the paper with K = 100 and restitution 0.6. */
void row_init(struct row *row);

/* Samples 0.01 s apart of peak sin(2 pi f t), from 0 to duration. */
int row_harmonic(struct row *row, double frequency_hz, double duration, double peak);

struct pound_chain_task row_task(struct row *row, int n_samples, double time_step, unsigned asked);

/* Runs it at a lane count (0: the widest); measures into the row. */
struct pound_chain_result row_run(struct row *row, const struct pound_chain_task *task, int lanes);

#endif
