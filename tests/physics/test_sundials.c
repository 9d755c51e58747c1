/* What the methods on SUNDIALS promise beside numbers: nothing from the heap in a step, no
 * crash where making one fails half-way, and reasons for what cannot be.
 */
#include "allocations.h"
#include "fixture.h"

#include "base/options.h"
#include "base/vector.h"

#include <math.h>
#include <stdarg.h>
#include <stdio.h>
#include <string.h>

/* a cloth that falls on a ball and a floor: commits that move the state are most */
#define SCENE                                                                                  \
    "{\"bodies\": [{\"cloth\": {\"grid\": [6, 6], \"start\": \"flat\","                        \
    " \"velocity\": [0, -2, 0]}, \"mass\": {\"total\": 0.2},"                                  \
    " \"springs\": {\"damping\": 0.01}}],"                                                     \
    " \"contact\": \"project\", \"colliders\": [{\"floor\": {\"height\": -0.5}, "              \
    "\"friction\": 0.3},"                                                                      \
    " {\"sphere\": {\"centre\": [0.03, -0.3, 0.02], \"radius\": 0.25}}]}"

static const char *const methods[] = {"cvode-bdf", "cvode-adams",     "ark-erk",
                                      "ark-dirk",  "ark-erk:order=8", "ark-imex"};
enum { METHODS = sizeof methods / sizeof *methods };

/* SUNDIALS takes its own small tables at the first step after create, and nothing later. */
TEST(steps_take_nothing) {
    allocations_begin();
    for (size_t k = 0; k < METHODS; k++) {
        struct fixture cloth;
        struct cs_error error = {0};
        fixture_open(&cloth, methods[k], SCENE);
        fixture_start(&cloth);
        fixture_frames(&cloth, 1);
        const uint64_t before = allocations;
        for (int frame = 0; frame < 20 && !error.status; frame++)
            cs_run_frame(&cloth.session.run, &error);
        const uint64_t taken = allocations - before;
        ck_assert_msg(!error.status, "%s: %s", methods[k], error.message);
        ck_assert_msg(taken == 0, "%s: %llu allocations", methods[k],
                      (unsigned long long)taken);
        ck_assert_uint_gt(cloth.session.run.counts.projected_particles, 0);
        fixture_close(&cloth);
    }
}

/* a host whose memory ends after so many requests */
struct poor_host {
    void *taken[256];
    int n, most;
    bool told;
};

static void *poor_alloc(void *ctx, size_t bytes) {
    struct poor_host *poor = ctx;
    if (poor->n >= poor->most)
        return NULL;
    const size_t whole = (bytes + 63) / 64 * 64;
    void *memory = aligned_alloc(64, whole);
    ck_assert_ptr_nonnull(memory);
    poor->taken[poor->n++] = memset(memory, 0, whole);
    return memory;
}

static enum cs_step poor_fail(void *ctx, const char *format, ...) {
    (void)format;
    ((struct poor_host *)ctx)->told = true;
    return CS_STEP_FAIL;
}

static void poor_note(void *ctx, const char *format, ...) {
    (void)ctx, (void)format;
}

static enum cs_step create_and_destroy(const struct fixture *cloth, struct poor_host *poor) {
    const struct cs_integrator *method = cloth->session.method.integrator;
    const struct cs_host host = {.size = sizeof host,
                                 .ctx = poor,
                                 .view = &cloth->system->view,
                                 .vector = &cs_vector_kernels,
                                 .alloc = poor_alloc,
                                 .fail = poor_fail,
                                 .note = poor_note};
    void *self = NULL;
    const enum cs_step status = method->create(&host, cloth->session.method.options, &self);
    if (self && method->destroy)
        method->destroy(self);
    for (int i = 0; i < poor->n; i++)
        free(poor->taken[i]);
    return status;
}

TEST(create_may_fail_anywhere) {
    for (size_t k = 0; k < METHODS; k++) {
        struct fixture cloth;
        fixture_open(&cloth, methods[k], SCENE);
        int most = 0;
        enum cs_step status = CS_STEP_FAIL;
        for (; status != CS_STEP_OK && most < 256; most++) {
            struct poor_host poor = {.most = most};
            status = create_and_destroy(&cloth, &poor);
        }
        ck_assert_int_eq(status, CS_STEP_OK);
        ck_assert_int_gt(most, 20);
        fixture_close(&cloth);
    }
}

