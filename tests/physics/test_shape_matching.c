/* Shape matching against closed forms and its limit cases. */
#include "matched.h"

#include "model/contact/ccd/crossings.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* alpha = 0 leaves every particle to itself, and to its springs where they are asked for: the
 * bits are those of symplectic Euler without springs, or with them */
TEST(alpha_0_is_symplectic_euler) {
    static const char scene[] =
        "{\"bodies\": [{\"mesh\": {\"shape\": \"torus\", \"detail\": 5, \"velocity\": [1, 2, "
        "0], \"spin\": [1, 2, 3]}, \"mass\": {\"total\": 1}, %s}], \"contact\": \"project\", "
        "\"colliders\": [{\"floor\": "
        "{\"height\": -0.6}, \"absorption\": -0.5, \"friction\": 0.2}], \"forces\": {\"drag\": "
        "0.001}}";
    static const char *const bodies[2][2] = {
        {"\"shape_matching\": {\"alpha\": 0}", "\"springs\": {\"stretch\": 0, \"bend\": 0}"},
        {"\"shape_matching\": {\"alpha\": 0, \"springs\": true}", "\"springs\": {}"}};
    for (int springs = 0; springs < 2; springs++) {
        struct fixture matched, free;
        fixture_open(&matched, "shape-matching:dt=0.004", scene, bodies[springs][0]);
        fixture_open(&free, "symplectic-euler:dt=0.004", scene, bodies[springs][1]);
        ck_assert((free.system->springs.n > 0) == springs);
        fixture_start(&matched);
        fixture_start(&free);
        fixture_frames(&matched, 60);
        fixture_frames(&free, 60);
        ck_assert_uint_gt(matched.session.run.counts.projected_particles, 0);
        for (size_t k = 0; k < 6 * free.n; k++)
            ck_assert(matched.x[k] == free.x[k]);
        fixture_close(&matched);
        fixture_close(&free);
    }
}

/* the shape at rest is where it stays: solid, flat, in parts, with any beta */
TEST(rest_is_a_fixed_point) {
    static const char *const shapes[] = {LIMBS, SHEET, "\"cloth\": {\"grid\": [6, 1]}",
                                         "\"cloth\": {\"grid\": [1, 1]}"};
    static const char *const ways[] = {"", "\"alpha\": 1, \"beta\": 1", "\"beta\": 0.5",
                                       "\"clusters\": 4, \"beta\": 0.3"};
    for (int s = 0; s < 4; s++)
        for (int w = 0; w < (s < 2 ? 4 : 3); w++) {
            struct fixture body;
            fixture_open(&body, "shape-matching", FLOATING, shapes[s], ways[w], "");
            fixture_start(&body);
            fixture_frames(&body, 60);
            ck_assert_double_le(moved(&body), 1e-12);
            fixture_close(&body);
        }
}

/* Two particles pulled apart by u are a spring, u'' = -k/m u with k/m = a/((1 - a) s^2), and
 * the step is implicit Euler's: u' = (u + h v)/(1 + k/m h^2). With alpha_step 0 that a holds
 * for any step. */
TEST(pair_swings_as_a_spring_in_implicit_euler) {
    static const struct {
        const char *matching;
        double step; /* s, that alpha is for; 0: h */
    } rows[] = {{"\"alpha\": 0.4", 1.0 / 60},
                {"\"alpha\": 0.4, \"alpha_step\": 0.1", 0.1},
                {"\"alpha\": 0.4, \"alpha_step\": 0", 0}};
    for (int r = 0; r < 3; r++)
        for (int parts = 1; parts <= 4; parts *= 4) {
            struct fixture pair;
            char method[64];
            const double h = 1.0 / 60 / parts, step = rows[r].step > 0 ? rows[r].step : h;
            const double stiffness = 0.4 / (0.6 * step * step);
            snprintf(method, sizeof method, "shape-matching:dt=%.17g", h);
            fixture_open(&pair, method, FLOATING, "\"cloth\": {\"grid\": [2, 1]}",
                         rows[r].matching, "");
            double u = 0.1, speed = 0;
            pair.x[0] -= u / 2;
            pair.x[1] += u / 2;
            fixture_start(&pair);
            fixture_frames(&pair, 10);
            for (int k = 0; k < 10 * parts; k++) {
                const double next = (u + h * speed) / (1 + stiffness * h * h);
                speed = (next - u) / h;
                u = next;
            }
            ck_assert_double_eq_tol(pair.x[1] - pair.x[0] - 1, u, 1e-13);
            ck_assert_double_eq_tol(pair.v[1] - pair.v[0], speed, 1e-11);
            fixture_close(&pair);
        }
}

