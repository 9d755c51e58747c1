/* reaction.h - what one pair in range does to its four particles. */
#ifndef CS_PAIR_REACTION_H
#define CS_PAIR_REACTION_H

#include "model/contact/touch.h"
#include "model/pair/meeting.h"
#include "model/pair/pair_set.h"
#include "model/pair/stencil_tangent.h"

/* What a pair has in a matrix beside its gradient, as in struct cs_pair. */
struct cs_pair_share {
    double weight[4]; /* w */
    double along;
    double of[6]; /* xx, xy, xz, yy, yz, zz */
};

/* One pair at one state, found in range. */
struct cs_reaction {
    struct cs_stencil stencil;
    struct cs_touch touch; /* of the contact points: g = n, v = V */
    double g[4][3], weight[4];
};

/* Sets everything of a reaction whose stencil is set. v (4) velocities of its particles. */
CS_INLINE void cs_reaction_set(struct cs_reaction *reaction, const struct cs_meeting *meeting,
                               const struct cs_contact_keys *keys, double v[4][3]) {
    const struct cs_stencil *s = &reaction->stencil;
    const double *n = s->n;
    cs_stencil_gradient(s, reaction->g);
    cs_stencil_weights(s, reaction->weight);
    reaction->touch = (struct cs_touch){.d = s->d,
                                        .range = meeting->range,
                                        .g = {n[0], n[1], n[2]},
                                        .h = {(1 - n[0] * n[0]) / s->d, -n[0] * n[1] / s->d,
                                              -n[0] * n[2] / s->d, (1 - n[1] * n[1]) / s->d,
                                              -n[1] * n[2] / s->d, (1 - n[2] * n[2]) / s->d},
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
CS_INLINE void cs_reaction_jvp(const struct cs_reaction *reaction, struct cs_touch_parts parts,
                               struct cs_reaction_move *move, double df[4][3]) {
    const struct cs_touch *touch = &reaction->touch;
    const double *w = reaction->weight;
    double dg[4][3], dw[4], along = 0, rub[3] = {0}, drub[3] = {0};
    struct cs_touch_move point = {0};
    cs_stencil_tangent(&reaction->stencil, move->dp, dg, dw);
    for (int k = 0; k < 4; k++) {
        along += cs_vec3_dot(reaction->g[k], move->dp[k]);
        for (int c = 0; c < 3; c++) {
            point.dp[c] += dw[k] * move->p[k][c] + w[k] * move->dp[k][c];
            point.dv[c] += dw[k] * move->v[k][c] + w[k] * move->dv[k][c];
        }
    }
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
void cs_reaction_bound(const struct cs_reaction *reaction, double stiffness[4],
                       double damping[4]);

#endif
