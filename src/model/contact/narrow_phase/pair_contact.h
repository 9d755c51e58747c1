/* pair_contact.h - force, Jacobian product, matrix and bounds of one pair in range on its four
 * particles. Formulas: contact_pairs.h and point_contact.h. */
#ifndef CS_NARROW_PHASE_PAIR_CONTACT_H
#define CS_NARROW_PHASE_PAIR_CONTACT_H

#include "model/contact/body_pair_params.h"
#include "model/contact/narrow_phase/mesh_feature.h"
#include "model/contact/point_contact.h"
#include "scene/contact_keys.h"

/* Terms of a pair's matrix P = c g g^T + (w w^T) x B besides the gradient g. */
struct cs_pair_matrix_terms {
    /* w of the four points */
    double weight[4];
    /* c = -ck K */
    double gradient_weight;
    /* B: xx, xy, xz, yy, yz, zz */
    double block[6];
};

/* One pair at one state. Edge-edge pairs use `distance`, features of triangles use `feature`.
 */
struct cs_pair_contact {
    enum cs_pair_kind kind;
    struct cs_pair_distance distance;
    struct cs_mesh_feature feature;
    /* both contact points as a point and a surface: g = n, v = sum w_k v_k */
    struct cs_point_contact contact;
    double g[4][3], weight[4];
};

/* Sets the distance, its gradient and the weights by the four points p. range: of edges, in m.
 */
CS_INLINE void cs_pair_contact_measure(struct cs_pair_contact *contact, enum cs_pair_kind kind,
                                       struct cs_feature_kind feature, double range,
                                       double p[4][3]) {
    contact->kind = kind;
    if (kind == CS_PAIR_EDGE_EDGE) {
        cs_pair_distance_set(&contact->distance, range, p);
        cs_pair_distance_gradient(&contact->distance, contact->g);
        cs_pair_distance_weights(&contact->distance, contact->weight);
    } else {
        cs_mesh_feature_set(&contact->feature, feature, p);
        cs_mesh_feature_to_points(contact->feature.g, contact->g);
        cs_mesh_feature_weights(&contact->feature, contact->weight);
    }
}

/* m, range of the force of edges, or of features. */
CS_INLINE double cs_pair_contact_range(const struct cs_body_pair_params *params, bool edges) {
    return edges ? cs_body_pair_params_range(params, true)
                 : CS_FEATURE_RANGE_RATIO * params->range;
}

/* As cs_pair_contact_measure for a pair as a whole, by which steps and starts are judged: a
 * point and a triangle have the feature that is nearest. range: that of the force. Returns the
 * distance in m. */
CS_INLINE double cs_pair_contact_measure_whole(struct cs_pair_contact *contact,
                                               enum cs_pair_kind kind, double range,
                                               double p[4][3]) {
    const double e = CS_FEATURE_BLEND_RADIUS / CS_FEATURE_RANGE_RATIO * range;
    struct cs_feature_kind feature = {0, 0, e};
    double to[4][3];
    if (kind == CS_PAIR_EDGE_EDGE) {
        cs_pair_contact_measure(contact, kind, feature, range, p);
        return contact->distance.d;
    }
    const double edge = cs_mesh_feature_nearest_edge(p), back = edge > 0.5 ? 3 - edge : 0;
    for (int c = 0; c < 3; c++) {
        double x[4] = {p[0][c], p[1][c], p[2][c], p[3][c]};
        cs_mesh_feature_rotate(edge, x);
        for (int k = 0; k < 4; k++)
            to[k][c] = x[k];
    }
    feature = cs_mesh_feature_nearest_form(e, to);
    cs_pair_contact_measure(contact, kind, feature, range, to);
    for (int c = 0; c < 3; c++) {
        double g[4] = {contact->g[0][c], contact->g[1][c], contact->g[2][c], contact->g[3][c]};
        cs_mesh_feature_rotate(back, g);
        for (int k = 0; k < 4; k++)
            contact->g[k][c] = g[k];
    }
    cs_mesh_feature_rotate(back, contact->weight);
    return contact->feature.d;
}

/* Sets `contact` after the measurement; v (4,3) velocities in m/s. The vector between the
 * contact points has direction n and length l, so the Hessian of its length is (I - n n^T)/l.
 */
CS_INLINE void cs_pair_contact_set(struct cs_pair_contact *contact,
                                   const struct cs_body_pair_params *params,
                                   const struct cs_contact_keys *keys, double v[4][3]) {
    const bool edges = contact->kind == CS_PAIR_EDGE_EDGE;
    const double *n = edges ? contact->distance.n : contact->feature.n;
    const double length = edges ? contact->distance.d : contact->feature.length;
    contact->contact = (struct cs_point_contact){
        .d = edges ? contact->distance.d : contact->feature.d,
        .range = params->range,
        .g = {n[0], n[1], n[2]},
        .h = {(1 - n[0] * n[0]) / length, -n[0] * n[1] / length, -n[0] * n[2] / length,
              (1 - n[1] * n[1]) / length, -n[1] * n[2] / length, (1 - n[2] * n[2]) / length},
        .k = params->k,
        .friction = params->friction,
        .friction_speed = keys->friction_speed,
        .damping = keys->damping,
        .loss = keys->loss};
    for (int k = 0; k < 4; k++)
        for (int c = 0; c < 3; c++)
            contact->contact.v[c] += contact->weight[k] * v[k][c];
}

