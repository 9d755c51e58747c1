/* Colliders moved by events: on their path to the bit, and what they take along. */
#include "methods.h"

#include "model/contact/posed_collider.h"

#include <math.h>
#include <string.h>

/* a pinned cloth that meets nothing; %s: the events, of a sphere and a box far away */
#define FAR                                                                                    \
    "{\"bodies\": [{\"cloth\": {\"grid\": [4, 4]}, \"mass\": {\"particle\": 0.01},"            \
    " \"pins\": [\"top\"]}], \"colliders\": [{\"sphere\": {\"centre\": [9, 1, 2],"             \
    " \"radius\": 0.5}}, {\"box\": {\"centre\": [0, -7, 0], \"size\": [1, 2, 3],"              \
    " \"rotate\": [0, 0, 0.6, 0.8]}}], \"events\": [%s]}"

/* free particles at rest on a floor; %s: its events */
#define GRAINS                                                                                 \
    "{\"bodies\": [{\"cloth\": {\"grid\": [3, 3], \"size\": [0.3, 0.3], \"start\": \"flat\"}," \
    " \"mass\": {\"particle\": 0.01}, \"springs\": {\"stretch\": 0, \"shear\": 0, \"bend\":"   \
    " 0}}], \"colliders\": [{\"floor\": {}, \"friction\": 0.5}], \"events\": [%s]}"

static void check_centre(const struct fixture *fixture, uint32_t k, double t, double x,
                         double y, double z) {
    struct cs_posed_collider of;
    const double expected[3] = {x, y, z};
    cs_posed_collider_at(fixture->system, k, t, &of);
    for (int c = 0; c < 3; c++)
        ck_assert_msg(fabs(of.centre[c] - expected[c]) < 1e-14,
                      "t = %g, axis %d: %.17g, not %.17g", t, c, of.centre[c], expected[c]);

    // and so has a method it in its view
    const struct cs_view *view = &fixture->system->view;
    const size_t at = 3 * (size_t)k;
    for (size_t c = 0; c < 3; c++) {
        const double v = view->collider_velocity[at + c];
        ck_assert_double_eq_tol(view->collider_origin[at + c] + t * v, expected[c], 1e-14);
        ck_assert_double_eq(v, of.velocity[c]);
        ck_assert_double_eq(view->collider_spin[at + c], of.spin[c]);
    }
}

/* Two legs, then rest; a second move goes on from there, along the cubic s^2 (3 - 2 s). */
TEST(path_is_exact) {
    const struct methods methods = methods_find(&(struct methods_query){.test = "moves"});
    for (size_t k = 0; k < methods.n; k++) {
        const char *method = methods.list[k].text;
        struct fixture far;
        fixture_open(&far, method, FAR,
                     "{\"from\": 0.05, \"to\": 0.3, \"move\": {\"collider\": 0, \"path\": ["
                     "{\"at\": 0.15, \"point\": [1, 0, 0]},"
                     " {\"at\": 0.25, \"point\": [1, 2, 0]}]}},"
                     "{\"at\": 0.4, \"move\": {\"collider\": 0, \"motion\": \"smooth\","
                     " \"path\": [{\"at\": 0.5, \"point\": [0, 0, -4]}]}}");
        fixture_start(&far);
        check_centre(&far, 0, 0, 9, 1, 2);
        fixture_frames(&far, 6); /* 0.1 s */
        check_centre(&far, 0, 0.1, 9.5, 1, 2);
        fixture_frames(&far, 6); /* 0.2 s */
        check_centre(&far, 0, 0.2, 10, 2, 2);
        fixture_frames(&far, 9); /* 0.35 s */
        check_centre(&far, 0, 0.35, 10, 3, 2);
        fixture_frames(&far, 6); /* 0.45 s: half way along the cubic */
        check_centre(&far, 0, 0.45, 10, 3, 0);
        fixture_frames(&far, 9); /* 0.6 s */
        check_centre(&far, 0, 0.6, 10, 3, -2);
        check_centre(&far, 1, 0.6, 0, -7, 0); /* the other stays */
        fixture_close(&far);
    }
}

