/* fields.c - the table of all members of a study document, in the order in which people write them. */
#include "schema/study/fields.h"

#include <math.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "schema/study/field_types.h"
#include "schema/study/study_json.h"
#include "schema/study/study_suite.h"

const char *study_kind_name(int kind)
{
	static const char *const names[] = {[POUND_KIND_RESPONSE] = "response",
	                                    [POUND_KIND_SENSITIVITY] = "sensitivity",
	                                    [POUND_KIND_CONVERGENCE] = "convergence",
	                                    [POUND_KIND_FLOOR_SPECTRUM] = "floor_spectrum",
	                                    [POUND_KIND_SEPARATION] = "separation"};
	return kind >= 0 && kind < (int)(sizeof names / sizeof names[0]) ? names[kind] : NULL;
}

static const char *signals_name(int common)
{
	return common == 0 ? "independent" : common == 1 ? "common" : NULL;
}

static const char *directions_name(int both)
{
	return both == 0 ? "one" : both == 1 ? "both" : NULL;
}

static const char *goal_name(int goal)
{
#define X(name, text) text,
	static const char *const names[] = {POUND_GOALS(X) NULL};
#undef X
	return names[goal];
}

static const char *until_output_name(int row)
{
	return row == 0 ? "all" : pound_output_name(row - 1);
}

#define AT(member)      offsetof(struct pound_study, member)
#define LAW             AT(scene.law)
#define OWN             AT(scene.oscillators[0].law)
#define IN_LAW(member)  offsetof(struct pound_law, member)
#define CONTACT(member) AT(scene.contact.member)
#define SENSITIVITY     .kinds = " sensitivity separation "
#define CONVERGENCE     .kinds = " convergence "
#define SPECTRAL        .kinds = " floor_spectrum sensitivity "
#define FLOORED         .kinds = " floor_spectrum "
#define SOLVED          .kinds = " response sensitivity "
#define SWEPT           .kinds = " response sensitivity separation "
#define SEPARATION \
	.kinds = " separation ", .sceneless = FIELD_UNUSED, .fixed = "only fields of the scene can vary"
#define FILTERED            .types = " kanai_tajimi "
#define RANDOM              .types = " kanai_tajimi white_noise "
#define LASTING             .types = " white_noise harmonic "
#define PITCHED             .types = " kanai_tajimi harmonic "
#define SCALED              .types = " kanai_tajimi white_noise harmonic "
#define STEPPED             .types = " kanai_tajimi white_noise harmonic record "
#define RECORDED            .types = " suite "
#define IN_RECORD(member)   offsetof(struct suite_record, member)
#define FIXED_DATA          .fixed = "the samples of a record are fixed data"
#define WITH_SCENE          .sceneless = FIELD_UNUSED
#define LATER               .unwritten = true
#define NOT_SCENE           .fixed = "only fields of the scene can vary"
#define OWN_CONTACT(member) offsetof(struct pound_row_contact, contact.member)
#define IN_CONTACTS(member) offsetof(struct pound_row_contact, member)
#define BUILDING(member)    offsetof(struct pound_building, member)
#define IN_PLACES(member)   offsetof(struct pound_storey_place, member)

// clang-format off
#define LAW_ROWS(pattern, law)                                                                          \
	{pattern "/type", FIELD_CHOICE, law + IN_LAW(type), 0, 0, 0, FIELD_CLOSED, "",                        \
	 .text = "constitutive law: spring force over displacement", .choice = pound_law_name},                      \
	{pattern "/hardening_ratio", FIELD_REAL, law + IN_LAW(hardening_ratio), 0.05, 0, 1, FIELD_CLOSED, "", \
	 .text = "post-yield stiffness over initial stiffness"},                                                                  \
	{pattern "/target_demand", FIELD_REAL, law + IN_LAW(target_demand), 2, 1, INFINITY, FIELD_CLOSED, "", \
	 .text = "ductility demand without pounding, from which the yield displacement is found"},                    \
	{pattern "/yield_displacement_m", FIELD_REAL, law + IN_LAW(yield_displacement), 0, 0, INFINITY,       \
	 FIELD_OPEN_MIN, "m", .text = "yield displacement, instead of target_demand"},                       \
	{pattern "/corrections", FIELD_COUNT, law + IN_LAW(corrections), 1, 0, 100, FIELD_CLOSED, "",         \
	 .text = "number of corrections of the yield displacement found from target_demand; 2 or more: largest number of steps of a "  \
	         "search for exactly that demand"}

#define CONTACT_ROWS(pattern, at)                                                                        \
	{pattern "/model", FIELD_CHOICE, at(model), 0, 0, 0, FIELD_CLOSED, "",                                \
	 .text = "contact model", .choice = pound_contact_name},                                              \
	{pattern "/stiffness_ratio", FIELD_REAL, at(stiffness_ratio), 100, 0, INFINITY,                       \
	 FIELD_OPEN, "", .text = "contact stiffness K over the larger stiffness beside it"},                  \
	{pattern "/stiffness_n_m", FIELD_REAL, at(stiffness), 0, 0, INFINITY, FIELD_OPEN_MIN, "N/m",              \
	 .text = "K, instead of stiffness_ratio", LATER},                                                     \
	{pattern "/hertz_stiffness_n_m1_5", FIELD_REAL, at(hertz_stiffness), 0, 0, INFINITY, FIELD_OPEN_MIN,    \
	 "N/m^1.5", .text = "K of F = K p^1.5 (default: such that the largest overlap at reference_speed_m_s is the same as with the linear K)", LATER}, \
	{pattern "/reference_speed_m_s", FIELD_REAL, at(reference_speed), 0.1, 0, INFINITY, FIELD_OPEN, "m/s", \
	 .text = "approach speed at which K p^1.5 and K p have the same largest overlap", LATER},              \
	{pattern "/restitution", FIELD_REAL, at(restitution), 0.6, 0, 1, FIELD_CLOSED, "",                    \
	 .text = "coefficient of restitution: relative speed after over before an isolated impact"},          \
	{pattern "/calibration", FIELD_CHOICE, at(calibration), 0, 0, 0, FIELD_CLOSED, "",                    \
	 .text = "how the dashpot follows from restitution: classic: by the formula of the model's paper; exact: an isolated impact has exactly that restitution", \
	 .choice = pound_calibration_name, LATER},                                                            \
	{pattern "/gap_m", FIELD_REAL, at(gap), 0, 0, INFINITY, FIELD_CLOSED, "m",                            \
	 .text = "clear distance between the bodies at rest"},                                                \
	{pattern "/tension", FIELD_BOOL, at(tension), 1, 0, 1, FIELD_CLOSED, "",                              \
	 .text = "true: the dashpot may pull just before separation, and contact ends when the overlap is 0; false: contact ends when its force falls to 0"}, \
	{pattern "/second_stiffness_ratio", FIELD_REAL, at(second_stiffness_ratio), 0.3, 0, 1, FIELD_CLOSED, "", \
	 .text = "post-yield stiffness of the bilinear model over K", LATER},                   \
	{pattern "/yield_overlap_m", FIELD_REAL, at(yield_overlap), 0, 0, INFINITY, FIELD_OPEN_MIN, "m",         \
	 .text = "yield overlap of the bilinear model, which requires it", LATER},                               \
	{pattern "/speed_floor_m_s", FIELD_REAL, at(speed_floor), 0.001, 0, INFINITY, FIELD_OPEN, "m/s",      \
	 .text = "lower bound of v in a dashpot D p'/v; rigid: lowest approach speed of an impact that is counted as a contact", LATER}