static void state_at(int parts, double *state, size_t *n) {
    struct fixture body;
    char method[64];
    snprintf(method, sizeof method, "shape-matching:dt=%.17g", 1.0 / 60 / parts);
    fixture_open(&body, method, FLOATING, BOX,
                 "\"alpha\": 0.05, \"beta\": 0.3, \"clusters\": 2", "");
    cs_perturb_smooth(body.system, 0.05, 0.2);
    fixture_start(&body);
    fixture_frames(&body, 10);
    *n = 3 * body.n;
    memcpy(state, body.x, *n * sizeof *state);
    fixture_close(&body);
}

/* with alpha meant for a step of its own, the motion has a limit as h goes to 0: order 1 */
TEST(motion_has_a_limit_at_order_1) {
    static double states[3][1024];
    size_t n = 0;
    for (int level = 0; level < 3; level++)
        state_at(16 << level, states[level], &n);
    ck_assert_uint_le(n, 1024);
    const double ratio =
        cs_rms_difference(states[0], states[1], n) / cs_rms_difference(states[1], states[2], n);
    ck_assert_double_eq_tol(ratio, 2, 0.1);
}

/* A rigid ball that turns by p_n in a step n turns by atan(sin p/(2 - cos p)) in the next, the
 * rotation of 2 R_n - R_n-1; the first one is atan(w h). So much angular momentum is lost: of
 * first order in h. Momentum and distances are kept. */
TEST(rigid_ball_turns_as_it_must) {
    for (int parts = 1; parts <= 2; parts++) {
        struct fixture ball;
        char method[64];
        const double w = 4, h = 1.0 / 60 / parts;
        snprintf(method, sizeof method, "shape-matching:dt=%.17g", h);
        fixture_open(&ball, method, FLOATING,
                     "\"mesh\": {\"shape\": \"sphere\", \"detail\": 4, \"velocity\": [1, 2, "
                     "3], \"spin\": [0, 0, 4]}",
                     "\"alpha\": 1", "");
        double before[2][3], after[2][3], turn = atan(w * h), angle = turn;
        fixture_momentum(&ball, before[0], before[1]);
        fixture_start(&ball);
        fixture_frames(&ball, 30);
        for (int k = 1; k < 30 * parts; k++) {
            turn = atan(sin(turn) / (2 - cos(turn)));
            angle += turn;
        }
        fixture_momentum(&ball, after[0], after[1]);
        for (size_t c = 0; c < 3; c++)
            ck_assert_double_eq_tol(after[0][c], before[0][c], 1e-12);
        ck_assert_double_le(deformation(&ball), 1e-13);
        // the ends of a vector across the axis
        const double *x = ball.x, *q = ball.system->start;
        const double from[2] = {q[1] - q[0], q[ball.n + 1] - q[ball.n]};
        const double to[2] = {x[1] - x[0], x[ball.n + 1] - x[ball.n]};
        const double turned[2] = {cos(angle) * from[0] - sin(angle) * from[1],
                                  sin(angle) * from[0] + cos(angle) * from[1]};
        for (int c = 0; c < 2; c++)
            ck_assert_double_eq_tol(to[c], turned[c], 1e-11);
        // about the ball's own centre, which is at v t and gives x x v nothing
        ck_assert_double_eq_tol(after[1][2] / before[1][2], sin(turn) / (w * h), 1e-9);
        fixture_close(&ball);
    }
}

/* Ways to the goals make no force and no torque, for any beta and any number of parts. */
TEST(goals_have_no_force_and_no_torque) {
    static const char *const ways[] = {"", "\"beta\": 0.6", "\"clusters\": 5",
                                       "\"clusters\": 3, \"beta\": 1, \"overlap\": 0.5"};
    for (int w = 0; w < 4; w++) {
        struct fixture body;
        double force[3] = {0}, torque[3] = {0}, size = 0;
        fixture_open(&body, "shape-matching", FLOATING, LIMBS, ways[w], "");
        cs_perturb_smooth(body.system, 0.1, 0);
        fixture_start(&body);
        double *g = calloc(3 * body.n, sizeof *g);
        cs_run_goals(&body.session.run, g);
        for (size_t i = 0; i < body.n; i++)
            for (size_t c = 0; c < 3; c++) {
                const size_t d = (c + 1) % 3 * body.n + i, e = (c + 2) % 3 * body.n + i;
                const double m = body.system->mass[i];
                force[c] += m * (g[c * body.n + i] - body.x[c * body.n + i]);
                torque[c] +=
                    m * (body.x[d] * (g[e] - body.x[e]) - body.x[e] * (g[d] - body.x[d]));
                size += m * fabs(g[c * body.n + i] - body.x[c * body.n + i]);
            }
        ck_assert_double_gt(size, 0.01);
        for (int c = 0; c < 3; c++) {
            ck_assert_double_le(fabs(force[c]), 1e-14);
            ck_assert_double_le(fabs(torque[c]), 1e-14);
        }
        free(g);
        fixture_close(&body);
    }
}

