/* Contact as a force: against closed forms of the law, of the incline and of the belt, and by
 * what holds for every method: its order, and that nothing gains energy at an obstacle. */
#include "base/vec3.h"
#include "methods.h"
#include "model/contact/barrier_law.h"
#include "model/contact/ccd/accd.h"
#include "model/contact/collider_params.h"
#include "model/contact/posed_collider.h"
#include "model/contact/step_check.h"
#include "model/plan.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

#define G 9.81

TEST(law_is_one_function) {
    const double range = 0.02, k = 700, e = 2e-9;
    for (double d = -0.01; d < 1.2 * range; d += 1.7e-4) {
        const struct cs_barrier barrier = cs_barrier_at(d, range, k);
        const double slope =
            (cs_barrier_energy(d - e, range, k) - cs_barrier_energy(d + e, range, k)) / (2 * e);
        const double bend =
            (cs_barrier_at(d - e, range, k).force - cs_barrier_at(d + e, range, k).force) /
            (2 * e);
        const double turn = (cs_barrier_at(d + e, range, k).stiffness -
                             cs_barrier_at(d - e, range, k).stiffness) /
                            (2 * e);
        ck_assert_double_eq_tol(barrier.force, slope, 1e-6 * (barrier.force + 1e-3));
        ck_assert_double_eq_tol(barrier.stiffness, bend, 1e-4 * barrier.stiffness + 1e-3);
        // the stiffness has a bend where its core begins
        if (fabs(d - CS_BARRIER_CORE * range) > 2 * e)
            ck_assert_double_eq_tol(cs_barrier_slope(d, range, k), turn,
                                    1e-4 * fabs(turn) + 1e-2);
    }
    ck_assert_double_eq_tol(cs_barrier_at(range / 2, range, k).stiffness, k * 11 / 12,
                            1e-9 * k);
    ck_assert_double_eq(cs_barrier_at(range, range, k).force, 0);
    ck_assert_double_eq(cs_barrier_energy(1.5 * range, range, k), 0);
    // what it takes to cross: 83 k D^2
    ck_assert_double_eq_tol(
        cs_barrier_energy(CS_BARRIER_CORE * range, range, k) / (k * range * range), 83, 0.005);
}

TEST(blocks_slide_and_creep_as_the_law_says) {
    const double ev = 1e-3, mu = 0.3;
    const struct methods methods =
        methods_find(&(struct methods_query){.test = "slope by force",
                                             .without = CS_EXPLICIT_OUTER | CS_NOT_GALILEAN,
                                             .dt = 0.004,
                                             .dt_for = CS_IMPLICIT,
                                             .rtol = 1e-6});
    for (size_t m = 0; m < methods.n; m++)
        for (double tangent = 0.1; tangent < 0.55; tangent += 0.1) {
            if (fabs(tangent - mu) < 0.01)
                continue;
            struct fixture block;
            fixture_open_slope(&block, methods.list[m].text, "\"friction_law\": \"smooth\"",
                               tangent, "");
            fixture_frames(&block, 15);
            const double before = fixture_sliding(&block, tangent);
            fixture_frames(&block, 15);
            const double v = fixture_sliding(&block, tangent);
            const double cosine = cos(atan(tangent));
            if (tangent > mu)
                ck_assert_msg(fabs((v - before) / 0.25 - G * cosine * (tangent - mu)) <
                                  0.02 * G * mu,
                              "%s: slope %.1f, acceleration %.4f", methods.list[m].text,
                              tangent, (v - before) / 0.25);
            else
                ck_assert_msg(
                    fabs(v / (ev * tangent / sqrt(mu * mu - tangent * tangent)) - 1) < 0.05,
                    "%s: slope %.1f, creep %.3g m/s", methods.list[m].text, tangent, v);
            fixture_close(&block);
        }
}

/* At one step a frame, whatever the step is against m ev/(mu N): what rests may creep for 30 s
 * and be 0.2 mm away. */
