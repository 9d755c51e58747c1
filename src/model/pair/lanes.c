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

CS_INLINE void write_share(const struct cs_pair_share *share, int lane,
                           struct cs_pair_factors *factors) {
    factors->along[lane] = share->along;
    CS_UNROLLED
    for (int k = 0; k < 4; k++)
        factors->weight[k][lane] = share->weight[k];
    CS_UNROLLED
    for (int e = 0; e < 6; e++)
        factors->of[e][lane] = share->of[e];
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
        write_lane(g, l, factors->g);
        write_share(&share, l, factors);
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

CS_INLINE void multiply(double g[4][3], const struct cs_pair_share *share, double p[4][3],
                        double by[4][3]) {
    const double *s = share->of;
    double along = 0, v[3] = {0};
    CS_UNROLLED
    for (int k = 0; k < 4; k++) {
        along += cs_vec3_dot(g[k], p[k]);
        CS_UNROLLED
        for (int c = 0; c < 3; c++)
            v[c] += share->weight[k] * p[k][c];
    }
    const double rub[3] = {s[0] * v[0] + s[1] * v[1] + s[2] * v[2],
                           s[1] * v[0] + s[3] * v[1] + s[4] * v[2],
                           s[2] * v[0] + s[4] * v[1] + s[5] * v[2]};
    CS_UNROLLED
    for (int k = 0; k < 4; k++) {
        double b[6] = {0};
        cs_pair_add_own(g[k], share->weight[k], share, b);
        const double own[3] = {b[0] * p[k][0] + b[1] * p[k][1] + b[2] * p[k][2],
                               b[1] * p[k][0] + b[3] * p[k][1] + b[4] * p[k][2],
                               b[2] * p[k][0] + b[4] * p[k][1] + b[5] * p[k][2]};
        CS_UNROLLED
        for (int c = 0; c < 3; c++)
            by[k][c] = share->along * along * g[k][c] + share->weight[k] * rub[c] - own[c];
    }
}

CS_INLINE void read_share(const struct cs_pair_factors *factors, int lane,
                          struct cs_pair_share *share) {
    share->along = factors->along[lane];
    CS_UNROLLED
    for (int k = 0; k < 4; k++)
        share->weight[k] = factors->weight[k][lane];
    CS_UNROLLED
    for (int e = 0; e < 6; e++)
        share->of[e] = factors->of[e][lane];
}

CS_CLONES void cs_pair_lanes_multiply(struct cs_pair_factors *restrict factors,
                                      double p[restrict 4][3][CS_PAIR_LANES]) {
    for (int l = 0; l < CS_PAIR_LANES; l++) {
        double at[4][3], g[4][3], by[4][3];
        struct cs_pair_share share;
        read_share(factors, l, &share);
        read_lane(factors->g, l, g);
        read_lane(p, l, at);
        multiply(g, &share, at, by);
        write_lane(by, l, p);
    }
}
