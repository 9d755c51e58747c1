/* A run that goes on from any of its frames is the unbroken one, to the last bit: of scenes in
 * which events, contact and methods with a memory are at work. */
#include "fixture.h"

#include "sim/run_state.h"

#include <string.h>

enum { BREAKS = 3 };

struct broken {
    const char *scene, *method;
    uint32_t frames, breaks[BREAKS];
};

/* What the scenes are run with. */
static struct cs_override changed;

static void open_session(struct cs_session *session, const struct broken *broken) {
    struct cs_error error = {0};
    const struct cs_session_settings settings = {.scene = broken->scene,
                                                 .integrator = broken->method,
                                                 .overrides = &changed,
                                                 .n_overrides = changed.path != NULL};
    cs_session_open(session, &settings, &error);
    ck_assert_msg(!error.status, "%s: %s", broken->scene, error.message);
}

static void run_to(struct cs_session *session, uint32_t frame) {
    struct cs_error error = {0};
    while (session->run.frame < frame && session->run.outcome == CS_RUNNING)
        cs_run_frame(&session->run, &error);
    ck_assert_msg(!error.status && session->run.outcome == CS_RUNNING, "%s", error.message);
}

static void compare(const struct cs_session *whole, const struct cs_session *resumed,
                    const struct broken *broken, uint32_t at) {
    const struct cs_run *a = &whole->run, *b = &resumed->run;
    const size_t n = 6 * (size_t)whole->system.view.n;
    ck_assert_msg(!memcmp(a->x, b->x, n * sizeof *a->x), "%s by %s differs after frame %u",
                  broken->scene, broken->method, at);
    ck_assert_uint_eq(a->counts.steps, b->counts.steps);
    ck_assert_uint_eq(a->counts.forces, b->counts.forces);
    ck_assert_uint_eq(a->counts.projected_particles, b->counts.projected_particles);
    ck_assert_uint_eq(a->counts.strain_limit_moves, b->counts.strain_limit_moves);
    ck_assert_uint_eq(a->counts.method.rejected, b->counts.method.rejected);
    ck_assert_uint_eq(a->n_notes, b->n_notes);
    ck_assert_mem_eq(a->notes, b->notes, sizeof a->notes);
}

static void go_on(const struct broken *broken, struct cs_serialiser *serialiser,
                  const struct cs_session *whole, uint32_t at) {
    struct cs_error error = {0};
    struct cs_session resumed;
    open_session(&resumed, broken);
    serialiser->is_reading = true;
    cs_run_load(&resumed.run, serialiser, &error);
    ck_assert_msg(!error.status, "%s", error.message);
    ck_assert(cs_serialiser_is_done(serialiser));
    ck_assert_uint_eq(resumed.run.frame, at);
    run_to(&resumed, broken->frames);
    compare(whole, &resumed, broken, at);
    cs_session_close(&resumed);
}

/* Breaks one run in several places, where a method that saves nothing starts anew. The places
 * at which it goes on take turns from run to run where a build takes one alone. */
static void check(const struct broken *broken) {
    static size_t runs;
    struct cs_error error = {0};
    struct cs_session whole;
    struct cs_serialiser records[BREAKS] = {0};
    open_session(&whole, broken);
    for (int k = 0; k < BREAKS; k++) {
        run_to(&whole, broken->breaks[k]);
        cs_run_save(&whole.run, records + k, &error);
        ck_assert_msg(!error.status, "%s", error.message);
    }
    run_to(&whole, broken->frames);
    // after the last break nothing starts anew any more; before it only a method that saves
    const bool saves = cs_run_method_has_history(whole.method.integrator);
    runs += saves;
    for (int k = saves ? 0 : BREAKS - 1; k < BREAKS; k++)
        if (!saves || suite_takes(runs + k, BREAKS))
            go_on(broken, records + k, &whole, broken->breaks[k]);
    for (int k = 0; k < BREAKS; k++)
        cs_serialiser_finish(records + k);
    cs_session_close(&whole);
}

