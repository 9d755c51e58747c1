/* Loops over lanes that hold a whole pair each, which compilers turn into vectors. */
#include "base/vectorise.h"

#include "model/pair/lanes.h"

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

CS_INLINE void measure(enum cs_stencil_kind kind, struct cs_pair_lanes *restrict lanes) {
    for (int l = 0; l < CS_PAIR_LANES; l++) {
        double p[4][3];
        struct cs_stencil stencil;
        read_lane(lanes->p, l, p);
        cs_stencil_set(&stencil, kind, p);
        lanes->d[l] = stencil.d;
    }
}

CS_CLONES static void measure_triangles(struct cs_pair_lanes *restrict lanes) {
    measure(CS_STENCIL_TRIANGLE, lanes);
}

CS_CLONES static void measure_edges(struct cs_pair_lanes *restrict lanes) {
    measure(CS_STENCIL_EDGES, lanes);
}

void cs_pair_lanes_measure(enum cs_stencil_kind kind, struct cs_pair_lanes *lanes) {
    if (kind == CS_STENCIL_EDGES)
        measure_edges(lanes);
    else
        measure_triangles(lanes);
}

CS_INLINE void react(enum cs_stencil_kind kind, struct cs_pair_lanes *lanes, int lane,
                     const struct cs_pair_law *law, struct cs_reaction *reaction) {
    double p[4][3], v[4][3];
    const struct cs_meeting meeting = {lanes->range[lane], lanes->k[lane], lanes->mu[lane]};
    read_lane(lanes->p, lane, p);
    read_lane(lanes->v, lane, v);
    const struct cs_facet_form form = {lanes->rim[lane], lanes->off[lane], lanes->bend[lane]};
    cs_reaction_measure(reaction, kind, form, p);
    cs_reaction_set(reaction, &meeting, &law->keys, v);
}

CS_INLINE void push(enum cs_stencil_kind kind, struct cs_pair_lanes *restrict lanes,
                    struct cs_pair_law law) {
    for (int l = 0; l < CS_PAIR_LANES; l++) {
        struct cs_reaction reaction;
        double to[4][3];
        react(kind, lanes, l, &law, &reaction);
        cs_reaction_force(&reaction, law.parts, to);
        write_lane(to, l, lanes->to);
    }
}

CS_INLINE void change(enum cs_stencil_kind kind, struct cs_pair_lanes *restrict lanes,
                      struct cs_pair_law law) {
    for (int l = 0; l < CS_PAIR_LANES; l++) {
        struct cs_reaction reaction;
        struct cs_reaction_move move;
        double to[4][3];
        react(kind, lanes, l, &law, &reaction);
        read_lane(lanes->p, l, move.p);
        read_lane(lanes->v, l, move.v);
        read_lane(lanes->dp, l, move.dp);
        read_lane(lanes->dv, l, move.dv);
        cs_reaction_jvp(&reaction, law.parts, &move, to);
        write_lane(to, l, lanes->to);
    }
}

/* a kernel for both kinds, each with clones of its own */
#define KERNEL(name)                                                                           \
    CS_CLONES static void name##_triangles(struct cs_pair_lanes *restrict lanes,               \
                                           struct cs_pair_law law) {                           \
        name(CS_STENCIL_TRIANGLE, lanes, law);                                                 \
    }                                                                                          \
    CS_CLONES static void name##_edges(struct cs_pair_lanes *restrict lanes,                   \
                                       struct cs_pair_law law) {                               \
        name(CS_STENCIL_EDGES, lanes, law);                                                    \
    }                                                                                          \
    void cs_pair_lanes_##name(enum cs_stencil_kind kind, struct cs_pair_lanes *lanes,          \
                              const struct cs_pair_law *law) {                                 \
        if (kind == CS_STENCIL_EDGES)                                                          \
            name##_edges(lanes, *law);                                                         \
        else                                                                                   \
            name##_triangles(lanes, *law);                                                     \
    }

KERNEL(push)
KERNEL(change)

