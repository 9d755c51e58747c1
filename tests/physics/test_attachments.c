/* Particles that a collider carries, and grabs that turn: on their arc to rounding, with every
 * method at its order, and with the work of what moves them in the ledger. */
#include "eventful.h"
#include "methods.h"

#include "base/vec3.h"
#include "model/contact/posed_collider.h"
#include "sim/energy_ledger.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

#define SPIN 3.0

/* a hanging cloth whose upper edge a sphere carries that moves and turns; %s: of the springs.
 * keys: of the move */
#define CARRIED_BY(keys)                                                                       \
    "{\"bodies\": [{\"cloth\": {\"grid\": [4, 4]}, \"mass\": {\"particle\": 0.1},"             \
    " \"springs\": {\"stretch\": 40, \"shear\": 15, \"bend\": 5%s},"                           \
    " \"pins\": [{\"at\": \"top\", \"to\": {\"collider\": 0}}]}],"                             \
    " \"colliders\": [{\"sphere\": {\"centre\": [0.1, 0.8, 0.05], \"radius\": 0.05}}],"        \
    " \"events\": [{\"from\": 0, \"to\": 10, \"move\": {\"collider\": 0," keys                 \
    " \"spin\": [0, 3, 0], \"path\": [{\"at\": 10, \"point\": [5, 0, -2.5]}]}}],"              \
    " \"time\": {\"fps\": %d}}"
#define CARRIED CARRIED_BY("")
/* about a hinge that is not in the sphere, as a door */
#define HINGED CARRIED_BY("\"centre\": [0.7, -0.2, -0.3],")
static const double sphere[3] = {0.1, 0.8, 0.05}, hinge[3] = {0.7, -0.2, -0.3};

/* Position and velocity at t of a point that starts at p and turns about a centre. */
static void carried_at(const double centre[3], const double p[3], double t, double x[3],
                       double v[3]) {
    const double arm[3] = {p[0] - centre[0], p[1] - centre[1], p[2] - centre[2]};
    const double c = cos(SPIN * t), s = sin(SPIN * t);
    const double turned[3] = {c * arm[0] + s * arm[2], arm[1], -s * arm[0] + c * arm[2]};
    const double rate[3] = {0.5, 0, -0.25};
    for (int k = 0; k < 3; k++) {
        x[k] = centre[k] + rate[k] * t + turned[k];
        v[k] = rate[k] + (k == 0 ? SPIN * turned[2] : k == 2 ? -SPIN * turned[0] : 0);
    }
}

/* Each held particle at a time in s; text: of the method. */
static void check_carried(const struct fixture *cloth, const char *text, const double centre[3],
                          double t) {
    const size_t n = cloth->n;
    const double *start = cloth->system->start;
    for (size_t i = 0; i < 4; i++) {
        double x[3], v[3];
        carried_at(centre, (const double[3]){start[i], start[n + i], start[2 * n + i]}, t, x,
                   v);
        for (size_t c = 0; c < 3; c++)
            ck_assert_msg(fabs(cloth->x[c * n + i] - x[c]) < 1e-14 &&
                              fabs(cloth->v[c * n + i] - v[c]) < 1e-13,
                          "%s: %.17g at %.17g m/s, not %.17g at %.17g", text,
                          cloth->x[c * n + i], cloth->v[c * n + i], x[c], v[c]);
    }
}

/* With every method, frame by frame. */
static void check_all(const char *scene, const double centre[3]) {
    const struct methods methods = methods_find(&(struct methods_query){.test = "moves"});
    for (size_t k = 0; k < methods.n; k++) {
        struct fixture cloth;
        fixture_open(&cloth, methods.list[k].text, scene, ", \"damping\": 0.01", 60);
        fixture_start(&cloth);
        for (int frame = 1; frame < 20; frame++) {
            fixture_frames(&cloth, 1);
            check_carried(&cloth, methods.list[k].text, centre, frame / 60.0);
        }
        fixture_close(&cloth);
    }
}