#define SETTING_ROWS(solver, name, row, most, unit, what)                                                \
	{"/convergence/" solver, FIELD_OBJECT, 0, 0, 0, 0, FIELD_CLOSED, "",                                  \
	 .text = "settings of solver " solver, CONVERGENCE, NOT_SCENE},                                              \
	{"/convergence/" solver "/" name, FIELD_LIST, AT(convergence.settings[row]), 0, 0, POUND_SETTINGS_MAX, \
	 FIELD_CLOSED, "", .text = what " to compare, in descending order; a default list if absent, none if empty", CONVERGENCE,  \
	 NOT_SCENE},                                                                                          \
	{"/convergence/" solver "/" name "/*", FIELD_REAL, AT(convergence.settings[row].values), NAN, 0, most,  \
	 FIELD_OPEN, unit, .text = "one element of " name, CONVERGENCE, NOT_SCENE}

const struct field fields[] = {
	{"/kind", FIELD_CHOICE, AT(kind), NAN, 0, 0, FIELD_CLOSED, "",
	 .text = "kind of study", .choice = study_kind_name, .sceneless = FIELD_OPTIONAL, NOT_SCENE},
	{"/name", FIELD_TEXT, AT(name), 0, 0, 200, FIELD_CLOSED, "",
	 .text = "display name", NOT_SCENE},
	{"/scene", FIELD_OBJECT, 0, NAN, 0, 0, FIELD_CLOSED, "",
	 .text = "two oscillators or a row of buildings, the contact between them and the ground motion", .sceneless = FIELD_OPTIONAL, NOT_SCENE},

	{"/scene/law", FIELD_OBJECT, 0, 0, 0, 0, FIELD_CLOSED, "",
	 .text = "constitutive law of every oscillator that has no law of its own"},
	LAW_ROWS("/scene/law", LAW),

	{"/scene/oscillators", FIELD_LIST, 0, NAN, 2, 2, FIELD_CLOSED, "",
	 .text = "left and right oscillator; required unless buildings are given", .instead = "buildings"},
	{"/scene/oscillators/*", FIELD_OBJECT, 0, 0, 0, 0, FIELD_CLOSED, "",
	 .text = "one oscillator"},
	{"/scene/oscillators/*/mass_kg", FIELD_REAL, AT(scene.oscillators[0].mass), 1, 0, INFINITY,
	 FIELD_OPEN, "kg", .text = "mass"},
	{"/scene/oscillators/*/frequency_hz", FIELD_REAL, AT(scene.oscillators[0].frequency_hz), NAN, 0, INFINITY,
	 FIELD_OPEN, "Hz", .text = "undamped natural frequency with the initial stiffness; required unless rigid_wall"},
	{"/scene/oscillators/*/damping_ratio", FIELD_REAL, AT(scene.oscillators[0].damping_ratio), 0.05, 0, 1,
	 FIELD_OPEN_MAX, "", .text = "fraction of critical damping"},
	{"/scene/oscillators/*/rigid_wall", FIELD_BOOL, AT(scene.oscillators[0].rigid_wall), 0, 0, 1, FIELD_CLOSED, "",
	 .text = "true: the right body is a rigid wall that moves with the ground; it has no other members", .fixed = "it determines which other members apply"},
	{"/scene/oscillators/*/law", FIELD_OBJECT, 0, 0, 0, 0, FIELD_CLOSED, "",
	 .text = "law of this oscillator, instead of the scene's"},
	LAW_ROWS("/scene/oscillators/*/law", OWN),

	{"/scene/contact", FIELD_OBJECT, 0, 0, 0, 0, FIELD_CLOSED, "",
	 .text = "contact between the bodies; absent: all defaults; null: no contact, the bodies pass each other"},
	CONTACT_ROWS("/scene/contact", CONTACT),

	{"/scene/buildings", FIELD_LIST, 0, 0, 2, POUND_BUILDINGS_MAX, FIELD_CLOSED, "",
	 .text = "a row of shear buildings from left to right, instead of oscillators"},
	{"/scene/buildings/*", FIELD_OBJECT, 0, 0, 0, 0, FIELD_CLOSED, "",
	 .text = "one building"},
	{"/scene/buildings/*/storeys", FIELD_COUNT, BUILDING(storeys), 1, 1, POUND_STOREYS_MAX, FIELD_CLOSED, "",
	 .text = "number of stories, each with the floor above it"},
	{"/scene/buildings/*/mass_kg", FIELD_EACH, BUILDING(mass), 1, 0, INFINITY, FIELD_OPEN, "kg",
	 .text = "masses of the floors"},
	{"/scene/buildings/*/stiffness_n_m", FIELD_EACH, BUILDING(stiffness), NAN, 0, INFINITY, FIELD_OPEN, "N/m",
	 .text = "initial stiffness of the stories; required unless frequency_hz is given", .instead = "frequency_hz"},
	{"/scene/buildings/*/frequency_hz", FIELD_REAL, BUILDING(frequency_hz), 0, 0, INFINITY, FIELD_OPEN_MIN, "Hz",
	 .text = "undamped natural frequency of the first mode; the stiffness of the stories is scaled to give it"},
	{"/scene/buildings/*/stiffness_profile", FIELD_EACH, BUILDING(profile), 1, 0, INFINITY, FIELD_OPEN, "",
	 .text = "initial stiffness of the stories relative to each other; only with frequency_hz"},
	{"/scene/buildings/*/height_m", FIELD_EACH, BUILDING(height), 3, 0, INFINITY, FIELD_OPEN, "m",
	 .text = "heights of the stories, for drift ratios"},
	{"/scene/buildings/*/damping", FIELD_CHOICE, BUILDING(damping), 0, 0, 0, FIELD_CLOSED, "",
	 .text = "damping model, built with the initial stiffness", .choice = pound_damping_name},
	{"/scene/buildings/*/damping_ratio", FIELD_EACH, BUILDING(damping_ratio), 0.05, 0, 1,
	 FIELD_OPEN_MAX, "", .text = "fraction of critical damping; may be an array if damping is \"storey\""},
	{"/scene/buildings/*/damping_modes", FIELD_LIST, 0, 0, 2, 2, FIELD_CLOSED, "",
	 .text = "modes that have the damping ratio, ascending (default: 1, 3; at most the number of stories); only with damping rayleigh",
	 .fixed = "it is a choice of two modes"},
	{"/scene/buildings/*/damping_modes/*", FIELD_COUNT, BUILDING(damping_modes), NAN, 1, POUND_STOREYS_MAX, FIELD_CLOSED, "",
	 .text = "number of one mode, from 1", .fixed = "it is a choice of two modes"},
	{"/scene/buildings/*/rigid_wall", FIELD_BOOL, BUILDING(rigid_wall), 0, 0, 1, FIELD_CLOSED, "",
	 .text = "true: the last building is a rigid wall that moves with the ground; it has no other members", .fixed = "it determines which other members apply"},
	{"/scene/buildings/*/law", FIELD_OBJECT, 0, 0, 0, 0, FIELD_CLOSED, "",
	 .text = "law of every story of this building, instead of the scene's"},
	{"/scene/buildings/*/law/type", FIELD_CHOICE, BUILDING(law.type), 0, 0, 0, FIELD_CLOSED, "",
	 .text = "constitutive law: story shear over drift", .choice = pound_law_name, .fixed = "vary /law/type, or write two studies"},
	{"/scene/buildings/*/law/hardening_ratio", FIELD_REAL, BUILDING(law.hardening_ratio), 0.05, 0, 1, FIELD_CLOSED, "",
	 .text = "post-yield stiffness over initial stiffness"},
	{"/scene/buildings/*/law/target_demand", FIELD_REAL, BUILDING(law.target_demand), 2, 1, INFINITY, FIELD_CLOSED, "",
	 .text = "ductility demand of every story without pounding, from which its yield drift is found"},
	{"/scene/buildings/*/law/yield_displacement_m", FIELD_EACH, BUILDING(yield_drift), 0, 0, INFINITY,
	 FIELD_OPEN_MIN, "m", .text = "yield drift, instead of target_demand"},
	{"/scene/buildings/*/law/corrections", FIELD_COUNT, BUILDING(law.corrections), 1, 0, 100, FIELD_CLOSED, "",
	 .text = "number of corrections of the yield drifts found from target_demand"},

	{"/scene/contacts", FIELD_LIST, 0, 0, 1, POUND_CONTACTS_MAX, FIELD_CLOSED, "",
	 .text = "contacts between the buildings; absent: floor i with floor i, in every gap"},
	{"/scene/contacts/*", FIELD_OBJECT, 0, 0, 0, 0, FIELD_CLOSED, "",
	 .text = "one contact; an absent member has the value of /scene/contact"},
	{"/scene/contacts/*/left_building", FIELD_COUNT, IN_CONTACTS(left_building), 0, 0, POUND_BUILDINGS_MAX - 2, FIELD_CLOSED, "",
	 .text = "index of the building on its left, from 0", .fixed = "it determines which levels there are"},
	{"/scene/contacts/*/levels", FIELD_LIST, 0, NAN, 2, 2, FIELD_CLOSED, "",
	 .text = "levels of the contact on the left and the right building: 2 is floor 2, 2.6 is the column 0.6 of the way from floor 2 to floor 3; any level on a rigid wall"},
	{"/scene/contacts/*/levels/*", FIELD_REAL, IN_CONTACTS(levels[0]), NAN, 0, POUND_STOREYS_MAX, FIELD_OPEN_MIN, "",
	 .text = "one level, at most the number of stories of its building"},
	CONTACT_ROWS("/scene/contacts/*", OWN_CONTACT),

	{"/scene/excitation", FIELD_OBJECT, 0, 0, 0, 0, FIELD_CLOSED, "",
	 .text = "ground motion; absent: all defaults"},
	{"/scene/excitation/type", FIELD_CHOICE, AT(scene.excitation.type), 0, 0, 0, FIELD_CLOSED, "",
	 .text = "type of ground motion", .choice = pound_excitation_name,
	 .fixed = "it determines which other members apply"},
	{"/scene/excitation/frequency_hz", FIELD_REAL, AT(scene.excitation.frequency_hz), 2.5, 0, INFINITY,
	 FIELD_OPEN, "Hz", .text = "frequency of the filter, or of the sine (more than two samples per cycle)", PITCHED},
	{"/scene/excitation/damping_ratio", FIELD_REAL, AT(scene.excitation.damping_ratio), 0.6, 0, INFINITY,
	 FIELD_OPEN, "", .text = "damping ratio of the filter", FILTERED},
	{"/scene/excitation/high_pass_ratio", FIELD_REAL, AT(scene.excitation.high_pass_ratio), 0.1, 0, INFINITY,
	 FIELD_OPEN, "", .text = "corner frequency of the high-pass filter over filter frequency", FILTERED},
	{"/scene/excitation/cycles", FIELD_REAL, AT(scene.excitation.cycles), 20, 0, INFINITY, FIELD_OPEN, "",
	 .text = "duration times frequency_hz", FILTERED},
	{"/scene/excitation/duration_s", FIELD_REAL, AT(scene.excitation.duration), NAN, 0, INFINITY, FIELD_OPEN, "s",
	 .text = "duration, rounded to whole time steps", LASTING},
	{"/scene/excitation/rise", FIELD_REAL, AT(scene.excitation.rise), 0.15, 0, 1, FIELD_CLOSED, "",
	 .text = "fraction of the duration over which the envelope rises", RANDOM},
	{"/scene/excitation/fall", FIELD_REAL, AT(scene.excitation.fall), 0.25, 0, 1, FIELD_CLOSED, "",
	 .text = "fraction of the duration over which the envelope falls; rise + fall <= 1", RANDOM},
	{"/scene/excitation/time_step_s", FIELD_REAL, AT(scene.excitation.time_step), 0.01, 0, INFINITY,
	 FIELD_OPEN, "s", .text = "time between two samples; a ground motion may have 2 to 10000000 samples", STEPPED},
	{"/scene/excitation/peak_m_s2", FIELD_REAL, AT(scene.excitation.peak), 1, 0, INFINITY, FIELD_OPEN, "m/s2",
	 .text = "peak ground acceleration", SCALED},
	{"/scene/excitation/signals", FIELD_COUNT_OR_AUTO, AT(scene.excitation.signals), 5, 1, 100000, FIELD_CLOSED, "",
	 .text = "number of random ground motions per scene; 1: the indices describe the response to single ground motions and include their noise; \"auto\": chosen by pilot runs for the narrowest intervals that /design/runs or /design/until allow", RANDOM,
	 .fixed = "every sample has the same number of signals"},
	{"/scene/excitation/acceleration_m_s2", FIELD_LIST, 0, NAN, 2, STUDY_SAMPLES_MAX, FIELD_CLOSED, "",
	 .text = "ground accelerations of a record, one per time step", .types = " record ", .fixed = "the samples of a record are fixed data"},
	{"/scene/excitation/acceleration_m_s2/*", FIELD_REAL, 0, NAN, -INFINITY, INFINITY, FIELD_OPEN, "m/s2",
	 .text = "one ground acceleration", .types = " record ", .fixed = "the samples of a record are fixed data"},
	{"/scene/excitation/factor", FIELD_REAL, AT(scene.excitation.factor), 1, 0, INFINITY, FIELD_OPEN, "",
	 .text = "factor of all ground accelerations", .types = " record suite ", LATER},
	{"/scene/excitation/records", FIELD_LIST, 0, NAN, 1, STUDY_RECORDS_MAX, FIELD_CLOSED, "",
	 .text = "recorded ground motions, each a signal; at most 20000000 samples in all", RECORDED, FIXED_DATA},
	{"/scene/excitation/records/*", FIELD_OBJECT, 0, 0, 0, 0, FIELD_CLOSED, "",
	 .text = "one record: file or acceleration_m_s2", RECORDED, FIXED_DATA},
	{"/scene/excitation/records/*/name", FIELD_TEXT, IN_RECORD(record.name), 0, 1, 200, FIELD_CLOSED, "",
	 .text = "display name (default: the file)", RECORDED, FIXED_DATA},
	{"/scene/excitation/records/*/file", FIELD_TEXT, IN_RECORD(file), 0, 1, 200, FIELD_CLOSED, "",
	 .text = "file of PEER, COSMOS, ESM or columns, its path from the folder of the study; `pound submit` sends it", RECORDED, FIXED_DATA},
	{"/scene/excitation/records/*/sha256", FIELD_TEXT, IN_RECORD(sha256), 0, 64, 64, FIELD_CLOSED, "",
	 .text = "SHA-256 of the file, which names it on a server (PUT /v1/records/{sha256}); `pound submit` adds it", RECORDED, FIXED_DATA},
	{"/scene/excitation/records/*/unit", FIELD_TEXT, IN_RECORD(unit), 0, 1, 16, FIELD_CLOSED, "",
	 .text = "unit of the accelerations, if the file does not name it: g, cm/s2 or m/s2", RECORDED, FIXED_DATA},
	{"/scene/excitation/records/*/channel", FIELD_COUNT, IN_RECORD(channel), 0, 0, 1000, FIELD_CLOSED, "",
	 .text = "number of the acceleration in a file that has several, from 1; 0: the file has one", RECORDED, FIXED_DATA},
	{"/scene/excitation/records/*/time_step_s", FIELD_REAL, IN_RECORD(record.time_step), 0, 0, INFINITY, FIELD_OPEN_MIN, "s",
	 .text = "time between two samples; required by acceleration_m_s2 and by a file without times", RECORDED, FIXED_DATA},
	{"/scene/excitation/records/*/acceleration_m_s2", FIELD_LIST, 0, 0, 2, STUDY_SAMPLES_MAX, FIELD_CLOSED, "",
	 .text = "ground accelerations, one per time step", RECORDED, FIXED_DATA},
	{"/scene/excitation/records/*/acceleration_m_s2/*", FIELD_REAL, 0, NAN, -INFINITY, INFINITY, FIELD_OPEN, "m/s2",
	 .text = "one ground acceleration", RECORDED, FIXED_DATA},
	{"/scene/excitation/records/*/factor", FIELD_REAL, IN_RECORD(record.factor), 1, 0, INFINITY, FIELD_OPEN, "",
	 .text = "factor of this record, before it is scaled", RECORDED, .fixed = "it belongs to the record; vary /excitation/factor"},
	{"/scene/excitation/records/*/reversed", FIELD_BOOL, IN_RECORD(record.reversed), 0, 0, 1, FIELD_CLOSED, "",
	 .text = "true: the accelerations change sign, so the ground moves in the opposite direction", RECORDED, .fixed = "it belongs to the record; use /excitation/directions"},
	{"/scene/excitation/directions", FIELD_ALTERNATIVE, AT(scene.excitation.both), 0, 0, 1, FIELD_CLOSED, "",
	 .text = "both: every record gives two signals, as it is and with its sign changed", .choice = directions_name, RECORDED,
	 .fixed = "every sample has the same number of signals"},
	{"/scene/excitation/draw", FIELD_COUNT, AT(scene.excitation.draw), 0, 0, 100000, FIELD_CLOSED, "",
	 .text = "number of signals that are drawn at random for each scene, with replacement; 0: each record is a signal", RECORDED,
	 .fixed = "every sample has the same number of signals"},
	{"/scene/excitation/scale", FIELD_OBJECT, 0, 0, 0, 0, FIELD_CLOSED, "",
	 .text = "what the records are scaled to; absent: they are not scaled", RECORDED},
	{"/scene/excitation/scale/to", FIELD_CHOICE, AT(scene.excitation.scale.to), NAN, 0, 0, FIELD_CLOSED, "",
	 .text = "every record to a peak (pga) or a spectral acceleration (sa), or all by one factor that makes the median spectral acceleration the intensity (median_sa)",
	 .choice = pound_scale_name, RECORDED, .fixed = "it determines which other members apply"},
	{"/scene/excitation/scale/intensity_m_s2", FIELD_REAL, AT(scene.excitation.scale.intensity), 0, 0, INFINITY, FIELD_OPEN_MIN, "m/s2",
	 .text = "peak or spectral acceleration that the records are scaled to; required unless `to` is none", RECORDED},
	{"/scene/excitation/scale/period_s", FIELD_REAL, AT(scene.excitation.scale.period), 0, 0, 1000, FIELD_OPEN_MIN, "s",
	 .text = "period of the spectral acceleration; required by sa and median_sa", RECORDED, .fixed = "records are scaled once for all cells"},
	{"/scene/excitation/scale/damping_ratio", FIELD_REAL, AT(scene.excitation.scale.damping_ratio), 0.05, 0, 1, FIELD_OPEN_MAX, "",
	 .text = "damping of the spectral acceleration, as a fraction of critical; only sa and median_sa", RECORDED,
	 .fixed = "records are scaled once for all cells"},

	{"/inputs", FIELD_LIST, 0, NAN, 1, POUND_INPUTS_MAX, FIELD_CLOSED, "",
	 .text = "random inputs; each varies one field of the scene; a study of separation may have none", SENSITIVITY, .optional = " separation ", NOT_SCENE},
	{"/inputs/*", FIELD_OBJECT, 0, 0, 0, 0, FIELD_CLOSED, "",
	 .text = "one random input", SENSITIVITY, NOT_SCENE},
	{"/inputs/*/path", FIELD_TEXT, offsetof(struct pound_input, path), NAN, 1, 200, FIELD_CLOSED, "",
	 .text = "JSON Pointer into \"scene\"", SENSITIVITY, .sceneless = FIELD_OPTIONAL, NOT_SCENE},
	{"/inputs/*/name", FIELD_TEXT, offsetof(struct pound_input, name), 0, 1, 100, FIELD_CLOSED, "",
	 .text = "display name (default: the path); unique; not `row`, `sample` or an output name", SENSITIVITY, NOT_SCENE},
	{"/inputs/*/distribution", FIELD_OBJECT, 0, NAN, 0, 0, FIELD_CLOSED, "",
	 .text = "probability distribution; its values must be in the range of the field", SENSITIVITY, NOT_SCENE},
	{"/inputs/*/distribution/type", FIELD_CHOICE, offsetof(struct pound_input, distribution.type),
	 NAN, 0, 0, FIELD_CLOSED, "", .text = "type of distribution", .choice = pound_distribution_name, SENSITIVITY, NOT_SCENE},
	{"/inputs/*/distribution/values", FIELD_LIST, 0, 0, 1, STUDY_VALUES_MAX, FIELD_CLOSED, "",
	 .text = "values of a discrete distribution, or sample of an empirical one, in ascending order", SENSITIVITY, NOT_SCENE},
	{"/inputs/*/distribution/values/*", FIELD_REAL, 0, NAN, -POUND_PARAMETER_MAX, POUND_PARAMETER_MAX, FIELD_CLOSED, "",
	 .text = "one value", SENSITIVITY, NOT_SCENE},
	{"/inputs/*/distribution/weights", FIELD_LIST, 0, 0, 1, STUDY_VALUES_MAX, FIELD_CLOSED, "",
	 .text = "weights of the values of a discrete distribution, one per value (default: equal)", SENSITIVITY, NOT_SCENE},
	{"/inputs/*/distribution/weights/*", FIELD_REAL, 0, NAN, 0, POUND_PARAMETER_MAX, FIELD_OPEN_MIN, "",
	 .text = "one weight", SENSITIVITY, NOT_SCENE},

	{"/ratios", FIELD_LIST, 0, 0, 0, POUND_RATIOS_MAX, FIELD_CLOSED, "",
	 .text = "ratios of inputs to report indices for; ratios plus remaining inputs: at most 5", SENSITIVITY, NOT_SCENE},
	{"/ratios/*", FIELD_OBJECT, 0, 0, 0, 0, FIELD_CLOSED, "",
	 .text = "one ratio", SENSITIVITY, NOT_SCENE},
	{"/ratios/*/name", FIELD_TEXT, offsetof(struct pound_ratio, name), NAN, 1, 100, FIELD_CLOSED, "",
	 .text = "display name; unique among ratios and inputs", SENSITIVITY, NOT_SCENE},
	{"/ratios/*/of", FIELD_LIST, 0, NAN, 2, 2, FIELD_CLOSED, "",
	 .text = "paths of two inputs: numerator, denominator; a numerator may not appear anywhere else in the ratios", SENSITIVITY, NOT_SCENE},
	{"/ratios/*/of/*", FIELD_TEXT, offsetof(struct pound_ratio, of), NAN, 1, 200, FIELD_CLOSED, "",
	 .text = "path of an input that is uniform or log_uniform and > 0; in a study without scene its name", SENSITIVITY, NOT_SCENE},

	{"/groups", FIELD_LIST, 0, 0, 0, POUND_GROUPS_MAX, FIELD_CLOSED, "",
	 .text = "groups of inputs to report indices of, each as of one input; each adds a sample to every row", SENSITIVITY, NOT_SCENE},
	{"/groups/*", FIELD_OBJECT, 0, 0, 0, 0, FIELD_CLOSED, "",
	 .text = "one group", SENSITIVITY, NOT_SCENE},
	{"/groups/*/name", FIELD_TEXT, offsetof(struct pound_group, name), NAN, 1, 100, FIELD_CLOSED, "",
	 .text = "display name; unique among groups, ratios and inputs", SENSITIVITY, NOT_SCENE},
	{"/groups/*/of", FIELD_LIST, 0, NAN, 2, POUND_INPUTS_MAX, FIELD_CLOSED, "",
	 .text = "paths of its inputs, two or more but not all; groups may overlap", SENSITIVITY, NOT_SCENE},
	{"/groups/*/of/*", FIELD_TEXT, offsetof(struct pound_group, of), NAN, 1, 200, FIELD_CLOSED, "",
	 .text = "path of an input; in a study without scene its name", SENSITIVITY, NOT_SCENE},

	{"/sweep", FIELD_LIST, 0, 0, 0, POUND_SWEEPS_MAX, FIELD_CLOSED, "",
	 .text = "swept fields; a cell is one combination of their values; at most 10000 cells", SWEPT, WITH_SCENE, NOT_SCENE},
	{"/sweep/*", FIELD_OBJECT, 0, 0, 0, 0, FIELD_CLOSED, "",
	 .text = "one swept field", SWEPT, WITH_SCENE, NOT_SCENE},
	{"/sweep/*/path", FIELD_TEXT, offsetof(struct pound_sweep, path), NAN, 1, 200, FIELD_CLOSED, "",
	 .text = "JSON Pointer into \"scene\"", SWEPT, WITH_SCENE, NOT_SCENE},
	{"/sweep/*/values", FIELD_LIST, 0, NAN, 1, STUDY_CELLS_MAX, FIELD_CLOSED, "",
	 .text = "values of the swept field, all different", SWEPT, WITH_SCENE, NOT_SCENE},

	{"/design", FIELD_OBJECT, 0, 0, 0, 0, FIELD_CLOSED, "",
	 .text = "sampling: which rows are run, and the seed", NOT_SCENE},
	{"/design/method", FIELD_CHOICE, AT(design.method), 0, 0, 0, FIELD_CLOSED, "",
	 .text = "sampling method: Latin hypercube, random, or Sobol' points", .choice = pound_design_name, SENSITIVITY, NOT_SCENE},
	{"/design/rows", FIELD_COUNT, AT(design.rows), 1000, 2, POUND_ROWS_MAX, FIELD_CLOSED, "",
	 .text = "base samples n: rows of the matrices A and B; sobol: default 1024, at least 2 per randomisation, best a power of two per randomisation; at most 10000000 pounding runs in all", SENSITIVITY, NOT_SCENE},
	{"/design/runs", FIELD_COUNT, AT(design.runs), 0, 0, STUDY_RUNS_MAX, FIELD_OPEN_MIN, "",
	 .text = "pounding runs to spend, pilot included, instead of rows; only with signals \"auto\", which requires it or `until`", .kinds = " sensitivity ", WITH_SCENE, NOT_SCENE, LATER},
	{"/design/randomisations", FIELD_COUNT, AT(design.randomisations), 8, 4, 32, FIELD_CLOSED, "",
	 .text = "number of independent scrambles of the Sobol' points, from which intervals are estimated; only with method sobol", SENSITIVITY,
	 NOT_SCENE},
	{"/design/until", FIELD_OBJECT, 0, 0, 0, 0, FIELD_CLOSED, "",
	 .text = "adds rows until every interval is narrow enough; starts with `rows`, or 1000 (sobol: 16 per randomisation) if that is more", SENSITIVITY, WITH_SCENE, NOT_SCENE},
	{"/design/until/half_width", FIELD_REAL, AT(design.until.half_width), NAN, 0, 1, FIELD_OPEN, "",
	 .text = "largest accepted half-width of the 95 % intervals of all S1 and ST", SENSITIVITY, WITH_SCENE, NOT_SCENE},
	{"/design/until/max_runs", FIELD_COUNT, AT(design.until.max_runs), 200000, 1, STUDY_RUNS_MAX, FIELD_CLOSED, "",
	 .text = "largest number of pounding runs; at least the runs of the first rows", SENSITIVITY, WITH_SCENE, NOT_SCENE},
	{"/design/until/goal", FIELD_CHOICE, AT(design.until.goal), 0, 0, 0, FIELD_CLOSED, "",
	 .text = "which intervals must be narrow enough: width: all of S1 and ST; order: only those of ST that overlap another input's", .choice = goal_name, SENSITIVITY,
	 WITH_SCENE, NOT_SCENE, LATER},
	{"/design/until/output", FIELD_CHOICE, AT(design.until.output), 0, 0, 0, FIELD_CLOSED, "",
	 .text = "output whose intervals must be narrow enough: all, or one of `outputs`", .choice = until_output_name, SENSITIVITY, WITH_SCENE, NOT_SCENE, LATER},
	{"/design/seed", FIELD_SEED, AT(design.seed), 42, 0, 0, FIELD_CLOSED, "",
	 .text = "seed of the random numbers; the same seed gives the same result", NOT_SCENE},
	{"/design/signals", FIELD_ALTERNATIVE, AT(design.common_signals), 1, 0, 1, FIELD_CLOSED, "",
	 .text = "whether the samples of a row share their random ground motions; if common, ST and interactions need 2 signals or more", .choice = signals_name, SENSITIVITY,
	 NOT_SCENE},
	{"/design/order", FIELD_CHOICE, AT(design.order), 0, 0, 0, FIELD_CLOSED, "",
	 .text = "samples per row, mixtures of A and B: total n_inputs + 2, second 2 n_inputs + 2, factorial 2^n_inputs (at most 5 inputs)",
	 .choice = pound_order_name, SENSITIVITY, NOT_SCENE},
	{"/design/estimator", FIELD_CHOICE, AT(design.estimator), 0, 0, 0, FIELD_CLOSED, "",
	 .text = "additional estimator of S1 and ST, reported in columns of its own; azzini_rosati implies order second",
	 .choice = pound_estimator_name, SENSITIVITY, NOT_SCENE},

	{"/outputs", FIELD_LIST, 0, 0, 1, POUND_OUTPUTS_ASKED_MAX, FIELD_CLOSED, "",
	 .text = "outputs to compute, all different (default: the applicable amplifications and, with contact, the impulse; in a separation study no outputs with pounding)", SWEPT, WITH_SCENE, NOT_SCENE},
	{"/outputs/*", FIELD_CHOICE, AT(outputs), 0, 0, 0, FIELD_CLOSED, "",
	 .text = "name of an output; schema/guide.md has its formula, its unit and what it needs: a body, a law, a contact or buildings", .choice = pound_output_name, SWEPT, WITH_SCENE, NOT_SCENE},

	{"/places", FIELD_LIST, 0, 0, 1, POUND_PLACES_MAX, FIELD_CLOSED, "",
	 .text = "stories of a row of buildings for which outputs are computed, all different (default: every story of building 0)", SOLVED, WITH_SCENE, NOT_SCENE},
	{"/places/*", FIELD_OBJECT, 0, 0, 0, 0, FIELD_CLOSED, "",
	 .text = "one story and the floor above it", SOLVED, WITH_SCENE, NOT_SCENE},
	{"/places/*/building", FIELD_COUNT, IN_PLACES(building), 0, 0, POUND_BUILDINGS_MAX - 1, FIELD_CLOSED, "",
	 .text = "index of the building", SOLVED, WITH_SCENE, NOT_SCENE},
	{"/places/*/storey", FIELD_COUNT, IN_PLACES(storey), NAN, 1, POUND_STOREYS_MAX, FIELD_CLOSED, "",
	 .text = "story, from 1", SOLVED, WITH_SCENE, NOT_SCENE},

	{"/solver", FIELD_OBJECT, 0, 0, 0, 0, FIELD_CLOSED, "",
	 .text = "numerical solver of the equations of motion", SOLVED, WITH_SCENE, NOT_SCENE},
	{"/solver/method", FIELD_CHOICE, AT(solver.method), 0, 0, 0, FIELD_CLOSED, "",
	 .text = "solver: event (exact), newmark and central_difference (fixed step) or adaptive (adaptive step)", .choice = pound_solver_name, SOLVED, WITH_SCENE, NOT_SCENE},
	{"/solver/tolerance", FIELD_REAL, AT(solver.tolerance), 1e-9, 0, 1, FIELD_OPEN, "",
	 .text = "relative error allowed per step; no effect on event, which is exact", .solvers = pound_solver_takes_tolerance,
	 SOLVED, WITH_SCENE, NOT_SCENE},
	{"/solver/step_s", FIELD_REAL, AT(solver.step), 1e-4, 0, INFINITY, FIELD_OPEN, "s",
	 .text = "largest time step; each sample interval is divided into equal steps, at most 1000000", .solvers = pound_solver_takes_step,
	 SOLVED, WITH_SCENE, NOT_SCENE},

	{"/spectrum", FIELD_OBJECT, 0, 0, 0, 0, FIELD_CLOSED, "",
	 .text = "floor response spectrum of the left body, or of a floor of a row of buildings; in a sensitivity study: settings of output floor_spectrum", SPECTRAL, WITH_SCENE, NOT_SCENE},
	{"/spectrum/frequencies_hz", FIELD_LIST, 0, 0, 1, STUDY_FREQUENCIES_MAX, FIELD_CLOSED, "",
	 .text = "frequencies of the spectrum: a list, or an object {min, max, count} for logarithmic spacing; all different, each at most 100 / time_step_s; at most 64 in a sensitivity study, else at most 5000000 over all signals",
	 SPECTRAL, WITH_SCENE, NOT_SCENE},
	{"/spectrum/frequencies_hz/*", FIELD_REAL, AT(spectrum.min_hz), 1, 0, INFINITY, FIELD_OPEN, "Hz",
	 .text = "one frequency", SPECTRAL, WITH_SCENE, NOT_SCENE},
	{"/spectrum/frequencies_hz/min", FIELD_REAL, AT(spectrum.min_hz), 0.1, 0, INFINITY, FIELD_OPEN, "Hz",
	 .text = "lowest frequency", SPECTRAL, WITH_SCENE, NOT_SCENE},
	{"/spectrum/frequencies_hz/max", FIELD_REAL, AT(spectrum.max_hz), 100, 0, INFINITY, FIELD_OPEN, "Hz",
	 .text = "highest frequency", SPECTRAL, WITH_SCENE, NOT_SCENE},
	{"/spectrum/frequencies_hz/count", FIELD_COUNT, AT(spectrum.n), 200, 2, STUDY_FREQUENCIES_MAX, FIELD_CLOSED, "",
	 .text = "number of frequencies", SPECTRAL, WITH_SCENE, NOT_SCENE},
	{"/spectrum/damping_ratio", FIELD_REAL, AT(spectrum.damping_ratio), 0.05, 0, 1, FIELD_OPEN_MAX, "",
	 .text = "damping of the spectrum, as a fraction of critical", SPECTRAL, WITH_SCENE, NOT_SCENE},
	{"/spectrum/pulses", FIELD_COUNT, AT(spectrum.pulses), 0, 0, 1000000, FIELD_CLOSED, "",
	 .text = "number of pulses in the idealized pulse train; 0: the number of contacts of each signal", FLOORED, WITH_SCENE, NOT_SCENE},
	{"/spectrum/place", FIELD_OBJECT, 0, 0, 0, 0, FIELD_CLOSED, "",
	 .text = "row of buildings: story below the floor of the spectrum and of the histories (default: top story of building 0)", SPECTRAL, WITH_SCENE, NOT_SCENE},
	{"/spectrum/place/building", FIELD_COUNT, AT(spectrum.place.building), 0, 0, POUND_BUILDINGS_MAX - 1, FIELD_CLOSED, "",
	 .text = "index of the building", SPECTRAL, WITH_SCENE, NOT_SCENE},
	{"/spectrum/place/storey", FIELD_COUNT, AT(spectrum.place.storey), NAN, 1, POUND_STOREYS_MAX, FIELD_CLOSED, "",
	 .text = "story, from 1", SPECTRAL, WITH_SCENE, NOT_SCENE},
	{"/histories", FIELD_BOOL, AT(spectrum.histories), 0, 0, 1, FIELD_CLOSED, "",
	 .text = "true: samples have the time histories of both oscillators, or of the floor at /spectrum/place and its contact with the right neighbor; at most 250000 ground motion samples over all signals", FLOORED, WITH_SCENE, NOT_SCENE},

	{"/separation", FIELD_OBJECT, 0, 0, 0, 0, FIELD_CLOSED, "",
	 .text = "settings of the gap needed: gaps, probabilities, intensity, hazard", SEPARATION},
	{"/separation/gaps_m", FIELD_LIST, 0, 0, 1, POUND_GAPS_MAX, FIELD_CLOSED, "",
	 .text = "gaps at which the probability of pounding is computed, ascending (default: up to 41 round values)", SEPARATION},
	{"/separation/gaps_m/*", FIELD_REAL, 0, NAN, 0, INFINITY, FIELD_CLOSED, "m",
	 .text = "one gap", SEPARATION},
	{"/separation/probabilities", FIELD_LIST, 0, 0, 1, POUND_PROBABILITIES_MAX, FIELD_CLOSED, "",
	 .text = "probabilities of pounding for which the gap is computed (default: 0.5, 0.16, 0.1, 0.05, 0.02, 0.01)", SEPARATION},
	{"/separation/probabilities/*", FIELD_REAL, 0, NAN, 0, 1, FIELD_OPEN, "",
	 .text = "one probability", SEPARATION},
	{"/separation/intensity", FIELD_TEXT, AT(separation.intensity), 0, 1, 200, FIELD_CLOSED, "",
	 .text = "path of the sweep whose values are intensities of the ground motion: fragility curves are fitted over them", SEPARATION},
	{"/separation/hazard", FIELD_OBJECT, 0, 0, 0, 0, FIELD_CLOSED, "",
	 .text = "hazard curve: mean annual rates of exceedance of intensities", SEPARATION},
	{"/separation/hazard/intensities", FIELD_LIST, 0, NAN, 2, POUND_STRIPES_MAX, FIELD_CLOSED, "",
	 .text = "intensities in the unit of the sweep, ascending", SEPARATION},
	{"/separation/hazard/intensities/*", FIELD_REAL, 0, NAN, 0, INFINITY, FIELD_OPEN, "",
	 .text = "one intensity", SEPARATION},
	{"/separation/hazard/annual_rates", FIELD_LIST, 0, NAN, 2, POUND_STRIPES_MAX, FIELD_CLOSED, "",
	 .text = "mean annual rates of exceedance, one per intensity, descending", SEPARATION},
	{"/separation/hazard/annual_rates/*", FIELD_REAL, 0, NAN, 0, INFINITY, FIELD_OPEN, "1/year",
	 .text = "one rate", SEPARATION},
	{"/separation/return_periods_years", FIELD_LIST, 0, 0, 1, POUND_PERIODS_MAX, FIELD_CLOSED, "",
	 .text = "return periods of pounding for which the gap is computed; needs hazard", SEPARATION},
	{"/separation/return_periods_years/*", FIELD_REAL, 0, NAN, 0, INFINITY, FIELD_OPEN, "years",
	 .text = "one return period", SEPARATION},

	{"/convergence", FIELD_OBJECT, 0, 0, 0, 0, FIELD_CLOSED, "",
	 .text = "solver settings whose results are compared with the event solver; at most 100000 runs in all", CONVERGENCE, NOT_SCENE},
	SETTING_ROWS("newmark", "steps_s", 1, INFINITY, "s", "steps"),
	SETTING_ROWS("central_difference", "steps_s", 2, INFINITY, "s", "steps"),
	SETTING_ROWS("adaptive", "tolerances", 3, 1, "", "tolerances"),
	{"/convergence/history_s", FIELD_REAL, AT(convergence.history), 2, 0, INFINITY, FIELD_OPEN, "s",
	 .text = "time from the start over which displacements are compared", CONVERGENCE, NOT_SCENE},
};
// clang-format on

