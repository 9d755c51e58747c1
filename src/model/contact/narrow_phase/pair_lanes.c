/* Evaluates pairs in lanes: forces, Jacobian products, bounds, matrix factors and products.
 *
 * Each loop over lanes holds a whole pair per iteration and has no branch on data, so that
 * compilers turn it into vectors. Pair kind and matrix type are constants of each clone.
 *
 * Formulas, with the distance d, its gradient g_k and the weights w_k of point k, the velocity
 * V = sum w_k v_k of the contact points, n their direction and T = V - n (n.V):
 *
 *   force     f_k  = F g_k - w_k (tau K n (n.V) + mu F T / sqrt(T.T + ev^2))
 *   change    df_k = -K dd g_k + F (H dp)_k + dw_k R + w_k dR,  dd = sum g_j.dp_j
 *   matrix    P    = c g g^T + (w w^T) x B,  c = -ck K
 *   product   (P p)_k = c (sum g_j.p_j) g_k + w_k B (sum w_j p_j)
 *   diagonal  P_kk = c g_k g_k^T + w_k^2 B
 *
 * R is the bracket of the force with its sign, H the Hessian of d, F and K the barrier law, B
 * the block of friction and damping of point_contact.h. Product and diagonal work on the
 * factors that the matrix has stored. */
#include "model/contact/narrow_phase/pair_lanes.h"

#include "model/contact/friction_chord.h"

#include <string.h>

/* Copies one lane to or from a pair in point order. */
CS_INLINE void read_lane(double from[4][3][CS_PAIR_LANES], int lane, double to[4][3]) {
    CS_UNROLLED
    for (int k = 0; k < 12; k++)
        to[k / 3][k % 3] = from[k / 3][k % 3][lane];
}

CS_INLINE void write_lane(double from[4][3], int lane, double to[4][3][CS_PAIR_LANES]) {
    CS_UNROLLED
    for (int k = 0; k < 12; k++)
        to[k / 3][k % 3][lane] = from[k / 3][k % 3];
}

CS_CLONES void cs_pair_lanes_measure_edges(struct cs_pair_lanes *restrict lanes) {
    for (int l = 0; l < CS_PAIR_LANES; l++) {
        double p[4][3];
        struct cs_pair_distance distance;
        read_lane(lanes->p, l, p);
        cs_pair_distance_set(&distance, lanes->range[l], p);
        lanes->d[l] = distance.d;
    }
}

/* Measures the pair of one lane: distance, gradient, weights, relative velocity. The law is
 * evaluated afterwards by the function that needs it. */
CS_INLINE void lane_force(enum cs_pair_kind kind, struct cs_pair_lanes *lanes, int lane,
                          const struct cs_pair_lane_constants *constants,
                          struct cs_pair_contact *contact) {
    double p[4][3], v[4][3];
    const struct cs_body_pair_params params = {
        .range = lanes->range[lane], .k = lanes->k[lane], .friction = lanes->friction[lane]};
    read_lane(lanes->p, lane, p);
    read_lane(lanes->v, lane, v);
    const struct cs_feature_kind feature = {lanes->is_edge[lane], lanes->is_off_plane[lane],
                                            lanes->blend_radius[lane]};
    cs_pair_contact_measure(contact, kind, feature, params.range, p);
    cs_pair_contact_set(contact, &params, &constants->keys, v);
    contact->contact.rate = lanes->rate[lane];
}

void cs_pair_lanes_contact(enum cs_pair_kind kind, struct cs_pair_lanes *lanes, uint32_t lane,
                           const struct cs_contact_keys *keys,
                           struct cs_pair_contact *contact) {
    lane_force(kind, lanes, (int)lane, &(struct cs_pair_lane_constants){.keys = *keys},
               contact);
}

/* out = f_k of every lane: cs_pair_contact_force */
CS_INLINE void force(enum cs_pair_kind kind, struct cs_pair_lanes *restrict lanes,
                     const struct cs_pair_lane_constants *constants) {
    const struct cs_pair_lane_constants law = *constants;
    for (int l = 0; l < CS_PAIR_LANES; l++) {
        struct cs_pair_contact contact;
        double to[4][3];
        lane_force(kind, lanes, l, &law, &contact);
        cs_pair_contact_force(&contact, law.parts, to);
        write_lane(to, l, lanes->out);
    }
}

