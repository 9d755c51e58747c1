/* Velocities of cubic splines through key frames, by elimination in a tridiagonal matrix, and
 * the curves between the keys. */
#include "mesh/vertex_paths.h"

#include <math.h>

/* Row k of positions or velocities. */
static double *row(const struct cs_vertex_paths *paths, double *of, size_t k) {
    return of + 3 * (size_t)paths->n * k;
}

/* Sets velocities to the right-hand sides of the rows; beyond the ends of a natural spline
 * stands the end itself. */
static void set_right_sides(const struct cs_vertex_paths *paths) {
    const size_t keys = paths->n_keys, last = keys - 1;
    const double factor = 3 / paths->interval;
    const bool loops = paths->end == CS_PATHS_LOOP;
    for (size_t k = 0; k < keys; k++) {
        const size_t before = k > 0 ? k - 1 : (loops ? last : 0);
        const size_t after = k < last ? k + 1 : (loops ? 0 : last);
        const double *from = row(paths, paths->positions, before);
        const double *to = row(paths, paths->positions, after);
        double *out = row(paths, paths->velocities, k);
        for (size_t i = 0; i < 3 * (size_t)paths->n; i++)
            out[i] = factor * (to[i] - from[i]);
    }
}

/* out = factor (out - before), rows of `length`; before NULL: 0. */
static void eliminate(size_t length, double factor, const double *before, double *out) {
    for (size_t i = 0; i < length; i++)
        out[i] = factor * (before ? out[i] - before[i] : out[i]);
}

/* out -= factor other, rows of `length`. */
static void subtract(size_t length, double factor, const double *other, double *out) {
    for (size_t i = 0; i < length; i++)
        out[i] -= factor * other[i];
}

/* Solves rows [begin, end) of x_k-1 + diagonal_k x_k + x_k+1 = x, each of `length` numbers,
 * without a neighbour beyond them; work (end). */
static void solve(size_t begin, size_t end, size_t length, const double *diagonal, double *work,
                  double *x) {
    for (size_t k = begin; k < end; k++) {
        double *at = x + k * length;
        work[k] = 1 / (diagonal[k] - (k > begin ? work[k - 1] : 0));
        eliminate(length, work[k], k > begin ? at - length : NULL, at);
    }
    for (size_t k = end; k-- > begin + 1;)
        subtract(length, work[k - 1], x + k * length, x + (k - 1) * length);
}

/* The closed ring of rows by Sherman and Morrison's formula: the matrix is the one without the
 * corners, with 4 added to its first diagonal and 1/4 to its last, plus u w^T with u = (-4, 0,
 * ..., 1) and w = (1, 0, ..., -1/4). turned: (keys), room for the solution with u. */
static void solve_loop(const struct cs_vertex_paths *paths, double *diagonal, double *work,
                       double *turned) {
    const size_t keys = paths->n_keys, last = keys - 1, length = 3 * (size_t)paths->n;
    diagonal[0] += 4;
    diagonal[last] += 0.25;
    for (size_t k = 0; k < keys; k++)
        turned[k] = k == 0 ? -4 : k == last;
    solve(0, keys, length, diagonal, work, paths->velocities);
    solve(0, keys, 1, diagonal, work, turned);
    const double *first = paths->velocities, *end = row(paths, paths->velocities, last);
    const double all = 1 + turned[0] - 0.25 * turned[last];
    for (size_t i = 0; i < length; i++) {
        const double share = (first[i] - 0.25 * end[i]) / all;
        for (size_t k = 0; k < keys; k++)
            row(paths, paths->velocities, k)[i] -= share * turned[k];
    }
}

/* work (3, keys) */
static void find_velocities(const struct cs_vertex_paths *paths, double *work) {
    const size_t keys = paths->n_keys, last = keys - 1, length = 3 * (size_t)paths->n;
    double *diagonal = work + 2 * keys;
    set_right_sides(paths);
    // the ends differ: rows of their own, a ring, or half the diagonal
    for (size_t k = 0; k < keys; k++)
        diagonal[k] = 4;
    switch (paths->end) {
    case CS_PATHS_HOLD:
        for (size_t i = 0; i < length; i++)
            paths->velocities[i] = row(paths, paths->velocities, last)[i] = 0;
        solve(1, last, length, diagonal, work, paths->velocities);
        break;
    case CS_PATHS_LOOP:
        solve_loop(paths, diagonal, work, work + keys);
        break;
    case CS_PATHS_CONTINUE:
        diagonal[0] = diagonal[last] = 2;
        solve(0, keys, length, diagonal, work, paths->velocities);
        break;
    }
}

