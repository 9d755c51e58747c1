/* Motion of surface points, and the swept-box test of pairs on all numbers of a point at once.
 */
#include "base/vectorise.h"

#include "model/contact/point_motion.h"

#include "base/vector.h"
#include "model/contact/surface_points.h"

#include <clothsim/clones.h>

/* One call of cs_point_motion_set. */
struct setting {
    const struct cs_system *system;
    const double *x0, *x1;
    struct cs_point_motion *moves;
};

static void set_some(void *arg, size_t begin, size_t end) {
    const struct setting *setting = arg;
    const size_t n = setting->system->surfaces->n_points;
    for (size_t i = begin; i < end; i++) {
        double *move = setting->moves[i].values;
        for (size_t c = 0; c < 3; c++) {
            const double from = setting->x0[c * n + i];
            move[CS_POINT_MOVE_FROM + c] = from;
            move[CS_POINT_MOVE_BY + c] = setting->x1[c * n + i] - from;
        }
        move[CS_POINT_MOVE_INVERSE_MASS] =
            cs_surface_points_inverse_mass(setting->system, (uint32_t)i);
    }
}

void cs_point_motion_set(const struct cs_system *system, const double *x0, const double *x1,
                         struct cs_point_motion *moves) {
    struct setting setting = {system, x0, x1, moves};
    cs_vector_parallel_for(system->surfaces->n_points, set_some, &setting);
}

CS_INLINE double min_of(double a, double b) {
    return a < b ? a : b;
}

CS_INLINE double max_of(double a, double b) {
    return a > b ? a : b;
}

/* 1 if the swept boxes of both primitives may come within reach. Differences of the bounds of
 * both sides are taken for positions and displacements alike; point p[1] belongs to the first
 * side of two edges, else to the triangle. */
CS_INLINE uint32_t boxes_may_overlap(bool edges, const double *restrict p[4], double reach) {
    double below[CS_POINT_MOVE_NUMBERS], above[CS_POINT_MOVE_NUMBERS];
    for (int k = 0; k < CS_POINT_MOVE_NUMBERS; k++) {
        const double a = p[0][k], b = p[1][k], c = p[2][k], d = p[3][k];
        const double low = min_of(c, d), high = max_of(c, d);
        const double least = edges ? min_of(a, b) : a, most = edges ? max_of(a, b) : a;
        below[k] = least - (edges ? high : max_of(b, high));
        above[k] = most - (edges ? low : min_of(b, low));
    }
    uint32_t meet = 1;
    for (int c = 0; c < 3; c++) {
        const double closing = below[CS_POINT_MOVE_BY + c],
                     opening = above[CS_POINT_MOVE_BY + c];
        meet &= below[c] + (closing < 0 ? closing : 0) <= reach;
        meet &= above[c] + (opening > 0 ? opening : 0) >= -reach;
    }
    return meet;
}

CS_INLINE size_t filter(bool edges, const struct cs_point_motion *restrict moves,
                        const struct cs_moving_pairs *pairs, double reach, uint32_t *out) {
    const uint32_t *of = edges ? pairs->surfaces->edges : pairs->surfaces->triangles;
    size_t n = 0;
    for (size_t k = 0; k < 2 * pairs->n; k += 2) {
        const uint32_t i = pairs->items[k], j = pairs->items[k + 1];
        const uint32_t *first = edges ? of + 2 * (size_t)i : &i;
        const uint32_t *second = of + (edges ? 2 : 3) * (size_t)j;
        const double *p[4] = {moves[first[0]].values,
                              moves[edges ? first[1] : second[0]].values,
                              moves[edges ? second[0] : second[1]].values,
                              moves[edges ? second[1] : second[2]].values};
        // Compaction without a branch: a rejected pair is overwritten by the next.
        out[2 * n] = i;
        out[2 * n + 1] = j;
        n += boxes_may_overlap(edges, p, reach);
    }
    return n;
}

CS_CLONES static size_t sieve_triangles(const struct cs_point_motion *moves,
                                        const struct cs_moving_pairs *pairs, double reach,
                                        uint32_t *out) {
    return filter(false, moves, pairs, reach, out);
}

CS_CLONES static size_t sieve_edges(const struct cs_point_motion *moves,
                                    const struct cs_moving_pairs *pairs, double reach,
                                    uint32_t *out) {
    return filter(true, moves, pairs, reach, out);
}

size_t cs_point_motion_filter(const struct cs_point_motion *moves,
                              const struct cs_moving_pairs *pairs, double reach,
                              uint32_t *out) {
    return pairs->edges ? sieve_edges(moves, pairs, reach, out)
                        : sieve_triangles(moves, pairs, reach, out);
}
