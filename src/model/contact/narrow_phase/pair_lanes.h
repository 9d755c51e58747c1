/* pair_lanes.h - eight pairs at a time: each lane is one pair's own arithmetic, so that the
 * bits are those of one pair alone. */
#ifndef CS_NARROW_PHASE_PAIR_LANES_H
#define CS_NARROW_PHASE_PAIR_LANES_H

#include "model/contact/narrow_phase/pair_contact.h"

enum { CS_PAIR_LANES = 8 };

/* Pairs of one kind at a state. Lanes from n on have numbers that mean nothing. */
struct cs_pair_lanes {
    double p[4][3][CS_PAIR_LANES], v[4][3][CS_PAIR_LANES]; /* m, m/s */
    double range[CS_PAIR_LANES], k[CS_PAIR_LANES], friction[CS_PAIR_LANES];
    double dp[4][3][CS_PAIR_LANES], dv[4][3][CS_PAIR_LANES]; /* of a change */
    double d[CS_PAIR_LANES];                                 /* m, the smooth distance */
    double out[4][3][CS_PAIR_LANES];                         /* forces, or their changes */
    double is_edge[CS_PAIR_LANES], is_off_plane[CS_PAIR_LANES],
        blend_radius[CS_PAIR_LANES];     /* form of a feature */
    double psd_stiffness[CS_PAIR_LANES]; /* N/m, of the law in a matrix */
    uint32_t n;
};

/* Sets d from p. */
void cs_pair_lanes_measure(enum cs_pair_kind kind, struct cs_pair_lanes *lanes);

/* What is the same for all lanes. */
struct cs_pair_lane_constants {
    struct cs_contact_keys keys;
    struct cs_contact_force_parts parts;
};

/* Sets `to` to the forces, or to their change: of edges, or of features of triangles. */
void cs_pair_lanes_force(enum cs_pair_kind kind, struct cs_pair_lanes *lanes,
                         const struct cs_pair_lane_constants *law);
void cs_pair_lanes_jvp(enum cs_pair_kind kind, struct cs_pair_lanes *lanes,
                       const struct cs_pair_lane_constants *law);

/* Bounds of each pair's particles, as cs_pair_contact_bound. */
struct cs_pair_bounds {
    double stiffness[4][CS_PAIR_LANES], damping[4][CS_PAIR_LANES]; /* N/m, N s/m */
};
void cs_pair_lanes_bound(enum cs_pair_kind kind, struct cs_pair_lanes *lanes,
                         const struct cs_contact_keys *keys, struct cs_pair_bounds *bounds);

/* What a matrix has of as many pairs, by the differences u, v, w of their points: half as many
 * numbers as by the points. */
struct cs_pair_factors {
    double g[3][3][CS_PAIR_LANES], weight[2][CS_PAIR_LANES]; /* the weight by w is 1 */
    double gradient_weight[CS_PAIR_LANES], block[6][CS_PAIR_LANES];
};

/* One pair's by its points: the gradient g, and the rest. */
void cs_pair_factors_read(enum cs_pair_kind kind, const struct cs_pair_factors *factors,
                          int lane, double g[4][3], struct cs_pair_matrix_terms *share);

/* Sets them, as cs_pair_contact_matrix of a matrix that is psd. */
void cs_pair_lanes_matrix(enum cs_pair_kind kind, struct cs_pair_lanes *lanes,
                          const struct cs_contact_keys *keys, const struct cs_matrix *matrix,
                          struct cs_pair_factors *factors);

/* In place of p: the share of each pair times p. How gradients turn is not in it. */
void cs_pair_lanes_multiply(enum cs_pair_kind kind, struct cs_pair_factors *factors,
                            double p[4][3][CS_PAIR_LANES]);

/* own = the diagonal blocks of each pair. alone: so much larger that they are above all of it,
 * as in cs_contact_set_add_blocks. */
void cs_pair_lanes_diagonal(enum cs_pair_kind kind, struct cs_pair_factors *factors, bool alone,
                            double own[4][6][CS_PAIR_LANES]);

#endif
