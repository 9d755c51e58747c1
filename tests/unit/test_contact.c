/* Projection contact of one particle against closed forms. */
#include "model/post_step/contact_projection.h"

#include "model/contact/posed_collider.h"
#include "sheet.h"

#include <string.h>

#define SCENE                                                                                  \
    "{\"bodies\": [{\"cloth\": {\"grid\": [1, 1]}, \"mass\": {\"particle\": 2}, \"pins\": "    \
    "[%s]}], \"contact\": \"project\", \"colliders\": [%s], \"forces\": {\"gravity\": [0, 0, " \
    "0]}}"
#define FLOOR(more) "{\"floor\": {\"height\": 0.5}" more "}"

/* a commit after a step of dt that began at `last` (6); without gravity and springs no energy
 * is asked about */
static struct cs_projection_counts commit(struct sheet *sheet, double dt, const double *last) {
    struct cs_arena arena = {0};
    struct cs_error error = {0};
    struct cs_contact_projection contact;
    cs_contact_projection_init(&contact, &sheet->system, &arena, &error);
    UNIT_ASSERT_OK(&error);
    cs_contact_projection_store(&contact, last, last + 3 * sheet->n, false);
    const bool projected = cs_contact_projection_resolve(&contact, 0, dt, sheet->x, sheet->v);
    ck_assert_int_eq(projected, contact.counts.projected > 0);
    cs_arena_finish(&arena);
    return contact.counts;
}

/* without a move there is nothing for friction to hold: velocities alone */
static struct cs_projection_counts resolve(struct sheet *sheet) {
    double last[6];
    ck_assert_uint_eq(sheet->n, 1);
    memcpy(last, sheet->x, sizeof last);
    return commit(sheet, 0.01, last);
}

TEST(particle_is_put_on_the_floor_with_its_skin) {
    struct sheet one;
    sheet_open(&one, 0, SCENE, "", FLOOR(", \"thickness\": 0.02"));
    sheet_put(&one, 0, 0.3, -0.1, 4, 0, 0, 0);
    const struct cs_projection_counts counts = resolve(&one);
    ck_assert_uint_eq(counts.tests, 1);
    ck_assert_uint_eq(counts.projected, 1);
    SHEET_ASSERT_AT(&one, one.x, 0, 0.3, 0.52, 4, 1e-15);
    sheet_close(&one);
}

/* on the surface or in front of it nothing happens, whatever the velocity */
TEST(particle_in_front_is_left_alone) {
    static const double heights[] = {0.5, 0.5000001, 3};
    struct sheet one;
    sheet_open(&one, 0, SCENE, "", FLOOR(""));
    for (size_t k = 0; k < 3; k++) {
        sheet_put(&one, 0, 0, heights[k], 0, 1, -2, 3);
        const struct cs_projection_counts counts = resolve(&one);
        ck_assert_uint_eq(counts.tests, 1);
        ck_assert_uint_eq(counts.projected, 0);
        SHEET_ASSERT_AT(&one, one.x, 0, 0, heights[k], 0, 0);
        SHEET_ASSERT_AT(&one, one.v, 0, 1, -2, 3, 0);
    }
    sheet_close(&one);
}

/* along the normal only, from a point that is 1.5 m behind the plane and its skin of 0.1 m */
TEST(particle_is_put_on_a_plane) {
    struct sheet one;
    sheet_open(&one, 0, SCENE, "",
               "{\"plane\": {\"point\": [1, 2, 3], \"normal\": [2, 0, 1.5]}, \"thickness\": "
               "0.1}");
    sheet_put(&one, 0, 1 - 1.4 * 0.8 - 0.6, 2 + 5, 3 - 1.4 * 0.6 + 0.8, 0, 0, 0);
    ck_assert_uint_eq(resolve(&one).projected, 1);
    SHEET_ASSERT_AT(&one, one.x, 0, 1 + 0.1 * 0.8 - 0.6, 7, 3 + 0.1 * 0.6 + 0.8, 1e-14);
    sheet_close(&one);
}

TEST(particle_is_put_on_a_sphere) {
    struct sheet one;
    sheet_open(&one, 0, SCENE, "",
               "{\"sphere\": {\"centre\": [1, 2, 3], \"radius\": 0.5}, \"thickness\": 0.1}");
    sheet_put(&one, 0, 1 + 0.2 * 2 / 3, 2 - 0.2 / 3, 3 + 0.2 * 2 / 3, 0, 0, 0);
    ck_assert_uint_eq(resolve(&one).projected, 1);
    SHEET_ASSERT_AT(&one, one.x, 0, 1.4, 1.8, 3.4, 1e-14);
    // the very centre has no normal: upwards
    sheet_put(&one, 0, 1, 2, 3, 0, 0, 0);
    ck_assert_uint_eq(resolve(&one).projected, 1);
    SHEET_ASSERT_AT(&one, one.x, 0, 1, 2.6, 3, 1e-14);
    sheet_close(&one);
}