CS_INLINE void find_bounds(enum cs_stencil_kind kind, struct cs_pair_lanes *restrict lanes,
                           struct cs_contact_keys keys, struct cs_pair_bounds *restrict to) {
    const struct cs_pair_law law = {.keys = keys};
    for (int l = 0; l < CS_PAIR_LANES; l++) {
        struct cs_reaction reaction;
        double stiffness[4], damping[4];
        react(kind, lanes, l, &law, &reaction);
        cs_reaction_bound(&reaction, stiffness, damping);
        CS_UNROLLED
        for (int k = 0; k < 4; k++)
            to->stiffness[k][l] = stiffness[k];
        CS_UNROLLED
        for (int k = 0; k < 4; k++)
            to->damping[k][l] = damping[k];
    }
}

CS_CLONES static void bound_triangles(struct cs_pair_lanes *restrict lanes,
                                      struct cs_contact_keys keys,
                                      struct cs_pair_bounds *restrict to) {
    find_bounds(CS_STENCIL_TRIANGLE, lanes, keys, to);
}

CS_CLONES static void bound_edges(struct cs_pair_lanes *restrict lanes,
                                  struct cs_contact_keys keys,
                                  struct cs_pair_bounds *restrict to) {
    find_bounds(CS_STENCIL_EDGES, lanes, keys, to);
}

void cs_pair_lanes_bound(enum cs_stencil_kind kind, struct cs_pair_lanes *lanes,
                         const struct cs_contact_keys *keys, struct cs_pair_bounds *bounds) {
    if (kind == CS_STENCIL_EDGES)
        bound_edges(lanes, *keys, bounds);
    else
        bound_triangles(lanes, *keys, bounds);
}

CS_INLINE void write_factors(enum cs_stencil_kind kind, double g[4][3],
                             const struct cs_pair_share *share, int lane,
                             struct cs_pair_factors *factors) {
    double weight[3];
    cs_stencil_fold(kind, share->weight, weight);
    factors->weight[0][lane] = weight[0];
    factors->weight[1][lane] = weight[1];
    factors->along[lane] = share->along;
    CS_UNROLLED
    for (int e = 0; e < 6; e++)
        factors->of[e][lane] = share->of[e];
    CS_UNROLLED
    for (int c = 0; c < 3; c++) {
        const double four[4] = {g[0][c], g[1][c], g[2][c], g[3][c]};
        double by[3];
        cs_stencil_fold(kind, four, by);
        CS_UNROLLED
        for (int k = 0; k < 3; k++)
            factors->g[k][c][lane] = by[k];
    }
}

/* a definite matrix; `bound` known to the compiler, or the loop would have a branch */
CS_INLINE void share_bound(enum cs_stencil_kind kind, struct cs_pair_lanes *restrict lanes,
                           struct cs_contact_keys keys, struct cs_matrix matrix,
                           struct cs_pair_factors *restrict factors) {
    const struct cs_pair_law law = {.keys = keys};
    for (int l = 0; l < CS_PAIR_LANES; l++) {
        struct cs_reaction reaction;
        struct cs_pair_share share;
        double g[4][3];
        react(kind, lanes, l, &law, &reaction);
        cs_reaction_matrix(&reaction, &matrix, g, &share);
        share.along = -matrix.ck *
                      cs_law_at(reaction.touch.d, lanes->range[l], lanes->stiff[l]).stiffness;
        write_factors(kind, g, &share, l, factors);
    }
}

CS_INLINE void share_matrix(enum cs_stencil_kind kind, struct cs_pair_lanes *restrict lanes,
                            struct cs_contact_keys keys, struct cs_matrix matrix,
                            struct cs_pair_factors *restrict factors) {
    const struct cs_matrix definite = {.cd = matrix.cd, .ck = matrix.ck, .psd = true};
    struct cs_matrix bound = definite;
    bound.bound = true;
    if (matrix.bound)
        share_bound(kind, lanes, keys, bound, factors);
    else
        share_bound(kind, lanes, keys, definite, factors);
}