/* out = df_k of every lane: cs_pair_contact_jvp */
CS_INLINE void jvp(enum cs_pair_kind kind, struct cs_pair_lanes *restrict lanes,
                   const struct cs_pair_lane_constants *constants) {
    const struct cs_pair_lane_constants law = *constants;
    for (int l = 0; l < CS_PAIR_LANES; l++) {
        struct cs_pair_contact contact;
        struct cs_pair_contact_motion motion;
        double to[4][3];
        lane_force(kind, lanes, l, &law, &contact);
        read_lane(lanes->p, l, motion.p);
        read_lane(lanes->v, l, motion.v);
        read_lane(lanes->dp, l, motion.dp);
        read_lane(lanes->dv, l, motion.dv);
        cs_pair_contact_jvp(&contact, law.parts, &motion, to);
        write_lane(to, l, lanes->out);
    }
}

/* out = row sums of block norms: stiffness K |g_k| sum |g_j| and damping |w_k| sum |w_j| times
 * the largest damping of the contact point. */
CS_INLINE void find_bounds(enum cs_pair_kind kind, struct cs_pair_lanes *restrict lanes,
                           const struct cs_pair_lane_constants *constants) {
    const struct cs_pair_lane_constants law = *constants;
    for (int l = 0; l < CS_PAIR_LANES; l++) {
        struct cs_pair_contact contact;
        double stiffness[4], damping[4];
        lane_force(kind, lanes, l, &law, &contact);
        cs_pair_contact_bound(&contact, stiffness, damping);
        CS_UNROLLED
        for (int k = 0; k < 4; k++)
            lanes->out[k][0][l] = stiffness[k];
        CS_UNROLLED
        for (int k = 0; k < 4; k++)
            lanes->out[k][1][l] = damping[k];
    }
}

/* the parameters of all three */
#define LAW                                                                                    \
    (struct cs_pair_lanes *restrict lanes, const struct cs_pair_lane_constants *constants),    \
        (lanes, constants)
#define KERNEL(...) CS_PAIR_KERNEL(__VA_ARGS__)
KERNEL(extern, cs_pair_lanes_force, force, LAW)
KERNEL(extern, cs_pair_lanes_jvp, jvp, LAW)
KERNEL(extern, cs_pair_lanes_bound, find_bounds, LAW)

/* Stores the terms of one pair by the differences u, v, w; see struct cs_pair_factors. */
CS_INLINE void write_factors(enum cs_pair_kind kind, double g[4][3],
                             const struct cs_pair_matrix_terms *terms, int lane,
                             struct cs_pair_factors *factors) {
    double weight[3];
    cs_pair_distance_from_points(kind, terms->weight, weight);
    factors->weight[0][lane] = weight[0];
    factors->weight[1][lane] = weight[1];
    factors->gradient_weight[lane] = terms->gradient_weight;
    CS_UNROLLED
    for (int e = 0; e < 6; e++)
        factors->block[e][lane] = terms->block[e];
    CS_UNROLLED
    for (int c = 0; c < 3; c++) {
        const double four[4] = {g[0][c], g[1][c], g[2][c], g[3][c]};
        double by[3];
        cs_pair_distance_from_points(kind, four, by);
        CS_UNROLLED
        for (int k = 0; k < 3; k++)
            factors->g[k][c][lane] = by[k];
    }
}

/* Matrix factors of all lanes. The barrier's curvature uses psd_stiffness, whose weight is
 * never negative; B uses k. `bound` must be a constant, or the loop would have a branch. */
CS_INLINE void share_bound(enum cs_pair_kind kind, struct cs_pair_lanes *restrict lanes,
                           struct cs_contact_keys keys, struct cs_matrix matrix,
                           struct cs_pair_factors *restrict factors) {
    const struct cs_pair_lane_constants constants = {.keys = keys};
    for (int l = 0; l < CS_PAIR_LANES; l++) {
        struct cs_pair_contact contact;
        struct cs_pair_matrix_terms terms;
        lane_force(kind, lanes, l, &constants, &contact);
        cs_pair_contact_matrix(&contact, &matrix, &terms);
        terms.gradient_weight = -matrix.ck * cs_barrier_at(contact.contact.d, lanes->range[l],
                                                           lanes->psd_stiffness[l])
                                                 .stiffness;
        write_factors(kind, contact.g, &terms, l, factors);
    }
}