/* on a face of a turned box, and on its rounded edge */
TEST(particle_is_put_on_a_box) {
    const double half = sqrt(0.5);
    struct sheet one;
    sheet_open(&one, 0, SCENE, "",
               "{\"box\": {\"centre\": [1, 2, 3], \"size\": [0.6, 0.4, 2], \"rotate\":"
               " [0, 0, 1, 1], \"radius\": 0.1}, \"thickness\": 0.02}");
    // a quarter turn about z: 0.4 wide and 0.6 high
    sheet_put(&one, 0, 1.1, 2.28, 2.5, 0, -1, 0);
    ck_assert_uint_eq(resolve(&one).projected, 1);
    SHEET_ASSERT_AT(&one, one.x, 0, 1.1, 2.32, 2.5, 1e-14);
    sheet_put(&one, 0, 1.15, 2.25, 2.5, 0, 0, 0);
    ck_assert_uint_eq(resolve(&one).projected, 1);
    SHEET_ASSERT_AT(&one, one.x, 0, 1.1 + 0.12 * half, 2.2 + 0.12 * half, 2.5, 1e-14);
    // beyond the round edge, where a sharp one would be
    sheet_put(&one, 0, 1.195, 2.295, 2.5, 0, 0, 0);
    ck_assert_uint_eq(resolve(&one).projected, 0);
    sheet_close(&one);
}

/* on the rod and on its end */
TEST(particle_is_put_on_a_capsule) {
    struct sheet one;
    sheet_open(&one, 0, SCENE, "",
               "{\"capsule\": {\"from\": [0, 0, 1], \"to\": [0, 0, 3], \"radius\": 0.25}}");
    sheet_put(&one, 0, 0.06, 0.08, 2.2, 0, 0, 0);
    ck_assert_uint_eq(resolve(&one).projected, 1);
    SHEET_ASSERT_AT(&one, one.x, 0, 0.15, 0.2, 2.2, 1e-14);
    sheet_put(&one, 0, 0, 0.06, 3.08, 0, 0, 0);
    ck_assert_uint_eq(resolve(&one).projected, 1);
    SHEET_ASSERT_AT(&one, one.x, 0, 0, 0.15, 3.2, 1e-14);
    sheet_put(&one, 0, 0, 0, 3.26, 0, 0, 0);
    ck_assert_uint_eq(resolve(&one).projected, 0);
    sheet_close(&one);
}

/* Normal and tangential velocity are those against the floor, which rises at 1 m/s and slides
 * at 2 m/s: half of 3 m/s inwards is taken away, and friction 0.2 takes 0.3 of 5 m/s. */
TEST(velocities_are_those_against_a_moving_floor) {
    struct cs_collider_motion motion = {
        .t_end = HUGE_VAL, .rate = {2, 1, 0}, .rotation = {1, 0, 0, 0, 1, 0, 0, 0, 1}};
    struct sheet one;
    sheet_open(&one, 0, SCENE, "", FLOOR(", \"absorption\": 0.5, \"friction\": 0.2"));
    one.system.motions = &motion;
    sheet_put(&one, 0, 0, 0.4, 0, 2 + 3, -2, 4);
    ck_assert_uint_eq(resolve(&one).projected, 1);
    SHEET_ASSERT_AT(&one, one.v, 0, 2 + 0.94 * 3, 1 - 1.5, 0.94 * 4, 1e-15);
    sheet_close(&one);
}

/* ka of the normal velocity is taken away, and -e turns it round; the rest is kept */
TEST(normal_velocity_is_absorbed) {
    static const struct {
        const char *absorption;
        double left; /* of -2 m/s */
    } rows[] = {{"1", 0}, {"0.5", -1}, {"0", -2}, {"-0.5", 1}, {"-1", 2}};
    for (size_t k = 0; k < sizeof rows / sizeof *rows; k++) {
        struct sheet one;
        char collider[128];
        snprintf(collider, sizeof collider, FLOOR(", \"absorption\": %s"), rows[k].absorption);
        sheet_open(&one, 0, SCENE, "", collider);
        sheet_put(&one, 0, 0, 0.4, 0, 3, -2, -4);
        resolve(&one);
        SHEET_ASSERT_AT(&one, one.v, 0, 3, rows[k].left, -4, 1e-15);
        // on its way out it is put on the surface and keeps its velocity
        sheet_put(&one, 0, 0, 0.4, 0, 3, 2, -4);
        ck_assert_uint_eq(resolve(&one).projected, 1);
        SHEET_ASSERT_AT(&one, one.v, 0, 3, 2, -4, 0);
        sheet_close(&one);
    }
}

/* One second on a slope of 30 degrees in steps of 10 ms, the velocity alone: below
 * tan(30 degrees) of friction the particle slides at g (sin - mu cos) t, above it sticks. */
