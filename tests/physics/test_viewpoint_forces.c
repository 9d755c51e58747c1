/* Forces from a viewpoint: their momentum, their times, whom they reach. */
#include "methods.h"

#include "model/event/event_state.h"
#include "model/event/events.h"
#include "scene/force_keys.h"
#include "scene/picture_keys.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

/* every method there is */
static struct methods all_methods(void) {
    static const char *const more[] = {"rk4:dt=2e-3", "backward-euler:dt=0.01", NULL};
    return methods_find(&(struct methods_query){.test = "events", .more = more});
}

/* 16 particles of 0.25 kg in a square of 1 m, in front of a camera at 2 m; %s: stiffness,
 * events
 */
#define DUST                                                                                   \
    "{\"bodies\": [{\"cloth\": {\"grid\": [4, 4]}, \"mass\": {\"particle\": 0.25},"            \
    " \"springs\": {\"stretch\": %s, \"shear\": 0, \"bend\": 0}}],"                            \
    " \"forces\": {\"gravity\": [0, 0, 0]}, \"camera\": {\"eye\": [0, 0, 2]},"                 \
    " \"events\": [%s]}"

/* force times time on each of those that are seen, along the view; springs change nothing about
 * it, nor do ends within frames */
TEST(momentum_is_force_times_time) {
    static const struct {
        const char *event;
        double p;
    } rows[] = {
        {"{\"at\": 0.03, \"viewpoint_force\": {\"force\": 3}}", 16 * 3 / 60.0},
        {"{\"at\": 0.05, \"viewpoint_force\": {\"force\": -3, \"duration\": 0.5}}",
         -16 * 3 * 0.5},
        {"{\"from\": 0.02, \"to\": 0.07, \"viewpoint_force\": {\"force\": 0.5}}",
         16 * 0.5 * 0.05},
        {"{\"from\": 0.02, \"to\": 0.07, \"viewpoint_force\": {\"force\": 0.5, \"refresh\": "
         "777}}",
         16 * 0.5 * 0.05},
        {"{\"from\": 0, \"to\": 0.05, \"viewpoint_force\": {\"force\": 0.5, \"refresh\": 0,"
         " \"rectangle\": [0.5, 0, 1, 0.5]}}",
         4 * 0.5 * 0.05},
        {"{\"from\": 0, \"to\": 0.05, \"viewpoint_force\": {\"force\": 0.5,"
         " \"viewpoint\": {\"target\": [0, 0, 4]}}}",
         0},
    };
    static const char *const by_methods[] = {"symplectic-euler", "velocity-verlet",
                                             "implicit-linearised:dt=0.005,rtol=1e-13"};
    for (size_t k = 0; k < sizeof rows / sizeof *rows; k++)
        for (size_t m = 0; m < 3; m++) {
            struct fixture dust;
            double p[3], l[3];
            fixture_open(&dust, by_methods[m], DUST, "40", rows[k].event);
            fixture_start(&dust);
            fixture_frames(&dust, 6);
            fixture_momentum(&dust, p, l);
            ck_assert_msg(fabs(p[2] + rows[k].p) < 1e-12, "row %zu, %s: %.15g", k,
                          by_methods[m], p[2]);
            ck_assert(fabs(p[0]) + fabs(p[1]) < 1e-12);
            fixture_close(&dust);
        }
}

/* A viewpoint force that sees all of them is an impact of as much. To the bit: the numbers are
 * powers of two. */
TEST(same_as_an_impact) {
    static const char *const events[] = {
        "{\"from\": 0.0375, \"to\": 0.2, \"viewpoint_force\": {\"force\": 0.5, \"refresh\": "
        "0}}",
        "{\"from\": 0.0375, \"to\": 0.2, \"impact\": {\"direction\": [0, 0, -1]}}"};
    const struct methods methods = all_methods();
    for (size_t k = 0; k < methods.n; k++) {
        const char *method = methods.list[k].text;
        struct fixture dust[2];
        for (size_t e = 0; e < 2; e++) {
            fixture_open(dust + e, method, DUST, "40", events[e]);
            cs_perturb_smooth(dust[e].system, 0.02, 0.1);
            fixture_start(dust + e);
        }
        /* 8 N on 4 kg for exactly its time */
        const struct cs_event_state *state = dust[1].system->events->states;
        struct cs_event *impact = dust[1].session.scene->events.items;
        impact->impact.impulse = 8 * (state->end - state->begin);
        for (size_t e = 0; e < 2; e++)
            fixture_frames(dust + e, 15);
        ck_bits(dust[0].x, dust[1].x, 6 * dust[1].n, method);
        for (size_t e = 0; e < 2; e++)
            fixture_close(dust + e);
    }
}