TEST(failures_have_reasons) {
    static const struct {
        const char *integrator, *reason;
    } rows[] = {{"ark-erk:max_steps=2,rtol=1e-10", "more than 2 steps"},
                {"ark-dirk:max_steps=2,rtol=1e-10", "more than 2 steps"},
                {"cvode-adams:max_steps=2,rtol=1e-10", "more than 2 steps"}};
    for (size_t k = 0; k < sizeof rows / sizeof *rows; k++) {
        struct fixture cloth;
        fixture_open(&cloth, rows[k].integrator, SCENE);
        cs_perturb_smooth(cloth.system, 0.01, 1);
        fixture_start(&cloth);
        const char *reason = fixture_reason(&cloth);
        ck_assert_msg(strstr(reason, rows[k].reason), "%s", reason);
        fixture_close(&cloth);
    }
}

/* A failure of the host's solver ends the run with the host's words, and no step follows it. Of
 * CVODE it ends the frame: it tries shorter steps, of which some ask for no solve. */
TEST(failed_solve_ends_the_run) {
    static const char *const implicit[] = {"cvode-bdf:rtol=1e-2", "ark-dirk", "ark-imex"};
    for (size_t k = 0; k < sizeof implicit / sizeof *implicit; k++) {
        struct fixture cloth;
        struct cs_error error = {0};
        fixture_open(&cloth, implicit[k], SCENE);
        cs_perturb_smooth(cloth.system, 0.01, 1);
        fixture_start(&cloth);
        fixture_frames(&cloth, 1);
        const uint64_t steps = cloth.session.run.counts.steps;
        cs_run_fail_solves(&cloth.session.run);
        ck_assert_int_eq(cs_run_frame(&cloth.session.run, &error), CS_ERR_MODULE);
        ck_assert_msg(strstr(error.message, "the linear solver was told to fail"), "%s",
                      error.message);
        ck_assert_uint_le(cloth.session.run.counts.steps, steps + (k == 0 ? 10 : 0));
        fixture_close(&cloth);
    }
}

/* a state that is no number is refused by the library's own name for it */
TEST(codes_are_named) {
    for (size_t k = 0; k < METHODS; k++) {
        struct fixture cloth;
        struct cs_error error = {0};
        fixture_open(&cloth, methods[k], SCENE);
        cloth.x[7] = (double)NAN;
        fixture_start(&cloth);
        ck_assert_int_eq(cs_run_frame(&cloth.session.run, &error), CS_ERR_MODULE);
        ck_assert_msg(strstr(error.message, "ODE failed at t = 0 s: "), "%s", error.message);
        ck_assert_msg(strstr(error.message, "_FAIL") || strstr(error.message, "_ERR"), "%s",
                      error.message);
        fixture_close(&cloth);
    }
}

/* 990 steps; a new start at order 1 after every step that touches takes 13400. */
TEST(history_survives_contact) {
    struct fixture cloth;
    fixture_open(&cloth, "cvode-bdf:rtol=1e-5", SCENE);
    fixture_start(&cloth);
    fixture_frames(&cloth, 30);
    const struct cs_counts *counts = &cloth.session.run.counts;
    ck_assert_uint_gt(counts->projected_particles, counts->steps);
    ck_assert_msg(counts->steps < 3000, "%llu steps", (unsigned long long)counts->steps);
    fixture_close(&cloth);
}

/* hangs by two corners; what follows the pins closes the body, and may act between steps */
#define HANGING                                                                                \
    "{\"bodies\": [{\"cloth\": {\"grid\": [8, 8]}, \"mass\": {\"total\": 0.2}, \"springs\":"   \
    " {\"stretch\": 1000, \"shear\": 300, \"bend\": 100, \"damping\": 0.002,"                  \
    " \"damping_model\": \"relative\"}, \"pins\": [\"top-left\", \"top-right\"] %s,"           \
    " \"time\": {\"fps\": %d}}"
enum { HANGING_VALUES = 6 * 64, ENDS = 5 };

struct hung {
    double states[ENDS][HANGING_VALUES]; /* after 0.1, 0.2, ... s */
    uint64_t forces;
};

static void hang(const char *method, const char *more, int fps, struct hung *out) {
    struct fixture cloth;
    fixture_open(&cloth, method, HANGING, more, fps);
    fixture_start(&cloth);
    for (int end = 0; end < ENDS; end++) {
        fixture_frames(&cloth, (uint32_t)fps / 10);
        memcpy(out->states[end], cloth.x, sizeof out->states[end]);
    }
    out->forces = cloth.session.run.counts.forces;
    fixture_close(&cloth);
}