TEST(carried_particles_are_on_their_arc) {
    check_all(CARRIED, sphere);
}

/* A point at radius r goes r w t along its arc, and the sphere itself too. */
TEST(a_hinge_is_the_centre_of_arcs) {
    struct cs_posed_collider collider;
    struct fixture cloth;
    double x[3], v[3], found[3];
    check_all(HINGED, hinge);
    fixture_open(&cloth, "rk4", HINGED, "", 60);
    fixture_start(&cloth);
    fixture_frames(&cloth, 40);
    cs_posed_collider_at(cloth.system, 0, 40 / 60.0, &collider);
    cs_posed_collider_velocity(&collider, collider.centre, found);
    carried_at(hinge, sphere, 40 / 60.0, x, v);
    for (int c = 0; c < 3; c++) {
        ck_assert_double_eq_tol(collider.centre[c], x[c], 1e-14);
        ck_assert_double_eq_tol(found[c], v[c], 1e-13);
    }
    fixture_close(&cloth);
}

enum { VALUES = 6 * 16 };

static void end_state(const char *method, const char *damping, double state[VALUES]) {
    struct fixture cloth;
    fixture_open(&cloth, method, CARRIED, damping, 10);
    fixture_start(&cloth);
    fixture_frames(&cloth, 3);
    memcpy(state, cloth.x, VALUES * sizeof *state);
    fixture_close(&cloth);
}

/* Forces depend on t then. Methods with a spring model of their own see x + h v, and are of
 * order 1 as ever. With damping what holds the cloth has an acceleration that the force feels.
 */
static void check_orders(const char *damping, bool damped) {
    const struct methods methods = methods_find(
        &(struct methods_query){.test = "order", .without = CS_ADAPTIVE, .residual = 1e-12});
    double reference[VALUES], state[VALUES];
    end_state("dopri5:rtol=1e-13", damping, reference);
    for (size_t i = 0; i < methods.n; i++) {
        const struct method_asked *method = methods.list + i;
        const uint32_t order = damped ? method->order_damped : method->order;
        const double h =
            method->traits & CS_NOT_GALILEAN ? 2.5e-5 : methods_step(method->order);
        double error[2];
        for (int k = 0; k < 2; k++) {
            char text[120];
            methods_set(text, method->text, "dt", k ? h / 2 : h);
            end_state(text, damping, state);
            error[k] = cs_rms_difference(state, reference, VALUES);
        }
        const double slope = log2(error[0] / error[1]);
        ck_assert_msg(slope > order - 0.15 && error[1] < 0.02,
                      "%s: order %.3f, stated %u (errors %.3g, %.3g)", method->text, slope,
                      order, error[0], error[1]);
    }
}

TEST(order_is_that_of_the_method) {
    check_orders("", false);
}

TEST(order_with_dampers_at_what_turns) {
    check_orders(", \"damping\": 0.3", true);
}

/* Methods with error control come as near as their tolerance. */
TEST(adaptive_methods_agree) {
    methods_check_agreement(end_state, ", \"damping\": 0.1", VALUES);
}

/* A particle on a spring to a turning pivot at a = 0.3 m: at r = k (a + L) / (k - m w^2) the
 * spring bears m w^2 r, and the particle goes round with it. */