/* From a frame on, every look is at a frame: no method notices those that see the same. */
TEST(looks_that_see_the_same_change_nothing) {
    static const char *const events[] = {
        "{\"from\": 0.05, \"to\": 0.2, \"viewpoint_force\": {\"force\": 0.5}}",
        "{\"from\": 0.05, \"to\": 0.2, \"viewpoint_force\": {\"force\": 0.5, \"refresh\": 0}}"};
    const struct methods methods = all_methods();
    for (size_t k = 0; k < methods.n; k++) {
        const char *method = methods.list[k].text;
        struct fixture dust[2];
        for (size_t e = 0; e < 2; e++) {
            fixture_open(dust + e, method, DUST, "40", events[e]);
            fixture_start(dust + e);
            fixture_frames(dust + e, 15);
        }
        ck_assert(dust[0].system->events->viewpoint_forces->states->n_tests == 9);
        ck_bits(dust[0].x, dust[1].x, 6 * dust[0].n, method);
        for (size_t e = 0; e < 2; e++)
            fixture_close(dust + e);
    }
}

/* What the frame loop does about a look that sees others: the same bits as runs joined there.
 */
TEST(runs_are_joined_at_looks) {
    const struct methods methods = all_methods();
    for (size_t k = 0; k < methods.n; k++) {
        const char *method = methods.list[k].text;
        struct fixture dust, parts;
        /* seen until it has left the rectangle by 0.05 s: at 0.1 s, frame 6, that is found */
        static const char event[] =
            "{\"from\": 0, \"to\": 1, \"viewpoint_force\": {\"force\": 0.25, \"refresh\": 10,"
            " \"rectangle\": [0.4, 0.4, 0.6, 0.6]}}";
        fixture_open(&dust, method, DUST, "0", event);
        fixture_open(&parts, method, DUST, "0",
                     "{\"from\": 0, \"to\": 9, \"impact\": {\"direction\": [0, 0, -1],"
                     " \"impulse\": 2.25, \"particles\": [5]}}");
        const size_t n = dust.n;
        for (struct fixture *of = &dust; of; of = of == &dust ? &parts : NULL) {
            for (size_t i = 0; i < n; i++) {
                of->x[i] = i == 5 ? 0.15 : 8;
                of->x[n + i] = 0;
                of->v[i] = i == 5 ? 1 : 0;
            }
            fixture_start(of);
        }
        fixture_frames(&dust, 9);
        fixture_frames(&parts, 6);
        ck_assert(parts.system->event_force[2 * n + 5] == -1);
        parts.system->event_force[2 * n + 5] = 0;
        struct cs_error error = {0};
        ck_assert_int_eq(cs_run_restart(&parts.session.run, 0.1, &error), CS_OK);
        fixture_frames(&parts, 3);
        ck_bits(dust.x, parts.x, 6 * n, method);
        ck_assert_double_eq_tol(dust.v[2 * n + 5], -0.1, 1e-9);
        fixture_close(&dust);
        fixture_close(&parts);
    }
}

/* A cloth behind another and one outside the rectangle get nothing, nor do those that an
 * obstacle hides, nor bodies that are not meant. */