#define CLOTH                                                                                  \
    "{\"cloth\": {\"grid\": [6, 5]}, \"mass\": {\"total\": 0.2}, \"pins\": [\"top\"]}, "       \
    "{\"mesh\": {\"shape\": \"sphere\", \"detail\": 3}, \"network\": {\"springs\": 3}, "       \
    "\"mass\": {\"total\": 1}}"

/* cloth and network body move as if the matched body were not there, to the last bit */
TEST(other_bodies_are_those_of_symplectic_euler) {
    struct fixture mixed, alone;
    fixture_open(&mixed, "shape-matching:dt=0.0005",
                 "{\"bodies\": [" CLOTH ", {" BOX ", \"mass\": {\"total\": 1}, "
                 "\"shape_matching\": {}}]}");
    fixture_open(&alone, "symplectic-euler:dt=0.0005", "{\"bodies\": [" CLOTH "]}");
    fixture_start(&mixed);
    fixture_start(&alone);
    fixture_frames(&mixed, 30);
    fixture_frames(&alone, 30);
    ck_assert_uint_gt(mixed.n, alone.n);
    for (size_t c = 0; c < 6; c++)
        for (size_t i = 0; i < alone.n; i++)
            ck_assert(mixed.x[c * mixed.n + i] == alone.x[c * alone.n + i]);
    // the limit that was chosen where none was asked for is that of the springs
    fixture_close(&alone);
    fixture_close(&mixed);
    fixture_open(&mixed, "shape-matching",
                 "{\"bodies\": [" CLOTH ", {" BOX ", \"mass\": {\"total\": 1}, "
                 "\"shape_matching\": {}}]}");
    fixture_start(&mixed);
    fixture_frames(&mixed, 60);
    ck_assert_uint_gt(mixed.session.run.counts.steps, 60);
    fixture_close(&mixed);
}

/* alpha_step, pairs */
#define THROWN                                                                                 \
    "{\"bodies\": [{" BOX ", \"thickness\": 0.1, \"mass\": "                                   \
    "{\"total\": 1}, \"shape_matching\": {\"alpha\": 0.4, \"alpha_step\": %s}}, {\"mesh\": "   \
    "{\"shape\": \"box\", \"detail\": 3, \"velocity\": [0, -4, 0], \"place\": "                \
    "{\"translate\": [0.4, 1.25, 0.3]}}, \"thickness\": 0.1, \"mass\": {\"total\": 1}, "       \
    "\"shape_matching\": {\"alpha\": 0.4, \"alpha_step\": %s}}], \"pairs\": \"%s\", "          \
    "\"contact\": {\"law\": \"force\", \"stiffness\": 60}, \"crossings\": \"limit\"}"

/* most crossings in any frame, until the run ends; *y the height of a corner then */
static uint64_t throw_boxes(const char *step, const char *pairs, struct cs_counts *counts,
                            double *y, struct cs_error *error) {
    struct fixture boxes;
    uint64_t most = 0;
    fixture_open(&boxes, "shape-matching", THROWN, step, step, pairs);
    fixture_start(&boxes);
    struct cs_run *run = &boxes.session.run;
    while (run->frame < 15 && run->outcome == CS_RUNNING && !cs_run_frame(run, error)) {
        const uint64_t found = cs_crossings_count(boxes.system, run->t, run->x).n;
        most = found > most ? found : most;
    }
    if (run->outcome == CS_GAVE_UP)
        cs_fail(error, CS_ERR_MODULE, "%s", run->reason);
    *counts = run->counts;
    *y = boxes.x[boxes.n];
    fixture_close(&boxes);
    return most;
}

/* Steps are cut as those of other methods are. Where alpha holds for any step, its parts have
 * the stiffness of the whole, here of a frame. Where nothing keeps the boxes off each other no
 * part is short enough. */
TEST(a_limit_holds_off_what_goals_draw) {
    static const char *const steps[] = {"0.016666666666666666", "0"};
    double y[2];
    for (int s = 0; s < 2; s++) {
        struct cs_counts counts;
        double end;
        struct cs_error error = {0};
        ck_assert_uint_eq(throw_boxes(steps[s], "all", &counts, y + s, &error), 0);
        ck_assert_msg(!error.status, "%s", error.message);
        ck_assert_uint_gt(counts.subdivided_steps, 0);
        ck_assert_uint_eq(throw_boxes(steps[s], "listed", &counts, &end, &error), 0);
        ck_assert_msg(error.status == CS_ERR_MODULE &&
                          strstr(error.message, "crosses a surface"),
                      "%s", error.message);
    }
    ck_assert_double_eq_tol(y[0], y[1], 1e-8);
}
