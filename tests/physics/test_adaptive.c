/* Methods with error control follow the tolerance that they are asked for, methods of high
 * order have the order that they state, and two families agree far below what a picture needs.
 *
 * The scene is a drum: a sheet stretched by 5 % in a frame, with a bump, light axial damping
 * and drag. Its springs are never slack, so that orders show; errors are those at the end, in m
 * and m/s, against Dormand-Prince at a tolerance of 1e-13.
 */
#include "methods.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

#define DRUM DRUM_AT("20")
#define DRUM_AT(fps)                                                                           \
    "{\"bodies\": [{\"cloth\": {\"grid\": [8, 8], \"start\": \"flat\","                        \
    " \"stretch\": [1.05, 1.05], \"bump\": 0.2}, \"mass\": {\"total\": 0.2},"                  \
    " \"springs\": {\"stretch\": 100, \"shear\": 30, \"bend\": 10, \"damping\": 0.02},"        \
    " \"pins\": [\"edges\"]}], \"forces\": {\"drag\": 1e-3}, \"time\": {\"fps\": " fps "}}"
#define HANG                                                                                   \
    "{\"bodies\": [{\"cloth\": {\"grid\": [10, 10], \"size\": [1, 1], \"place\":"              \
    " {\"rotate\": [-0.38, 0, 0, 0.925]}}, \"mass\": {\"particle\": 0.0012}, \"springs\":"     \
    " {\"stretch\": 1000, \"shear\": 300, \"bend\": 5, \"damping\": 0.01},"                    \
    " \"pins\": [\"top-left\", \"top-right\"]}], \"forces\": {\"drag\": 1e-3}}"

enum { FRAMES = 3, VALUES_MAX = 6 * 256 };

struct error {
    double place, speed; /* RMS in m and m/s */
};

static size_t end_state(const char *integrator, const char *scene, uint32_t frames,
                        double state[VALUES_MAX]) {
    struct fixture cloth;
    fixture_open(&cloth, integrator, "%s", scene);
    fixture_start(&cloth);
    fixture_frames(&cloth, frames);
    const size_t values = 6 * cloth.n;
    memcpy(state, cloth.x, values * sizeof *state);
    fixture_close(&cloth);
    return values;
}

static struct error error_of(const char *integrator) {
    static double reference[VALUES_MAX], state[VALUES_MAX];
    static bool known;
    if (!known)
        end_state("dopri5:rtol=1e-13", DRUM, FRAMES, reference);
    known = true;
    const size_t half = end_state(integrator, DRUM, FRAMES, state) / 2;
    return (struct error){cs_rms_difference(state, reference, half),
                          cs_rms_difference(state + half, reference + half, half)};
}

/* Tolerances are those of a step, so that an error may be some times larger; and 10^4 in the
 * tolerance must be 300 in the error at least. */
TEST(errors_follow_the_tolerance) {
    static const char *const methods[] = {
        "dopri5:",           "dop853:",           "esdirk:",           "cvode-adams:",
        "cvode-bdf:",        "ark-erk:order=2,",  "ark-erk:order=3,",  "ark-erk:order=4,",
        "ark-erk:order=5,",  "ark-erk:order=6,",  "ark-erk:order=8,",  "ark-dirk:order=3,",
        "ark-dirk:order=4,", "ark-dirk:order=5,", "ark-imex:order=3,", "ark-imex:order=4,",
        "ark-imex:order=5,"};
    // a method of order 2 takes a hundred times the steps of the others at 1e-8
    static const double tolerances[2][3] = {{1e-4, 1e-6, 1e-8}, {1e-3, 1e-5, 1e-7}};
    for (size_t k = 0; k < sizeof methods / sizeof *methods; k++) {
        struct error errors[3];
        for (int i = 0; i < 3; i++) {
            const double tolerance = tolerances[strstr(methods[k], "order=2") != NULL][i];
            char integrator[64];
            snprintf(integrator, sizeof integrator, "%srtol=%g", methods[k], tolerance);
            errors[i] = error_of(integrator);
            ck_assert_msg(errors[i].place < 2 * tolerance && errors[i].speed < 120 * tolerance,
                          "%s: errors %.3g m, %.3g m/s", integrator, errors[i].place,
                          errors[i].speed);
        }
        ck_assert_msg(errors[0].place > 300 * errors[2].place,
                      "%s: errors %.3g m at the loosest rtol, %.3g m at the tightest",
                      methods[k], errors[0].place, errors[2].place);
    }
}