CS_INLINE void share_matrix(enum cs_pair_kind kind, struct cs_pair_lanes *restrict lanes,
                            const struct cs_contact_keys *keys, const struct cs_matrix *matrix,
                            struct cs_pair_factors *restrict factors) {
    const struct cs_matrix definite = {.cd = matrix->cd, .ck = matrix->ck, .psd = true};
    struct cs_matrix bound = definite;
    struct cs_contact_keys lossless = *keys;
    bound.bound = true;
    lossless.loss = 0;
    if (matrix->bound)
        share_bound(kind, lanes, *keys, bound, factors);
    else if (keys->loss > 0)
        share_bound(kind, lanes, *keys, definite, factors);
    else
        share_bound(kind, lanes, lossless, definite, factors);
}

CS_PAIR_KERNEL(extern, cs_pair_lanes_matrix, share_matrix,
               (struct cs_pair_lanes *restrict lanes, const struct cs_contact_keys *keys,
                const struct cs_matrix *matrix, struct cs_pair_factors *restrict factors),
               (lanes, keys, matrix, factors))

/* out = B v for the symmetric block of lane l */
CS_INLINE void lane_tangent(const struct cs_pair_factors *factors, int l, const double v[3],
                            double out[3]) {
    const double xx = factors->block[0][l], xy = factors->block[1][l],
                 xz = factors->block[2][l], yy = factors->block[3][l],
                 yz = factors->block[4][l], zz = factors->block[5][l];
    out[0] = xx * v[0] + xy * v[1] + xz * v[2];
    out[1] = xy * v[0] + yy * v[1] + yz * v[2];
    out[2] = xz * v[0] + yz * v[1] + zz * v[2];
}

/* Product of P and the points in p, lane by lane, by the differences: with D the 3 x 4 matrix
 * of the differences, P = D^T (c g g^T + (w w^T) x B) D for g and w by u, v, w.
 * cs_pair_distance_differences applies D, and cs_pair_distance_to_points applies D^T. */
CS_INLINE void multiply(enum cs_pair_kind kind, struct cs_pair_factors *restrict factors,
                        double p[restrict 4][3][CS_PAIR_LANES]) {
    for (int l = 0; l < CS_PAIR_LANES; l++) {
        double at[4][3], d[3][3], v[3], rub[3], along = 0;
        read_lane(p, l, at);
        cs_pair_distance_differences(kind, at, d[0], d[1], d[2]);
        const double weight[3] = {factors->weight[0][l], factors->weight[1][l], 1};
        CS_UNROLLED
        for (int c = 0; c < 3; c++) {
            v[c] = weight[0] * d[0][c] + weight[1] * d[1][c] + d[2][c];
            along += factors->g[0][c][l] * d[0][c] + factors->g[1][c][l] * d[1][c] +
                     factors->g[2][c][l] * d[2][c];
        }
        along *= factors->gradient_weight[l];
        lane_tangent(factors, l, v, rub);
        CS_UNROLLED
        for (int c = 0; c < 3; c++) {
            double four[4];
            cs_pair_distance_to_points(kind, along * factors->g[0][c][l] + weight[0] * rub[c],
                                       along * factors->g[1][c][l] + weight[1] * rub[c],
                                       along * factors->g[2][c][l] + rub[c], four);
            CS_UNROLLED
            for (int k = 0; k < 4; k++)
                p[k][c][l] = four[k];
        }
    }
}

/* Converts the factors of one lane from differences to points by D^T. */
CS_INLINE void read_factors(enum cs_pair_kind kind, const struct cs_pair_factors *factors,
                            int lane, double g[4][3], struct cs_pair_matrix_terms *terms) {
    const double(*by)[3][CS_PAIR_LANES] = factors->g;
    terms->gradient_weight = factors->gradient_weight[lane];
    CS_UNROLLED
    for (int e = 0; e < 6; e++)
        terms->block[e] = factors->block[e][lane];
    cs_pair_distance_to_points(kind, factors->weight[0][lane], factors->weight[1][lane], 1,
                               terms->weight);
    CS_UNROLLED
    for (int c = 0; c < 3; c++) {
        double four[4];
        cs_pair_distance_to_points(kind, by[0][c][lane], by[1][c][lane], by[2][c][lane], four);
        CS_UNROLLED
        for (int k = 0; k < 4; k++)
            g[k][c] = four[k];
    }
}

