/* What shape matching brings back, holds and lets go, and what its rotation is needed for. */
#include "matched.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static void stretch(struct fixture *body, double sx, double sy, double sz) {
    for (size_t i = 0; i < body->n; i++) {
        body->x[i] *= sx;
        body->x[body->n + i] *= sy;
        body->x[2 * body->n + i] *= sz;
    }
}

TEST(damaged_bodies_get_up) {
    static const char *const ways[] = {"\"alpha\": 0.5", "\"alpha\": 1",
                                       "\"alpha\": 0.5, \"beta\": 0.5"};
    static const char *const shapes[] = {BOX, LIMBS};
    for (int s = 0; s < 2; s++)
        for (int w = 0; w < 3; w++)
            for (int way = 0; way < DAMAGES; way++) {
                struct fixture body;
                fixture_open(&body, "shape-matching", FLOATING, shapes[s], ways[w], "");
                damage(&body, way);
                fixture_start(&body);
                fixture_frames(&body, 240);
                ck_assert_msg(deformation(&body) <= 1e-4,
                              "body %d, %s, damage %d: %g m off its shape", s, ways[w], way,
                              deformation(&body));
                fixture_close(&body);
            }
}

/* beta = 1: a body at its old volume, whatever its stretch, is at its goals; another one comes
 * back to its volume but keeps its proportions */
TEST(beta_1_keeps_linear_deformations) {
    struct fixture body;
    fixture_open(&body, "shape-matching", FLOATING, BALL, "\"alpha\": 0.7, \"beta\": 1", "");
    stretch(&body, 2, 0.4, 1.25);
    double before[3 * 512];
    ck_assert_uint_le(body.n, 512);
    memcpy(before, body.x, 3 * body.n * sizeof *before);
    fixture_start(&body);
    fixture_frames(&body, 60);
    for (size_t k = 0; k < 3 * body.n; k++)
        ck_assert_double_eq_tol(body.x[k], before[k], 1e-12);
    fixture_close(&body);

    fixture_open(&body, "shape-matching", FLOATING, BALL, "\"alpha\": 0.7, \"beta\": 1", "");
    stretch(&body, 2 * 1.3, 0.4 * 1.3, 1.25 * 1.3);
    fixture_start(&body);
    fixture_frames(&body, 240);
    for (size_t k = 0; k < 3 * body.n; k++)
        ck_assert_double_eq_tol(body.x[k], before[k], 1e-6);
    fixture_close(&body);
}

/* Held at one vertex, with k/m of the free ones and a thousandfold weight of the held one: it
 * is pulled from its goal by g/(1000 k/m). */
TEST(locked_vertex_holds_the_body) {
    struct fixture body;
    const double alpha = 0.5, h = 1.0 / 60, g = 9.81;
    fixture_open(&body, "shape-matching",
                 "{\"bodies\": [{" BALL ", \"shape_matching\": {\"alpha\": 0.5}, \"mass\": "
                 "{\"total\": 1}, \"pins\": [0]}], \"forces\": {\"velocity_loss\": 0.05}}");
    fixture_start(&body);
    fixture_frames(&body, 1200);
    double *goal = calloc(3 * body.n, sizeof *goal), offset = 0;
    cs_run_goals(&body.session.run, goal);
    for (size_t c = 0; c < 3; c++) {
        const double d = goal[c * body.n] - body.x[c * body.n];
        ck_assert_double_eq(body.x[c * body.n], body.system->start[c * body.n]);
        offset += d * d;
    }
    const double expected = g * (1 - alpha) * h * h / alpha / 1000;
    ck_assert_double_eq_tol(sqrt(offset) / expected, 1, 0.01);
    // and it hangs straight below
    double centre[3] = {0};
    for (size_t c = 0; c < 3; c++)
        for (size_t i = 0; i < body.n; i++)
            centre[c] += body.x[c * body.n + i] / (double)body.n;
    ck_assert_double_eq_tol(centre[0], body.x[0], 1e-3);
    ck_assert_double_eq_tol(centre[2], body.x[2 * body.n], 1e-3);
    ck_assert_double_lt(centre[1], body.x[body.n] - 0.4);
    free(goal);
    fixture_close(&body);
}

