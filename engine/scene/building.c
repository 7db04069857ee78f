/* building.c - a shear building as masses, springs and dashpots of its storeys.
 *
 * Adding a damping form: its function and its row in forms[]. */
#include "engine/scene/building.h"

#include <math.h>
#include <stddef.h>

#include "engine/scene/modes.h"

static const double PI = 3.14159265358979323846;

/* Rayleigh damping: ratio xi in two modes, somewhat less in modes between them.
 *
 *   c_i = 2 xi k_i/(wp + wq)     a0 = 2 xi wp wq/(wp + wq)     one storey: as by_stiffness
 *
 * Source   Chopra 2017, Dynamics of Structures, Eq. (11.4.11)
 */
static void rayleigh(const struct pound_building *building, const double *w, struct pound_storeys *s)
{
	const int n = s->n, *modes = building->damping_modes;
	const double p = w[(modes[0] < n ? modes[0] : n) - 1], q = w[(modes[1] < n ? modes[1] : n) - 1];
	const double xi = pound_each_of(&building->damping_ratio, 0);
	s->mass_damping = n == 1 ? 0 : 2 * xi * p * q / (p + q);
	for (int i = 0; i < n; i++)
		s->dashpot[i] = 2 * xi * s->stiffness[i] / (n == 1 ? p : p + q);
}

/* The damping ratio in the first mode; in the others it grows in proportion to their frequency. */
static void by_stiffness(const struct pound_building *building, const double *w, struct pound_storeys *s)
{
	for (int i = 0; i < s->n; i++)
		s->dashpot[i] = 2 * pound_each_of(&building->damping_ratio, 0) * s->stiffness[i] / w[0];
}

/* Every storey has the dashpot of a single oscillator of its mass and stiffness: the paper, Figure 5. */
static void by_storey(const struct pound_building *building, const double *w, struct pound_storeys *s)
{
	(void)w;
	for (int i = 0; i < s->n; i++)
		s->dashpot[i] = 2 * pound_each_of(&building->damping_ratio, i) * sqrt(s->mass[i] * s->stiffness[i]);
}

/* The damping ratio in every mode; with one storey a dashpot does this. */
static void modal(const struct pound_building *building, const double *w, struct pound_storeys *s)
{
	if (s->n == 1)
		by_stiffness(building, w, s);
	s->modal = s->n > 1;
}

static const struct damping_form {
	const char *name;
	const char *text; /* one line of documentation */
	void (*dashpots)(const struct pound_building *building, const double *w, struct pound_storeys *s);
	bool modes; /* two modes have the damping ratio */
	bool each;  /* every storey may have a damping ratio of its own */
} forms[] = {
    {"rayleigh", "the damping ratio in two modes", rayleigh, true, false},
    {"stiffness", "proportional to the stiffness: the damping ratio in the first mode", by_stiffness, false,
     false},
    {"storey", "of every story as if it were an oscillator of its own", by_storey, false, true},
    {"modal", "the damping ratio in every mode", modal, false, false},
};

const char *pound_damping_name(int row)
{
	return row >= 0 && row < (int)(sizeof forms / sizeof forms[0]) ? forms[row].name : NULL;
}

const char *pound_damping_text(int row)
{
	return forms[row].text;
}

bool pound_damping_takes_modes(int row)
{
	return forms[row].modes;
}

bool pound_damping_takes_each(int row)
{
	return forms[row].each;
}

/* Masses, stiffnesses and damping of the storeys of a building.
 *
 * Given    building   not a rigid wall
 * Returns  storeys    (building->storeys)
 *
 * If the frequency is given, the profile is scaled: k_i = profile_i (2 pi f/w_1)^2, w_1 first frequency of the profile.
 *
 * Source   the project's design pages, buildings.md 1
 * Test     unit_building
 */
void pound_building_storeys(const struct pound_building *building, struct pound_storeys *storeys)
{
	const bool given = building->stiffness.n > 0;
	double w[POUND_STOREYS_MAX];
	*storeys = (struct pound_storeys){.n = building->storeys};
	for (int i = 0; i < storeys->n; i++) {
		storeys->mass[i] = pound_each_of(&building->mass, i);
		storeys->stiffness[i] = pound_each_of(given ? &building->stiffness : &building->profile, i);
	}
	pound_modes_frequencies(storeys->n, storeys->mass, storeys->stiffness, w);
	if (!given) {
		const double wanted = 2 * PI * building->frequency_hz, factor = wanted / w[0];
		for (int i = 0; i < storeys->n; i++) {
			storeys->stiffness[i] *= factor * factor;
			w[i] *= factor;
		}
		w[0] = wanted;
	}
	storeys->frequency = w[0];
	forms[building->damping].dashpots(building, w, storeys);
}

/* Modes of a building with its initial stiffness.
 *
 * Given    building       not a rigid wall
 * Returns  modes          frequencies, effective masses, damping ratios   (building->storeys)
 *
 *   mass_ratio = (sum m phi)^2 / (sum m phi^2 sum m)      damping_ratio = phi^T C phi / (2 w phi^T M phi)
 *
 * The damping ratio equals the document's in the modes in which the damping form prescribes it; with the form "storey" C couples
 * the modes, and it is from the diagonal term alone.
 *
 * Source   Chopra, Dynamics of Structures, 13.2.5 (effective modal mass), 14.3 and 11.4
 * Test     unit_building: modes_have_their_closed_forms
 */
void pound_building_modes(const struct pound_building *building,
                          struct pound_building_mode modes[static POUND_STOREYS_MAX])
{
	struct pound_storeys storeys;
	struct pound_modes shapes; // with sum m phi^2 = 1
	double total = 0;
	pound_building_storeys(building, &storeys);
	pound_modes_fill(storeys.n, storeys.mass, storeys.stiffness, &shapes);
	for (int i = 0; i < storeys.n; i++)
		total += storeys.mass[i];
	for (int r = 0; r < storeys.n; r++) {
		double moved = 0, damping = storeys.mass_damping, below = 0;
		for (int i = 0; i < storeys.n; i++) {
			const double drift = shapes.shape[r][i] - below;
			moved += storeys.mass[i] * shapes.shape[r][i];
			damping += storeys.dashpot[i] * drift * drift;
			below = shapes.shape[r][i];
		}
		// a given first frequency is kept without the rounding of the scaled stiffness
		const double w = r == 0 ? storeys.frequency : shapes.w[r];
		modes[r] = (struct pound_building_mode){
		    .frequency = w,
		    .mass_ratio = moved * moved / total,
		    .damping_ratio = storeys.modal ? pound_each_of(&building->damping_ratio, 0) : damping / (2 * w)};
	}
}