TEST(what_rests_creeps_by_less_than_a_fifth_of_a_millimetre) {
    // at their defaults these let it creep 1.3 to 80 times as fast
    static const char *const accurate[] = {"ark-dirk:rtol=1e-6", "ark-imex:rtol=1e-6",
                                           "cvode-bdf:rtol=1e-6", NULL};
    const double ev = 5e-6, tangent = 0.2, mu = 0.3;
    const struct methods methods = methods_find(
        &(struct methods_query){.test = "small creep",
                                .with = CS_IMPLICIT,
                                .without = CS_ADAPTIVE | CS_EXPLICIT_OUTER | CS_NOT_GALILEAN,
                                .more = accurate});
    ck_assert_uint_ge(methods.n_by_trait, 5);
    for (size_t m = 0; m < methods.n; m++) {
        struct fixture block;
        fixture_open_slope(&block, methods.list[m].text, "\"friction_speed\": 5e-6", tangent,
                           "");
        fixture_frames(&block, 120);
        const double begin[2] = {block.x[0], block.x[block.n]};
        fixture_frames(&block, 180);
        const double way = hypot(block.x[0] - begin[0], block.x[block.n] - begin[1]);
        const double expected = 3 * ev * tangent / sqrt(mu * mu - tangent * tangent);
        ck_assert_msg(fabs(way / expected - 1) < 0.01 && 10 * way < 2e-4, "%s: %g mm in 3 s",
                      methods.list[m].text, 1e3 * way);
        fixture_close(&block);
    }
}

/* also those that move particles place by place see how fast the belt is */
TEST(belts_carry_what_lies_on_them) {
    static const char *const methods[] = {"rk4", "implicit-linearised:dt=0.004",
                                          "backward-euler:dt=0.004", "xpbd:dt=0.004"};
    for (size_t m = 0; m < LENGTH(methods); m++) {
        struct fixture block;
        fixture_open_slope(
            &block, methods[m], "\"friction_law\": \"smooth\"", 0,
            "{\"from\": 0, \"to\": 1, \"move\": {\"collider\": 0, \"path\": [{\"at\": 1, "
            "\"point\": [0.5, 0, 0]}]}}");
        fixture_frames(&block, 6);
        // mu g t until it has the belt's 0.5 m/s
        const double early = fixture_sliding(&block, 0);
        ck_assert_msg(fabs(early - 0.3 * G * 0.1) < 0.01 * 0.3 * G * 0.1, "%s: %g m/s",
                      methods[m], early);
        fixture_frames(&block, 24);
        ck_assert_msg(fabs(fixture_sliding(&block, 0) - 0.5) < 1e-3, "%s: %g m/s", methods[m],
                      fixture_sliding(&block, 0));
        fixture_close(&block);
    }
}

/* a sheet in the range of a plane, soft enough for a smooth motion over a step */
#define SHEET                                                                                  \
    "{\"bodies\": [{\"cloth\": {\"grid\": [4, 4], \"start\": \"flat\", \"place\": "            \
    "{\"translate\": [0, 0.12, 0]}}, \"mass\": {\"particle\": 0.1}, \"springs\": "             \
    "{\"stretch\": 40, \"shear\": 15, \"bend\": 5, \"damping\": 0}}],"                         \
    " \"colliders\": [{\"floor\": {\"height\": 0}, \"thickness\": 0.2}],"                      \
    " \"contact\": {\"law\": \"force\", \"stiffness\": 40}, \"time\": {\"fps\": 10}}"

enum { VALUES = 6 * 16 };

static void end_state(const char *name, double h, double state[VALUES]) {
    struct fixture sheet;
    char integrator[120];
    methods_set(integrator, name, "dt", h);
    fixture_open(&sheet, integrator, SHEET);
    cs_perturb_smooth(sheet.system, 0.01, 0.2);
    fixture_start(&sheet);
    fixture_frames(&sheet, 3);
    memcpy(state, sheet.x, VALUES * sizeof *state);
    fixture_close(&sheet);
}

