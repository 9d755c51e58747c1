/* Starts inside colliders, which contact.untangle resolves in time: the way is that of a closed
 * form, the energy told is that of the state, and what does not overlap is not concerned. */
#include "fixture.h"
#include "model/contact/barrier_law.h"
#include "model/contact/narrow_phase/contact_pairs.h"
#include "model/contact/posed_collider.h"
#include "model/force/diagnostics.h"
#include "sim/run_state.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

enum { FRAMES = 30 }; /* of 1/60 s: the way */
#define G        9.81
#define K        1000.0
#define RANGE    0.02
#define MASS     0.01
#define UNTANGLE "\"contact\": {\"law\": \"force\", \"stiffness\": 1000, \"untangle\": 0.5}"
#define LOOSE    "\"springs\": {\"stretch\": 0, \"shear\": 0, \"bend\": 0}"
#define POINTS   "\"bodies\": [" POINTS_AT("0, 0, 0") "]"
#define POINTS_AT(where)                                                                       \
    "{\"cloth\": {\"grid\": [2, 2], \"size\": [0.2, 0.2], \"start\": \"flat\", \"place\": "    \
    "{\"translate\": [" where "]}}, \"mass\": {\"particle\": 0.01}, " LOOSE "}"

static const char *const methods[] = {"velocity-verlet:dt=0.001", "rk4:dt=0.002",
                                      "implicit-linearised:dt=0.001",
                                      "implicit-midpoint:dt=0.002"};

/* Part of the way at frame k: from rest to rest. */
static double part_at(int k) {
    const double u = fmin(k / (double)FRAMES, 1);
    return u * u * (3 - 2 * u);
}

/* J that the run says it gave. */
static double told(const struct fixture *points) {
    return points->session.run.energy_input.given[CS_SOURCE_UNTANGLE];
}

static double stored(const struct fixture *points) {
    const struct cs_energy energy =
        cs_diagnostics_energy(points->system, points->session.run.t, points->x, points->v);
    return cs_energy_total(&energy);
}

/* Four loose particles 3 cm under a floor, or in a sphere: they go straight out to where the
 * collider carries them, and the energy is that of the height and of the contact there. */
TEST(way_and_energy_are_those_of_the_closed_form) {
    static const char *const colliders[] = {
        "{\"floor\": {\"height\": 0.03}, \"thickness\": 0.02}",
        "{\"sphere\": {\"centre\": [0, -1, 0], \"radius\": 1.04}, \"thickness\": 0.02}"};
    const double carried = cs_barrier_loaded_distance(RANGE, K, MASS * G),
                 contact = 4 * cs_barrier_energy(carried, RANGE, K);
    for (size_t m = 0; m < 2 * LENGTH(methods); m++) {
        const bool sphere = m % 2;
        struct fixture points;
        fixture_open(&points, methods[m / 2], "{" POINTS ", \"colliders\": [%s], " UNTANGLE "}",
                     colliders[sphere]);
        ck_assert_uint_eq(points.session.initial_penetration.n, 4);
        fixture_start(&points);
        const double start = stored(&points), reach = sqrt(0.1 * 0.1 * 2 + 1);
        // between two particles the sphere comes nearer, hence a thicker layer
        const double way = sphere ? 1.04 - reach + 1.5 * carried : 0.03 + carried;
        for (int k = 1; k <= FRAMES; k++) {
            fixture_frames(&points, 1);
            for (size_t i = 0; i < 4; i++) {
                const double *x = points.x + i;
                const double height =
                    sphere ? sqrt(x[0] * x[0] + (x[4] + 1) * (x[4] + 1) + x[8] * x[8]) - reach
                           : x[4];
                ck_assert_double_eq_tol(height, way * part_at(k), 1e-12);
            }
        }
        // free from the next step on; nothing of the way is left in the velocity
        fixture_frames(&points, 1);
        ck_assert_uint_eq(points.system->n_pinned, 0);
        // between the sphere's points contact may store what a rest can have
        const double rise = MASS * G * way * (sphere ? 4 / reach : 4),
                     rest = sphere ? 4 * MASS * G * carried : contact;
        ck_assert_double_ge(told(&points), (1 - 1e-3) * rise + (sphere ? 0 : rest));
        ck_assert_double_le(told(&points), (1 + 1e-3) * rise + rest);
        ck_assert_double_eq_tol(stored(&points) - start, told(&points), 5e-3 * rise);
        fixture_close(&points);
    }
}

/* In a mesh, at rest or turning about an axis through the way, the nearest face is left along
 * its normal. */
TEST(mesh_is_left_along_the_normal_of_its_nearest_face) {
    for (int turns = 0; turns < 2; turns++) {
        struct fixture points;
        fixture_open(
            &points, "velocity-verlet:dt=0.001",
            "{" POINTS ", \"colliders\": [{\"mesh\": {\"shape\": \"box\", \"scale\": [1, "
            "1, 1], \"place\": {\"translate\": [0, -0.47, 0]}}, \"thickness\": 0.02}], "
            "\"events\": [%s], " UNTANGLE "}",
            turns ? "{\"from\": 0, \"to\": 1, \"move\": {\"collider\": 0, \"spin\": "
                    "[0, 1, 0]}}"
                  : "");
        const struct cs_body_pair_params *pair =
            cs_body_pair_params_of(&points.system->pairs->body_pairs, 0, 1);
        const double way = 0.03 + cs_barrier_loaded_distance(pair->range, pair->k, MASS * G);
        fixture_start(&points);
        for (int k = 1; k <= FRAMES; k++) {
            fixture_frames(&points, 1);
            const double s = turns ? sin(k / 60.0) : 0, c = turns ? cos(k / 60.0) : 1;
            for (size_t i = 0; i < 4; i++) {
                const double *from = points.system->start + i;
                const double place[3] = {c * from[0] + s * from[8], way * part_at(k),
                                         c * from[8] - s * from[0]};
                for (size_t j = 0; j < 3; j++)
                    ck_assert_double_eq_tol(points.x[4 * j + i], place[j], 1e-12);
            }
        }
        fixture_frames(&points, 1);
        ck_assert_double_eq_tol(told(&points), 4 * MASS * G * way, 0.02 * MASS * G);
        fixture_close(&points);
    }
}

