/* Elastic forces along the gradient of the distance; what rubs acts between the two contact
 * points, as on a point that touches an obstacle. */
#include "model/pair/reaction.h"

#include <string.h>

void cs_reaction_set(struct cs_reaction *reaction, const struct cs_meeting *meeting,
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
static struct cs_touch_parts rubbing_of(struct cs_touch_parts parts) {
    return (struct cs_touch_parts){.elastic = 0, .rubbing = parts.rubbing};
}

static bool rubs(const struct cs_touch *touch, struct cs_touch_parts parts) {
    return parts.rubbing * (touch->mu + touch->tau) > 0;
}

void cs_reaction_force(const struct cs_reaction *reaction, struct cs_touch_parts parts,
                       double f[4][3]) {
    const struct cs_touch *touch = &reaction->touch;
    const double push = parts.elastic * cs_law_at(touch->d, touch->range, touch->k).force;
    double rub[3] = {0};
    if (rubs(touch, parts))
        cs_touch_force(touch, rubbing_of(parts), rub);
    for (int k = 0; k < 4; k++)
        for (int c = 0; c < 3; c++)
            f[k][c] = push * reaction->g[k][c] + reaction->weight[k] * rub[c];
}

void cs_reaction_jvp(const struct cs_reaction *reaction, struct cs_touch_parts parts,
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
    if (rubs(touch, parts)) {
        cs_touch_force(touch, rubbing_of(parts), rub);
        cs_touch_jvp(touch, rubbing_of(parts), &point, drub);
    }
    const struct cs_law law = cs_law_at(touch->d, touch->range, touch->k);
    const double push = parts.elastic * law.force;
    const double dpush = -parts.elastic * law.stiffness * along;
    for (int k = 0; k < 4; k++)
        for (int c = 0; c < 3; c++)
            df[k][c] =
                dpush * reaction->g[k][c] + push * dg[k][c] + dw[k] * rub[c] + w[k] * drub[c];
}

void cs_reaction_matrix(const struct cs_reaction *reaction, const struct cs_matrix *matrix,
                        struct cs_pair *pair) {
    const struct cs_touch *touch = &reaction->touch;
    const struct cs_law law = cs_law_at(touch->d, touch->range, touch->k);
    // the law's own slope has another gradient than the touch
    struct cs_matrix rubbing = *matrix;
    rubbing.ck = 0;
    pair->along = -matrix->ck * law.stiffness;
    memcpy(pair->to, reaction->g, sizeof pair->to);
    memcpy(pair->share, reaction->weight, sizeof pair->share);
    memset(pair->of, 0, sizeof pair->of);
    cs_touch_add_block(touch, &rubbing, pair->of);
}

/* column by column; the half above the diagonal is taken for both, so that it is symmetric */
void cs_reaction_turn(const struct cs_reaction *reaction, const struct cs_matrix *matrix,
                      struct cs_pair_turn *turn) {
    const struct cs_touch *touch = &reaction->touch;
    const double push = matrix->ck * cs_law_at(touch->d, touch->range, touch->k).force;
    for (int j = 0; j < 12; j++) {
        double unit[4][3] = {{0}}, column[4][3], dw[4];
        unit[j / 3][j % 3] = 1;
        cs_stencil_tangent(&reaction->stencil, unit, column, dw);
        for (int i = 0; i <= j; i++)
            turn->of[i][j] = turn->of[j][i] = push * column[i / 3][i % 3];
    }
}

void cs_reaction_bound(const struct cs_reaction *reaction, double stiffness[4],
                       double damping[4]) {
    double length[4], sum = 0, shares = 0, own, rub;
    cs_touch_bound(&reaction->touch, &own, &rub);
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