TEST(orders_hold_in_contact) {
    const struct methods methods = methods_find(
        &(struct methods_query){.test = "order in contact",
                                .without = CS_ADAPTIVE | CS_EXPLICIT_OUTER | CS_NOT_GALILEAN,
                                .residual = 1e-12});
    double reference[VALUES];
    end_state("rk4", 2e-4, reference);
    for (size_t m = 0; m < methods.n; m++) {
        const struct method_asked *method = methods.list + m;
        const double h = methods_step(method->order);
        double state[VALUES], error[2];
        for (int k = 0; k < 2; k++) {
            end_state(method->text, h / (1 + k), state);
            error[k] = cs_rms_difference(state, reference, VALUES);
        }
        const double order = log2(error[0] / error[1]);
        ck_assert_msg(fabs(order - method->order) < 0.2,
                      "%s: order %.3f in contact, stated %u (errors %.3g, %.3g)", method->text,
                      order, method->order, error[0], error[1]);
    }
}

/* The passes of a position-level method settle with contact among them, beside implicit Euler:
 * the distance to it is one of second order in a step. */
TEST(passes_settle_beside_implicit_euler) {
    double apart[2];
    for (int k = 0; k < 2; k++) {
        const double h = 2e-3 / (1 + k);
        double few[VALUES], many[VALUES], euler[VALUES];
        end_state("xpbd:iterations=60", h, few);
        end_state("xpbd:iterations=240", h, many);
        end_state("backward-euler:rtol=1e-12", h, euler);
        apart[k] = cs_rms_difference(many, euler, VALUES);
        ck_assert_double_le(cs_rms_difference(few, many, VALUES), 1e-3 * apart[k]);
    }
    ck_assert_double_ge(log2(apart[0] / apart[1]), 0.8);
}

/* the energy that a straight move of one particle does not see, as step_check.h has it */
static bool move_is_seen(const struct cs_system *system, double h, const double from[3],
                         const double to[3]) {
    const struct cs_collider_params *params = system->collider_params;
    struct cs_posed_collider collider;
    double g[3], hessian[6], move[3], worst = 0;
    cs_posed_collider_at(system, 0, h, &collider);
    const double d = cs_posed_collider_smooth_distance(&collider, from, g, hessian);
    const struct cs_barrier barrier = cs_barrier_at(d, params->range, params->k);
    const double held = cs_barrier_energy(d, params->range, params->k);
    for (int c = 0; c < 3; c++)
        move[c] = to[c] - from[c];
    const double way = sqrt(cs_vec3_dot(move, move));
    const int points = 1 + (int)fmin(way / (0.5 * params->range), 63);
    for (int j = 1; j <= points; j++) {
        double p[3];
        for (int c = 0; c < 3; c++)
            p[c] = from[c] + j / (double)points * move[c];
        const double s = d - cs_posed_collider_smooth_distance(&collider, p, g, hessian);
        worst = fmax(worst, fabs(cs_barrier_energy(d - s, params->range, params->k) - held -
                                 barrier.force * s - 0.5 * barrier.stiffness * s * s));
    }
    return worst <= 0.02 * (0.5 * system->mass[0] * way * way / (h * h) + held);
}

/* whatever is told from a whole row of particles at once */
TEST(steps_are_judged_as_stated) {
    static const char *const shapes[] = {
        "{\"floor\": {\"height\": 0}",
        "{\"sphere\": {\"centre\": [0, -0.3, 0], \"radius\": 0.3}",
        "{\"box\": {\"centre\": [0, -0.2, 0], \"size\": [0.4, 0.4, 0.4], \"radius\": 0.05}"};
    for (size_t k = 0; k < LENGTH(shapes); k++) {
        struct fixture one;
        uint32_t seen = 0, moves = 0;
        fixture_open(
            &one, "rk4",
            "{\"bodies\": [{\"cloth\": {\"grid\": [1, 1], \"place\": {\"translate\": [0, 1, "
            "0]}}, \"mass\": {\"particle\": 0.01}}], \"colliders\": [%s, \"thickness\": "
            "0.02}], \"contact\": {\"law\": \"force\", \"stiffness\": 200}}",
            shapes[k]);
        for (int i = 0; i < 2000; i++) {
            const double length = 0.1 * pow(10, -3 * fabs(sin(1.7 * i))),
                         h = i % 2 ? 0.01 : 1e-3;
            double from[3], to[3];
            for (int c = 0; c < 3; c++) {
                from[c] = c == 1 ? 0.012 + 0.012 * sin(2.3 * i) : 0.02 * sin(0.7 * i + c);
                to[c] = from[c] + length * cos(1.1 * i + 2 * c);
            }
            const bool expected = move_is_seen(one.system, h, from, to);
            ck_assert_msg(cs_collider_contact_resolves_step(one.system, 0, from, h, to) ==
                              expected,
                          "shape %zu, move %d of %g m: expected %d", k, i, length, expected);
            seen += expected, moves++;
        }
        ck_assert_uint_gt(seen, moves / 10);
        ck_assert_uint_lt(seen, moves * 9 / 10);
        fixture_close(&one);
    }
}

