/* Floor with restitution and friction: what a particle, and a body that lands all at once, have
 * left after the bounce; and the rest that contact by force comes to. */
#include "fixture.h"

#include "model/contact/barrier_law.h"
#include "model/contact/step_check.h"
#include "scene/contact_keys.h"
#include "scene/scene.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

#define E       0.6
#define DROP    0.8
#define GRAVITY 9.81
#define STEP    0.02

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
        ck_assert_double_eq_tol(box.system->scene->contact->damping, rows[r].damping, 1e-15);
        fixture_close(&box);
    }
}

/* A sheet of 4 x 4 particles at the height 0.09 over a floor with a range of 0.1 m. */
#define LOW                                                                                    \
    "{\"bodies\": [{\"cloth\": {\"grid\": [4, 4], \"start\": \"flat\", \"place\": "            \
    "{\"translate\": [0, 0.09, 0]}}, \"mass\": {\"particle\": 0.1}}], \"colliders\": "         \
    "[{\"floor\": {}, \"thickness\": 0.1}], \"contact\": {\"stiffness\": 100}}"

/* m, height at which a particle that comes down to it in STEP misses `ratio` times its energy
 * with the force and the stiffness of the begin, by halving */
static double height_that_misses(const struct fixture *sheet, double ratio) {
    const double range = 0.1, k = 100, d = sheet->x[sheet->n];
    const struct cs_barrier barrier = cs_barrier_at(d, range, k);
    const double held = cs_barrier_energy(d, range, k);
    const double spare = CS_SPARE_BESIDE_REBOUNDS * cs_barrier_energy(0.5 * range, range, k);
    double low = 1e-3, high = d;
    for (int halving = 0; halving < 60; halving++) {
        const double at = 0.5 * (low + high), s = d - at;
        const double missed = cs_barrier_energy(at, range, k) - held - barrier.force * s -
                              0.5 * barrier.stiffness * s * s;
        const double energy = 0.5 * sheet->system->mass[0] * s * s / (STEP * STEP) + held;
        *(missed > ratio * (energy + spare) ? &low : &high) = at;
    }
    return high;
}

/* Returns whether a step is resolved that takes the first `divers` particles down so far, and
 * the others aside by as much. */
static bool dive(const struct fixture *sheet, uint32_t divers, double ratio) {
    const size_t n = sheet->n;
    double x[48];
    const double way = sheet->x[n] - height_that_misses(sheet, ratio);
    memcpy(x, sheet->x, sizeof x);
    for (size_t i = 0; i < n; i++)
        x[i < divers ? n + i : i] += i < divers ? -way : way;
    return cs_collider_contact_resolves_step(sheet->system, 0, sheet->x, STEP, x);
}

/* In a scene with impacts a tenth is allowed in the sum of all, and three times its energy to
 * one; without impacts, a fiftieth to each. */
TEST(few_particles_do_not_cut_the_step_of_all) {
    static const char *const methods[] = {"implicit-linearised:dt=0.02", "rk4:dt=0.01"};
    for (int m = 0; m < 2; m++) {
        struct fixture sheet;
        fixture_open(&sheet, methods[m], LOW);
        fixture_start(&sheet); // sets the impacts up
        ck_assert_int_eq(sheet.system->rebounds != NULL, m == 0);
        ck_assert(dive(&sheet, 0, 0.5));
        ck_assert_int_eq(dive(&sheet, 1, 0.9), m == 0);
        ck_assert_int_eq(dive(&sheet, 16, 0.09), m == 0);
        ck_assert(!dive(&sheet, 4, 0.9));
        ck_assert(!dive(&sheet, 16, 0.11));
        ck_assert(!dive(&sheet, 1, 3.3));
        fixture_close(&sheet);
    }
}

/* A ball pushes through a curtain: few of its contacts are impacts at a time. */
#define CURTAIN                                                                                \
    "{\"bodies\": [{\"cloth\": {\"grid\": [28, 32], \"size\": [1, 1.2]}, \"mass\": "           \
    "{\"areal_density\": 0.25}, \"springs\": {\"stretch\": 1000, \"shear\": 300, \"bend\": "   \
    "5, \"damping\": 0.01}, \"pins\": [\"top\"]}], \"colliders\": [{\"sphere\": {\"centre\": " \
    "[0, -0.15, -0.45], \"radius\": 0.2}, \"thickness\": 0.008}], \"events\": [{\"at\": 0.1, " \
    "\"move\": {\"collider\": 0, \"path\": [{\"at\": 0.9, \"point\": [0, 0.05, 0.6]}]}}], "    \
    "\"forces\": {\"drag\": 0.12}}"

/* The account has the work of all contacts of a step with impacts: that of an independent
 * method, which has none. */
TEST(work_of_contacts_beside_impacts_counts) {
    static const char *const methods[] = {"velocity-verlet",
                                          "implicit-linearised:dt=0.0041667"};
    double given[2];
    for (int m = 0; m < 2; m++) {
        struct fixture curtain;
        fixture_open(&curtain, methods[m], CURTAIN);
        fixture_start(&curtain);
        fixture_frames(&curtain, 40);
        given[m] = curtain.session.run.energy_input.given[CS_SOURCE_FORCES];
        fixture_close(&curtain);
    }
    ck_assert_double_gt(given[0], 0.05);
    ck_assert_msg(fabs(given[1] / given[0] - 1) < 0.15, "%g J, expected %g J", given[1],
                  given[0]);
}
