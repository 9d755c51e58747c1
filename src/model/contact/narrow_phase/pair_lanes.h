/* pair_lanes.h - evaluates eight pairs at a time in vector lanes.
 *
 * Each lane holds one whole pair and does the arithmetic of that pair alone, in the order of
 * pair_contact.h. The bits of a pair therefore depend neither on its lane nor on the pairs
 * beside it, and are the same for every width of vectors.
 *
 * Layout: the lane is the last index of every array, so that one component of eight pairs is
 * one contiguous load. A feature of a point and a triangle has the kind CS_PAIR_POINT_TRIANGLE.
 */
#ifndef CS_NARROW_PHASE_PAIR_LANES_H
#define CS_NARROW_PHASE_PAIR_LANES_H

#include "model/contact/narrow_phase/pair_contact.h"
#include "model/system/particle_system.h"
#include "scene/contact_keys.h"

enum { CS_PAIR_LANES = 8 };

/* Pairs of one kind at a state: up to CS_PAIR_LANES of them. Lanes from n on hold unspecified
 * numbers; the caller ignores their results. */
struct cs_pair_lanes {
    /* positions in m and velocities in m/s of the four points */
    double p[4][3][CS_PAIR_LANES], v[4][3][CS_PAIR_LANES];
    /* parameters of the barrier law: range D in m, stiffness k in N/m (times the weight of the
     * feature, so it may be negative), friction coefficient */
    double range[CS_PAIR_LANES], k[CS_PAIR_LANES], friction[CS_PAIR_LANES];
    double rate[CS_PAIR_LANES]; /* 1/s2, k/M without weights, of restitution */
    /* direction of a Jacobian product: changes of p and v */
    double dp[4][3][CS_PAIR_LANES], dv[4][3][CS_PAIR_LANES];
    /* distance in m; cs_pair_lanes_measure_edges sets it */
    double d[CS_PAIR_LANES];
    /* result: forces on the four points in N, or their changes; or bounds in N/m and N s/m */
    double out[4][3][CS_PAIR_LANES];
    /* struct cs_feature_kind of each lane; ignored for edge-edge pairs */
    double is_edge[CS_PAIR_LANES], is_off_plane[CS_PAIR_LANES], blend_radius[CS_PAIR_LANES];
    /* N/m: k that the barrier's curvature has in a positive semi-definite matrix, never
     * negative */
    double psd_stiffness[CS_PAIR_LANES];
    uint32_t n;
};

/* Copies three columns of the rows of n pairs, whose four points have the rows `to`, into
 * lanes. rows is (rows, width) from the first of the columns on. */
static inline void cs_pair_lanes_read(const double *rows, size_t width, uint32_t (*to)[4],
                                      uint32_t n, double out[4][3][CS_PAIR_LANES]) {
    for (uint32_t l = 0; l < n; l++)
        for (size_t k = 0; k < 4; k++)
            for (size_t c = 0; c < 3; c++)
                out[k][c][l] = rows[to[l][k] * width + c];
}

/* sums (rows, width) += the first `width` components of n pairs, pair by pair. */
static inline void cs_pair_lanes_add(double by[4][3][CS_PAIR_LANES], size_t width,
                                     uint32_t (*to)[4], uint32_t n, double *sums) {
    for (uint32_t l = 0; l < n; l++)
        for (size_t k = 0; k < 4; k++)
            for (size_t c = 0; c < width; c++)
                sums[to[l][k] * width + c] += by[k][c][l];
}

/* Sets d of edges from p and range; for features of triangles d comes from feature_weights.h.
 */
void cs_pair_lanes_measure_edges(struct cs_pair_lanes *lanes);

/* Parameters that all lanes share: damping and friction speed of the scene, and the parts of
 * the force that are wanted. */
struct cs_pair_lane_constants {
    struct cs_contact_keys keys;
    struct cs_contact_force_parts parts;
};

/* Sets *contact to the pair of one lane. */
void cs_pair_lanes_contact(enum cs_pair_kind kind, struct cs_pair_lanes *lanes, uint32_t lane,
                           const struct cs_contact_keys *keys, struct cs_pair_contact *contact);

/* Sets `out` to the forces, to their exact change along (dp, dv), or to the bounds of
 * cs_pair_contact_bound in its first two components, for edges or for features of triangles.
 * Formulas: contact_pairs.h. */
void cs_pair_lanes_force(enum cs_pair_kind kind, struct cs_pair_lanes *lanes,
                         const struct cs_pair_lane_constants *constants);
void cs_pair_lanes_jvp(enum cs_pair_kind kind, struct cs_pair_lanes *lanes,
                       const struct cs_pair_lane_constants *constants);
void cs_pair_lanes_bound(enum cs_pair_kind kind, struct cs_pair_lanes *lanes,
                         const struct cs_pair_lane_constants *constants);

/* Factors of the matrix of eight pairs, P = c g g^T + (w w^T) x B with a 3 x 3 block B.
 *
 * They are stored by the three differences u, v, w of the points (pair_distance.h) and not by
 * the four points: g then has 9 numbers and not 12, and w has 2 and not 4. No information is
 * lost, because both the gradient and the weights sum to 0 over the points. */
struct cs_pair_factors {
    /* gradient by u, v and w; weights of u and v, that of w being 1 */
    double g[3][3][CS_PAIR_LANES], weight[2][CS_PAIR_LANES];
    /* c in the unit of the matrix; B as xx, xy, xz, yy, yz, zz */
    double gradient_weight[CS_PAIR_LANES], block[6][CS_PAIR_LANES];
};

/* Reads the factors of one lane by its points: gradient g and the other terms. */
void cs_pair_factors_read(enum cs_pair_kind kind, const struct cs_pair_factors *factors,
                          int lane, double g[4][3], struct cs_pair_matrix_terms *terms);

/* Sets the factors to those of cs_pair_contact_matrix for a positive semi-definite matrix. */
void cs_pair_lanes_matrix(enum cs_pair_kind kind, struct cs_pair_lanes *lanes,
                          const struct cs_contact_keys *keys, const struct cs_matrix *matrix,
                          struct cs_pair_factors *factors);

/* Replaces p by P p for each pair. The Hessian of the distance is not part of P. */
void cs_pair_lanes_multiply(enum cs_pair_kind kind, struct cs_pair_factors *factors,
                            double p[4][3][CS_PAIR_LANES]);

/* Sets `own` to the four 3 x 3 diagonal blocks of P of each pair. alone: enlarges them until
 * the block-diagonal matrix bounds P from above, as in cs_contact_set_add_blocks. */
void cs_pair_lanes_diagonal(enum cs_pair_kind kind, struct cs_pair_factors *factors, bool alone,
                            double own[4][6][CS_PAIR_LANES]);

/* --- friction by its chord (contact/friction_chord.h) --- */

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