/* a soft ball that falls 0.6 m on a floor, friction and damping 0 */
#define BALL                                                                                   \
    "{\"bodies\": [{\"mesh\": {\"shape\": \"sphere\", \"detail\": 3, \"scale\": [0.4, 0.4, "   \
    "0.4], \"place\": {\"translate\": [0, 0.8, 0]}}, \"network\": {\"placement\": "            \
    "\"nearest\", \"springs\": 4}, \"mass\": {\"total\": 1}, \"springs\": {\"stretch\": 400, " \
    "\"bend\": 0, \"damping\": 0}}], \"colliders\": [{\"floor\": {\"height\": 0}, "            \
    "\"thickness\": 0.02}], \"contact\": \"force\"}"

/* these damp by themselves */
static bool is_damped(const char *method) {
    static const char *const names[] = {"implicit-linearised",
                                        "implicit-block",
                                        "backward-euler",
                                        "bdf2",
                                        "tr-bdf2",
                                        "sdirk2",
                                        "cvode-bdf",
                                        "xpbd"};
    for (size_t k = 0; k < LENGTH(names); k++)
        if (methods_is(method, names[k]))
            return true;
    return false;
}

TEST(bounces_make_no_energy) {
    static const char *const more[] = {"implicit-linearised:dt=0.016666666666666666",
                                       "xpbd:dt=0.016666666666666666", NULL};
    const struct methods methods =
        methods_find(&(struct methods_query){.test = "bounce",
                                             .without = CS_EXPLICIT_OUTER,
                                             .dt = 1 / 240.0,
                                             .dt_for = CS_IMPLICIT,
                                             .rtol = 1e-3,
                                             .more = more});
    for (size_t m = 0; m < methods.n; m++) {
        const char *method = methods.list[m].text;
        struct fixture ball;
        fixture_open(&ball, method, BALL);
        fixture_start(&ball);
        const double start = fixture_energy(&ball), most = is_damped(method) ? 1.01 : 1.05;
        double largest = start;
        for (int frame = 0; frame < 32; frame++) {
            fixture_frames(&ball, 1);
            largest = fmax(largest, fixture_energy(&ball));
        }
        ck_assert_msg(largest <= most * start, "%s: %.4f of the start's energy", method,
                      largest / start);
        // it touched the floor and came back up
        double up = 0;
        for (size_t i = 0; i < ball.n; i++)
            up += ball.v[ball.n + i];
        // implicit-block falls too slowly to be there yet
        ck_assert_msg(up > 0 || methods.list[m].traits & CS_NOT_GALILEAN, "%s: it still falls",
                      method);
        fixture_close(&ball);
    }
}

/* Stiff springs at a long step: the stage of a Rosenbrock method lands on loads that are never
 * there. Friction under them made 7000 times the energy of the start. */