/* Steps of h, h/2, whole parts of a frame: small enough for the slope, large enough to stay
 * above rounding. Order 7 is
 * in no table of SUNDIALS 6. */
TEST(tables_have_their_order) {
    static const struct {
        const char *method;
        double order, h;
    } rows[] = {{"rk4:", 4, 5e-4},
                {"ark-erk:order=2,", 2, 5e-4},
                {"ark-erk:order=3,", 3, 5e-4},
                {"ark-erk:order=4,", 4, 5e-4},
                {"ark-erk:order=5,", 5, 6.25e-4},
                {"ark-erk:order=6,", 6, 1.25e-3},
                {"ark-erk:order=8,", 8, 2e-3},
                {"ark-dirk:rtol=1e-12,linear_rtol=1e-12,order=2,", 2, 2.5e-4},
                {"ark-dirk:rtol=1e-12,linear_rtol=1e-12,order=3,", 3, 1.5625e-4},
                {"ark-dirk:rtol=1e-12,linear_rtol=1e-12,order=4,", 4, 1e-3},
                {"ark-dirk:rtol=1e-12,linear_rtol=1e-12,order=5,", 5, 5e-4},
                {"esdirk:rtol=1e-12,newton_rtol=1e-3,", 4, 1e-3},
                {"ark-imex:rtol=1e-12,linear_rtol=1e-12,order=3,", 3, 5e-4},
                {"ark-imex:rtol=1e-12,linear_rtol=1e-12,order=4,", 4, 1e-3},
                {"ark-imex:rtol=1e-12,linear_rtol=1e-12,order=5,", 5, 1e-3}};
    for (size_t k = 0; k < sizeof rows / sizeof *rows; k++) {
        struct error errors[2];
        for (int i = 0; i < 2; i++) {
            char integrator[96];
            snprintf(integrator, sizeof integrator, "%sdt=%.17g", rows[k].method,
                     i ? rows[k].h / 2 : rows[k].h);
            errors[i] = error_of(integrator);
        }
        const double place = log2(errors[0].place / errors[1].place);
        const double speed = log2(errors[0].speed / errors[1].speed);
        // errors of order 8 are near its later terms at h, and near rounding at h/2
        const double bound = rows[k].order > 6 ? 0.2 : 0.1;
        ck_assert_msg(
            fabs(place - rows[k].order) < bound && fabs(speed - rows[k].order) < bound,
            "%s: orders %.3f and %.3f (errors %.3g m, %.3g m/s), expected %g", rows[k].method,
            place, speed, errors[1].place, errors[1].speed, rows[k].order);
    }
}

/* Without damping and from rest, terms of the error of a first step vanish by symmetry: the
 * estimate of dop853 let one pass that left 3e-8 m whatever the tolerance. */
TEST(first_steps_from_rest_are_short) {
    static const char *const scene =
        "{\"bodies\": [{\"cloth\": {\"grid\": [16, 16], \"start\": \"flat\","
        " \"stretch\": [1.05, 1.05], \"bump\": 0.08}, \"mass\": {\"total\": 0.2},"
        " \"springs\": {\"stretch\": 100, \"shear\": 30, \"bend\": 10},"
        " \"pins\": [\"edges\"]}], \"time\": {\"fps\": 20}}";
    static double reference[VALUES_MAX], state[VALUES_MAX];
    end_state("ark-erk:order=8,rtol=1e-12", scene, FRAMES, reference);
    const size_t half = end_state("dop853:rtol=1e-8", scene, FRAMES, state) / 2;
    ck_assert_double_lt(cs_rms_difference(state, reference, half), 5e-9);
}

/* An explicit one-step method, two multistep ones and a pair of our own share nothing but the
 * force: on a cloth that swings and wrinkles they meet to 1e-8 m. */