/* Returns whether friction or damping act and are wanted. */
CS_INLINE bool cs_pair_contact_has_friction(const struct cs_point_contact *contact,
                                            struct cs_contact_force_parts parts) {
    return parts.friction * (contact->friction + contact->damping + contact->loss) > 0;
}

/* f_k = F g_k + w_k R in N, with R friction and damping of the contact points. */
CS_INLINE void cs_pair_contact_force(const struct cs_pair_contact *pair,
                                     struct cs_contact_force_parts parts, double f[4][3]) {
    const struct cs_point_contact *contact = &pair->contact;
    const double push =
        parts.elastic * cs_barrier_at(contact->d, contact->range, contact->k).force;
    double rub[3] = {0};
    // the elastic force acts along g, not along n
    parts.elastic = 0;
    if (cs_pair_contact_has_friction(contact, parts))
        cs_point_contact_force(contact, parts, rub);
    for (int k = 0; k < 4; k++)
        for (int c = 0; c < 3; c++)
            f[k][c] = push * pair->g[k][c] + pair->weight[k] * rub[c];
}

/* State and direction of a Jacobian product. */
struct cs_pair_contact_motion {
    double p[4][3], v[4][3], dp[4][3], dv[4][3];
};
/* dg = H dp and dw = change of the weights, by the tangent of the distance in use. */
CS_INLINE void cs_pair_contact_tangent(const struct cs_pair_contact *contact, double dp[4][3],
                                       double dg[4][3], double dw[4]) {
    if (contact->kind == CS_PAIR_EDGE_EDGE)
        cs_pair_distance_tangent(&contact->distance, dp, dg, dw);
    else
        cs_mesh_feature_tangent(&contact->feature, dp, dg, dw);
}

/* df_k = -K dd g_k + F (H dp)_k + dw_k R + w_k dR, exact. The relative move of the contact
 * points includes the change of the weights: dp = sum dw_k p_k + w_k dp_k. */
CS_INLINE void cs_pair_contact_jvp(const struct cs_pair_contact *pair,
                                   struct cs_contact_force_parts parts,
                                   struct cs_pair_contact_motion *motion, double df[4][3]) {
    const struct cs_point_contact *contact = &pair->contact;
    const double *w = pair->weight;
    double dg[4][3], dw[4], along = 0, rub[3] = {0}, drub[3] = {0};
    struct cs_point_contact_motion point = {0};
    cs_pair_contact_tangent(pair, motion->dp, dg, dw);
    for (int k = 0; k < 4; k++) {
        along += cs_vec3_dot(pair->g[k], motion->dp[k]);
        for (int c = 0; c < 3; c++) {
            point.dp[c] += dw[k] * motion->p[k][c] + w[k] * motion->dp[k][c];
            point.dv[c] += dw[k] * motion->v[k][c] + w[k] * motion->dv[k][c];
        }
    }
    // a bent distance changes otherwise than that of the contact points
    point.extra_dd = along - cs_vec3_dot(contact->g, point.dp);
    const struct cs_barrier barrier = cs_barrier_at(contact->d, contact->range, contact->k);
    const double push = parts.elastic * barrier.force;
    const double dpush = -parts.elastic * barrier.stiffness * along;
    parts.elastic = 0;
    if (cs_pair_contact_has_friction(contact, parts)) {
        cs_point_contact_force(contact, parts, rub);
        cs_point_contact_jvp(contact, parts, &point, drub);
    }
    for (int k = 0; k < 4; k++)
        for (int c = 0; c < 3; c++)
            df[k][c] =
                dpush * pair->g[k][c] + push * dg[k][c] + dw[k] * rub[c] + w[k] * drub[c];
}

/* Weights and block of the matrix terms. ck F H is not among them (pair_matrix.h), nor is the
 * change of the weights. */
CS_INLINE void cs_pair_contact_matrix(const struct cs_pair_contact *contact,
                                      const struct cs_matrix *matrix,
                                      struct cs_pair_matrix_terms *terms) {
    // the law's own slope has another gradient than the contact
    struct cs_matrix rubbing = *matrix;
    rubbing.ck = 0;
    for (int k = 0; k < 4; k++)
        terms->weight[k] = contact->weight[k];
    for (int e = 0; e < 6; e++)
        terms->block[e] = 0;
    cs_point_contact_add_block(&contact->contact, &rubbing, terms->block);
}

/* Gershgorin bounds in N/m and N s/m. The block of df/dx at points k and j is -K g_k g_j^T, of
 * norm K |g_k| |g_j|, so the row of k sums to K |g_k| sum |g_j|; likewise |w_k| sum |w_j| for
 * damping. F H is left out. */
CS_INLINE void cs_pair_contact_bound(const struct cs_pair_contact *pair, double stiffness[4],
                                     double damping[4]) {
    double length[4], sum = 0, shares = 0, own, rub;
    // What is subtracted counts with its absolute value.
    struct cs_point_contact contact = pair->contact;
    contact.k = fabs(contact.k);
    cs_point_contact_bound(&contact, &own, &rub);
    for (int k = 0; k < 4; k++) {
        const double w = pair->weight[k];
        length[k] = sqrt(cs_vec3_dot(pair->g[k], pair->g[k]));
        sum += length[k];
        shares += w < 0 ? -w : w;
    }
    for (int k = 0; k < 4; k++) {
        const double w = pair->weight[k];
        stiffness[k] = own * length[k] * sum;
        damping[k] = rub * (w < 0 ? -w : w) * shares;
    }
}

#endif
