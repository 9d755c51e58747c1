/* reaction.h - what one pair in range does to its four particles. */
#ifndef CS_PAIR_REACTION_H
#define CS_PAIR_REACTION_H

#include "model/contact/touch.h"
#include "model/pair/facet_tangent.h"
#include "model/pair/meeting.h"
#include "model/pair/pair_set.h"

/* What a pair has in a matrix beside its gradient, as in struct cs_pair. */
struct cs_pair_share {
    double weight[4]; /* w */
    double along;
    double of[6]; /* xx, xy, xz, yy, yz, zz */
};

/* One pair at one state, found in range: of edges the stencil, of a point and a triangle one
 * facet. */
struct cs_reaction {
    enum cs_stencil_kind kind;
    struct cs_stencil stencil;
    struct cs_facet facet;
    struct cs_touch touch; /* of the contact points: g = n, v = V */
    double g[4][3], weight[4];
};

/* The distance of edges, or of a facet. */
CS_INLINE void cs_reaction_measure(struct cs_reaction *reaction, enum cs_stencil_kind kind,
                                   struct cs_facet_form form, double p[4][3]) {
    reaction->kind = kind;
    if (kind == CS_STENCIL_EDGES) {
        cs_stencil_set(&reaction->stencil, kind, p);
        cs_stencil_gradient(&reaction->stencil, reaction->g);
        cs_stencil_weights(&reaction->stencil, reaction->weight);
    } else {
        cs_facet_set(&reaction->facet, form, p);
        cs_facet_spread(reaction->facet.g, reaction->g);
        cs_facet_weights(&reaction->facet, reaction->weight);
    }
}

/* Sets everything of a reaction that is measured. v (4) velocities of its particles. */
CS_INLINE void cs_reaction_set(struct cs_reaction *reaction, const struct cs_meeting *meeting,
                               const struct cs_contact_keys *keys, double v[4][3]) {
    const bool edges = reaction->kind == CS_STENCIL_EDGES;
    const double *n = edges ? reaction->stencil.n : reaction->facet.n;
    const double length = edges ? reaction->stencil.d : reaction->facet.length;
    reaction->touch = (struct cs_touch){
        .d = edges ? reaction->stencil.d : reaction->facet.d,
        .range = meeting->range,
        .g = {n[0], n[1], n[2]},
        .h = {(1 - n[0] * n[0]) / length, -n[0] * n[1] / length, -n[0] * n[2] / length,
              (1 - n[1] * n[1]) / length, -n[1] * n[2] / length, (1 - n[2] * n[2]) / length},
        .k = meeting->k,
        .mu = meeting->mu,
        .ev = keys->friction_speed,
        .tau = keys->damping};
    for (int k = 0; k < 4; k++)
        for (int c = 0; c < 3; c++)
            reaction->touch.v[c] += reaction->weight[k] * v[k][c];
}

/* what the touch alone does: the elastic part has a gradient of its own */
CS_INLINE struct cs_touch_parts cs_reaction_rubbing(struct cs_touch_parts parts) {
    return (struct cs_touch_parts){.elastic = 0, .rubbing = parts.rubbing};
}

CS_INLINE bool cs_reaction_rubs(const struct cs_touch *touch, struct cs_touch_parts parts) {
    return parts.rubbing * (touch->mu + touch->tau) > 0;
}

/* f = the forces on the four particles; the parts as in touch.h. */
CS_INLINE void cs_reaction_force(const struct cs_reaction *reaction,
                                 struct cs_touch_parts parts, double f[4][3]) {
    const struct cs_touch *touch = &reaction->touch;
    const double push = parts.elastic * cs_law_at(touch->d, touch->range, touch->k).force;
    double rub[3] = {0};
    if (cs_reaction_rubs(touch, parts))
        cs_touch_force(touch, cs_reaction_rubbing(parts), rub);
    for (int k = 0; k < 4; k++)
        for (int c = 0; c < 3; c++)
            f[k][c] = push * reaction->g[k][c] + reaction->weight[k] * rub[c];
}

/* df = their change, exact, when the particles move from p by dp and their velocities v change
 * by dv. */