TEST(families_agree) {
    static const char *const methods[] = {"cvode-bdf:rtol=1e-11,max_order=5",
                                          "cvode-adams:rtol=1e-11",
                                          "dopri5:rtol=1e-10",
                                          "dop853:rtol=1e-11",
                                          "esdirk:rtol=1e-10",
                                          "ark-dirk:order=5,rtol=1e-9,linear_rtol=1e-6"};
    static double reference[VALUES_MAX], state[VALUES_MAX];
    end_state("ark-erk:order=8,rtol=1e-12", HANG, 15, reference);
    for (size_t k = 0; k < sizeof methods / sizeof *methods; k++) {
        const size_t half = end_state(methods[k], HANG, 15, state) / 2;
        const double place = cs_rms_difference(state, reference, half);
        const double speed = cs_rms_difference(state + half, reference + half, half);
        ck_assert_msg(place < 1e-8 && speed < 1e-6, "%s: %.3g m, %.3g m/s apart", methods[k],
                      place, speed);
    }
}

/* A mass on three springs. */
#define QUAD                                                                                   \
    "{\"bodies\": [{\"cloth\": {\"grid\": [2, 2]}, \"mass\": {\"particle\": 1},"               \
    " \"springs\": {\"stretch\": 200}, \"pins\": [0]}]%s, \"time\": {\"fps\": %d}}"

struct half_second {
    double state[6 * 4];
    uint64_t forces, rejected;
};

static struct half_second half_second(const char *method, const char *more, int fps) {
    struct half_second out;
    struct fixture cloth;
    fixture_open(&cloth, method, QUAD, more, fps);
    fixture_start(&cloth);
    fixture_frames(&cloth, (uint32_t)fps / 2);
    memcpy(out.state, cloth.x, sizeof out.state);
    out.forces = cloth.session.run.counts.forces;
    out.rejected = cloth.session.run.counts.method.rejected;
    fixture_close(&cloth);
    return out;
}

/* A step cut at every frame is no step thrown away, and the frames' number changes the end by
 * no more than the tolerance. */
TEST(frames_do_not_disturb) {
    const struct half_second few = half_second("dop853:rtol=1e-8", "", 20);
    const struct half_second many = half_second("dop853:rtol=1e-8", "", 200);
    ck_assert_uint_lt(few.rejected, 5);
    ck_assert_uint_lt(many.rejected, 5);
    ck_assert_double_lt(cs_rms_difference(few.state, many.state, 24), 1e-7);
}

/* Neither the motion nor its cost depends on how many frames there are. Where anything acts
 * between steps each frame ends one. */
TEST(steps_pass_frames) {
    static const char *const methods[] = {"dopri5:rtol=1e-6",
                                          "dop853:rtol=1e-8",
                                          "dop853:order=8",
                                          "esdirk:rtol=1e-5",
                                          "rock4",
                                          "rkc2"};
    static const int fps[] = {30, 60, 240, 1200, 3000};
    for (size_t m = 0; m < sizeof methods / sizeof *methods; m++) {
        const struct half_second few = half_second(methods[m], "", 24);
        for (size_t k = 0; k < sizeof fps / sizeof *fps; k++) {
            const struct half_second many = half_second(methods[m], "", fps[k]);
            ck_bits(few.state, many.state, 24, methods[m]);
            ck_assert_uint_eq(few.forces, many.forces);
        }
        const char *const acts = ", \"forces\": {\"velocity_loss\": 1e-12}";
        ck_assert_uint_gt(half_second(methods[m], acts, 3000).forces, 2 * few.forces);
    }
}

/* The same in contact by force and between events, above 60 frames a second. */
TEST(steps_pass_frames_up_to_events) {
    static const char *const methods[] = {"dopri5", "dop853", "esdirk:rtol=1e-4", "rock4"};
    static const char *const acting[] = {
        ", \"colliders\": [{\"floor\": {\"height\": -0.7}, \"thickness\": 0.05}]"
        ", \"contact\": {\"law\": \"force\"}",
        ", \"events\": [{\"at\": 0.13, \"impact\": {\"impulse\": 0.3, \"direction\": [1, 0, "
        "2]}},"
        " {\"from\": 0.2, \"to\": 0.41, \"ramp\": {\"key\": \"forces.drag\", \"value\": "
        "0.5}}]"};
    for (size_t m = 0; m < sizeof methods / sizeof *methods; m++)
        for (int k = 0; k < 2; k++) {
            const struct half_second few = half_second(methods[m], acting[k], 100);
            const struct half_second many = half_second(methods[m], acting[k], 3000);
            const struct half_second ended = half_second(methods[m], acting[k], 60);
            ck_bits(few.state, many.state, 24, methods[m]);
            ck_assert_uint_eq(few.forces, many.forces);
            ck_assert_double_lt(cs_rms_difference(few.state, ended.state, 12), 3e-4);
            ck_assert_double_gt(
                cs_rms_difference(few.state, half_second(methods[m], "", 60).state, 12), 1e-2);
        }
}