const int fields_count = sizeof fields / sizeof fields[0];

const char *const fields_outputs_absent[] = {"force_amplification",
                                             "drift_amplification",
                                             "acceleration_amplification",
                                             "demand_amplification",
                                             "impulse",
                                             NULL};

const struct field *fields_find(const char *pattern)
{
	for (int i = 0; i < fields_count; i++)
		if (strcmp(fields[i].pattern, pattern) == 0)
			return &fields[i];
	return NULL;
}

const char *fields_name(const struct field *field)
{
	return strrchr(field->pattern, '/') + 1;
}

bool fields_child(const struct field *field, const char *pattern)
{
	size_t length = strlen(pattern);
	return strncmp(field->pattern, pattern, length) == 0 && fields_name(field) == field->pattern + length + 1;
}

bool fields_within(const struct field *field, const char *const starts[], size_t n)
{
	size_t k = 0;
	while (k < n && strncmp(field->pattern, starts[k], strlen(starts[k])) != 0)
		k++;
	return k < n;
}

bool fields_listed(const char *names, const char *name)
{
	size_t n = strlen(name);
	for (const char *at = names ? strstr(names, name) : NULL; at && n > 0; at = strstr(at + 1, name))
		if (at > names && at[-1] == ' ' && at[n] == ' ')
			return true;
	return false;
}