TEST(tension_is_centripetal) {
    const double k = 200, m = 0.5, a = 0.3, length = 0.4, w = 5;
    const double r = k * (a + length) / (k - m * w * w);
    struct fixture pair;
    fixture_open(&pair, "rk4:dt=1e-3",
                 "{\"bodies\": [{\"cloth\": {\"grid\": [2, 1], \"size\": [%.17g, 1],"
                 " \"stretch\": [%.17g, 1], \"velocity\": [0, 0, %.17g], \"place\": {"
                 "\"translate\": [%.17g, 0, 0]}}, \"mass\": {\"particle\": %g}, \"springs\":"
                 " {\"stretch\": %g}, \"pins\": [{\"index\": 0, \"to\": {\"collider\": 0}}]}],"
                 " \"colliders\": [{\"sphere\": {\"centre\": [0, 0, 0], \"radius\": 0.1}}], "
                 "\"forces\": {\"gravity\":"
                 " [0, 0, 0]}, \"events\": [{\"from\": 0, \"to\": 9, \"move\": {\"collider\":"
                 " 0, \"spin\": [0, %g, 0]}}]}",
                 length, (r - a) / length, -w * r, (r + a) / 2, m, k, w);
    fixture_start(&pair);
    fixture_frames(&pair, 120);
    double p[3], q[3], d[3];
    for (int c = 0; c < 3; c++) {
        p[c] = pair.x[2 * c];
        q[c] = pair.x[2 * c + 1];
        d[c] = q[c] - p[c];
    }
    ck_assert_double_eq_tol(sqrt(cs_vec3_dot(p, p)), a, 1e-14);
    ck_assert_double_eq_tol(sqrt(cs_vec3_dot(q, q)), r, 1e-7);
    ck_assert_double_eq_tol(k * (sqrt(cs_vec3_dot(d, d)) - length), m * w * w * r, 1e-5);
    ck_assert_double_eq_tol(q[0], r * cos(2 * w), 1e-6);
    fixture_close(&pair);
}

/* What a collider carries without turning is what hangs from it at rest, moved along. */
TEST(carried_straight_is_galilean) {
    static const char *const by[] = {"rk4:dt=2e-3", "implicit-midpoint:dt=2e-3",
                                     "bdf2:dt=2e-3"};
    for (size_t k = 0; k < LENGTH(by); k++) {
        double state[2][VALUES];
        for (int moves = 0; moves < 2; moves++) {
            struct fixture cloth;
            fixture_open(
                &cloth, by[k],
                "{\"bodies\": [{\"cloth\": {\"grid\": [4, 4], \"velocity\": [%d, 0, 0]},"
                " \"mass\": {\"particle\": 0.1}, \"pins\": [{\"at\": \"top-left\","
                " \"to\": {\"collider\": 0}}]}], \"colliders\": [{\"sphere\":"
                " {\"centre\": [0, 9, 0]}}], \"events\": [{\"from\": 0, \"to\": 1,"
                " \"move\": {\"collider\": 0, \"path\": [{\"at\": 1, \"point\":"
                " [%d, 0, 0]}]}}]}",
                2 * moves, 2 * moves);
            fixture_start(&cloth);
            fixture_frames(&cloth, 30);
            memcpy(state[moves], cloth.x, sizeof state[moves]);
            fixture_close(&cloth);
        }
        for (size_t i = 0; i < VALUES / 6; i++)
            state[1][i] -= 1;
        for (size_t i = 0; i < VALUES / 2; i++)
            ck_assert_msg(fabs(state[0][i] - state[1][i]) < 1e-7, "%s: %zu", by[k], i);
    }
}