TEST(only_what_is_seen_moves) {
    struct fixture cloths;
    fixture_open(
        &cloths, "velocity-verlet",
        "{\"bodies\": [{\"cloth\": {\"grid\": [5, 5]}, \"mass\": {\"total\": 1}},"
        " {\"cloth\": {\"grid\": [5, 5], \"place\": {\"translate\": [0, 0, -0.5]}}, \"mass\":"
        " {\"total\": 1}},"
        " {\"cloth\": {\"grid\": [5, 5], \"place\": {\"translate\": [3, 0, 0]}}, \"mass\":"
        " {\"total\": 1}},"
        " {\"mesh\": {\"shape\": \"box\", \"scale\": [0.4, 0.4, 0.4], \"place\":"
        " {\"translate\": [0, 1.2, 0]}}, \"mass\": {\"total\": 1}},"
        " {\"cloth\": {\"grid\": [2, 2], \"size\": [0.1, 0.1], \"place\":"
        " {\"translate\": [0, -1.2, 0]}}, \"mass\": {\"total\": 1}}],"
        " \"forces\": {\"gravity\": [0, 0, 0]},"
        " \"colliders\": [{\"sphere\": {\"centre\": [0, -0.9, 0.75], \"radius\": 0.3}}],"
        " \"events\": [{\"from\": 0, \"to\": 0.1, \"viewpoint_force\": {\"force\": 0.01, "
        "\"viewpoint\":"
        " {\"eye\": [0, 0, 3], \"target\": [0, 0, 0], \"fov\": 60, \"aspect\": 1}}},"
        " {\"at\": 0, \"viewpoint_force\": {\"force\": 0.01, \"body\": 3, \"viewpoint\":"
        " {\"eye\": [0, 0, 3], \"target\": [0, 0, 0], \"fov\": 60, \"aspect\": 1}}}]}");
    const struct cs_body_range *bodies = cloths.system->bodies;
    const struct cs_viewpoint_force_state *states =
        cloths.system->events->viewpoint_forces->states;
    fixture_start(&cloths);
    fixture_frames(&cloths, 1);
    uint32_t seen[2][5] = {{0}};
    for (int k = 0; k < 2; k++)
        for (uint32_t b = 0; b < 5; b++)
            for (uint32_t i = 0; i < bodies[b].count; i++)
                seen[k][b] += states[k].is_visible[bodies[b].first + i];
    ck_assert(seen[0][0] == 25 && seen[0][1] == 0 && seen[0][2] == 0 && seen[0][4] == 0);
    /* the front and the lower side of the box */
    ck_assert(seen[0][3] > 0 && seen[0][3] < bodies[3].count);
    ck_assert(seen[1][0] == 0 && seen[1][3] == seen[0][3]);
    for (uint32_t i = bodies[1].first; i < bodies[2].first + bodies[2].count; i++)
        ck_assert(cloths.v[2 * cloths.n + i] == 0);
    fixture_close(&cloths);
}

/* From two sides, and twice from one: forces add up, and opposite ones leave nothing. */
TEST(viewpoint_forces_add_up) {
    static const char side[] = "\"viewpoint\": {\"eye\": [2, 0, 2], \"target\": [0, 0, 0]}";
    static const char back[] = "\"viewpoint\": {\"eye\": [0, 0, -2], \"target\": [0, 0, 0]}";
    struct fixture dust;
    char events[800];
    double p[3], l[3];
    snprintf(
        events, sizeof events,
        "{\"from\": 0, \"to\": 0.5, \"viewpoint_force\": {\"force\": 0.1}},"
        "{\"from\": 0.1, \"to\": 0.2, \"viewpoint_force\": {\"force\": 0.1}},"
        "{\"from\": 0, \"to\": 0.5, \"viewpoint_force\": {\"force\": 0.1, %s}},"
        "{\"from\": 0, \"to\": 0.5, \"impact\": {\"direction\": [0, 1, 0],"
        " \"impulse\": 2}},"
        "{\"from\": 0, \"to\": 0.5, \"viewpoint_force\": {\"force\": 0.2, \"refresh\": 0, %s}}",
        back, side);
    fixture_open(&dust, "velocity-verlet:dt=0.001", DUST, "0", events);
    fixture_start(&dust);
    fixture_frames(&dust, 40);
    fixture_momentum(&dust, p, l);
    const double aslant = 16 * 0.2 * 0.5 / sqrt(2);
    ck_assert_double_eq_tol(p[0], -aslant, 1e-12);
    ck_assert_double_eq_tol(p[1], 2, 1e-12);
    ck_assert_double_eq_tol(p[2], -aslant - 16 * 0.1 * 0.1, 1e-12);
    fixture_close(&dust);
}

/* Pinned ones are seen, and stay; the others get no more for it. */
TEST(pinned_ones_stay) {
    struct fixture dust;
    double p[3], l[3];
    fixture_open(&dust, "velocity-verlet", DUST, "0",
                 "{\"from\": 0, \"to\": 1, \"pin\": {\"particles\": [\"left\"]}},"
                 "{\"from\": 0, \"to\": 0.1, \"viewpoint_force\": {\"force\": 1}},"
                 "{\"at\": 0.2, \"viewpoint_force\": {\"force\": 1}}");
    fixture_start(&dust);
    fixture_frames(&dust, 15);
    fixture_momentum(&dust, p, l);
    ck_assert_double_eq_tol(p[2], -12 * (0.1 + 1 / 60.0), 1e-12);
    ck_assert(dust.x[2 * dust.n] == 0 && dust.v[2 * dust.n] == 0);
    fixture_close(&dust);
}