/* Whether a list contains a name; a NULL list contains all names, and a NULL name is in every list. */
static bool listed(const char *names, const char *name)
{
	return !names || !name || fields_listed(names, name);
}

bool fields_used(const struct field *field, const char *kind, const char *excitation, const char *solver)
{
	return listed(field->kinds, kind) && listed(field->types, excitation) &&
	       (!solver || !field->solvers || field->solvers(fields_choice(pound_solver_name, solver)));
}

bool fields_in_range(const struct field *field, double value)
{
	bool above = field->ends & FIELD_OPEN_MIN ? value > field->min : value >= field->min;
	bool below = field->ends & FIELD_OPEN_MAX ? value < field->max : value <= field->max;
	return above && below && isfinite(value);
}

/* The valid range of a number, as text that follows "must be"; "a number" if there are no limits.
 *
 * Test     unit_fields: every_field_says_what_it_takes
 */
void fields_range(const struct field *field, char *text, size_t size)
{
	bool open_min = field->ends & FIELD_OPEN_MIN, open_max = field->ends & FIELD_OPEN_MAX;
	if (isinf(field->min))
		snprintf(text, size, "a number");
	else if (isinf(field->max))
		snprintf(text, size, "%s %.15g", open_min ? "greater than" : "at least", field->min);
	else
		snprintf(text, size, "in %c%.15g, %.15g%c", open_min ? '(' : '[', field->min, field->max,
		         open_max ? ')' : ']');
}

