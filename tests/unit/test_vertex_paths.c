/* Curves through key frames: keys met, slopes true, accelerations continuous, errors of fourth
 * order, ends as asked for. */
#include "mesh/vertex_paths.h"
#include "unit.h"

#include <math.h>

enum { N = 2, KEYS = 7, NUMBERS = 3 * N };

static double keys[KEYS * NUMBERS];

/* Paths through the first n_keys keys. */
static void make(struct cs_vertex_paths *paths, uint32_t n_keys, enum cs_paths_end end,
                 struct cs_arena *arena) {
    struct cs_error error = {0};
    for (int k = 0; k < KEYS * NUMBERS; k++)
        keys[k] = sin(1.7 * k) + 0.3 * cos(5.1 * k);
    *paths = (struct cs_vertex_paths){.n = N,
                                      .n_keys = n_keys,
                                      .end = end,
                                      .start = 0.3,
                                      .interval = 0.125,
                                      .positions = keys};
    cs_vertex_paths_finish(paths, arena, &error);
    UNIT_ASSERT_OK(&error);
}

static void find(const struct cs_vertex_paths *paths, double t, uint32_t i, double p[3],
                 double v[3]) {
    const struct cs_path_weights at = cs_vertex_paths_weights(paths, t);
    cs_vertex_paths_sum(paths, &at, at.position, i, p);
    cs_vertex_paths_sum(paths, &at, at.velocity, i, v);
}

static const enum cs_paths_end ends[] = {CS_PATHS_HOLD, CS_PATHS_LOOP, CS_PATHS_CONTINUE};

TEST(keys_are_met) {
    for (size_t e = 0; e < LENGTH(ends); e++)
        for (uint32_t n = 2; n <= KEYS; n++) {
            struct cs_arena arena = {0};
            struct cs_vertex_paths paths;
            double p[3], v[3];
            make(&paths, n, ends[e], &arena);
            for (uint32_t k = 0; k < n; k++) {
                find(&paths, 0.3 + 0.125 * k, 1, p, v);
                for (size_t c = 0; c < 3; c++)
                    ck_assert_double_eq_tol(p[c], keys[k * NUMBERS + c * N + 1], 1e-14);
            }
            cs_arena_finish(&arena);
        }
}

/* m/s2 at t, from one side */
static double acceleration(const struct cs_vertex_paths *paths, double t, double h) {
    double p[3], from[3], to[3];
    find(paths, t, 0, p, from);
    find(paths, t + h, 0, p, to);
    return (to[1] - from[1]) / h;
}

/* Differences give the velocity everywhere, and the acceleration has one value on both sides of
 * a key: of the ends too, but where the vertices come to rest. */
TEST(curves_have_two_derivatives) {
    const double h = 1e-6;
    for (size_t e = 0; e < LENGTH(ends); e++) {
        struct cs_arena arena = {0};
        struct cs_vertex_paths paths;
        double p[3], q[3], v[3], most = 0;
        make(&paths, KEYS, ends[e], &arena);
        for (double t = -0.5; t < 2.5; t += 0.0437) {
            find(&paths, t - h, 1, p, v);
            find(&paths, t + h, 1, q, v);
            find(&paths, t, 1, (double[3]){0}, v);
            for (int c = 0; c < 3; c++)
                ck_assert_double_eq_tol(v[c], (q[c] - p[c]) / (2 * h), 1e-6);
            most = fmax(most, sqrt(v[0] * v[0] + v[1] * v[1] + v[2] * v[2]));
        }
        ck_assert_msg(most <= paths.speed && most > 0.4 * paths.speed, "%g, bound %g", most,
                      paths.speed);
        for (uint32_t k = 0; k < KEYS; k++) {
            const double t = 0.3 + 0.125 * k, before = acceleration(&paths, t - 1e-9, -h);
            const double after = acceleration(&paths, t + 1e-9, h);
            const bool rests = ends[e] == CS_PATHS_HOLD && (k == 0 || k == KEYS - 1);
            ck_assert_msg((fabs(before - after) > 1) == rests, "end %zu, key %u: %g, %g", e, k,
                          before, after);
        }
        cs_arena_finish(&arena);
    }
}