/* Frames are interpolated: neither the motion nor its cost depends on how many there are. Where
 * anything acts between steps each frame ends one. */
TEST(steps_pass_frames) {
    static struct hung few, many;
    hang("cvode-bdf:rtol=1e-2", "}]", 10, &few);
    hang("cvode-bdf:rtol=1e-2", "}]", 500, &many);
    ck_assert_mem_eq(few.states, many.states, sizeof few.states);
    ck_assert_uint_eq(few.forces, many.forces);
    ck_assert_uint_lt(few.forces, 250);
    hang("cvode-bdf:rtol=1e-2", "}], \"forces\": {\"velocity_loss\": 1e-12}", 500, &many);
    ck_assert_uint_gt(many.forces, 250);
}

/* The slope at the end of a step that a frame asks for is the first of the next step. */
TEST(runge_kutta_steps_pass_frames) {
    static const char *const names[] = {"ark-erk", "ark-erk:order=8", "ark-dirk", "ark-imex"};
    static struct hung few, many;
    for (size_t k = 0; k < LENGTH(names); k++) {
        hang(names[k], "}]", 10, &few);
        hang(names[k], "}]", 500, &many);
        ck_assert_msg(!memcmp(few.states, many.states, sizeof few.states), "%s", names[k]);
        ck_assert_msg(few.forces == many.forces, "%s: %llu and %llu forces", names[k],
                      (unsigned long long)few.forces, (unsigned long long)many.forces);
        hang(names[k], "}], \"forces\": {\"velocity_loss\": 1e-12}", 500, &many);
        ck_assert_uint_gt(many.forces, few.forces + few.forces / 4);
    }
}

/* In contact by force and up to events too. A slope at a frame before an event goes unused. */
TEST(steps_pass_frames_up_to_events) {
    static const char *const names[] = {"ark-erk", "ark-dirk", "ark-imex"};
    static const char *const acting[] = {
        "}], \"colliders\": [{\"sphere\": {\"centre\": [0, -0.2, 0.25], \"radius\": 0.2}}], "
        "\"forces\": {\"gravity\": [0, -9.81, 5]},"
        " \"contact\": {\"law\": \"force\"}",
        "}], \"events\": [{\"at\": 0.23, \"release\": {\"particles\": [\"top-left\"]}}]"};
    static struct hung few, many;
    for (size_t k = 0; k < 2 * LENGTH(names); k++) {
        const char *name = names[k / 2];
        hang(name, acting[k % 2], 100, &few);
        hang(name, acting[k % 2], 1000, &many);
        ck_assert_msg(!memcmp(few.states, many.states, sizeof few.states), "%s", name);
        ck_assert_msg(many.forces < few.forces + few.forces / 50, "%s: %llu and %llu forces",
                      name, (unsigned long long)few.forces, (unsigned long long)many.forces);
        hang("dopri5:rtol=1e-8", acting[k % 2], 100, &many);
        const double error =
            cs_rms_difference(few.states[ENDS - 1], many.states[ENDS - 1], HANGING_VALUES / 2);
        ck_assert_msg(error < 1e-3, "%s: %.3g m off", name, error);
    }
}

/* The interpolant is as good as the steps: between them the error follows the tolerance too. */
TEST(interpolated_frames_follow_the_tolerance) {
    static const char *const names[] = {"cvode-bdf", "ark-erk", "ark-erk:order=8,", "ark-dirk",
                                        "ark-imex"};
    static const double rtols[] = {1e-2, 1e-4, 1e-6};
    static struct hung reference, found;
    hang("dopri5:rtol=1e-11", "}]", 10, &reference);
    for (size_t k = 0; k < LENGTH(rtols) * LENGTH(names); k++) {
        const char *name = names[k / LENGTH(rtols)];
        const double rtol = rtols[k % LENGTH(rtols)];
        char method[64];
        snprintf(method, sizeof method, "%s%srtol=%g", name, strchr(name, ':') ? "" : ":",
                 rtol);
        hang(method, "}]", 10, &found);
        for (int end = 0; end < ENDS; end++) {
            const double error =
                cs_rms_difference(found.states[end], reference.states[end], HANGING_VALUES / 2);
            ck_assert_msg(error < 3 * rtol && error > 1e-6 * rtol,
                          "%s: %.3g m off after %d frames", method, error, end + 1);
        }
    }
}

