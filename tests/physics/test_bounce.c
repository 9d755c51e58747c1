/* Floor with restitution and friction: what a particle, and a body that lands all at once, have
 * left after the bounce; and the rest that contact by force comes to. */
#include "fixture.h"

#include <math.h>
#include <stdio.h>

#define E       0.6
#define DROP    0.8
#define GRAVITY 9.81

/* on a floor at y = 0; a flat start is all particles at one height */
#define SCENE                                                                                  \
    "{\"bodies\": [{\"cloth\": {\"grid\": [%d, %d], \"start\": \"flat\", \"velocity\": [%g, "  \
    "0, 0], \"place\": {\"translate\": [0, 0.8, 0]}}, \"mass\": {\"total\": 1}, %s}],"         \
    " \"contact\": \"project\", \"colliders\": [{\"floor\": {}, \"absorption\": %g, "          \
    "\"friction\": %g}],"                                                                      \
    " \"time\": {\"fps\": 1000}}"

/* a particle alone, and bodies of springs and of shape matching */
static const struct {
    const char *method, *law;
    int columns, rows;
} bodies[] = {{"symplectic-euler", "\"springs\": {}", 1, 1},
              {"symplectic-euler", "\"springs\": {}", 4, 3},
              {"shape-matching", "\"shape_matching\": {\"alpha\": 0.3}", 4, 3},
              {"shape-matching", "\"shape_matching\": {\"alpha\": 1}", 4, 3}};
enum { BODIES = sizeof bodies / sizeof *bodies };

static void open_body(struct fixture *body, int k, double dt, double speed, double absorption,
                      double friction) {
    char method[64];
    snprintf(method, sizeof method, "%s:dt=%.17g", bodies[k].method, dt);
    fixture_open(body, method, SCENE, bodies[k].columns, bodies[k].rows, speed, bodies[k].law,
                 absorption, friction);
    fixture_start(body);
}

/* runs until the first contact, and gives the speed with which it was met */
static double fall(struct fixture *body) {
    double speed = 0;
    while (body->session.run.counts.projected_particles == 0) {
        speed = -body->v[body->n];
        ck_assert_uint_lt(body->session.run.frame, 1000);
        fixture_frames(body, 1);
    }
    // the step that met the floor was accelerated too
    return speed + GRAVITY / body->system->scene->time.fps;
}

/* height that is reached after the first bounce */
static double apex(struct fixture *body) {
    double highest = 0;
    fall(body);
    while (body->v[body->n] > 0) {
        fixture_frames(body, 1);
        for (size_t i = 0; i < body->n; i++)
            highest = fmax(highest, body->x[body->n + i]);
    }
    return highest;
}

/* It comes up to e^2 of the height; what the step that meets the floor leaves out of the way
 * down, or adds to the speed, is of first order in h. */
TEST(bounce_is_e_squared_of_the_drop) {
    for (int k = 0; k < BODIES; k++)
        for (double h = 1e-3; h > 1e-5; h /= 10) {
            struct fixture body;
            open_body(&body, k, h, 0, -E, 0);
            const double bound = sqrt(2 * GRAVITY * DROP) * (1 + E) * h;
            const double height = apex(&body);
            ck_assert_msg(fabs(height - E * E * DROP) <= bound,
                          "body %d, h = %g: %.6f m, expected %.6f m", k, h, height,
                          E * E * DROP);
            fixture_close(&body);
        }
}

/* Coulomb: the tangential speed loses friction times the change of the normal speed, (1 + e)
 * times that of the impact; all of it where that is more. */
TEST(tangential_speed_is_lost_by_the_impact) {
    static const struct {
        double speed, absorption, friction;
    } rows[] = {{2, -E, 0.1}, {2, -E, 0}, {2, 1, 0.2}, {-3, -1, 0.1}, {0.5, -E, 0.2}};
    for (int k = 0; k < BODIES; k++)
        for (size_t r = 0; r < sizeof rows / sizeof *rows; r++) {
            struct fixture body;
            open_body(&body, k, 1e-3, rows[r].speed, rows[r].absorption, rows[r].friction);
            const double impact = fall(&body);
            const double share =
                rows[r].absorption < 0 ? 1 - rows[r].absorption : rows[r].absorption;
            const double left =
                fmax(fabs(rows[r].speed) - rows[r].friction * share * impact, 0);
            for (size_t i = 0; i < body.n; i++) {
                ck_assert_double_eq_tol(body.v[i], copysign(left, rows[r].speed), 1e-11);
                ck_assert_double_eq_tol(body.v[body.n + i], (share - 1) * impact, 1e-11);
            }
            fixture_close(&body);
        }
}

/* A box of springs that falls by 5 cm; %s: more keys. */
#define BOX                                                                                    \
    "{\"bodies\": [{\"mesh\": {\"shape\": \"box\", \"detail\": 3, \"scale\": [0.3, 0.3, "      \
    "0.3], \"place\": {\"translate\": [0, 0.2, 0]}}, \"mass\": {\"total\": 1}, \"springs\": "  \
    "{\"stretch\": 400, \"bend\": 0, \"damping\": 0.4}, \"network\": {}}], \"colliders\": "    \
    "[{\"floor\": {}, \"friction\": 0.5}]%s}"

/* A scene that names no law comes to rest: it bounced at 0.4 m/s for 6 s. Velocities are those
 * of the motion. */
TEST(contact_by_default_comes_to_rest) {
    static const char *const methods[] = {"velocity-verlet", "tr-bdf2", "implicit-midpoint",
                                          "implicit-linearised:dt=frame"};
    enum { LAST = 340 };
    for (size_t m = 0; m < sizeof methods / sizeof *methods; m++) {
        struct fixture box;
        fixture_open(&box, methods[m], BOX, "");
        fixture_start(&box);
        fixture_frames(&box, LAST);
        double before = 0, fastest = 0;
        for (size_t i = 0; i < box.n; i++) {
            before += box.x[box.n + i];
            fastest = fmax(fastest, fabs(box.v[box.n + i]));
        }
        fixture_frames(&box, 1);
        double rise = -before;
        for (size_t i = 0; i < box.n; i++)
            rise += box.x[box.n + i];
        ck_assert_msg(fastest < 1e-3, "%s: %.3g m/s", methods[m], fastest);
        ck_assert_double_le(fabs(rise) / (double)box.n, 1e-5);
        fixture_close(&box);
    }
}

/* sqrt(m/k) for the stiffness that is given; a law or a damping that is named stays as it is.
 */
TEST(damping_is_chosen_where_nobody_names_law_or_damping) {
    static const struct {
        const char *contact;
        double damping;
    } rows[] = {{", \"contact\": {\"stiffness\": 175}", 0.010101525445522107},
                {", \"contact\": {\"stiffness\": 175, \"damping\": 0}", 0},
                {", \"contact\": {\"damping\": 0.25}", 0.25},
                {", \"contact\": {\"law\": \"force\"}", 0},
                {", \"contact\": \"force\"", 0}};
    for (size_t r = 0; r < sizeof rows / sizeof *rows; r++) {
        struct fixture box;
        fixture_open(&box, "rk4", BOX, rows[r].contact);
        ck_assert_double_eq_tol(box.system->scene->contact.damping, rows[r].damping, 1e-15);
        fixture_close(&box);
    }
}