/* Half a turn about a centre that moves; let go, a particle flies on as it went. */
TEST(grabs_turn) {
    struct fixture dust;
    fixture_open(
        &dust, "rk4", DUST, "0",
        "{\"from\": 0, \"to\": 0.5, \"grab\": {\"particles\": [0, 3], \"relative\": true,"
        " \"centre\": [0.5, 0, 0], \"spin\": [0, 0, 6.283185307179586],"
        " \"path\": [{\"at\": 0.5, \"point\": [0, 0, 1]}]}},"
        "{\"at\": 0.1, \"grab\": {\"particles\": [12, 15], \"spin\": [0, 0, 1]}}");
    const size_t n = dust.n;
    const double x0 = dust.x[0], y0 = dust.x[n], z0 = dust.x[2 * n];
    const double middle = 0.5 * (dust.x[12] + dust.x[15]);
    fixture_start(&dust);
    fixture_frames(&dust, 15); /* a quarter turn */
    ck_assert_double_eq_tol(dust.x[0], 0.5 - y0, 1e-14);
    ck_assert_double_eq_tol(dust.x[n], x0 - 0.5, 1e-14);
    ck_assert_double_eq_tol(dust.x[2 * n], z0 + 0.5, 1e-14);
    ck_assert_double_eq_tol(dust.v[0], -6.283185307179586 * (x0 - 0.5), 1e-13);
    ck_assert_double_eq_tol(dust.v[2 * n], 2, 1e-14);
    ck_assert_double_eq_tol(0.5 * (dust.x[12] + dust.x[15]), middle, 1e-14);
    fixture_frames(&dust, 15);
    const double x = dust.x[0], v = dust.v[n];
    ck_assert_double_eq_tol(x, 1 - x0, 1e-13);
    fixture_frames(&dust, 6);
    ck_assert_double_eq(dust.v[n], v);
    ck_assert_double_eq_tol(dust.x[n], -y0 + 0.1 * v, 1e-13);
    fixture_close(&dust);
}

/* Grabbed to a collider that has turned already: from there on carried, until to. */
TEST(grabs_hold_to_colliders) {
    struct fixture dust;
    fixture_open(&dust, "velocity-verlet",
                 "{\"bodies\": [{\"cloth\": {\"grid\": [4, 4]}, \"mass\": {\"particle\": 0.1},"
                 " \"springs\": {\"stretch\": 0, \"shear\": 0, \"bend\": 0}}], \"forces\":"
                 " {\"gravity\": [0, 0, 0]}, \"colliders\": [{\"box\": {\"centre\": [1, 0, 2],"
                 " \"size\": [0.1, 0.1, 0.1]}}], \"events\": [%s]}",
                 "{\"from\": 0, \"to\": 5, \"move\": {\"collider\": 0, \"spin\": [0, 2, 0]}},"
                 "{\"from\": 0.5, \"to\": 1, \"grab\": {\"particles\": [5], \"to\":"
                 " {\"collider\": 0}}}");
    const double x = dust.x[5], z = dust.x[2 * dust.n + 5];
    fixture_start(&dust);
    fixture_frames(&dust, 60);
    ck_assert_double_eq_tol(dust.x[5], 1 + cos(1) * (x - 1) + sin(1) * (z - 2), 1e-14);
    ck_assert_double_eq_tol(dust.x[2 * dust.n + 5], 2 - sin(1) * (x - 1) + cos(1) * (z - 2),
                            1e-14);
    fixture_frames(&dust, 1);
    ck_assert(dust.system->inv_mass[5] > 0);
    fixture_close(&dust);
}

/* The work of the collider is what the cloth gains. */
static void check_work(const char *scene) {
    struct fixture cloth;
    struct cs_energy_ledger ledger = {0};
    struct cs_error error = {0};
    fixture_open(&cloth, "rk4:dt=1e-3", scene, "", 60);
    cs_energy_ledger_open(&ledger, cloth.system, 0, &error);
    ck_assert_int_eq(error.status, CS_OK);
    cloth.session.settings.run.ledger = &ledger;
    fixture_start(&cloth);
    const double before = cs_energy_ledger_sum(&ledger);
    fixture_frames(&cloth, 30);
    const double gained = cs_energy_ledger_sum(&ledger) - before;
    const double events = ledger.work[CS_WORK_EVENTS], pins = ledger.work[CS_WORK_PINS];
    ck_assert_double_gt(fabs(pins), 0.1);
    ck_assert_double_eq_tol(gained, pins + events, 1e-8);
    ck_assert_double_lt(fabs(ledger.work[CS_WORK_INTEGRATOR]), 1e-8);
    cs_energy_ledger_close(&ledger);
    fixture_close(&cloth);
}

TEST(ledger_has_the_work) {
    check_work(CARRIED);
    check_work(HINGED);
}