TEST(friction_in_a_stage_makes_no_energy) {
    struct fixture ball;
    fixture_open(
        &ball, "ros2:dt=0.016666666666666666",
        "{\"bodies\": [{\"mesh\": {\"shape\": \"sphere\", \"detail\": 6, \"scale\": "
        "[0.4, 0.4, 0.4], \"place\": {\"translate\": [0, 0.6, 0]}}, \"network\": "
        "{\"placement\": \"nearest\", \"springs\": 4}, \"mass\": {\"total\": 1}, "
        "\"springs\": {\"stretch\": 1e5, \"bend\": 0, \"damping\": 0}}], \"colliders\": "
        "[{\"floor\": {\"height\": 0}, \"thickness\": 0.02, \"friction\": 0.9}], "
        "\"contact\": \"force\"}");
    fixture_start(&ball);
    const double start = fixture_energy(&ball);
    for (int frame = 0; frame < 26; frame++) {
        fixture_frames(&ball, 1);
        ck_assert_double_le(fixture_energy(&ball), 1.001 * start);
    }
    fixture_close(&ball);
}

TEST(methods_with_explicit_outer_forces_are_refused) {
    struct fixture ball;
    struct cs_error error = {0};
    fixture_open(&ball, "velocity-verlet", BALL);
    struct cs_integrator method = *ball.session.method.integrator;
    ck_assert_int_eq(cs_plan_check(ball.session.scene, &method, &error), CS_OK);
    method.traits |= CS_EXPLICIT_OUTER;
    ck_assert_int_eq(cs_plan_check(ball.session.scene, &method, &error), CS_ERR_SCENE);
    ck_assert_ptr_nonnull(strstr(error.message, "contact.law"));
    fixture_close(&ball);
}

/* the distance of the nearest triangle of a grid of 13 x 13 from the origin */
static double nearest_triangle(const double *x) {
    enum { SIDE = 13, ALL = SIDE * SIDE };
    double least = HUGE_VAL;
    for (uint32_t row = 0; row + 1 < SIDE; row++)
        for (uint32_t column = 0; column + 1 < SIDE; column++)
            for (uint32_t half = 0; half < 4; half++) {
                // both ways to cut a cell
                static const uint32_t cut[4][3] = {{0, 1, 2}, {1, 3, 2}, {0, 1, 3}, {0, 3, 2}};
                double p[4][3] = {{0}};
                for (int k = 0; k < 3; k++) {
                    const uint32_t corner = cut[half][k];
                    const size_t i = (row + corner / 2) * SIDE + column + corner % 2;
                    for (size_t c = 0; c < 3; c++)
                        p[k + 1][c] = x[c * ALL + i];
                }
                least = fmin(least, cs_exact_distance_squared(CS_PAIR_POINT_TRIANGLE,
                                                              (const double(*)[3])p));
            }
    return sqrt(least);
}

#define BALLED                                                                                 \
    "{\"bodies\": [{\"cloth\": {\"grid\": [13, 13], \"start\": \"flat\", \"place\": "          \
    "{\"translate\": [0.05, 0.5, 0.02], \"rotate\": [0, 0.2, 0, 1]}}, \"mass\": "              \
    "{\"areal_density\": 0.3}, \"springs\": {\"stretch\": 1000, \"shear\": 300, "              \
    "\"bend\": 12, \"damping\": 0.005}}], \"colliders\": [{\"sphere\": {\"centre\": "          \
    "[0, 0, 0], \"radius\": 0.35}, \"friction\": 0.3}], \"contact\": \"force\"}"

/* A coarse cloth on a ball of 0.35 m, the range left to the mesh: what hangs between the
 * particles sinks by s^2/8R at most, which is below a quarter of the range, and needs no points
 * of its own. */
TEST(no_triangle_comes_into_a_ball) {
    struct fixture cloth;
    double least = HUGE_VAL;
    fixture_open(&cloth, "implicit-linearised:dt=0.004166666666666667", BALLED);
    ck_assert_ptr_null(cloth.system->contact_samples);
    fixture_start(&cloth);
    for (int frame = 0; frame < 45; frame++) {
        fixture_frames(&cloth, 1);
        least = fmin(least, nearest_triangle(cloth.x));
    }
    ck_assert_double_gt(least, 0.35 + 0.01);
    fixture_close(&cloth);
}