/* Positions instead of shifts: the same way, also after an earlier move. */
TEST(positions_are_exact) {
    struct fixture far;
    fixture_open(
        &far, "velocity-verlet", FAR,
        "{\"from\": 0.05, \"to\": 0.3, \"move\": {\"collider\": 0, \"path\": ["
        "{\"at\": 0.15, \"point\": [1, 0, 0]}]}},"
        "{\"at\": 0.4, \"move\": {\"collider\": 0, \"relative\": false, \"path\": ["
        "{\"at\": 0.5, \"point\": [10, 3, -2]}, {\"at\": 0.6, \"point\": [9, 1, 2]}]}}");
    fixture_start(&far);
    fixture_frames(&far, 24); /* 0.4 s */
    check_centre(&far, 0, 0.4, 10, 1, 2);
    fixture_frames(&far, 3); /* 0.45 s */
    check_centre(&far, 0, 0.45, 10, 2, 0);
    fixture_frames(&far, 3); /* 0.5 s */
    check_centre(&far, 0, 0.5, 10, 3, -2);
    fixture_frames(&far, 9); /* 0.65 s: where the scene has it */
    check_centre(&far, 0, 0.65, 9, 1, 2);
    fixture_close(&far);
}

/* A quarter turn about y in 0.5 s, from the way that the scene has turned the box. */
TEST(turn_is_exact) {
    struct fixture far;
    struct cs_posed_collider before, after;
    fixture_open(&far, "velocity-verlet", FAR,
                 "{\"from\": 0.1, \"to\": 0.6, \"move\": {\"collider\": 1,"
                 " \"spin\": [0, 3.14159265358979324, 0],"
                 " \"path\": [{\"at\": 0.6, \"point\": [0, 1, 0]}]}}");
    fixture_start(&far);
    cs_posed_collider_at(far.system, 1, 0, &before);
    ck_assert(before.axes[0][0] > 0.27 && before.axes[0][1] > 0.95);
    fixture_frames(&far, 21); /* 0.35 s: under way */
    check_centre(&far, 1, 0.35, 0, -6.5, 0);
    ck_assert_double_gt(far.system->view.collider_spin[4], 3.14);
    fixture_frames(&far, 24); /* 0.75 s: at rest again */
    cs_posed_collider_at(far.system, 1, 0.75, &after);
    for (int k = 0; k < 3; k++) {
        ck_assert_double_eq_tol(after.axes[k][0], before.axes[k][2], 1e-14);
        ck_assert_double_eq_tol(after.axes[k][1], before.axes[k][1], 1e-14);
        ck_assert_double_eq_tol(after.axes[k][2], -before.axes[k][0], 1e-14);
        ck_assert_double_eq(after.velocity[k], 0);
        ck_assert_double_eq(after.spin[k], 0);
    }
    check_centre(&far, 1, 0.75, 0, -6, 0);
    fixture_close(&far);
}

/* A quarter turn about an edge on a moving hinge, and back about another: chord by chord. */
TEST(hinge_is_exact) {
    struct fixture far;
    struct cs_posed_collider before, after;
    fixture_open(&far, "velocity-verlet", FAR,
                 "{\"from\": 0.1, \"to\": 0.6, \"move\": {\"collider\": 1,"
                 " \"spin\": [0, 3.14159265358979324, 0], \"centre\": [2, -7, 1],"
                 " \"motion\": \"smooth\", \"path\": [{\"at\": 0.6, \"point\": [0, 1, 0]}]}},"
                 "{\"from\": 0.7, \"to\": 1.2, \"move\": {\"collider\": 1,"
                 " \"spin\": [0, -3.14159265358979324, 0], \"centre\": [1, 0, 3],"
                 " \"relative\": false, \"path\": [{\"at\": 1.2, \"point\": [1, 0, 7]}]}}");
    fixture_start(&far);
    cs_posed_collider_at(far.system, 1, 0, &before);
    fixture_frames(&far, 39); /* 0.65 s: (-2, -1) from the hinge has become (-1, 2) */
    cs_posed_collider_at(far.system, 1, 0.65, &after);
    ck_assert_double_eq_tol(after.centre[0], 1, 1e-14);
    ck_assert_double_eq_tol(after.centre[1], -6, 1e-14);
    ck_assert_double_eq_tol(after.centre[2], 3, 1e-14);
    fixture_frames(&far, 18); /* 0.95 s: the view has the hinge */
    ck_assert_double_eq_tol(far.system->view.collider_origin[5] +
                                0.95 * far.system->view.collider_velocity[5],
                            5, 1e-13);
    fixture_frames(&far, 18); /* 1.25 s: (0, 0) from this one, shifted along z */
    check_centre(&far, 1, 1.25, 1, -6, 7);
    cs_posed_collider_at(far.system, 1, 1.25, &after);
    for (int k = 0; k < 9; k++)
        ck_assert_double_eq_tol(after.axes[k / 3][k % 3], before.axes[k / 3][k % 3], 1e-14);
    fixture_close(&far);
}

