/* vertex_paths.h - the vertices of a mesh on smooth paths through key frames.
 *
 * Keys p_k are T seconds apart. Between keys k and k + 1, with s from 0 to 1, a vertex follows
 * the cubic Hermite curve
 *   x = (1 + 2 s)(1 - s)^2 p_k + s^2 (3 - 2 s) p_k+1 + T (s (1 - s)^2 v_k - s^2 (1 - s) v_k+1)
 * with the velocities v_k of the cubic spline (de Boor 1978, ch. IV), which solve
 *   v_k-1 + 4 v_k + v_k+1 = 3 (p_k+1 - p_k-1) / T.
 * Acceleration is then continuous at the keys too. With tangents of finite differences
 * (Catmull, Rom 1974) it would jump there, and a step of order 4 over a key would have order 3.
 * A change of one key fades by 2 - sqrt(3) = 0.27 from key to key.
 *
 * Beyond the first and the last key by `end`:
 *   hold      at rest: v = 0 at both ends, where the acceleration may jump
 *   loop      the first key follows the last one
 *   continue  on with the velocity of the end, without acceleration there: the natural spline
 */
#ifndef CS_VERTEX_PATHS_H
#define CS_VERTEX_PATHS_H

#include "base/arena.h"
#include "base/hash.h"

enum cs_paths_end { CS_PATHS_HOLD, CS_PATHS_LOOP, CS_PATHS_CONTINUE };

/* Paths of n vertices through n_keys >= 2 keys. The arrays belong to the arena of their maker.
 */
struct cs_vertex_paths {
    uint32_t n, n_keys;
    enum cs_paths_end end;
    double start, interval; /* s: of the first key, from key to key */
    double *positions;      /* (n_keys, 3, n) m */

    /* made by cs_vertex_paths_finish */
    double *velocities; /* (n_keys, 3, n) m/s */
    double speed;       /* m/s, a bound on the speed of all vertices at all times */

    char file_hash[CS_HASH_DIGITS]; /* of the bytes of the file, or of the hashes of several */
    size_t bytes;                   /* of this struct and its arrays, set by the reader */
};

/* Sets velocities and speed. CS_ERR_MEMORY. */
enum cs_status cs_vertex_paths_finish(struct cs_vertex_paths *paths, struct cs_arena *arena,
                                      struct cs_error *error);

/* Weights at one time: of positions and then velocities of two keys, in position and velocity.
 */
struct cs_path_weights {
    double t; /* s */
    uint32_t key[2];
    double position[4], velocity[4]; /* 1, 1, s, s; 1/s, 1/s, 1, 1 */
};

/* Weights at t, which may be any number; not finite gives the first key. + - * / and floor
 * only. */
struct cs_path_weights cs_vertex_paths_weights(const struct cs_vertex_paths *paths, double t);

/* out (3) = sum of the weights times positions and velocities of vertex i. */
static inline void cs_vertex_paths_sum(const struct cs_vertex_paths *paths,
                                       const struct cs_path_weights *at, const double weight[4],
                                       uint32_t i, double out[3]) {
    const size_t n = paths->n, first = 3 * n * at->key[0] + i, second = 3 * n * at->key[1] + i;
    for (size_t c = 0; c < 3; c++)
        out[c] = weight[0] * paths->positions[first + c * n] +
                 weight[1] * paths->positions[second + c * n] +
                 weight[2] * paths->velocities[first + c * n] +
                 weight[3] * paths->velocities[second + c * n];
}

#endif