/* what the host says of a scene that goes on so */
static bool may_pass(const char *more) {
    struct fixture cloth;
    fixture_open(&cloth, "cvode-bdf", HANGING, more, 60);
    fixture_start(&cloth);
    const bool passes = cs_run_calls(&cloth.session.run)->may_overstep;
    fixture_close(&cloth);
    return passes;
}

/* whether the time that a method passes has an effect on the forces of a scene that goes on so
 */
TEST(time_dependence_is_told) {
    static const struct {
        const char *more;
        bool depends;
    } rows[] = {{"}], \"forces\": {\"drag\": 0.1}", false},
                {"}], \"colliders\": [{\"floor\": {\"height\": -9}}]", false},
                {"}], \"events\": [{\"from\": 0, \"to\": 1, \"ramp\": {\"key\": "
                 "\"forces.drag\", \"value\": 1}}]",
                 true}};
    for (size_t k = 0; k < sizeof rows / sizeof *rows; k++) {
        struct fixture cloth;
        fixture_open(&cloth, "velocity-verlet", HANGING, rows[k].more, 60);
        fixture_start(&cloth);
        ck_assert_msg(cs_run_calls(&cloth.session.run)->forces_depend_on_time ==
                          rows[k].depends,
                      "%s", rows[k].more);
        fixture_close(&cloth);
    }
}

TEST(what_acts_between_steps_is_told) {
    static const char *const acting[] = {
        ", \"strain_limit\": 1.1}]",
        "}], \"forces\": {\"velocity_loss\": 0.01}",
        "}], \"colliders\": [{\"floor\": {\"height\": -9}}]",
        "}], \"colliders\": [{\"floor\": {\"height\": -9}}], \"contact\": {\"law\": \"force\"}",
        "}], \"crossings\": \"stop\"",
        "}], \"events\": [{\"at\": 1, \"release\": {\"particles\": [\"top-left\"]}}]"};
    ck_assert(may_pass("}]"));
    ck_assert(may_pass("}], \"forces\": {\"drag\": 0.1}"));
    for (size_t k = 0; k < sizeof acting / sizeof *acting; k++)
        ck_assert_msg(!may_pass(acting[k]), "%s", acting[k]);
}

/* --- fixed steps --- */

/* The state of a sheet of springs after 0.3 s. */
static void end_state(const char *method, double *x) {
    struct fixture sheet;
    fixture_open(
        &sheet, method,
        "{\"bodies\": [{\"cloth\": {\"grid\": [6, 6], \"size\": [0.5, 0.5], \"start\": "
        "\"flat\", \"bump\": 0.02}, \"mass\": {\"areal_density\": 0.2}, \"springs\": "
        "{\"stretch\": 20, \"shear\": 6, \"bend\": 0.6, \"damping\": 0.01}, \"pins\": "
        "[\"top-left\", \"top-right\"]}], \"time\": {\"fps\": 20}}");
    fixture_start(&sheet);
    fixture_frames(&sheet, 6);
    memcpy(x, sheet.x, 3 * sheet.n * sizeof *x);
    fixture_close(&sheet);
}

/* With a fixed step Newton's iteration stops well below the error of the step, at the default
 * rtol: else halving it once more, to 1e-9 m, would show order 1.6. */
TEST(fixed_steps_keep_their_order) {
    static const char *const names[] = {"ark-dirk:", "ark-imex:", "ark-dirk:order=5,"};
    enum { VALUES = 3 * 36 };
    double reference[VALUES], x[VALUES];
    end_state("dop853:rtol=1e-13,atol=1e-16", reference);
    for (size_t k = 0; k < LENGTH(names); k++) {
        double error[2];
        for (int halved = 0; halved < 2; halved++) {
            char method[80];
            snprintf(method, sizeof method, "%sdt=%g", names[k], 0.0025 / (1 + halved));
            end_state(method, x);
            error[halved] = cs_rms_difference(x, reference, VALUES);
        }
        const double order = log2(error[0] / error[1]), stated = k < 2 ? 4 : 5;
        ck_assert_msg(fabs(order - stated) < 0.3, "%s order %.2f, errors %.3g and %.3g m",
                      names[k], order, error[0], error[1]);
    }
}
