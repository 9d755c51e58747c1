/* lanes.h - eight pairs at a time: each lane is one pair's own arithmetic, so that the bits are
 * those of one pair alone. */
#ifndef CS_PAIR_LANES_H
#define CS_PAIR_LANES_H

#include "model/pair/reaction.h"

enum { CS_PAIR_LANES = 8 };

/* Pairs of one kind at a state. Lanes from n on have numbers that mean nothing. */
struct cs_pair_lanes {
    double p[4][3][CS_PAIR_LANES], v[4][3][CS_PAIR_LANES]; /* m, m/s */
    double range[CS_PAIR_LANES], k[CS_PAIR_LANES], mu[CS_PAIR_LANES];
    double dp[4][3][CS_PAIR_LANES], dv[4][3][CS_PAIR_LANES]; /* of a change */
    double d[CS_PAIR_LANES];                                 /* m, the smooth distance */
    double to[4][3][CS_PAIR_LANES];                          /* as in struct cs_pair */
    uint32_t at[CS_PAIR_LANES][4];
    double rim[CS_PAIR_LANES], off[CS_PAIR_LANES], bend[CS_PAIR_LANES]; /* form of a facet */
    double stiff[CS_PAIR_LANES]; /* N/m, of the law in a matrix */
    uint32_t n;
};

/* Sets d from p. */
void cs_pair_lanes_measure(enum cs_stencil_kind kind, struct cs_pair_lanes *lanes);

/* What is the same for all lanes. */
struct cs_pair_law {
    struct cs_contact_keys keys;
    struct cs_touch_parts parts;
};

/* Sets `to` to the forces, or to their change: of edges, or of facets of triangles. */
void cs_pair_lanes_push(enum cs_stencil_kind kind, struct cs_pair_lanes *lanes,
                        const struct cs_pair_law *law);
void cs_pair_lanes_change(enum cs_stencil_kind kind, struct cs_pair_lanes *lanes,
                          const struct cs_pair_law *law);

/* What a matrix has of as many pairs. */
struct cs_pair_factors {
    double g[4][3][CS_PAIR_LANES], weight[4][CS_PAIR_LANES];
    double along[CS_PAIR_LANES], of[6][CS_PAIR_LANES];
    uint32_t at[CS_PAIR_LANES][4];
};

/* Sets all of them but `at`, as cs_reaction_matrix of a matrix that is psd. */
void cs_pair_lanes_matrix(enum cs_stencil_kind kind, struct cs_pair_lanes *lanes,
                          const struct cs_contact_keys *keys, const struct cs_matrix *matrix,
                          struct cs_pair_factors *factors);

/* In place of p: the share of each pair times p, less what the diagonal blocks of the solver
 * have of it. How gradients turn is not in it. */
void cs_pair_lanes_multiply(struct cs_pair_factors *factors, double p[4][3][CS_PAIR_LANES]);

/* block (6) += that of a corner with gradient g and weight w with itself. */
CS_INLINE void cs_pair_add_own(const double g[3], double w, const struct cs_pair_share *share,
                               double block[6]) {
    const double along = share->along, rub = w * w;
    // line by line: a loop in the loop over lanes would keep that from being vectors
    block[0] += along * (g[0] * g[0]) + rub * share->of[0];
    block[1] += along * (g[0] * g[1]) + rub * share->of[1];
    block[2] += along * (g[0] * g[2]) + rub * share->of[2];
    block[3] += along * (g[1] * g[1]) + rub * share->of[3];
    block[4] += along * (g[1] * g[2]) + rub * share->of[4];
    block[5] += along * (g[2] * g[2]) + rub * share->of[5];
}

#endif