TEST(scenes_go_on) {
    static const struct broken all[] = {
        {SCENES "/grab_release.json", "velocity-verlet", 30, {1, 11, 23}},
        {SCENES "/viewpoint_flag.json", "implicit-linearised", 20, {3, 8, 17}},
        {SCENES "/push.json", "bdf2", 16, {2, 7, 12}},
        {SCENES "/swing.json", "dopri5", 20, {1, 9, 15}},
        {SCENES "/swing.json", "rkc2", 20, {1, 9, 15}},
        {SCENES "/reef_knot.json", "rkc2", 6, {1, 3, 4}},
        {SCENES "/reef_knot.json", "rock4", 6, {1, 3, 4}},
        {SCENES "/swing.json", "rock4", 20, {1, 9, 15}},
        {SCENES "/swing.json", "composition", 20, {1, 9, 15}},
        {SCENES "/swing.json", "composition:damping=quadrature", 20, {1, 9, 15}},
        {SCENES "/swing.json", "symmetric-multistep", 20, {1, 9, 15}},
        {SCENES "/hang.json", "dopri5:rtol=1e-2", 8, {1, 4, 6}},
        {SCENES "/hang.json", "dop853:rtol=1e-2", 8, {1, 4, 6}},
        {SCENES "/swing.json", "esdirk:rtol=1e-2", 20, {1, 9, 15}},
        {SCENES "/swing.json", "rkc2:rtol=1e-2", 20, {1, 9, 15}},
        {SCENES "/contact_compare.json", "dop853", 40, {12, 21, 33}},
        {SCENES "/contact_compare.json", "dop853:rtol=1e-4", 40, {12, 21, 33}},
        {SCENES "/contact_compare.json", "esdirk", 40, {12, 21, 33}},
        {SCENES "/two_winds.json", "implicit-linearised", 16, {2, 7, 12}},
        {SCENES "/contact_compare.json", "newmark", 16, {3, 8, 13}},
        {SCENES "/contact_compare.json", "gauss", 8, {2, 4, 7}},
        {SCENES "/explosion_cured.json", "implicit-linearised", 12, {1, 4, 9}},
        {SCENES "/flag_capsules.json", "bdf2", 16, {2, 7, 12}},
        {SCENES "/flag_capsules.json", "dopri5", 16, {2, 7, 12}},
        {SCENES "/rip.json", "implicit-linearised", 45, {20, 36, 40}},
        {SCENES "/rip.json", "newmark", 45, {20, 36, 40}},
        {SCENES "/sphere_rest.json", "implicit-linearised", 10, {1, 4, 7}},
        {SCENES "/layers.json", NULL, 6, {2, 4, 5}},
        {SCENES "/walking_bear.json", "implicit-linearised", 20, {7, 13, 18}},
        {SCENES "/walking_bear.json", "newmark", 20, {7, 13, 18}},
        {SCENES "/funnel.json", "implicit-linearised", 4, {1, 2, 3}},
        {SCENES "/self_compare.json", "newmark", 60, {20, 35, 50}},
        {SCENES "/self_compare.json", "r-respa", 60, {20, 35, 50}},
        {SCENES "/self_compare.json", "dopri5", 60, {20, 35, 50}},
        {SCENES "/mixed_company.json", "shape-matching", 10, {1, 4, 7}},
        {SCENES "/disc_drape.json", "bdf2", 29, {24, 26, 28}},
        {SCENES "/disc_drape.json", "fast-mass-spring:dt=frame", 36, {24, 29, 33}},
    };
    for (size_t k = 0; k < sizeof all / sizeof *all; k++)
        check(all + k);
}

/* Steps of its own choice are 300 a frame, which show a sanitizer no more than one does. */
TEST(projections_in_steps_of_their_own_choice_go_on) {
    static const struct broken disc = {
        SCENES "/disc_drape.json", "fast-mass-spring", 36, {24, 29, 33}};
    if (suite_takes(0, SIZE_MAX))
        check(&disc);
}

TEST(methods_go_on_without_damping) {
    static const struct broken drum = {
        SCENES "/drum.json", "symmetric-multistep", 20, {1, 9, 15}};
    changed = (struct cs_override){"bodies[0].springs.damping", "0"};
    check(&drum);
    changed = (struct cs_override){0};
}

/* Breaks within steps that pass frames in contact and before events. */
TEST(steps_that_pass_frames_go_on) {
    static const struct broken all[] = {
        {SCENES "/contact_compare.json", "dop853", 400, {20, 211, 333}},
        {SCENES "/contact_compare.json", "esdirk", 400, {20, 211, 333}},
        {SCENES "/grab_release.json", "dopri5", 300, {7, 111, 203}},
        {SCENES "/grab_release.json", "rock4", 300, {7, 111, 203}},
    };
    changed = (struct cs_override){"time.fps", "600"};
    for (size_t k = 0; k < sizeof all / sizeof *all; k++)
        check(all + k);
    changed = (struct cs_override){0};
}

/* the record of another scene has too many bytes, or too few */
TEST(foreign_records_are_refused) {
    static const struct broken one = {SCENES "/hang.json", "velocity-verlet", 3, {1, 2, 3}};
    static const struct broken two = {SCENES "/swing.json", "velocity-verlet", 3, {1, 2, 3}};
    struct cs_error error = {0};
    struct cs_session session;
    struct cs_serialiser serialiser = {0};
    open_session(&session, &one);
    run_to(&session, 1);
    cs_run_save(&session.run, &serialiser, &error);
    cs_session_close(&session);
    open_session(&session, &two);
    serialiser.is_reading = true;
    cs_run_load(&session.run, &serialiser, &error);
    ck_assert(error.status == CS_ERR_FILE || !cs_serialiser_is_done(&serialiser));
    cs_serialiser_finish(&serialiser);
    cs_session_close(&session);
}