/* The second move begins while the first is under way: it goes on from where the collider is,
 * and the end of the first changes nothing. */
TEST(later_move_takes_over) {
    struct fixture far;
    fixture_open(&far, "velocity-verlet", FAR,
                 "{\"from\": 0, \"to\": 0.4, \"move\": {\"collider\": 0,"
                 " \"path\": [{\"at\": 0.4, \"point\": [4, 0, 0]}]}},"
                 "{\"from\": 0.2, \"to\": 0.6, \"move\": {\"collider\": 0,"
                 " \"path\": [{\"at\": 0.6, \"point\": [0, 4, 0]}]}}");
    fixture_start(&far);
    fixture_frames(&far, 12);
    check_centre(&far, 0, 0.2, 11, 1, 2);
    fixture_frames(&far, 18); /* 0.5 s */
    check_centre(&far, 0, 0.5, 11, 4, 2);
    fixture_frames(&far, 12);
    check_centre(&far, 0, 0.7, 11, 5, 2);
    fixture_close(&far);
}

/* A floor that rises takes what lies on it along: at its height, with its velocity. */
TEST(floor_lifts_what_lies_on_it) {
    const struct methods methods = methods_find(&(struct methods_query){.test = "lift"});
    for (size_t k = 0; k < methods.n; k++) {
        const char *method = methods.list[k].text;
        struct fixture grains;
        fixture_open(&grains, method, GRAINS,
                     "{\"at\": 0, \"move\": {\"collider\": 0,"
                     " \"path\": [{\"at\": 1, \"point\": [0, 0.5, 0]}]}}");
        fixture_start(&grains);
        fixture_frames(&grains, 30);
        for (size_t i = 0; i < grains.n; i++) {
            ck_assert_msg(fabs(grains.x[grains.n + i] - 0.25) < 1e-12, "%s: height %.17g",
                          method, grains.x[grains.n + i]);
            ck_assert_msg(fabs(grains.v[grains.n + i] - 0.5) < 1e-12, "%s: velocity %.17g",
                          method, grains.v[grains.n + i]);
        }
        fixture_close(&grains);
    }
}

/* A floor that slides at 0.6 m/s drags what lies on it by mu g until it is as fast. */
TEST(friction_is_against_the_moving_floor) {
    const double mu = 0.5, g = 9.81, step = 1e-4;
    struct fixture grains;
    fixture_open(&grains, "velocity-verlet:dt=1e-4", GRAINS,
                 "{\"at\": 0, \"move\": {\"collider\": 0,"
                 " \"path\": [{\"at\": 1, \"point\": [0.6, 0, 0]}]}}");
    fixture_start(&grains);
    fixture_frames(&grains, 6); /* 0.1 s: slides */
    for (size_t i = 0; i < grains.n; i++)
        ck_assert_double_eq_tol(grains.v[i], mu * g * 0.1, 2 * mu * g * step);
    fixture_frames(&grains, 24); /* 0.5 s: goes with it since 0.122 s */
    for (size_t i = 0; i < grains.n; i++)
        ck_assert_double_eq_tol(grains.v[i], 0.6, 1e-9);
    fixture_close(&grains);
}