TEST(slope_is_slid_down_or_stuck_to) {
    const double angle = acos(-1) / 6, g = 9.81, dt = 0.01;
    static const double parts[] = {0, 0.5, 0.999, 1.001, 3}; // of tan(angle)
    for (size_t k = 0; k < sizeof parts / sizeof *parts; k++) {
        const double mu = parts[k] * tan(angle);
        char collider[160];
        snprintf(collider, sizeof collider,
                 "{\"plane\": {\"normal\": [%.17g, %.17g, 0]}, \"friction\": %.17g}",
                 sin(angle), cos(angle), mu);
        struct sheet one;
        sheet_open(&one, 0, SCENE, "", collider);
        for (int step = 0; step < 100; step++) {
            sheet_put(&one, 0, -1e-9 * sin(angle), -1e-9 * cos(angle), 0, one.v[0],
                      one.v[1] - g * dt, one.v[2]);
            ck_assert_uint_eq(resolve(&one).projected, 1);
        }
        const double speed = parts[k] > 1 ? 0 : g * (sin(angle) - mu * cos(angle));
        SHEET_ASSERT_AT(&one, one.v, 0, speed * cos(angle), -speed * sin(angle), 0, 1e-13);
        sheet_close(&one);
    }
}

/* friction goes by the normal velocity that was changed: 1.5 times the inward one here */
TEST(friction_counts_the_bounce) {
    struct sheet one;
    sheet_open(&one, 0, SCENE, "", FLOOR(", \"absorption\": -0.5, \"friction\": 0.2"));
    sheet_put(&one, 0, 0, 0.4, 0, 3, -2, -4);
    resolve(&one);
    const double kept = 1 - 0.2 * 1.5 * 2 / 5;
    SHEET_ASSERT_AT(&one, one.v, 0, kept * 3, 1, -kept * 4, 1e-15);
    sheet_close(&one);
}

/* The tangential move of a step loses friction times the depth, all of it where that is more:
 * 0.03 m down and (0.3, -0.4) m across here. */
TEST(friction_holds_the_move) {
    static const struct {
        double friction, kept;
    } rows[] = {{0, 1}, {5, 1 - 5 * 0.03 / 0.5}, {1e3, 0}};
    for (size_t k = 0; k < sizeof rows / sizeof *rows; k++) {
        const double last[6] = {1, 0.5, 2, 0, 0, 0};
        struct sheet one;
        char collider[128];
        snprintf(collider, sizeof collider, FLOOR(", \"friction\": %g"), rows[k].friction);
        sheet_open(&one, 0, SCENE, "", collider);
        sheet_put(&one, 0, 1.3, 0.47, 1.6, 0, 0, 0);
        ck_assert_uint_eq(commit(&one, 0.01, last).projected, 1);
        SHEET_ASSERT_AT(&one, one.x, 0, 1 + rows[k].kept * 0.3, 0.5, 2 - rows[k].kept * 0.4,
                        1e-15);
        sheet_close(&one);
    }
}

/* what a rising and sliding floor has taken along is no move against it */
TEST(friction_takes_along) {
    struct cs_collider_motion motion = {
        .t_end = HUGE_VAL, .rate = {2, 1, 0}, .rotation = {1, 0, 0, 0, 1, 0, 0, 0, 1}};
    const double last[6] = {1, 0.49, 2, 0, 0, 0};
    struct sheet one;
    sheet_open(&one, 0, SCENE, "", FLOOR(", \"friction\": 1000"));
    one.system.motions = &motion;
    sheet_put(&one, 0, 1, 0.49, 2, 0, 0, 0);
    ck_assert_uint_eq(commit(&one, 0.01, last).projected, 1);
    SHEET_ASSERT_AT(&one, one.x, 0, 1 + 2 * 0.01, 0.5, 2, 1e-15);
    SHEET_ASSERT_AT(&one, one.v, 0, 2, 1, 0, 1e-15);
    sheet_close(&one);
}

TEST(pinned_particle_is_not_tested) {
    struct sheet one;
    sheet_open(&one, 0, SCENE, "0", FLOOR(""));
    sheet_put(&one, 0, 0, -1, 0, 0, 0, 0);
    const struct cs_projection_counts counts = resolve(&one);
    ck_assert_uint_eq(counts.tests, 0);
    ck_assert_uint_eq(counts.projected, 0);
    ck_assert_double_eq(one.x[1], -1);
    sheet_close(&one);
}

/* so that the blow-up test still finds it */
TEST(particle_that_is_not_finite_stays_so) {
    struct sheet one;
    sheet_open(&one, 0, SCENE, "", FLOOR(", \"friction\": 1"));
    sheet_put(&one, 0, 0, (double)NAN, 0, 0, -1, 0);
    ck_assert_uint_eq(resolve(&one).projected, 0);
    ck_assert_double_nan(one.x[1]);
    sheet_close(&one);
}

TEST(corner_of_floor_and_wall_holds) {
    struct sheet one;
    sheet_open(&one, 0, SCENE, "",
               FLOOR("") ", {\"plane\": {\"normal\": [-1, 0, 0]}, \"thickness\": 0.1}");
    sheet_put(&one, 0, 2, -3, 1, 5, -5, 1);
    const struct cs_projection_counts counts = resolve(&one);
    ck_assert_uint_eq(counts.tests, 2);
    ck_assert_uint_eq(counts.projected, 2);
    SHEET_ASSERT_AT(&one, one.x, 0, -0.1, 0.5, 1, 1e-15);
    SHEET_ASSERT_AT(&one, one.v, 0, 0, 0, 1, 0);
    sheet_close(&one);
}