TEST(ends_are_as_asked_for) {
    struct cs_arena arena = {0};
    struct cs_vertex_paths paths;
    double p[3], q[3], v[3], w[3];
    make(&paths, KEYS, CS_PATHS_HOLD, &arena);
    for (double t = -1e9; t < 2e9; t += 1.999e9) {
        find(&paths, t, 0, p, v);
        for (size_t c = 0; c < 3; c++) {
            ck_assert_double_eq(v[c], 0);
            ck_assert_double_eq(p[c], keys[(t > 0 ? KEYS - 1 : 0) * NUMBERS + c * N]);
        }
    }
    make(&paths, KEYS, CS_PATHS_LOOP, &arena);
    for (double t = 0; t < 0.9; t += 0.01) {
        find(&paths, t, 1, p, v);
        find(&paths, t - 3 * KEYS * 0.125, 1, q, w);
        for (int c = 0; c < 3; c++) {
            ck_assert_double_eq_tol(p[c], q[c], 1e-12);
            ck_assert_double_eq_tol(v[c], w[c], 1e-10);
        }
    }
    make(&paths, KEYS, CS_PATHS_CONTINUE, &arena);
    find(&paths, -1.7, 1, p, v);
    find(&paths, 0.3, 1, q, w);
    for (int c = 0; c < 3; c++) {
        ck_assert_double_eq(v[c], w[c]);
        ck_assert_double_eq_tol(p[c], q[c] - 2 * w[c], 1e-13);
    }
    // what is no number is the first key
    find(&paths, (double)NAN, 0, p, v);
    ck_assert_double_eq(p[0], keys[0]);
    cs_arena_finish(&arena);
}

/* A straight way at constant speed is one, to the last digits, and its speed is the bound. */
TEST(lines_stay_lines) {
    struct cs_arena arena = {0};
    struct cs_error error = {0};
    double line[5 * 3], p[3], v[3];
    for (int k = 0; k < 5; k++) {
        line[3 * k] = 3 * 0.1 * k - 7;
        line[3 * k + 1] = 4 * 0.1 * k;
        line[3 * k + 2] = 1;
    }
    struct cs_vertex_paths paths = {
        .n = 1, .n_keys = 5, .end = CS_PATHS_CONTINUE, .interval = 0.1, .positions = line};
    cs_vertex_paths_finish(&paths, &arena, &error);
    ck_assert_double_eq_tol(paths.speed, 5, 1e-13);
    for (double t = -1; t < 2; t += 0.03) {
        find(&paths, t, 0, p, v);
        ck_assert_double_eq_tol(p[0], 3 * t - 7, 1e-13);
        ck_assert_double_eq_tol(p[1], 4 * t, 1e-13);
        ck_assert_double_eq_tol(v[0], 3, 1e-13);
        ck_assert_double_eq_tol(v[2], 0, 1e-13);
    }
    cs_arena_finish(&arena);
}

/* m, largest error of a circle with `n` keys */
static double circle_error(uint32_t n) {
    const double pi = 3.14159265358979324;
    struct cs_arena arena = {0};
    struct cs_error error = {0};
    double circle[3 * 64] = {0}, p[3], v[3], most = 0;
    for (uint32_t k = 0; k < n; k++) {
        circle[3 * k] = cos(2 * pi * k / n);
        circle[3 * k + 1] = sin(2 * pi * k / n);
    }
    struct cs_vertex_paths paths = {
        .n = 1, .n_keys = n, .end = CS_PATHS_LOOP, .interval = 1.0 / n, .positions = circle};
    cs_vertex_paths_finish(&paths, &arena, &error);
    for (double t = 0; t < 1; t += 0.001) {
        find(&paths, t, 0, p, v);
        most = fmax(most, hypot(p[0] - cos(2 * pi * t), p[1] - sin(2 * pi * t)));
    }
    cs_arena_finish(&arena);
    return most;
}

TEST(errors_are_of_fourth_order) {
    const double order = log2(circle_error(32) / circle_error(64));
    ck_assert_msg(fabs(order - 4) < 0.1, "%g", order);
}