/* On a turning floor friction leads to the velocity of the floor where a particle lies. */
TEST(friction_is_against_the_turning_floor) {
    struct fixture grains;
    fixture_open(&grains, "velocity-verlet:dt=1e-3", GRAINS,
                 "{\"at\": 0, \"move\": {\"collider\": 0, \"spin\": [0, 2, 0]}}");
    fixture_start(&grains);
    fixture_frames(&grains, 60);
    const size_t n = grains.n;
    for (size_t i = 0; i < n; i++) {
        // w x r; a step straight on leads outwards by w^2 r h
        const double x = grains.x[i], z = grains.x[2 * n + i];
        ck_assert_double_eq_tol(grains.v[i], 2 * z, 2e-3);
        ck_assert_double_eq_tol(grains.v[2 * n + i], -2 * x, 2e-3);
        ck_assert(i == 4 || sqrt(x * x + z * z) > 0.14);
    }
    fixture_close(&grains);
}

TEST(bytes_are_planned) {
    struct fixture with, without;
    fixture_open(&with, "velocity-verlet", FAR,
                 "{\"at\": 0.1, \"move\": {\"collider\": 1, \"motion\": \"smooth\","
                 " \"path\": [{\"at\": 0.5, \"point\": [0, 0, 1]}]}}");
    fixture_open(&without, "velocity-verlet", FAR, "");
    const size_t more = with.system->arena.used - without.system->arena.used;
    ck_assert_uint_eq(more, with.system->plan.rows[CS_FEATURE_EVENTS].bytes);
    ck_assert_ptr_nonnull(with.system->motions);
    ck_assert_ptr_null(without.system->motions);
    ck_assert_uint_eq(with.system->view.n_colliders, 2);
    ck_assert_uint_eq(without.system->view.n_colliders, 0);
    fixture_close(&with);
    fixture_close(&without);
}

/* Other events leave colliders where they are, and have no motions. */
TEST(nothing_without_moves) {
    struct fixture far;
    fixture_open(&far, "velocity-verlet", FAR,
                 "{\"at\": 0, \"grab\": {\"particles\": [15],"
                 " \"path\": [{\"at\": 0.5, \"point\": [0, 0, 1]}]}}");
    ck_assert_ptr_null(far.system->motions);
    fixture_close(&far);
}

/* A floor that slides at 1 m/s under a sheet at rest pulls it by mu g, and its friction pays
 * for the way back onto the surface: without that work in the limit of energy the sheet sank by
 * 18 mm in 0.2 s. */
TEST(sliding_floor_lets_nothing_sink) {
    static const char *const list[] = {"implicit-linearised:dt=frame", "bdf2:dt=frame",
                                       "xpbd:dt=frame", "velocity-verlet"};
    for (size_t k = 0; k < sizeof list / sizeof *list; k++) {
        struct fixture sheet;
        fixture_open(&sheet, list[k],
                     "{\"bodies\": [{\"cloth\": {\"grid\": [8, 8], \"start\": \"flat\"},"
                     " \"mass\": {\"total\": 0.2}}], \"contact\": \"project\","
                     " \"colliders\": [{\"floor\": {\"height\": 0}, \"friction\": 0.3}],"
                     " \"events\": [{\"from\": 0, \"to\": 0.5, \"move\": {\"collider\": 0,"
                     " \"path\": [{\"at\": 0.5, \"point\": [0.5, 0, 0]}]}}]}");
        fixture_start(&sheet);
        fixture_frames(&sheet, 12);
        for (size_t i = 0; i < sheet.n; i++) {
            ck_assert_msg(fabs(sheet.x[sheet.n + i]) <= 1e-9, "%s: y = %.3g m", list[k],
                          sheet.x[sheet.n + i]);
            const double v = sheet.v[i], expected = 0.3 * 9.81 * 0.2;
            ck_assert_msg(fabs(v - expected) <= 1e-3 * expected, "%s: %.6g m/s", list[k], v);
        }
        ck_assert_uint_eq(sheet.session.run.counts.subdivided_steps, 0);
        fixture_close(&sheet);
    }
}
