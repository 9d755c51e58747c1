/* The order of cvode-bdf: 5 where the tolerance asks for short steps, 2 where order 5 would be
 * held by its stability near the imaginary axis, and back to 2 where motion has become slow.
 * The sheet hangs by two corners and is weakly damped. */
#include "fixture.h"

#include <stdio.h>
#include <string.h>

#define SHEET                                                                                  \
    "{\"bodies\": [{\"cloth\": {\"grid\": [8, 8], \"size\": [1, 1]}, \"mass\": {\"total\":"    \
    " 0.2}, \"springs\": {\"stretch\": %d000, \"shear\": %d00, \"bend\": %d0, \"damping\":"    \
    " 0.002, \"damping_model\": \"relative\"}, \"pins\": [\"top-left\", \"top-right\"]}],"     \
    " \"forces\": {\"drag\": %s}, \"time\": {\"fps\": 20}}"

enum { VALUES = 6 * 64 };

struct outcome {
    double state[VALUES];
    uint64_t steps;
};

static void run(const char *method, int stiffness, const char *drag, uint32_t frames,
                struct outcome *out) {
    struct fixture cloth;
    fixture_open(&cloth, method, SHEET, stiffness, 3 * stiffness, stiffness, drag);
    fixture_start(&cloth);
    fixture_frames(&cloth, frames);
    memcpy(out->state, cloth.x, sizeof out->state);
    out->steps = cloth.session.run.counts.steps;
    fixture_close(&cloth);
}

static double error_of(const struct outcome *found, const struct outcome *reference) {
    return cs_rms_difference(found->state, reference->state, VALUES / 2);
}

/* both better than order 2, and the cheaper one */
TEST(short_steps_take_order_5) {
    static struct outcome reference, low, found;
    run("dopri5:rtol=1e-12", 1, "0", 3, &reference);
    run("cvode-bdf:rtol=1e-6,atol=1e-9,max_order=2", 1, "0", 3, &low);
    run("cvode-bdf:rtol=1e-6,atol=1e-9", 1, "0", 3, &found);
    ck_assert_msg(4 * found.steps < low.steps, "%llu steps, %llu of order 2",
                  (unsigned long long)found.steps, (unsigned long long)low.steps);
    ck_assert_msg(2 * error_of(&found, &reference) < error_of(&low, &reference),
                  "errors %.3g m, %.3g m of order 2", error_of(&found, &reference),
                  error_of(&low, &reference));
}

/* The sheet's damping outweighs what order 5 makes grow: steps of h omega = 0.3 may try it. */
TEST(damping_lets_longer_steps_take_order_5) {
    static struct outcome reference, low, found;
    run("dopri5:rtol=1e-12", 1, "0", 10, &reference);
    run("cvode-bdf:rtol=1e-4,atol=1e-7,max_order=2", 1, "0", 10, &low);
    run("cvode-bdf:rtol=1e-4,atol=1e-7", 1, "0", 10, &found);
    ck_assert_msg(2 * found.steps < low.steps, "%llu steps, %llu of order 2",
                  (unsigned long long)found.steps, (unsigned long long)low.steps);
    ck_assert_msg(4 * error_of(&found, &reference) < error_of(&low, &reference),
                  "errors %.3g m, %.3g m of order 2", error_of(&found, &reference),
                  error_of(&low, &reference));
}

/* order 5 alone takes hundreds of times the steps there */
TEST(a_stiff_sheet_keeps_order_2) {
    static struct outcome low, found;
    run("cvode-bdf:rtol=1e-3,max_order=2", 1000, "0", 4, &low);
    run("cvode-bdf:rtol=1e-3", 1000, "0", 4, &found);
    ck_assert_msg(found.steps < 2 * low.steps, "%llu steps, %llu of order 2",
                  (unsigned long long)found.steps, (unsigned long long)low.steps);
}

/* the motion dies in the drag: held by stability, order 5 takes twice the steps */
TEST(slow_motion_goes_back_to_order_2) {
    static struct outcome high, found;
    run("cvode-bdf:rtol=1e-6,max_order=5", 1, "0.02", 60, &high);
    run("cvode-bdf:rtol=1e-6", 1, "0.02", 60, &found);
    ck_assert_msg(3 * found.steps < 2 * high.steps, "%llu steps, %llu of order 5",
                  (unsigned long long)found.steps, (unsigned long long)high.steps);
}