/* The number of elements or characters of a list or a text: "2", "1 to 200". */
void fields_span(const struct field *field, char *text, size_t size)
{
	if (field->min == field->max)
		snprintf(text, size, "%.0f", field->max);
	else
		snprintf(text, size, "%.0f to %.0f", field->min, field->max);
}

/* The valid values of a field, as text that follows "must be".
 *
 * Test     unit_fields: every_field_says_what_it_takes
 */
void fields_expected(const struct field *field, char *text, size_t size)
{
	field_types[field->type].expected(field, text, size);
}

int fields_choice(const char *(*choice)(int row), const char *name)
{
	for (int row = 0; choice(row); row++)
		if (strcmp(choice(row), name) == 0)
			return row;
	return -1;
}

/* Replaces each index of a path by * and returns the indices; false: not a path of a field. */
static bool path_pattern(const char *path, char *pattern, size_t size, int indices[2])
{
	int n = 0;
	size_t length = (size_t)snprintf(pattern, size, "/scene");
	indices[0] = indices[1] = -1;
	for (const char *part = path; *part == '/'; part += strcspn(part, "/")) {
		const size_t digits = strspn(++part, "0123456789"), end = strcspn(part, "/");
		const bool index = digits > 0 && digits == end;
		if ((index && (n == 2 || digits > 3 || (digits > 1 && *part == '0'))) || length + end + 2 > size)
			return false;
		if (index)
			indices[n++] = atoi(part);
		length += (size_t)snprintf(pattern + length, size - length, "/%.*s", index ? 1 : (int)end,
		                           index ? "*" : part);
	}
	return *path == '/' && !strchr(path, '*');
}