/* m/s, square of the largest speed of vertex i from key k to key `next`: the velocity is a
 * quadratic whose Bezier points are v_k, 3 (p - p_k)/T - v_k - v and v, with p and v of `next`.
 */
static double largest_square(const struct cs_vertex_paths *paths, size_t k, size_t next,
                             size_t i) {
    double squares[3] = {0}, most = 0;
    for (size_t c = 0; c < 3; c++) {
        const size_t at = i + c * paths->n;
        const double *p = paths->positions + at, *v = paths->velocities + at;
        const size_t length = 3 * (size_t)paths->n;
        // the three Bezier points, component by component
        const double ends[2] = {v[k * length], v[next * length]};
        const double middle =
            3 * (p[next * length] - p[k * length]) / paths->interval - ends[0] - ends[1];
        squares[0] += ends[0] * ends[0];
        squares[1] += middle * middle;
        squares[2] += ends[1] * ends[1];
    }
    for (int k3 = 0; k3 < 3; k3++)
        most = fmax(most, squares[k3]);
    return most;
}

static double largest_speed(const struct cs_vertex_paths *paths) {
    const size_t legs = paths->end == CS_PATHS_LOOP ? paths->n_keys : paths->n_keys - 1;
    double most = 0;
    for (size_t k = 0; k < legs; k++)
        for (size_t i = 0; i < paths->n; i++)
            most = fmax(most, largest_square(paths, k, (k + 1) % paths->n_keys, i));
    return sqrt(most);
}

enum cs_status cs_vertex_paths_finish(struct cs_vertex_paths *paths, struct cs_arena *arena,
                                      struct cs_error *error) {
    struct cs_arena making = {0};
    double *work = cs_arena_alloc_array(&making, paths->n_keys, 3 * sizeof *work, error);
    paths->velocities = cs_arena_alloc_array(
        arena, paths->n_keys, 3 * (size_t)paths->n * sizeof *paths->velocities, error);
    if (!error->status) {
        find_velocities(paths, work);
        paths->speed = largest_speed(paths);
    }
    cs_arena_finish(&making);
    return error->status;
}

/* Beyond the keys, `since` s after the end key. */
static struct cs_path_weights beyond(const struct cs_vertex_paths *paths, uint32_t key,
                                     double since) {
    const bool goes_on = paths->end == CS_PATHS_CONTINUE;
    return (struct cs_path_weights){.key = {key, key},
                                    .position = {1, 0, goes_on ? since : 0, 0},
                                    .velocity = {0, 0, goes_on ? 1 : 0, 0}};
}

static struct cs_path_weights between(const struct cs_vertex_paths *paths, double u) {
    const uint32_t k = (uint32_t)u;
    const double s = u - k, r = 1 - s, interval = paths->interval;
    const double slope = 6 * s * r / interval;
    return (struct cs_path_weights){
        .key = {k, (k + 1) % paths->n_keys},
        .position = {(1 + 2 * s) * r * r, s * s * (3 - 2 * s), interval * (s * r * r),
                     -interval * (s * s * r)},
        .velocity = {-slope, slope, r * (1 - 3 * s), s * (3 * s - 2)}};
}

struct cs_path_weights cs_vertex_paths_weights(const struct cs_vertex_paths *paths, double t) {
    const double last = paths->n_keys - 1, since = t - paths->start;
    struct cs_path_weights at;
    double u = since / paths->interval;
    if (paths->end == CS_PATHS_LOOP) {
        u -= paths->n_keys * floor(u / paths->n_keys);
        // rounding may reach the end, and t may be infinite
        at = between(paths, u >= 0 && u < paths->n_keys ? u : 0);
    } else if (u > 0) {
        at = u < last ? between(paths, u)
                      : beyond(paths, paths->n_keys - 1, since - last * paths->interval);
    } else {
        at = beyond(paths, 0, u <= 0 ? since : 0);
    }
    at.t = t;
    return at;
}