struct cs_reaction_move {
    double p[4][3], v[4][3], dp[4][3], dv[4][3];
};
CS_INLINE void cs_reaction_tangent(const struct cs_reaction *reaction, double dp[4][3],
                                   double dg[4][3], double dw[4]) {
    if (reaction->kind == CS_STENCIL_EDGES)
        cs_stencil_tangent(&reaction->stencil, dp, dg, dw);
    else
        cs_facet_tangent(&reaction->facet, dp, dg, dw);
}

CS_INLINE void cs_reaction_jvp(const struct cs_reaction *reaction, struct cs_touch_parts parts,
                               struct cs_reaction_move *move, double df[4][3]) {
    const struct cs_touch *touch = &reaction->touch;
    const double *w = reaction->weight;
    double dg[4][3], dw[4], along = 0, rub[3] = {0}, drub[3] = {0};
    struct cs_touch_move point = {0};
    cs_reaction_tangent(reaction, move->dp, dg, dw);
    for (int k = 0; k < 4; k++) {
        along += cs_vec3_dot(reaction->g[k], move->dp[k]);
        for (int c = 0; c < 3; c++) {
            point.dp[c] += dw[k] * move->p[k][c] + w[k] * move->dp[k][c];
            point.dv[c] += dw[k] * move->v[k][c] + w[k] * move->dv[k][c];
        }
    }
    // a bent distance changes otherwise than that of the contact points
    point.more = along - cs_vec3_dot(touch->g, point.dp);
    if (cs_reaction_rubs(touch, parts)) {
        cs_touch_force(touch, cs_reaction_rubbing(parts), rub);
        cs_touch_jvp(touch, cs_reaction_rubbing(parts), &point, drub);
    }
    const struct cs_law law = cs_law_at(touch->d, touch->range, touch->k);
    const double push = parts.elastic * law.force;
    const double dpush = -parts.elastic * law.stiffness * along;
    for (int k = 0; k < 4; k++)
        for (int c = 0; c < 3; c++)
            df[k][c] =
                dpush * reaction->g[k][c] + push * dg[k][c] + dw[k] * rub[c] + w[k] * drub[c];
}

/* The share of a matrix, and g in to[4][3]: the law along the gradient, and friction and
 * damping with the weights as they are. How the gradient turns is not in it. */
CS_INLINE void cs_reaction_matrix(const struct cs_reaction *reaction,
                                  const struct cs_matrix *matrix, double to[4][3],
                                  struct cs_pair_share *share) {
    const struct cs_touch *touch = &reaction->touch;
    const struct cs_law law = cs_law_at(touch->d, touch->range, touch->k);
    // the law's own slope has another gradient than the touch
    struct cs_matrix rubbing = *matrix;
    rubbing.ck = 0;
    share->along = -matrix->ck * law.stiffness;
    for (int k = 0; k < 4; k++) {
        share->weight[k] = reaction->weight[k];
        for (int c = 0; c < 3; c++)
            to[k][c] = reaction->g[k][c];
    }
    for (int e = 0; e < 6; e++)
        share->of[e] = 0;
    cs_touch_add_block(touch, &rubbing, share->of);
}
/* That: ck F times the second derivative of the distance, which has both signs. */
void cs_reaction_turn(const struct cs_reaction *reaction, const struct cs_matrix *matrix,
                      struct cs_pair_turn *turn);

/* Sums of the norms of the blocks in the row of each particle: N/m and N s/m. */
CS_INLINE void cs_reaction_bound(const struct cs_reaction *reaction, double stiffness[4],
                                 double damping[4]) {
    double length[4], sum = 0, shares = 0, own, rub;
    // what is taken away bounds as what is there
    struct cs_touch touch = reaction->touch;
    touch.k = fabs(touch.k);
    cs_touch_bound(&touch, &own, &rub);
    for (int k = 0; k < 4; k++) {
        const double w = reaction->weight[k];
        length[k] = sqrt(cs_vec3_dot(reaction->g[k], reaction->g[k]));
        sum += length[k];
        shares += w < 0 ? -w : w;
    }
    for (int k = 0; k < 4; k++) {
        const double w = reaction->weight[k];
        stiffness[k] = own * length[k] * sum;
        damping[k] = rub * (w < 0 ? -w : w) * shares;
    }
}

#endif