/* let go, it falls with what momentum it has: the weights are those of free particles again */
TEST(released_vertex_is_as_heavy_as_it_was) {
    struct fixture body;
    double before[2][3], after[2][3];
    fixture_open(&body, "shape-matching:dt=0.002",
                 "{\"bodies\": [{" BALL ", \"shape_matching\": {\"clusters\": 2}, \"mass\": "
                 "{\"total\": 1}, \"pins\": [0, 7]}], \"events\": [{\"at\": 0.5, \"release\": "
                 "{}}]}");
    fixture_start(&body);
    fixture_frames(&body, 31);
    ck_assert_double_gt(body.system->inv_mass[0], 0);
    fixture_momentum(&body, before[0], before[1]);
    fixture_frames(&body, 30);
    fixture_momentum(&body, after[0], after[1]);
    for (int c = 0; c < 3; c++)
        ck_assert_double_eq_tol(after[0][c] - before[0][c], c == 1 ? -9.81 * 0.5 : 0, 1e-12);
    fixture_close(&body);
}

/* looking at the goals changes nothing of the run */
TEST(goals_are_only_looked_at) {
    struct fixture looked, plain;
    fixture_open(&looked, "shape-matching", FLOATING, LIMBS, "\"clusters\": 3", "");
    fixture_open(&plain, "shape-matching", FLOATING, LIMBS, "\"clusters\": 3", "");
    damage(&looked, LINE);
    damage(&plain, LINE);
    fixture_start(&looked);
    fixture_start(&plain);
    double *g = calloc(3 * looked.n, sizeof *g);
    for (int k = 0; k < 20; k++) {
        cs_run_goals(&looked.session.run, g);
        fixture_frames(&looked, 1);
        fixture_frames(&plain, 1);
    }
    ck_assert_mem_eq(looked.x, plain.x, 6 * plain.n * sizeof *plain.x);
    free(g);
    fixture_close(&looked);
    fixture_close(&plain);
}

/* Without the square root a ball at rest has its goals at 1/M of its size, M = sum m q^2/3 of
 * one direction, and swings about M^-1/2; with it, or with the linear transformation A, whose
 * M is 1, it rests (soft-body thesis, sec. 2.5). */
TEST(without_its_root_a_pq_pulsates) {
    static const char *const rotations[] = {"polar", "unrooted-linear", "unrooted-pq"};
    for (int r = 0; r < 3; r++) {
        struct fixture ball;
        char method[64];
        double least = 1, most = 1;
        snprintf(method, sizeof method, "shape-matching:dt=0.001,rotation=%s", rotations[r]);
        // 12 kg in a ball of radius 1/2: M near 12/4/3 = 1
        fixture_open(&ball, method,
                     "{\"bodies\": [{" BALL ", \"shape_matching\": {\"alpha\": 0.1}, \"mass\": "
                     "{\"total\": 9}}], \"forces\": {\"gravity\": [0, 0, 0]}}");
        const double size = distance(&ball, ball.x, 0, ball.n - 1);
        double inertia = 0;
        for (size_t i = 0; i < ball.n; i++)
            inertia += ball.system->mass[i] * ball.x[i] * ball.x[i];
        fixture_start(&ball);
        for (int k = 0; k < 60; k++) {
            fixture_frames(&ball, 1);
            const double now = distance(&ball, ball.x, 0, ball.n - 1) / size;
            least = fmin(least, now);
            most = fmax(most, now);
        }
        if (r < 2) {
            ck_assert_double_eq_tol(least, 1, 1e-12);
            ck_assert_double_eq_tol(most, 1, 1e-12);
        } else {
            // u'' = -w^2 (u - 1/(M u)) turns where u^2 - 1 = 2/M log u
            const double m = inertia;
            ck_assert_double_lt(m, 0.9);
            ck_assert_double_eq_tol(least, 1, 0.01);
            ck_assert_double_eq_tol(most * most - 1, 2 / m * log(most),
                                    0.05 * (most * most - 1));
            ck_assert_double_gt(most, 1.3);
        }
        fixture_close(&ball);
    }
}