/* Bits of the second body, and of all where nothing overlaps, are those of a run without. */
TEST(what_does_not_overlap_is_the_same_to_the_bit) {
    static const struct {
        const char *low, *other, *contact;
    } rows[] = {
        {"0, 0, 0", "3, 0.3, 0", UNTANGLE},
        {"0, 5, 0", "3, 0.3, 0", UNTANGLE},
        {"0, 5, 0", "3, 0.3, 0", "\"contact\": {\"law\": \"force\", \"stiffness\": 1000}"}};
    double last[24] = {0};
    uint64_t forces = 0;
    for (size_t k = 0; k < LENGTH(rows); k++) {
        struct fixture points;
        fixture_open(&points, "velocity-verlet:dt=0.001",
                     "{\"bodies\": [" POINTS_AT("%s") ", " POINTS_AT(
                         "%s") "], \"colliders\": [{\"floor\": {\"height\": 0.03}, "
                               "\"thickness\": 0.02}], "
                               "%s}",
                     rows[k].low, rows[k].other, rows[k].contact);
        fixture_start(&points);
        fixture_frames(&points, 40);
        for (size_t c = 0; c < 6 && k == 1; c++)
            ck_bits(points.x + 8 * c + 4, last + 4 * c, 4, "the other body");
        for (size_t c = 0; c < 6; c++)
            memcpy(last + 4 * c, points.x + 8 * c + 4, 4 * sizeof *last);
        // nothing overlaps: told, and no evaluation more than without the key
        if (k)
            ck_assert(!points.system->events && told(&points) == 0);
        if (k == 1)
            ck_assert(points.session.run.n_notes &&
                      strstr(points.session.run.notes[0], "nothing starts inside"));
        if (k == 2)
            ck_assert_uint_eq(points.session.run.counts.forces, forces);
        forces = points.session.run.counts.forces;
        fixture_close(&points);
    }
}

enum { AROUND = 24, UP = 8 };

/* A tube of radius 0.1 m. */
static void write_tube(void) {
    FILE *file = fopen("tube.obj", "w");
    ck_assert(file != NULL);
    for (int j = 0; j <= UP; j++)
        for (int i = 0; i < AROUND; i++)
            fprintf(file, "v %.9g %.9g %.9g\n", 0.1 * cos(6.283185307179586 * i / AROUND),
                    0.025 * (j - UP / 2), 0.1 * sin(6.283185307179586 * i / AROUND));
    for (int j = 0; j < UP; j++)
        for (int i = 0; i < AROUND; i++) {
            const int a = j * AROUND + i + 1, b = j * AROUND + (i + 1) % AROUND + 1;
            fprintf(file, "f %d %d %d\nf %d %d %d\n", a, a + AROUND, b + AROUND, a, b + AROUND,
                    b);
        }
    fclose(file);
}

/* A tube that lies 10 mm inside a capsule all round is stretched over it: no particle is inside
 * at the end, and what was told is what the springs and the contact hold, as nothing is lost.
 */
TEST(tube_is_drawn_over_a_capsule) {
    static const char *const hard[] = {"velocity-verlet:dt=0.0005", "velocity-verlet:dt=0.001",
                                       "implicit-linearised:dt=0.002", "implicit-linearised",
                                       "implicit-midpoint:dt=0.004"};
    double given[LENGTH(hard)];
    write_tube();
    for (size_t m = 0; m < LENGTH(hard); m++) {
        struct fixture tube;
        fixture_open(
            &tube, hard[m],
            "{\"bodies\": [{\"mesh\": {\"file\": \"tube.obj\"}, \"mass\": {\"areal_density\": "
            "0.2}, \"springs\": {\"stretch\": 200, \"bend\": 1}}], \"colliders\": "
            "[{\"capsule\": "
            "{\"from\": [0, -0.4, 0], \"to\": [0, 0.4, 0], \"radius\": 0.11}}], \"forces\": "
            "{\"gravity\": [0, 0, 0]}, \"contact\": {\"law\": \"force\", \"untangle\": 0.5}}");
        ck_assert_uint_eq(tube.session.initial_penetration.n, tube.n);
        ck_assert_double_ge(tube.session.initial_penetration.depth, 0.01);
        fixture_start(&tube);
        const double start = stored(&tube);
        fixture_frames(&tube, FRAMES);
        ck_assert_double_eq_tol(told(&tube), stored(&tube) - start, 0.02 * told(&tube));
        fixture_frames(&tube, 15);
        for (size_t i = 0; i < tube.n; i++)
            ck_assert_double_gt(hypot(tube.x[i], tube.x[2 * tube.n + i]), 0.11);
        ck_assert_double_eq(cs_posed_colliders_depth(tube.system, 0.75, tube.x), 0);
        given[m] = told(&tube);
        ck_assert_double_eq_tol(given[m], given[0], 0.02 * given[0]);
        fixture_close(&tube);
    }
}
