/* pair_chord.h - matrix factors of pairs with friction by its chord (contact/friction_chord.h).
 */
#ifndef CS_NARROW_PHASE_PAIR_CHORD_H
#define CS_NARROW_PHASE_PAIR_CHORD_H

#include "model/contact/narrow_phase/pair_lanes.h"
#include "model/system/particle_system.h"

/* Forces on the four points of eight pairs in N, as in struct cs_chord_forces, and
 * inverse masses in 1/kg, 0 for points that are held or belong to a collider. */
struct cs_pair_pulls {
    double all[4][3][CS_PAIR_LANES], contact[4][3][CS_PAIR_LANES];
    double inverse_mass[4][CS_PAIR_LANES];
};

/* Sets the factors as cs_pair_lanes_matrix, but for friction. matrix->chord is set. */
void cs_pair_lanes_chord_matrix(enum cs_pair_kind kind, struct cs_pair_lanes *lanes,
                                const struct cs_contact_keys *keys,
                                const struct cs_matrix *matrix, struct cs_pair_pulls *pulls,
                                struct cs_pair_factors *factors);

#endif