/* The view is the camera's unless it is given: fixed, while the camera looks from elsewhere. */
TEST(viewpoint_is_the_cameras_by_default) {
    struct fixture dust;
    fixture_open(
        &dust, "velocity-verlet", DUST, "0",
        "{\"at\": 0, \"viewpoint_force\": {\"force\": 1}},"
        "{\"at\": 0, \"viewpoint_force\": {\"force\": 1, \"viewpoint\": {\"eye\": [5, 6, 7],"
        " \"fov\": 20, \"aspect\": 1}}}");
    const struct cs_viewpoint *a =
        &cs_scene_events(dust.session.scene)[0].viewpoint_force.viewpoint;
    const struct cs_viewpoint *b =
        &cs_scene_events(dust.session.scene)[1].viewpoint_force.viewpoint;
    const struct cs_camera *camera = dust.session.scene->camera;
    ck_assert_mem_eq(a->eye, camera->eye, sizeof a->eye);
    ck_assert_mem_eq(b->target, camera->target, sizeof a->target);
    ck_assert_mem_eq(b->up, camera->up, sizeof a->up);
    ck_assert(a->fov == 40 && a->aspect == 640 / 480.0 && b->fov == 20 && b->aspect == 1 &&
              b->eye[1] == 6);
    fixture_close(&dust);
}

#define CLOTH                                                                                  \
    "{\"bodies\": [{\"cloth\": {\"grid\": [9, 8]}, \"mass\": {\"total\": 0.2},"                \
    " \"springs\": {\"stretch\": 40, \"damping\": 0.01}, \"pins\": [\"top\"]}],"               \
    " \"forces\": {\"drag\": 0.002}, \"camera\": {\"eye\": [0.3, 0.2, 2]}, \"events\": [%s]}"

/* A blow and two winds that see others at every look: two methods that have nothing in common
 * agree, and the coarser comes near four times as fast when its step is halved. */
TEST(methods_agree) {
    static const char *const by[] = {"cvode-bdf:rtol=1e-9,linear_rtol=1e-9,max_order=5",
                                     "velocity-verlet:dt=0.0005", "velocity-verlet:dt=0.001"};
    struct fixture cloths[3];
    for (size_t k = 0; k < 3; k++) {
        fixture_open(cloths + k, by[k], CLOTH,
                     "{\"from\": 0.02, \"to\": 0.3, \"viewpoint_force\": {\"force\": 0.03,"
                     " \"rectangle\": [0.37, 0.31, 0.63, 0.67]}},"
                     "{\"from\": 0.05, \"to\": 0.2, \"viewpoint_force\": {\"force\": 0.02, "
                     "\"refresh\": 35,"
                     " \"viewpoint\": {\"eye\": [-2, 0, 1]}, \"rectangle\": [0, 0.5, 1, 1]}},"
                     "{\"at\": 0.1, \"viewpoint_force\": {\"force\": 0.5}}");
        fixture_start(cloths + k);
        fixture_frames(cloths + k, 18);
        ck_assert_mem_eq(cloths[k].system->events->viewpoint_forces->states[0].is_visible,
                         cloths[0].system->events->viewpoint_forces->states[0].is_visible,
                         cloths[0].n);
    }
    const size_t n = 3 * cloths[0].n;
    const double fine = cs_rms_difference(cloths[0].x, cloths[1].x, n);
    const double coarse = cs_rms_difference(cloths[0].x, cloths[2].x, n);
    ck_assert_msg(fine < 1e-5, "%g m apart", fine);
    ck_assert_msg(coarse / fine > 3 && coarse / fine < 5.5, "%g and %g m apart", coarse, fine);
    for (size_t k = 0; k < 3; k++)
        fixture_close(cloths + k);
}