void cs_pair_factors_read(enum cs_pair_kind kind, const struct cs_pair_factors *factors,
                          int lane, double g[4][3], struct cs_pair_matrix_terms *terms) {
    read_factors(kind, factors, lane, g, terms);
}

/* growth_k = (sum_j size_j) / size_k, by which the diagonal blocks must grow to bound the whole
 * matrix of the pair. By Cauchy's inequality for any numbers a_j = g_j.p_j,
 *
 *   (sum a_j)^2 = (sum sqrt(size_j) a_j / sqrt(size_j))^2 <= (sum size_j) sum a_j^2 / size_j
 *
 * so that c g g^T <= diag(growth_k c g_k g_k^T) for c >= 0 and size_j = |g_j|, and (w w^T) x B
 * <= diag(growth_k w_k^2 B) for B >= 0 and size_j = |w_j|. A point with size 0 has a zero
 * block, and any growth serves. */
CS_INLINE void find_growth(const double size[4], double growth[4]) {
    const double sum = size[0] + size[1] + size[2] + size[3];
    CS_UNROLLED
    for (int k = 0; k < 4; k++)
        growth[k] = size[k] > 0 ? sum / size[k] : 1;
}

/* The six numbers of one diagonal block, written out: an inner loop would keep the loop over
 * lanes from being vectorised. */
CS_INLINE void write_own(const double g[3], double along, double rub,
                         const struct cs_pair_matrix_terms *terms, int l,
                         double own[6][CS_PAIR_LANES]) {
    own[0][l] = along * (g[0] * g[0]) + rub * terms->block[0];
    own[1][l] = along * (g[0] * g[1]) + rub * terms->block[1];
    own[2][l] = along * (g[0] * g[2]) + rub * terms->block[2];
    own[3][l] = along * (g[1] * g[1]) + rub * terms->block[3];
    own[4][l] = along * (g[1] * g[2]) + rub * terms->block[4];
    own[5][l] = along * (g[2] * g[2]) + rub * terms->block[5];
}

/* Diagonal blocks of all lanes, times find_growth if `alone` is true. */
CS_INLINE void diagonal(enum cs_pair_kind kind, struct cs_pair_factors *restrict factors,
                        bool alone, double own[restrict 4][6][CS_PAIR_LANES]) {
    for (int l = 0; l < CS_PAIR_LANES; l++) {
        double g[4][3], size[4], weight[4], along[4], rub[4];
        struct cs_pair_matrix_terms terms;
        read_factors(kind, factors, l, g, &terms);
        CS_UNROLLED
        for (int k = 0; k < 4; k++) {
            size[k] = sqrt(cs_vec3_dot(g[k], g[k]));
            weight[k] = fabs(terms.weight[k]);
        }
        find_growth(size, along);
        find_growth(weight, rub);
        CS_UNROLLED
        for (int k = 0; k < 4; k++)
            write_own(g[k], terms.gradient_weight * (alone ? along[k] : 1),
                      weight[k] * weight[k] * (alone ? rub[k] : 1), &terms, l, own[k]);
    }
}

/* The same with `alone` as a constant: roots and quotients of find_growth take most of it. */
CS_INLINE void diagonal_by(enum cs_pair_kind kind, struct cs_pair_factors *restrict factors,
                           bool alone, double own[restrict 4][6][CS_PAIR_LANES]) {
    if (alone)
        diagonal(kind, factors, true, own);
    else
        diagonal(kind, factors, false, own);
}

CS_PAIR_KERNEL(extern, cs_pair_lanes_multiply, multiply,
               (struct cs_pair_factors *restrict factors,
                double p[restrict 4][3][CS_PAIR_LANES]),
               (factors, p))
CS_PAIR_KERNEL(extern, cs_pair_lanes_diagonal, diagonal_by,
               (struct cs_pair_factors *restrict factors, bool alone,
                double own[restrict 4][6][CS_PAIR_LANES]),
               (factors, alone, own))

/* Adds friction by its chord to the factors of pairs, eight at a time, as one loop over lanes.
 * The factors have the weights of the contact points already: with them come the vector
 * between these points, its direction n, and their relative velocity and acceleration. */

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
        at.contacts.end_force = at.contacts.force;
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