CS_CLONES static void share_triangles(struct cs_pair_lanes *restrict lanes,
                                      struct cs_contact_keys keys, struct cs_matrix matrix,
                                      struct cs_pair_factors *restrict factors) {
    share_matrix(CS_STENCIL_TRIANGLE, lanes, keys, matrix, factors);
}

CS_CLONES static void share_edges(struct cs_pair_lanes *restrict lanes,
                                  struct cs_contact_keys keys, struct cs_matrix matrix,
                                  struct cs_pair_factors *restrict factors) {
    share_matrix(CS_STENCIL_EDGES, lanes, keys, matrix, factors);
}

void cs_pair_lanes_matrix(enum cs_stencil_kind kind, struct cs_pair_lanes *lanes,
                          const struct cs_contact_keys *keys, const struct cs_matrix *matrix,
                          struct cs_pair_factors *factors) {
    if (kind == CS_STENCIL_EDGES)
        share_edges(lanes, *keys, *matrix, factors);
    else
        share_triangles(lanes, *keys, *matrix, factors);
}

CS_INLINE void turn(const struct cs_pair_factors *factors, int l, const double v[3],
                    double out[3]) {
    const double xx = factors->of[0][l], xy = factors->of[1][l], xz = factors->of[2][l],
                 yy = factors->of[3][l], yz = factors->of[4][l], zz = factors->of[5][l];
    out[0] = xx * v[0] + xy * v[1] + xz * v[2];
    out[1] = xy * v[0] + yy * v[1] + yz * v[2];
    out[2] = xz * v[0] + yz * v[1] + zz * v[2];
}

CS_INLINE void multiply(enum cs_stencil_kind kind, struct cs_pair_factors *restrict factors,
                        double p[restrict 4][3][CS_PAIR_LANES]) {
    for (int l = 0; l < CS_PAIR_LANES; l++) {
        double at[4][3], d[3][3], v[3], rub[3], along = 0;
        read_lane(p, l, at);
        cs_stencil_differences(kind, at, d[0], d[1], d[2]);
        const double weight[3] = {factors->weight[0][l], factors->weight[1][l], 1};
        CS_UNROLLED
        for (int c = 0; c < 3; c++) {
            v[c] = weight[0] * d[0][c] + weight[1] * d[1][c] + d[2][c];
            along += factors->g[0][c][l] * d[0][c] + factors->g[1][c][l] * d[1][c] +
                     factors->g[2][c][l] * d[2][c];
        }
        along *= factors->along[l];
        turn(factors, l, v, rub);
        CS_UNROLLED
        for (int c = 0; c < 3; c++) {
            double four[4];
            cs_stencil_spread(kind, along * factors->g[0][c][l] + weight[0] * rub[c],
                              along * factors->g[1][c][l] + weight[1] * rub[c],
                              along * factors->g[2][c][l] + rub[c], four);
            CS_UNROLLED
            for (int k = 0; k < 4; k++)
                p[k][c][l] = four[k];
        }
    }
}

/* by the points */
CS_INLINE void read_factors(enum cs_stencil_kind kind, const struct cs_pair_factors *factors,
                            int lane, double g[4][3], struct cs_pair_share *share) {
    const double(*by)[3][CS_PAIR_LANES] = factors->g;
    share->along = factors->along[lane];
    CS_UNROLLED
    for (int e = 0; e < 6; e++)
        share->of[e] = factors->of[e][lane];
    cs_stencil_spread(kind, factors->weight[0][lane], factors->weight[1][lane], 1,
                      share->weight);
    CS_UNROLLED
    for (int c = 0; c < 3; c++) {
        double four[4];
        cs_stencil_spread(kind, by[0][c][lane], by[1][c][lane], by[2][c][lane], four);
        CS_UNROLLED
        for (int k = 0; k < 4; k++)
            g[k][c] = four[k];
    }
}