/* The plan says what they take; without any there is nothing, and blows alone push nothing. */
TEST(bytes_are_planned) {
    struct fixture with, blow, without;
    fixture_open(
        &with, "velocity-verlet", CLOTH,
        "{\"from\": 0.1, \"to\": 0.2, \"viewpoint_force\": {\"force\": 1}},"
        "{\"from\": 0.3, \"to\": 1e8, \"viewpoint_force\": {\"force\": 1, \"refresh\": 1e5}}");
    fixture_open(&blow, "velocity-verlet", CLOTH,
                 "{\"at\": 0.1, \"viewpoint_force\": {\"force\": 1}}");
    fixture_open(&without, "velocity-verlet", CLOTH, "");
    const struct cs_plan_row *rows = with.system->plan.rows;
    const size_t more = with.system->arena.used - without.system->arena.used;
    ck_assert_uint_eq(more,
                      rows[CS_FEATURE_EVENTS].bytes + rows[CS_FEATURE_VIEWPOINT_FORCES].bytes);
    ck_assert(!without.session.plan.rows[CS_FEATURE_VIEWPOINT_FORCES].built);
    ck_assert_uint_eq(without.system->plan.rows[CS_FEATURE_VIEWPOINT_FORCES].bytes, 0);
    ck_assert_ptr_null(blow.system->event_force);
    fixture_close(&with);
    fixture_close(&blow);
    fixture_close(&without);
    fixture_open(&without, "velocity-verlet", CLOTH, "{\"at\": 0.1, \"release\": {}}");
    ck_assert_ptr_null(without.system->events->viewpoint_forces);
    fixture_close(&without);
}

/* Times at which steps are cut: 0.1 s and 0.5 s, and the looks between them that are at no
 * frame. */
TEST(cuts_are_counted) {
    static const struct {
        double refresh;
        uint32_t cuts;
    } rows[] = {{60, 2}, {30, 2}, {0, 2}, {120, 2 + 24}, {50, 2 + 16}};
    for (size_t k = 0; k < sizeof rows / sizeof *rows; k++) {
        struct fixture dust;
        char event[200];
        snprintf(event, sizeof event,
                 "{\"from\": 0.1, \"to\": 0.5, \"viewpoint_force\": {\"force\": 1, "
                 "\"refresh\": %g}}",
                 rows[k].refresh);
        fixture_open(&dust, "velocity-verlet", DUST, "0", event);
        const uint32_t cuts = cs_events_count_stops(dust.system->events, 1);
        ck_assert_msg(cuts == rows[k].cuts, "%g looks a second: %u", rows[k].refresh, cuts);
        fixture_close(&dust);
    }
}

/* A look within a nanosecond of an end is made there: no step of rounding errors. */
TEST(looks_and_ends_are_one) {
    struct fixture dust;
    fixture_open(&dust, "velocity-verlet", DUST, "0",
                 "{\"from\": 0.002, \"to\": 0.015, \"viewpoint_force\": {\"force\": 1, "
                 "\"refresh\": 1000}},"
                 "{\"at\": 0.0110000000003, \"release\": {}}");
    fixture_start(&dust);
    fixture_frames(&dust, 1);
    ck_assert_uint_eq(dust.session.run.counts.steps, 15);
    fixture_close(&dust);
}

/* Looks do not hide a blow-up: it is found in the frame in which it is found without them, and
 * what is pushed for long is none. */
TEST(bound_goes_on_over_looks) {
    static const char *const events[] = {
        "", "{\"from\": 0, \"to\": 9, \"viewpoint_force\": {\"force\": 0.01, \"refresh\": 240,"
            " \"rectangle\": [0.3, 0.3, 0.5, 0.7]}}"};
    uint32_t frames[2];
    for (size_t k = 0; k < 2; k++) {
        struct fixture cloth;
        struct cs_error error = {0};
        fixture_open(&cloth, "explicit-euler:dt=0.008", CLOTH, events[k]);
        cs_perturb_smooth(cloth.system, 0.01, 0.1);
        fixture_start(&cloth);
        struct cs_run *run = &cloth.session.run;
        while (run->outcome == CS_RUNNING && run->frame < 300)
            ck_assert_int_eq(cs_run_frame(run, &error), CS_OK);
        ck_assert_int_eq(run->outcome, CS_UNBOUNDED);
        frames[k] = run->frame;
        fixture_close(&cloth);
    }
    ck_assert_msg(frames[1] <= frames[0] + 1, "%u and %u frames", frames[0], frames[1]);

    struct fixture dust;
    fixture_open(&dust, "velocity-verlet", DUST, "0",
                 "{\"from\": 0, \"to\": 20, \"viewpoint_force\": {\"force\": 1, \"rectangle\":"
                 " [0.4, 0.4, 0.6, 0.6]}}");
    fixture_start(&dust);
    fixture_frames(&dust, 1200);
    fixture_close(&dust);
}