bool fields_may_have(const char *pattern, int index)
{
	char name[256];
	const char *star = strstr(pattern, "/*");
	snprintf(name, sizeof name, "%.*s", star ? (int)(star - pattern) : 0, pattern);
	const struct field *list = fields_find(name);
	return list && index >= 0 && index < list->max;
}

/* Finds the field that a JSON Pointer into "scene" names.
 *
 * Given    path        -       -       "/oscillators/1/mass_kg", "/buildings/0/mass_kg/3", "/contacts/0/levels/1"
 * Returns  value       -       -       row of the field, NULL: none
 *          place       -       -       {1, -1}, {0, 3}, {0, 1}; {-1, -1} if the path has no index
 *
 * Test     unit_fields: a_path_names_one_field_of_the_scene
 */
const struct field *fields_scene(const char *path, struct field_place *place)
{
	char pattern[256];
	int indices[2];
	*place = (struct field_place){-1, -1};
	if (!path_pattern(path, pattern, sizeof pattern, indices))
		return NULL;
	const struct field *field = fields_find(pattern);
	if (indices[0] >= 0 && !fields_may_have(pattern, indices[0]))
		return NULL;
	*place = (struct field_place){indices[0], indices[1]};
	if (field)
		return indices[1] < 2 ? field : NULL; // of two levels, or of two modes
	char *last = strrchr(pattern, '/');
	if (strcmp(last, "/*") != 0)
		return NULL;
	*last = 0;
	field = fields_find(pattern);
	return field && field->type == FIELD_EACH && indices[1] < POUND_STOREYS_MAX ? field : NULL;
}

bool fields_vary(const struct field *field, bool input)
{
	return !field->fixed && field_types[field->type].number &&
	       (!input || field->type == FIELD_REAL || field->type == FIELD_EACH);
}