void cs_pair_factors_read(enum cs_stencil_kind kind, const struct cs_pair_factors *factors,
                          int lane, double g[4][3], struct cs_pair_share *share) {
    read_factors(kind, factors, lane, g, share);
}

/* by how much the blocks of the gradients, or of the weights, must grow for all together to be
 * above what the pair couples */
CS_INLINE void find_growth(const double size[4], double growth[4]) {
    const double sum = size[0] + size[1] + size[2] + size[3];
    CS_UNROLLED
    for (int k = 0; k < 4; k++)
        growth[k] = size[k] > 0 ? sum / size[k] : 1;
}

/* line by line: a loop in the loop over lanes would keep that from being vectors */
CS_INLINE void write_own(const double g[3], double along, double rub,
                         const struct cs_pair_share *share, int l,
                         double own[6][CS_PAIR_LANES]) {
    own[0][l] = along * (g[0] * g[0]) + rub * share->of[0];
    own[1][l] = along * (g[0] * g[1]) + rub * share->of[1];
    own[2][l] = along * (g[0] * g[2]) + rub * share->of[2];
    own[3][l] = along * (g[1] * g[1]) + rub * share->of[3];
    own[4][l] = along * (g[1] * g[2]) + rub * share->of[4];
    own[5][l] = along * (g[2] * g[2]) + rub * share->of[5];
}

CS_INLINE void find_own(enum cs_stencil_kind kind, struct cs_pair_factors *restrict factors,
                        bool alone, double own[restrict 4][6][CS_PAIR_LANES]) {
    for (int l = 0; l < CS_PAIR_LANES; l++) {
        double g[4][3], size[4], weight[4], along[4], rub[4];
        struct cs_pair_share share;
        read_factors(kind, factors, l, g, &share);
        CS_UNROLLED
        for (int k = 0; k < 4; k++) {
            size[k] = sqrt(cs_vec3_dot(g[k], g[k]));
            weight[k] = fabs(share.weight[k]);
        }
        find_growth(size, along);
        find_growth(weight, rub);
        CS_UNROLLED
        for (int k = 0; k < 4; k++)
            write_own(g[k], share.along * (alone ? along[k] : 1),
                      weight[k] * weight[k] * (alone ? rub[k] : 1), &share, l, own[k]);
    }
}

CS_CLONES static void multiply_triangles(struct cs_pair_factors *restrict factors,
                                         double p[restrict 4][3][CS_PAIR_LANES]) {
    multiply(CS_STENCIL_TRIANGLE, factors, p);
}

CS_CLONES static void multiply_edges(struct cs_pair_factors *restrict factors,
                                     double p[restrict 4][3][CS_PAIR_LANES]) {
    multiply(CS_STENCIL_EDGES, factors, p);
}

void cs_pair_lanes_multiply(enum cs_stencil_kind kind, struct cs_pair_factors *factors,
                            double p[4][3][CS_PAIR_LANES]) {
    if (kind == CS_STENCIL_EDGES)
        multiply_edges(factors, p);
    else
        multiply_triangles(factors, p);
}

CS_CLONES static void find_own_triangles(struct cs_pair_factors *restrict factors, bool alone,
                                         double own[restrict 4][6][CS_PAIR_LANES]) {
    if (alone)
        find_own(CS_STENCIL_TRIANGLE, factors, true, own);
    else
        find_own(CS_STENCIL_TRIANGLE, factors, false, own);
}

CS_CLONES static void find_own_edges(struct cs_pair_factors *restrict factors, bool alone,
                                     double own[restrict 4][6][CS_PAIR_LANES]) {
    if (alone)
        find_own(CS_STENCIL_EDGES, factors, true, own);
    else
        find_own(CS_STENCIL_EDGES, factors, false, own);
}

void cs_pair_lanes_own(enum cs_stencil_kind kind, struct cs_pair_factors *factors, bool alone,
                       double own[4][6][CS_PAIR_LANES]) {
    if (kind == CS_STENCIL_EDGES)
        find_own_edges(factors, alone, own);
    else
        find_own_triangles(factors, alone, own);
}
