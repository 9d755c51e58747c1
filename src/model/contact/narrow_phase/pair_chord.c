/* Adds friction by its chord to the factors of pairs, eight at a time, as one loop over lanes.
 *
 * The factors have the weights of the contact points already: with them come the vector
 * between these points, its direction n, and their relative velocity and acceleration. */
#include "model/contact/narrow_phase/pair_lanes.h"

#include "base/vector.h"
#include "model/contact/friction_chord.h"
#include "scene/contact_keys.h"

#include <string.h>

/* The pair of one lane as one contact point. */
struct point {
    double r[3]; /* m, between the contact points */
    struct cs_sliding_contact contacts;
    struct cs_contact_pull pull;
};

CS_INLINE void add_vertex(const struct cs_pair_lanes *lanes, const struct cs_pair_pulls *pulls,
                          int k, int l, double w, struct point *to) {
    const double moved = w * pulls->inverse_mass[k][l];
    to->pull.inverse += w * moved;
    CS_UNROLLED
    for (int c = 0; c < 3; c++) {
        to->r[c] += w * lanes->p[k][c][l];
        to->contacts.v[c] += w * lanes->v[k][c][l];
        to->pull.motion[c] += moved * pulls->all[k][c][l];
        to->pull.push[c] += moved * pulls->contact[k][c][l];
    }
}

/* The distance of a feature comes with the lanes, that of edges is |r|. */
CS_INLINE void add_chord(enum cs_pair_kind kind, const struct cs_pair_lanes *restrict lanes,
                         const struct cs_contact_keys *keys, struct cs_contact_pull pull,
                         const struct cs_pair_pulls *restrict pulls,
                         struct cs_pair_factors *restrict factors) {
    const double friction_speed = keys->friction_speed;
    for (int l = 0; l < CS_PAIR_LANES; l++) {
        double weight[4], block[6] = {0};
        struct point at = {
            .pull = pull,
            .contacts = {.friction = lanes->friction[l], .friction_speed = friction_speed}};
        cs_pair_distance_to_points(kind, factors->weight[0][l], factors->weight[1][l], 1,
                                   weight);
        CS_UNROLLED
        for (int k = 0; k < 4; k++)
            add_vertex(lanes, pulls, k, l, weight[k], &at);
        // the same n and F as in the pair's force
        const double length = sqrt(cs_vec3_dot(at.r, at.r) + DBL_MIN);
        const double d = kind == CS_PAIR_EDGE_EDGE ? length : lanes->d[l];
        CS_UNROLLED
        for (int c = 0; c < 3; c++)
            at.contacts.n[c] = at.r[c] / length;
        at.contacts.force = cs_barrier_at(d, lanes->range[l], lanes->k[l]).force;
        cs_friction_chord_add(&at.pull, &at.contacts, block);
        CS_UNROLLED
        for (int e = 0; e < 6; e++)
            factors->block[e][l] += block[e];
    }
}

CS_PAIR_KERNEL(static, add_chords, add_chord,
               (const struct cs_pair_lanes *restrict lanes, const struct cs_contact_keys *keys,
                struct cs_contact_pull pull, const struct cs_pair_pulls *restrict pulls,
                struct cs_pair_factors *restrict factors),
               (lanes, keys, pull, pulls, factors))

void cs_pair_lanes_chord_matrix(enum cs_pair_kind kind, struct cs_pair_lanes *lanes,
                                const struct cs_contact_keys *keys,
                                const struct cs_matrix *matrix, struct cs_pair_pulls *pulls,
                                struct cs_pair_factors *factors) {
    double friction[CS_PAIR_LANES];
    memcpy(friction, lanes->friction, sizeof friction);
    memset(lanes->friction, 0, sizeof lanes->friction);
    cs_pair_lanes_matrix(kind, lanes, keys, matrix, factors);
    memcpy(lanes->friction, friction, sizeof friction);
    add_chords(kind, lanes, keys, cs_contact_pull_begin(matrix), pulls, factors);
}