enum { INSIDE = 100 };

/* The largest RMS error in m over frames that fall anywhere within steps of h. */
static double error_within_steps(const char *method) {
    static double reference[INSIDE][VALUES_MAX];
    static bool known;
    double most = 0;
    for (int pass = known ? 1 : 0; pass < 2; pass++) {
        struct fixture cloth;
        fixture_open(&cloth, pass ? method : "dop853:rtol=1e-13", "%s", DRUM_AT("1777"));
        fixture_start(&cloth);
        for (int k = 0; k < INSIDE; k++) {
            fixture_frames(&cloth, 1);
            if (!pass)
                memcpy(reference[k], cloth.x, 6 * cloth.n * sizeof(double));
            most = fmax(most, cs_rms_difference(cloth.x, reference[k], 3 * cloth.n));
        }
        fixture_close(&cloth);
    }
    known = true;
    return most;
}

/* At frames that fall anywhere within steps the error falls by the order of the method: two
 * ends of a step give positions to h^6, three to h^9. Cubics between two would give h^4. */
TEST(frames_have_the_order_of_the_method) {
    static const struct {
        const char *method;
        double h, order;
    } rows[] = {{"dopri5:rtol=0.1,dt_max=", 4e-3, 5},
                {"dop853:order=8,rtol=0.1,dt_max=", 6e-3, 8},
                {"esdirk:rtol=0.1,newton_rtol=1e-12,dt_max=", 2e-3, 4},
                {"rock4:rtol=0.1,dt_max=", 2e-3, 4}};
    for (size_t k = 0; k < sizeof rows / sizeof *rows; k++) {
        double errors[2];
        for (int level = 0; level < 2; level++) {
            char method[80];
            snprintf(method, sizeof method, "%s%.17g", rows[k].method, rows[k].h / (1 + level));
            errors[level] = error_within_steps(method);
        }
        const double order = log2(errors[0] / errors[1]);
        ck_assert_msg(fabs(order - rows[k].order) < 0.5, "%s: order %.3f (%.3g m, %.3g m)",
                      rows[k].method, order, errors[0], errors[1]);
    }
}

/* Lengths and gravity times a power of two: the motion is the same times that, to the bit,
 * because tolerances that nobody set scale with the scene. */
TEST(tolerances_scale_with_the_scene) {
    static double states[2][VALUES_MAX];
    const struct methods methods = methods_find(&(struct methods_query){.with = CS_ADAPTIVE});
    for (size_t k = 0; k < methods.n; k++) {
        size_t values = 0;
        for (int i = 0; i < 2; i++) {
            const double unit = i ? 1 / 1024.0 : 1;
            char scene[600];
            snprintf(scene, sizeof scene,
                     "{\"bodies\": [{\"cloth\": {\"grid\": [7, 7], \"size\": [%.17g, %.17g], "
                     "\"stretch\": [1.1, 1]}, \"mass\": {\"total\": 0.1}, \"springs\": "
                     "{\"stretch\": "
                     "200, \"shear\": 60, \"bend\": 10, \"damping\": 0.02}, \"pins\": "
                     "[\"top-left\", "
                     "\"top-right\"]}], \"forces\": {\"gravity\": [0, %.17g, 0]}}",
                     unit / 2, unit / 2, -9.8125 * unit);
            values = end_state(methods.list[k].text, scene, 5, states[i]);
        }
        for (size_t i = 0; i < values; i++)
            states[1][i] *= 1024;
        ck_bits(states[0], states[1], values, methods.list[k].text);
    }
}
