/* dop853 takes steps of order 5 where contact or the frame limits steps of both orders, and
 * those of order 8 elsewhere: never for more evaluations than order 8 alone. */
#include "fixture.h"

#include <string.h>

enum { VALUES_MAX = 6 * 256 };

struct end {
    uint64_t forces;
    size_t half;
    double state[VALUES_MAX];
};

static struct end end_of(const char *scene, const char *method, uint32_t frames) {
    struct cs_error error = {0};
    struct cs_session session;
    struct end end = {0};
    cs_session_open(
        &session, &(struct cs_session_settings){.scene = scene, .integrator = method}, &error);
    ck_assert_msg(!error.status, "%s: %s", scene, error.message);
    while (session.run.frame < frames && session.run.outcome == CS_RUNNING)
        cs_run_frame(&session.run, &error);
    ck_assert_msg(!error.status && session.run.outcome == CS_RUNNING, "%s", error.message);
    end.forces = session.run.counts.forces;
    end.half = 3 * (size_t)session.system.view.n;
    ck_assert_uint_le(2 * end.half, VALUES_MAX);
    memcpy(end.state, session.run.x, 2 * end.half * sizeof *end.state);
    cs_session_close(&session);
    return end;
}

/* Contact lets steps of about 3 ms pass, which is all that order 5 needs down to 1e-4. */
TEST(contact_takes_order_5) {
    static const char *const scene = SCENES "/contact_compare.json";
    const struct end chosen = end_of(scene, "dop853:rtol=1e-4", 30);
    const struct end eight = end_of(scene, "dop853:rtol=1e-4,order=8", 30);
    ck_assert_double_lt((double)chosen.forces, 0.65 * (double)eight.forces);
    ck_assert_double_lt(cs_rms_difference(chosen.state, eight.state, eight.half), 1e-4);
}

/* Errors of order 5 limit its steps at 1e-8 in the same contact. */
TEST(contact_takes_order_8_at_a_small_tolerance) {
    static const char *const scene = SCENES "/contact_compare.json";
    const struct end chosen = end_of(scene, "dop853:rtol=1e-8", 30);
    const struct end eight = end_of(scene, "dop853:rtol=1e-8,order=8", 30);
    ck_assert_double_lt((double)chosen.forces, 1.05 * (double)eight.forces);
    ck_assert_double_lt((double)chosen.forces,
                        0.8 * (double)end_of(scene, "dopri5:rtol=1e-8", 30).forces);
}

/* Nothing but its error limits a step on the drum: all are of order 8. */
TEST(smooth_motion_takes_order_8) {
    static const char *const scene = SCENES "/drum.json";
    const struct end chosen = end_of(scene, "dop853:rtol=1e-10", 30);
    const struct end eight = end_of(scene, "dop853:rtol=1e-10,order=8", 30);
    ck_assert_uint_eq(chosen.forces, eight.forces);
    ck_assert_mem_eq(chosen.state, eight.state, sizeof eight.state);
}
